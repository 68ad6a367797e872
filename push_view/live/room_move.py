"""One move of a room, from measurement to measurement, as the page shows it."""

from collections.abc import Callable, Sequence

import numpy as np
from push_control.events import TaskEvent
from push_model.geometry import Pose
from push_planner.rearrangement.problem import Move
from push_scenario.simulation.loop import (
    ClosedLoop, make_protective_field, make_safety_layer)
from push_scenario.simulation.result import Outcome
from push_scenario.simulation.robot_control import Ending
from push_scenario.tidying.tidy import RoomRun
from push_view.live.display import RunDisplay
from push_view.messages import goal_message, truth_message
from push_view.server.message_log import MessageLog


class RoomMove:
    """
    The pushes that bring one object to where a move ends, while all others stand.

    ``move``: the ``Move``.

    :param run: the ``RoomRun``.
    :param move: the ``Move``.
    :param columns: names of the columns that the page is sent.
    :param more: values of columns behind these.
    :param log: where it is shown.
    """

    def __init__(self, run: RoomRun, move: Move, columns: Sequence[str],
                 more: Callable[[], Sequence[float]], log: MessageLog) -> None:
        self.move = move
        self._run = run
        self._start = run.begin(move)
        scenario, robot = self._start.scenario, self._start.robot
        self._end_time = run.simulation.time + scenario.time_limit
        self._is_cancelled = False
        safety = make_safety_layer(scenario)
        self._loop = ClosedLoop(run.simulation, robot, safety, self._start.observation,
                                localizer=run.localizer,
                                protective_field=make_protective_field(scenario))
        self._display = RunDisplay(log, run.simulation, robot, safety, scenario.object,
                                   columns=columns, more=more)
        log.add(truth_message(run.simulation.time, scenario.true_object))
        log.add(goal_message(run.simulation.time, scenario.goal.pose))
        self._display.take_rows()

    @property
    def shown_time(self) -> float:
        """Time of the last row, at which the page shows what is changed now [s]."""
        return self._display.time

    def rehearse(self) -> None:
        """Compile what the robot needs for a push."""
        self._start.robot.supervisor.rehearse()

    def advance(self) -> Ending | None:
        """
        Go on to the next measurement; return how it ended, where it has.

        Then everything is at rest, and where all are has been measured.
        """
        ending = self._ending()
        if ending is None:
            self.idle()
            return None
        self._loop.settle()
        self._run.end(self.move, self._start)
        self._display.take_rows()
        return ending

    def idle(self) -> None:
        """Go on to the next measurement with a robot that plans nothing."""
        self._loop.advance()
        self._display.take_rows()

    def show(self) -> None:
        """Send the page the rows."""
        self._display.send_rows()

    def cancel(self) -> None:
        """Let the robot back off and stand."""
        self._is_cancelled = True
        self._start.robot.supervisor.cancel(TaskEvent.GOAL_REPLACED.report())

    def _ending(self) -> Ending | None:
        robot, time = self._start.robot, self._run.simulation.time
        ending = robot.update_plan(self._loop.observation)
        if ending is not None:
            return ending
        if self._is_cancelled and robot.supervisor.state.is_standing:
            return Ending(Outcome.FAILED, str(TaskEvent.GOAL_REPLACED.report()))
        if time >= self._end_time:
            return Ending(Outcome.TIME_LIMIT,
                          f'not done after {self._start.scenario.time_limit:g} s')
        return None


def standing_move(name: str, pose: Pose) -> Move:
    """Make a move of an object to where it is."""
    return Move(name, pose, pose, False, 0.0, np.array([pose[:2]]))
