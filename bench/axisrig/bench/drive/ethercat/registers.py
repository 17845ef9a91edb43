"""Registers and memory of a slave controller: what a read gives, what a write does.

Source: docs/ethercat.md; `registers.csv` of the profile has their places and who may write.
"""

import struct
from dataclasses import dataclass
from typing import Final, Protocol

from axisrig.bench.drive.ethercat import register_areas as areas
from axisrig.bench.drive.ethercat import watchdog
from axisrig.bench.drive.ethercat.distributed_clock import DistributedClock
from axisrig.bench.drive.ethercat.eeprom import Eeprom
from axisrig.bench.drive.ethercat.fmmu import COUNT as FMMUS
from axisrig.bench.drive.ethercat.fmmu import Mapping, Physical, read_fmmus
from axisrig.bench.drive.ethercat.sync_managers import COUNT as SYNC_MANAGERS
from axisrig.bench.drive.ethercat.sync_managers import SyncManagers
from axisrig.bench.drive.ethercat.sync_unit import LatchUnit, SyncUnit
from axisrig.bench.drive.ethercat.watchdog import Watchdog
from axisrig.kernel.profiles.ethercat import layouts, tables
from axisrig.kernel.time.clock import Clock, TimeNs

RAM_START: Final = 0x1000
RAM_END: Final = 0x3000
_FEATURES: Final = 0x010C  # clock of 64 bits, enhanced
_PORTS: Final = 0x0F  # two with MII
_PDI_CONTROL: Final = 0x80  # on the chip
_LAST_OF_LINE, _INSIDE_LINE = 0x5611, 0x5A31
"""DL status: link at port 0, and at port 1 where a slave follows."""
_AL_EVENT: Final = 1 << 3
_LATCH_EVENT: Final = 1 << 0
_MASK_32: Final = 0xFFFF_FFFF
_COUNT_MAX: Final = 0xFF
_LENGTH_BITS: Final = 12
_ERRORS: Final = (
    (areas.FRAME_ERRORS, ("RX_ERRORS", "FORWARDED_ERRORS")),
    (areas.MALFORMED_FRAMES, ("MALFORMED_FRAMES",)),
    (areas.PDI_ERRORS, ("PDI_ERRORS",)),
    (areas.LOST_LINKS, ("LOST_LINKS",)),
)
"""What a write clears, whatever it writes."""


class Device(Protocol):
    """What a slave controller wakes up."""

    def al_control(self, value: int) -> None:
        """Take what the master asks of the state machine."""
        ...

    def activated(self) -> None:
        """Take note that the activation of the SYNC signals has changed."""
        ...

    def before_latches(self) -> None:
        """Take the edges that have come until now."""
        ...


@dataclass(frozen=True)
class Parts:
    """What stands behind the registers."""

    clock: Clock
    eeprom: Eeprom
    time: DistributedClock
    sync: SyncUnit
    latches: LatchUnit
    watchdog: Watchdog
    managers: SyncManagers


class Registers(Physical):
    """The memory of one slave controller as a master sees it, from 0000 to 2FFF.

    Reads and writes are those of a frame that passes at `passes`.
    """

    def __init__(self, parts: Parts, device: Device) -> None:
        self._parts, self._device = parts, device
        self._memory = bytearray(RAM_END)
        self._at = areas.addresses()
        self._system_time = self._at["SYSTEM_TIME"]
        self._event_mask, self._station = self._at["ECAT_EVENT_MASK"], self._at["STATION_ADDRESS"]
        self._reads, self._writes = areas.READS, areas.WRITES
        self._may_write = bytearray(RAM_START)
        for row in tables.registers().values():
            if row.master == "rw":
                self._may_write[row.address : row.address + row.size] = b"\x01" * row.size
        self.mapping = Mapping(self)
        self._arrival_ns: TimeNs = 0
        self._return_ns: TimeNs | None = None
        self._event_request = 0
        self.reset()

    def reset(self) -> None:
        """Be as after power on."""
        memory = self._memory
        memory[:] = bytes(len(memory))
        self.put("TYPE", 0x11)
        self.put("FMMUS", FMMUS)
        self.put("SYNC_MANAGERS", SYNC_MANAGERS)
        self.put("RAM_SIZE", (RAM_END - RAM_START) // 1024)
        self.put("PORTS", _PORTS)
        self.put("FEATURES", _FEATURES)
        self.put("PDI_CONTROL", _PDI_CONTROL)
        self.put("DL_STATUS", _LAST_OF_LINE)
        self.put("DL_CONTROL", 0x0007_0001)
        self.put("AL_STATUS", tables.AlState.INIT)
        self.put("WATCHDOG_DIVIDER", watchdog.DIVIDER)
        self.put("WATCHDOG_PDI", watchdog.TIME)
        self.put("WATCHDOG_PROCESS_DATA", watchdog.TIME)
        self.put("SPEED_COUNTER_START", 0x1000)
        self.put("TIME_FILTER_DEPTH", 4)
        self.put("SPEED_FILTER_DEPTH", 12)
        self.put("SYNC_PULSE", 100)
        self._event_request = 0
        self.mapping.fmmus = []
        self._parts.managers.configure(bytes(8 * SYNC_MANAGERS))
        self._parts.time.reset()
        self._parts.sync.activate(0)
        self._parts.watchdog.reset()
        self._parts.eeprom.load()
        self.put("STATION_ALIAS", self._parts.eeprom.alias)

    # The slave's own processor

    def put(self, name: str, value: int) -> None:
        """Let a register show a value."""
        row = tables.registers()[name]
        self._memory[row.address : row.address + row.size] = value.to_bytes(row.size, "little")

    def get(self, name: str) -> int:
        """Return the value of a register as it was put or written last."""
        row = tables.registers()[name]
        return int.from_bytes(self._memory[row.address : row.address + row.size], "little")

    def broken(self, *, is_here: bool) -> None:
        """Let the counter of port 0 of frames with a wrong FCS go on, to its end.

        is_here: it broke on the wire before the slave.
        """
        at = self._at["RX_ERRORS" if is_here else "FORWARDED_ERRORS"]
        self._memory[at] = min(self._memory[at] + 1, _COUNT_MAX)

    def show_state(self, status: int, code: int) -> None:
        """Let AL status and its code show this."""
        if (status, code) != (self.get("AL_STATUS"), self.get("AL_STATUS_CODE")):
            self.put("AL_STATUS", status)
            self.put("AL_STATUS_CODE", code)
            self._event_request |= _AL_EVENT

    # The frame that passes

    def passes(self, arrival_ns: TimeNs, return_ns: TimeNs | None) -> None:
        """Take note when the frame came, and whether a slave follows."""
        self._arrival_ns = arrival_ns
        if (return_ns is None) != (self._return_ns is None):
            self.put("DL_STATUS", _LAST_OF_LINE if return_ns is None else _INSIDE_LINE)
        self._return_ns = return_ns

    def answers_to(self, address: int) -> bool:
        """Whether a station address is that of this slave."""
        at, memory = self._station, self._memory
        if address == memory[at] | memory[at + 1] << 8:
            return True
        alias = self.get("STATION_ALIAS")
        return bool(self.get("DL_CONTROL") >> 24 & 1 and alias and address == alias)

    def events(self) -> int:
        """Return the events that the master wants to see in each datagram."""
        mask = self._memory[self._event_mask]
        if not mask:
            return 0
        latch = _LATCH_EVENT if self._parts.latches.has_event else 0
        return (self._event_request | latch) & mask

    def read(self, address: int, length: int) -> bytes | None:
        """Return what a master reads, None where it is refused."""
        end = address + length
        if address >= RAM_START:
            if end > RAM_END:
                return None
            return self._parts.managers.read(address, length, self._memory)
        if end > RAM_START:
            return None  # half of it is no register
        key = address << _LENGTH_BITS | length
        concerned = self._reads.get(key)
        if concerned is None:
            concerned = self._reads[key] = areas.read_parts(address, end)
        if concerned:
            self._before_read(concerned, address, end)
        data = bytes(self._memory[address:end])
        if concerned & areas.CLEARED:
            self._after_read(concerned, address, end)
        return data

    def write(self, address: int, data: bytes) -> bool:
        """Take what a master writes; return whether that is allowed."""
        length = len(data)
        end = address + length
        if address >= RAM_START:
            return end <= RAM_END and self._parts.managers.write(address, data, self._memory)
        if end > RAM_START:
            return False
        key = address << _LENGTH_BITS | length
        concerned = self._writes.get(key)
        if concerned is None:
            concerned = self._writes[key] = areas.written_parts(address, end)
        if concerned & areas.WRITABLE:
            self._memory[address:end] = data
        else:
            before, allowed = self._memory[address:end], self._may_write[address:end]
            self._memory[address:end] = bytes(
                new if may else old for new, old, may in zip(data, before, allowed, strict=True)
            )
        if concerned & areas.CLOCK:
            self._written_clock(concerned)
        else:
            self._written(concerned)
        return True

    # What reads give

    def _before_read(self, concerned: int, begin: int, end: int) -> None:
        parts = self._parts
        if concerned & areas.TIME:
            system_ns = parts.time.system_ns(self._arrival_ns)
            at = self._system_time
            self._memory[at : at + 8] = system_ns.to_bytes(8, "little")
        if concerned & areas.DIFFERENCE:
            self.put("SYSTEM_TIME_DIFFERENCE", parts.time.difference)
        if concerned & areas.MANAGERS:
            parts.managers.show(self._memory, self._at["SYNC_MANAGER"], begin, end)
        if concerned & areas.EEPROM:
            self.put("EEPROM_CONTROL", parts.eeprom.status)
        if concerned & areas.WATCHDOG:
            self.put("WATCHDOG_STATUS", int(parts.watchdog.is_healthy))
            self.put("WATCHDOG_COUNT", parts.watchdog.count)
        if concerned & areas.SYNC:
            self.put("ACTIVATION_STATUS", parts.sync.status)
            if parts.sync.has_sync0:
                self.put("START_TIME", parts.sync.next0)
        if concerned & areas.LATCHES:
            self._device.before_latches()
            self.put("LATCH0_STATUS", parts.latches.status(0))
            self.put("LATCH1_STATUS", parts.latches.status(1))
            first = self._at["LATCH0_POSITIVE"]
            self._memory[first : first + 32] = parts.latches.times()

    def _after_read(self, concerned: int, begin: int, end: int) -> None:
        if concerned & areas.AL_STATUS:
            self._event_request &= ~_AL_EVENT
        if concerned & areas.LATCH_TIMES:
            first = self._at["LATCH0_POSITIVE"]
            for place in range(4):
                if begin <= first + 8 * place < end:
                    self._parts.latches.taken(place)

    # What writes do

    def _written(self, concerned: int) -> None:
        parts = self._parts
        if concerned & areas.AL_CONTROL:
            self._device.al_control(self.get("AL_CONTROL"))
        if concerned & areas.WATCHDOG_SETTINGS:
            parts.watchdog.divider = self.get("WATCHDOG_DIVIDER")
            parts.watchdog.time = self.get("WATCHDOG_PROCESS_DATA")
        if concerned & areas.WATCHDOG_COUNTS:
            parts.watchdog.count = 0
        if concerned & areas.ERRORS:
            for part, names in _ERRORS:
                if concerned & part:
                    for name in names:
                        self.put(name, 0)
        if concerned & areas.EEPROM:
            self._eeprom_command()
        if concerned & areas.FMMUS:
            first = self._at["FMMU"]
            size = layouts.FMMU.size * FMMUS
            self.mapping.fmmus = read_fmmus(bytes(self._memory[first : first + size]))
        if concerned & areas.MANAGERS:
            first = self._at["SYNC_MANAGER"]
            parts.managers.configure(bytes(self._memory[first : first + 8 * SYNC_MANAGERS]))

    def _eeprom_command(self) -> None:
        if self.get("EEPROM_CONFIGURATION") & 1:
            return  # the slave has it
        data = self._parts.eeprom.command(
            self.get("EEPROM_CONTROL"),
            self.get("EEPROM_ADDRESS"),
            self.get("EEPROM_DATA").to_bytes(8, "little"),
        )
        self.put("EEPROM_DATA", int.from_bytes(data, "little"))
        self.put("STATION_ALIAS", self._parts.eeprom.alias)

    def _written_clock(self, concerned: int) -> None:
        parts = self._parts
        now_ns = parts.clock.now_ns
        if concerned & areas.RECEIVE_TIMES:
            self._latch_receive_times()
        if concerned & (areas.FOLLOW_32 | areas.FOLLOW_64):
            bits = 64 if concerned & areas.FOLLOW_64 else 32
            at = self._system_time
            received = int.from_bytes(self._memory[at : at + bits // 8], "little")
            parts.time.follow(received, bits, self._arrival_ns)
        if concerned & areas.OFFSET:
            parts.time.delay = self.get("SYSTEM_TIME_DELAY")
            parts.time.set_offset(self.get("SYSTEM_TIME_OFFSET"), now_ns)
        if concerned & areas.FILTERS:
            parts.time.forget(now_ns)
        if concerned & areas.SYNC_SETTINGS:
            sync = parts.sync
            if not sync.has_sync0 or self.get("ACTIVATION") != sync.activation:
                sync.start = self.get("START_TIME")
            sync.cycle0, sync.cycle1 = self.get("SYNC0_CYCLE"), self.get("SYNC1_CYCLE")
            parts.latches.control = [self.get("LATCH0_CONTROL"), self.get("LATCH1_CONTROL")]
            if concerned & areas.ACTIVATION:
                sync.activate(self.get("ACTIVATION"))
                self._device.activated()
        parts.sync.moved()

    def _latch_receive_times(self) -> None:
        """Latch when this frame came to each port, and to the processing unit."""
        local = self._parts.time.local
        arrival = local.at(self._arrival_ns)
        back = 0 if self._return_ns is None else local.at(self._return_ns)
        first = self._at["RECEIVE_TIMES"]
        times = struct.pack("<4I", arrival & _MASK_32, back & _MASK_32, 0, 0)
        self._memory[first : first + 16] = times
        self.put("RECEIVE_TIME", arrival & (1 << 64) - 1)
