"""Log files of the traffic, with times that count from the start of the run.

| kind | suffix | written by | times | same bytes in every run |
|---|---|---|---|---|
| blf | .blf | python-can, data frames packed here | 1 ns early at most | yes |
| candump | .log | python-can | 1 us | yes |
| asc | .asc | python-can | 1 us | no: its head has the date |
| pcap | .pcap | here | exact | yes |

BLF and ASC number the segments as channels, candump names them, pcap has a file for each.
"""

import struct
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

import can

from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.native import native_records
from axisrig.bench.bus.journal import Entry
from axisrig.bench.files import named, naming
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import S, TimeNs

LOG_SUFFIXES = {"blf": ".blf", "candump": ".log", "asc": ".asc", "pcap": ".pcap"}
"""Kind of log -> suffix of its file."""

BLF_LEVEL: Final = 2
"""Level of zlib: a third of the time of its default, for files 1.05 to 1.1 times as large."""

SEGMENT_MARK = "@"
"""Is before the name of a segment in the name of a file; no name of a run has it."""

# Source: tcpdump.org, pcap file format and LINKTYPE_CAN_SOCKETCAN; Linux can.h and can/error.h
PCAP_MAGIC_NS, LINKTYPE_CAN_SOCKETCAN, SNAP_BYTES = 0xA1B23C4D, 227, 16
EXTENDED_FLAG, REMOTE_FLAG, ERROR_FLAG = 1 << 31, 1 << 30, 1 << 29
PROTOCOL_VIOLATION = 0x008
ERROR_DATA_BYTES = 8


class BusLog:
    """A log file of a journal, `journal.add(log.take)`, which is drained before `stop`.

    `segment.observe(log)` writes frame by frame instead.
    """

    def __call__(self, time_ns: TimeNs, segment: str, frame: Frame, is_error: bool) -> None:
        """Write one frame. Raises OSError with the name of the file."""
        raise NotImplementedError

    def take(self, block: list[Entry]) -> None:
        """Write frames. Raises OSError with the name of the file."""
        for entry in block:
            self(*entry)

    def stop(self) -> None:
        """Write what is left and close the file. Raises OSError with the name of the file."""
        raise NotImplementedError


def open_log(path: Path, segments: Sequence[str]) -> BusLog:
    """Open the log that the suffix of `path` asks for; segments: names in the order of channels.

    Raises UserError for another suffix.
    """
    suffix = path.suffix.lower()
    channels = {name: number for number, name in enumerate(segments)}
    if suffix == LOG_SUFFIXES["blf"]:
        return BlfLog(blf_writer(path), channels, path)
    if suffix == LOG_SUFFIXES["candump"]:
        return MessageLog(CandumpWriter(path), {name: name for name in segments}, path)
    if suffix == LOG_SUFFIXES["asc"]:
        return MessageLog(asc_writer(path), channels, path)
    if suffix == LOG_SUFFIXES["pcap"]:
        return PcapLog(path, segments)
    raise UserError("no kind of bus log", value=path.name, allowed=list(LOG_SUFFIXES.values()))


def log_kinds(text: str) -> list[str]:
    """Read `blf,pcap`. Raises UserError for an unknown kind."""
    kinds = [kind.strip() for kind in text.split(",") if kind.strip()]
    for kind in kinds:
        if kind not in LOG_SUFFIXES:
            raise UserError("no kind of bus log", value=kind, allowed=list(LOG_SUFFIXES))
    return kinds


def blf_writer(path: str | Path) -> can.BLFWriter:
    """Open a BLF log whose times count from the start of the run.

    A writer left to itself counts from the millisecond of its first frame and stores that origin
    as a calendar date, which simulated time does not have: reading back would shift every frame.
    Times are kept as whole ns, cut off from a float: a frame reads back at most 1 ns early.
    The caller taps it to a segment and calls `stop()` at the end.
    """
    writer = can.BLFWriter(path, compression_level=BLF_LEVEL)
    writer.start_timestamp = 0.0
    return writer


def asc_writer(path: str | Path) -> can.ASCWriter:
    """Open an ASC log whose times count from the start of the run, not from its first frame."""
    writer = can.ASCWriter(path)
    writer.log_event("Simulated time", 0.0)
    return writer


class CandumpWriter(can.CanutilsLogWriter):
    """The writer of python-can, which leaves the length out that a remote frame asks for."""

    def on_message_received(self, msg: can.Message) -> None:
        """Write one frame as candump -l does: `703#R1`."""
        if msg.is_error_frame or not msg.is_remote_frame or not msg.dlc:
            super().on_message_received(msg)
            return
        channel = f"can{msg.channel}" if str(msg.channel).isdigit() else msg.channel
        can_id = f"{msg.arbitration_id:0{8 if msg.is_extended_id else 3}X}"
        direction = "R" if msg.is_rx else "T"
        self.file.write(f"({msg.timestamp:f}) {channel} {can_id}#R{msg.dlc} {direction}\n")


class MessageLog(BusLog):
    """One file for all segments of a rig: a writer of python-can, fed cheaply.

    The writer reads a message and forgets it, so one `can.Message` is filled again for every frame;
    making a new one costs as much as writing it.
    """

    def __init__(
        self,
        writer: can.io.generic.FileIOMessageWriter[Any],
        channels: Mapping[str, int | str],
        path: Path,
    ) -> None:
        """channels: what the writer is to call each segment. path: of its file."""
        self._path = path
        self._writer = writer
        self._channels = channels
        self._message = can.Message()

    def __call__(self, time_ns: TimeNs, segment: str, frame: Frame, is_error: bool) -> None:
        """Write one frame."""
        message = self._message
        message.timestamp = time_ns / S
        message.channel = self._channels[segment]
        message.arbitration_id, message.data = frame.arbitration_id, frame.data  # type: ignore[assignment]
        message.is_extended_id, message.is_remote_frame = frame[2], frame[3]
        message.dlc, message.is_error_frame = frame.dlc, is_error
        try:
            self._writer.on_message_received(message)
        except OSError as error:
            raise named(error, self._path) from None

    def stop(self) -> None:
        """Write what is left and close the file."""
        try:
            self._writer.stop()
        except OSError as error:
            with suppress(OSError):  # else what could not be written is tried once more at the end
                self._writer.file.close()
            raise named(error, self._path) from None


class BlfLog(MessageLog):
    """A BLF file whose data and remote frames are packed a block at a time.

    The bytes are those of python-can's writer, which has the file and its containers, and writes
    error frames: the tests of every shipped run compare both.
    """

    # Source: can/io/blf.py. Object head (size 32, version 1, 48 bytes, type 1 = CAN message) with
    # flags 2 = times in ns; then time, channel, flags, dlc, identifier, data
    _HEAD: Final = struct.pack("<4sHHLLLHH", b"LOBJ", 32, 1, 48, 1, 2, 0, 0)
    _OBJECT: Final = struct.Struct("<24sQHBBL8s")
    _REMOTE: Final = 0x80

    def __init__(self, writer: can.BLFWriter, channels: Mapping[str, int], path: Path) -> None:
        """writer: from `blf_writer`. channels: segment -> number from 0. path: of its file."""
        super().__init__(writer, channels, path)
        self._blf = writer
        self._numbers = {name: number + 1 for name, number in channels.items()}

    def take(self, block: list[Entry]) -> None:
        """Write frames. Raises OSError with the name of the file."""
        if native_records is not None:
            self._take_native(block)
            return
        objects: list[bytes] = []
        head, pack, numbers = self._HEAD, self._OBJECT.pack, self._numbers
        for entry in block:
            time_ns, segment, frame, is_error = entry
            if is_error:
                self._put(objects)
                objects = []
                self(*entry)
                continue
            can_id, data, extended, remote, dlc = frame
            if extended:
                can_id |= EXTENDED_FLAG
            flags = self._REMOTE if remote else 0
            # Over seconds as a float and back, as python-can does
            blf_ns = int(time_ns / S * 1e9)
            objects.append(pack(head, blf_ns, numbers[segment], flags, dlc, can_id, data))
        self._put(objects)
        self._blf.stop_timestamp = block[-1][0] / S

    def _take_native(self, block: list[Entry]) -> None:
        first = 0
        while first < len(block):
            objects, after = native_records.blf_objects(block, first, self._numbers, self._HEAD)
            self._put([objects])
            if after < len(block):
                self(*block[after])
            first = after + 1
        self._blf.stop_timestamp = block[-1][0] / S

    def _put(self, objects: list[bytes]) -> None:
        """Give objects to the writer, which puts each 128 KB of them into a container."""
        writer = self._blf
        size = sum(map(len, objects))
        writer._buffer += objects
        writer._buffer_size += size
        writer.object_count += size // self._OBJECT.size
        with naming(self._path):
            for _ in range(writer._buffer_size // writer.max_container_size):
                writer._flush()


class PcapLog(BusLog):
    """SocketCAN frames in pcap files with times in ns, one file for each segment of a rig.

    With several segments the name of each goes into that of its file: `run@can1.pcap`. An error
    frame becomes SocketCAN's error message of a protocol violation. All numbers of the file are
    little-endian, identifiers big-endian, as the link type asks for.
    """

    _HEAD = struct.Struct("<IHHiIII")
    _RECORD = struct.Struct("<IIII")
    _FRAME = struct.Struct(">IB3x8s")

    def __init__(self, path: Path, segments: Sequence[str]) -> None:
        self._files = {}
        for name in segments:
            several = path.with_name(f"{path.stem}{SEGMENT_MARK}{name}.pcap")
            self._files[name] = (several if len(segments) > 1 else path).open("wb")
            head = (PCAP_MAGIC_NS, 2, 4, 0, 0, SNAP_BYTES, LINKTYPE_CAN_SOCKETCAN)
            self._files[name].write(self._HEAD.pack(*head))

    def __call__(self, time_ns: TimeNs, segment: str, frame: Frame, is_error: bool) -> None:
        """Write one frame."""
        seconds, rest_ns = divmod(time_ns, S)
        can_id, data, dlc = frame.arbitration_id, frame.data, frame.dlc
        if is_error:
            can_id, data, dlc = ERROR_FLAG | PROTOCOL_VIOLATION, b"", ERROR_DATA_BYTES
        elif frame.is_extended_id:
            can_id |= EXTENDED_FLAG
        if frame.is_remote_frame:
            can_id |= REMOTE_FLAG
        record = self._RECORD.pack(seconds, rest_ns, SNAP_BYTES, SNAP_BYTES)
        file = self._files[segment]
        try:
            file.write(record + self._FRAME.pack(can_id, dlc, data))
        except OSError as error:
            raise named(error, Path(file.name)) from None

    def stop(self) -> None:
        """Close the files."""
        for file in self._files.values():
            with naming(Path(file.name)):
                file.close()
