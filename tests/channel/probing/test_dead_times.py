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


def test_an_axis_without_a_dead_time_has_none():
    settings = SimpleNamespace(measuring=SimpleNamespace(delay_ns=0), window_mm=0.01)
    path = SimpleNamespace(settings=lambda _: settings)
    assert dead_times(path, {}, ["Z"], MS, lambda _axis, _mm_s: 0.0) == {}
