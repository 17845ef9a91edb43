"""A terminal with digital inputs that stamps edges in its slave controller, without an application.

As terminals like the EL1252 have it: the latch inputs of the distributed clock, whose registers the
process image takes as they are: level, and 64 bits of the system time of the edges. It has no
mailbox and no outputs. Source: docs/ethercat.md.
"""

from collections.abc import Callable
from typing import Final

from axisrig.bench.bus.ethercat.segment import Passage
from axisrig.bench.drive.axis.ports import SignalPort
from axisrig.bench.drive.ethercat.al_states import AlStateMachine
from axisrig.bench.drive.ethercat.controller import SlaveController
from axisrig.bench.drive.ethercat.description import Description
from axisrig.bench.drive.ethercat.distributed_clock import DistributedClock
from axisrig.bench.drive.ethercat.eeprom import Eeprom
from axisrig.bench.drive.ethercat.local_clock import LocalClock
from axisrig.bench.drive.ethercat.registers import Parts, Registers
from axisrig.bench.drive.ethercat.sii import sii_content
from axisrig.bench.drive.ethercat.sync_managers import SyncManagers
from axisrig.bench.drive.ethercat.sync_unit import LatchUnit, SyncUnit
from axisrig.bench.drive.ethercat.watchdog import Watchdog
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.time.clock import Clock, Phase, TimeNs

PRODUCT: Final = 401
"""Its product code: digital inputs (CiA 401); the vendor is 0."""
_USES_INPUTS: Final = 2


class StampingTerminal:
    """One terminal on the line; a `Slave`.

    inputs: signals at its two inputs, None for an open one. advance: steps the plants to an
    instant. start_ns, drift_ppm: of its clock.
    """

    def __init__(
        self,
        clock: Clock,
        inputs: tuple[SignalPort | None, SignalPort | None],
        advance: Callable[[TimeNs], None],
        serial: int,
        start_ns: TimeNs = 0,
        drift_ppm: float = 0.0,
    ) -> None:
        self._clock, self._advance = clock, advance
        self.is_on = True
        self.time = DistributedClock(LocalClock(start_ns, drift_ppm))
        self.latches = LatchUnit(self.time, inputs)
        self.description = Description(
            serial,
            (),
            (),
            (),
            product=PRODUCT,
            group="axisrig terminals",
            order="DI2STAMP",
            name="axisrig terminal with time stamps",
            fmmus=(_USES_INPUTS,),
            coe=(),
        )
        self.states = AlStateMachine(self, self._show_state)
        parts = Parts(
            clock,
            Eeprom(sii_content(self.description)),
            self.time,
            SyncUnit(clock, self.time, _nothing, _nothing),
            self.latches,
            Watchdog(clock, _nothing),
            SyncManagers(_no_manager, _no_manager, _no_manager, _nothing),
        )
        self.registers = Registers(parts, self)
        self._controller = SlaveController(self.registers)

    # As a slave on the line

    def process(self, frame: bytearray, passage: Passage) -> None:
        """Stamp the edges until now, then act on each datagram of a frame that has passed.

        The clock is as it was when they came: a time that the frame hands on moves it.
        """
        if self.is_on:
            self.before_latches()
            self._controller.process(frame, passage)

    def broken(self, *, is_here: bool) -> None:
        """Count a frame with a wrong FCS."""
        if self.is_on:
            self.registers.broken(is_here=is_here)

    def power_off(self) -> None:
        """Take the power away. To be called from an event."""
        self.is_on = False

    # What the slave controller wakes up

    def al_control(self, value: int) -> None:
        """Follow the master after the frame, in an event of its own."""
        self._clock.call_at(
            self._clock.now_ns, Phase.APPLICATION, lambda: self.states.control(value)
        )

    def activated(self) -> None:
        """Nothing: no application waits for SYNC0."""

    def before_latches(self) -> None:
        """Step the plant to now, so that its edges are there, and stamp them."""
        self._advance(self._clock.now_ns)
        self.latches.look()

    def _show_state(self, status: int, code: int) -> None:
        self.registers.show_state(status, code)

    # States

    def enter(self, state: AlState) -> str | None:
        """Go up one state: nothing stands against it."""
        return None

    def leave(self, before: AlState, after: AlState, code: str) -> None:
        """Go down: inputs go on."""


def _nothing() -> None:
    """Do nothing."""


def _no_manager(_number: int) -> None:
    """Do nothing: it has none in use."""
