"""Order of rows for the solver: a permutation, stage by stage."""

from helpers.push_problems import face_problem
import numpy as np
from push_model.geometry import Pose
from push_planner.collocation.dimensions import Dimensions
from push_planner.collocation.fatrop_layout import FatropLayout, RowCounts
from push_planner.collocation.transcription import Transcription
from push_planner.push_parameters import PUSH_KINDS
import pytest

COUNTS = RowCounts(dynamics=3, collocation=2, step=9, first_equalities=4, first=6, end=5)
STEPS, SIZE = 4, 7


@pytest.fixture(name='layout')
def make_layout():
    return FatropLayout.build(STEPS, SIZE, COUNTS)


def test_the_order_is_a_bijection(layout):
    """Every row of the blocks is a row of the program, once; and position inverts it."""
    total = STEPS * COUNTS.step + COUNTS.first + COUNTS.end
    assert sorted(layout.order) == list(range(total))
    np.testing.assert_array_equal(layout.order[layout.position], np.arange(total))
    np.testing.assert_array_equal(layout.position[layout.order], np.arange(total))


def test_each_stage_has_dynamics_then_equalities_then_inequalities(layout):
    """Those of the first step alone are in the first stage, those of the end in the last."""
    first = STEPS * COUNTS.step
    end = first + COUNTS.first
    stage = layout.order[:COUNTS.step + COUNTS.first]
    assert list(stage) == [0, 1, 2, *range(first, first + 4), 3, 4, first + 4, first + 5,
                           5, 6, 7, 8]
    for k in range(1, STEPS):
        begin = COUNTS.first + k * COUNTS.step
        assert list(layout.order[begin:begin + COUNTS.step]) == list(
            range(k * COUNTS.step, (k + 1) * COUNTS.step))
    assert list(layout.order[-COUNTS.end:]) == list(range(end, end + COUNTS.end))


def test_dynamics_are_coupled_to_the_states_of_the_next_step(layout):
    """State i of step k + 1 is added to row i of the dynamics of step k."""
    rows = layout.order[layout.coupling_rows]
    for number, (row, variable) in enumerate(zip(rows, layout.coupling_variables)):
        k, i = divmod(number, COUNTS.dynamics)
        assert row == k * COUNTS.step + i
        assert variable == (k + 1) * SIZE + i


@pytest.mark.parametrize('kind', PUSH_KINDS)
@pytest.mark.parametrize('jumps', [False, True])
def test_equalities_of_a_program_come_before_the_inequalities_of_their_stage(kind, jumps):
    """As casadi's structure detection asks for, in every program of the planner."""
    dimensions = Dimensions(kind, len(face_problem(Pose(1.0, 0.0, 0.0)).obj.supports), 3, jumps,
                            True, False)
    transcription = Transcription(dimensions)
    changes = np.flatnonzero(np.diff(transcription.equality.astype(int)) > 0)
    # A new stage begins wherever an equality follows an inequality: n - 1 steps and the end.
    assert len(changes) == dimensions.step_count
    assert transcription.equality[0] and transcription.equality[-1]
