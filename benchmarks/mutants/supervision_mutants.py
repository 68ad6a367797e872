"""Mutants of supervision and behaviours: tasks that do not end, pushes that nothing bounds."""

from benchmarks.mutants.mutant import Mutant

TASK = 'test/control/task'
# Files that are the quickest to notice.
TASK_FILES = {'stand_reasons': 'test_stand_reasons', 'execution': 'test_supervisor_stops',
              'supervisor': 'test_supervisor_requests'}
BEHAVIORS = 'test/control/behaviors'
CALIBRATION = ('test/base/test_calibration_square.py', 'test/base/test_calibration.py')


def _task(name: str, module: str, old: str, new: str) -> Mutant:
    return Mutant(name, f'push_control/task/{module}.py', old, new,
                  (f'{TASK}/{TASK_FILES[module]}.py', *(f'{TASK}/test_{each}.py' for each in (
                      'supervisor_requests', 'supervisor_stops', 'supervisor'))))


def _behavior(name: str, module: str, old: str, new: str) -> Mutant:
    return Mutant(name, f'push_control/behaviors/{module}.py', old, new,
                  (f'{BEHAVIORS}/test_{module}.py', BEHAVIORS))


def _calibration(name: str, old: str, new: str) -> Mutant:
    return Mutant(name, 'push_base/calibration/program.py', old, new, CALIBRATION)


TASKS = (
    _task('a task goes on although it has to stand', 'execution',
          'command = self._act(dt) if stand_reason is None else self._stand(stand_reason)',
          'command = self._act(dt)'),
    _task('measurements that fail stop nobody', 'execution',
          'self._reasons.on_measurements(fault, perception.time)',
          'self._reasons.on_measurements(None, perception.time)'),
    _task('spinning wheels never end a task', 'execution',
          'if failure.code in TOO_WEAK and self._progress.count_spin(failure):', 'if False:'),
    _task('a stop never ends for lack of time', 'stand_reasons',
          'StandCause.SAFETY_STOP: (STOP_TIME_LIMIT,', 'StandCause.SAFETY_STOP: (math.inf,'),
    _task('measurements are awaited for ever', 'stand_reasons',
          'StandCause.MEASUREMENTS: (MEASUREMENT_TIME_LIMIT,',
          'StandCause.MEASUREMENTS: (math.inf,'),
    _task('a resumed task is not stopped any more', 'stand_reasons',
          'if self._stop is not None and self._stop.code.awaits_resume:\n            self._stop',
          'if self._stop is not None:\n            self._stop'),
    _task('stops never end a task', 'supervisor',
          'if self._progress.count_safety_stop():', 'if False:'),
    _task('plans for an object elsewhere are driven', 'supervisor',
          'if self.awaits_plan and has_moved(', 'if False and has_moved('),
    _task('a map in the way is ignored', 'supervisor',
          'if perception.is_localized and self._behavior.is_blocked(',
          'if False and self._behavior.is_blocked('),
    _task('a cancelled robot does not back off', 'supervisor',
          'self._enter(state, cause, is_requested=True)\n        self._abandon()',
          'pass\n        self._abandon()'),
    _task('a cancelled goal is pursued on', 'supervisor',
          'self._enter(state, cause, is_requested=True)\n        self._abandon()',
          'self._enter(state, cause, is_requested=True)'),
    _task('a pause does nothing', 'supervisor', 'self._enter(TaskState.PAUSED)', 'pass'),
    _task('goals that are not finite are taken', 'supervisor',
          'if not Pose(*pose).is_finite():', 'if False:'),
    _task('a plan that cannot be used goes on', 'supervisor',
          'self._abort(TaskFailure.NO_PLAN, no_plan(code, code.value))', 'pass'),
    _task('a fault of odometry leaves the robot known', 'supervisor',
          'if fault is not None and fault.code.is_of_odometry:', 'if False:'),
)
PUSHES = (
    _behavior('an obstacle does not end a push', 'push_progress',
              'if (progress.is_excessive or progress.is_near_obstacle or',
              'if (progress.is_excessive or'),
    _behavior('a push has no greatest length', 'push_progress',
              'if (progress.is_excessive or progress.is_near_obstacle or',
              'if (progress.is_near_obstacle or'),
    _behavior('no distance is too long for a push', 'push_progress',
              'return self.pushed > limit or self.time', 'return self.time'),
    _behavior('no time is too long for a push', 'push_progress',
              'return self.pushed > limit or self.time > TIMEOUT + limit / MIN_SPEED',
              'return self.pushed > limit'),
    _behavior('an object that is not seen is pushed on', 'push_progress',
              'or progress.is_too_uncertain\n', 'or False\n'),
    _behavior('spinning wheels do not end a push', 'push_progress',
              'if progress.is_spinning:', 'if False:'),
    _behavior('an object that is not there is sought without end', 'push_progress',
              'if progress.overrun > miss_distance:\n            return Miss',
              'if False:\n            return Miss'),
    _behavior('a push without effect goes on', 'push_progress',
              'if is_still and seen_distance > miss_distance or is_over and progress.is_hindered:',
              'if is_over and progress.is_hindered:'),
    _behavior('an early touch is ignored', 'push_progress',
              'if progress.has_touched_early:', 'if False:'),
    _behavior('the obstacle guard of straight pushes is never asked', 'straight_push',
              'if self._guard is None:\n            return False',
              'if True:\n            return False'),
    _behavior('the first touch is as fast as the push', 'straight_push',
              'self._speed if self._progress.has_moved else self._touch_speed', 'self._speed'),
    _behavior('the way to the touch does not slow down', 'straight_push',
              '+ 2.0 * APPROACH_DECELERATION', '+ 99.0 * APPROACH_DECELERATION'),
    _behavior('a paused push goes on', 'straight_push',
              'if self._progress.stage is not Stage.STOPPING:\n            self._stop()',
              'if False:\n            self._stop()'),
    _behavior('obstacles that come nearer do not count', 'obstacle_guard',
              'clearance + REACTION_TIME * rate < limit', 'clearance < limit - 9.0'),
    _behavior('no time to react to obstacles', 'obstacle_guard',
              'clearance + REACTION_TIME * rate < limit', 'clearance < limit'),
    _behavior('safety stops are not counted', 'progress',
              'self._safety_stops += 1', 'self._safety_stops += 0'),
    _behavior('attempts are not counted', 'progress', 'self._attempts += 1\n        self._insp',
              'self._attempts += 0\n        self._insp'),
    _behavior('an object beside its goal counts as there', 'progress',
              'if (position_error <= settings.position_tolerance - position_margin\n',
              'if (position_error <= settings.position_tolerance + position_margin\n'),
    _behavior('a heading beside its goal counts as there', 'progress',
              'and heading_error <= settings.heading_tolerance - heading_margin):',
              'and heading_error <= settings.heading_tolerance + heading_margin):'),
    _behavior('pushes that nobody sees go on', 'progress',
              'if self._unseen_pushes >= self._max_unseen_pushes:\n            return TaskEvent',
              'if False:\n            return TaskEvent'),
)
CALIBRATIONS = (
    _calibration('a calibration leaves its square',
                 'if is_moving and not self._may_go_on(twist):', 'if False:'),
    _calibration('a calibration goes on without odometry',
                 'if time - self._odometry_arrival > ODOMETRY_TIMEOUT:', 'if False:'),
    _calibration('a calibration goes on with a base that does not move',
                 'if amount < MIN_MOVED_RATIO * abs(expected):', 'if False:'),
    _calibration('a calibration goes on with a base that moves the other way',
                 'if along * expected <= 0.5 * amount * abs(expected):', 'if False:'),
)
MUTANTS = TASKS + PUSHES + CALIBRATIONS
