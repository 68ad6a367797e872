"""What the physics knows of objects and robots: units, ranges and meanings, written once."""

import dataclasses
import functools
import math
from typing import get_args, Literal

import numpy as np
from push_model.quantity import check, quantity
from scipy.optimize import nnls


def plate_inertia(mass, outline, radius=0.0):
    """
    Moment of inertia about the vertical axis through the mass centre [kg m^2].

    That of a uniform plate in the shape of the outline, about its centroid. It is also taken where
    the mass centre is elsewhere: what moves it is thought to be spread out as far as the plate.

    :param mass: [kg].
    :param outline: vertices (x, y) of a polygon, counter-clockwise [m]; empty for a disc.
    :param radius: of the disc [m].
    :return: inertia [kg m^2].
    """
    if not outline:
        return 0.5 * mass * radius ** 2
    # Triangles between the centroid of the vertices, which is inside, and the edges.
    count = len(outline)
    o_x, o_y = sum(x for x, _ in outline) / count, sum(y for _, y in outline) / count
    area, first_x, first_y, second = 0.0, 0.0, 0.0, 0.0
    for i, (x, y) in enumerate(outline):
        a_x, a_y = outline[i - 1][0] - o_x, outline[i - 1][1] - o_y
        b_x, b_y = x - o_x, y - o_y
        part = 0.5 * (a_x * b_y - a_y * b_x)
        area += part
        first_x += part * (a_x + b_x) / 3.0
        first_y += part * (a_y + b_y) / 3.0
        second += part * (a_x * a_x + a_x * b_x + b_x * b_x
                          + a_y * a_y + a_y * b_y + b_y * b_y) / 6.0
    return mass * (second / area - (first_x / area) ** 2 - (first_y / area) ** 2)


BALANCE_TOLERANCE = 0.01
STIFF = 1e5


def load_fractions(points, given, center):
    """
    Share of the weight on each support.

    :param points: places of the supports, shape (k, 2) [m].
    :param given: relative shares, one per support; all 0 where none are given.
    :param center: mass centre (x, y) [m], same frame.
    :return: tuple of k shares that sum up to 1.
    :raises ValueError: where the object would tip, where given shares do not balance it, or where
        only some are given; the text has no name in front.
    """
    points, given, center = (np.array(v, dtype=float) for v in (points, given, center))
    reach = max(float(np.abs(points - center).max()), 1e-9)
    shares = _balanced((points - center) / reach)
    if shares is None:
        raise ValueError(f'got a mass centre at ({center[0]:g}, {center[1]:g}), expected it '
                         'inside the hull of the supports: the object would tip')
    if given.any() and not given.all():
        raise ValueError(f'got load shares {given.tolist()}, expected one above 0 for every '
                         'support, or none')
    given = given / given.sum() if given.any() else shares
    pressure = given @ points
    if np.abs(pressure - center).max() > BALANCE_TOLERANCE * reach:
        raise ValueError(f'got load shares that balance about ({pressure[0]:.4g}, '
                         f'{pressure[1]:.4g}), expected about the mass centre ({center[0]:g}, '
                         f'{center[1]:g}): change either, or give no shares')
    # Where statics leave no choice, rounded shares do not count.
    return tuple((shares if _is_determinate(points) else given).tolist())


def _is_determinate(points):
    return np.linalg.matrix_rank(np.column_stack([np.ones(len(points)), points])) == len(points)


def _balanced(points):
    # Least squares of the loads among all that balance: springs of equal stiffness under a plate.
    rows = np.vstack([np.ones(len(points)), points.T])
    want = np.array([1.0, 0.0, 0.0])
    rough, _ = nnls(np.vstack([STIFF * rows, np.eye(len(points))]),
                    np.concatenate([STIFF * want, np.zeros(len(points))]))
    # A foot without load is allowed: a mass centre on the edge of the hull is at the limit.
    carrying = rough > 1e-9
    shares = np.zeros(len(points))
    shares[carrying] = np.linalg.lstsq(rows[:, carrying], want, rcond=None)[0]
    balances = np.abs(rows @ shares - want).max() < 1e-6 and shares.min() > -1e-6
    return np.maximum(shares, 0.0) if balances else None


GRAVITY = 9.81
Drive = Literal['differential', 'holonomic']
DRIVES: tuple[Drive, ...] = get_args(Drive)
ContactKind = Literal['vertex', 'face', 'round']
CONTACT_KINDS: tuple[ContactKind, ...] = get_args(ContactKind)
Outline = tuple[tuple[float, float], ...]


@dataclasses.dataclass(frozen=True)
class Support:
    """A foot of the object: where it stands, what it carries, how it rubs."""

    x: float = quantity('position in the object frame, x', 'm')
    y: float = quantity('position in the object frame, y', 'm')
    friction_coefficient: float = quantity('Coulomb friction on the floor', '', 0.0, 10.0)
    load_fraction: float = quantity('share of the weight, relative to the other supports; 0 for all: '
                                    'as the mass centre has it', '', 0.0, default=0.0)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class PushedObject:
    """
    A rigid object with a flat base on point supports.

    Its outline is a convex polygon, or a disc about the frame's origin when ``outline`` is empty;
    supports stand anywhere. An ``inertia`` of 0 is replaced at construction by that of the shape.
    """

    mass: float = quantity('mass', 'kg', above=0.0)
    inertia: float = quantity('moment of inertia about the vertical axis through the mass centre; '
                              '0: of a uniform plate', 'kg m^2', 0.0, default=0.0)
    supports: tuple[Support, ...] = quantity('supports that carry the object', default=())
    outline: Outline = quantity('vertices (x, y) of the convex outline, counter-clockwise, in the '
                                'object frame; empty for a disc', 'm', default=())
    radius: float = quantity('radius of a disc-shaped outline, 0 for a polygon', 'm', 0.0,
                             default=0.0)
    center_of_mass: tuple[float, float] = quantity('mass centre (x, y) in the object frame', 'm',
                                                   default=(0.0, 0.0))
    contact_friction_coefficient: float = quantity('Coulomb friction between outline and robot',
                                                   '', 0.0, 10.0, default=0.5)

    def __post_init__(self):
        """Validate the fields and the shape."""
        check(self)
        if not self.supports:
            raise ValueError('PushedObject.supports: got none, expected at least one Support')
        for support in self.supports:
            if not isinstance(support, Support):
                raise ValueError(f'PushedObject.supports: got {support!r}, expected a Support')
        if len(self.center_of_mass) != 2:
            raise ValueError(f'PushedObject.center_of_mass: got {self.center_of_mass!r}, '
                             'expected two numbers (x, y) [m]')
        if bool(self.outline) == bool(self.radius):
            raise ValueError(f'PushedObject.outline: got {len(self.outline)} vertices and radius '
                             f'{self.radius:g}, expected vertices or a radius, not both')
        if self.outline:
            _check_convex(self.outline)
        if self.inertia == 0.0:
            object.__setattr__(self, 'inertia',
                               plate_inertia(self.mass, self.outline, self.radius))
        object.__setattr__(self, '_shares', _balanced_shares(self.supports, self.center_of_mass))

    @property
    def loads(self):
        """Normal load on each support [N], shape (k,); they balance about the mass centre."""
        return tuple(self.mass * GRAVITY * share for share in self._shares)

    @property
    def capacities(self):
        """Friction capacity ``q_i = mu_i N_i`` of each support [N], shape (k,)."""
        return tuple(support.friction_coefficient * load
                     for support, load in zip(self.supports, self.loads))


@dataclasses.dataclass(frozen=True)
class RoundRobot:
    """
    A disc-shaped mobile base and the limits of its drive.

    A radius of 0 is a point. An infinite one is a straight fence through the robot's position,
    which faces along its heading.
    """

    radius: float = quantity('radius of the outline; 0: a point, infinite: a straight fence', 'm',
                             0.0, infinite=True)
    drive: Drive = quantity('kinematics of the base', choices=DRIVES, default='differential')
    max_speed: float = quantity('speed limit', 'm/s', above=0.0, high=10.0, default=0.5)
    max_yaw_rate: float = quantity('yaw rate limit', 'rad/s', above=0.0, high=50.0, default=2.0)
    max_acceleration: float = quantity('acceleration limit', 'm/s^2', above=0.0, high=100.0,
                                       default=1.0)
    max_yaw_acceleration: float = quantity('yaw acceleration limit', 'rad/s^2', above=0.0,
                                           high=1000.0, default=6.0)
    time_constant: float = quantity('first-order lag from command to motion', 's', 0.0, 5.0,
                                    default=0.1)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class Contact:
    """Where the robot touches the object's outline."""

    kind: ContactKind = quantity('feature that is touched', choices=CONTACT_KINDS)
    index: int = quantity('vertex number, or face number (face i runs from vertex i to i + 1); '
                          '0 for a round outline', '', 0, default=0)
    offset: float = quantity('on a face: distance of the contact from the midpoint, to the left '
                             'as the robot looks at it; on a round outline: angle of the contact '
                             'in the object frame; 0 at a vertex', 'm or rad', default=0.0)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


# Kept, as variations of an object mostly stand on the same feet.
@functools.lru_cache(maxsize=256)
def _balanced_shares(supports, center_of_mass):
    try:
        return load_fractions([(foot.x, foot.y) for foot in supports],
                              [foot.load_fraction for foot in supports], center_of_mass)
    except ValueError as error:
        raise ValueError(f'PushedObject.supports: {error}') from error


def _check_convex(outline):
    for vertex in outline:
        if not isinstance(vertex, tuple) or len(vertex) != 2:
            raise ValueError(f'PushedObject.outline: got vertex {vertex!r}, expected (x, y) [m]')
    if len(outline) < 3:
        raise ValueError(f'PushedObject.outline: got {len(outline)} vertices, expected 3 or more')
    turned = 0.0
    for i, (x, y) in enumerate(outline):
        x0, y0 = outline[i - 1]
        x1, y1 = outline[(i + 1) % len(outline)]
        cross = (x - x0) * (y1 - y) - (y - y0) * (x1 - x)
        dot = (x - x0) * (x1 - x) + (y - y0) * (y1 - y)
        if cross <= 0.0:
            raise ValueError(f'PushedObject.outline: got a turn of {math.atan2(cross, dot):.3g} '
                             f'rad at vertex {i}, expected a convex outline, counter-clockwise')
        turned += math.atan2(cross, dot)
    if abs(turned - 2 * math.pi) > 1e-6:
        raise ValueError('PushedObject.outline: got edges that cross, expected a convex outline')
