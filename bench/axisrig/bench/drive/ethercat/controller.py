"""The slave controller: datagrams in, registers and memory, working counters.

Source: docs/ethercat.md. What its registers do is `registers.py`, buffers `sync_managers.py`.
"""

from typing import Final

from axisrig.bench.bus.ethercat.frame import Datagram, datagrams, is_ethercat
from axisrig.bench.bus.ethercat.segment import Passage
from axisrig.bench.drive.ethercat.registers import Registers
from axisrig.kernel.profiles.ethercat.layouts import DATAGRAM, WORKING_COUNTER
from axisrig.kernel.profiles.ethercat.tables import Command, commands

_ADDRESS: Final = 2
"""Where the address is in the head of a datagram; the events are behind the length."""
_EVENTS: Final = DATAGRAM.size - 2
_READ, _WRITE = 1, 1
_POSITION, _STATION, _BROADCAST, _LOGICAL = range(4)
_KINDS: Final = ("position", "station", "broadcast", "logical")


def _table() -> dict[int, tuple[int, bool, bool]]:
    return {
        code: (_KINDS.index(row.addressing), row.reads, row.writes)
        for code, row in commands().items()
        if row.addressing in _KINDS
    }


class SlaveController:
    """One slave controller on the line. registers: what it holds, and what acts on it."""

    def __init__(self, registers: Registers) -> None:
        self.registers = registers
        self._commands = _table()
        self._distributes = (int(Command.ARMW), int(Command.FRMW))

    def process(self, frame: bytearray, passage: Passage) -> None:
        """Act on each datagram of a frame, and change the frame as a slave does."""
        if not is_ethercat(frame):
            return
        registers = self.registers
        registers.passes(passage.arrival_ns, passage.return_ns)
        for datagram in datagrams(frame):
            known = self._commands.get(datagram.command)
            if known is None:
                continue
            kind, reads, writes = known
            if kind == _LOGICAL:
                count = self._logical(frame, datagram, reads, writes)
            else:
                count = self._physical(frame, datagram, kind, reads, writes)
            if count:
                at = datagram.counter_start
                counter = WORKING_COUNTER.unpack_from(frame, at)[0] + count & 0xFFFF
                WORKING_COUNTER.pack_into(frame, at, counter)
            events = registers.events()
            if events:
                at = datagram.start + _EVENTS
                held = int.from_bytes(frame[at : at + 2], "little")
                frame[at : at + 2] = (held | events).to_bytes(2, "little")

    def _logical(self, frame: bytearray, datagram: Datagram, reads: bool, writes: bool) -> int:
        was_read, was_written = self.registers.mapping.exchange(
            frame,
            datagram.data_start,
            datagram.address,
            datagram.length,
            reads=reads,
            writes=writes,
        )
        return _READ * was_read + (2 if reads else _WRITE) * was_written

    def _physical(
        self, frame: bytearray, datagram: Datagram, kind: int, reads: bool, writes: bool
    ) -> int:
        position = datagram.address & 0xFFFF
        if kind == _STATION:
            is_mine = self.registers.answers_to(position)
        else:
            is_mine = kind == _BROADCAST or position == 0
            at = datagram.start + _ADDRESS
            frame[at : at + 2] = (position + 1 & 0xFFFF).to_bytes(2, "little")
        if datagram.command in self._distributes:
            reads, writes = is_mine, not is_mine
        elif not is_mine:
            return 0
        at, end = datagram.data_start, datagram.counter_start
        address, length = datagram.address >> 16, datagram.length
        sent = bytes(frame[at:end])
        held = self.registers.read(address, length) if reads else None
        was_written = writes and self.registers.write(address, sent)
        if held is not None:
            if kind == _BROADCAST:
                held = bytes(a | b for a, b in zip(sent, held, strict=True))
            frame[at:end] = held
        if reads and writes:
            return _READ * (held is not None) + 2 * was_written
        return _READ * (held is not None) + _WRITE * was_written
