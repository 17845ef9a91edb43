"""What records work out of what they hold: ages, states, spreads, series that travel."""

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axisrig.bench.bus.deadlines import BINS_US, Deadlines
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.bus import Spread, real_time_of
from axisrig.bench.record.distance import Controller, DistanceChange
from axisrig.bench.record.series import TIME, Series, SeriesWriter, column_of
from axisrig.kernel.distance.states import DistanceState
from axisrig.kernel.time.clock import MS, US

CONTROLLER: dict[str, Any] = {
    "kp": 1.0, "tn_s": 0.0, "tv_s": 0.0, "filter_type": "NONE", "count": 1, "alpha": 0.0,
    "order": 1, "corner_hz": 0.0, "sigma_mm": 0.0,
}  # fmt: skip


def test_6064_is_older_than_what_the_plc_reads_by_the_difference_of_both() -> None:
    for late, fresh in ((0, 0), (3, 1), (2, 2), (1, 3)):
        axis = AxisRecord("can0", 1, 1000.0, late_cycles=late, fresh_late_cycles=fresh)
        assert axis.later_cycles == late - fresh


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


def _columns(first: int, count: int) -> dict[str, Any]:
    times = np.arange(first, first + count, dtype=np.int64) * MS
    return {TIME: column_of(times), "Z.actual_mm": column_of(times / MS * 0.5)}


@pytest.mark.parametrize("is_kept", [True, False])
def test_a_series_travels_to_another_process_by_its_source(tmp_path: Path, is_kept: bool) -> None:
    """What is open or held stays; there the same rows are read again."""
    path = tmp_path / "trace.parquet" if is_kept else None
    writer = SeriesWriter(path, {"run": "r1"}, holds=True)
    writer.add(_columns(0, 3))
    series = writer.close()
    before = series.column("Z.actual_mm")
    there: Series = pickle.loads(pickle.dumps(series))
    assert there.held is None
    assert there.about == series.about == {"run": "r1"}
    assert there.names == series.names == [TIME, "Z.actual_mm"]
    for found in (there, series.released() if is_kept else there):
        assert found.column("Z.actual_mm").tolist() == before.tolist() == [0.0, 0.5, 1.0]


def test_only_what_was_not_finished_is_dropped(tmp_path: Path) -> None:
    done, broken = tmp_path / "done.parquet", tmp_path / "broken.parquet"
    for path in (done, broken):
        writer = SeriesWriter(path)
        writer.add(_columns(0, 2))
        writer.add(_columns(2, 3))
        if path is done:
            first = writer.close()
            assert writer.close() is first
        writer.discard()
        assert path.exists() is (path is done)
    found = Series(done)
    assert [(rows.start, rows.stop) for rows in found.blocks] == [(0, 2), (2, 5)]
    assert found.column(TIME, found.blocks[1]).tolist() == [2 * MS, 3 * MS, 4 * MS]
    SeriesWriter(tmp_path / "never.parquet").discard()
    SeriesWriter(None).discard()
    assert sorted(item.name for item in tmp_path.iterdir()) == ["done.parquet"]
