"""What the robot keeps between moves: its place, and what it learned of each object."""

from push_control.perception.object_knowledge import ObjectKnowledge
from push_control.perception.raw_perception import RawPerception
from push_control.supervision_settings import SupervisionSettings
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose


class RobotMemory:
    """
    Place of the robot in the world, and knowledge of objects by name.

    :param settings: ``SupervisionSettings``, for how fast knowledge gets uncertain.
    """

    def __init__(self, settings: SupervisionSettings) -> None:
        self._settings = settings
        self._perception: RawPerception | None = None
        # When an object was known so [s], and what.
        self._known: dict[str, tuple[float, ObjectKnowledge]] = {}

    @property
    def robot_pose(self) -> Pose | None:
        """Estimated ``Pose`` of the robot; None before the first move."""
        perception = self._perception
        return perception.robot_pose if perception and perception.is_localized else None

    def recall(self, name: str, time: float) -> ObjectKnowledge | None:
        """
        Return what is known of an object by now; None where it was not pushed yet.

        :param name: of the object.
        :param time: now [s].
        """
        if name not in self._known:
            return None
        known_at, knowledge = self._known[name]
        return knowledge.aged(time - known_at, self._settings.center_walk,
                              self._settings.contact_friction_walk)

    def take_over(self, supervisor: Supervisor) -> None:
        """Let another supervisor start with the robot where it was localized."""
        if self._perception is not None:
            supervisor.perception.take_over_robot(self._perception)

    def keep(self, name: str, supervisor: Supervisor, time: float) -> None:
        """
        Keep what a supervisor knows at the end of its move.

        :param name: of the object.
        :param time: now [s].
        """
        self._perception = supervisor.perception
        knowledge = supervisor.perception.knowledge
        if knowledge is not None:
            self._known[name] = time, knowledge
