"""Presets: what makes pushing hard, at one click."""

from push_model.parameters import PushedObject
from push_view.live.settings import CONTACT_FRICTION, FRICTION
from push_view.messages import Message

# True friction of the floor and of the contact; chosen: far off what the robot is told.
ICE, ICY_CONTACT = 0.06, 0.15
RUG, BARE_FLOOR = 0.9, 0.25
# How the object is kicked, seen from the robot: aside, away, and round [m, m, rad]; chosen: the
# push cannot go on.
KICK = (0.15, 0.15, 0.5)


def preset_messages(obj: PushedObject) -> list[Message]:
    """
    List presets as the commands that the page sends for them.

    :param obj: the true ``PushedObject``.
    """
    count = len(obj.supports)
    ice = [_set(f'{FRICTION}{i}', ICE) for i in range(count)] + [_set(CONTACT_FRICTION,
                                                                      ICY_CONTACT)]
    # The supports of the left side stand on the rug.
    rug = [_set(f'{FRICTION}{i}', RUG if support.y > 0.0 else BARE_FLOOR)
           for i, support in enumerate(obj.supports)]
    return [
        _preset('ice', 'Floor and contact are slippery.', ice),
        _preset('rug', 'The left side of the object stands on a rug, the right one beside it.',
                rug),
        _preset('kick', 'Somebody kicks the object aside.', [{'type': 'kick', 'by': list(KICK)}]),
        _preset('bad base', 'The base obeys 0.3 s late.', [{'type': 'choose', 'base': 'late_03'}]),
        _preset('own camera', 'The robot sees the object only ahead, by its own camera.',
                [{'type': 'choose', 'sensors': 'own_camera'}]),
    ]


def _preset(name: str, explanation: str, commands: list[Message]) -> Message:
    return {'name': name, 'help': explanation, 'commands': commands}


def _set(name: str, value: float) -> Message:
    return {'type': 'set', 'name': name, 'value': value}
