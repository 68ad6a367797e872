"""Measurements that fail by turns make the robot wait, and not start and stop."""

from push_control.perception.measurement_watch import MeasurementWatch, RECOVERY_TIMES
from push_model.events import PushEvent

PERIOD = 0.02


def stale(age):
    """Report that poses are stale."""
    return PushEvent.OBJECT_POSE_STALE.report(age=age, limit=0.25)


def watched(is_bad, duration):
    """Watch measurements that are bad at times; return the watch, and what it answers."""
    watch, answers = MeasurementWatch(), []
    for i in range(round(duration / PERIOD)):
        time = i * PERIOD
        answers.append(watch.update(stale(time) if is_bad(time) else None, time))
    return watch, answers


def test_one_gap_costs_no_more_than_it_takes():
    """The robot goes on with the first good measurement."""
    watch, answers = watched(lambda time: 1.0 <= time < 1.5, 3.0)
    waits = [i * PERIOD for i, answer in enumerate(answers) if answer is not None]
    assert min(waits) == 1.0 and max(waits) < 1.5 and watch.waited(3.0) == 0.0


def test_gaps_in_every_second_end_in_a_wait():
    """Whose reason stays, so that it is not reported again with every message."""
    watch, answers = watched(lambda time: time % 1.0 < 0.4, 30.0)
    changes = sum((a is None) is not (b is None) for a, b in zip(answers, answers[1:]))
    assert changes <= 2 * len(RECOVERY_TIMES)
    assert watch.waited(30.0) > 25.0
    assert len({id(answer) for answer in answers[-1000:]}) <= 12


def test_poses_that_are_late_again_and_again_are_named_with_what_to_change() -> None:
    """The first time they may be lost; so they are named after a tracker was gone, and before."""
    watch = MeasurementWatch()
    late, gone = ([0.2 + 0.08 * (i % 3 == 0) for i in range(250)],
                  [0.1 + i * PERIOD for i in range(150)])
    answers = [watch.update(stale(age) if age > 0.25 else None, i * PERIOD)
               for i, age in enumerate(late + gone + late)]
    reasons = [None if answer is None else answer.code for answer in answers]
    assert reasons[0] is reasons[399] is PushEvent.OBJECT_POSE_STALE
    for i in (249, -1):
        assert reasons[i] is PushEvent.OBJECT_POSES_LATE
        assert 'up to 0.28 s old, control.pose_timeout is 0.25 s' in str(answers[i])


def test_gaps_now_and_then_do_not():
    """As where somebody passes through the picture."""
    _, answers = watched(lambda time: time % 4.0 < 0.4, 30.0)
    assert sum(answer is not None for answer in answers) * PERIOD < 30.0 * 0.11


def test_poses_that_are_always_late_are_named_so_too() -> None:
    """None of them is good; those of a tracker that is gone grow older."""
    watch = MeasurementWatch()
    answers = [watch.update(stale(0.3 + 0.05 * (i % 2)), i * PERIOD) for i in range(150)]
    assert answers[-1] is not None and answers[-1].code is PushEvent.OBJECT_POSES_LATE
    gone = MeasurementWatch()
    answers = [gone.update(stale(0.25 + i * PERIOD), i * PERIOD) for i in range(150)]
    assert answers[-1] is not None and answers[-1].code is PushEvent.OBJECT_POSE_STALE
