"""Reads pcap files with SocketCAN frames, those of this bench and of other tools.

Source: tcpdump.org, pcap file format and LINKTYPE_CAN_SOCKETCAN; Linux can.h.
"""

import gzip
import struct
from collections.abc import Iterator
from pathlib import Path

import can

from axisrig.bench.bus.can.logs import (
    ERROR_FLAG,
    EXTENDED_FLAG,
    LINKTYPE_CAN_SOCKETCAN,
    PCAP_MAGIC_NS,
    REMOTE_FLAG,
    SEGMENT_MARK,
)
from axisrig.kernel.errors import UserError

PCAP_MAGIC_US = 0xA1B2C3D4
_ID_BITS, _HEAD_BYTES, _RECORD_BYTES, _FRAME_BYTES = 0x1FFF_FFFF, 24, 16, 8


def read_pcap(path: Path) -> Iterator[can.Message]:
    """Yield the frames of a file; times in s, channel: the segment in its name (`run@can1.pcap`).

    A `.gz` is unpacked. Raises UserError when it is no pcap file with SocketCAN frames, or ends
    within a frame.
    """
    is_packed = path.suffix.lower() == ".gz"
    data = gzip.decompress(path.read_bytes()) if is_packed else path.read_bytes()
    for order in "<>":
        if len(data) >= _HEAD_BYTES:
            magic, *_, link = struct.unpack_from(f"{order}IHHiIII", data)
            if magic in (PCAP_MAGIC_NS, PCAP_MAGIC_US):
                break
    else:
        raise UserError("no pcap file", file=path)
    if link & 0xFFFF != LINKTYPE_CAN_SOCKETCAN:
        allowed = f"{LINKTYPE_CAN_SOCKETCAN} (SocketCAN)"
        raise UserError("pcap file of another link type", file=path, value=link, allowed=allowed)
    name = path.with_suffix("").stem if is_packed else path.stem
    channel = name.partition(SEGMENT_MARK)[2] or None
    ticks = 1e9 if magic == PCAP_MAGIC_NS else 1e6
    at = _HEAD_BYTES
    while at < len(data):
        body = at + _RECORD_BYTES
        if body <= len(data):
            seconds, rest, size, _ = struct.unpack_from(f"{order}IIII", data, at)
            at = body + size
        if body + _FRAME_BYTES > len(data) or at > len(data) or size < _FRAME_BYTES:
            raise UserError("the file ends within a frame", file=path)
        yield socketcan_message(data[body:at], seconds + rest / ticks, channel)


def socketcan_message(frame: bytes, time_s: float, channel: str | None) -> can.Message:
    """Return a frame of SocketCAN (struct can_frame, identifier big-endian) as a message.

    Raises UserError when it is shorter than its head.
    """
    if len(frame) < _FRAME_BYTES:
        raise UserError("a packet is shorter than a frame of SocketCAN", value=frame.hex(" "))
    can_id, length = struct.unpack_from(">IB", frame)
    is_remote = bool(can_id & REMOTE_FLAG)
    return can.Message(
        timestamp=time_s,
        channel=channel,
        arbitration_id=can_id & _ID_BITS,
        is_extended_id=bool(can_id & EXTENDED_FLAG),
        is_remote_frame=is_remote,
        is_error_frame=bool(can_id & ERROR_FLAG),
        dlc=length,
        data=None if is_remote else frame[_FRAME_BYTES : _FRAME_BYTES + length],
    )
