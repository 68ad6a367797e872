"""Draw figures of concepts/physics.md: ``python -m benchmarks.plant.physics_pictures``."""

import math
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
import numpy as np
from push_model.contact import contact_point
from push_model.friction import friction_center
from push_model.parameters import Contact, PushedObject, Support
from push_model.quasi_static import compare_yaw_rates, quasi_static_yaw_rate, vehicle
from studies.analysis.pushing_location import PushingLocation
from studies.analysis.stability import equilibria, tolerances

OUT = Path(__file__).resolve().parents[2] / 'docs' / 'physics'
BLUE, ORANGE, GREEN, GREY, INK = '#0B3C8C', '#C96A00', '#007A5E', '#8A8A8A', '#202020'
# Coefficient of friction at the contact, for the cone and the tolerances; chosen.
FRICTION = 0.5
LOCATIONS = {
    'round on round: R_p 0.5, R_s 0.2, h 0.1 m': PushingLocation(0.5, 0.2, 0.1),
    'round on round: R_p 2.0, R_s 0.2, h 0.15 m': PushingLocation(2.0, 0.2, 0.15),
    'flat face: R_p 0.5, h 0.3 m (stable)': PushingLocation(0.5, math.inf, 0.3),
    'flat face: R_p 0.5, h 0.7 m (unstable)': PushingLocation(0.5, math.inf, 0.7),
}


def square() -> PushedObject:
    """Return the square of 0.4 m on feet at its corners."""
    corners = ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))
    return PushedObject(3.0, supports=tuple(Support(x, y, 0.3) for x, y in corners),
                        outline=corners)


def draw_alpha(axes: Axes, title: str, location: PushingLocation) -> None:
    """Draw alpha over rho, with equilibria, cone and senses of rotation."""
    rho = np.linspace(-0.75, 0.75, 601)
    alpha = location.alpha(location.rotation_at(rho))
    inside = np.abs(rho) <= math.atan(FRICTION)
    alpha[np.abs(np.diff(alpha, append=alpha[-1])) > 1.0] = np.nan
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.plot(rho, np.where(inside, alpha, np.nan), color=BLUE, linewidth=2.2)
    axes.plot(rho, np.where(inside, np.nan, alpha), color=BLUE, linewidth=1.4, linestyle='--')
    rest_positions = equilibria(location)
    for one in (item for item in rest_positions if abs(item.rho) < 0.75):
        axes.plot(one.rho, 0.0, 'o', markersize=8, color=GREEN, zorder=3,
                  markerfacecolor=GREEN if one.is_stable else 'white')
    centre = min(rest_positions, key=lambda one: abs(one.rho))
    if centre.is_stable:
        edges = [item.rho for item in tolerances(location, centre, FRICTION)]
        axes.axvspan(min(edges), max(edges), color=GREEN, alpha=0.12)
    axes.set_title(title, fontsize=10)
    axes.set_xlim(-0.75, 0.75)
    axes.set_ylim(-1.0, 1.0)
    axes.grid(color='#E0E0E0', linewidth=0.6)
    axes.text(-0.72, 0.86, 'turns clockwise', fontsize=8, color=INK)
    axes.text(-0.72, -0.94, 'turns counter-clockwise', fontsize=8, color=INK)


def picture_of_stability() -> Figure:
    """Draw alpha over rho for four locations."""
    figure = Figure(figsize=(10.0, 6.4), layout='constrained')
    grid = figure.subplots(2, 2, sharex=True, sharey=True)
    for axes, (title, location) in zip(grid.flat, LOCATIONS.items()):
        draw_alpha(axes, title, location)
    for axes in grid[1]:
        axes.set_xlabel('pushing angle rho [rad]')
    for axes in grid[:, 0]:
        axes.set_ylabel('alpha [rad]')
    return figure


def draw_vehicle(axes: Axes, obj: PushedObject) -> None:
    """Draw the square as a bicycle driven in reverse."""
    contact = contact_point(obj, Contact('face', 3))
    view, center = vehicle(obj, contact), friction_center(obj)
    axes.add_patch(Polygon(obj.outline, facecolor='#EFE6DA', edgecolor=INK, linewidth=1.5))
    for foot in obj.supports:
        axes.add_patch(Circle((foot.x, foot.y), 0.012, color=GREY, zorder=3))
    axes.plot([contact[0], view.flat_output[0]], [contact[1], view.flat_output[1]], color=BLUE)
    marks = ((contact, 'C', ORANGE, (-0.02, 0.03)), (center, 'F', INK, (-0.005, 0.02)),
             (view.flat_output, 'z', BLUE, (0.015, 0.02)))
    for (x, y), name, colour, (right, up) in marks:
        axes.plot(x, y, 'o', color=colour, zorder=4)
        axes.text(x + right, y + up, name, color=colour, fontsize=12)
    angle = 0.8
    push = math.cos(angle), math.sin(angle)
    axes.annotate('', contact, (contact[0] - 0.14 * push[0], contact[1] - 0.14 * push[1]),
                  arrowprops={'arrowstyle': '-|>', 'color': ORANGE, 'linewidth': 2})
    rate = quasi_static_yaw_rate(obj, contact, *push)
    # The centre of rotation does not move: C moves at a right angle to the line between them.
    pole = contact[0] - push[1] / rate, contact[1] + push[0] / rate
    axes.plot(*pole, 'x', color=GREEN, markersize=9)
    axes.text(pole[0] + 0.015, pole[1] - 0.02, 'centre of rotation', color=GREEN, fontsize=9)
    for x, y in (contact, view.flat_output):
        axes.plot([x, pole[0]], [y, pole[1]], color=GREEN, linewidth=0.8, linestyle=':')
    axes.annotate('', (contact[0], -0.26), (view.flat_output[0], -0.26),
                  arrowprops={'arrowstyle': '<->', 'color': BLUE})
    axes.text(0.0, -0.31, f'wheelbase L = {view.wheelbase:.2f} m', color=BLUE, ha='center',
              va='bottom', fontsize=9)
    axes.set_aspect('equal')
    axes.set_axis_off()


def picture_of_the_vehicle() -> Figure:
    """Draw the vehicle, and its yaw rates beside those of the ellipsoid."""
    figure = Figure(figsize=(10.0, 4.6), layout='constrained')
    left, right = figure.subplots(1, 2)
    obj = square()
    draw_vehicle(left, obj)
    angles = np.linspace(0.0, 1.4, 57)
    rows = compare_yaw_rates(obj, contact_point(obj, Contact('face', 3)), angles)
    lines: tuple[tuple[str, str, dict[str, Any]], ...] = (
        ('supports', 'four supports', {'color': BLUE, 'linewidth': 2.4}),
        ('near_straight', 'vehicle, L = 0.4 m', {'color': GREEN, 'linestyle': '--'}),
        ('ellipsoid', 'ellipsoid, L = 0.6 m', {'color': ORANGE, 'linestyle': '-.'}))
    for name, label, style in lines:
        right.plot(angles, [-getattr(row, name) for row in rows], label=label, **style)
    right.set_xlabel('alpha [rad]')
    right.set_ylabel('clockwise rotation per path length of the contact [rad/m]')
    right.grid(color='#E0E0E0', linewidth=0.6)
    right.legend(frameon=False)
    return figure


def main() -> None:
    """Write both figures."""
    OUT.mkdir(parents=True, exist_ok=True)
    picture_of_stability().savefig(OUT / 'stability.png', dpi=110)
    picture_of_the_vehicle().savefig(OUT / 'vehicle.png', dpi=110)


if __name__ == '__main__':
    main()
