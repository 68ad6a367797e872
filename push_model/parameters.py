"""
Parameters of objects, robots and contacts: units, ranges and meanings, written once.

An object stands on point supports under a rigid plate. Where no more is given, its inertia is that
of a uniform plate in the shape of its outline, and its supports share the load like springs of
equal stiffness.
"""

import dataclasses
import functools
import math
from typing import Any, get_args, Literal

import numpy as np
from push_model.geometry import BoolArray, convex_hull, Coordinates, FloatArray, Polygon
from push_model.quantity import (
    check, INFINITY, MAX_EXTENT, MAX_HEIGHT, MIN_RADIUS, quantity, RADII,
)


# Standard acceleration of free fall, to the digits that friction coefficients deserve [m/s^2].
GRAVITY = 9.81
# Chosen: given load fractions may put the mass centre off by this fraction of the supports'
# extent, as weighed ones do.
BALANCE_TOLERANCE = 0.01
# Weight of the balance against the spread of the loads in the first, rough solution. Chosen: large
# enough that supports without load are told from others, and well below 1e8, where the squared
# problem loses all digits of the spread.
BALANCE_STIFFNESS = 1e5
# Distance of supports from the origin over that of the outline beyond which a unit is mistaken;
# chosen: beyond legs that stand apart.
MAX_SUPPORT_RATIO = 5.0
# Radius of gyration over the greatest distance of the outline from the origin: (least, greatest)
# that are no mistake of a unit; chosen: a mass in the middle, and one beside the outline.
GYRATION_RATIOS = 0.05, 5.0
# Longest dead time that is no mistake of a unit [s]; chosen: no robot pushes with so much.
MAX_DEAD_TIME = 1.0
# Track over radius where no track is stated, and track of a point or a flat pusher [m]: those of
# the bases in config/robots.
TRACK_RATIO = 1.35
DEFAULT_TRACK = 0.23

# Kinematics of a base, and features of an outline that can be touched.
Drive = Literal['differential', 'holonomic']
DRIVES: tuple[Drive, ...] = get_args(Drive)
ContactKind = Literal['vertex', 'face', 'round']
CONTACT_KINDS: tuple[ContactKind, ...] = get_args(ContactKind)
# Vertices of a convex hull that an error lists, at most; chosen: as fits some lines.
MAX_NAMED_VERTICES = 12
# Vertices (x, y) of a convex polygon, counter-clockwise [m]; empty for a disc.
Outline = tuple[tuple[float, float], ...]


@dataclasses.dataclass(frozen=True)
class Support:
    """A support point of the object: its position, its load and its friction."""

    x: float = quantity('x in the object frame', 'm', is_basic=True)
    y: float = quantity('y in the object frame', 'm', is_basic=True)
    friction_coefficient: float = quantity('Coulomb friction on the floor', '', 0.0, 10.0,
                                           is_basic=True)
    load_fraction: float = quantity('share of the weight; all 0: from the mass centre', '', 0.0,
                                    default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class PushedObject:
    """
    A rigid object with a flat base on point supports.

    Its outline is a convex polygon, or a disc about the frame's origin when ``outline`` is empty;
    supports stand anywhere. An ``inertia`` of 0 is replaced at construction by that of the shape.
    """

    mass: float = quantity('mass', 'kg', above=0.0, high=1000.0, is_basic=True)
    inertia: float = quantity('yaw inertia about the mass centre; 0: uniform plate', 'kg m^2', 0.0,
                              default=0.0)
    supports: tuple[Support, ...] = quantity('supports that carry the object', default=())
    outline: Outline = quantity('convex vertices (x, y), counter-clockwise; empty: disc', 'm',
                                is_basic=True, default=())
    radius: float = quantity('radius of a disc; 0: polygon', 'm', 0.0, is_basic=True, default=0.0)
    center_of_mass: tuple[float, float] = quantity('(x, y) in the object frame', 'm',
                                                   default=(0.0, 0.0))
    contact_friction_coefficient: float = quantity('Coulomb friction between outline and robot',
                                                   '', 0.0, 10.0, is_basic=True, default=0.5)
    contact_height: float = quantity('height of the contact; with both heights 0 no load shifts',
                                     'm', 0.0, MAX_HEIGHT, default=0.0)
    center_of_mass_height: float = quantity('height of the mass centre', 'm', 0.0, MAX_HEIGHT,
                                            default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields and the shape."""
        check(self)
        if not self.supports:
            raise ValueError('PushedObject.supports: got none, expected at least one Support')
        supports: tuple[Any, ...] = self.supports
        for support in supports:
            if not isinstance(support, Support):
                raise ValueError(f'PushedObject.supports: got {support!r}, expected a Support')
        if not _is_point(self.center_of_mass):
            raise ValueError(f'PushedObject.center_of_mass: got {self.center_of_mass!r}, '
                             'expected two numbers (x, y) [m]')
        if bool(self.outline) == bool(self.radius):
            raise ValueError(f'PushedObject.outline: got {len(self.outline)} vertices and radius '
                             f'{self.radius:g}, expected vertices or a radius, not both')
        if self.outline:
            _check_convex(self.outline)
        self._check_size()
        if self.inertia == 0.0:
            object.__setattr__(self, 'inertia',
                               plate_inertia(self.mass, self.outline, self.radius))
        if not self.inertia > 0.0:
            raise ValueError(f'PushedObject.mass: got {self.mass:g} kg, expected one with which '
                             'the moment of inertia is above 0')
        self._check_inertia()
        # Refuses supports that do not balance the object.
        _support_load_fractions(self.supports, self.center_of_mass)

    def _check_size(self) -> None:
        """Refuse what must be a mistake of a unit."""
        extent = self._extent
        if not MIN_RADIUS <= extent <= MAX_EXTENT:
            raise ValueError(f'PushedObject.outline: got a point {extent:g} m from the origin, '
                             f'expected the farthest at {MIN_RADIUS:g} to {MAX_EXTENT:g} m '
                             '(lengths are in metres)')
        for support in self.supports:
            away = math.hypot(support.x, support.y)
            if away > MAX_SUPPORT_RATIO * extent:
                raise ValueError(f'PushedObject.supports: got one {away:g} m from the origin of '
                                 f'an object that reaches {extent:g} m, expected at most '
                                 f'{MAX_SUPPORT_RATIO:g} times as much (lengths are in metres)')

    def _check_inertia(self) -> None:
        """Refuse a moment of inertia that no such body has."""
        unit = self.mass * self._extent ** 2
        least, most = (ratio ** 2 * unit for ratio in GYRATION_RATIOS)
        if not least <= self.inertia <= most:
            # Rounded by less than the range is narrowed: both ends are accepted.
            raise ValueError(f'PushedObject.inertia: got {self.inertia:g}, expected from '
                             f'{1.001 * least:.4g} to {0.999 * most:.4g} for this mass and '
                             'outline, or 0 [kg m^2]')

    @property
    def _extent(self) -> float:
        """Greatest distance of the outline from the origin [m]."""
        return max((math.hypot(*vertex) for vertex in self.outline), default=self.radius)

    @functools.cached_property
    def weight_fractions(self) -> tuple[float, ...]:
        """Fraction of the weight on each support, shape (k,); they sum up to 1."""
        return _support_load_fractions(self.supports, self.center_of_mass)

    @functools.cached_property
    def loads(self) -> tuple[float, ...]:
        """Normal load on each support [N], shape (k,); they balance about the mass centre."""
        return tuple(self.mass * GRAVITY * fraction for fraction in self.weight_fractions)

    @functools.cached_property
    def size(self) -> float:
        """Greatest distance between two points of the outline [m]."""
        return max((math.dist(a, b) for a in self.outline for b in self.outline),
                   default=2.0 * self.radius)

    @functools.cached_property
    def capacities(self) -> tuple[float, ...]:
        """Friction capacity ``q_i = mu_i N_i`` of each support [N], shape (k,)."""
        return tuple(support.friction_coefficient * load
                     for support, load in zip(self.supports, self.loads))


@dataclasses.dataclass(frozen=True)
class RoundRobot:
    """
    A disc-shaped mobile base and the limits of its drive.

    A radius of 0 is a point. An infinite one is a flat pusher, a straight edge through the robot's
    position that faces along its heading.
    """

    radius: float = quantity('5 mm to 5 m; 0: a point; infinite: a flat pusher', 'm', 0.0,
                             infinite=True, plausible=RADII, is_basic=True)
    drive: Drive = quantity('kinematics of the base', choices=DRIVES, is_basic=True,
                            default='differential')
    max_speed: float = quantity('speed limit', 'm/s', above=0.0, high=10.0, is_basic=True,
                                default=0.5)
    max_yaw_rate: float = quantity('yaw rate limit', 'rad/s', above=0.0, high=50.0, default=2.0)
    max_acceleration: float = quantity('acceleration limit', 'm/s^2', above=0.0, high=100.0,
                                       default=1.0)
    max_yaw_acceleration: float = quantity('yaw acceleration limit', 'rad/s^2', 1e-3, 1000.0,
                                           default=6.0)
    time_constant: float = quantity('first-order lag from command to motion', 's', 0.0, 5.0,
                                    default=0.1)
    dead_time: float = quantity('time from a command until the base begins to follow it', 's', 0.0,
                                MAX_DEAD_TIME, default=0.0)
    min_speed: float = quantity('least speed that is not 0: of a wheel of a differential drive, '
                                'of the translation of a holonomic base', 'm/s', 0.0, 1.0,
                                default=0.0)
    min_yaw_rate: float = quantity('least yaw rate of a holonomic base that is not 0', 'rad/s',
                                   0.0, 5.0, default=0.0)
    speed_step: float = quantity('step to which the base rounds speeds, of wheels or of the '
                                 'translation of a holonomic base; 0: none', 'm/s', 0.0, 0.5,
                                 default=0.0)
    track: float = quantity('distance between the wheels of a differential drive; 0: 1.35 times '
                            'the radius', 'm', 0.0, 10.0, default=0.0)
    max_push_force: float = quantity('force with which the robot pushes before its wheels spin',
                                     'N', above=0.0, infinite=True, default=INFINITY)
    identify_base: bool = quantity('whether dead time, least speeds and accelerations are '
                                   'learned from the motion; else they are as stated',
                                   default=True)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    @property
    def wheel_track(self) -> float:
        """Distance between the wheels, as stated or by the radius [m]."""
        if self.track > 0.0:
            return self.track
        is_disc = 0.0 < self.radius < math.inf
        return TRACK_RATIO * self.radius if is_disc else DEFAULT_TRACK


@dataclasses.dataclass(frozen=True)
class Contact:
    """Contact of the robot with the object's outline."""

    kind: ContactKind = quantity('feature that is touched', choices=CONTACT_KINDS)
    index: int = quantity('vertex number, or face number (face i runs from vertex i to i + 1); '
                          '0 for a round outline', '', 0, default=0)
    offset: float = quantity('on a face: distance of the contact from the midpoint, to the left '
                             'as the robot looks at it; on a round outline: angle of the contact '
                             'in the object frame; 0 at a vertex', 'm or rad', default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)


def plate_inertia(mass: float, outline: Polygon, radius: float = 0.0) -> float:
    """
    Moment of inertia about the vertical axis through the mass centre [kg m^2].

    That of a uniform plate in the shape of the outline, about its centroid. It is also taken where
    the mass centre is elsewhere: what moves it is thought to be spread out as far as the plate.
    The plate is cut into triangles (o, a, b) between a point o inside and the edges ab:

        A = sum A_k,   A c = sum A_k (a + b) / 3,   J = sum A_k (a.a + a.b + b.b) / 6
        I = m (J / A - |c|^2)

    :param mass: m [kg].
    :param outline: vertices (x, y) of a polygon, counter-clockwise [m]; empty for a disc.
    :param radius: of the disc [m].
    :return: inertia I [kg m^2].
    """
    if not outline:
        return 0.5 * mass * radius ** 2
    count = len(outline)
    o_x, o_y = sum(x for x, _ in outline) / count, sum(y for _, y in outline) / count
    area, first_x, first_y, second = 0.0, 0.0, 0.0, 0.0
    for i, (x, y) in enumerate(outline):
        a_x, a_y = outline[i - 1][0] - o_x, outline[i - 1][1] - o_y
        b_x, b_y = x - o_x, y - o_y
        triangle = 0.5 * (a_x * b_y - a_y * b_x)
        area += triangle
        first_x += triangle * (a_x + b_x) / 3.0
        first_y += triangle * (a_y + b_y) / 3.0
        second += triangle * (a_x * a_x + a_x * b_x + b_x * b_x
                              + a_y * a_y + a_y * b_y + b_y * b_y) / 6.0
    return mass * (second / area - (first_x / area) ** 2 - (first_y / area) ** 2)


def load_fractions(points: Any, fractions: Any, center: Coordinates) -> tuple[float, ...]:
    """
    Fraction of the weight on each support.

    :param points: positions of the supports, shape (k, 2) [m].
    :param fractions: relative fractions, one per support; all 0 where none are given.
    :param center: mass centre (x, y) [m], same frame.
    :return: tuple of k fractions that sum up to 1.
    :raises ValueError: where the object would tip, where given fractions do not balance it, or
        where only some are given; the text has no name in front.
    """
    points, fractions, center = (np.array(v, dtype=float) for v in (points, fractions, center))
    extent = max(float(np.abs(points - center).max()), 1e-9)
    balanced = _spring_loads((points - center) / extent)
    if balanced is None:
        raise ValueError(f'got a mass centre at ({center[0]:g}, {center[1]:g}), expected it '
                         'inside the hull of the supports: the object would tip')
    if fractions.any() and not fractions.all():
        raise ValueError(f'got load fractions {fractions.tolist()}, expected one above 0 for '
                         'every support, or none')
    fractions = fractions / fractions.sum() if fractions.any() else balanced
    pressure = fractions @ points
    if np.abs(pressure - center).max() > BALANCE_TOLERANCE * extent:
        raise ValueError(f'got load fractions that balance about ({pressure[0]:.4g}, '
                         f'{pressure[1]:.4g}), expected about the mass centre ({center[0]:g}, '
                         f'{center[1]:g}): change either, or give no fractions')
    # Where statics leave no choice, rounded fractions do not count.
    return tuple((balanced if _is_determinate(points) else fractions).tolist())


def _is_determinate(points: FloatArray) -> bool:
    rank = np.linalg.matrix_rank(np.column_stack([np.ones(len(points)), points]))
    return bool(rank == len(points))


def _spring_loads(points: FloatArray) -> FloatArray | None:
    """
    Load fractions of springs of equal stiffness under a rigid plate, or None where it tips.

    These are the least squares of the loads w >= 0 among all that balance about the origin,
    ``sum w = 1, sum w s = 0``.
    """
    balance = np.vstack([np.ones(len(points)), points.T])
    totals = np.array([1.0, 0.0, 0.0])
    loads = np.linalg.lstsq(balance, totals, rcond=None)[0]
    if loads.min() < 0.0:
        # A support without load is allowed: a mass centre on the edge of the hull is at the limit.
        carrying = _carrying_supports(balance, totals)
        loads = np.zeros(len(points))
        loads[carrying] = np.linalg.lstsq(balance[:, carrying], totals, rcond=None)[0]
    balances = np.abs(balance @ loads - totals).max() < 1e-6 and loads.min() > -1e-6
    return np.maximum(loads, 0.0) if balances else None


def _carrying_supports(balance: FloatArray, totals: FloatArray) -> BoolArray:
    # Imported here: most objects stand on all their supports, and most programs, such as a node
    # that starts, need nothing else of scipy.
    from scipy.optimize import nnls
    count = balance.shape[1]
    rough, _ = nnls(np.vstack([BALANCE_STIFFNESS * balance, np.eye(count)]),
                    np.concatenate([BALANCE_STIFFNESS * totals, np.zeros(count)]))
    return rough > 1e-9


# Kept, as variations of an object mostly stand on the same supports; 256 such sets take few kB.
@functools.lru_cache(maxsize=256)
def _support_load_fractions(supports: tuple[Support, ...],
                            center_of_mass: tuple[float, float]) -> tuple[float, ...]:
    try:
        return load_fractions([(support.x, support.y) for support in supports],
                              [support.load_fraction for support in supports], center_of_mass)
    except ValueError as error:
        raise ValueError(f'PushedObject.supports: {error}') from error


def _is_point(value: Any) -> bool:
    return (isinstance(value, tuple) and len(value) == 2
            and all(isinstance(coordinate, float) for coordinate in value))


# Kept for the same reason as the load fractions.
@functools.lru_cache(maxsize=256)
def _hull_text(outline: Outline) -> str:
    """Offer what a robot touches of an outline that is not convex."""
    hull = convex_hull(outline)
    if len(hull) > MAX_NAMED_VERTICES:
        return f'such as its hull of {len(hull)} vertices, push_model.convex_hull(outline)'
    return f'such as its hull {[list(vertex) for vertex in hull]}'


def _check_convex(outline: tuple[Any, ...]) -> None:
    for vertex in outline:
        if not _is_point(vertex):
            raise ValueError(f'PushedObject.outline: got vertex {vertex!r}, expected (x, y) [m]')
    if len(outline) < 3:
        raise ValueError(f'PushedObject.outline: got {len(outline)} vertices, expected 3 or more')
    rotation = 0.0
    for i, (x, y) in enumerate(outline):
        x0, y0 = outline[i - 1]
        x1, y1 = outline[(i + 1) % len(outline)]
        cross = (x - x0) * (y1 - y) - (y - y0) * (x1 - x)
        dot = (x - x0) * (x1 - x) + (y - y0) * (y1 - y)
        if cross <= 0.0:
            raise ValueError('PushedObject.outline: got an exterior angle of '
                             f'{math.atan2(cross, dot):.3g} rad at vertex {i}, expected a convex '
                             f'outline, counter-clockwise, {_hull_text(outline)}')
        rotation += math.atan2(cross, dot)
    if abs(rotation - 2 * math.pi) > 1e-6:
        raise ValueError('PushedObject.outline: got edges that cross, expected a convex outline, '
                         + _hull_text(outline))
