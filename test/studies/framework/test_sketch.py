"""Drawing primitives put their parts where they are told."""

import math

from matplotlib.figure import Figure
import pytest
from studies.framework import sketch


def axes():
    """Return empty axes."""
    return Figure().subplots()


@pytest.mark.parametrize('direction, length, expected', [
    (0.0, 2.0, (3.0, 1.0)), (0.5 * math.pi, 2.0, (1.0, 3.0)), (math.pi, -2.0, (3.0, 1.0))])
def test_polar_point_lies_at_its_distance_and_direction(direction, length, expected):
    assert sketch.polar(direction, length, (1.0, 1.0)) == pytest.approx(expected)


def test_arrow_is_labelled_beyond_its_tip_or_beside_its_shaft():
    beyond, beside = axes(), axes()
    sketch.arrow(beyond, (0.0, 0.0), (2.0, 0.0), 'F')
    sketch.arrow(beside, (0.0, 0.0), (2.0, 0.0), 'F', at=0.5, side=90.0, gap=8.0)
    label = [text for text in beyond.texts if text.get_text()][0]
    assert label.xy == pytest.approx((2.0, 0.0)) and label.xyann == pytest.approx((8.0, 0.0))
    label = [text for text in beside.texts if text.get_text()][0]
    assert label.xy == pytest.approx((1.0, 0.0)) and label.xyann == pytest.approx((0.0, 8.0))


def test_angle_is_an_arc_from_its_begin_towards_its_end():
    drawing = axes()
    sketch.angle(drawing, (1.0, 0.0), 2.0, (0.0, -0.5), 'a')
    x, y = drawing.lines[0].get_data()
    assert [math.hypot(a - 1.0, b) for a, b in zip(x, y)] == pytest.approx([2.0] * len(x))
    assert (x[0], y[0]) == pytest.approx((3.0, 0.0)) and y[-1] < y[0]


def test_dimension_line_is_shifted_to_the_left_of_its_direction():
    drawing = axes()
    sketch.dimension(drawing, (0.0, 0.0), (3.0, 0.0), 'L', shift=0.5)
    arrow = [text for text in drawing.texts if text.arrow_patch is not None][0]
    assert arrow.xyann == pytest.approx((0.0, 0.5)) and arrow.xy == pytest.approx((3.0, 0.5))
