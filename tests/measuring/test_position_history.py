"""The history of positions against motions whose place at every instant is known."""

import pytest

from axisrig.kernel.measuring.position_history import DEPTH, PositionHistory

MS = 1_000_000
SYNC_NS = 48_000


def _history(count: int, place: object, depth: int = DEPTH) -> PositionHistory:
    history = PositionHistory(depth)
    for number in range(count):
        time_ns = number * MS + SYNC_NS
        history.take(time_ns, place(time_ns * 1e-9))  # type: ignore[operator]
    return history


@pytest.mark.parametrize("time_ns", [48_000, 700_000, 3_000_001, 8_500_000, 9_048_000])
def test_constant_speed_is_exact_everywhere(time_ns: int) -> None:
    history = _history(10, lambda t: 20.0 - 16.0 * t)
    place_mm, speed_mm_ns = history.at(time_ns)
    assert place_mm == pytest.approx(20.0 - 16.0e-9 * time_ns, abs=1e-12)
    assert speed_mm_ns * 1e9 == pytest.approx(-16.0, abs=1e-6)


@pytest.mark.parametrize("time_ns", [1_200_000, 4_548_000, 7_999_999])
def test_constant_acceleration_is_exact_inside(time_ns: int) -> None:
    """x = 1000/2 t^2: a straight line would miss it by 0.125 um."""
    history = _history(10, lambda t: 500.0 * t * t)
    t_s = time_ns * 1e-9
    place_mm, speed_mm_ns = history.at(time_ns)
    assert place_mm == pytest.approx(500.0 * t_s * t_s, abs=1e-12)
    assert speed_mm_ns * 1e9 == pytest.approx(1000.0 * t_s, abs=1e-6)


@pytest.mark.parametrize("time_ns", [548_000, 8_548_000])
def test_at_its_ends_the_history_is_a_straight_line(time_ns: int) -> None:
    """Half way between two samples of x = a/2 t^2 a line is a h^2/8 too high."""
    history = _history(10, lambda t: 500.0 * t * t)
    t_s = time_ns * 1e-9
    place_mm, _ = history.at(time_ns)
    assert place_mm - 500.0 * t_s * t_s == pytest.approx(1000.0 * 1e-6 / 8, rel=1e-6)


def test_what_is_outside_has_no_place() -> None:
    history = _history(600, lambda t: t, depth=100)
    assert history.oldest_ns == 500 * MS + SYNC_NS
    for time_ns in (500 * MS, 600 * MS):
        with pytest.raises(ValueError, match="outside"):
            history.at(time_ns)


def test_a_place_is_known_when_two_samples_after_it_are_there() -> None:
    history = _history(5, lambda t: t)
    assert history.reaches(3 * MS + SYNC_NS)
    assert not history.reaches(3 * MS + SYNC_NS + 1)
    assert not PositionHistory().reaches(0)


def test_a_sample_that_is_not_newer_changes_nothing() -> None:
    history = _history(3, lambda t: t)
    history.take(2 * MS + SYNC_NS, 99.0)
    assert history.at(2 * MS + SYNC_NS)[0] == pytest.approx(0.002048)


def test_between_samples_that_are_not_neighbours_the_whole_way_is_open() -> None:
    history = PositionHistory()
    for number in (0, 1, 2, 3, 7, 8, 9):
        history.take(number * MS, number * 0.01)
    assert history.doubt_mm(4 * MS, MS) == pytest.approx(0.03)
    assert history.doubt_mm(6 * MS, MS) == pytest.approx(0.03)
    assert history.doubt_mm(8 * MS, MS) == 0.0


def test_clocks_count_that_were_apart_at_the_samples_around_an_instant() -> None:
    history = PositionHistory()
    for number in range(10):
        history.take(number * MS, 0.0, 7 if number == 5 else 0)
    assert [history.clocks_off_ns(n * MS + 500_000) for n in range(9)] == [
        0, 0, 0, 7, 7, 7, 7, 0, 0,
    ]  # fmt: skip
