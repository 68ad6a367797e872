"""Check whether a robot can push an object, by what is stated of both."""

from push_model.parameters import PushedObject, RoundRobot


def needed_force(obj: PushedObject) -> float:
    """Compute the force that pushes an object through its centre of friction [N]."""
    return sum(obj.capacities)


def force_warning(obj: PushedObject, robot: RoundRobot) -> str:
    """
    Warn of an object that is too heavy for a robot, with both forces.

    :param obj: the ``PushedObject``, nominal.
    :param robot: the ``RoundRobot``, nominal.
    :return: one sentence; empty where the force suffices, or is not stated.
    """
    needed = needed_force(obj)
    if needed <= robot.max_push_force:
        return ''
    return (f'the object needs {needed:.0f} N, and the robot pushes with '
            f'{robot.max_push_force:.0f} N: its wheels will spin')
