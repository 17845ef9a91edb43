"""Frames of EtherCAT as a slave and an observer see them, and their time on the wire.

Sources: docs/ethercat.md. A frame is counted from its destination address on, without FCS.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from axisrig.kernel.profiles.ethercat.layouts import (
    BYTE_NS,
    DATAGRAM,
    ETHERNET_HEADER,
    ETHERTYPE,
    FIRST_DATAGRAM,
    FRAME_TYPE_DATAGRAMS,
    GAP_BYTES,
    LENGTH_MASK,
    MORE,
    WORKING_COUNTER,
    received_after_ns,
)
from axisrig.kernel.time.clock import TimeNs

_OVERHEAD: Final[int] = DATAGRAM.size + WORKING_COUNTER.size
_ETHERTYPE_PLACE: Final[int] = ETHERNET_HEADER.size - 2


@dataclass(frozen=True)
class Datagram:
    """Where one datagram of a frame is, and what it says.

    start: of its head within the frame. address: ADP in the low half, ADO in the high one.
    """

    start: int
    command: int
    index: int
    address: int
    length: int

    @property
    def data_start(self) -> int:
        """Where its data begins."""
        return self.start + DATAGRAM.size

    @property
    def counter_start(self) -> int:
        """Where its working counter is, behind the data."""
        return self.start + DATAGRAM.size + self.length


def time_on_wire_ns(frame_bytes: int) -> TimeNs:
    """Return how long a frame has the wire: preamble, at least 60 bytes, FCS and gap.

    6.72 us for the shortest frame at 100 Mbit/s.
    """
    return received_after_ns(frame_bytes) + GAP_BYTES * BYTE_NS


def is_ethercat(frame: bytes | bytearray) -> bool:
    """Whether slaves act on a frame: its ethertype, and a header that says datagrams."""
    if len(frame) < FIRST_DATAGRAM + _OVERHEAD:
        return False
    if frame[_ETHERTYPE_PLACE] != ETHERTYPE >> 8 or frame[_ETHERTYPE_PLACE + 1] != ETHERTYPE & 0xFF:
        return False
    return frame[_ETHERTYPE_PLACE + 3] >> 4 == FRAME_TYPE_DATAGRAMS


def datagrams(frame: bytes | bytearray) -> Iterator[Datagram]:
    """Return the datagrams of an EtherCAT frame; those that are whole, where one is cut off."""
    at, end = FIRST_DATAGRAM, len(frame)
    is_last = False
    while not is_last and at + _OVERHEAD <= end:
        command, index, position, offset, word, _ = DATAGRAM.unpack_from(frame, at)
        length = word & LENGTH_MASK
        if at + _OVERHEAD + length > end:
            return
        yield Datagram(at, command, index, position | offset << 16, length)
        is_last = not word & MORE
        at += _OVERHEAD + length


def working_counter(frame: bytes | bytearray, datagram: Datagram) -> int:
    """Return the working counter of a datagram."""
    counter: int = WORKING_COUNTER.unpack_from(frame, datagram.counter_start)[0]
    return counter
