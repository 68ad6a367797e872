"""Points of a convex polygon; plain scalar code that numba compiles as it stands."""

import math


def closest_on_polygon(outline, x, y):
    """
    Find the point of a convex polygon's boundary that is closest to a point.

    :param outline: vertices, counter-clockwise, shape (k, 2) [m].
    :param x: the point, x [m].
    :param y: the point, y [m].
    :return: (x, y) of the closest point [m], (x, y) of the unit normal into the polygon there,
        signed distance [m] (negative inside), face number, position along that face in [0, 1].
    """
    best, face, along = math.inf, 0, 0.0
    closest_x, closest_y = 0.0, 0.0
    inside = True
    count = len(outline)
    for i in range(count):
        x0, y0 = outline[i]
        x1, y1 = outline[(i + 1) % count]
        ex, ey = x1 - x0, y1 - y0
        if ex * (y - y0) - ey * (x - x0) < 0.0:
            inside = False
        u = ((x - x0) * ex + (y - y0) * ey) / (ex * ex + ey * ey)
        u = min(1.0, max(0.0, u))
        px, py = x0 + u * ex, y0 + u * ey
        squared = (px - x) * (px - x) + (py - y) * (py - y)
        if squared < best:
            best, face, along, closest_x, closest_y = squared, i, u, px, py
    away = math.sqrt(best)
    sign = -1.0 if inside else 1.0
    if away > 1e-9 and (along == 0.0 or along == 1.0):
        nx, ny = sign * (closest_x - x) / away, sign * (closest_y - y) / away
        return closest_x, closest_y, nx, ny, sign * away, face, along
    # The face's own normal is exact however near the point is: a point robot needs that.
    x0, y0 = outline[face]
    x1, y1 = outline[(face + 1) % count]
    length = math.hypot(x1 - x0, y1 - y0)
    return closest_x, closest_y, (y0 - y1) / length, (x1 - x0) / length, sign * away, face, along


def lowest_vertex(outline, n_x, n_y):
    """
    Find the number of the vertex that lies lowest along a direction.

    :param outline: vertices, shape (k, 2) [m].
    :param n_x: direction, x.
    :param n_y: the same, y.
    """
    found, lowest = 0, math.inf
    for i in range(len(outline)):
        height = n_x * outline[i][0] + n_y * outline[i][1]
        if height < lowest:
            found, lowest = i, height
    return found
