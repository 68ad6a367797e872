"""Values that are meant in another unit are refused, and the error names the field."""

import dataclasses
import math
from typing import Any

from helpers.objects import box
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.files.flat_values import from_parameter_values
from push_model.files.mapping import from_mapping, Location
from push_model.parameters import RoundRobot
from push_navigation.settings import DriveSettings
from push_planner.settings import PlannerSettings
from push_ros.node_settings import ControllerOptions, SimOptions
from push_sim_node.disturbance import ObjectDisplacement
from push_sim_node.sensors import SensorSettings
import pytest

THOUSANDTH, THOUSAND = 1e-3, 1e3
DEGREES = math.degrees(1.0)
ROBOT = RoundRobot(radius=0.17)
CONTROL = ControlSettings()
TASK = SupervisionSettings()
DRIVE = DriveSettings()
PLANNER = PlannerSettings()
# An instance, its fields of this unit, and factors by which mistaken units change them.
CASES = [
    (ROBOT, 'max_speed', (THOUSANDTH, THOUSAND)),
    (ROBOT, 'max_yaw_rate', (THOUSANDTH, THOUSAND, DEGREES)),
    (ROBOT, 'max_acceleration', (THOUSANDTH, THOUSAND)),
    (DRIVE, 'speed acceleration clearance standoff retreat_distance', (THOUSANDTH, THOUSAND)),
    (DRIVE, 'yaw_rate yaw_acceleration', (THOUSANDTH, THOUSAND, DEGREES)),
    (PLANNER, 'pushing_speed straight_speed end_speed', (THOUSANDTH, THOUSAND)),
    (PLANNER, 'max_angle_rate', (THOUSANDTH, THOUSAND, DEGREES)),
    (PLANNER, 'max_pushing_angle heading_tolerance', (THOUSAND, DEGREES)),
    (CONTROL, 'pose_timeout odometry_timeout start_speed acceleration deceleration '
     'position_tolerance start_tolerance pose_noise', (THOUSANDTH, THOUSAND)),
    (CONTROL, 'heading_tolerance heading_noise', (THOUSANDTH, THOUSAND, DEGREES)),
    (TASK, 'position_tolerance moved_distance probe_distance max_path_deviation plan_timeout '
     'stall_timeout', (THOUSANDTH, THOUSAND)),
    (TASK, 'moved_angle', (THOUSANDTH, THOUSAND, DEGREES)),
    (TASK, 'heading_tolerance', (THOUSAND, DEGREES)),
    (ControllerOptions(), 'watchdog_timeout', (THOUSANDTH, THOUSAND)),
    (SensorSettings(), 'pose_rate odometry_rate', (THOUSANDTH, THOUSAND)),
]


@pytest.mark.parametrize('instance, names, factors', CASES, ids=lambda value: type(value).__name__)
def test_a_value_in_another_unit_is_refused_by_name(instance: Any, names: str,
                                                    factors: tuple[float, ...]) -> None:
    for name in names.split():
        for factor in factors:
            value = factor * getattr(instance, name)
            with pytest.raises(ValueError, match=f'{name}: got {value!r}, expected'):
                dataclasses.replace(instance, **{name: value})


@pytest.mark.parametrize('change, field', [
    ({'mass': 4500.0}, 'mass'),
    ({'mass': 0.001}, 'mass'),
    ({'contact_height': 150.0, 'center_of_mass_height': 0.2}, 'contact_height'),
    ({'contact_height': 0.1, 'center_of_mass_height': 200.0}, 'center_of_mass_height'),
    # In kg cm^2 and in kg m^2 times a thousandth.
    ({'inertia': 1e4 * box().inertia}, 'inertia'),
    ({'inertia': 1e-3 * box().inertia}, 'inertia'),
    ({'outline': tuple((1e3 * x, 1e3 * y) for x, y in box().outline)}, 'outline'),
    ({'outline': tuple((1e-3 * x, 1e-3 * y) for x, y in box().outline)}, 'outline')])
def test_an_object_in_other_units_is_refused_by_name(change: dict[str, Any], field: str) -> None:
    with pytest.raises(ValueError, match=f'PushedObject.{field}: got'):
        dataclasses.replace(box(), **change)


def test_small_and_large_robots_and_objects_are_plausible() -> None:
    """Robots of 0.05 to 1 m, objects of 0.01 to 500 kg."""
    for size, mass in ((0.05, 0.01), (3.0, 500.0)):
        ratio = size / box().size
        outline = tuple((ratio * x, ratio * y) for x, y in box().outline)
        supports = tuple(dataclasses.replace(support, x=ratio * support.x, y=ratio * support.y)
                         for support in box().supports)
        scaled = dataclasses.replace(box(), mass=mass, inertia=0.0, outline=outline,
                                     supports=supports)
        assert scaled.size == pytest.approx(size)
    for radius in (0.025, 0.5):
        assert RoundRobot(radius, max_speed=0.05).radius == radius


@pytest.mark.parametrize('radius', [170.0, 17.0, 0.17e-3])
def test_a_robot_in_other_units_is_refused_in_files_and_parameters(radius: float) -> None:
    with pytest.raises(ValueError, match=r'robot\.radius: got .* from 0.005 to 5 \[m\]'):
        from_parameter_values(RoundRobot, {'robot.radius': radius}, 'robot.')
    with pytest.raises(ValueError, match='robot.yaml: radius: got'):
        from_mapping(RoundRobot, {'radius': radius}, Location('robot.yaml'))


@pytest.mark.parametrize('radius', [0.0, 0.025, 0.5, math.inf])
def test_points_flat_pushers_and_robots_are_read(radius: float) -> None:
    assert from_mapping(RoundRobot, {'radius': radius}, Location('robot.yaml')).radius == radius


def test_headings_in_degrees_are_refused() -> None:
    with pytest.raises(ValueError, match='object_start: .* radians'):
        SimOptions(object_start=(0.0, 0.0, 90.0))
    with pytest.raises(ValueError, match='robot_start: .* radians'):
        SimOptions(robot_start=(0.0, 0.0, 90.0))
    with pytest.raises(ValueError, match='theta: got 90'):
        ObjectDisplacement(1.0, theta=90.0)
