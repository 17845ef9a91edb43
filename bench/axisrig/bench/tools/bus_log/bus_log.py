"""`axisrig bus`: finds a bus log, reads it and chooses the frames that are shown."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import can

from axisrig.bench.bus.can.dissect import Dissected, dissect
from axisrig.bench.bus.can.frame import Frame, identifier_text
from axisrig.bench.bus.can.logs import SEGMENT_MARK
from axisrig.bench.bus.ethercat.pcapng import SUFFIX as PCAPNG
from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.campaign.replay import recorded_case
from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.rig.canopen.members import can_segments
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.bus_log.canopen.bus_words import Names, is_boot_up
from axisrig.bench.tools.bus_log.choice.channels import Channels
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.ethercat.log import tell_lines
from axisrig.bench.tools.bus_log.reading.files import (
    READABLE,
    is_line,
    is_readable,
    is_timeless,
    messages_of,
)
from axisrig.bench.tools.bus_log.reading.progress import Progress
from axisrig.kernel.errors import UserError
from axisrig.kernel.profiles.canopen.identifiers import services

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
    is_error: bool = False
    is_note: bool = False


def find_log(place: Path, run: str | None) -> tuple[list[Path], Settings | None]:
    """Return the files of the log that is meant, one but for pcap logs of several segments.

    With them come the settings of the run where they are in a results folder.
    Raises UserError when there is none.
    """
    if not place.is_dir():
        if not is_readable(place):
            allowed = f"{', '.join(READABLE)}, each also with .gz"
            raise UserError("no bus log that can be read", value=str(place), allowed=allowed)
        return [place], None
    if run is None and (place / DRIVES_LOG).is_file():
        return [place / DRIVES_LOG], None
    runs = [stored.run for stored in read_results(place).runs]
    if run is None:
        raise UserError("no run of the folder is named", file=place, allowed=runs)
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
    paths: Sequence[Path],
    settings: Settings | None,
    selection: Selection,
    progress: Progress | None = None,
) -> Iterator[str]:
    """Yield the lines for the frames of a log, and one that says so when there are none.

    Error frames in a row are one line; EtherCAT lines come behind the CAN buses of a run.
    progress: counts what was read. Raises UserError for a damaged log or an unknown word.
    """
    lines = [path for path in paths if is_line(path)]
    buses = [path for path in paths if path not in lines]
    if buses:
        yield from _tell_buses(buses, settings, selection, progress)
    if lines:
        is_empty = True
        for text in tell_lines(lines, settings, selection, progress):
            is_empty = False
            yield text
        if is_empty:
            yield _nothing(lines, selection)


def _nothing(paths: Sequence[Path], selection: Selection) -> str:
    words = f" for {', '.join(selection.only)}" if selection.only else ""
    return f"no frame{words} among those of {paths[0]} that are shown (see --all)"


def _tell_buses(
    paths: Sequence[Path],
    settings: Settings | None,
    selection: Selection,
    progress: Progress | None,
) -> Iterator[str]:
    if is_timeless(paths[0]):
        yield "the log has no times (candump without -l and -t), only the order of its frames"
    names = Names(settings)
    wanted = _wanted(selection.only, names.axes)
    channels = Channels(
        can_segments(settings) if settings is not None else [],
        selection.segments,
        lambda: {message.channel for message in messages_of(paths, progress)},
    )
    is_empty, row, count, last_ms = True, None, 0, 0.0
    for line in _lines(_times(messages_of(paths, progress)), names, channels, selection, wanted):
        if line.is_note:
            yield from _folded(row, count, last_ms)
            row = None
            yield line.text
            continue
        is_empty = False
        if row is not None and line.is_error and line.segment == row.segment:
            count, last_ms = count + 1, line.time_ms
            continue
        yield from _folded(row, count, last_ms)
        row, count = (line, 1) if line.is_error else (None, 0)
        if row is None:
            yield line.text
    yield from _folded(row, count, last_ms)
    if channels.unused:
        yield f"no frame of channel {', '.join(channels.unused)} is in the log (--segment)"
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
    messages: Iterable[tuple[float, can.Message]],
    names: Names,
    channels: Channels,
    selection: Selection,
    wanted: frozenset[str],
) -> Iterator[_Line]:
    last: dict[tuple[str, int, bool], object] = {}
    before_ms = float("-inf")
    for time_ms, message in messages:
        segment = channels.segment(message.channel)
        for note in channels.notes():
            yield _Line(time_ms, segment, note, is_note=True)
        if time_ms < before_ms:
            text = f"the times of the log go back by {before_ms - time_ms:.3f} ms here"
            yield _Line(time_ms, segment, text, is_note=True)
        before_ms = time_ms
        frame = Frame(
            message.arbitration_id,
            bytes(message.data),
            message.is_extended_id,
            message.is_remote_frame,
            message.dlc,
        )
        dissected = names.follow(segment, frame, dissect(frame, is_error=message.is_error_frame))
        if not selection.from_ms <= time_ms <= selection.to_ms:
            continue
        key = (segment, frame.arbitration_id, frame.is_extended_id)
        content = _content(dissected, frame)
        is_old = _repeats(dissected) and key in last and last[key] == content
        if not message.is_error_frame:
            last[key] = content
        if is_old and not selection.is_all:
            continue
        described = names.describe(segment, frame, dissected)
        if wanted and not wanted & described.tags:
            continue
        can_id = identifier_text(frame.arbitration_id, frame.is_extended_id)
        can_id = "   " if message.is_error_frame else can_id
        text = f"{time_ms:10.3f}  {segment:<6} {can_id}  {described.name:<16} {described.text}"
        yield _Line(time_ms, segment, text.rstrip(), message.is_error_frame)


def _times(messages: Iterable[can.Message]) -> Iterator[tuple[float, can.Message]]:
    """Yield time in ms and message; times count from the first frame where they are dates."""
    iterator = iter(messages)
    first = next(iterator, None)
    if first is None:
        return
    origin_s = first.timestamp if first.timestamp > EPOCH_S else 0.0
    for message in chain([first], iterator):
        yield (message.timestamp - origin_s) * 1e3, message


def _content(dissected: Dissected, frame: Frame) -> object:
    """Return what must change for a cyclic frame to be news; a toggle bit is none."""
    return (
        dissected.fields.get("state", frame.data)
        if dissected.service == "heartbeat"
        else frame.data
    )


def _repeats(dissected: Dissected) -> bool:
    """Whether a frame comes cyclically, so that it is worth a line only when it has changed.

    A boot-up never does: it says that a node has started anew.
    """
    if dissected.service == "heartbeat":
        return not is_boot_up(dissected)
    return dissected.service == "SYNC" or "PDO" in dissected.service
