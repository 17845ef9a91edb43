"""LSS slave: node number and bit rate over the bus, by the identity of the node.

Source: CiA 305, layer setting services. Every frame has 8 bytes; others are ignored.
"""

import struct
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

from axisrig.kernel.time.clock import MS, Clock, Phase

UNCONFIGURED: Final = 255
NODE_ID_MAX: Final = 127
BIT_RATES: Final = {0: 1_000_000, 1: 800_000, 2: 500_000, 3: 250_000, 4: 125_000, 6: 50_000,
                    7: 20_000, 8: 10_000}  # fmt: skip
"""Index in the standard table to bit/s; 5 is reserved, 9 (automatic) is not supported."""
REFUSED: Final = 1  # error code: out of range, not supported

_SWITCH_GLOBAL, _NODE_ID, _BIT_TIMING, _ACTIVATE, _STORE = 0x04, 0x11, 0x13, 0x15, 0x17
_SELECT, _SELECTED = range(0x40, 0x44), 0x44
_IDENTIFY, _IDENTIFY_UNCONFIGURED = range(0x46, 0x4C), 0x4C
_IDENTIFIED, _IS_UNCONFIGURED = 0x4F, 0x50
_FAST_SCAN, _CONFIRM = 0x51, 0x80
_INQUIRE_IDENTITY, _INQUIRE_NODE_ID = range(0x5A, 0x5E), 0x5E


@dataclass
class LssSettings:
    """What LSS sets. stored_*: what power on takes; bit rate None = that of the bus."""

    node_id: int
    stored_node_id: int
    bit_rate: int | None = None
    stored_bit_rate: int | None = None


class LssSlave:
    """Answers an LSS master.

    settings: pending node number and bit rate are written there. identity(): vendor, product,
    revision, serial number (1018). active_id(): the present node number. send(data): answers.
    switch(): a node without number takes the pending one. set_bit_rate(bit_s or None): silent,
    then the new rate; None = this bus cannot change its rate.
    """

    def __init__(
        self,
        settings: LssSettings,
        clock: Clock,
        identity: Callable[[], tuple[int, ...]],
        active_id: Callable[[], int],
        send: Callable[[bytes], None],
        switch: Callable[[], None],
        set_bit_rate: Callable[[int | None], None] | None,
    ) -> None:
        self._settings, self._clock, self._send = settings, clock, send
        self._identity, self._active_id = identity, active_id
        self._switch, self._set_bit_rate = switch, set_bit_rate
        self._run = 0  # counts the resets: an event of an older time does nothing
        self.reset()

    def reset(self) -> None:
        """Wait, as after power on; a bit rate that is being activated is not."""
        self._run += 1
        self._is_configuring = False
        self._selected = 0  # numbers of the identity that have matched so far
        self._seen: list[int] = []  # numbers of an identify request so far
        self._scan_position = 0

    def on_request(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        """Take a frame of the master."""
        if len(data) != 8:
            return
        command = data[0]
        number = int.from_bytes(data[1:5], "little")
        if command == _SWITCH_GLOBAL:
            self._switch_global(data[1])
        elif command in _SELECT:
            self._select(command - _SELECT.start, number)
        elif command in _IDENTIFY:
            self._identify(command - _IDENTIFY.start, number)
        elif command == _IDENTIFY_UNCONFIGURED:
            if self._is_unconfigured:
                self._answer(_IS_UNCONFIGURED)
        elif command == _FAST_SCAN:
            self._fast_scan(number, *data[5:8])
        elif self._is_configuring:
            self._configure(command, data)

    @property
    def _is_unconfigured(self) -> bool:
        return self._active_id() == UNCONFIGURED and self._settings.node_id == UNCONFIGURED

    def _answer(self, command: int, *data: int) -> None:
        self._send(bytes((command, *data)).ljust(8, b"\x00"))

    # Who is meant

    def _switch_global(self, mode: int) -> None:
        if mode == 1:
            self._is_configuring = True
        elif mode == 0 and self._is_configuring:
            self._is_configuring = False
            if self._active_id() == UNCONFIGURED != self._settings.node_id:
                self._switch()

    def _select(self, position: int, number: int) -> None:
        if position == 0:
            self._selected = 0
        if position == self._selected and number == self._identity()[position]:
            self._selected += 1
            if self._selected == len(_SELECT):
                self._is_configuring = True
                self._answer(_SELECTED)
        else:
            self._selected = 0

    def _identify(self, position: int, number: int) -> None:
        """Vendor, product, least and greatest revision, least and greatest serial number."""
        if position == 0:
            self._seen = []
        if position != len(self._seen):
            self._seen = []
            return
        self._seen.append(number)
        if len(self._seen) == len(_IDENTIFY):
            vendor, product, *limits = self._seen
            identity = self._identity()
            if (vendor, product) == identity[:2] and all(
                low <= own <= high
                for own, low, high in zip(identity[2:], limits[::2], limits[1::2], strict=True)
            ):
                self._answer(_IDENTIFIED)

    def _fast_scan(self, number: int, bit: int, position: int, following: int) -> None:
        """Say whether the upper bits of one number of the identity, down to `bit`, are these."""
        if not self._is_unconfigured or self._is_configuring:
            return
        if bit == _CONFIRM:
            self._scan_position = 0
            self._answer(_IDENTIFIED)
        elif bit < 32 and position < 4 and following < 4 and position == self._scan_position:
            if (number ^ self._identity()[position]) >> bit:
                return
            if bit == 0:
                self._scan_position = following
                self._is_configuring = following < position
            self._answer(_IDENTIFIED)

    # What is set

    def _configure(self, command: int, data: bytearray) -> None:
        settings = self._settings
        if command == _NODE_ID:
            node_id = data[1]
            if 1 <= node_id <= NODE_ID_MAX or node_id == UNCONFIGURED:
                settings.node_id = node_id
                self._answer(command)
            else:
                self._answer(command, REFUSED)
        elif command == _BIT_TIMING:
            self._configure_bit_timing(data[1], data[2])
        elif command == _ACTIVATE:
            self._activate(int.from_bytes(data[1:3], "little"))
        elif command == _STORE:
            settings.stored_node_id = settings.node_id
            settings.stored_bit_rate = settings.bit_rate
            self._answer(command)
        elif command in _INQUIRE_IDENTITY:
            own = self._identity()[command - _INQUIRE_IDENTITY.start]
            self._answer(command, *struct.pack("<I", own))
        elif command == _INQUIRE_NODE_ID:
            self._answer(command, self._active_id())

    def _configure_bit_timing(self, table: int, entry: int) -> None:
        if self._set_bit_rate is None or table != 0 or entry not in BIT_RATES:
            self._answer(_BIT_TIMING, REFUSED)
            return
        self._settings.bit_rate = BIT_RATES[entry]
        self._answer(_BIT_TIMING)

    def _activate(self, delay_ms: int) -> None:
        """Silence, the new bit rate after the delay, and once more the delay."""
        if self._set_bit_rate is None or self._settings.bit_rate is None:
            return
        self._set_bit_rate(None)
        self._clock.call_at(
            self._clock.now_ns + 2 * delay_ms * MS,
            Phase.APPLICATION,
            partial(self._speak_again, self._run),
        )

    def _speak_again(self, run: int) -> None:
        if run == self._run and self._set_bit_rate is not None:
            self._set_bit_rate(self._settings.bit_rate)
