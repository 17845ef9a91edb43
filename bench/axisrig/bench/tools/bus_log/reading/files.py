"""Which files are logs of a CAN bus, and their messages in the order of time."""

import heapq
import logging
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import can

from axisrig.bench.bus.can.logs import (
    LINKTYPE_CAN_SOCKETCAN,
    LOG_SUFFIXES,
)
from axisrig.bench.bus.can.pcap import read_pcap, socketcan_message
from axisrig.bench.bus.ethercat.pcapng import SUFFIX as PCAPNG
from axisrig.bench.tools.bus_log.reading.asc import AscLines, read_asc
from axisrig.bench.tools.bus_log.reading.candump import read_candump, read_screen
from axisrig.bench.tools.bus_log.reading.lines import ASC, SCREEN, TRC, Lines, kind_of
from axisrig.bench.tools.bus_log.reading.pcapng import ETHERNET, read_packets
from axisrig.bench.tools.bus_log.reading.progress import Progress, opened, suffix_of
from axisrig.bench.tools.bus_log.reading.trc import read_trc
from axisrig.kernel.errors import UserError, printable
from axisrig.kernel.time.clock import S

TEXTS: Final = (LOG_SUFFIXES["candump"], LOG_SUFFIXES["asc"], ".trc", ".txt")
BLF, PCAP = LOG_SUFFIXES["blf"], LOG_SUFFIXES["pcap"]
READABLE: Final = (*LOG_SUFFIXES.values(), PCAPNG, ".trc", ".txt")
"""Suffixes of logs; each may have `.gz` behind it."""

WINDOW_S: Final = 1.0
"""Frames that a tool wrote so much too late are put in their places: buffers of interfaces, of
threads that write. What is further back is another recording in the same file."""

_NEWER_BLF: Final = "Unknown object header version (3)"


def is_readable(path: Path) -> bool:
    """Whether a file is a log by its name."""
    return path.is_file() and suffix_of(path) in READABLE


def is_line(path: Path) -> bool:
    """Whether a log is of an EtherCAT line: a pcapng file that begins with a packet of Ethernet.

    Raises UserError for a damaged file.
    """
    if suffix_of(path) != PCAPNG:
        return False
    first = next(read_packets(path), None)
    return first is None or first.link == ETHERNET


def messages_of(paths: Sequence[Path], progress: Progress | None = None) -> Iterator[can.Message]:
    """Yield the frames of a log by time, as far as `in_order` does so.

    paths: one, but of pcap logs of several segments. progress: counts what was read.
    Raises UserError for a damaged log.
    """
    progress = progress or Progress()
    if suffix_of(paths[0]) == PCAP and len(paths) > 1:
        by_time = heapq.merge(*map(read_pcap, paths), key=lambda message: message.timestamp)
        read: Iterator[can.Message] = iter(by_time)
    else:
        read = _of_file(paths[0], progress)
    yield from in_order(_counted(read, progress))


def in_order(messages: Iterable[can.Message]) -> Iterator[can.Message]:
    """Yield messages by time; where the time goes back by more than `WINDOW_S`, it begins anew."""
    waiting = list[tuple[float, int, can.Message]]()
    newest_s = float("-inf")
    try:
        for number, message in enumerate(messages):
            time_s = message.timestamp
            if time_s < newest_s - WINDOW_S:
                yield from _drained(waiting)
                newest_s = time_s
            newest_s = max(newest_s, time_s)
            heapq.heappush(waiting, (time_s, number, message))
            while waiting[0][0] < newest_s - WINDOW_S:
                yield heapq.heappop(waiting)[2]
    except UserError:
        yield from _drained(waiting)  # what came before the damage
        raise
    yield from _drained(waiting)


def _drained(waiting: list[tuple[float, int, can.Message]]) -> Iterator[can.Message]:
    while waiting:
        yield heapq.heappop(waiting)[2]


def _counted(messages: Iterable[can.Message], progress: Progress) -> Iterator[can.Message]:
    for message in messages:
        progress.frames += 1
        yield message


def _of_file(path: Path, progress: Progress) -> Iterator[can.Message]:
    suffix = suffix_of(path)
    try:
        if suffix == PCAP:
            yield from read_pcap(path)
        elif suffix == PCAPNG:
            yield from _of_pcapng(path, progress)
        elif suffix == BLF:
            with _complaining(), can.BLFReader(opened(path, progress)) as reader:
                yield from reader
        else:
            yield from _of_text(path, suffix, progress)
    except UserError as error:
        if error.file is not None:
            raise
        raise UserError(
            error.message, file=path, value=error.value, allowed=error.allowed, hint=error.hint
        ) from error
    except Exception as error:  # the readers of python-can raise whatever comes up
        text = str(error)
        if text == _NEWER_BLF:
            raise UserError(
                "objects of header version 3 (as of CANoe 15) are not read",
                file=path,
                hint="export the log as ASC",
            ) from error
        what = printable(text) or type(error).__name__
        raise UserError(f"the log is damaged: {what}", file=path) from error


def _of_text(path: Path, suffix: str, progress: Progress) -> Iterator[can.Message]:
    kind = kind_of(path, suffix)
    lines = AscLines(path, progress) if kind == ASC else Lines(path, progress)
    try:
        with _complaining():
            if isinstance(lines, AscLines):
                yield from read_asc(lines)
            elif kind == SCREEN:
                yield from read_screen(lines)
            else:
                yield from (read_trc if kind == TRC else read_candump)(lines)
    except UserError:
        raise
    except Exception as error:  # as above
        what = printable(str(error)) or type(error).__name__
        is_cut = lines.is_cut
        text = "the last line is cut" if is_cut else f"the log is damaged: {what}"
        shown = printable(lines.last.strip())
        raise UserError(text, file=path, line=lines.number, value=shown) from error
    finally:
        lines.close()


def _of_pcapng(path: Path, progress: Progress) -> Iterator[can.Message]:
    for packet in read_packets(path, progress):
        if packet.link != LINKTYPE_CAN_SOCKETCAN:
            allowed = f"{LINKTYPE_CAN_SOCKETCAN} (SocketCAN)"
            raise UserError("pcapng file of another link type", value=packet.link, allowed=allowed)
        yield socketcan_message(packet.data, packet.time_ns / S, packet.interface or None)


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


def is_timeless(path: Path) -> bool:
    """Whether a log has no times: candump on the screen without -t."""
    if suffix_of(path) not in TEXTS or kind_of(path, suffix_of(path)) != SCREEN:
        return False
    return all(message.timestamp == 0.0 for message in messages_of([path]))
