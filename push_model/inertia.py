"""Moment of inertia of an object of which only mass and outline are known."""


def plate_inertia(mass, outline, radius=0.0):
    """
    Moment of inertia about the vertical axis through the mass centre [kg m^2].

    That of a uniform plate in the shape of the outline, about its centroid. It is also taken where
    the mass centre is elsewhere: what moves it is thought to be spread out as far as the plate.

    :param mass: [kg].
    :param outline: vertices (x, y) of a polygon, counter-clockwise [m]; empty for a disc.
    :param radius: of the disc [m].
    :return: inertia [kg m^2].
    """
    if not outline:
        return 0.5 * mass * radius ** 2
    # Triangles between the centroid of the vertices, which is inside, and the edges.
    count = len(outline)
    o_x, o_y = sum(x for x, _ in outline) / count, sum(y for _, y in outline) / count
    area, first_x, first_y, second = 0.0, 0.0, 0.0, 0.0
    for i, (x, y) in enumerate(outline):
        a_x, a_y = outline[i - 1][0] - o_x, outline[i - 1][1] - o_y
        b_x, b_y = x - o_x, y - o_y
        part = 0.5 * (a_x * b_y - a_y * b_x)
        area += part
        first_x += part * (a_x + b_x) / 3.0
        first_y += part * (a_y + b_y) / 3.0
        second += part * (a_x * a_x + a_x * b_x + b_x * b_x
                          + a_y * a_y + a_y * b_y + b_y * b_y) / 6.0
    return mass * (second / area - (first_x / area) ** 2 - (first_y / area) ** 2)
