"""Exact stop before and after the set position, at the very window, and of which axis."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.path.settings import AxisSettings, CycleTiming
from axisrig.kernel.channel.path.settling import (
    REST_CYCLES,
    REST_LIMIT_NS,
    SETTLED_CYCLES,
    STANDSTILL_INCREMENTS,
    Rest,
    Settling,
    Standstill,
)
from axisrig.kernel.channel.path.soft_limits import SoftLimits, SoftLimitWatch
from axisrig.kernel.drives.position_watch import jump_alarm, lag_alarm
from axisrig.kernel.drives.power import Power
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS

pytestmark = pytest.mark.interpreted
OFFSET_NS, WINDOW_INCREMENTS = 600_000, 10


class Axes:
    """Axes X, Z, whose set position is 0; 1000 increments a millimetre, window 10 increments."""

    def __init__(self, settling_ns: int = 0, names: str = "XZ") -> None:
        self.now_ns = 0
        self.links: Any = [
            SimpleNamespace(name=name, actual_increments=0, lag_mm=0.0, has_actual=True)
            for name in names
        ]
        self.axes: Any = [
            (AxisSettings(link.name, True, WINDOW_INCREMENTS / 1000, settling_ns, {}), link)
            for link in self.links
        ]

    def put(self, *places: int) -> None:
        self.now_ns += MS
        for link, place in zip(self.links, places, strict=True):
            link.actual_increments, link.lag_mm = place, -place / 1000


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("place", "stands"), [(WINDOW_INCREMENTS, True), (WINDOW_INCREMENTS + 1, False)]
)
@pytest.mark.parametrize("second", [False, True])
def test_an_axis_stands_at_its_window_on_either_side(
    sign: int, place: int, stands: bool, second: bool
) -> None:
    axes = Axes()
    settling = Settling(axes, MS)  # type: ignore[arg-type]
    found = []
    for _ in range(SETTLED_CYCLES + 3):
        axes.put(*((0, sign * place) if second else (sign * place, 0)))
        found.append(settling.judge(axes.axes))
    assert found == [stands and cycle >= SETTLED_CYCLES for cycle in range(SETTLED_CYCLES + 3)]


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("second", [False, True])
def test_an_axis_beyond_its_window_is_named_after_its_settling_time(
    sign: int, second: bool
) -> None:
    """5 ms may pass; the lag of an axis ahead of its set position is negative."""
    axes = Axes(settling_ns=5 * MS)
    place = sign * (WINDOW_INCREMENTS + 1)
    settling = Settling(axes, MS)  # type: ignore[arg-type]
    for _ in range(6):
        axes.put(*((0, place) if second else (place, 0)))
        assert not settling.judge(axes.axes)
    axes.put(*((0, place) if second else (place, 0)))
    with pytest.raises(Alarm) as caught:
        settling.judge(axes.axes)
    assert caught.value.id == 70082
    assert caught.value.values == {
        "axis": "XZ"[second], "lag_mm": f"{-sign * 0.011:.4f}", "window_mm": "0.0100", "ms": 6,
    }  # fmt: skip


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("place", "rests"), [(WINDOW_INCREMENTS, True), (WINDOW_INCREMENTS + 1, False)]
)
def test_axes_come_to_rest_inside_their_windows_on_either_side(
    sign: int, place: int, rests: bool
) -> None:
    axes = Axes()
    standstill = Standstill(axes, CycleTiming(MS, OFFSET_NS), axes.axes)  # type: ignore[arg-type]
    for _ in range(3):
        axes.put(0, sign * place)
        found = standstill.look(True)
    assert found == (2 * MS - OFFSET_NS if rests else None)  # in the first it has moved


@pytest.mark.parametrize("step", [STANDSTILL_INCREMENTS, STANDSTILL_INCREMENTS + 1])
@pytest.mark.parametrize("sign", [1, -1])
def test_an_axis_that_creeps_by_an_increment_rests_and_a_faster_one_does_not(
    step: int, sign: int
) -> None:
    axes = Axes(names="Z")
    standstill = Standstill(axes, CycleTiming(MS, OFFSET_NS), axes.axes)  # type: ignore[arg-type]
    for cycle in range(1, 4):
        axes.put(sign * step * cycle)
        found = standstill.look(True)
    assert (found is not None) is (step == STANDSTILL_INCREMENTS)


def test_the_time_for_swaying_counts_from_the_end_of_the_set_path_and_anew_for_the_next() -> None:
    axes = Axes(names="Z")
    standstill = Standstill(axes, CycleTiming(MS, OFFSET_NS), axes.axes)  # type: ignore[arg-type]

    def sways(cycles: int, ended: bool) -> int | None:
        found = None
        for _ in range(cycles):
            axes.put(4 * (axes.now_ns // MS % 2))  # by more than it may creep
            found = standstill.look(ended)
        return found

    limit = REST_LIMIT_NS // MS
    assert sways(20, False) is None
    assert sways(limit + 1, True) is None
    assert sways(2, True) is not None
    assert sways(1, False) is None
    assert sways(limit, True) is None


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("sway", "is_alarm"), [(WINDOW_INCREMENTS, False), (WINDOW_INCREMENTS + 1, True)]
)
def test_an_axis_that_sways_too_long_is_an_alarm_outside_its_window_only(
    sign: int, sway: int, is_alarm: bool
) -> None:
    axes = Axes(settling_ns=20 * MS, names="Z")
    rest = Rest(axes, MS, axes.axes)  # type: ignore[arg-type]

    def cycles(count: int) -> list[bool]:
        found = []
        for cycle in range(count):
            axes.put(sign * sway * (-1) ** cycle)
            found.append(rest.judge())
        return found

    assert not any(cycles(20))
    if is_alarm:
        with pytest.raises(Alarm) as caught:
            cycles(3)
        assert (caught.value.id, caught.value.values["axis"]) == (900200, "Z")
        return
    assert any(cycles(REST_CYCLES + 2))


# --- software limit switches -------------------------------------------------------------------

LIMITS = SoftLimits(-5.0, 20.0, 0.5)


def drive(increments: int, *, leads_itself: bool = False) -> Any:
    return SimpleNamespace(
        name="Z", actual_increments=increments, actual_mm=increments / 1000,
        leads_itself=leads_itself, settings=SimpleNamespace(increments_per_mm=1000.0),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("target_mm", "alarm_id", "limit"),
    [
        (20.0, None, ""),
        (-5.0, None, ""),
        (20.0001, 120002, "20.0000"),
        (-5.0001, 120003, "-5.0000"),
    ],
)
def test_a_target_may_be_at_a_switch(target_mm: float, alarm_id: int | None, limit: str) -> None:
    if alarm_id is None:
        LIMITS.require_target("Z", target_mm)
        return
    with pytest.raises(Alarm) as caught:
        LIMITS.require_target("Z", target_mm)
    assert caught.value.id == alarm_id
    assert caught.value.values == {
        "axis": "Z", "position_mm": f"{target_mm:.4f}", "limit_mm": limit,
    }  # fmt: skip


@pytest.mark.parametrize("offset_mm", [None, 3.0, -3.0])
@pytest.mark.parametrize(
    ("counted_mm", "alarm_id", "limit"),
    [
        (20.5, None, ""),
        (-5.5, None, ""),
        (20.501, 70021, "20.5000"),
        (-5.501, 70022, "-5.5000"),
    ],
)
def test_an_actual_position_may_be_a_tolerance_past_a_switch(
    offset_mm: float | None, counted_mm: float, alarm_id: int | None, limit: str
) -> None:
    """An offset that does not count is taken off; the alarm names what counts."""
    at = drive(round(1000 * (counted_mm + (offset_mm or 0.0))))
    uncounted = {} if offset_mm is None else {"Z": lambda: offset_mm}
    watch = SoftLimitWatch({"X": None, "Z": LIMITS}, {"Z": at}, uncounted)  # type: ignore[dict-item]
    if alarm_id is None:
        watch.check()
        return
    with pytest.raises(Alarm) as caught:
        watch.check()
    assert (caught.value.id, caught.value.values["limit_mm"]) == (alarm_id, limit)
    assert caught.value.values["position_mm"] == f"{counted_mm:.4f}"
    at.leads_itself = True  # homing
    watch.check()


# --- lag and jumps of a drive ------------------------------------------------------------------


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("lag_mm", "limit_mm"), [(0.0, 0.0), (2.0, 2.0), (9e9, float("inf"))])
def test_a_lag_may_be_as_large_as_its_limit(sign: int, lag_mm: float, limit_mm: float) -> None:
    """0 is a limit that allows none at all; without one there is no alarm."""
    at = SimpleNamespace(
        name="Z", frozen=None, watches_lag=True, lag_mm=sign * lag_mm,
        settings=SimpleNamespace(lag_limit_mm=limit_mm),
    )  # fmt: skip
    assert lag_alarm(at) is None  # type: ignore[arg-type]
    at.lag_mm = sign * (lag_mm + 0.001)
    alarm = lag_alarm(at)  # type: ignore[arg-type]
    if limit_mm == float("inf"):
        assert alarm is None
        return
    assert alarm is not None
    assert alarm.id == 900036
    assert alarm.values == {
        "axis": "Z", "lag_mm": f"{sign * (lag_mm + 0.001):.4f}", "limit_mm": f"{limit_mm:g}",
    }  # fmt: skip
    at.watches_lag = False  # a run to a fixed stop
    assert lag_alarm(at) is None  # type: ignore[arg-type]


@pytest.mark.parametrize("power", Power)
def test_a_jump_is_an_alarm_in_operation_and_is_forgotten_in_any_state(power: Power) -> None:
    at: Any = SimpleNamespace(name="Z", jump_mm=1.5, power=power)
    alarm = jump_alarm(at)
    assert (alarm is not None) is (power is Power.OPERATING)
    if alarm is not None:
        assert (alarm.id, alarm.values) == (900029, {"axis": "Z", "jump_mm": "1.500"})
    assert jump_alarm(at) is None
