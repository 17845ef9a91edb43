"""In which direction an axis reaches a position on a path that bends; how long such a path is."""

import pytest

from axisrig.kernel.measuring.simulated import (
    ALL,
    BODY,
    CYCLES,
    FIRST,
    POSITION,
    REST,
    Body,
    SimulatedProbe,
    Way,
    towards,
)


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


STARTS, ENDS = {"X": 0.0, "Z": 20.0}, {"X": 4.0, "Z": 10.0}
BALL = Body({"X": (0.0, 0.0, 4.0, 1.0), "Z": (0.0, 0.0, 10.0, 1.0)})


@pytest.mark.parametrize(
    ("mode", "parameter", "first"),
    [
        (POSITION, 150_000, 50),  # 15 mm, reached from above
        (POSITION, 200_000, 1),
        (POSITION, 90_000, None),  # behind the target
        (CYCLES, 7, 7),
        (REST, 30, 71),  # less than 30 % of its way is left
        (REST, 0, None),
        (ALL, 0, 100),
        (FIRST, 0, 100),
        (BODY, 0, 91),  # sqrt(0.16 + 1) of the whole way is 1.077: 1 mm before the end
    ],
)
def test_a_probe_signals_once_by_its_mode_while_it_is_armed(
    mode: int, parameter: int, first: int | None
) -> None:
    """Z goes 10 mm down in 100 cycles, X 4 mm aside; then it is armed once more at the end."""
    way = Way(STARTS, ENDS, programmed=("X", "Z"))
    places = (20.0, 10.0)
    probe = SimulatedProbe("Z", mode, parameter, way, places, BALL)
    for armed in (False, True):
        if armed:
            probe.arm()
        found = None
        for cycle in range(1, 101):
            share = cycle / 100.0
            here = {name: at + share * (ENDS[name] - at) for name, at in STARTS.items()}
            probe.look(here, here)
            if probe.has_latched and found is None:
                found = cycle
                assert probe.latched_mm == here["Z"]
        assert found == (first if armed else None)
        assert probe.is_confirmed() is (found is not None)
    probe.disarm()
    assert probe.is_clear
    assert probe.latched_mm is None


@pytest.mark.parametrize(
    ("mode", "target_mm", "signals"),
    [
        (REST, {"X": 4.0}, True),  # nothing of its own way is left
        (REST, {"X": 4.0, "Z": 10.0}, False),
        (FIRST, {"X": 4.0}, True),  # it is at its target already
        (FIRST, {"X": 4.0, "Z": 10.0}, False),
        (ALL, {"X": 4.0}, False),
    ],
)
def test_an_axis_that_does_not_move_has_no_way_left(
    mode: int, target_mm: dict[str, float], signals: bool
) -> None:
    way = Way(STARTS, target_mm, programmed=("X", "Z"))
    probe = SimulatedProbe("Z", mode, 1, way, (20.0,))
    probe.arm()
    probe.look(STARTS, STARTS)
    assert probe.has_latched is signals


def test_a_run_begins_with_a_probe_that_waits_for_nothing_and_has_nothing() -> None:
    """Armed, latched and disarmed, twice; cycles count from the arming on, and the first stays."""
    probe = SimulatedProbe("Z", CYCLES, 2, Way(STARTS, ENDS), (20.0, 10.0))
    for begin_mm in (20.0, 15.0):
        assert (probe.is_clear, probe.is_armed, probe.is_confirmed()) == (True, False, False)
        probe.arm()
        for cycle in range(4):
            assert not probe.is_clear
            assert probe.is_confirmed() is (cycle >= 2)
            here = {"X": 0.0, "Z": begin_mm - cycle}
            probe.look(here, here)
        assert probe.latched_mm == begin_mm - 1.0
        probe.is_armed = False  # a latch that nobody has taken
        assert not probe.is_clear
        probe.disarm()
        assert probe.latched_mm is None


MODE_6 = {
    "cuboid": ((6, -10_000, 20_000, 0, 0), (6, 50_000, 60_000, 0, 0), (6, 0, 0, 0, 0)),
    "cylinder": ((6, 0, 0, 10_000, 20_000), (6, 0, 0, -30_000, 20_000), (6, -5_000, 5_000, 0, 0)),
    "ellipsoid": ((6, 0, 0, 0, 10_000), (6, 0, 0, 0, 20_000), (6, 0, 0, 0, 30_000)),
    "of one axis": ((6, 0, 10_000, 0, 0), (1, 50_000, 60_000, 0, 20_000), (0, 0, 0, 0, 0)),
}


@pytest.mark.parametrize(
    ("body", "here_mm", "is_in"),
    [
        ("cuboid", (-1.0, 5.0, 100.0), True),  # on its edge; Z does not limit it
        ("cuboid", (2.0, 6.0, -100.0), True),
        ("cuboid", (-1.001, 5.5, 0.0), False),
        ("cuboid", (0.0, 6.001, 0.0), False),
        ("cylinder", (1.0 + 1.2, -3.0 + 1.6, 0.5), True),  # 2 mm about (1, -3)
        ("cylinder", (1.0 + 1.21, -3.0 - 1.6, 0.0), False),
        ("cylinder", (1.0, -3.0, 0.501), False),
        ("ellipsoid", (0.6, 1.6, 0.0), True),
        ("ellipsoid", (0.6, 1.6, 0.1), False),
        ("ellipsoid", (0.0, 0.0, -3.0), True),
        ("of one axis", (0.5, 0.0, 0.0), True),  # Y has another mode, Z a real probe
        ("of one axis", (1.001, 5.5, 0.0), False),
    ],
)
def test_the_body_of_the_lists_is_a_cuboid_round_or_both(
    body: str, here_mm: tuple[float, ...], is_in: bool
) -> None:
    """P-AXIS-00145 to 00148 in 0.1 um: least, largest, centre, radius."""
    made = Body.of(dict(zip("XYZ", MODE_6[body], strict=True)))
    assert made.contains(dict(zip("XYZ", here_mm, strict=True))) is is_in


def test_a_body_without_limits_is_none() -> None:
    """It would be touched wherever the axes are."""
    assert not Body.of({"X": (6, 0, 0, 0, 0)}).contains({"X": 0.0})


@pytest.mark.parametrize(
    ("offset_mm", "first"),
    [(0.0, 100), (-5.0, 50), (-2.5, 75), (-10.0, 1), (0.1, 101), (5.0, 150), (5.05, 151)],
)
def test_simu_offset_shifts_the_place_of_all_axes_along_the_path(
    offset_mm: float, first: int
) -> None:
    """X goes 6 mm and Z 8 mm, 0.1 mm of the path in a cycle, and on past the target."""
    way = Way({"X": 0.0, "Z": 0.0}, {"X": 6.0, "Z": 8.0}, offset_mm, ("X", "Z"))
    probe = SimulatedProbe("X", ALL, 0, way, (0.0, 6.0))
    probe.arm()
    for cycle in range(1, 160):
        here = {"X": 0.06 * cycle, "Z": 0.08 * cycle}
        probe.look(here, here)
        assert probe.has_latched is (cycle >= first)
    assert probe.latched_mm == pytest.approx(0.06 * first)
