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


@pytest.mark.parametrize("missing", [1, 3])
@pytest.mark.parametrize("turns_ms", [4.0, 4.3, 4.9, 5.5, 6.0, 7.1])
@pytest.mark.parametrize("signs", [(1, -1), (-1, 1), (0, 1), (1, 0)])
def test_an_axis_that_keeps_to_its_acceleration_is_inside_the_doubt(missing, turns_ms, signs):
    """Its acceleration changes inside the gap: the place by the closed form, and no way in it."""
    a_mm_s2 = 1000.0

    def place_mm(time_ns: float) -> float:
        t_s, turn_s = time_ns * 1e-9, turns_ms * 1e-3
        first = 100.0 * t_s + signs[0] * a_mm_s2 * min(t_s, turn_s) * (t_s - min(t_s, turn_s) / 2)
        return first + signs[1] * a_mm_s2 * max(t_s - turn_s, 0.0) ** 2 / 2

    history = PositionHistory()
    for number in range(12):
        if not 4 < number <= 4 + missing:
            history.take(number * MS, place_mm(number * MS))
    for time_ns in range(4 * MS + MS // 10, (5 + missing) * MS, MS // 10):
        doubt_mm = history.doubt_mm(time_ns, MS, a_mm_s2)
        assert abs(history.at(time_ns)[0] - place_mm(time_ns)) <= doubt_mm + 1e-12
        assert doubt_mm <= history.doubt_mm(time_ns, MS)


def test_at_a_constant_speed_the_doubt_is_the_bow_alone():
    history = PositionHistory()
    for number in (0, 1, 2, 4, 5, 6):
        history.take(number * MS, number * 0.01)
    assert history.doubt_mm(3 * MS, MS, 1000.0) == pytest.approx(0.0005)
    assert history.doubt_mm(3 * MS, MS, 1e9) == pytest.approx(0.01)


def test_clocks_count_that_were_apart_at_the_samples_around_an_instant() -> None:
    history = PositionHistory()
    for number in range(10):
        history.take(number * MS, 0.0, 7 if number == 5 else 0)
    assert [history.clocks_off_ns(n * MS + 500_000) for n in range(9)] == [
        0, 0, 0, 7, 7, 7, 7, 0, 0,
    ]  # fmt: skip
