"""
Two hypotheses of a contact: about as rough as stated, or slippery.

At first contact the ensemble is forked. The fork has a low contact friction; both follow the same
measurements, and the likelihood of the object poses decides which one is kept (``slip_detector``).
"""

from typing import Sequence

from push_control.perception.ensemble.ensemble_reading import EnsembleReading
from push_control.perception.ensemble.ensemble_state import RobotMemory
from push_control.perception.ensemble.measurement_update import COUPLING_TIME
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_control.perception.ensemble.slip_detector import (
    SlipDetector, slippery_friction, SlipVerdict)
from push_control.perception.object_knowledge import ObjectKnowledge
from push_model.geometry import FloatArray, Pose
from push_model.signals import ObjectPose, Odometry


class ContactHypotheses(EnsembleReading):
    """
    Follows a rough and a slippery contact, and reads as the one that is kept.

    What is inferred of the robot by other means than measurements holds for the rough contact
    alone: it ends the comparison until the next contact.
    """

    def __init__(self, ensemble: PushEnsemble) -> None:
        """
        Start with one hypothesis.

        :param ensemble: the ``PushEnsemble`` of the contact as stated; no one else changes it.
        """
        super().__init__(ensemble._state)
        self._ensemble = ensemble
        self._slippery: PushEnsemble | None = None
        self._slip_detector = SlipDetector()

    @property
    def is_undecided(self) -> bool:
        """Tell whether both hypotheses are followed."""
        return self._slippery is not None

    # Measurements, which both hypotheses follow.

    def predict(self, odometry: Odometry, step: Pose | None = None) -> None:
        """
        Move the members of both hypotheses by odometry.

        :param odometry: as of ``PushEnsemble.predict``.
        :param step: likewise.
        """
        if self._slippery is not None:
            self._slippery.predict(odometry, step)
        if not self._ensemble.predict(odometry, step):
            return
        time_since_contact = self._ensemble.time_since_contact
        if time_since_contact == 0.0:
            self._fork()
        elif time_since_contact > COUPLING_TIME and not self._ensemble.has_unseen_contact:
            self._decide_after_contact()

    def update(self, measured: ObjectPose) -> bool:
        """
        Correct both hypotheses by a measured object pose, and compare them.

        :param measured: as of ``PushEnsemble.update``.
        :return: whether the estimate of the hypothesis that is read from now on includes it.
        """
        slippery = self._slippery
        is_accepted = self._ensemble.update(measured)
        if slippery is None:
            return is_accepted
        is_accepted_if_slippery = slippery.update(measured)
        verdict = self._slip_detector.evaluate(self._log_likelihood_ratio(slippery))
        self._follow(slippery, verdict)
        return is_accepted_if_slippery if verdict is SlipVerdict.SLIPPERY else is_accepted

    def update_robot(self, pose: Pose, covariance: FloatArray) -> None:
        """
        Correct both hypotheses by a measured pose of the robot.

        :param pose: as of ``PushEnsemble.update_robot``.
        :param covariance: likewise.
        """
        if self._slippery is not None:
            self._slippery.update_robot(pose, covariance)
        self._ensemble.update_robot(pose, covariance)

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
        self._slippery = None
        self._ensemble.update_along(direction, error, deviation, is_certain)

    def inflate_covariance(self, deviation: float, heading_deviation: float = 0.0) -> None:
        """
        Make the robot's pose less certain, as after a search without success.

        :param deviation: standard deviation of x and of y that is added [m].
        :param heading_deviation: standard deviation of the heading that is added [rad].
        """
        self._slippery = None
        self._ensemble.inflate_covariance(deviation, heading_deviation)

    def place_robot(self, pose: Pose, deviations: Sequence[float]) -> None:
        """
        Replace the estimate of the robot's pose.

        :param pose: its ``Pose``, about.
        :param deviations: standard deviations of x, y [m] and heading [rad].
        """
        self._slippery = None
        self._ensemble.place_robot(pose, deviations)

    def restore_robot(self, memory: RobotMemory, deviation: float,
                      heading_deviation: float) -> None:
        """
        Return to an earlier estimate of the robot, moved by odometry since.

        :param deviation: standard deviation of x and of y that is added [m].
        :param heading_deviation: standard deviation of the heading that is added [rad].
        """
        self._slippery = None
        self._ensemble.restore_robot(memory, deviation, heading_deviation)

    def take_over_robot(self, previous: EnsembleReading) -> None:
        """
        Start with the robot as it was estimated with another object.

        :param previous: that estimate; nothing is taken before its first odometry.
        """
        self._slippery = None
        self._ensemble.take_over_robot(previous)

    def start_from(self, knowledge: ObjectKnowledge) -> None:
        """
        Start from what was learned of the object before.

        :param knowledge: ``ObjectKnowledge``, as it is by now.
        """
        self._ensemble.start_from(knowledge)

    # Comparison.

    def _fork(self) -> None:
        """Fork a low-friction hypothesis at first contact."""
        if self._slippery is not None or not self.has_object or not self._state.knows_contact:
            return
        nominal = self.members.obj.contact_friction_coefficient
        friction = self.members.parameters[:, -1]
        if self._slip_detector.is_needed(nominal, friction):
            self._slippery = self._ensemble.fork()
            self._slippery.set_contact_friction(slippery_friction(nominal, friction))

    def _log_likelihood_ratio(self, slippery: PushEnsemble) -> float:
        """Return the logarithm of the likelihood of slippery over rough, since the fork."""
        return slippery.log_likelihood - self._ensemble.log_likelihood

    def _decide_after_contact(self) -> None:
        """Follow the likelier hypothesis once a contact is over."""
        slippery = self._slippery
        if slippery is not None:
            ratio = self._log_likelihood_ratio(slippery)
            self._follow(slippery, self._slip_detector.evaluate_after_contact(ratio))

    def _follow(self, slippery: PushEnsemble, verdict: SlipVerdict) -> None:
        if verdict is SlipVerdict.BOTH:
            return
        self._slippery = None
        if verdict is SlipVerdict.SLIPPERY:
            self._ensemble.assign(slippery)
