"""Mutants of estimation: poses that are believed wrongly, and events that nobody notices."""

from benchmarks.mutants.mutant import Mutant

PERCEPTION = 'test/control/perception'
STEERED = 'test/control/steered/estimation'
# Files that are the quickest to notice.
FILES = {
    'displacement': 'test_displacement.py', 'contact_consistency': 'test_contact_consistency.py',
    'measurement_watch': 'test_measurement_watch.py', 'lost_robot': 'test_lost_robot.py',
    'measurement_faults': '../steered/test_monitors.py',
    'ensemble/measurement_update': 'ensemble/test_push_ensemble.py'}


def _perception(name: str, module: str, old: str, new: str) -> Mutant:
    return Mutant(name, f'push_control/perception/{module}.py', old, new,
                  (f'{PERCEPTION}/{FILES[module]}', PERCEPTION))


def _steered(name: str, module: str, old: str, new: str) -> Mutant:
    return Mutant(name, f'push_control/steered/estimation/{module}.py', old, new,
                  (f'{STEERED}/test_{module}.py', STEERED))


MUTANTS = (
    _perception('outliers are believed', 'ensemble/measurement_update',
                'if test.squared_distance > OUTLIER_GATE:', 'if False:'),
    _perception('an object that was moved is never found', 'ensemble/measurement_update',
                'if state.outliers < MAX_OUTLIERS:', 'if True:'),
    _perception('headings are not wrapped', 'ensemble/measurement_update',
                'innovation[2] = wrap_angle(innovation[2])\n        return update',
                'return update'),
    _perception('biases of poses count twice', 'ensemble/measurement_update',
                'objects = objects + bias.errors(robots, objects)\n        return relative',
                'objects = objects - bias.errors(robots, objects)\n        return relative'),
    _perception('contacts tell nothing of the robot', 'ensemble/measurement_update',
                'first = 0 if is_coupled else OBJECT_COLUMNS', 'first = OBJECT_COLUMNS'),
    _perception('poses are averaged without end', 'ensemble/measurement_update',
                'if any(missing) and members.contact_ratio == 0.0:', 'if False:'),
    _perception('a push that leads elsewhere leaves the robot known',
                'ensemble/measurement_update', 'if was_pushed:', 'if False:'),
    _perception('an object that comes back was displaced', 'displacement',
                'return Displacement.RETURNED', 'return Displacement.DISPLACED'),
    _perception('every push displaces', 'displacement',
                'if not _exceeds(shift, driven):', 'if False:'),
    _perception('no displacement is noticed', 'displacement',
                'if not _exceeds(shift, driven):', 'if True:'),
    _perception('an excursion never ends', 'displacement',
                'if (measured.time - one.time < MAX_EXCURSION\n', 'if (True\n'),
    _perception('no contact refutes', 'contact_consistency',
                'return self._contradictions >= MAX_CONTRADICTIONS', 'return False'),
    _perception('good contacts do not count', 'contact_consistency',
                'if contact is Touch.PUSHED and position_std <= FITTING_STD:', 'if False:'),
    _perception('taps to the side do not count', 'contact_consistency',
                'elif self._lateral_excess > LATERAL_SIGMAS', 'elif 0.0 > LATERAL_SIGMAS'),
    _perception('measurements that fail by turns are used', 'measurement_watch',
                'if time - self._bad_at >= recovery:', 'if True:'),
    _perception('late poses are not named', 'measurement_watch',
                'if not is_late:\n', 'if True:\n'),
    _perception('old poses are used', 'measurement_faults',
                'if age > settings.pose_timeout:', 'if False:'),
    _perception('old odometry is used', 'measurement_faults',
                'if age > settings.odometry_timeout:', 'if False:'),
    _perception('a tracker that has erred leaves its mistake', 'lost_robot',
                'return RestoreRobot(memory, RESTORED_STD)', 'return None'),
    _perception('slip is never inferred', 'lost_robot',
                'if not self._is_odometry_drifting:', 'if True:'),
    _perception('faults of odometry leave the robot known', 'lost_robot',
                'return InflateRobot(stds) if self._estimate.position_deviation < stds[0] else '
                'None', 'return None'),
    _steered('rejected poses are forgotten', 'estimator',
             'self.rejected_poses += 1', 'self.rejected_poses += 0'),
    _steered('an object that was moved is not followed', 'estimator',
             'if is_possible and len(self._rejected) == AGREEING_COUNT:', 'if False:'),
    _steered('what poses say against odometry is not added up', 'estimator',
             'if displacement > MAX_DISPLACEMENT:', 'if False:'),
    _steered('poses that fit nothing are not named', 'estimator',
             'if (len(rejected) < AGREEING_COUNT\n', 'if (True\n'),
    _steered('a gap in odometry is driven through', 'estimator',
             'if odometry.time - last > 2.0 * timeout:', 'if False:'),
    _steered('drift is corrected the wrong way', 'dead_reckoning',
             'transform((drift.gap, -drift.slip))', 'transform((drift.gap, drift.slip))'),
    _steered('the heading error is not averaged', 'dead_reckoning',
             'averaged = robot.heading_error + min(1.0,', 'averaged = robot.heading_error + 0.0 * '
             'min(1.0,'),
    Mutant('slip is said to the other side', 'push_control/steered/estimation/cusum.py',
           'return 1 if above > self._threshold else -1',
           'return -1 if above > self._threshold else 1',
           (f'{STEERED}/test_contact_detection.py', STEERED)),
)
