"""Mutants of goal handling and of the node: goals, zeros, watchdog, other commanders."""

from benchmarks.mutants.mutant import Mutant

GOALS = ('test/ros/test_goal_entry.py',)
ACTION = ('test/ros/test_push_action.py', 'test/ros/test_goal_entry.py')
MEASUREMENTS = ('test/ros/test_measurements.py',)
STOPS = ('test/ros/test_stop.py', 'test/ros/test_nodes_user.py')
COMMANDERS = ('test/ros/test_other_commanders.py',)
ZEROS = (*COMMANDERS, *STOPS)


def _mutant(name: str, module: str, old: str, new: str, tests: tuple[str, ...]) -> Mutant:
    return Mutant(name, f'push_control/ros/{module}.py', old, new, tests)


MUTANTS = (
    _mutant('a stopped controller takes goals', 'goal_entry',
            "if self.refusal:\n            raise MessageRefused(f'goal_pose",
            "if False:\n            raise MessageRefused(f'goal_pose", (*GOALS, *STOPS)),
    _mutant('goals have no time limit', 'goal_entry',
            'elif current.elapsed_time > current.goal.time_limit:', 'elif False:', GOALS),
    _mutant('goals have no time limit without odometry', 'goal_entry',
            'if current.pending_outcome is None and current.elapsed_time > '
            'current.goal.time_limit:', 'if False:', GOALS),
    _mutant('a repeated goal starts anew', 'goal_entry',
            'if self._is_pursued(goal.pose):', 'if False:', GOALS),
    _mutant('a replaced goal is not told', 'goal_entry',
            'if prepare is None:\n            self._end(GoalOutcome.REPLACED, REPLACED)',
            'if prepare is None:', GOALS),
    _mutant('a goal ends before the robot stands', 'goal_entry',
            'if handle.pending_outcome is not None and not self._pursuit.is_commanding:',
            'if handle.pending_outcome is not None:', GOALS),
    _mutant('a goal that waits is forgotten', 'goal_entry',
            'self._start(upcoming.handle)', 'pass', GOALS),
    _mutant('a cancelled goal goes on', 'push_action',
            'if handle is self._current:\n            self._goals.cancel()',
            'if handle is self._current:\n            pass', ACTION),
    _mutant('a goal for another object is pursued with this one', 'push_action',
            "if name in ('', self._object_name):", 'if True:', ACTION),
    _mutant('an inactive node accepts goals', 'push_action',
            'if self._is_active():\n            return GoalResponse.ACCEPT',
            'if True:\n            return GoalResponse.ACCEPT', ACTION),
    _mutant('a watchdog without patience', 'measurements',
            'if age > self._timeout:', 'if age > 0.0:', MEASUREMENTS),
    _mutant('no watchdog', 'measurements', 'if age > self._timeout:', 'if False:', MEASUREMENTS),
    _mutant('odometry is never lost', 'measurements',
            'if age > LOST_RATIO * self._timeout:', 'if False:', MEASUREMENTS),
    _mutant('odometry that repeats its stamp feeds the watchdog', 'measurements',
            'if self._received is None or stamp > self._received.stamp:', 'if True:',
            MEASUREMENTS),
    _mutant('older measurements replace newer ones', 'measurements',
            'if self.odometry is None or odometry.time >= self.odometry.time:', 'if True:',
            MEASUREMENTS),
    _mutant('a gap loses nothing', 'measurements',
            'and now - self._received.now > LOST_RATIO * self._timeout)', 'and False)',
            MEASUREMENTS),
    _mutant('no zeros at deactivation', 'active_controller',
            'self._base.interrupt(str(DEACTIVATED))\n        self._commands.flush()',
            'self._base.interrupt(str(DEACTIVATED))', ZEROS),
    _mutant('no zeros at a stop', 'active_controller',
            'self.pursuit.stop()\n        self._commands.stop()', 'self.pursuit.stop()', ZEROS),
    _mutant('a stop leaves the goal', 'active_controller',
            'self.goals.interrupt(GoalOutcome.CANCELLED, cause)', 'pass', STOPS),
    _mutant('no zeros after the last command', 'commands',
            'self._remaining_zeros = STOP_COMMANDS', 'self._remaining_zeros = 0', ZEROS),
    _mutant('another commander is not noticed', 'command_gate',
            'if is_commanding and (self.yields or others.is_driving):', 'if False:', COMMANDERS),
    _mutant('a later controller does not yield', 'command_gate',
            'self.yields = is_commanding and is_blocked and others.is_commanding',
            'self.yields = False', COMMANDERS),
)
