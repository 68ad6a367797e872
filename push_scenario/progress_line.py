"""A line that tells how far a replay has come."""

TERMINAL_PERIOD = 0.1
LOG_PERIOD = 5.0


class ProgressLine:
    """
    Shows a run's progress: one line that is written over in a terminal, else a line now and then.

    :param stream: where to write, such as ``sys.stderr``.
    :param clock: function that returns wall-clock seconds.
    :param title: what is running.
    """

    def __init__(self, stream, clock, title):
        self._stream, self._clock, self._title = stream, clock, title
        self._terminal = stream.isatty()
        self._began = self._shown = clock()
        self._since = None
        self._stage, self._width = '', 0

    def __call__(self, progress):
        """
        Show progress, unless something was shown a moment ago.

        :param progress: the ``Progress``.
        """
        now = self._clock()
        if progress.stage != 'planning' and self._since is None:
            self._since = now, progress.time
        period = TERMINAL_PERIOD if self._terminal else LOG_PERIOD
        if progress.stage == self._stage and now - self._shown < period:
            return
        self._stage, self._shown = progress.stage, now
        self._write(f'{self._title}: {progress.stage}, {progress.time:.1f} s simulated'
                    f'{self._speed(progress.time, now)}, {progress.distance:.3f} m to the goal')

    def end(self, text):
        """
        Write the last line.

        :param text: how it ended.
        """
        self._write(f'{self._title}: {text}, {self._clock() - self._began:.1f} s')
        if self._terminal:
            self._stream.write('\n')
            self._stream.flush()

    def _speed(self, time, now):
        if self._since is None or now - self._since[0] < 0.2:
            return ''
        factor = (time - self._since[1]) / (now - self._since[0])
        return f' at {factor:.1f} x real time'

    def _write(self, text):
        if self._terminal:
            self._stream.write('\r' + text.ljust(self._width))
            self._width = len(text)
        else:
            self._stream.write(text + '\n')
        self._stream.flush()
