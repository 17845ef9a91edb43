"""From where the dead time of a probe may lead a value back: where the drive really stands."""

from types import SimpleNamespace

import pytest

from axisrig.kernel.channel.path.dead_times import dead_times
from axisrig.kernel.errors import Alarm

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
