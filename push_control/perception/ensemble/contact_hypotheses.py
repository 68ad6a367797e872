"""
Hypotheses of a contact: as stated, with little friction, or pushed by wheels that creep.

At first contact the ensemble is forked. One fork has a low contact friction (``slip_detector``),
one has wheels that creep (``wheel_creep``). All follow the same measurements, and the likelihood
of the object poses decides which one is kept (``hypothesis_odds``). Wheels are said to creep only
where nothing else explains the poses as well.
"""

from typing import NamedTuple, Sequence

from push_control.perception.ensemble.ensemble_reading import EnsembleReading
from push_control.perception.ensemble.ensemble_state import RobotMemory
from push_control.perception.ensemble.hypothesis_odds import HypothesisTest, Verdict
from push_control.perception.ensemble.measurement_update import COUPLING_TIME
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_control.perception.ensemble.slip_detector import SlipDetector, slippery_friction
from push_control.perception.object_knowledge import ObjectKnowledge
from push_dynamics.walls import Wall
from push_model.geometry import FloatArray, Pose
from push_model.signals import ObjectPose, Odometry


class _Alternative(NamedTuple):
    """An ensemble in which a hypothesis holds, and the test of that."""

    ensemble: PushEnsemble
    test: HypothesisTest


class ContactHypotheses(EnsembleReading):
    """
    Follows a contact as stated and others that may be, and reads as the one that is kept.

    What is inferred of the robot by other means than measurements holds for the stated contact
    alone: it ends the comparison until the next contact.
    """

    def __init__(self, ensemble: PushEnsemble) -> None:
        """
        Start with one hypothesis.

        :param ensemble: the ``PushEnsemble`` of the contact as stated; no one else changes it.
        """
        super().__init__(ensemble._state)
        self._ensemble = ensemble
        self._slip_detector = SlipDetector()
        self._creep_test = HypothesisTest()
        self._alternatives: list[_Alternative] = []

    @property
    def is_undecided(self) -> bool:
        """Tell whether a slippery contact is followed besides."""
        return any(alternative.test is self._slip_detector for alternative in self._alternatives)

    # Measurements, which all hypotheses follow.

    def predict(self, odometry: Odometry, step: Pose | None = None) -> None:
        """
        Move the members of all hypotheses by odometry.

        :param odometry: as of ``PushEnsemble.predict``.
        :param step: likewise.
        """
        for alternative in self._alternatives:
            alternative.ensemble.predict(odometry, step)
        if not self._ensemble.predict(odometry, step):
            return
        time_since_contact = self._ensemble.time_since_contact
        if time_since_contact == 0.0:
            self._fork()
        elif time_since_contact > COUPLING_TIME and not self._ensemble.has_unseen_contact:
            self._decide_after_contact()

    def update(self, measured: ObjectPose) -> bool:
        """
        Correct all hypotheses by a measured object pose, and compare them.

        :param measured: as of ``PushEnsemble.update``.
        :return: whether the estimate of the hypothesis that is read from now on includes it.
        """
        is_accepted = self._ensemble.update(measured)
        are_accepted = [each.ensemble.update(measured) for each in self._alternatives]
        for alternative, is_accepted_there in zip(list(self._alternatives), are_accepted):
            verdict = alternative.test.evaluate(self._log_likelihood_ratio(alternative))
            if self._follow(alternative, verdict):
                return is_accepted_there
        return is_accepted

    def update_robot(self, pose: Pose, covariance: FloatArray) -> None:
        """
        Correct all hypotheses by a measured pose of the robot.

        :param pose: as of ``PushEnsemble.update_robot``.
        :param covariance: likewise.
        """
        for alternative in self._alternatives:
            alternative.ensemble.update_robot(pose, covariance)
        self._ensemble.update_robot(pose, covariance)

    def update_place(self, pose: Pose, covariance: FloatArray) -> None:
        """
        Correct all hypotheses by the place of the robot in a map.

        :param pose: as of ``PushEnsemble.update_place``.
        :param covariance: likewise.
        """
        for alternative in self._alternatives:
            alternative.ensemble.update_place(pose, covariance)
        self._ensemble.update_place(pose, covariance)

    def contradicts(self, pose: Pose, covariance: FloatArray) -> bool:
        """
        Tell whether a measured pose of the robot is one that the estimate does not explain.

        :param pose: as of ``PushEnsemble.contradicts``.
        :param covariance: likewise.
        """
        return self._ensemble.contradicts(pose, covariance)

    def set_walls(self, walls: Sequence[Wall], errors: FloatArray | None = None) -> None:
        """
        Let walls stop object and robot in all hypotheses from now on.

        :param walls: none for open floor.
        :param errors: as of ``Members.set_walls``.
        """
        for alternative in self._alternatives:
            alternative.ensemble.members.set_walls(walls, errors)
        self._ensemble.members.set_walls(walls, errors)

    @property
    def time_since_contact(self) -> float:
        """Time from the last contact to the last odometry [s]; infinite before either."""
        return self._ensemble.time_since_contact

    # Inferences, which end the comparison.

    def update_along(self, direction: float, error: float, deviation: float,
                     is_certain: bool = True) -> None:
        """
        Correct the robot's pose by an error along one direction, as by a contact.

        :param direction: as of ``PushEnsemble.update_along``.
        :param error: likewise.
        :param deviation: likewise.
        :param is_certain: likewise.
        """
        self._alternatives.clear()
        self._ensemble.update_along(direction, error, deviation, is_certain)

    def inflate_covariance(self, deviation: float, heading_deviation: float = 0.0) -> None:
        """
        Make the robot's pose less certain, as after a search without success.

        :param deviation: standard deviation of x and of y that is added [m].
        :param heading_deviation: standard deviation of the heading that is added [rad].
        """
        self._alternatives.clear()
        self._ensemble.inflate_covariance(deviation, heading_deviation)

    def place_robot(self, pose: Pose, deviations: Sequence[float]) -> None:
        """
        Replace the estimate of the robot's pose.

        :param pose: its ``Pose``, about.
        :param deviations: standard deviations of x, y [m] and heading [rad].
        """
        self._alternatives.clear()
        self._ensemble.place_robot(pose, deviations)

    def restore_robot(self, memory: RobotMemory, deviation: float,
                      heading_deviation: float) -> None:
        """
        Return to an earlier estimate of the robot, moved by odometry since.

        :param deviation: standard deviation of x and of y that is added [m].
        :param heading_deviation: standard deviation of the heading that is added [rad].
        """
        self._alternatives.clear()
        self._ensemble.restore_robot(memory, deviation, heading_deviation)

    def take_over_robot(self, previous: EnsembleReading) -> None:
        """
        Start with the robot as it was estimated with another object.

        :param previous: that estimate; nothing is taken before its first odometry.
        """
        self._alternatives.clear()
        self._ensemble.take_over_robot(previous)

    def start_from(self, knowledge: ObjectKnowledge) -> None:
        """
        Start from what was learned of the object before.

        :param knowledge: ``ObjectKnowledge``, as it is by now.
        """
        self._ensemble.start_from(knowledge)

    # Comparison.

    def _fork(self) -> None:
        """Fork the hypotheses that are open at first contact."""
        if not self.has_object or not self._state.knows_contact:
            return
        nominal = self.members.obj.contact_friction_coefficient
        friction = self.members.parameters[:, -1]
        if not self._is_followed(self._slip_detector) and self._slip_detector.is_needed(
                nominal, friction):
            self._follow_too(self._slip_detector).set_contact_friction(
                slippery_friction(nominal, friction))
        if not self._is_followed(self._creep_test) and self._may_creep:
            self._follow_too(self._creep_test).let_wheels_creep()

    @property
    def _may_creep(self) -> bool:
        """Whether poses can tell that wheels creep which are taken not to."""
        return (self._creep_test.is_open and not self._state.is_relative
                and not self.members.wheel_creep.any())

    def _is_followed(self, test: HypothesisTest) -> bool:
        return any(alternative.test is test for alternative in self._alternatives)

    def _follow_too(self, test: HypothesisTest) -> PushEnsemble:
        """Follow a copy of the estimate, in which a hypothesis is to hold."""
        alternative = _Alternative(self._ensemble.fork(), test)
        self._alternatives.append(alternative)
        return alternative.ensemble

    def _log_likelihood_ratio(self, alternative: _Alternative) -> float:
        """Return the logarithm of the likelihood of a hypothesis over others, since its fork."""
        others = [self._ensemble.log_likelihood]
        if alternative.test is self._creep_test:
            others += [each.ensemble.log_likelihood for each in self._alternatives
                       if each is not alternative]
        return alternative.ensemble.log_likelihood - max(others)

    def _decide_after_contact(self) -> None:
        """Follow the likelier hypothesis once a contact is over."""
        for alternative in list(self._alternatives):
            ratio = self._log_likelihood_ratio(alternative)
            if self._follow(alternative, alternative.test.evaluate_after_contact(ratio)):
                return

    def _follow(self, alternative: _Alternative, verdict: Verdict) -> bool:
        """Do what a verdict says; return whether a hypothesis has become the estimate."""
        if verdict is Verdict.OPEN:
            return False
        self._alternatives.remove(alternative)
        if verdict is Verdict.REJECTED:
            return False
        # The others are forks of an estimate that is given up.
        self._alternatives.clear()
        self._ensemble.assign(alternative.ensemble)
        return True
