"""What happens to a task, and why it waits: codes for the program, sentences for people."""

from push_model.events import AnyReport, Cause, Report
from push_model.plan_request import PlanFailure


class TaskEvent(Cause):
    """Why the state of a task changes, or what it waits for."""

    # Somebody has asked for it.
    NEW_GOAL = 'new goal'
    NEW_GOAL_TOO_HEAVY = 'new goal; {warning}'
    NO_GOAL = 'no goal'
    NEW_PLAN = 'another plan'
    RESUMED = 'resumed'
    GOAL_CANCELLED = 'cancelled'
    GOAL_REPLACED = 'another goal has come'
    GOAL_TIMED_OUT = 'timed out'
    GOAL_REFUSED = '{error}'
    AWAITS_START = 'has a plan and waits for controller/start'
    STOPPED_BY_USER = 'stopped by controller/stop: call controller/start'
    DEACTIVATED = 'the controller was deactivated'

    # The task is interrupted.
    ODOMETRY_LOST = 'stands where it is, as no odometry comes'
    TIME_WENT_BACK = 'time went back'
    INTERNAL_ERROR = 'internal error: {error!r:.200}'
    HIT_WALL = '{contact}'

    # Another plan is sought.
    STARTED_OVER = ('odometry has jumped while the robot stood: localization of robot and object '
                    'starts over')
    RELOCATED = 'the robot is elsewhere in the map than it seemed to be'
    MAP_BLOCKS_PATH = 'the new map has an obstacle in the way'
    OBJECT_UNSEEN = 'the object has to be seen from another side'

    # There is no plan.
    NO_PLAN = 'no plan: {reason}'
    NO_PUSH_NEEDED = '{reason}'

    # It is done, but for what nobody can know.
    DONE_BY_ODOMETRY = (
        'at its goal as odometry has it, which is known to {position:.0f} mm and {heading:.1f} '
        'deg (standard deviations)')
    NOBODY_PLANS = 'no plan within {timeout:g} s: nobody subscribes {topic}'
    PLANNER_SILENT = (
        'no plan within {timeout:g} s: the subscriber of {topic} does not answer yet; for a new '
        'object it takes a minute or two')
    PLANNERS_SILENT = 'no plan within {timeout:g} s: {count} subscribers of {topic} do not answer'
    PLAN_STARTS_ELSEWHERE = (
        'the plan begins where the object is not, {distance:.2f} m and {rotation:.0f} deg off')
    PLAN_OLDER_THAN_NODE = (
        'the plan is older than this node: request another, or call controller/start')

    # It waits.
    NO_USABLE_MAP = '{map_fault}'
    AVERAGING = (
        'the noise of the object poses is averaged down to standard errors of {position:.1f} mm '
        'and {heading:.2f} deg, for {limit:g} s at most')

    # A plan cannot be driven with a limited view.
    PUSH_NEEDS_POSES = (
        'a steered push needs poses of the object all along, and supervision.view_angle, '
        'view_nearest or view_farthest limits them')

    # It is given up.
    OBJECT_NOT_FOUND = 'aborted: the object is not found'
    ABORTED = 'aborted: {reason}'
    GOAL_TOO_FAR = (
        'aborted: the goal is {distance:.0f} m away, at most {limit:g} m is expected '
        '(supervision.max_goal_distance)')
    GOAL_UNCERTAIN = (
        'aborted: the object may be at its goal, but its poses do not show it to within the '
        'tolerances: standard errors of {position:.1f} mm and {heading:.2f} deg; with tolerances '
        'of {position_tolerance:.1f} mm and {heading_tolerance:.1f} deg they would')
    PUSHES_UNSEEN = (
        'aborted: {count} pushes have left the object pose as it was, to the last digit: the '
        'tracker is frozen, or the robot pushes elsewhere')
    ATTEMPTS_USED_UP = 'aborted: no progress in {count} attempts'
    NEARLY_DONE = (
        '{abort}; tolerances of {position_tolerance:.1f} mm and {heading_tolerance:.1f} deg '
        'would do')
    ATTEMPTS_FAILED = 'aborted: no progress in {count} attempts; last failure: {failure}'
    PLANNING_FAILED_AGAIN = 'aborted: planning failed twice from here: {reason}'
    PLANNING_FAILED_FOR_LONG = 'aborted: planning failed for {duration:g} s: {reason}'
    # What measurements have to do with it.
    ABORTED_INCONSISTENT = '{abort}; {inconsistency}'
    ABORTED_AFTER = '{abort}; before that: {disturbance}'


# A task with one of these has done what it could: people are informed, not warned.
WITHOUT_FAULT = frozenset({TaskEvent.DONE_BY_ODOMETRY})


def no_plan(code: PlanFailure, reason: str | AnyReport) -> Report[TaskEvent]:
    """
    Report that there is no plan.

    :param reason: ``code`` in one sentence, or a ``Report`` of it.
    """
    return TaskEvent.NO_PLAN.report(failure=code, reason=reason)


class PerceptionEvent(Cause):
    """Event in measurements, over several of them."""

    # The object does not come to rest.
    NO_POSES_COME = 'the object is not at rest: no poses of it come'
    OBJECT_MOVES = (
        'the object is not at rest: it moves by itself, at {speed:.2f} m/s and {yaw_rate:.0f} '
        'deg/s')
    OBJECT_POSES_DIFFER = (
        'the object is not at rest: its poses differ from one to the next by {position:.1f} mm '
        'and {heading:.2f} deg')
    OBJECT_POSES_NOISIER_THAN_STATED = (
        'the object is not at rest: its poses differ from one to the next by {position:.1f} mm '
        'and {heading:.2f} deg, and noise of {stated_position:.1f} mm and {stated_heading:.2f} '
        'deg is stated')

    # Contacts do not fit the measurements.
    CONTACTS_DO_NOT_FIT = '{count} contacts in a row did not fit the object poses'
    PUSH_WITHOUT_EFFECT = 'a push moved no object at its poses'
    PUSHES_WITHOUT_EFFECT = '{count} pushes in a row moved no object at its poses'
    POSES_ELSEWHERE = (
        '{contacts}: they are of another object or of the robot, mirrored or in other axes, or '
        'the robot is elsewhere')
    POSES_JUMPED_ELSEWHERE = (
        '{contacts}, which have jumped by {distance:.2f} m and {rotation:.0f} deg: they are of '
        'another object or of the robot, mirrored or in other axes, or the robot is elsewhere')
    POSES_JUMPED = (
        'object poses have jumped by {distance:.2f} m and {rotation:.0f} deg: somebody has moved '
        'the object, or they are of another one')
    ODOMETRY_TOO_LARGE = (
        'odometry means {percentage:.0f} % more motion than there is, as where wheels slip')
    ODOMETRY_TOO_SMALL = (
        'odometry means {percentage:.0f} % less motion than there is, as where wheels slip')
    INCONSISTENCIES = '{first}; {second}'
