"""How often it has been tried without getting nearer."""

import math
import re

from push_control.task.perception import has_moved
from push_model.geometry import distance, wrap_angle

SHYER, SHYEST = 0.8, 0.4


class Tries:
    """Counts pushes and recoveries since the object last came nearer to its goal."""

    def __init__(self, settings):
        """
        Begin with nothing tried.

        :param settings: ``SupervisionSettings``.
        """
        self._settings = settings
        self._least, self._count, self._trouble = math.inf, 0, ''
        self._refusal, self._hopeless = None, ''

    def count(self, trouble=''):
        """
        Count one more.

        :param trouble: what went wrong, empty where nothing did.
        """
        self._count += 1
        self._trouble = trouble or self._trouble

    def refused(self, wanted, reason):
        """
        Hear that there is no plan: no use to ask again where all is as it was.

        :param wanted: the plan that was ``push_model.plan_request.Wanted``.
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

    def judge(self, rest, goal):
        """
        Look where the object has come to rest.

        :param rest: ``push_control.task.perception.Rest``.
        :param goal: ``Pose`` wanted.
        :return: ``'reached'``, ``'off'``, or ``'unsure'`` where a longer look may tell.
        """
        settings = self._settings
        away, turned = distance(rest.pose, goal), abs(wrap_angle(rest.pose.theta - goal.theta))
        error = max(away / settings.position_tolerance, turned / settings.heading_tolerance)
        if error < settings.nearer * self._least:
            self._least, self._count, self._trouble = error, 0, ''
        slack = (settings.certainty * rest.position_error,
                 settings.certainty * rest.heading_error)
        if (away <= settings.position_tolerance - slack[0]
                and turned <= settings.heading_tolerance - slack[1]):
            return 'reached'
        certain = (away > settings.position_tolerance + slack[0]
                   or turned > settings.heading_tolerance + slack[1])
        return 'off' if certain or rest.duration >= settings.longest_look else 'unsure'

    @property
    def boldness(self):
        """Share of what friction allows that the next plan should use: less every other try."""
        return max(SHYEST, SHYER ** (self._count // 2))

    @property
    def exhausted(self):
        """Why it is to give up, empty while it is not."""
        if self._count < self._settings.tries:
            return self._hopeless
        last = f'; last: {self._trouble}' if self._trouble else ''
        return f'gave up: {self._count} tries brought the object no nearer{last}'
