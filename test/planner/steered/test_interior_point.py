"""The planner's own method: each row and step against casadi's program, and how it converges."""

import casadi as ca
from helpers.push_problems import (
    DIFFERENTIAL, face_problem, HOLONOMIC, round_problem, vertex_problem)
from helpers.whole_program import first_program, random_iterate, WholeProgram, wrong_rows
import numpy as np
from push_dynamics import machine_code
from push_model.geometry import Pose
from push_planner.steered.collocation import interior_point, newton_step, push_solver
from push_planner.steered.collocation.interior_point import (
    InteriorPointMethod, Iterate, LAST_BARRIER)
from push_planner.steered.collocation.transcription import PushRows
import pytest

GOAL = Pose(1.9, 0.7, -0.2)
PROBLEMS = {
    'held face': face_problem(GOAL),
    'without a cone': face_problem(GOAL, angle_limit='angle'),
    'jumps, heading free': face_problem(GOAL, pushing_angles='constant', heading_free=True),
    'rolling': face_problem(Pose(1.5, 0.05, 0.05), robot_yaw='fixed', final_straight=0.0),
    'round': round_problem(GOAL),
    'held vertex': vertex_problem(GOAL, HOLONOMIC),
    'differential': vertex_problem(GOAL, DIFFERENTIAL)}
KINDS = pytest.mark.parametrize('problem', PROBLEMS.values(), ids=PROBLEMS)


@pytest.mark.slow
@KINDS
def test_each_row_and_each_newton_step_is_that_of_the_whole_program(problem):
    """At random points: values, slopes and curvatures, bounds among them, and the error."""
    formulation, guess = first_program(problem)
    whole = WholeProgram(formulation.dimensions)
    for seed in range(3):
        iterate = random_iterate(formulation, guess, np.random.default_rng(seed))
        assert wrong_rows(formulation, iterate, whole) == []


class Planted(PushRows):
    """
    Rows some of which are wrong.

    Attribute, set before one is built: ``errors``, (block, kind, number) of a row -> function of
    the states of the block, which is added to the row.
    """

    errors = {}

    def __init__(self, dimensions):
        """Add the errors."""
        super().__init__(dimensions)
        for (block, kind, number), error in self.errors.items():
            rows = getattr(self, block)
            added = error(self.end if block == 'of_end' else self.symbols.variables)
            if kind == 'equality':
                column = ca.vertcat(*rows.equalities)
                column[number] += added
                rows.equalities[:] = [column]
            else:
                constraint, row = rows.inequalities[number]
                rows.inequalities[number] = constraint, row + added


@pytest.fixture(name='case', scope='module')
def make_case():
    """Program of a kind that has all rows: (formulation, iterate, whole program)."""
    formulation, guess = first_program(PROBLEMS['differential'])
    iterate = random_iterate(formulation, guess, np.random.default_rng(4))
    return formulation, iterate, WholeProgram(formulation.dimensions)


@pytest.fixture(name='found_with')
def make_found_with(case, monkeypatch):
    """Compare a method that has wrong rows with the whole program, which has them right."""
    # Interpreted: to compile each of many wrong programs takes longer.
    monkeypatch.setattr(machine_code, '_compile', lambda *_: None)
    monkeypatch.setattr(newton_step, 'PushRows', Planted)
    monkeypatch.setattr(interior_point, 'newton_functions',
                        newton_step.newton_functions.__wrapped__)

    def found_with(errors):
        monkeypatch.setattr(Planted, 'errors', errors)
        return wrong_rows(*case)
    return found_with


def all_rows():
    """List (block, kind, number) of each row."""
    rows = PushRows(first_program(PROBLEMS['differential'])[0].dimensions)
    return [(block, kind, number) for block in PLACES
            for kind, count in (
                ('equality', ca.vertcat(*getattr(rows, block).equalities).numel()),
                ('inequality', len(getattr(rows, block).inequalities)))
            for number in range(count)]


# Where a row is looked for, by its block: of the steps in one of them.
PLACES = {'of_step': 'step 3', 'of_first': 'first', 'of_end': 'end'}
ROWS = pytest.mark.parametrize('row', [
    ('of_step', 'equality', 0), ('of_step', 'equality', 8), ('of_step', 'inequality', 0),
    ('of_step', 'inequality', 9), ('of_first', 'equality', 4), ('of_first', 'inequality', 2),
    ('of_end', 'equality', 1), ('of_end', 'equality', 4)], ids=str)


def title(row):
    """Name a row as the comparison does."""
    block, kind, number = row
    return f'{PLACES[block]}, {kind} {number}'


@pytest.mark.slow
def test_nothing_is_found_without_an_error(found_with):
    assert found_with({}) == []


@pytest.mark.slow
def test_every_wrong_value_is_found(found_with):
    """Each row is off by a constant."""
    found = found_with({row: lambda states: 1e-4 for row in all_rows()})
    assert {title(row) for row in all_rows()} <= set(found)


@pytest.mark.slow
@ROWS
def test_no_other_row_is_named(found_with, row):
    found = found_with({row: lambda states: 1e-4})
    names = {name for name in found if name.startswith(('step', 'first', 'end'))}
    assert title(row) in names
    assert all(name.endswith(f'{row[1]} {row[2]}') for name in names)


def deviation(case, row, power):
    """Make an error that is 0 in one place, and so are its derivatives below a power."""
    formulation, iterate, _ = case
    first = first_variable(case, row)
    value = float(iterate.primal[first + 2])
    assert formulation.dimensions.step_size < first or row[0] == 'of_first'
    return lambda states: 1e-2 * (states[2] - value) ** power


def first_variable(case, row):
    """Find the first variable of the block in which a row is looked for."""
    dimensions = case[0].dimensions
    step = {'of_step': 3, 'of_first': 0, 'of_end': dimensions.step_count}[row[0]]
    return step * dimensions.step_size


@pytest.mark.slow
def test_every_wrong_slope_is_found(found_with, case):
    """By the pushing angle, at a point where each row has its right value."""
    found = found_with({row: deviation(case, row, 1) for row in all_rows()})
    assert {title(row) for row in all_rows()} <= set(found)


@pytest.mark.slow
@ROWS
def test_a_wrong_curvature_is_found(found_with, case, row):
    """By the pushing angle, at a point where the row has its right value and slope."""
    found = found_with({row: deviation(case, row, 2)})
    assert f'variable {first_variable(case, row) + 2}' in found
    assert title(row) not in found


def full_steps(formulation, iterate, count):
    """Take full Newton steps from a solution: (error of each iterate, the last one)."""
    memory = InteriorPointMethod(formulation.dimensions)._memory
    memory.set_program(formulation.common, formulation.steps,
                       push_solver.method_bounds(formulation.bounds))
    memory.resume(iterate, has_slacks=True)
    errors = []
    for _ in range(count):
        judgement = memory.evaluate()
        errors.append(max(judgement.error, abs(judgement.excess - LAST_BARRIER)))
        assert memory.find_step()
        memory.take_step()
    return errors, Iterate(memory.primal, memory.dual)


@pytest.fixture(name='solved', params=PROBLEMS)
def make_solved(request):
    """Solve a program: (formulation, guess, iterate)."""
    formulation, guess = first_program(PROBLEMS[request.param])
    result = push_solver.push_solver(formulation.dimensions).solve(formulation, guess)
    return formulation, guess, result.iterate


def test_it_converges_with_order_three_halves_at_least(solved):
    """From the tolerance of the planner to rounding within six steps."""
    formulation, _, iterate = solved
    errors, _ = full_steps(formulation, iterate, 7)
    assert errors[0] > 1e-6
    assert min(errors) < 1e-10
    for error, next_error in zip(errors, errors[1:]):
        if error > 1e-7:
            assert next_error < 30.0 * error ** 1.5


@pytest.mark.slow
def test_at_rounding_it_agrees_with_ipopt_in_every_number(solved):
    """On the program with the same barriers: variables and multipliers, with their signs."""
    formulation, guess, iterate = solved
    whole = WholeProgram(formulation.dimensions)
    x, duals = whole.ipopt(formulation, guess, LAST_BARRIER)
    _, last = full_steps(formulation, iterate, 7)
    own = whole.multipliers(last.dual)
    np.testing.assert_allclose(last.primal[:len(x)], x, atol=1e-6)
    np.testing.assert_allclose(own.equalities, duals.equalities, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(own.inequalities, duals.inequalities, rtol=1e-5, atol=1e-6)
    assert own.inequalities.min() > 0.0
