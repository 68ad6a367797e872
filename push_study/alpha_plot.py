"""Alpha over rho, with the sense in which the object turns."""

import numpy as np
from push_study import paper

ARROWS = 9


def draw(axes, places, alpha, label, solid=None):
    """
    Draw alpha with an arrow for the sense of rotation on each stretch, and where it is 0.

    :param axes: matplotlib axes.
    :param places: what alpha is drawn over, array.
    :param alpha: angle from the line to the friction centre to the push [rad], array.
    :param label: of the horizontal axis.
    :param solid: array of bool: where the line is solid; elsewhere it is dashed; None for all.
    """
    solid = np.ones_like(alpha, dtype=bool) if solid is None else solid
    axes.axhline(0.0, color=paper.GREY, linewidth=0.8)
    axes.plot(places, paper.split_where(solid, alpha), **paper.series(0))
    axes.plot(places, paper.split_where(~solid, alpha), color=paper.SERIES[0][0],
              linestyle=(0, (4, 2)), linewidth=1.4)
    for index in np.linspace(0, len(places) - 1, ARROWS + 2).astype(int)[1:-1]:
        if abs(alpha[index]) > 1e-9:
            paper.rotation_arrow(axes, places[index], alpha[index], bool(alpha[index] > 0.0))
    axes.set_xlabel(label)
    axes.set_ylabel('$\\alpha$ [rad]')
    axes.set_xlim(places[0], places[-1])
    axes.margins(y=0.18)
