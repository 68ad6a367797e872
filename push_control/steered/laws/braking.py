"""Braking: how far a robot with lag and a limit on its acceleration still moves."""

from push_model.parameters import RoundRobot


def braking_distance(robot: RoundRobot, speed: float) -> float:
    """
    Compute the distance from the command to stop until rest.

    With time constant T and acceleration limit a, ``v' = -min(v / T, a)``: constant deceleration
    down to a T, then an exponential decay, over

        (v^2 - (a T)^2) / (2 a) + a T^2,  or v T from a speed v below a T.

    :param speed: v [m/s], at least 0.
    :return: distance [m].
    """
    lag, limit = robot.time_constant, robot.max_acceleration
    knee = limit * lag
    if speed <= knee:
        return speed * lag
    return 0.5 * (speed ** 2 - knee ** 2) / limit + knee * lag
