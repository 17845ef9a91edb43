"""Time series of a run: written in blocks while it lasts, read back by columns and blocks.

A row belongs to one SYNC. `time_ns` (int64) is its instant, the first one of all segments;
`<axis>.sync_after_ns` (int64) is how much later that of a drive was, `<axis>.<signal>_<unit>` and
`<plant>.<signal>` are one value for each row. `<axis>.<field>_frame_ns` and
`<axis>.<field>_increments` are lists: the cyclic values that the bus brought since the row before,
with the ends of their frames. `plc.inputs_frame_ns` has the ends of the telegrams of a node with
digital inputs alone.

The metadata of the schema say what the file is about: `units` (JSON: column -> unit), and where
they are known `run` and `rig`. Older files have none; `Series.units` goes by the names then.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow import OSFile

from axisrig.bench.files import naming
from axisrig.kernel.errors import UserError

Signal = npt.NDArray[np.float64]
Times = npt.NDArray[np.int64]

TIME: Final = "time_ns"
TARGET, ACTUAL, SECOND = "target", "actual", "second"
"""Cyclic values: target position 607A, actual position 6064, second encoder 60E4:1."""
SYNC_AFTER: Final = "sync_after_ns"
"""How much later than the row the SYNC of a drive was; in rigs with several segments."""
FRAME_NS, INCREMENTS = "frame_ns", "increments"
INPUTS: Final = "plc.inputs"
"""Telegrams of the node with digital inputs that is the terminal of the PLC."""
ABOUT: Final = ("run", "rig")
"""What the metadata of a file say beside the units."""
_UNITS: Final = "units"

# Columns and their names for an axis that turns; those of forces where its plant turns too
LENGTH_COLUMNS = {
    "set_mm": "set_deg",
    "actual_mm": "actual_deg",
    "truth_mm": "truth_deg",
    "velocity_mm_s": "velocity_deg_s",
    "cnc_lag_mm": "cnc_lag_deg",
    "drive_lag_mm": "drive_lag_deg",
    "drive_lag_peak_mm": "drive_lag_peak_deg",
    "stop_mm": "stop_deg",
    "superposed_mm": "superposed_deg",
    "offset_mm": "offset_deg",
    "sensor_mm": "sensor_deg",
    "distance_cnc_mm": "distance_cnc_deg",
    "surface_cnc_mm": "surface_cnc_deg",
    "filtered_mm": "filtered_deg",
    "error_mm": "error_deg",
    "delta_mm": "delta_deg",
    "step_mm": "step_deg",
    "set_pos_mm": "set_pos_deg",
    "set_dist_mm": "set_dist_deg",
}
FORCE_COLUMNS = {
    "force_n": "torque_nm",
    "stop_force_n": "stop_torque_nm",
    "stop_force_peak_n": "stop_torque_peak_nm",
}
# End of the name of a column -> its unit, as `metrics.csv` writes units
UNITS = {
    "mm_s": "mm/s",
    "deg_s": "deg/s",
    "mm": "mm",
    "deg": "deg",
    "nm": "N.m",
    "n": "N",
    "ns": "ns",
    "pct": "pct",
    "increments": "increments",
}


def units_of(columns: Iterable[str]) -> dict[str, str]:
    """Return the unit of each column that has one, by the end of its name."""
    found = {}
    for column in columns:
        unit = next((unit for end, unit in UNITS.items() if column.endswith(f"_{end}")), None)
        if unit is not None:
            found[column] = unit
    return found


pa.set_memory_pool(pa.system_memory_pool())  # the one it brings along keeps what was freed


class MissingSignalError(KeyError):
    """A signal that was not recorded."""

    def __str__(self) -> str:
        return f"the recording has no signal {self.args[0]}"


class Telegrams(NamedTuple):
    """Values of a field in their order: ends of their frames, ns, and increments; shape (n,)."""

    frame_ns: Times
    increments: Times


@dataclass(frozen=True)
class Series:
    """The time series of a run.

    source: the file where they are, or the table itself for a run that is not kept. held: the same
    as the file has, while it is in memory; listed: what its end says, from who has written it; see
    `released`.
    """

    source: Path | pa.Table
    held: pa.Table | None = None
    listed: pq.FileMetaData | None = None

    def released(self) -> "Series":
        """Return the series without `held` and `listed`: who asks reads the file."""
        return Series(self.source)

    @property
    def names(self) -> list[str]:
        """Return the columns with one value for each row, in their order.

        Raises UserError when the file is damaged, OSError when it cannot be read.
        """
        return [item.name for item in self._schema if not pa.types.is_list(item.type)]

    @property
    def about(self) -> Mapping[str, str]:
        """What the file says of itself: `run` and `rig`; empty in older ones. Raises as `names`."""
        given = self._schema.metadata or {}
        texts = {key.decode(): value.decode() for key, value in given.items()}
        return {key: texts[key] for key in ABOUT if key in texts}

    @property
    def units(self) -> Mapping[str, str]:
        """Return the unit of each column that has one. Raises as `names`."""
        given = (self._schema.metadata or {}).get(_UNITS.encode())
        if given is None:
            return units_of(self._schema.names)
        try:
            units: Mapping[str, str] = json.loads(given)
        except ValueError as error:
            raise _damaged(self.source, "units are no JSON") from error
        return units

    @cached_property
    def blocks(self) -> tuple[slice, ...]:
        """Rows of each block that was written, in their order; of a run in memory its only one."""
        if isinstance(self.source, Path):
            begins, count = self._groups, self._rows
        else:
            begins, count = {0: 0} if self.source.num_rows else {}, self.source.num_rows
        return tuple(slice(begin, end) for begin, end in pairwise([*begins, count]))

    def column(self, name: str, block: slice | None = None) -> npt.NDArray[np.generic]:
        """Return one value for each row, of one of the `blocks` or of all, shape (n,).

        Raises MissingSignalError for one that was not recorded.
        """
        values: npt.NDArray[np.generic] = values_of(self._read([name], block).column(0))
        return values

    def telegrams(self, axis: str, field: str, block: slice | None = None) -> Telegrams:
        """Return the cyclic values of a field (TARGET, ACTUAL, SECOND); empty without any.

        Of the rows of one of the `blocks`, or of all.
        """
        names = [f"{axis}.{field}_{part}" for part in (FRAME_NS, INCREMENTS)]
        if names[0] not in self._schema.names:
            return Telegrams(np.empty(0, np.int64), np.empty(0, np.int64))
        table = self._read(names, block)
        return Telegrams(*(_flat(table.column(place)) for place in (0, 1)))

    def frame_ends_ns(self, of: str, block: slice | None = None) -> Times:
        """Return the ends of the telegrams `of` on the wire, ns; rows as `telegrams`."""
        name = f"{of}_{FRAME_NS}"
        if name not in self._schema.names:
            return np.empty(0, np.int64)
        return _flat(self._read([name], block).column(0))

    def table(self, names: Sequence[str] | None = None) -> pa.Table:
        """Return some columns, or all with one value for each row."""
        return self._read(self.names if names is None else names)

    @cached_property
    def whole(self) -> pa.Table:
        """Every column with one value for each row, read once; `column` takes them from it then.

        For who needs them all at the end: to read each by itself takes longer. Raises as `names`.
        """
        return self.table()

    def save(self, path: Path) -> None:
        """Write series that are in memory into a file; those of a file are there already.

        Raises OSError with the name of the file.
        """
        if not isinstance(self.source, Path):
            writer = SeriesWriter(path, self.about)
            writer.add(dict(zip(self.source.column_names, self.source.columns, strict=True)))
            writer.close()

    def __reduce__(self) -> tuple[type["Series"], tuple[Path | pa.Table]]:
        return Series, (self.source,)  # an open file stays in its process

    @cached_property
    def _file(self) -> pq.ParquetFile:
        assert isinstance(self.source, Path)
        with _readable(self.source):
            return pq.ParquetFile(self.source, metadata=self.listed, memory_map=False)

    @property
    def _table(self) -> pa.Table | None:
        """The series where they are in memory."""
        return self.held if isinstance(self.source, Path) else self.source

    @property
    def _rows(self) -> int:
        return int(self._file.metadata.num_rows if self.held is None else self.held.num_rows)

    @cached_property
    def _schema(self) -> pa.Schema:
        table = self._table
        schema = self._file.schema_arrow if table is None else table.schema
        if TIME not in schema.names or schema.field(TIME).type != pa.int64():
            raise _damaged(self.source, "no column time_ns of whole numbers")
        return schema

    def _read(self, names: Sequence[str], block: slice | None = None) -> pa.Table:
        missing = set(names) - set(self._schema.names)
        if missing:
            raise MissingSignalError(min(missing))
        table = self._table
        if table is not None:
            return table.select(list(names))
        whole = self.__dict__.get("whole")  # where it has been asked for
        if whole is not None and set(names) <= set(whole.column_names):
            table = whole.select(list(names))
            return table if block is None else table.slice(block.start, block.stop - block.start)
        with _readable(self.source):
            if block is None:
                table = self._file.read(columns=list(names), use_threads=False)
            else:
                number = self._groups[block.start]
                table = self._file.read_row_group(number, list(names), use_threads=False)
            return table.select(list(names))

    @cached_property
    def _groups(self) -> dict[int, int]:
        """First row of a block -> number of its row group in the file."""
        if self.held is not None:  # of one block only
            return {0: 0} if self.held.num_rows else {}
        groups = self._file.metadata
        sizes = [groups.row_group(number).num_rows for number in range(groups.num_row_groups)]
        begins = np.cumsum([0, *sizes]).tolist()
        return {begins[number]: number for number, size in enumerate(sizes) if size}


class _readable:  # noqa: N801
    """Turns what the library raises for a damaged file into a UserError."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, traceback: object) -> None:
        if isinstance(error, pa.ArrowException | OSError) and not (
            isinstance(error, OSError) and error.errno is not None  # the file cannot be read at all
        ):
            raise _damaged(self._path, str(error).strip().partition("\n")[0]) from error


def _damaged(source: Path | pa.Table, why: str) -> UserError:
    file = source if isinstance(source, Path) else None
    return UserError(f"the trace is damaged: {why}", file=file)


def _flat(lists: pa.ChunkedArray) -> Times:
    return values_of(pa.chunked_array([chunk.flatten() for chunk in lists.chunks], pa.int64()))


def column_of(values: npt.NDArray[np.generic]) -> pa.Array:
    """Return numbers, shape (n,), as a column; equal to `pa.array`, which loads pandas for it.

    A float that is no number (NaN) has no value there: every reader of Parquet leaves such a row
    out of its statistics, and readers differ in how they count NaN.
    """
    whole = np.ascontiguousarray(values)
    kind = pa.from_numpy_dtype(whole.dtype)
    unset = np.isnan(whole) if whole.dtype.kind == "f" else np.zeros(0, bool)
    count = int(np.count_nonzero(unset))
    valid = pa.py_buffer(np.packbits(~unset, bitorder="little")) if count else None
    return pa.Array.from_buffers(kind, len(whole), [valid, pa.py_buffer(whole)], null_count=count)


def values_of(column: pa.ChunkedArray) -> npt.NDArray[Any]:
    """Return the numbers of a column, shape (n,); equal to `to_numpy`, which loads pandas.

    A float without a value is NaN.
    """
    kind = column.type
    if not (pa.types.is_floating(kind) or (pa.types.is_integer(kind) and not column.null_count)):
        values: npt.NDArray[Any] = column.to_numpy()
        return values
    dtype = np.dtype(kind.to_pandas_dtype())
    parts = [_numbers(chunk, dtype) for chunk in column.chunks if len(chunk)]
    return np.concatenate([np.empty(0, dtype), *parts])


def _numbers(chunk: pa.Array, dtype: np.dtype[Any]) -> npt.NDArray[Any]:
    valid, data = chunk.buffers()
    numbers = np.frombuffer(data, dtype, len(chunk), chunk.offset * dtype.itemsize)
    if not chunk.null_count:
        return numbers
    bits = np.unpackbits(np.frombuffer(valid, np.uint8), bitorder="little")
    return np.where(bits[chunk.offset : chunk.offset + len(chunk)], numbers, np.nan)


SINK_BYTES = 1 << 18
"""So much of a file is collected before it is written: most runs are written at once."""


class SeriesWriter:
    """Takes blocks of rows and puts them into a file, or keeps them where there is none.

    All blocks have the columns of the first one. `close` gives the series; `discard` drops what was
    written. about: `run` and `rig` of the series. holds: those of one block stay in memory as well,
    for who reads them at once (`Series.released`).
    """

    def __init__(
        self, path: Path | None, about: Mapping[str, str] | None = None, *, holds: bool = False
    ) -> None:
        self._path, self._about, self._holds = path, dict(about or {}), holds
        self._file: pq.ParquetWriter | None = None
        self._sink: pa.NativeFile | None = None
        self._tables: list[pa.Table] = []
        self._held: pa.Table | None = None
        self._metadata: dict[str, str] | None = None
        self._series: Series | None = None

    def add(self, columns: Mapping[str, pa.Array]) -> None:
        """Write a block. Raises OSError with the name of the file.

        Raises ValueError for a block without instants: a defect.
        """
        if TIME not in columns:
            raise ValueError(f"a block without {TIME}")
        if self._metadata is None:  # all blocks have the columns of the first one
            self._metadata = {**self._about, _UNITS: json.dumps(units_of(columns))}
        table = pa.table(dict(columns), metadata=self._metadata)
        if self._path is None:
            self._tables.append(table)
            return
        with naming(self._path):
            if self._file is None:
                self._file = self._opened(self._path, table.schema)
            self._file.write_table(table)
        self._held, self._holds = (table if self._holds else None), False

    def close(self) -> Series:
        """Finish; at least one block was written. Raises OSError with the name of the file."""
        if self._series is None:
            if self._path is None:
                self._series = Series(pa.concat_tables(self._tables))
            else:
                assert self._file is not None
                assert self._sink is not None
                with naming(self._path):
                    self._file.close()
                    self._sink.close()
                listed = self._file.writer.metadata
                self._series, self._held = Series(self._path, self._held, listed), None
        return self._series

    def discard(self) -> None:
        """Drop a file that was not finished; nothing happens to one that was."""
        if self._file is not None and self._path is not None and self._series is None:
            with suppress(OSError):
                self._file.close()
            with suppress(OSError):
                if self._sink is not None:
                    self._sink.close()
            with suppress(OSError):
                self._path.unlink()

    def _opened(self, path: Path, schema: pa.Schema) -> pq.ParquetWriter:
        """Open the file; its pages are collected, for each would be a call of the system."""
        path.parent.mkdir(parents=True, exist_ok=True)
        self._sink = pa.BufferedOutputStream(OSFile(str(path), "wb"), SINK_BYTES)
        return pq.ParquetWriter(self._sink, schema, **_encoding(schema))


def _encoding(schema: pa.Schema) -> dict[str, object]:
    """Return how a file is written: LZ4, floats split into byte streams, times as differences.

    LZ4 takes half the time of zstd for files 1.01 to 1.1 times as large.
    """
    floats = [item.name for item in schema if pa.types.is_floating(item.type)]
    lists = [f"{item.name}.list.element" for item in schema if pa.types.is_list(item.type)]
    return {
        "compression": "lz4",
        "use_dictionary": False,
        "use_byte_stream_split": floats,
        "column_encoding": dict.fromkeys([TIME, *lists], "DELTA_BINARY_PACKED"),
    }
