"""Tables of runs that left a part only: facts without signals, signals without blocks or edges."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import Step, block_trace, facts, kept

from axisrig.bench.record.axes import AxisRecord, DriveState, Latch
from axisrig.bench.record.facts import Facts, run_text
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS
from axisrig.results.loading import Results, load

LEFT = facts(
    axes={"Z": AxisRecord("can1", 1, 1000.0, latches=(Latch(2 * MS, 1),))},
    blocks=block_trace((Step("N10 G1 Z5", "feed", 1, 2, 6, feed_mm_min=600, path_mm=5),)),
    edges=(),
)


def results_of(folder: Path, left: Facts | None, *, has_trace: bool = True) -> Results:
    (folder / "cases.csv").write_text("run,verdict\nr,pass\n", encoding="utf-8")
    (folder / "results.csv").write_text("run,metric,verdict\n", encoding="utf-8")
    for name in ("runs", "traces"):
        (folder / name).mkdir()
    (folder / "runs" / "r.json").write_text(run_text(left, "it broke"), encoding="utf-8")
    if has_trace:
        columns = {"time_ns": np.arange(5, dtype=np.int64) * MS, "Z.set_mm": np.zeros(5)}
        kept(pa.table(columns), folder / "traces" / "r.parquet")
    return load(folder)


@pytest.mark.parametrize(
    ("left", "has_trace", "count"),
    [(LEFT, True, 1), (LEFT, False, 0), (None, True, 0), (None, False, 0)],
)
def test_events_need_facts_and_signals(
    left: Facts | None, has_trace: bool, count: int, tmp_path: Path
) -> None:
    """A mark has the name of its axis; without one of both there is a table without rows."""
    events = results_of(tmp_path, left, has_trace=has_trace).events("r")
    found = [tuple(row) for row in events.itertuples(index=False)]
    assert found == [(2 * MS, "latch", "Z", "Z: latch of probe 1")][:count]
    assert list(events.columns) == ["time_ns", "kind", "axis", "text"]
    assert str(events["time_ns"].dtype) == "int64"


@pytest.mark.parametrize(
    ("table", "left", "words"),
    [
        ("blocks", None, "the run left no block trace"),
        ("blocks", replace(LEFT, blocks=None), "the run left no block trace"),
        ("edges", None, "the run left no places of edges"),
        ("edges", replace(LEFT, edges=None), "the run left no places of edges"),
        ("diagnosis", None, "the run has no 3D distance control"),
        ("diagnosis", LEFT, "the run has no 3D distance control"),
    ],
)
def test_a_table_that_a_run_did_not_leave_is_refused(
    table: str, left: Facts | None, words: str, tmp_path: Path
) -> None:
    results = results_of(tmp_path, left)
    with pytest.raises(UserError) as refused:
        getattr(results, table)("r")
    assert (refused.value.message, refused.value.value) == (words, "r")


def test_the_signals_of_a_run_need_no_facts(tmp_path: Path) -> None:
    results = results_of(tmp_path, None)
    assert results.signals("r")["time_ns"].tolist() == [n * MS for n in range(5)]
    assert list(results.traces()) == ["r"]


def test_each_column_of_blocks_with_a_unit_has_its_own(tmp_path: Path) -> None:
    """Words, numbers of blocks and lines have none."""
    blocks: Any = results_of(tmp_path, LEFT).blocks("r")
    assert blocks.attrs["units"] == {
        **dict.fromkeys(("due_ns", "begin_ns", "end_ns", "waited_ns", "held_ns"), "ns"),
        "feed_mm_min": "mm/min", "path_mm": "mm", "travelled_mm": "mm",
    }  # fmt: skip
    assert blocks[["due_ns", "begin_ns", "end_ns"]].to_numpy().tolist() == [
        [1 * MS, 2 * MS, 6 * MS]
    ]
    assert np.isnan(blocks["travelled_mm"][0])


def test_what_happens_at_one_instant_is_in_the_order_of_the_rig(tmp_path: Path) -> None:
    """Marks first, then the states of its axes; whatever their names are."""
    axes = {
        name: AxisRecord("can1", node, 1000.0, latches=(Latch(2 * MS, 1),),
                         states=(DriveState(2 * MS, "B"), DriveState(2 * MS, "A"),
                                 DriveState(MS, "FIRST")))
        for node, name in enumerate("ZA", start=1)
    }  # fmt: skip
    events = results_of(tmp_path, replace(LEFT, axes=axes)).events("r")
    found = [(row.time_ns // MS, row.kind, row.axis, row.text) for row in events.itertuples()]
    assert [row for row in found if row[1] == "state"] == [
        (1, "state", "Z", "FIRST"), (1, "state", "A", "FIRST"), (2, "state", "Z", "B"),
        (2, "state", "Z", "A"), (2, "state", "A", "B"), (2, "state", "A", "A"),
    ]  # fmt: skip
    assert [row[1] for row in found][2:4] == ["latch", "latch"]
