"""A run in parts: what judges find does not depend on the blocks of its trace."""

import gc
import weakref
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.recordings import facts

from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.judge.distance.times import unbroken
from axisrig.bench.judge.observed.observed import KEPT_BYTES, Columns, Observed
from axisrig.bench.judge.topics import TOPICS
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.series import INPUTS, Series, SeriesWriter, column_of

ROOT = Path(__file__).parents[2]
MS = 1_000_000
STEP_NS = 3


def series(path: Path | None, sizes: Sequence[int]) -> Series:
    """Rows at 0, 3, 6 ... ns in blocks of these sizes, Z at the number of the row."""
    writer, begin = SeriesWriter(path), 0
    for size in sizes:
        row = np.arange(begin, begin + size, dtype=np.int64)
        writer.add({"time_ns": column_of(row * STEP_NS), "Z.truth_mm": column_of(row * 1.0)})
        begin += size
    return writer.close()


def test_equal_values_in_several_parts_are_one_time_where_these_touch() -> None:
    """Rows 0 .. 3 and 4 .. 5 touch, rows 8 .. 9 are apart; an empty part is nothing."""
    parts = [([7, 7, 1, 1], 0), ([], 4), ([1, 7], 4), ([7, 7], 8), ([2], 10)]
    found = unbroken((np.array(values), first) for values, first in parts)
    assert [tuple(time) for time in found] == [
        (0, 2, 7), (2, 5, 1), (5, 6, 7), (8, 10, 7), (10, 11, 2)
    ]  # fmt: skip


def test_a_run_that_was_forgotten_needs_no_search_for_garbage() -> None:
    observed = Observed(facts(axes={"Z": AxisRecord("can1", 1, 10_000.0)}), series(None, [3]))
    observed.once(lambda whole: [whole])
    gone = weakref.ref(observed)
    gc.disable()
    try:
        observed.forget()
        del observed
        assert gone() is None
    finally:
        gc.enable()


@pytest.mark.long
@settings(max_examples=40, deadline=None)
@given(
    sizes=st.lists(st.integers(0, 9), min_size=1, max_size=5),
    begin=st.integers(0, 40),
    length=st.integers(0, 40),
    before=st.integers(0, 12),
    at_ns=st.integers(-5, 140),
    is_kept=st.booleans(),
)
def test_parts_are_the_rows_in_their_order(
    sizes: list[int],
    begin: int,
    length: int,
    before: int,
    at_ns: int,
    is_kept: bool,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    folder = tmp_path_factory.mktemp("parts")
    found = series(folder / "a.parquet" if is_kept else None, sizes)
    observed = Observed(facts(axes={"Z": AxisRecord("can1", 1, 10_000.0)}), found)
    count = sum(sizes)
    times, wanted = np.arange(count) * STEP_NS, np.arange(count)[begin : begin + length]
    assert len(observed) == count
    rows: list[float] = []
    for part, first, inside in observed.parts(slice(begin, begin + length), before):
        values = part.column("Z", "truth_mm")
        assert values.tolist() == (part.times_ns / STEP_NS).tolist()
        assert part.column("Z", "truth_mm", inside).tolist() == values[inside].tolist()
        assert inside.start == inside.stop or values[inside][0] == first
        assert inside.start >= min(before, first)
        rows += values[inside].tolist()
    assert rows == wanted.tolist()
    assert observed.column("Z", "truth_mm", slice(begin, begin + length)).tolist() == rows
    assert observed.index_at(at_ns) == max(int(np.searchsorted(times, at_ns, "right")) - 1, 0)
    inside = observed.between(at_ns, at_ns + length)
    mask = (times >= at_ns) & (times <= at_ns + length)
    assert list(range(count))[inside] == np.flatnonzero(mask).tolist()
    assert [observed.value("Z", "truth_mm", row) for row in range(count)] == [*range(count)]


@pytest.mark.long
@given(values=st.lists(st.integers(0, 2), max_size=30), size=st.integers(1, 9))
def test_unbroken_times_do_not_end_with_a_block(values: list[int], size: int) -> None:
    blocks = [(np.array(values[at : at + size]), at) for at in range(0, len(values), size)]
    answer = unbroken(blocks)
    assert [time.value for time in answer for _ in range(time.begin, time.end)] == values
    assert all(one.value != other.value for one, other in pairwise(answer))


@pytest.mark.parametrize("sizes", [[6], [3, 3], [1, 2, 3], [5, 1], [1] * 6])
@pytest.mark.parametrize("row_later", [0, 1])
def test_frames_between_two_instants_do_not_depend_on_blocks(
    sizes: Sequence[int], row_later: int, tmp_path: Path
) -> None:
    """A frame ends 2 ns after each SYNC, and is in the row of this SYNC or of the next one."""
    writer, begin = SeriesWriter(tmp_path / "a.parquet"), 0
    for size in sizes:
        row = np.arange(begin, begin + size, dtype=np.int64)
        ends_ns = [[n * STEP_NS + 2] if n >= 0 else [] for n in row - row_later]
        frames = pa.array(ends_ns, type=pa.list_(pa.int64()))
        writer.add({"time_ns": column_of(row * STEP_NS), f"{INPUTS}_frame_ns": frames})
        begin += size
    observed = Observed(facts(), writer.close())
    every_ns = [n * STEP_NS + 2 for n in range(6 - row_later)]
    for first_ns in range(-1, 18):
        for last_ns in range(first_ns, 18):
            found = observed.frame_ends_ns(INPUTS, first_ns, last_ns)
            assert found.tolist() == [n for n in every_ns if first_ns <= n <= last_ns]


def test_what_is_kept_of_a_long_run_does_not_grow(tmp_path: Path) -> None:
    found = series(tmp_path / "a.parquet", [4096] * 20)
    columns = Columns(found)
    of_block = 4096 * 8
    most = KEPT_BYTES // of_block
    for number, block in enumerate(found.blocks, start=1):
        columns.read("Z.truth_mm", block)
        columns.read("Z.truth_mm", block)  # it is kept once
        assert columns.kept_bytes == min(number, most) * of_block
    assert len(found.blocks) > most
    for block in found.blocks:
        columns.read("time_ns", block)
    assert columns.kept_bytes == most * of_block


@pytest.mark.long
@pytest.mark.parametrize(
    ("plan", "case"),
    [
        ("latch_accuracy", "f600"),
        ("distance_control", "p-2-plain-above"),
        ("distance_control", "profile-sine"),
    ],
)
def test_every_metric_is_the_same_in_blocks_of_any_size(
    plan: str, case: str, tmp_path: Path
) -> None:
    """The reference is the same run with a trace of one block."""
    (row,) = [c for c in read_plan(ROOT / "testplans" / f"{plan}.csv").cases if c.case == case]
    result = run_case(row, RunFiles(trace=tmp_path / "run.parquet"))
    assert result.facts is not None
    table = pq.read_table(tmp_path / "run.parquet")
    answer = []
    for rows in (table.num_rows, 97, 512):
        path = tmp_path / f"{rows}.parquet"
        pq.write_table(table, path, row_group_size=rows)
        observed = Observed(result.facts, Series(path))
        answer.append(
            {
                (name, axis): repr(metric(observed, axis))
                for topic in TOPICS
                for name, metric in topic.metrics.items()
                for axis in (None, *observed.axes)
            }
        )
    assert len(Series(tmp_path / "97.parquet").blocks) > 3
    assert answer[0] == answer[1] == answer[2]
