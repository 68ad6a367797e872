"""Settings of the simulation: accuracy of the plant, and what disturbs it."""

import dataclasses

from push_dynamics.encoding import WALL_FRICTION
from push_dynamics.floor import FloorPatch
from push_dynamics.walls import Wall
from push_model.quantity import check, quantity
from push_sim_node.disturbance import FrictionChange, ObjectDisplacement
from push_sim_node.drive_imperfections import DriveImperfections


@dataclasses.dataclass(frozen=True)
class SimulationSettings:
    """Settings of the simulated plant, and its disturbances."""

    step: float = quantity('longest step of the plant', 's', 1e-5, 0.05, default=2e-3)
    friction_smoothing: float = quantity('speed below which support friction turns viscous',
                                         'm/s', 1e-9, 1e-2, default=1e-5)
    contact_creep: float = quantity('slip of a sticking contact per distance, at the friction '
                                    'limit', '', 0.0, 0.5, default=0.0)
    command_timeout: float = quantity('simulated time without commands before a stop', 's',
                                      above=0.0, high=60.0, default=0.5)
    seed: int = quantity('seed of all random errors', '', 0, default=0)
    friction_changes: tuple[FrictionChange, ...] = quantity('intervals of other support friction',
                                                            default=())
    floor_patches: tuple[FloorPatch, ...] = quantity('places of other support friction',
                                                     default=())
    walls: tuple[Wall, ...] = quantity('walls that stop object and robot', default=())
    wall_friction: float = quantity('friction coefficient between walls and what touches them',
                                    '', 0.0, 2.0, default=WALL_FRICTION)
    object_displacements: tuple[ObjectDisplacement, ...] = quantity(
        'displacements of the object by a person', default=())
    drive: DriveImperfections = DriveImperfections()

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        for name, kind in (('friction_changes', FrictionChange), ('floor_patches', FloorPatch),
                           ('walls', Wall),
                           ('object_displacements', ObjectDisplacement)):
            for item in getattr(self, name):
                if not isinstance(item, kind):
                    raise ValueError(f'SimulationSettings.{name}: got {item!r}, expected a '
                                     f'{kind.__name__}')
