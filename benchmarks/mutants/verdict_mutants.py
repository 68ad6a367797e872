"""Mutants of the verdict on faults: a campaign that cannot fail."""

from benchmarks.mutants.mutant import Mutant

TESTS = ('test/benchmarks/test_verdict.py',)


def _mutant(name: str, old: str, new: str) -> Mutant:
    return Mutant(name, 'benchmarks/faults/verdict.py', old, new, TESTS)


MUTANTS = (
    _mutant('every robot stands', 'if any(sent.twist != STOP for sent in (',
            'if False and any(sent.twist != STOP for sent in ('),
    _mutant('every robot may brake for ever',
            'if not all(_size(sent.twist) <= _braking_limit(', 'if False and not all(_size(sent.'
            'twist) <= _braking_limit('),
    _mutant('a robot that moves in truth stands',
            'return is_base_driven or (', 'return True or ('),
    _mutant('every run that says so is done', 'if not is_truly_done(record, fault):',
            'if False:'),
    _mutant('every reason names the fault',
            'elif not set(reasons).intersection(simulated.codes):', 'elif False:'),
    _mutant('the object may be anywhere', 'if moved > expectation.deviation else [])]',
            'if moved > 20.0 else [])]'),
    _mutant('any time is soon enough',
            'stop.duration > expectation.stop_time + ROUNDING)', 'False)'),
    _mutant('any distance is short enough', 'stop.driven > expectation.driven)', 'False)'),
    _mutant('a robot need not stop', 'return [Violation.NEVER_STOPS] if lasts else []',
            'return []'),
    _mutant('the object may point anywhere',
            'and abs(wrap_angle(object_pose[2] - goal.theta)) <= (', 'and True or (0.0,) <= ('),
)
