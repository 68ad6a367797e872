"""Mutants of the safety layer: a robot that goes on where it has to stop, or says why wrongly."""

from benchmarks.mutants.mutant import Mutant

TESTS = 'test/safety'
FILES = {'layer': 'test_layer', 'stop': 'test_stop', 'status': 'test_standstill',
         'pose_check': 'test_pose_check', 'odometry_check': 'test_odometry_check',
         'motion_check': 'test_motion_check', 'stamp_check': 'test_stamp_check'}


def _mutant(name: str, module: str, old: str, new: str, first: str = '') -> Mutant:
    return Mutant(name, f'push_safety/{module}.py', old, new,
                  (f'{TESTS}/{first or FILES[module]}.py', TESTS))


LAYER = (
    _mutant('commands that are not finite pass', 'layer',
            'if not all(map(math.isfinite, command)):', 'if False:'),
    _mutant('a stopped robot is commanded on', 'layer',
            'if self.report is None:\n            allowed', 'if True:\n            allowed'),
    _mutant('a robot without odometry does not slow down', 'layer',
            'return min(1.0, max(0.0, 1.0 - (time - since - silence) / SLOWING_TIME))',
            'return 1.0'),
    _mutant('a differential drive is commanded sideways', 'layer',
            "sideways = 0.0 if robot.drive == 'differential' else command.v_y",
            'sideways = command.v_y'),
    _mutant('no limit of speed', 'layer',
            'limit = min(robot.max_speed, robot.max_acceleration',
            'limit = min(9.0, robot.max_acceleration'),
    _mutant('no limit of the yaw rate', 'layer',
            'yaw_limit = min(robot.max_yaw_rate,', 'yaw_limit = min(9.0,'),
    _mutant('every robot that waits for a word is let go on', 'layer',
            'if not controller.awaits_resume:\n            self.resume()',
            'if True:\n            self.resume()', 'test_guard'),
    _mutant('a stop from outside is ignored', 'layer',
            'elif interference is not None:', 'elif False:', 'test_guard'),
    _mutant('a clock that falls back is ignored', 'layer',
            'if self._late_count < AGREEING_MESSAGES or shift < MAX_CLOCK_SHIFT:', 'if True:'),
    _mutant('other commanders are not named', 'layer',
            'if fault is not None and self.other_commanders:', 'if False:'),
    _mutant('odometry that errs is taken for a base that errs', 'layer',
            'return self._odometry_check.early_contradiction() or fault', 'return fault'),
    _mutant('the object is not expected elsewhere with the robot', 'layer',
            'if fault is not None and fault.code is SafetyReason.ODOMETRY_JUMPED:', 'if False:',
            'test_guard'),
    _mutant('a robot that nobody commands stays stopped', 'layer',
            'if not is_commanding:\n            self.release()\n        elif',
            'if not is_commanding:\n            pass\n        elif', 'test_guard'),
)
STOP = (
    _mutant('a stopped robot goes on at once', 'stop',
            'if time - since <= REST_TIME:', 'if time - since < 0.0:'),
    _mutant('a robot that is stopped again goes on as soon', 'stop',
            'return (not has_relapsed or', 'return (True or'),
    _mutant('missing odometry awaits nobody', 'stop', 'if gap > limit:', 'if False:'),
    _mutant('a base that stands awaits nobody', 'stop',
            'elif standstill.is_too_long(', 'elif False and standstill.is_too_long('),
    _mutant('a robot goes on before it rests', 'stop',
            'if is_faulty or not is_at_rest(odometry.twist):', 'if is_faulty:'),
    _mutant('a robot goes on while something is wrong', 'stop',
            'if is_faulty or not is_at_rest(odometry.twist):',
            'if not is_at_rest(odometry.twist):'),
    _mutant('odometry that was missing awaits nobody', 'status',
            'return self in (SafetyReason.BASE_STOOD, SafetyReason.ODOMETRY_WAS_MISSING)',
            'return self in (SafetyReason.BASE_STOOD,)'),
)
POSES = (
    _mutant('a frozen tracker is believed', 'pose_check',
            'if self._noise.is_noisy and self._repetitions > MAX_POSE_REPETITIONS:', 'if False:'),
    _mutant('one pose is enough for a jump', 'pose_check',
            'if self._agreeing >= AGREEING_MESSAGES:', 'if self._agreeing >= 1:'),
    _mutant('no pose is held back', 'pose_check',
            'if gap > MAX_POSE_GAP or not _jumps(accepted.pose, measured.pose, gap):',
            'if True:'),
    _mutant('mistaken headings stay', 'pose_check', 'jump = multiple', 'jump = 0.0'),
    _mutant('objects may turn at any rate', 'pose_check',
            '> OBJECT_JUMP_ROTATION + MAX_OBJECT_YAW_RATE * duration)', '> 99.0)'),
)
ODOMETRY = (
    _mutant('frozen odometry is believed', 'odometry_check',
            'if duration <= REPETITION_TIME or not has_moved:', 'if True:'),
    _mutant('contradictions within a window are believed', 'odometry_check',
            'if (offset <= WINDOW_DISTANCE + WINDOW_RATIO * max(moved, expected)\n',
            'if (offset <= 9.0 + WINDOW_RATIO * max(moved, expected)\n'),
    _mutant('contradictions of rotation are believed', 'odometry_check',
            'and rotation <= WINDOW_ROTATION + WINDOW_RATIO * max(rotated, turned)):',
            'and rotation <= 9.0 + WINDOW_RATIO * max(rotated, turned)):'),
    _mutant('wrong directions are believed', 'odometry_check',
            'if course.travelled < DIRECTION_PATH:', 'if True:'),
    _mutant('lateral errors are believed', 'odometry_check',
            'if abs(lateral) <= constant + LATERAL_RATIO * course.travelled:', 'if True:'),
    _mutant('jumps are believed', 'odometry_check',
            'if (offset <= distance_limit +', 'if (offset <= 99.0 +'),
    _mutant('jumps of the heading are believed', 'odometry_check',
            'and rotation <= rotation_limit +', 'and rotation <= 99.0 +'),
    _mutant('corrections may come at any rate', 'odometry_check',
            'return (odometry.time - self._corrected_at >= CORRECTION_PERIOD\n',
            'return (True\n'),
)
MOTION = (
    _mutant('a base that does not follow is no fault', 'motion_check',
            'if stated > MAX_RESIDUAL_SUM:\n            return True',
            'if stated > MAX_RESIDUAL_SUM:\n            return False'),
    _mutant('a stuck base is no fault', 'motion_check',
            'is_stuck = is_settled and', 'is_stuck = False and'),
    _mutant('a late base is no fault', 'motion_check', 'if delay is not None:', 'if False:',
            'test_layer'),
    _mutant('a base that is known is not held to it', 'motion_check',
            'is_far = close > MAX_RESIDUAL_SUM and self._is_known', 'is_far = False'),
    _mutant('a base that stands is said to move otherwise', 'motion_check',
            'SafetyReason.NOT_MOVING if is_short', 'SafetyReason.MOVES_OTHERWISE if is_short',
            'test_layer'),
    _mutant('what a base did in a gap counts', 'motion_check',
            'if self._is_interrupted or time - last > MAX_MOTION_GAP:',
            'if self._is_interrupted:', 'test_layer'),
)
STAMPS = (
    _mutant('old stamps are accepted', 'stamp_check',
            'return -MAX_STAMP_OFFSET <= difference <=', 'return difference <='),
    _mutant('stamps ahead of time are accepted', 'stamp_check',
            '<= difference <= MAX_STAMP_OFFSET + TIME_RATIO * elapsed', '<= difference'),
    _mutant('time that goes back is not noticed', 'stamp_check',
            'went_back = self._first_candidate < before', 'went_back = False'),
    _mutant('another time is believed at once', 'stamp_check',
            'self._candidate - self._first_candidate >= NEW_CLOCK_TIME)', 'True)'),
)
MUTANTS = LAYER + STOP + POSES + ODOMETRY + MOTION + STAMPS
