"""All mutants, by the part of the program that they are in."""

from benchmarks.mutants.estimation_mutants import MUTANTS as ESTIMATION
from benchmarks.mutants.goal_mutants import MUTANTS as GOALS
from benchmarks.mutants.safety_mutants import MUTANTS as SAFETY
from benchmarks.mutants.supervision_mutants import MUTANTS as SUPERVISION
from benchmarks.mutants.verdict_mutants import MUTANTS as VERDICT

GROUPS = {'safety': SAFETY, 'supervision': SUPERVISION, 'estimation': ESTIMATION,
          'goals': GOALS, 'verdict': VERDICT}
