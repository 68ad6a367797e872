"""Tables 2.1 and 2.2: notation of the models, and default physical parameters."""

from typing import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from push_model.parameters import GRAVITY, plate_inertia
from studies.framework import plot_style
from studies.framework.box import BOX, rectangle
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

BOTH = 'both'
DYNAMIC = 'dynamic'
QUASI_STATIC = 'quasi-static'
# Symbol, meaning, unit, and the model that it belongs to.
NOTATION = (
    ('$v_C$', 'velocity that the robot imposes at the contact C', 'm/s', BOTH),
    ('$\\rho$', 'pushing angle, from the contact normal n to $v_C$', 'rad', BOTH),
    ('$\\alpha$', 'angle from the line C-F to $v_C$', 'rad', BOTH),
    ('$\\theta, \\omega$', 'orientation and yaw rate of the object', 'rad, rad/s', BOTH),
    ('$s_i, N_i, \\mu_i$', 'support point i: position, load, friction', 'm, N, 1', BOTH),
    ('$q_i$', 'friction capacity of support point i, $\\mu_i N_i$', 'N', BOTH),
    ('$F$', 'centre of friction, $\\sum q_i s_i / \\sum q_i$', 'm', BOTH),
    ('$\\mu_c$', 'friction coefficient at the contact', '1', BOTH),
    ('$R_p, R_s$', 'radius of the robot, of the object at the contact', 'm', BOTH),
    ('$R_e$', 'effective radius, $R_p R_s / (R_p + R_s)$', 'm', BOTH),
    ('$m, I$', 'mass, moment of inertia about the mass centre G', 'kg, kg m²', DYNAMIC),
    ('$r_G$', 'from the contact to the mass centre', 'm', DYNAMIC),
    ("$\\omega'$", 'yaw acceleration', 'rad/s²', DYNAMIC),
    ('$F_C$', 'force of the robot on the object, $m a_G - \\sum f_i$', 'N', BOTH),
    ('$r$', 'distance from C to F', 'm', QUASI_STATIC),
    ('$c^2$', 'mean square of the support points along the push', 'm²', QUASI_STATIC),
    ('$L$', 'wheelbase, $(r^2 + c^2) / r$', 'm', QUASI_STATIC),
    ('$z$', 'flat output point, which never moves sideways', 'm', QUASI_STATIC))
DEFAULTS = (*BOX, Parameter('robot_radius', 'm', 'radius of the robot of case study 3'),
            Parameter('speed', 'm/s', 'speed of the push of case study 3'))
# Chosen: places of the columns, as a fraction of the width.
COLUMNS = (0.0, 0.19, 0.68, 0.84)


def compute_notation(_: Values, __: RunJobs) -> Outcome:
    """List the notation."""
    names = ('symbol', 'meaning', 'unit', 'model')
    return Outcome({'notation': dict(zip(names, map(list, zip(*NOTATION))))}, {
        'symbols': Finding(len(NOTATION), '', 'number of rows'),
        'dynamic': Finding(sum(row[-1] == DYNAMIC for row in NOTATION), '', 'rows of the dynamic '
                           'model only')})


def compute_defaults(values: Values, _: RunJobs) -> Outcome:
    """List the values."""
    rows = [(value.parameter.name, value.parameter.meaning, f'{value.value:g}',
             value.parameter.unit or '1') for value in values]
    outline = rectangle(values.box_length, values.box_width)
    rows += [('inertia', 'moment of inertia of the box, uniform plate',
              f'{plate_inertia(values.mass, outline):.3g}', 'kg m^2'),
             ('supports', 'support points of the box, one at each corner', '4', '1'),
             ('gravity', 'acceleration by gravity', f'{GRAVITY:g}', 'm/s^2')]
    names = ('name', 'meaning', 'value', 'unit')
    return Outcome({'defaults': dict(zip(names, map(list, zip(*rows))))}, {
        'count': Finding(len(rows), '', 'number of parameters')})


def draw(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Write the table."""
    axes = figure.subplots()
    axes.set_axis_off()
    (table,) = outcome.tables.values()
    rows = list(zip(*table.values()))
    axes.set_ylim(len(rows) + 0.6, -0.6)
    axes.set_xlim(0.0, 1.0)
    _write_row(axes, list(table), 0, plot_style.GREY)
    axes.axhline(0.5, color=plot_style.GREY, linewidth=0.8)
    for row_index, row in enumerate(rows, 1):
        _write_row(axes, row, row_index, plot_style.INK)


def _write_row(axes: Axes, texts: Sequence[str], row_index: int, color: str) -> None:
    for x, text in zip(COLUMNS, texts):
        axes.text(x, row_index, text.replace('_', ' ') if '$' not in text else text, color=color,
                  va='center')


STUDIES = (
    Study('T2.1', 'Notation of the dynamic and the quasi-static model', (), compute_notation, draw,
          'Of {symbols:.0f} quantities the dynamic model alone needs {dynamic:.0f}: mass, moment '
          'of inertia and what follows from them.',
          'The quasi-static model keeps geometry and ratios of friction; see the '
          '[nomenclature](nomenclature.md).', (7.6, 5.4)),
    Study('T2.2', 'Default physical parameters', DEFAULTS, compute_defaults, draw,
          'The {count:.0f} values that hold where a figure states no others.',
          'They are household values; those of the thesis were not at hand.', (7.6, 3.4)))
