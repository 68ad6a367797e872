"""
Positions of the numbers in the arrays that the kernel works on.

numba compiles arrays of floats far faster than objects, so that the kernel sees the state of the
world as one flat array. These names say which number is which; ``encoding`` translates between
them and the typed values of the rest of the package.
"""

from typing import Any, NamedTuple

# State: the mass centre and its velocity, world axes. The acceleration over the last step
# predicts the next one; it is 0 where it says nothing about that.
X = 0
Y = 1
THETA = 2
V_X = 3
V_Y = 4
OMEGA = 5
A_X = 6
A_Y = 7
A_OMEGA = 8
# State: pose of the robot in the world, and its velocity in its own axes.
ROBOT_X = 9
ROBOT_Y = 10
ROBOT_THETA = 11
ROBOT_V_X = 12
ROBOT_V_Y = 13
ROBOT_OMEGA = 14
# State: mode of the contact and its force on the object over the last step [N].
MODE = 15
NORMAL_FORCE = 16
TANGENTIAL_FORCE = 17
# State: energies since the start [J].
WORK = 18
SUPPORT_LOSS = 19
CONTACT_LOSS = 20
IMPACT_LOSS = 21
# State: counts since the start.
ITERATIONS = 22
STEPS = 23
UNSOLVED_STEPS = 24
# State: centre of pressure of the last step relative to the mass centre, world axes [m].
PRESSURE_X = 25
PRESSURE_Y = 26
# State: energy since the start that the implicit step itself damps [J].
INTEGRATION_LOSS = 27
# State: distance that object and robot may move before either can touch a wall [m].
WALL_SLACK = 28
# State: force of walls on the object over the last step, world axes [N]; how many touches it has;
# how far it is inside a wall [m]; whether a wall holds the robot.
WALL_FORCE_X = 29
WALL_FORCE_Y = 30
WALL_TOUCHES = 31
WALL_DEPTH = 32
ROBOT_AT_WALL = 33
STATE_SIZE = 34

# Body: what does not change during a simulation.
MASS = 0
INERTIA = 1
COM_X = 2
COM_Y = 3
DISC_RADIUS = 4
ROBOT_RADIUS = 5
CONTACT_FRICTION = 6
SMOOTHING_SPEED = 7
CONTACT_CREEP = 8
CONTACT_HEIGHT = 9
CENTER_OF_MASS_HEIGHT = 10
# Body: friction between walls and what touches them, and the greatest force with which the robot
# pushes an object that walls hold [N].
WALL_FRICTION = 11
MAX_PUSH_FORCE = 12

# Drive of the robot.
TIME_CONSTANT = 0
MAX_ACCELERATION = 1
MAX_YAW_ACCELERATION = 2

# Columns of a support: position relative to the mass centre, object axes [m]; friction capacity
# on the floor that is under it now, and on plain floor, under its load at rest [N]; its load over
# that at rest; its fraction of the weight at rest, and the gradient of that fraction by the centre
# of pressure, object axes [1/m].
SUPPORT_X = 0
SUPPORT_Y = 1
CAPACITY = 2
PLAIN_CAPACITY = 3
LOAD_RATIO = 4
LOAD_FRACTION = 5
GRADIENT_X = 6
GRADIENT_Y = 7
SUPPORT_SIZE = 8

# Number of columns of a floor patch, see ``floor.floor_rows``.
PATCH_SIZE = 8

# Columns of a touch of object and wall: unit normal from the wall to the object, arms of it and of
# the tangent about the mass centre [m], gap [m], normal velocity that the object needs at least
# [m/s], impulses along normal and tangent [N s].
TOUCH_N_X = 0
TOUCH_N_Y = 1
TOUCH_ARM_N = 2
TOUCH_ARM_T = 3
TOUCH_GAP = 4
TOUCH_REQUIRED = 5
TOUCH_NORMAL = 6
TOUCH_TANGENTIAL = 7
TOUCH_SIZE = 8

# Modes of the contact.
SEPARATE = 0
STICK = 1
SLIDE_LEFT = 2
SLIDE_RIGHT = 3
MODE_COUNT = 4
# In place of a mode: the one that the contact law selects.
ANY_MODE = -1


class World(NamedTuple):
    """
    An object and the robot beside it, in arrays whose numbers have the order above.

    :param state: shape (``STATE_SIZE``,), is written.
    :param body: what does not change of object and robot, shape (13,).
    :param supports: shape (k, ``SUPPORT_SIZE``); their capacities and loads are written.
    :param outline: vertices in the object frame [m].
    :param floor: rows of ``floor.floor_rows``; none on a plain floor.
    :param forces: friction on each support (x, y, x, y, ...) [N], is written; empty where neither
        that nor energies are asked for.
    :param drive: lag and limits of the robot's drive, shape (3,).
    :param command: (v_x, v_y, omega) asked of the robot, its own axes [m/s, rad/s].
    :param walls: ``wall_grid.WallGrid``; ``NO_WALLS`` on open floor.
    :param touches: room for touches of object and walls, shape (m, ``TOUCH_SIZE``), is written.
    """

    state: Any
    body: Any
    supports: Any
    outline: Any
    floor: Any
    forces: Any
    drive: Any
    command: Any
    walls: Any
    touches: Any
