"""The zero pulse against closed forms of the motion: crossings of one mark per revolution."""

from math import asin, cos, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.drive.axis.index_pulse import IndexPulse
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

S = 1_000_000_000
LEAD_M = 0.01


def pulse(motion: object, angle_deg: float = 0.0, increments: int = 10_000) -> IndexPulse:
    profile = DriveProfile(encoder_increments=increments, index_angle_deg=angle_deg)
    return IndexPulse(profile, lambda time_ns: motion(time_ns / S))  # type: ignore[operator]


@pytest.mark.parametrize("speed_m_s", [0.5, -0.5, 0.003, -2.0])
@pytest.mark.parametrize("angle_deg", [0.0, 90.0, 270.0])
def test_steady_motion_passes_every_mark_at_its_instant(speed_m_s: float, angle_deg: float) -> None:
    """x = x0 + v t is at mark k after (p_k - x0)/v; upwards it rises there, downwards it falls."""
    start_m, end_ns = 0.0123, 50_000_000
    edges = pulse(lambda t: start_m + speed_m_s * t, angle_deg).edges(0, end_ns)
    expected = []
    for number in range(-50, 50):
        mark_m = (number + angle_deg / 360) * LEAD_M
        for side_m, rises_upwards in ((mark_m, True), (mark_m + LEAD_M / 10_000, False)):
            time_ns = (side_m - start_m) / speed_m_s * S
            if 0 < time_ns <= end_ns:
                expected.append((time_ns, rises_upwards is (speed_m_s > 0)))
    expected.sort()
    assert [level for _, level, _ in edges] == [level for _, level in expected]
    for (found_ns, _, _), (time_ns, _) in zip(edges, expected, strict=True):
        assert -0.01 <= found_ns - time_ns <= 1.01


def test_a_motion_that_turns_passes_the_mark_twice() -> None:
    """x = A sin(w t) with A = 5.5 mm, mark at 5 mm: up at asin(5/5.5)/w, down at (pi - ..)/w."""
    amplitude_m, omega = 0.0055, 2 * pi * 5
    edges = pulse(lambda t: amplitude_m * sin(omega * t), 180.0, 1000).edges(0, S // 10)
    rise = asin(0.005 / amplitude_m) / omega * S
    fall = asin(0.00501 / amplitude_m) / omega * S
    half = pi / omega * S
    expected = [(rise, True), (fall, False), (half - fall, True), (half - rise, False)]
    assert [level for _, level, _ in edges] == [level for _, level in expected]
    for (found_ns, _, _), (time_ns, _) in zip(edges, expected, strict=True):
        assert abs(found_ns - time_ns) <= 2


@pytest.mark.parametrize(("direction", "edge_ns"), [(1, 1000), (-1, 1001)])
def test_at_its_lower_side_a_motion_is_on_the_mark(direction: int, edge_ns: int) -> None:
    """At 1000 ns exactly: upwards it is on it then, downwards it leaves it a nanosecond later."""
    profile = DriveProfile(encoder_increments=10_000, index_angle_deg=0.0)
    index = IndexPulse(profile, lambda time_ns: direction * (time_ns - 1000) * 1e-10)
    assert index.edges(500, 2000) == [(edge_ns, direction > 0, 0.0)]
    assert index.edges(500, edge_ns - 1) == []
    assert index.edges(edge_ns, 2000) == []


@pytest.mark.parametrize(
    ("angle_deg", "increment"), [(1.0, 28), (0.04, 1), (0.06, 2), (359.99, 0), (359.9, 9997)]
)
def test_an_angle_is_that_of_the_nearest_increment(angle_deg: float, increment: int) -> None:
    """Of 10000 to a revolution, 0.036 degrees each; half of one before 360 it is that of 0."""
    place_m = increment * LEAD_M / 10_000
    rise, fall = pulse(lambda t: -1e-7 + t, angle_deg).edges(0, S // 90)[:2]
    assert (rise.level, fall.level) == (True, False)
    assert rise.position_m == pytest.approx(place_m, abs=1e-9)
    assert fall.position_m == pytest.approx(place_m + LEAD_M / 10_000, abs=1e-9)


@pytest.mark.parametrize("number", [-3, 0, 2])
@pytest.mark.parametrize(
    ("begin", "end", "rises"),
    [
        *((-5, 2, True), (-5, 0.5, True), (-5, -1, False), (0.5, 5, False), (2, 9, False)),
        *((5, -2, True), (5, 0.5, True), (5, 2, False), (0.5, -5, False), (-2, -9, False)),
        (-5, 10_005, True), (5, -10_005, True), (0.5, 10_000.5, True), (0.5, -9_999.5, True),
    ],
)  # fmt: skip
def test_a_way_upwards_rises_at_the_lower_side_and_one_downwards_at_the_upper(
    begin: float, end: float, number: int, *, rises: bool
) -> None:
    """Places in increments from the lower side of a mark, which is one increment wide."""
    mark, width_m = number + 0.25, LEAD_M / 10_000
    index = pulse(lambda _: 0.0, 90.0)
    begin_m, end_m = (mark * LEAD_M + place * width_m for place in (begin, end))
    assert index.rises_between(begin_m, end_m) is rises
    course = pulse(lambda t: begin_m + (end_m - begin_m) * t, 90.0).edges(0, S)
    assert any(edge.level for edge in course) is rises


def test_standing_on_the_mark_is_no_edge() -> None:
    assert pulse(lambda t: 0.01).edges(0, S) == []


@given(st.lists(st.integers(1, 40_000_000), max_size=8).map(sorted))
@pytest.mark.long
def test_looking_often_or_once_finds_the_same_edges(looks_ns: list[int]) -> None:
    def motion(t: float) -> float:
        return 0.02 * (1 - cos(30 * t))

    index = pulse(motion, 45.0)
    end_ns = 40_000_001
    parts, begin_ns = [], 0
    for look_ns in [*looks_ns, end_ns]:
        parts += index.edges(begin_ns, look_ns)
        begin_ns = look_ns
    assert parts == index.edges(0, end_ns)
