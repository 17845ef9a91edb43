"""A recording in several blocks, as a file has them, and whom a metric is about.

Rows each ms in blocks of 5, 1, 7 and 12; what is looked at is the same as in one block.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.measuring import FixedStop, MeasurementRun
from axisrig.bench.record.series import SeriesWriter
from axisrig.kernel.time.clock import MS, US

SIZES = (5, 1, 7, 12)
ROWS = sum(SIZES)
FRAMES = [[row * MS + 100 * US] * (row % 3) for row in range(ROWS)]
"""None, one or two telegrams a row."""


def axis(**of: Any) -> AxisRecord:
    return AxisRecord("can1", 1, 1000.0, **of)


def columns(rows: slice) -> dict[str, pa.Array]:
    place = np.arange(ROWS, dtype=np.float64)[rows]
    return {
        "time_ns": pa.array(np.arange(ROWS, dtype=np.int64)[rows] * MS),
        "Z.truth_mm": pa.array(place * 0.5),
        "X.truth_mm": pa.array(-place),
        "plc.inputs_frame_ns": pa.array(FRAMES[rows], pa.list_(pa.int64())),
    }


def in_blocks(path: Path, sizes: Sequence[int] = SIZES, **of_facts: Any) -> Observed:
    writer, begin = SeriesWriter(path), 0
    for size in sizes:
        writer.add(columns(slice(begin, begin + size)))
        begin += size
    whole = facts(axes={"X": axis(), "Z": axis()}, end_ns=ROWS * MS, **of_facts)
    return Observed(whole, writer.close())


@pytest.fixture
def blocks(tmp_path: Path) -> Observed:
    return in_blocks(tmp_path / "a.parquet")


@pytest.fixture
def whole(tmp_path: Path) -> Observed:
    return in_blocks(tmp_path / "b.parquet", (ROWS,))


# Rows


@pytest.mark.parametrize("before", [0, 1, 3, 50])
@pytest.mark.parametrize("rows", [None, slice(0, 3), slice(4, 7), slice(5, 6), slice(12, 25)])
def test_parts_are_the_rows_of_the_whole_in_their_order(
    blocks: Observed, rows: slice | None, before: int
) -> None:
    """Each with its instants and values, and as many rows before it as are there."""
    parts = list(blocks.parts(rows, before))
    begin, end, _ = (rows or slice(None)).indices(ROWS)
    rows_of_parts: list[int] = []
    for part in parts:
        own = range(part.begin, part.begin + part.inside.stop - part.inside.start)
        rows_of_parts += own
        first = part.begin - part.inside.start
        assert first == max(part.begin - before, 0)
        assert len(part.observed) == own[-1] + 1 - first
        instants = part.observed.instants(part.inside)
        assert instants.tolist() == [row * MS for row in own]
        assert part.observed.times_ns.tolist() == [row * MS for row in range(first, own[-1] + 1)]
        column = part.observed.column("Z", "truth_mm", part.inside)
        assert column.tolist() == [row * 0.5 for row in own]
    assert rows_of_parts == list(range(begin, end))


@pytest.mark.parametrize("begin", range(-1, ROWS + 1, 3))
@pytest.mark.parametrize("off_us", [-1, 0, 1])
def test_an_instant_has_its_row_whatever_the_blocks(
    blocks: Observed, whole: Observed, begin: int, off_us: int
) -> None:
    at_ns = begin * MS + off_us * US
    row = min(max(at_ns // MS, 0), ROWS - 1)
    assert blocks.index_at(at_ns) == whole.index_at(at_ns) == row
    for length_ms in (0, 1, 4, 40):
        found = blocks.between(at_ns, at_ns + length_ms * MS)
        assert found == whole.between(at_ns, at_ns + length_ms * MS)
        inside = [n for n in range(ROWS) if at_ns <= n * MS <= at_ns + length_ms * MS]
        assert list(range(found.start, found.stop)) == inside


@pytest.mark.parametrize(
    ("begin_ms", "end_ms"), [(0, 25), (3, 5), (5, 6), (4, 14), (12, 13), (6, 6), (24, 30), (2, 20)]
)
def test_ends_of_frames_are_those_of_an_interval_whatever_the_blocks(
    blocks: Observed, whole: Observed, begin_ms: int, end_ms: int
) -> None:
    begin_ns, end_ns = begin_ms * MS, end_ms * MS
    want = [ns for row in FRAMES for ns in row if begin_ns <= ns <= end_ns]
    for observed in (blocks, whole):
        assert observed.frame_ends_ns("plc.inputs", begin_ns, end_ns).tolist() == want
    assert blocks.frame_ends_ns("plc.other", begin_ns, end_ns).tolist() == []


# SYNCs that nobody got


def test_where_a_lost_sync_is_too_far_from_one_that_came_its_own_instant_counts() -> None:
    """The segment has its SYNC 64 us after the first one: the begin of the next cycle by it.

    Nothing new comes for 25 cycles from row 5 on; only 20 are looked back.
    """
    rows = 40
    place = np.array([float(min(row, 4)) for row in range(rows)])
    table = pa.table({
        "time_ns": np.arange(rows, dtype=np.int64) * MS + 936 * US,
        "Z.sync_after_ns": [64 * US] * rows,
        "Z.actual_mm": place,
    })  # fmt: skip
    observed = Observed(facts(axes={"Z": axis()}), kept(table))
    for row in (5, 26, 30, 39):
        assert observed.sync_ns("Z", row) == (row + 1) * MS


# Whom a metric is about


def measured(*axes: str, begin_ms: int = 1, **more: Any) -> MeasurementRun:
    return MeasurementRun(axes, begin_ns=begin_ms * MS, end_ns=(begin_ms + 2) * MS, **more)


def of_runs(*runs: MeasurementRun, outside: Sequence[str] = (), **of_facts: Any) -> Observed:
    axes = {name: axis(is_outside=name in outside) for name in "XYZC"}
    table = pa.table({"time_ns": np.arange(5, dtype=np.int64) * MS})
    return Observed(facts(axes=axes, runs=runs, **of_facts), kept(table))


def metric(judged: str = "last", needs: str = "") -> Any:
    return SimpleNamespace(judged=judged, needs=needs)


FIRST, LAST = measured("X", "Z"), measured("Y", "Z", begin_ms=3)


@pytest.mark.parametrize(
    ("judged", "axis_name", "about"),
    [
        ("last", None, ["Y", "Z"]),
        ("every", None, ["X", "Z", "Y"]),
        ("", None, ["X", "Y", "Z", "C"]),
        ("last", "C", ["C"]),
        ("every", "X", ["X"]),
        ("", "Y", ["Y"]),
    ],
)
def test_a_metric_is_about_the_axis_that_it_names_or_those_of_its_runs(
    judged: str, axis_name: str | None, about: list[str]
) -> None:
    assert of_runs(FIRST, LAST).about(metric(judged), axis_name) == about
    alone = of_runs().about(metric(judged), axis_name)
    assert alone == ([axis_name] if axis_name else ["X", "Y", "Z", "C"])


@pytest.mark.parametrize(
    ("outside", "axis_name", "hidden"),
    [
        ("", None, ""),
        ("X", None, ""),  # not of the last run
        ("C", None, ""),
        ("Y", None, "Y"),
        ("Z", None, "Z"),
        ("ZY", None, "Y Z"),
        ("XYZ", "Y", "Y"),
        ("XZ", "Y", ""),
        ("Y", "C", ""),
    ],
)
def test_of_a_real_drive_no_plant_gives_the_truth(
    outside: str, axis_name: str | None, hidden: str
) -> None:

    def words(axes: str) -> str:
        return f"the drive of axis {axes} is real: no plant gives the truth" if axes else ""

    observed = of_runs(FIRST, LAST, outside=outside)
    assert observed.hides(metric(needs="plant"), axis_name) == words(hidden)
    for needs in ("bus", ""):
        assert observed.hides(metric(needs=needs), axis_name) == ""
    every = [name for name in "XZY" if name in outside]
    assert observed.hides(metric("every", "plant"), None) == words(" ".join(every))


@pytest.mark.parametrize(
    ("axis_name", "number"), [(None, 2), ("X", 0), ("Y", 2), ("Z", 1), ("C", 1), ("A", 2)]
)
def test_the_last_run_of_an_axis_is_the_last_in_which_it_takes_part(
    axis_name: str | None, number: int
) -> None:
    """A slave takes part in a fixed stop without measuring; one that is in none gets the last."""
    stop = FixedStop({}, axes=("Z", "C"))
    runs = (FIRST, measured("Z", begin_ms=2, fixed_stop=stop), measured("Y", begin_ms=3))
    found = of_runs(*runs).last_run(axis_name)
    assert found is runs[number]
    assert of_runs().last_run(axis_name) is None
    without = (runs[0], replace(runs[1], fixed_stop=replace(stop, axes=())), runs[2])
    assert of_runs(*without).last_run("C") is without[2]
