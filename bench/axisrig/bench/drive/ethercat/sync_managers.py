"""SyncManagers: the buffers between master and slave, as mailbox or as three buffers.

Source: docs/ethercat.md. A mailbox is full from the write of its last byte to the read of its last
byte; a full one refuses a write and an empty one a read, without a working counter. Of three
buffers the reader always gets the latest whole one.
"""

from collections.abc import Callable
from typing import Final

from axisrig.kernel.profiles.ethercat.layouts import (
    SM_DIRECTION_MASK,
    SM_ENABLE,
    SM_FULL,
    SM_MAILBOX,
    SM_MASTER_WRITES,
    SM_MODE_MASK,
    SM_REPEAT,
    SM_WATCHDOG,
    SYNC_MANAGER,
)

COUNT: Final = 8
MAILBOX_OUT: Final = 0
MAILBOX_IN: Final = 1
OUTPUTS: Final = 2
INPUTS: Final = 3
_STATUS: Final = 5
_PDI: Final = 7


class SyncManager:
    """One of them. latest: what its reader gets. is_full: a mailbox that holds a message.

    is_enabled: whether it answers for its area, from `start` to before `end`. is_mailbox: otherwise
    it has three buffers. master_writes: otherwise he reads.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.start = self.length = self.control = self.activation = self.acknowledge = 0
        self.end = 0
        self.is_enabled = self.is_mailbox = self.master_writes = self.is_full = False
        self.latest = b""
        self._buffer = bytearray()

    def configure(self, registers: bytes) -> bool:
        """Take the registers that a master has written, 8 bytes; return whether it is another."""
        before = (self.start, self.length, self.control, self.activation & SM_ENABLE)
        self.start, self.length, self.control, _, self.activation, _ = SYNC_MANAGER.unpack(
            registers
        )
        if before == (self.start, self.length, self.control, self.activation & SM_ENABLE):
            return False
        self.end = self.start + self.length
        self.is_enabled = bool(self.activation & SM_ENABLE) and self.length > 0
        self.is_mailbox = self.control & SM_MODE_MASK == SM_MAILBOX
        self.master_writes = self.control & SM_DIRECTION_MASK == SM_MASTER_WRITES
        self.is_full = False
        self.latest = bytes(self.length)
        self._buffer = bytearray(self.length)
        return True

    @property
    def is_watched(self) -> bool:
        """Whether its writes feed the watchdog."""
        return bool(self.control & SM_WATCHDOG)

    @property
    def wants_repeat(self) -> bool:
        """Whether the master's request to repeat differs from what was acknowledged."""
        return bool((self.activation ^ self.acknowledge) & SM_REPEAT)

    def status(self) -> int:
        """Return its status register."""
        return SM_FULL if self.is_mailbox and self.is_full else 0

    def holds(self, address: int, length: int) -> bool:
        """Whether an access is within its area."""
        return self.start <= address and address + length <= self.end

    # The master's side

    def read(self, address: int, length: int) -> bytes | None:
        """Return what a master reads, None where it is refused."""
        if self.master_writes or (self.is_mailbox and not self.is_full):
            return None
        at = address - self.start
        return self.latest[at : at + length]

    def write(self, address: int, data: bytes) -> bool | None:
        """Take what a master writes; return whether a buffer is whole now, None when refused."""
        if not self.master_writes or (self.is_mailbox and self.is_full):
            return None
        at = address - self.start
        self._buffer[at : at + len(data)] = data
        if at + len(data) < self.length:
            return False
        self.latest = bytes(self._buffer)
        self.is_full = True
        return True

    # The slave's side

    def put(self, data: bytes) -> None:
        """Give the master a new buffer; data is filled up with zeros."""
        self.latest = data.ljust(self.length, b"\x00")
        self.is_full = True


class SyncManagers:
    """All of them, with the RAM outside.

    written(n): a buffer of n is whole. taken(n): the master has read the mailbox n. repeat(n): the
    master asks n for its last message once more. changed(): one of them is now another.
    """

    def __init__(
        self,
        written: Callable[[int], None],
        taken: Callable[[int], None],
        repeat: Callable[[int], None],
        changed: Callable[[], None],
    ) -> None:
        self._changed = changed
        self.all = [SyncManager(number) for number in range(COUNT)]
        self._written, self._taken, self._repeat = written, taken, repeat
        self._enabled: list[SyncManager] = []

    def __getitem__(self, number: int) -> SyncManager:
        return self.all[number]

    def configure(self, registers: bytes) -> None:
        """Take the registers of all, 8 bytes each."""
        is_other = False
        for manager in self.all:
            at = SYNC_MANAGER.size * manager.number
            is_other |= manager.configure(registers[at : at + SYNC_MANAGER.size])
        self._enabled = [manager for manager in self.all if manager.is_enabled]
        if is_other:
            self._changed()
        for manager in self._enabled:
            if manager.is_mailbox and manager.wants_repeat:
                self._repeat(manager.number)

    def show(self, memory: bytearray, first: int, begin: int, end: int) -> None:
        """Write what the slave says into the registers between two addresses.

        first: address of those of the first one.
        """
        size = SYNC_MANAGER.size
        for number in range(max(begin - first, 0) // size, min(-(-(end - first) // size), COUNT)):
            manager, at = self.all[number], first + size * number
            memory[at + _STATUS] = manager.status()
            memory[at + _PDI] = manager.acknowledge

    def read(self, address: int, length: int, ram: bytearray) -> bytes | None:
        """Return what a master reads from the RAM, None where a SyncManager refuses."""
        manager = self._of(address, length)
        if manager is None:
            return bytes(ram[address : address + length])
        if not manager.holds(address, length):
            return None
        data = manager.read(address, length)
        if data is not None and manager.is_mailbox and self._is_end(manager, address, length):
            manager.is_full = False
            self._taken(manager.number)
        return data

    def write(self, address: int, data: bytes, ram: bytearray) -> bool:
        """Take what a master writes to the RAM; return whether that is allowed."""
        manager = self._of(address, len(data))
        if manager is None:
            ram[address : address + len(data)] = data
            return True
        if not manager.holds(address, len(data)):
            return False
        is_whole = manager.write(address, data)
        if is_whole:
            self._written(manager.number)
        return is_whole is not None

    @staticmethod
    def _is_end(manager: SyncManager, address: int, length: int) -> bool:
        return address + length == manager.end

    def _of(self, address: int, length: int) -> SyncManager | None:
        for manager in self._enabled:
            if address < manager.end and manager.start < address + length:
                return manager
        return None
