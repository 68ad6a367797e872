"""The same pushes, computed another way: stiff integration of smooth equations of motion."""

import math

import numpy as np
from push_model.contact import rolling_constants
from push_model.equation_of_motion import equation_of_motion
from push_model.geometry import closest_on_polygon, Pose
from push_model.parameters import RoundRobot
from scipy.integrate import solve_ivp

ACCELERATION, YAW_ACCELERATION = 2.0, 10.0


def ramp_robot(radius, drive='holonomic'):
    """Return a robot without lag: it ramps up at constant acceleration."""
    return RoundRobot(radius, drive, max_speed=5.0, max_yaw_rate=20.0,
                      max_acceleration=ACCELERATION, max_yaw_acceleration=YAW_ACCELERATION,
                      time_constant=0.0)


def ramped(command, time):
    """Return (v_x, v_y, omega) in own axes and its rate, from rest."""
    speed = math.hypot(command[0], command[1])
    share = min(1.0, ACCELERATION * time / speed) if speed else 1.0
    rate = ACCELERATION / speed if share < 1.0 else 0.0
    omega = math.copysign(min(abs(command[2]), YAW_ACCELERATION * time), command[2])
    alpha = math.copysign(YAW_ACCELERATION, command[2]) * (abs(omega) < abs(command[2]))
    return (share * command[0], share * command[1], omega), (rate * command[0],
                                                             rate * command[1], alpha)


def kinks(command, times):
    """Return the times where the ramps end, with the ends of the run."""
    ramps = [math.hypot(*command[:2]) / ACCELERATION, abs(command[2]) / YAW_ACCELERATION]
    return sorted({0.0, times[-1], *(t for t in ramps if 0.0 < t < times[-1])})


def robot_at(heading, command, time):
    """Return world velocity, acceleration, yaw rate and yaw acceleration of the robot."""
    twist, rate = ramped(command, time)
    pose = Pose(0.0, 0.0, heading)
    v_x, v_y = pose.rotate(twist)
    a_x, a_y = pose.rotate(rate)
    return (v_x, v_y), (a_x - twist[2] * v_y, a_y + twist[2] * v_x), twist[2], rate[2]


def integrate(rate, start, command, times, tolerance=1e-9):
    """Integrate piecewise between the kinks; return states at the times, shape (n, k)."""
    edges, state, pieces = kinks(command, times), np.array(start), []
    for begin, end in zip(edges, edges[1:]):
        at = [t for t in times if begin < t <= end]
        # An explicit end of the piece keeps the kink out of the integrator's view.
        inside = (begin + 1e-12, end - 1e-12)
        run = solve_ivp(lambda t, y: rate(min(max(t, inside[0]), inside[1]), y), (begin, end),
                        state, method='Radau', rtol=tolerance, atol=tolerance * 1e-2,
                        t_eval=sorted({*at, end}))
        assert run.success, run.message
        pieces += [y for t, y in zip(run.t, run.y.T) if t in at]
        state = run.y[:, -1]
    return np.array(pieces)


def rolling_push(obj, robot, normal, contact_point, surface_radius, heading, command, times):
    """
    Integrate push_model's rolling equation for an object at the origin that is touched at rest.

    :return: object poses, shape (n, 3), contact forces (F_n, F_t), shape (n, 2).
    """
    share, effective = rolling = rolling_constants(robot.radius, surface_radius)
    motion = equation_of_motion(obj, rolling)

    def inputs(time, y):
        # The velocity of the robot's material at C, whatever the robot's shape.
        v, a, omega_p, alpha_p = robot_at(y[7], command, time)
        v, a = complex(*v), complex(*a)
        arm = complex(*Pose(*y[:3]).transform(y[5:7])) - complex(*y[8:10])
        surface = v + 1j * omega_p * arm
        moved = surface + effective * (y[3] - omega_p) * 1j * np.exp(1j * y[4])
        bias = a + 1j * alpha_p * arm + 1j * omega_p * (moved - v)
        return [surface.real, surface.imag, bias.real, bias.imag, omega_p]

    def rate(time, y):
        u, v = inputs(time, y), robot_at(y[7], command, time)[0]
        return np.array([*np.array(motion(y[:7], u)[0]).ravel(), u[4], *v])

    away = 0.0 if math.isinf(robot.radius) else robot.radius
    start = Pose(*contact_point, normal).transform((-away, 0.0))
    states = integrate(rate, [0, 0, 0, 0, normal, *contact_point, heading, *start], command, times)
    forces = [np.array(motion(y[:7], inputs(t, y))[1]).ravel() for t, y in zip(times, states)]
    return states[:, :3], np.array(forces)


def sliding_push(obj, robot, robot_pose, command, side, times):
    """
    Push a face of an object at the origin while the contact slides, in maximal coordinates.

    :param side: +1 or -1, the sign of the tangential force.
    :return: object poses, shape (n, 3).
    """
    _, _, n0_x, n0_y, _, _, _ = closest_on_polygon(obj.outline, robot_pose[0], robot_pose[1])
    arms = [(s.x - obj.center_of_mass[0], s.y - obj.center_of_mass[1]) for s in obj.supports]

    def rate(time, y):
        g, v, omega, p = y[0:2], y[3:5], y[5], y[6:8]
        turned = Pose(0.0, 0.0, y[2])
        n = np.array(turned.rotate((n0_x, n0_y)))
        t = np.array([-n[1], n[0]])
        v_p, a_p, omega_p, _ = (np.array(item) for item in robot_at(y[8], command, time))
        force, moment = np.zeros(2), 0.0
        for arm, capacity in zip(arms, obj.capacities):
            r = np.array(turned.rotate(arm))
            slip = v + omega * np.array([-r[1], r[0]])
            f = -capacity * slip / math.sqrt(slip @ slip + 1e-10)
            force, moment = force + f, moment + r[0] * f[1] - r[1] * f[0]
        push = n + side * obj.contact_friction_coefficient * t
        arm = p + robot.radius * n - g
        per_force = push / obj.mass, (arm[0] * push[1] - arm[1] * push[0]) / obj.inertia
        # The face stays at the distance R_p: second derivative of n.(G - P).
        lever = t @ (g - p)
        free = (moment / obj.inertia * lever - omega ** 2 * (n @ (g - p))
                + 2.0 * omega * (t @ (v - v_p)) + n @ (force / obj.mass - a_p))
        size = -free / (per_force[1] * lever + n @ per_force[0])
        return np.concatenate([v, [omega], force / obj.mass + size * per_force[0],
                               [moment / obj.inertia + size * per_force[1]], v_p, [omega_p]])

    start = [*obj.center_of_mass, 0.0, 0.0, 0.0, 0.0, *robot_pose]
    states = integrate(rate, start, command, times)
    back = [Pose(0.0, 0.0, y[2]).rotate(obj.center_of_mass) for y in states]
    return np.column_stack([states[:, :2] - back, states[:, 2]])
