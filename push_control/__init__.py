"""
Feedback control of a push, and of tasks of several pushes: measurements in, commands out.

``Controller`` follows one planned push; ``Supervisor`` brings an object to its goal with as many
pushes as that takes. Both answer an ``Observation`` with a ``Twist`` of the robot, and know
neither a clock nor ROS. The modules behind these names are imported at first use.
"""

from typing import TYPE_CHECKING

from push_model.files.lazy_names import lazy_names

if TYPE_CHECKING:
    from push_control.settings import ControlSettings
    from push_control.steered.controller import Controller
    from push_control.steered.laws.steering_law import Foresight, SteeringInput, SteeringLaw
    from push_control.supervision_settings import SupervisionSettings
    from push_control.task.supervisor import Supervisor
    from push_model.observation import Observation

__all__ = [
    'ControlSettings', 'Controller', 'Foresight', 'Observation', 'SteeringInput', 'SteeringLaw',
    'SupervisionSettings', 'Supervisor',
]

__getattr__, __dir__ = lazy_names(__name__, {
    'push_model.observation': ('Observation',),
    'push_control.steered.controller': ('Controller',),
    'push_control.steered.laws.steering_law': ('Foresight', 'SteeringInput', 'SteeringLaw'),
    'push_control.settings': ('ControlSettings',),
    'push_control.supervision_settings': ('SupervisionSettings',),
    'push_control.task.supervisor': ('Supervisor',),
})
