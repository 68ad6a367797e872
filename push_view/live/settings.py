"""What a live session lets its user choose and change."""

import dataclasses
import math
from typing import NamedTuple

from push_model.parameters import PushedObject
from push_sim_node.sensors import SensorSettings
from push_view.messages import Message
from push_view.server.commands import CommandRefused

CONTACT_FRICTION = 'contact_friction'
FRICTION = 'friction.'


class Setting(NamedTuple):
    """
    A number that can be changed under way, and how it is shown.

    :param name: of the setting; of sensors, that of the field of ``SensorSettings``.
    :param label: what it is called on the page.
    :param low: least value, SI units.
    :param high: greatest value.
    :param unit: in which the page shows it.
    :param factor: from SI units to that unit.
    """

    name: str
    label: str
    low: float
    high: float
    unit: str = ''
    factor: float = 1.0

    def to_message(self, value: float) -> Message:
        """
        Describe it with its present value.

        :param value: SI units.
        """
        return {**self._asdict(), 'value': value}


# Ranges are chosen: from perfect to worse than what the package is made for.
SENSOR_SETTINGS = (
    Setting('pose_noise', 'noise of poses', 0.0, 0.01, 'mm', 1e3),
    Setting('pose_heading_noise', 'noise of headings', 0.0, math.radians(2.0), '°',
            math.degrees(1.0)),
    Setting('pose_latency', 'latency of poses', 0.0, 0.3, 'ms', 1e3),
    Setting('pose_drop_probability', 'lost poses', 0.0, 0.5, '%', 1e2),
    Setting('odometry_scale', 'error of distances', 0.0, 0.1, '%', 1e2),
    Setting('odometry_yaw_scale', 'error of rotations', 0.0, 0.05, '%', 1e2),
    Setting('odometry_heading_drift', 'drift of the heading', 0.0, math.radians(5.0), '°/m',
            math.degrees(1.0)),
)


def friction_settings(obj: PushedObject) -> tuple[Setting, ...]:
    """List the true friction that can be changed."""
    feet = tuple(Setting(f'{FRICTION}{i}', f'true friction of foot {i + 1}', 0.05, 1.0)
                 for i in range(len(obj.supports)))
    return (*feet, Setting(CONTACT_FRICTION, 'true friction of the contact', 0.0, 1.2))


def find_setting(obj: PushedObject, name: str, value: float) -> Setting:
    """
    Look a setting up, and check a value for it.

    :param name: of the setting.
    :param value: SI units.
    :raises CommandRefused: where there is none, or the value is out of its range.
    """
    known = {setting.name: setting for setting in (*friction_settings(obj), *SENSOR_SETTINGS)}
    if name not in known:
        raise CommandRefused(f'set.name: got {name[:60]!r}, expected one of ' + ', '.join(known))
    setting = known[name]
    if not setting.low <= value <= setting.high:
        raise CommandRefused(f'set.value: got {value:g}, expected {setting.low:g} to '
                             f'{setting.high:g} for {name}')
    return setting


def with_friction(obj: PushedObject, name: str, value: float) -> PushedObject:
    """
    Change one friction coefficient of an object.

    :param name: of one of ``friction_settings``.
    :param value: the coefficient.
    """
    if name == CONTACT_FRICTION:
        return dataclasses.replace(obj, contact_friction_coefficient=value)
    index = int(name.removeprefix(FRICTION))
    supports = tuple(dataclasses.replace(support, friction_coefficient=value)
                     if i == index else support for i, support in enumerate(obj.supports))
    return dataclasses.replace(obj, supports=supports)


def setting_values(obj: PushedObject, sensors: SensorSettings) -> dict[str, float]:
    """List the values of all settings by name, SI units."""
    friction = [*(support.friction_coefficient for support in obj.supports),
                obj.contact_friction_coefficient]
    return {**{setting.name: value for setting, value in zip(friction_settings(obj), friction)},
            **{setting.name: getattr(sensors, setting.name) for setting in SENSOR_SETTINGS}}


def setting_messages(obj: PushedObject, sensors: SensorSettings) -> list[Message]:
    """Describe all settings with their values."""
    values = setting_values(obj, sensors)
    return [setting.to_message(values[setting.name])
            for setting in (*friction_settings(obj), *SENSOR_SETTINGS)]
