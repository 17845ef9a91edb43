"""Series of a run: blocks read back as columns, lists of telegrams, damaged files."""

import csv
import json
import math
import pickle
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import duckdb
import numpy as np
import numpy.typing as npt
import pandas as pd
import polars
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axisrig.bench.record.series import (
    ACTUAL,
    SECOND,
    TARGET,
    TIME,
    MissingSignalError,
    Series,
    SeriesWriter,
    _readable,
    column_of,
    units_of,
    values_of,
)
from axisrig.kernel.errors import UserError

MS = 1_000_000
ACTUAL_MM = "Z.actual_mm"
ROOT = Path(__file__).parents[2]


def block(begin: int, rows: int) -> dict[str, pa.Array]:
    """Rows from `begin` on: a time, a position, a state, and the telegrams of each cycle.

    Row n has n modulo 3 of them, with their ends 1000 ns apart.
    """
    at = np.arange(begin, begin + rows, dtype=np.int64)
    ends = [[int(n) * MS + 1000 * k for k in range(n % 3)] for n in at]
    values = [[int(10 * n + k) for k in range(n % 3)] for n in at]
    return {
        "time_ns": pa.array(at * MS),
        "Z.set_mm": pa.array(np.where(at % 7 == 6, np.nan, at / 3.0)),
        "probe.signal": pa.array((at % 2).astype(np.int8)),
        "Z.actual_frame_ns": pa.array(ends, pa.list_(pa.int64())),
        "Z.actual_increments": pa.array(values, pa.list_(pa.int64())),
    }


def write(path: Path | None, sizes: Sequence[int]) -> Series:
    writer = SeriesWriter(path)
    begin = 0
    for size in sizes:
        writer.add(block(begin, size))
        begin += size
    return writer.close()


@pytest.mark.long
@settings(max_examples=25, deadline=None)
@given(sizes=st.lists(st.integers(0, 40), min_size=1, max_size=6), is_kept=st.booleans())
def test_blocks_read_back_as_the_columns_of_one(
    sizes: list[int], is_kept: bool, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("series")
    found = write(folder / "parts.parquet" if is_kept else None, sizes)
    whole = write(folder / "one.parquet", [sum(sizes)])
    assert found.names == whole.names == ["time_ns", "Z.set_mm", "probe.signal"]
    for name in whole.names:
        one, other = found.column(name), whole.column(name)
        assert one.dtype == other.dtype
        assert one.tobytes() == other.tobytes()
    for one, other in zip(found.telegrams("Z", ACTUAL), whole.telegrams("Z", ACTUAL), strict=True):
        assert one.tolist() == other.tolist()


@pytest.mark.parametrize("is_kept", [True, False])
def test_a_trace_that_was_read_whole_gives_the_same_columns_blocks_and_telegrams(
    tmp_path: Path, is_kept: bool
) -> None:
    path = tmp_path / "a.parquet" if is_kept else None
    apart, at_once = write(path, [5, 0, 9, 3]), write(path, [5, 0, 9, 3])
    assert at_once.whole.column_names == apart.names
    assert at_once.blocks == apart.blocks
    for name in apart.names:
        for block in (None, *apart.blocks):
            one, other = at_once.column(name, block), apart.column(name, block)
            assert (one.dtype, one.tobytes()) == (other.dtype, other.tobytes())
    for one, other in zip(
        at_once.telegrams("Z", ACTUAL), apart.telegrams("Z", ACTUAL), strict=True
    ):
        assert one.tolist() == other.tolist()
    with pytest.raises(KeyError):
        at_once.column("Z.other")


@pytest.mark.parametrize("sizes", [[12], [0], [5, 7]])
def test_what_is_held_in_memory_is_what_the_file_has(tmp_path: Path, sizes: list[int]) -> None:
    """Only a run of one block is held, so that a long one needs no more memory."""
    writer, begin = SeriesWriter(tmp_path / "a.parquet", {"run": "a"}, holds=True), 0
    for size in sizes:
        writer.add(block(begin, size))
        begin += size
    held = writer.close()
    assert (held.held is None) is (len(sizes) > 1)
    read = held.released()
    assert (read.source, read.held, read.listed) == (held.source, None, None)
    assert held.listed is not None
    assert held.listed.equals(pq.read_metadata(tmp_path / "a.parquet"))
    assert pickle.loads(pickle.dumps(held)).listed is None
    assert pickle.loads(pickle.dumps(held)).held is None
    assert (held.names, held.about, held.units) == (read.names, read.about, read.units)
    assert held.blocks == read.blocks
    assert held.table().schema.equals(read.table().schema)
    for name in read.names:
        for part in (None, *read.blocks):
            one, other = held.column(name, part), read.column(name, part)
            assert (one.dtype, one.tobytes()) == (other.dtype, other.tobytes())
    for one, other in zip(held.telegrams("Z", ACTUAL), read.telegrams("Z", ACTUAL), strict=True):
        assert (one.dtype, one.tolist()) == (other.dtype, other.tolist())
    with pytest.raises(KeyError):
        held.column("Z.other")


def test_telegrams_are_all_of_the_bus_in_their_order(tmp_path: Path) -> None:
    """Rows 0 to 5 have 0, 1, 2, 0, 1, 2 telegrams."""
    ends, values = write(tmp_path / "a.parquet", [2, 4]).telegrams("Z", ACTUAL)
    assert ends.tolist() == [1 * MS, 2 * MS, 2 * MS + 1000, 4 * MS, 5 * MS, 5 * MS + 1000]
    assert values.tolist() == [10, 20, 21, 40, 50, 51]
    assert (ends.dtype, values.dtype) == (np.int64, np.int64)


def test_a_block_has_the_ends_of_its_own_telegrams(tmp_path: Path) -> None:
    """Block by block they are those of the whole, each once."""
    series = write(tmp_path / "a.parquet", [2, 4, 3])
    parts = [series.frame_ends_ns(f"Z.{ACTUAL}", each) for each in series.blocks]
    assert len(parts) == 3
    whole = series.frame_ends_ns(f"Z.{ACTUAL}")
    assert (
        np.concatenate(parts).tolist()
        == whole.tolist()
        == series.telegrams("Z", ACTUAL)[0].tolist()
    )


def test_a_field_that_no_telegram_has_is_empty(tmp_path: Path) -> None:
    series = write(tmp_path / "a.parquet", [3])
    for axis, field in (("Z", TARGET), ("Z", SECOND), ("X", ACTUAL)):
        ends, values = series.telegrams(axis, field)
        assert (len(ends), len(values)) == (0, 0)


def test_some_columns_are_a_table_in_their_order(tmp_path: Path) -> None:
    series = write(tmp_path / "a.parquet", [3])
    assert series.table(["probe.signal", "time_ns"]).column_names == ["probe.signal", "time_ns"]
    assert series.table().column_names == series.names


@pytest.mark.parametrize("is_kept", [True, False])
def test_a_column_that_was_not_recorded_is_a_key_error(tmp_path: Path, is_kept: bool) -> None:
    series = write(tmp_path / "a.parquet" if is_kept else None, [3])
    with pytest.raises(KeyError, match=r"Z\.truth_mm"):
        series.column("Z.truth_mm")


@pytest.mark.parametrize("is_kept", [True, False])
def test_of_several_columns_that_were_not_recorded_the_first_by_name_is_named(
    tmp_path: Path, is_kept: bool
) -> None:
    """In whatever order they are asked for, and beside some that are there."""
    series = write(tmp_path / "a.parquet" if is_kept else None, [3])
    for names in (["Z.b", "Z.a", "time_ns"], ["time_ns", "Z.a", "Z.b"]):
        with pytest.raises(MissingSignalError) as caught:
            series.table(names)
        assert str(caught.value) == "the recording has no signal Z.a"


@pytest.mark.parametrize("is_kept", [True, False])
def test_a_series_without_rows_has_no_block_and_one_with_rows_in_memory_has_one(
    tmp_path: Path, is_kept: bool
) -> None:
    path = tmp_path / "a.parquet" if is_kept else None
    for sizes, blocks in (([0], []), ([0, 0], []), ([5], [(0, 5)])):
        series = write(path, sizes)
        assert [(rows.start, rows.stop) for rows in series.blocks] == blocks
        assert len(series.column("time_ns")) == sum(sizes)
    several = write(path, [2, 0, 3]).blocks
    parts = [(0, 2), (2, 5)] if is_kept else [(0, 5)]
    assert [(rows.start, rows.stop) for rows in several] == parts


def test_a_trace_may_lie_in_folders_that_are_not_there_yet(tmp_path: Path) -> None:
    path = tmp_path / "results" / "of" / "traces" / "a.parquet"
    assert write(path, [2]).source == path
    assert Series(path).column("time_ns").tolist() == [0, MS]


def test_a_damaged_trace_is_one_line(tmp_path: Path) -> None:
    """However many lines the message of the library has."""
    path = tmp_path / "a.parquet"
    with pytest.raises(UserError) as caught, _readable(path):
        raise pa.ArrowInvalid("  Couldn't read it\nIn file parquet.cc, line 7\n")
    assert str(caught.value).splitlines()[0].endswith("the trace is damaged: Couldn't read it")
    assert "line 7" not in str(caught.value)
    with pytest.raises(OSError, match="denied") as refused, _readable(path):
        raise PermissionError(13, "denied")
    assert refused.value.errno == 13


def test_a_file_that_was_broken_off_is_named(tmp_path: Path) -> None:
    path = tmp_path / "plan-a.parquet"
    series = write(path, [40])
    data = path.read_bytes()
    for kept in (0, 4, len(data) // 2, len(data) - 1):
        path.write_bytes(data[:kept])
        with pytest.raises(UserError, match=r"plan-a\.parquet: the trace is damaged: \S"):
            series.column("Z.set_mm")


@pytest.mark.parametrize(
    "times", [None, pa.array([0.0, 1.0]), pa.array(["a", "b"])], ids=["none", "float", "text"]
)
def test_a_file_without_instants_is_named(tmp_path: Path, times: pa.Array | None) -> None:
    path = tmp_path / "plan-a.parquet"
    columns = {"Z.set_mm": pa.array([1.0, 2.0])}
    pq.write_table(pa.table(columns if times is None else {"time_ns": times, **columns}), path)
    for call in (lambda: Series(path).names, lambda: Series(path).column("Z.set_mm")):
        with pytest.raises(
            UserError, match=r"plan-a\.parquet: .*no column time_ns of whole numbers"
        ):
            call()


def test_a_file_that_is_not_there_is_no_damage(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"a\.parquet"):
        Series(tmp_path / "a.parquet").column("time_ns")


def test_a_run_that_is_broken_off_leaves_no_file(tmp_path: Path) -> None:
    path = tmp_path / "traces" / "a.parquet"
    writer = SeriesWriter(path)
    writer.add(block(0, 3))
    assert path.exists()
    writer.discard()
    assert not path.exists()
    finished = SeriesWriter(path)
    finished.add(block(0, 3))
    series = finished.close()
    finished.discard()
    assert series.column("time_ns").tolist() == [0, MS, 2 * MS]


def test_a_series_that_has_ended_ends_once_and_one_that_was_never_begun_leaves_no_file(
    tmp_path: Path,
) -> None:
    done = SeriesWriter(tmp_path / "done.parquet")
    done.add(block(0, 2))
    done.add(block(2, 3))
    series = done.close()
    assert done.close() is series
    done.discard()
    assert [(rows.start, rows.stop) for rows in Series(series.source).blocks] == [(0, 2), (2, 5)]
    SeriesWriter(tmp_path / "never.parquet").discard()
    SeriesWriter(None).discard()
    assert [path.name for path in tmp_path.iterdir()] == ["done.parquet"]


@pytest.mark.parametrize("is_kept", [True, False])
def test_a_series_has_its_rows_in_another_process_too(tmp_path: Path, is_kept: bool) -> None:
    """What is open or held stays; there the same rows are read again."""
    writer = SeriesWriter(tmp_path / "a.parquet" if is_kept else None, {"run": "r1"}, holds=True)
    writer.add({TIME: column_of(np.arange(3) * MS), ACTUAL_MM: column_of(np.arange(3) * 0.5)})
    series = writer.close()
    there: Series = pickle.loads(pickle.dumps(series))
    assert there.held is None
    assert there.about == series.about == {"run": "r1"}
    assert there.names == series.names == [TIME, ACTUAL_MM]
    assert there.column(ACTUAL_MM).tolist() == [0.0, 0.5, 1.0]


def test_a_block_without_instants_is_a_defect(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="time_ns"):
        SeriesWriter(tmp_path / "a.parquet").add({"time_s": pa.array([0.0])})


@pytest.mark.parametrize(
    "values",
    [
        np.array([1.5, math.nan, -math.inf, 0.0]),
        np.arange(12.0).reshape(4, 3)[:, 1],
        np.array([], dtype=np.float64),
        np.array([2**62, -1], dtype=np.int64),
        np.array([1, 0, -7], dtype=np.int8),
        np.array([0, 3, 5], dtype=np.int32),
        np.array([1.5, math.nan, 0.0], dtype=np.float32),
    ],
    ids=lambda values: f"{values.dtype}{len(values)}",
)
def test_columns_and_values_are_those_of_pyarrow(values: npt.NDArray[Any]) -> None:
    column, expected = column_of(values), pa.array(values, from_pandas=True)
    assert column.type == expected.type
    assert column.null_count == expected.null_count
    assert (column.buffers()[0] is None) == (not column.null_count)
    for chunked in (
        pa.chunked_array([column]),
        pa.chunked_array([column, column.slice(1), column.slice(0, 1)]),
        pa.chunked_array([], column.type),
    ):
        found = values_of(chunked)
        assert found.dtype == values.dtype
        assert found.flags.writeable
        np.testing.assert_array_equal(found, chunked.to_numpy())


def test_values_that_are_missing_or_no_numbers_are_given_as_by_pyarrow() -> None:
    for column in (pa.chunked_array([[1, None]]), pa.chunked_array([[True, False]])):
        np.testing.assert_array_equal(values_of(column), column.to_numpy())


@pytest.mark.parametrize("is_kept", [True, False])
def test_a_trace_says_its_units_its_run_and_its_rig(is_kept: bool, tmp_path: Path) -> None:
    """Read by another library than that of the writer's rows: the metadata of the file itself."""
    about = {"run": "plan-a", "rig": "rigs/z.toml"}
    writer = SeriesWriter(tmp_path / "a.parquet" if is_kept else None, about)
    writer.add(block(0, 3))
    series = writer.close()
    series.save(tmp_path / "a.parquet")
    answer = pq.read_schema(tmp_path / "a.parquet").metadata
    assert {key: answer[key] for key in (b"run", b"rig")} == {
        b"run": b"plan-a",
        b"rig": b"rigs/z.toml",
    }
    units = {
        "time_ns": "ns",
        "Z.set_mm": "mm",
        "Z.actual_frame_ns": "ns",
        "Z.actual_increments": "increments",
    }
    assert json.loads(answer[b"units"]) == units
    assert Series(tmp_path / "a.parquet").units == units
    assert Series(tmp_path / "a.parquet").about == about


def test_a_trace_of_an_older_version_has_the_units_of_its_names(tmp_path: Path) -> None:
    pq.write_table(pa.table(block(0, 3)), tmp_path / "old.parquet")
    old = Series(tmp_path / "old.parquet")
    assert old.about == {}
    assert old.units["Z.set_mm"] == "mm"
    assert "probe.signal" not in old.units


def test_units_are_those_of_the_plots() -> None:
    """The table by which the report labels its axes was written apart from the ends of names."""
    plots = {"µm": "um", "°": "deg", "°/s": "deg/s", "m°": "mdeg", "%": "pct"}
    with (ROOT / "reports/axisrig/reports/signals.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if not row["suffix"].startswith("change_")]
    for row in rows:
        unit = units_of([f"Z.{row['suffix']}"]).get(f"Z.{row['suffix']}", "")
        assert unit == plots.get(row["unit"], row["unit"]), row["suffix"]


def test_units_that_are_no_table_are_reported_with_the_file(tmp_path: Path) -> None:
    table = pa.table(block(0, 1), metadata={"units": "mm"})
    pq.write_table(table, tmp_path / "bad.parquet")
    with pytest.raises(UserError, match=r"bad\.parquet: the trace is damaged: units"):
        _ = Series(tmp_path / "bad.parquet").units


def unset_signal(path: Path) -> Path:
    """A signal without a value in most rows, in two blocks, the second without any value."""
    writer = SeriesWriter(path)
    for begin, values in ((0, [np.nan, -1.98, np.nan, 3.0]), (4, [np.nan, np.nan])):
        times = np.arange(begin, begin + len(values), dtype=np.int64)
        numbers = np.array(values, dtype=np.float64)
        writer.add({TIME: column_of(times), "Z.force_n": column_of(numbers)})
    writer.close()
    return path


@pytest.mark.long
def test_every_reader_counts_a_signal_without_a_value_alike(tmp_path: Path) -> None:
    """DuckDB answered 3, nothing or -1.98 for one question in three forms while NaN was stored."""
    path = unset_signal(tmp_path / "t.parquet")
    column = "Z.force_n"
    values = pq.read_table(path).column(column)
    frame, lazy = pd.read_parquet(path)[column], polars.read_parquet(path)[column]
    with duckdb.connect(":memory:") as connection:

        def ask(what: str, where: str = "") -> object:
            found = connection.execute(f"select {what} from '{path}' t {where}").fetchone()
            return None if found is None else found[0]

        x = f'"{column}"'
        assert pc.count(values).as_py() == frame.count() == lazy.count() == ask(f"count({x})") == 2
        assert pc.min(values).as_py() == frame.min() == lazy.min() == ask(f"min({x})") == -1.98
        assert pc.max(values).as_py() == frame.max() == lazy.max() == ask(f"max({x})") == 3.0
        assert frame.mean() == lazy.mean() == ask(f"avg({x})") == pytest.approx(0.51)
        for where, rows in ((f"{x} > 2", 1), (f"{x} < 0", 1), (f"{x} is null", 4)):
            assert ask("count(*)", f"where {where}") == rows
        assert (lazy > 2).sum() == (frame > 2).sum() == 1
        highest = f"where {x} is not null order by {x} desc limit 1"
        assert ask(x, highest) == ask(f"max({x})") == 3.0


def test_a_signal_without_a_value_is_no_number_for_the_bench(tmp_path: Path) -> None:
    path = unset_signal(tmp_path / "t.parquet")
    series = Series(path)
    expected = [np.nan, -1.98, np.nan, 3.0, np.nan, np.nan]
    np.testing.assert_array_equal(series.column("Z.force_n"), expected)
    np.testing.assert_array_equal(series.column("Z.force_n", series.blocks[1]), [np.nan] * 2)
    np.testing.assert_array_equal(values_of(series.whole.slice(1, 3).column(1)), expected[1:4])
    assert np.isnan(series.table().to_pandas()["Z.force_n"]).sum() == 4


@pytest.mark.parametrize("count", [0, 1, 7, 8, 9, 64, 65])
def test_columns_with_and_without_values_come_back(count: int) -> None:
    values = np.arange(count, dtype=np.float64)
    values[::3] = np.nan
    column = column_of(values)
    column.validate(full=True)
    assert column.null_count == len(values[::3])
    np.testing.assert_array_equal(values_of(pa.chunked_array([column])), values)
    whole = column_of(np.arange(count))
    assert whole.null_count == 0
