"""
Many cases of a varied push at once: their columns in, their results out, one row for each case.

The columns are checked as arrays, and one compiled loop runs all cases. Objects and plants are
made only for the cases that somebody opens (``VariedPush.plant`` and ``run``).
"""

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray
from push_dynamics import layout
from push_dynamics.cases import CaseEnd
from push_model.geometry import FloatArray
from push_scenario.batch.case_arrays import (
    CaseEncoder, Cases, object_poses_of, object_twists_of,
)
from push_scenario.batch.varied_push import CaseColumns, CaseValues, COLUMNS, VariedPush
from push_sim_node.truth import Energy

# Rows of cases, with named fields.
CaseRows = NDArray[np.void]
# Poses and velocities of a result, in the order of ``Truth``.
POSE_COLUMNS = tuple(f'{name}_{axis}' for name in ('object', 'object_v', 'robot', 'robot_v')
                     for axis in ('x', 'y', 'theta'))
COUNTS = {'mode': np.uint8, 'steps': np.int64, 'unsolved_steps': np.int64}
ENERGIES = {'work': layout.WORK, 'support_loss': layout.SUPPORT_LOSS,
            'contact_loss': layout.CONTACT_LOSS, 'impact_loss': layout.IMPACT_LOSS,
            'integration_loss': layout.INTEGRATION_LOSS}


def simulate_cases(push: VariedPush, values: CaseValues) -> CaseRows:
    """
    Simulate many cases of a push.

    :param push: the ``VariedPush``.
    :param values: its columns, arrays whose first axis counts the cases.
    :return: rows, shape (n,), with these columns and the results as fields: poses and velocities
        (``object_x``, ...), energies and ``time`` at the end, ``mode`` (``ContactMode.code``) of
        the last step, ``steps``, ``unsolved_steps`` and ``end`` (``CaseEnd``). Results of cases
        that are refused are nan; ``refusal`` returns the reason.
    :raises ValueError: for an unknown column, and for shapes that do not fit.
    """
    columns = push.columns(values)
    cases = CaseEncoder(push, columns).encode()
    cases.arrays.run(push.step, push.lost_gap)
    rows = np.zeros(len(cases.arrays.ends), row_type(columns))
    for name, column in columns.items():
        rows[name] = column
    _write_results(rows, cases)
    return rows


def row_type(columns: CaseColumns) -> np.dtype[np.void]:
    """
    Describe a row: columns of the case, then its results.

    :param columns: as ``VariedPush.columns`` returns them.
    """
    given = [(name, np.float64, columns[name].shape[1:]) for name in COLUMNS if name in columns]
    floats = (*POSE_COLUMNS, *Energy._fields, 'time')
    results = [*((name, np.float64) for name in floats), *COUNTS.items(), ('end', np.uint8)]
    return np.dtype([*given, *results])


def case_values(row: np.void) -> dict[str, FloatArray]:
    """
    Take from a row what it changes of the push; ``VariedPush.plant`` opens it.

    :param row: one of those that ``simulate_cases`` returns.
    """
    names = row.dtype.names or ()
    return {name: np.array(row[name]) for name in COLUMNS if name in names}


def refusal(push: VariedPush, row: np.void) -> str:
    """
    Return why a case was refused; empty where it was not.

    :param push: the ``VariedPush``.
    :param row: one of those that ``simulate_cases`` returns.
    """
    if row['end'] != CaseEnd.REFUSED:
        return ''
    try:
        # Without steps, as all that is refused is found before.
        dataclasses.replace(push, step=math.inf).run(case_values(row))
    except ValueError as error:
        return str(error)
    raise RuntimeError(f'case: got {case_values(row)} refused, expected that it cannot be run')


def _write_results(rows: CaseRows, cases: Cases) -> None:
    """Write what the arrays hold at the end."""
    arrays, states = cases.arrays, cases.arrays.states
    poses = np.column_stack([
        object_poses_of(states, cases.centers), object_twists_of(states, cases.centers),
        states[:, layout.ROBOT_X:layout.ROBOT_OMEGA + 1]])
    is_refused = arrays.ends == CaseEnd.REFUSED
    values = {**dict(zip(POSE_COLUMNS, poses.T)), 'kinetic': _kinetic_energies(cases),
              **{name: states[:, place] for name, place in ENERGIES.items()},
              'time': arrays.times}
    for name, numbers in values.items():
        rows[name] = np.where(is_refused, math.nan, numbers)
    rows['mode'] = states[:, layout.MODE]
    rows['steps'] = states[:, layout.STEPS]
    rows['unsolved_steps'] = states[:, layout.UNSOLVED_STEPS]
    rows['end'] = arrays.ends


def _kinetic_energies(cases: Cases) -> FloatArray:
    """Compute ``m v^2 / 2 + I omega^2 / 2`` [J]."""
    bodies, states = cases.arrays.bodies, cases.arrays.states
    v_x, v_y, omega = states[:, layout.V_X:layout.OMEGA + 1].T
    return 0.5 * (bodies[:, layout.MASS] * (v_x * v_x + v_y * v_y)
                  + bodies[:, layout.INERTIA] * omega * omega)
