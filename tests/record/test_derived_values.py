"""Values that records derive from what they hold: age, state of a control, spread of times."""

from typing import Any

import pytest

from axisrig.bench.bus.deadlines import BINS_US, Deadlines
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.bus import Spread, real_time_of
from axisrig.bench.record.distance import Controller, DistanceChange
from axisrig.bench.record.series import units_of
from axisrig.kernel.distance.states import DistanceState
from axisrig.kernel.time.clock import MS, US

CONTROLLER: dict[str, Any] = {
    "kp": 1.0, "tn_s": 0.0, "tv_s": 0.0, "filter_type": "NONE", "count": 1, "alpha": 0.0,
    "order": 1, "corner_hz": 0.0, "sigma_mm": 0.0,
}  # fmt: skip


def test_6064_is_older_than_what_the_plc_reads_by_the_difference_of_both() -> None:
    for late, fresh, older in ((0, 0, 0), (3, 1, 2), (2, 2, 0), (1, 3, -2)):
        axis = AxisRecord("can0", 1, 1000.0, late_cycles=late, fresh_late_cycles=fresh)
        assert axis.later_cycles == older


@pytest.mark.parametrize("state", DistanceState)
@pytest.mark.parametrize("both", [True, False])
def test_a_control_is_on_in_its_two_states_and_follows_in_its_mode(
    state: DistanceState, both: bool
) -> None:
    """SET_POS where the set position leads; the constant distance by sensor alone or by both."""
    controller = Controller(**CONTROLLER, both_encoders=both)
    change = DistanceChange(0, state.name, "NC", "S", False, controller)
    assert change.is_on is (state.name in ("ACTIVE", "ACTIVE_CONST_DIST"))
    if state.name == "ACTIVE":
        assert change.mode == SET_POS
    elif change.is_on:
        assert change.mode == (BOTH if both else CONST_DIST)


def test_real_time_without_a_sync_has_no_spread_and_one_sync_no_interval() -> None:
    deadlines = Deadlines(100 * US)
    kept = real_time_of(deadlines, MS)
    assert (kept.cycles, kept.lateness_us, kept.interval_us) == (0, None, None)
    deadlines.sync_sent(0, 150 * US)
    kept = real_time_of(deadlines, MS)
    assert (kept.cycles, kept.late_cycles, kept.interval_us) == (1, 1, None)
    assert kept.lateness_us == Spread(150.0, 150.0, 150.0, 150.0)
    deadlines.sync_sent(MS, MS + 50 * US)
    kept = real_time_of(deadlines, 2 * MS)
    assert kept.interval_us == Spread(900.0, 900.0, 900.0, 900.0)
    assert (kept.period_us, kept.late_us) == (2000.0, 100.0)
    assert (kept.bins_us, sum(kept.histogram)) == (BINS_US, 2)


@pytest.mark.parametrize(
    ("column", "unit"),
    [
        ("Z.set_mm", "mm"),
        ("Z.velocity_mm_s", "mm/s"),
        ("C.set_deg", "deg"),
        ("C.velocity_deg_s", "deg/s"),
        ("Z.force_n", "N"),
        ("C.torque_nm", "N.m"),
        ("time_ns", "ns"),
        ("Z.sync_after_ns", "ns"),
        ("bus.load_pct", "pct"),
        ("Z.actual_increments", "increments"),
        ("spring.tension", None),  # names that only end with the letters of a unit
        ("slide.position", None),
        ("probe.columns", None),
        ("cam.mm", None),
        ("Z.program", None),
        ("probe.signal", None),
    ],
)
def test_the_unit_of_a_column_is_the_last_word_of_its_name(column: str, unit: str | None) -> None:
    assert units_of([column]) == ({} if unit is None else {column: unit})


def test_columns_keep_their_order_and_those_without_a_unit_are_left_out() -> None:
    found = units_of(["Z.b_mm", "probe.signal", "Z.a_n", "time_ns"])
    assert list(found.items()) == [("Z.b_mm", "mm"), ("Z.a_n", "N"), ("time_ns", "ns")]
