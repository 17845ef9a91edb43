"""The stamping terminal of a line: what the control asks of it, and the image that the PLC has.

Level and stamps of its inputs are registers of the slave controller; the cyclic frame brings them,
and the PLC reads what the last one has brought. Stamps are system time, 64 bits: 0 is the begin of
the run.
"""

import struct
from typing import Final

from axisrig.bench.drive.axis.ports import SignalPort
from axisrig.bench.drive.ethercat.stamping import PRODUCT, StampingTerminal
from axisrig.bench.machine.plc.terminal import ChannelInput
from axisrig.bench.rig.ethercat.members import TERMINAL, TERMINAL_BYTES, terminal_position
from axisrig.bench.rig.reading.plc_task import TerminalTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.ethercat.settings import RegisterInputs
from axisrig.kernel.profiles.ethercat.tables import address_of
from axisrig.kernel.time.clock import Clock, TimeNs

_IMAGE: Final = struct.Struct("<BB4Q")
"""From LATCH0_STATUS on: status of both inputs, then of each its rising and its falling edge."""
_LEVEL: Final = 1 << 2
_SINGLE_EVENTS: Final = b"\3"
_CONTINUOUS: Final = b"\0"
_VENDOR_OF, _PRODUCT_OF = 1, 2  # sub-indices of 1018, as an EEPROM has them

assert _IMAGE.size == TERMINAL_BYTES


def register_inputs(settings: Settings, segment: str, table: TerminalTable) -> RegisterInputs:
    """Return what the control knows of the terminal of a line."""
    mode = _SINGLE_EVENTS if table.stamp_edge == "first" else _CONTINUOUS
    return RegisterInputs(
        axis=TERMINAL,
        node_id=terminal_position(settings, segment),
        first=address_of("LATCH0_STATUS"),
        size=TERMINAL_BYTES,
        writes=(("LATCH0_CONTROL", mode), ("LATCH1_CONTROL", mode)),
        identity={_VENDOR_OF: 0, _PRODUCT_OF: PRODUCT},
    )


class LineTerminal:
    """The PLC's end of the terminal (`AnyTerminal`), and the slave.

    wc_state: 0 while frames bring its inputs, 1 after more than `missing_cycles` without.
    """

    def __init__(
        self, slave: StampingTerminal, table: TerminalTable, clock: Clock, period_ns: TimeNs
    ) -> None:
        self.slave, self._clock = slave, clock
        self.image = {number: ChannelInput() for number in table.inputs}
        self._limit_ns = (table.missing_cycles + 1) * period_ns
        self._came_ns: TimeNs | None = None

    def taken(self, data: bytes) -> None:
        """Take the registers of a frame whose working counter was right."""
        self._came_ns = self._clock.now_ns
        first, second, *times = _IMAGE.unpack(data)
        self.image = {
            number: ChannelInput(
                bool((first, second)[number - 1] & _LEVEL), *times[2 * number - 2 : 2 * number]
            )
            for number in self.image
        }

    def exchange_until(self, now_ns: TimeNs) -> None:
        """Nothing: the frames of the line make the image."""

    @property
    def wc_state(self) -> int:
        """0 while the process data come."""
        came_ns = self._came_ns
        return int(came_ns is None or self._clock.now_ns - came_ns > self._limit_ns)


def inputs_of(
    table: TerminalTable, signals: dict[str, SignalPort]
) -> tuple[SignalPort | None, SignalPort | None]:
    """Return the signals at both inputs."""
    wired = table.inputs
    first, second = (signals[wired[n]] if n in wired else None for n in (1, 2))
    return first, second
