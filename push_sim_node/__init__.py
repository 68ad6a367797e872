"""
The simulated robot and object: plant, sensors, disturbances, and a tape of what happened.

``Simulation`` lets time pass from one measurement to the next; ``Plant`` is the physics alone.
"""

from push_dynamics.floor import FloorPatch
from push_dynamics.walls import Wall
from push_sim_node.camera import CameraSettings
from push_sim_node.disturbance import FrictionChange, ObjectDisplacement
from push_sim_node.plant import Plant
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Simulation
from push_sim_node.tape import read_tape, Tape
from push_sim_node.truth import ContactMode, Energy, Truth, WallTouch

__all__ = [
    'CameraSettings', 'ContactMode', 'Energy', 'FloorPatch', 'FrictionChange',
    'ObjectDisplacement', 'Plant', 'read_tape', 'SensorSettings', 'Simulation',
    'SimulationSettings', 'Tape', 'Truth', 'Wall', 'WallTouch',
]
