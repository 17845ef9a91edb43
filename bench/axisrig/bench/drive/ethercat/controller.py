"""The slave controller: datagrams in, registers and memory, working counters.

Source: docs/ethercat.md. What its registers do is `registers.py`, buffers `sync_managers.py`.
"""

from dataclasses import dataclass
from typing import Final

from axisrig.bench.bus.ethercat.frame import is_ethercat
from axisrig.bench.bus.ethercat.segment import Passage
from axisrig.bench.drive.ethercat.registers import Registers
from axisrig.kernel.profiles.ethercat.layouts import (
    DATAGRAM,
    FIRST_DATAGRAM,
    LENGTH_MASK,
    MORE,
    WORKING_COUNTER,
)
from axisrig.kernel.profiles.ethercat.tables import Command, commands

_HEAD: Final[int] = DATAGRAM.size
_COUNTER: Final[int] = WORKING_COUNTER.size
_ADDRESS: Final = 2
"""Where the address is in the head of a datagram; the events are behind the length."""
_EVENTS: Final = _HEAD - 2
_READ: Final = 1
_WRITE: Final = 1
_STATION: Final = 1
_BROADCAST: Final = 2
_LOGICAL: Final = 3
"""Places in `_KINDS`."""
_KINDS: Final = ("position", "station", "broadcast", "logical")
_DISTRIBUTES: Final = (Command.ARMW, Command.FRMW)


@dataclass(frozen=True)
class _Known:
    """What a command asks for. distributes: the slave that is addressed reads, others write."""

    kind: int
    reads: bool
    writes: bool
    distributes: bool


def _table() -> dict[int, _Known]:
    return {
        code: _Known(_KINDS.index(row.addressing), row.reads, row.writes, code in _DISTRIBUTES)
        for code, row in commands().items()
        if row.addressing in _KINDS
    }


class SlaveController:
    """One slave controller on the line. registers: what it holds, and what acts on it."""

    def __init__(self, registers: Registers) -> None:
        self.registers = registers
        self._commands = _table()

    def process(self, frame: bytearray, passage: Passage) -> None:
        """Act on each datagram of a frame, and change the frame as a slave does."""
        if not is_ethercat(frame):
            return
        registers = self.registers
        registers.passes(passage.arrival_ns, passage.return_ns)
        at, size, goes_on = FIRST_DATAGRAM, len(frame), True
        while goes_on and at + _HEAD + _COUNTER <= size:
            command, _, position, offset, word, _ = DATAGRAM.unpack_from(frame, at)
            begin = at + _HEAD
            end = begin + (word & LENGTH_MASK)
            if end + _COUNTER > size:
                return  # it is cut off
            known = self._commands.get(command)
            if known is not None:
                count = self._act(frame, known, position, offset, begin, end)
                if count:
                    count += frame[end] | frame[end + 1] << 8
                    frame[end] = count & 0xFF
                    frame[end + 1] = count >> 8 & 0xFF
                events = registers.events()
                if events:
                    frame[at + _EVENTS] |= events & 0xFF
                    frame[at + _EVENTS + 1] |= events >> 8
            goes_on = word & MORE != 0
            at = end + _COUNTER

    def _act(
        self, frame: bytearray, known: _Known, position: int, offset: int, begin: int, end: int
    ) -> int:
        """Act on the data of a datagram; return what its working counter grows by."""
        reads, writes = known.reads, known.writes
        if known.kind == _LOGICAL:
            was_read, was_written = self.registers.mapping.exchange(
                frame, begin, position | offset << 16, end - begin, reads, writes
            )
            return _READ * was_read + (2 if reads else _WRITE) * was_written
        if known.kind == _STATION:
            is_mine = self.registers.answers_to(position)
        else:
            is_mine = known.kind == _BROADCAST or position == 0
            at = begin - _HEAD + _ADDRESS
            frame[at : at + 2] = (position + 1 & 0xFFFF).to_bytes(2, "little")
        if known.distributes:
            reads, writes = is_mine, not is_mine
        elif not is_mine:
            return 0
        sent = bytes(frame[begin:end])
        held = self.registers.read(offset, end - begin) if reads else None
        was_written = writes and self.registers.write(offset, sent)
        if held is not None:
            if known.kind == _BROADCAST and any(sent):
                held = bytes(a | b for a, b in zip(sent, held, strict=True))
            frame[begin:end] = held
        was_read = held is not None
        if reads and writes:
            return _READ * was_read + 2 * was_written
        return _READ * was_read + _WRITE * was_written
