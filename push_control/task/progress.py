"""How often it has been tried without getting nearer."""

import math
import re

from push_control.task.perception import has_moved
from push_model.geometry import distance, wrap_angle

SHYER, SHYEST = 0.8, 0.4


class ProgressMonitor:
    """Counts pushes and recoveries since the object last came nearer to its goal."""

    def __init__(self, settings):
        """
        Begin with nothing tried.

        :param settings: ``SupervisionSettings``.
        """
        self._settings = settings
        self._least, self._count, self._trouble = math.inf, 0, ''
        self._refusal, self._hopeless = None, ''

    def count(self, failure_reason=''):
        """
        Count one more.

        :param failure_reason: what went wrong, empty where nothing did.
        """
        self._count += 1
        self._trouble = failure_reason or self._trouble

    def on_planning_failed(self, wanted, reason):
        """
        Hear that there is no plan: no use to ask again where all is as it was.

        :param wanted: the plan that was ``push_model.plan_request.PlanRequest``.
        :param reason: why there is none.
        """
        # Noise of the poses shows in the numbers.
        text = re.sub(r'\d+', '', reason)
        if self._refusal is not None:
            before, text_before = self._refusal
            if text == text_before and not any(
                    has_moved(then, now, self._settings)
                    for then, now in ((before.object_pose, wanted.object_pose),
                                      (before.robot_pose, wanted.robot_pose))):
                self._hopeless = f'gave up: twice no plan from here: {reason}'
        self._refusal = wanted, text

    def look_anew(self):
        """Forget what was refused, as there may be a plan now."""
        self._refusal, self._hopeless = None, ''

    def check_goal(self, object_at_rest, goal):
        """
        Look where the object has come to rest.

        :param object_at_rest: ``push_control.task.perception.ObjectAtRest``.
        :param goal: ``Pose`` wanted.
        :return: ``'reached'``, ``'off'``, or ``'unsure'`` where a longer look may tell.
        """
        settings = self._settings
        away, turned = distance(object_at_rest.pose, goal), abs(wrap_angle(object_at_rest.pose.theta - goal.theta))
        error = max(away / settings.position_tolerance, turned / settings.heading_tolerance)
        if error < settings.improvement_ratio * self._least:
            self._least, self._count, self._trouble = error, 0, ''
        slack = (settings.confidence_sigmas * object_at_rest.position_error,
                 settings.confidence_sigmas * object_at_rest.heading_error)
        if (away <= settings.position_tolerance - slack[0]
                and turned <= settings.heading_tolerance - slack[1]):
            return 'reached'
        certain = (away > settings.position_tolerance + slack[0]
                   or turned > settings.heading_tolerance + slack[1])
        return 'off' if certain or object_at_rest.duration >= settings.max_averaging_time else 'unsure'

    @property
    def cone_fraction(self):
        """Share of what friction allows that the next plan should use: less every other try."""
        return max(SHYEST, SHYER ** (self._count // 2))

    @property
    def abort_reason(self):
        """Why it is to give up, empty while it is not."""
        if self._count < self._settings.max_attempts:
            return self._hopeless
        last = f'; last: {self._trouble}' if self._trouble else ''
        return f'gave up: {self._count} tries brought the object no nearer{last}'
