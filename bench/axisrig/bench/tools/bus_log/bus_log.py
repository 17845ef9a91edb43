"""`axisrig bus`: finds a bus log, reads it and chooses the frames that are shown."""

import heapq
import logging
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import can

from axisrig.bench.bus.can.dissect import Dissected, dissect
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.logs import LOG_SUFFIXES, SEGMENT_MARK
from axisrig.bench.bus.can.pcap import read_pcap
from axisrig.bench.bus.ethercat.pcapng import SUFFIX as PCAPNG
from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.campaign.replay import recorded_case
from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.bus_log.candump import read_candump
from axisrig.bench.tools.bus_log.canopen.bus_words import Names, is_boot_up
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.ethercat.log import tell_lines
from axisrig.kernel.errors import UserError, printable
from axisrig.kernel.profiles.canopen.identifiers import services

READABLE = [*LOG_SUFFIXES.values(), PCAPNG]
PCAP, CANDUMP = LOG_SUFFIXES["pcap"], LOG_SUFFIXES["candump"]
DRIVES_LOG = "bus.blf"
"""What `axisrig drive -o DIR` writes."""

EPOCH_S = 1e8
"""A later first time is a date: times are then counted from the first frame on."""

GROUPS = ("SDO", "LSS", "PDO", "TPDO", "RPDO", "boot-up", "abort", "error")
"""Words for services beside those of `identifiers.csv`."""

_PDO = re.compile(r"[rt]pdo\d{1,3}")
_OBJECT = re.compile(r"(?:0x)?([0-9a-f]{4})(?::([0-9a-f]{1,2}))?")


@dataclass(frozen=True)
class _Line:
    time_ms: float
    segment: str
    text: str
    is_error: bool


def find_log(place: Path, run: str | None) -> tuple[list[Path], Settings | None]:
    """Return the files of the log that is meant, one but for pcap logs of several segments.

    With them come the settings of the run where they are in a results folder.
    Raises UserError when there is none.
    """
    if not place.is_dir():
        if not place.is_file() or place.suffix.lower() not in READABLE:
            raise UserError("no bus log that can be read", value=str(place), allowed=READABLE)
        return [place], None
    if run is None and (place / DRIVES_LOG).is_file():
        return [place / DRIVES_LOG], None
    runs = [stored.run for stored in read_results(place).runs]
    if run is None:
        raise UserError("which run of the folder?", file=place, allowed=runs)
    case, _ = recorded_case(place, run)
    return logs_of(place, run), settings_of(case)


def logs_of(place: Path, run: str) -> list[Path]:
    """Return the files of the log of a run of a results folder. Raises UserError without one."""
    folder = place / "bus"
    found = [folder / f"{run}{suffix}" for suffix in READABLE]
    several = sorted(p for p in folder.glob("*.pcap") if p.stem.startswith(run + SEGMENT_MARK))
    lines = sorted(p for p in folder.glob(f"*{PCAPNG}") if p.stem.startswith(run + SEGMENT_MARK))
    for files in [*([path] for path in found if path.is_file()), several]:
        if files:
            return [*files, *lines]
    if lines:
        return lines
    raise UserError("the run left no bus log that can be read", file=folder, allowed=READABLE)


def tell_log(
    paths: Sequence[Path], settings: Settings | None, selection: Selection
) -> Iterator[str]:
    """Yield the lines for the frames of a log, and one that says so when there are none.

    Error frames in a row are one line; EtherCAT lines come behind the CAN buses of a run. Raises
    UserError for a damaged log or an unknown word.
    """
    lines = [path for path in paths if path.suffix.lower() == PCAPNG]
    buses = [path for path in paths if path not in lines]
    if buses:
        yield from _tell_buses(buses, settings, selection)
    if lines:
        is_empty = True
        for text in tell_lines(lines, settings, selection):
            is_empty = False
            yield text
        if is_empty:
            yield _nothing(lines, selection)


def _nothing(paths: Sequence[Path], selection: Selection) -> str:
    words = f" for {', '.join(selection.only)}" if selection.only else ""
    return f"no frame{words} among those of {paths[0]} that are shown (see --all)"


def _tell_buses(
    paths: Sequence[Path], settings: Settings | None, selection: Selection
) -> Iterator[str]:
    names = Names(settings)
    wanted = _wanted(selection.only, names.axes)
    is_empty, row, count, last_ms = True, None, 0, 0.0
    for line in _lines(paths, names, selection, wanted):
        is_empty = False
        if row is not None and line.is_error and line.segment == row.segment:
            count, last_ms = count + 1, line.time_ms
            continue
        yield from _folded(row, count, last_ms)
        row, count = (line, 1) if line.is_error else (None, 0)
        if row is None:
            yield line.text
    yield from _folded(row, count, last_ms)
    if is_empty:
        yield _nothing(paths, selection)


def _folded(row: _Line | None, count: int, last_ms: float) -> Iterator[str]:
    if row is not None:
        yield row.text if count == 1 else f"{row.text}  {count} times until {last_ms:.3f} ms"


def _wanted(only: Iterable[str], axes: Sequence[str]) -> frozenset[str]:
    """Return the tags that are asked for. Raises UserError for a word that is none."""
    kinds = [*(service.name for service in services()), "error frame", "unknown", *GROUPS]
    known = {kind.lower() for kind in kinds}
    whose = {axis.lower() for axis in axes} | {str(node) for node in range(1, 128)}
    found = set()
    for word in only:
        low = word.strip().lower()
        who, dot, kind = low.partition(".")
        item = _OBJECT.fullmatch(low)
        is_kind = low in known or _PDO.fullmatch(low)
        if is_kind or (who in whose and (not kind or kind in known or _PDO.fullmatch(kind))):
            found.add(low if kind else who if dot else low)
        elif item is not None:
            found.add(item[1] + (f":{int(item[2], 16):x}" if item[2] else ""))
        else:
            allowed = [*kinds, *(axes or ["node number"]), "Z.TPDO1", "6041", "6041:0"]
            raise UserError(
                "--only: no service, axis, telegram or object", value=word, allowed=allowed
            )
    return frozenset(found)


def _lines(
    paths: Sequence[Path], names: Names, selection: Selection, wanted: frozenset[str]
) -> Iterator[_Line]:
    last: dict[tuple[str, int], object] = {}
    for time_ms, message in _times(messages_of(paths)):
        if time_ms > selection.to_ms:
            return
        segment = names.segment(message.channel)
        frame = Frame(
            message.arbitration_id,
            bytes(message.data),
            message.is_extended_id,
            message.is_remote_frame,
            message.dlc,
        )
        told = names.follow(segment, frame, dissect(frame, is_error=message.is_error_frame))
        if time_ms < selection.from_ms:
            continue
        key = (segment, frame.arbitration_id)
        content = _content(told, frame)
        is_old = _repeats(told) and key in last and last[key] == content
        if not message.is_error_frame:
            last[key] = content
        if is_old and not selection.is_all:
            continue
        said = names.describe(segment, frame, told)
        if wanted and not wanted & said.tags:
            continue
        can_id = "   " if message.is_error_frame else f"{frame.arbitration_id:03X}"
        text = f"{time_ms:10.3f}  {segment:<6} {can_id}  {said.name:<16} {said.text}".rstrip()
        yield _Line(time_ms, segment, text, message.is_error_frame)


def messages_of(paths: Sequence[Path]) -> Iterator[can.Message]:
    """Yield the frames of a log by time. Raises UserError for a damaged one."""
    if paths[0].suffix.lower() == PCAP:
        yield from heapq.merge(*map(read_pcap, paths), key=lambda message: message.timestamp)
        return
    try:
        with _complaining(), ExitStack() as opened:
            is_candump = paths[0].suffix.lower() == CANDUMP
            yield from (
                read_candump(paths[0])
                if is_candump
                else opened.enter_context(can.LogReader(paths[0]))
            )
    except Exception as error:  # the readers of python-can raise whatever comes up
        what = printable(str(error)) or type(error).__name__
        raise UserError(f"the log is damaged: {what}", file=paths[0]) from error


class _Complaint(logging.Handler):
    """Makes an error of what a reader of python-can would only warn of, leaving frames out."""

    def emit(self, record: logging.LogRecord) -> None:
        raise ValueError(record.getMessage())


@contextmanager
def _complaining() -> Iterator[None]:
    reader, complaint = logging.getLogger("can.io"), _Complaint(logging.WARNING)
    reader.addHandler(complaint)
    try:
        yield
    finally:
        reader.removeHandler(complaint)


def _times(messages: Iterable[can.Message]) -> Iterator[tuple[float, can.Message]]:
    """Yield time in ms and message; times count from the first frame where they are dates."""
    iterator = iter(messages)
    first = next(iterator, None)
    if first is None:
        return
    origin_s = first.timestamp if first.timestamp > EPOCH_S else 0.0
    for message in chain([first], iterator):
        yield (message.timestamp - origin_s) * 1e3, message


def _content(told: Dissected, frame: Frame) -> object:
    """Return what must change for a cyclic frame to be news; a toggle bit is none."""
    return told.fields.get("state", frame.data) if told.service == "heartbeat" else frame.data


def _repeats(told: Dissected) -> bool:
    """Whether a frame comes cyclically, so that it is worth a line only when it has changed.

    A boot-up never does: it says that a node has started anew.
    """
    if told.service == "heartbeat":
        return not is_boot_up(told)
    return told.service == "SYNC" or "PDO" in told.service
