"""The floor on which robot and object move: the newest map, without their own footprints."""

from typing import Any

from push_control.ros.parameters import ControllerParameters
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import PushedObject
from push_navigation.footprint_clearing import FootprintClearing
from push_navigation.occupancy_map import OccupancyMap
from push_ros.map_reader import MapReader, ReadMap

# Why the robot stands where a map is required.
NO_MAP = 'no map has come, and map_required is true'


class LiveMap:
    """Reads maps, and clears the footprints of object and robot from them."""

    def __init__(self, parameters: ControllerParameters, *, is_needed: bool) -> None:
        """
        Start without a map.

        :param is_needed: whether the robot stands while a map cannot be used, and with
            ``map_required`` until there is one.
        """
        self._is_needed = is_needed
        self._is_required = is_needed and parameters.options.map_required
        self._map: ReadMap | None = None
        self._reader = MapReader(parameters.frames.world_frame, parameters.map)
        self._clearing = FootprintClearing(parameters.map, parameters.object, parameters.robot)

    @property
    def fault(self) -> str:
        """Why there is no map to rely on; empty where there is one, or none is needed."""
        if not self._is_needed:
            return ''
        return self._reader.fault or (NO_MAP if self.is_awaited else '')

    @property
    def is_awaited(self) -> bool:
        """Tell whether a map is needed, and none has come."""
        return self._is_required and self._map is None

    @property
    def is_busy(self) -> bool:
        """Tell whether a map is to be taken."""
        return self._reader.is_busy

    @property
    def clears_footprints(self) -> bool:
        """Tell whether footprints are cleared at all."""
        return self._clearing.is_enabled

    @property
    def occupancy_map(self) -> OccupancyMap | None:
        """The map without the footprints of object and robot."""
        return None if self._map is None else self._clearing.clear(self._map.occupancy_map,
                                                                   self._map.stamp)

    def set_object(self, obj: PushedObject) -> None:
        """Turn to another object; the previous one is an obstacle now."""
        self._clearing.set_object(obj)

    def record(self, observation: Observation) -> None:
        """Remember where object and robot are."""
        measured = observation.object_pose
        self._clearing.record(observation.time, None if measured is None else measured.pose,
                              observation.odometry.pose)

    def start(self, message: Any) -> None:
        """Start to read a map; ``take`` returns it."""
        self._reader.start(message)

    def refuse(self, reason: str) -> None:
        """
        Rely on no map until one can be used.

        :param reason: why this one cannot, one sentence.
        """
        self._reader.refuse(reason)

    def take(self) -> ReadMap | None:
        """
        Use a map that was read.

        :return: ``ReadMap``; None where there is none.
        :raises MessageRefused: where it cannot be used.
        """
        taken = self._reader.take()
        if taken is not None:
            self._map = taken
        return taken

    def move(self, correction: Pose) -> bool:
        """
        Move the map with the frame that it is in.

        :param correction: ``Pose`` that takes its previous origin to the new one,
            ``correction @ origin``.
        :return: whether there is a map.
        """
        moved = self._reader.move(correction)
        if moved is not None:
            self._map = moved
        return moved is not None
