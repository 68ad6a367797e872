"""How closely a base is known to follow: what was shown counts, until something else shows."""

from push_control.safety.close_following import CloseFollowing, LEARNING_TIME, SETTLING_TIME
from push_model.signals import STOP, Twist

AHEAD, TURNING = Twist(0.2, 0.0, 0.0), Twist(0.2, 0.0, 0.5)


def followed(following, velocity, duration, is_close=True):
    for _ in range(round(duration / 0.02)):
        following.add(velocity, 0.02, is_close=is_close)


def test_every_axis_that_moves_must_have_been_seen():
    """A drive straight ahead tells nothing of turning, and nothing of standing."""
    following = CloseFollowing()
    followed(following, AHEAD, 0.5 * LEARNING_TIME)
    assert not following.is_known(AHEAD)
    followed(following, AHEAD, 0.6 * LEARNING_TIME)
    assert following.is_known(AHEAD) and not following.is_known(TURNING)
    assert not following.is_known(STOP)
    followed(following, TURNING, 1.1 * LEARNING_TIME)
    assert following.is_known(TURNING)


def test_what_was_in_doubt_must_be_shown_for_twice_as_long():
    """Again and again, so that a base with noise is soon not held to it any more."""
    following, expected = CloseFollowing(), LEARNING_TIME
    for _ in range(3):
        followed(following, AHEAD, 1.1 * expected)
        assert following.is_known(AHEAD)
        followed(following, AHEAD, 0.1, is_close=False)
        assert following.is_known(AHEAD)
        expected *= 2.0
        followed(following, AHEAD, 0.9 * expected)
        assert not following.is_known(AHEAD)


def test_a_command_that_jumps_is_not_judged_closely():
    """Until a base with any acceleration has settled."""
    following = CloseFollowing()
    assert following.is_settled((0.1, 0.0, 0.5), 0.0)
    assert not following.is_settled((0.0, 0.0, 1.0), 1.0)
    assert not following.is_settled((0.0, 0.0, 0.0), 1.0 + 0.9 * SETTLING_TIME)
    assert following.is_settled((0.0, 0.0, 0.0), 1.0 + 1.1 * SETTLING_TIME)
