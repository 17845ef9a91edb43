"""From where the dead time of a probe may lead a value back: where the drive really stands."""

from types import SimpleNamespace

import pytest

from axisrig.kernel.channel.path.dead_times import RunUp, dead_times, shares_of
from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.dynamics import Dynamics
from axisrig.kernel.motion.profile import Slope

MS = 1_000_000


@pytest.mark.parametrize("superposed_mm", [0.0, 5.0, -3.0])
def test_an_offset_that_distance_control_has_left_is_part_of_the_begin(superposed_mm):
    """The latch is an actual position: that of the interpolation with the offset."""
    settings = SimpleNamespace(measuring=SimpleNamespace(delay_ns=10 * MS), window_mm=0.01)
    path = SimpleNamespace(
        settings=lambda _: settings,
        position_acs_mm=lambda _: 100.0,
        superposed_mm=lambda _: superposed_mm,
    )
    link = SimpleNamespace(name="Z", lag_mm=0.0)
    (found,) = dead_times(path, {"Z": link}, ["Z"], MS, lambda _axis, _mm_s: 0.0).values()
    begin_mm = 100.0 + superposed_mm
    assert found.led_back_mm(begin_mm + 0.09, 0.01) == pytest.approx(begin_mm - 0.01)
    with pytest.raises(Alarm, match="900520"):
        found.led_back_mm(begin_mm + 0.08, 0.01)


@pytest.mark.parametrize(("delay_ns", "period_ns"), [(2_500_000, 2 * MS), (700_000, MS)])
@pytest.mark.parametrize("speed_mm_s", [40.0, -40.0])
def test_a_dead_time_need_not_be_a_whole_number_of_cycles(delay_ns, period_ns, speed_mm_s):
    """P-AXIS-00487 is in us: the value is led back by v T to the last of them."""
    settings = SimpleNamespace(measuring=SimpleNamespace(delay_ns=delay_ns), window_mm=0.01)
    path = SimpleNamespace(
        settings=lambda _: settings,
        position_acs_mm=lambda _: 100.0,
        superposed_mm=lambda _: 0.0,
    )
    asked_mm_s = []

    def behind_mm(_axis, mm_s):
        asked_mm_s.append(mm_s)
        return 0.0

    link = SimpleNamespace(name="Z", lag_mm=0.0)
    (found,) = dead_times(path, {"Z": link}, ["Z"], period_ns, behind_mm).values()
    touched_mm = 100.0 + speed_mm_s
    travel_mm = speed_mm_s * period_ns * 1e-9  # in one cycle
    back_mm = found.led_back_mm(touched_mm, travel_mm)
    assert back_mm == pytest.approx(touched_mm - speed_mm_s * delay_ns * 1e-9, abs=1e-9)
    assert asked_mm_s == [pytest.approx(abs(speed_mm_s))]


def test_an_axis_without_a_dead_time_has_none():
    settings = SimpleNamespace(measuring=SimpleNamespace(delay_ns=0), window_mm=0.01)
    path = SimpleNamespace(settings=lambda _: settings)
    assert dead_times(path, {}, ["Z"], MS, lambda _axis, _mm_s: 0.0) == {}


A_MM_S2, SPEED_MM_S = 400.0, 50.0
SLOPE = Slope(A_MM_S2, A_MM_S2, 500.0)
DYNAMICS = Dynamics(SLOPE, SLOPE, SLOPE, 500.0)


def test_an_axis_of_an_oblique_path_is_behind_by_half_its_own_way_in_the_time_of_the_run_up():
    """30, 40 and 0 mm of 50: each axis has had half its speed v for T = V / a of the path.

    So it is v V / 2a behind, and an axis alone v^2 / 2a.
    """
    path = SimpleNamespace(
        transformation=SimpleNamespace(kinematic=None), position_acs_mm=lambda _: 10.0
    )
    shares = shares_of(path, {"X": 40.0, "Y": -30.0, "Z": 10.0})
    assert shares == pytest.approx({"X": 0.6, "Y": 0.8, "Z": 0.0})
    run_up = RunUp(DYNAMICS, shares)
    for axis, share in (("X", 0.6), ("Y", 0.8)):
        v_mm_s = share * SPEED_MM_S
        behind_mm = v_mm_s * SPEED_MM_S / (2.0 * A_MM_S2)
        assert run_up.behind_mm(axis, v_mm_s) == pytest.approx(behind_mm, rel=1e-5)
    assert [run_up.behind_mm(axis, SPEED_MM_S) for axis in ("Z", "W")] == [0.0, 0.0]
    alone_mm = RunUp(DYNAMICS, {"X": 1.0}).behind_mm("X", SPEED_MM_S)
    assert alone_mm == pytest.approx(SPEED_MM_S**2 / (2.0 * A_MM_S2), rel=1e-5)


def test_under_a_kinematic_the_whole_time_of_the_run_up_counts():
    """No axis has a share of its own: at v it is at most v T behind, T = V / a of the path."""
    path = SimpleNamespace(transformation=SimpleNamespace(kinematic=object()))
    assert shares_of(path, {"X": 40.0}) is None
    run_up = RunUp(DYNAMICS, None, SPEED_MM_S)
    for v_mm_s in (0.0, 20.0, 80.0):
        behind_mm = v_mm_s * SPEED_MM_S / A_MM_S2
        assert run_up.behind_mm("X", v_mm_s) == pytest.approx(behind_mm, rel=1e-5)
