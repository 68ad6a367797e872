"""
Buffer of stamped transforms: a tree of frames, looked up at a time.

A frame has one parent. Between two stamps a transform is interpolated; before the first and after
the last one it is not known. Static transforms hold at any time.
"""

import bisect
import enum
from typing import NamedTuple

from push_model.rigid_transform import RigidTransform

# How long transforms are kept [ns]; that of tf2.
HISTORY = 10_000_000_000
# A stamp that lies before the newest one by more is of a time that went back [ns]; chosen: longer
# than transforms of one source come out of order.
BACKWARDS = 1_000_000_000
NANOSECOND = 1e-9


class LookupFailure(enum.Enum):
    """Reason why there is no transform."""

    UNKNOWN_FRAME = 'unknown frame'
    NOT_CONNECTED = 'not connected'
    TOO_EARLY = 'before the first transform'
    TOO_LATE = 'after the last transform'


class TransformUnavailable(LookupError):
    """
    There is no transform between two frames at a time.

    ``failure``: the ``LookupFailure``.
    """

    def __init__(self, failure: LookupFailure, text: str) -> None:
        super().__init__(text)
        self.failure = failure

    @property
    def is_final(self) -> bool:
        """Tell whether no transform that comes later can help."""
        return self.failure is LookupFailure.TOO_EARLY


class _Link:
    """Transforms of a frame in its parent, by time [ns]."""

    def __init__(self, parent: str, is_static: bool) -> None:
        self.parent = parent
        self.is_static = is_static
        self.times: list[int] = []
        self.transforms: list[RigidTransform] = []

    def add(self, time: int, transform: RigidTransform) -> None:
        if self.is_static or (self.times and time < self.times[-1] - BACKWARDS):
            self.times, self.transforms = [], []
        index = bisect.bisect_left(self.times, time)
        if index < len(self.times) and self.times[index] == time:
            self.transforms[index] = transform
            return
        self.times.insert(index, time)
        self.transforms.insert(index, transform)
        expired = bisect.bisect_left(self.times, self.times[-1] - HISTORY)
        if expired:
            del self.times[:expired], self.transforms[:expired]

    def at(self, time: int) -> RigidTransform:
        """Interpolate at a time within the history."""
        if self.is_static:
            return self.transforms[0]
        index = bisect.bisect_left(self.times, time)
        if self.times[index] == time:
            return self.transforms[index]
        before, after = self.times[index - 1], self.times[index]
        return self.transforms[index - 1].interpolate(
            self.transforms[index], (time - before) / (after - before))


class _Path(NamedTuple):
    """Frames below the common ancestor of two frames, each from the bottom up."""

    up_from_source: tuple[str, ...]
    up_from_target: tuple[str, ...]


class TransformBuffer:
    """Transforms as they came."""

    def __init__(self) -> None:
        """Start without frames."""
        self._links: dict[str, _Link] = {}

    def set(self, parent: str, child: str, time: int, transform: RigidTransform, *,
            is_static: bool = False) -> None:
        """
        Take in a transform.

        :param parent: frame id.
        :param child: frame id.
        :param time: of the transform [ns].
        :param transform: of the child in the parent.
        :param is_static: whether it holds at any time.
        :raises ValueError: where a frame has no name, or is its own parent.
        """
        parent, child = _name(parent), _name(child)
        if not parent or not child or parent == child:
            raise ValueError(f'transform: got the frames {parent!r} and {child!r}, expected two '
                             'different names')
        link = self._links.get(child)
        if link is None or link.parent != parent or link.is_static != is_static:
            link = self._links[child] = _Link(parent, is_static)
        link.add(time, transform)

    def clear(self) -> None:
        """Forget all transforms but static ones, as when time went back."""
        self._links = {child: link for child, link in self._links.items() if link.is_static}

    def lookup(self, target: str, source: str, time: int | None = None) -> RigidTransform:
        """
        Look up a transform.

        :param target: frame id to which coordinates are brought.
        :param source: frame id in which they are.
        :param time: when [ns]; None for the newest at which all that it takes is known.
        :return: pose of the source in the target.
        :raises TransformUnavailable: saying what is missing.
        """
        target, source = _name(target), _name(source)
        if target == source:
            return RigidTransform()
        path = self._path(target, source)
        frames = [frame for frame in (*path.up_from_source, *path.up_from_target)
                  if not self._links[frame].is_static]
        if time is None:
            time = min((self._links[frame].times[-1] for frame in frames), default=0)
        for frame in frames:
            self._check_time(frame, time)
        return (self._climb(path.up_from_target, time).inverse()
                @ self._climb(path.up_from_source, time))

    def rigid(self, target: str, source: str) -> RigidTransform | None:
        """
        Look up a transform that holds at any time.

        :param target: frame id to which coordinates are brought.
        :param source: frame id in which they are.
        :return: pose of the source in the target; None where they are not connected by static
            transforms alone.
        """
        target, source = _name(target), _name(source)
        if target == source:
            return RigidTransform()
        try:
            path = self._path(target, source)
        except TransformUnavailable:
            return None
        if not all(self._links[frame].is_static
                   for frame in (*path.up_from_source, *path.up_from_target)):
            return None
        return self.lookup(target, source)

    def is_below(self, frame: str, ancestor: str) -> bool:
        """
        Tell whether a frame hangs below another one, or is the same.

        :param frame: frame id.
        :param ancestor: frame id.
        """
        return _name(ancestor) in self._line(_name(frame))

    def parent(self, frame: str) -> str:
        """
        Look up the parent of a frame.

        :param frame: frame id.
        :raises TransformUnavailable: where it has none.
        """
        link = self._links.get(_name(frame))
        if link is None:
            raise TransformUnavailable(
                LookupFailure.UNKNOWN_FRAME, f'no transform of {frame!r} has come')
        return link.parent

    def newest(self, frame: str) -> int | None:
        """
        Look up the time of the newest transform of a frame in its parent.

        :param frame: frame id.
        :return: time [ns]; None before the first.
        """
        link = self._links.get(_name(frame))
        return None if link is None else link.times[-1]

    def has(self, frame: str, time: int) -> bool:
        """
        Tell whether there is a transform of a frame in its parent with exactly that stamp.

        :param frame: frame id.
        :param time: [ns].
        """
        link = self._links.get(_name(frame))
        return link is not None and time in link.times

    @property
    def description(self) -> str:
        """Description of the tree, as "parent -> child" of every frame."""
        links = sorted((link.parent, child) for child, link in self._links.items())
        return ', '.join(f'{parent} -> {child}' for parent, child in links) or 'nothing'

    def _line(self, frame: str) -> list[str]:
        """List a frame and all above it; a loop is walked once."""
        line = [frame]
        while line[-1] in self._links:
            parent = self._links[line[-1]].parent
            if parent in line:
                break
            line.append(parent)
        return line

    def _path(self, target: str, source: str) -> _Path:
        known = {*self._links, *(link.parent for link in self._links.values())}
        for frame in (source, target):
            if frame not in known:
                raise TransformUnavailable(
                    LookupFailure.UNKNOWN_FRAME,
                    f'no transform of {frame!r} has come; known: {self.description}')
        above_source, above_target = self._line(source), self._line(target)
        common = next((frame for frame in above_source if frame in above_target), None)
        if common is None:
            raise TransformUnavailable(
                LookupFailure.NOT_CONNECTED,
                f'{source!r} and {target!r} are not connected; known: {self.description}')
        return _Path(tuple(above_source[:above_source.index(common)]),
                     tuple(above_target[:above_target.index(common)]))

    def _check_time(self, frame: str, time: int) -> None:
        link = self._links[frame]
        first, last = link.times[0], link.times[-1]
        if first <= time <= last:
            return
        failure = LookupFailure.TOO_EARLY if time < first else LookupFailure.TOO_LATE
        raise TransformUnavailable(
            failure, f'the transforms {link.parent} -> {frame} are of {first * NANOSECOND:.3f} to '
            f'{last * NANOSECOND:.3f} s')

    def _climb(self, frames: tuple[str, ...], time: int) -> RigidTransform:
        transform = RigidTransform()
        for frame in frames:
            transform = self._links[frame].at(time) @ transform
        return transform


def _name(frame: str) -> str:
    return frame.lstrip('/')
