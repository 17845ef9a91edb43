"""SHA-256 of the files of a run, in its row of `cases.csv`: a file of another run is none of it."""

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from axisrig.bench.bus.can.logs import LOG_SUFFIXES, SEGMENT_MARK
from axisrig.bench.bus.ethercat.pcapng import SUFFIX as PCAPNG
from axisrig.bench.campaign.results.layout import BUS, RECORDINGS_OF, TRACES
from axisrig.bench.files import sha256_of

TRACE_SUM, RECORDING_SUM, BUS_LOG_SUM = "trace_sha256", "recording_sha256", "bus_log_sha256"
SUMS = (TRACE_SUM, RECORDING_SUM, BUS_LOG_SUM)
"""Columns of `cases.csv`; of bus logs `.blf:<sha>`, one word for each file. An asc log has a date
in its head, and another sum each time."""
_SUM = re.compile(r"([0-9a-f]{64})?")
_ENDINGS = "|".join(re.escape(suffix) for suffix in (*LOG_SUFFIXES.values(), PCAPNG))
_LOG = rf"((?:{SEGMENT_MARK}[^/\\\x00:]+)?(?:{_ENDINGS})):([0-9a-f]{{64}})"
_LOGS = re.compile(rf"(?:{_LOG}(?: {_LOG})*)?")
_ONE_LOG = re.compile(rf"(?:^| ){_LOG}")


def is_sum(cell: str) -> bool:
    """Whether a cell can be the sum of a trace or a recording; empty: the run has left none."""
    return _SUM.fullmatch(cell) is not None


def is_log_sums(cell: str) -> bool:
    """Whether a cell can hold sums of bus logs."""
    return _LOGS.fullmatch(cell) is not None


def sums_of(root: Path, run: str, names: Iterable[str]) -> dict[str, str]:
    """Return the cells of a run. names: of its files, from `root`."""
    cells, logs = dict.fromkeys(SUMS, ""), []
    for name in names:
        kind, _, file = name.partition("/")
        digits = sha256_of(root / name)
        if kind == BUS:
            logs.append(f"{file.removeprefix(run)}:{digits}")
        else:
            cells[TRACE_SUM if kind == TRACES else RECORDING_SUM] = digits
    return cells | {BUS_LOG_SUM: " ".join(logs)}


def altered_files(root: Path, run: str, row: Mapping[str, str]) -> Iterator[str]:
    """Yield names of files of a run, from `root`, that are not those that it has written.

    A file that is missing is none of these, and a row without sums (an older folder) says nothing.
    """
    if not row.get(RECORDING_SUM):
        return
    written = {
        f"{TRACES}/{run}.parquet": row.get(TRACE_SUM, ""),
        f"{RECORDINGS_OF}/{run}.json": row[RECORDING_SUM],
    }
    for ending, digits in _ONE_LOG.findall(row.get(BUS_LOG_SUM, "")):
        written[f"{BUS}/{run}{ending}"] = digits
    for name, digits in written.items():
        if (root / name).is_file() and sha256_of(root / name) != digits:
            yield name
