"""Frames as a master makes them and reads them back.

A frame is counted from its destination address on, without FCS. Source:
`axisrig.kernel.profiles.ethercat.layouts`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from axisrig.kernel.profiles.ethercat.layouts import (
    DATAGRAM,
    ETHERNET_HEADER,
    ETHERTYPE,
    FIRST_DATAGRAM,
    FRAME_HEADER,
    FRAME_MIN,
    FRAME_TYPE_DATAGRAMS,
    LENGTH_MASK,
    MORE,
    WORKING_COUNTER,
    received_after_ns,
)
from axisrig.kernel.profiles.ethercat.tables import Command
from axisrig.kernel.time.clock import TimeNs

BROADCAST: Final = b"\xff" * 6
MASTER: Final = bytes.fromhex("000000000001")
"""Source address; the first slave sets bit 1 of its first byte."""
NOT_KNOWN: Final[TimeNs] = -1
OVERHEAD: Final = DATAGRAM.size + WORKING_COUNTER.size
INDEX_PLACE: Final = FIRST_DATAGRAM + 1
"""Where the index of the first datagram is: by it a frame that is back is known again."""


@dataclass(frozen=True)
class Datagram:
    """One datagram to be sent. address: ADP in the low half, ADO in the high one, or logical."""

    command: Command
    address: int
    data: bytes


@dataclass(frozen=True)
class Answer:
    """What came back of one datagram."""

    data: bytes
    counter: int


def at_position(position: int, register: int) -> int:
    """Return the address of a register of the slave at a position, from 0 on."""
    return -position & 0xFFFF | register << 16


def at_station(station: int, register: int) -> int:
    """Return the address of a register of the slave with a station address."""
    return station | register << 16


def frame_of(datagrams: Sequence[Datagram], index: int) -> bytearray:
    """Make a frame; index: of all its datagrams."""
    frame = bytearray(ETHERNET_HEADER.pack(BROADCAST, MASTER, ETHERTYPE))
    length = sum(OVERHEAD + len(each.data) for each in datagrams)
    frame += FRAME_HEADER.pack(length | FRAME_TYPE_DATAGRAMS << 12)
    for number, each in enumerate(datagrams):
        low, high = each.address & 0xFFFF, each.address >> 16
        word = len(each.data) | (0 if number + 1 == len(datagrams) else MORE)
        frame += DATAGRAM.pack(each.command, index, low, high, word, 0)
        frame += each.data + WORKING_COUNTER.pack(0)
    return frame.ljust(FRAME_MIN, b"\0")


def answers_of(frame: bytes) -> list[Answer]:
    """Return what came back of each datagram of a frame; those that are whole."""
    found, at, goes_on = list[Answer](), FIRST_DATAGRAM, True
    while goes_on and at + OVERHEAD <= len(frame):
        word = DATAGRAM.unpack_from(frame, at)[4]
        begin, length = at + DATAGRAM.size, word & LENGTH_MASK
        goes_on, at = bool(word & MORE), at + OVERHEAD + length
        if at > len(frame):
            break
        counter = WORKING_COUNTER.unpack_from(frame, begin + length)[0]
        found.append(Answer(frame[begin : begin + length], counter))
    return found


class Way:
    """How long frames are on their way there and back, without the time that their bytes take.

    A frame that takes longer than another one has waited, and brings its time later.
    """

    def __init__(self) -> None:
        self._shortest_ns = NOT_KNOWN

    def later_ns(self, sent_ns: TimeNs, back_ns: TimeNs, frame_bytes: int) -> TimeNs:
        """Return how much longer this frame took than the shortest so far."""
        way_ns = back_ns - sent_ns - received_after_ns(frame_bytes)
        if self._shortest_ns == NOT_KNOWN or way_ns < self._shortest_ns:
            self._shortest_ns = way_ns
        return way_ns - self._shortest_ns
