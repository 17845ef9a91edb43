"""In which direction an axis reaches a position on a path that bends; how long such a path is."""

import pytest

from axisrig.kernel.measuring.simulated import Way, towards


@pytest.mark.parametrize(
    ("places_mm", "position_mm", "expected"),
    [
        ((0.0, 10.0), 5.0, 1.0),
        ((10.0, 0.0), 5.0, -1.0),
        ((0.0, -3.0, 10.0), 5.0, 1.0),
        ((0.0, -3.0, 10.0), -2.0, -1.0),  # on the way out, before it turns
        ((0.0, 8.0, -1.0), 5.0, 1.0),
        ((0.0, 8.0, 0.0), 5.0, 1.0),
        ((0.0, -8.0, 0.0), -5.0, -1.0),
        ((0.0, 10.0), -1.0, 1.0),  # nowhere: the way as a whole
        ((10.0, 0.0), -1.0, -1.0),
        ((3.0, 3.0), 4.0, 1.0),  # at rest
        ((0.0, 10.0), 0.0, 1.0),
        ((10.0, 0.0), 10.0, -1.0),
    ],
)
def test_an_axis_reaches_a_position_from_the_side_on_which_it_begins(
    places_mm: tuple[float, ...], position_mm: float, expected: float
) -> None:
    assert towards(places_mm, position_mm) == expected


def test_the_way_of_the_tool_counts_beside_degrees() -> None:
    """3 mm and 4 degrees are 5 in all coordinates and 3 mm of the tool."""
    way = Way({"X": 0.0, "A": 0.0}, {"X": 3.0, "A": 4.0}, share=3.0 / 5.0)
    assert way.length_mm == pytest.approx(3.0)
    assert way.travelled_mm({"X": 1.5, "A": 2.0}) == pytest.approx(1.5)
