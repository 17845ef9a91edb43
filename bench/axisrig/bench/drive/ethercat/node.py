"""A drive of CiA 402 on EtherCAT: slave controller, states, mailbox, process data and the servo.

Source: docs/ethercat.md. What the drive does with its object values is `servo.py` of CiA 402, as
on any carrier; here is when its cycle comes, and what the states of EtherCAT mean for it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Final

from axisrig.bench.bus.ethercat.segment import Passage
from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.bench.drive.axis.timer import Timer
from axisrig.bench.drive.cia402.dictionary.objects import ObjectRow
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.storage import ParameterStorage
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore
from axisrig.bench.drive.cia402.node import Cia402Node
from axisrig.bench.drive.cia402.profile_objects import PROFILE_OBJECTS, ProfileObjects
from axisrig.bench.drive.ethercat.al_states import WAITS, AlStateMachine
from axisrig.bench.drive.ethercat.coe_server import CoeServer
from axisrig.bench.drive.ethercat.controller import SlaveController
from axisrig.bench.drive.ethercat.cycle import CycleClock
from axisrig.bench.drive.ethercat.description import MAILBOX_BYTES, Description, describe
from axisrig.bench.drive.ethercat.distributed_clock import DistributedClock
from axisrig.bench.drive.ethercat.eeprom import Eeprom
from axisrig.bench.drive.ethercat.fitting import Fitting
from axisrig.bench.drive.ethercat.local_clock import LocalClock
from axisrig.bench.drive.ethercat.mailbox import Mailbox, MailboxService
from axisrig.bench.drive.ethercat.objects import described, ethercat_table
from axisrig.bench.drive.ethercat.process_data import Exchanged, ProcessData
from axisrig.bench.drive.ethercat.registers import Parts, Registers
from axisrig.bench.drive.ethercat.sii import sii_content
from axisrig.bench.drive.ethercat.sync_managers import (
    INPUTS,
    MAILBOX_IN,
    MAILBOX_OUT,
    OUTPUTS,
    SyncManagers,
)
from axisrig.bench.drive.ethercat.sync_unit import LatchUnit, SyncUnit
from axisrig.bench.drive.ethercat.watchdog import Watchdog
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.time.clock import Clock, Phase, S, TimeNs

_SAFEOP: Final = AlState.SAFEOP
_OP: Final = AlState.OP
MOVING: Final = (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE)
OUTPUTS_LOST: Final = 0x8130
SYNC_LOST: Final = 0x8700
"""Emergency codes of the fault that the drive makes of it (docs/ambiguities.md)."""
NO_SYNC_NS: Final[TimeNs] = S
"""So long may the first SYNC0 be away when OP is asked for; outputs may be for ever."""
_SYNC_CODES: Final = ("SYNC_ERROR", "FATAL_SYNC")
_EVERYTHING: Final = (0x1000, 0xFFFF)


@dataclass(frozen=True)
class SlaveSettings:
    """What differs from slave to slave.

    serial: of the identity. mailbox_bytes: of each mailbox. start_ns, drift_ppm: of its clock.
    sample_ns: when it samples its inputs, after what gives the clock of its cycle; below 0 = before
    the next one, 0 = in the cycle itself.
    """

    serial: int = 0
    mailbox_bytes: int = MAILBOX_BYTES
    start_ns: TimeNs = 0
    drift_ppm: float = 0.0
    sample_ns: TimeNs = 0


class EthercatDrive(Cia402Node):
    """One drive on the line: it moves an axis and has up to two probe signals.

    probes: the signals wired to probe input 1 and 2, None for an open input; they are the latch
    inputs of its slave controller too. switches, entered, seed: as those of `Servo`. It boots at
    the present instant, that is with the first event the clock runs.
    """

    def __init__(  # noqa: PLR0913
        self,
        name: str,
        clock: Clock,
        axis: AxisPort,
        probes: tuple[SignalPort | None, SignalPort | None] = (None, None),
        profile: DriveProfile | None = None,
        settings: SlaveSettings | None = None,
        seed: int = 0,
        *,
        switches: Mapping[str, SignalPort] | None = None,
        entered: Callable[[State], None] | None = None,
    ) -> None:
        self.settings = settings or SlaveSettings()
        self.time = DistributedClock(LocalClock(self.settings.start_ns, self.settings.drift_ppm))
        super().__init__(
            name,
            clock,
            axis,
            probes,
            profile or DriveProfile(),
            seed,
            switches=switches,
            entered=entered,
            device_time=self.time.system_ns,
        )
        self._probes = probes
        self._outputs = 0  # how often they came since SAFEOP
        self._samples = 0
        self._no_sync = Timer(clock, self._sync_stays_away)
        self.description: Description = self._describe()
        self._build_controller()
        self._build_objects()
        clock.call_at(clock.now_ns, Phase.APPLICATION, self._switched_on)

    def _describe(self) -> Description:
        return describe(self.profile, self.settings.serial, self.settings.mailbox_bytes)

    def _build_controller(self) -> None:
        clock = self._clock
        self.managers = SyncManagers(
            self._written, self._taken, self._repeat, self._managers_changed
        )
        self.sync = SyncUnit(clock, self.time, self._sync0, _nothing)
        self.watchdog = Watchdog(clock, self._outputs_stay_away)
        self.latches = LatchUnit(self.time, self._probes)
        self.eeprom = Eeprom(sii_content(self.description))
        self.states = AlStateMachine(self, self._show_state)
        parts = Parts(
            clock,
            self.eeprom,
            self.time,
            self.sync,
            self.latches,
            self.watchdog,
            self.managers,
        )
        self.registers = Registers(parts, self)
        self.controller = SlaveController(self.registers)

    def _build_objects(self) -> None:
        clock, servo, profile = self._clock, self.servo, self.profile
        self.objects = ObjectStore(ethercat_table(profile), servo.image, self._note_change)
        self.storage = ParameterStorage(self.objects)
        self.process_data: Exchanged = self._make_process_data()
        self.cycle_clock = CycleClock(
            clock,
            self.objects,
            self.sync,
            servo.interpolation.period_ns,
            profile.tick_ns,
            self._cycle,
            self._may_change,
        )
        self.objects.own(ProfileObjects(servo, profile, clock, self._changed), PROFILE_OBJECTS)
        self._fitting = Fitting(self.description, self.managers, self.process_data)
        for part in (self.storage, self.process_data, self.cycle_clock):
            self.objects.own(part, part.objects)
        self.service: MailboxService = self._make_service()
        self.mailbox = Mailbox(self.managers, clock, self.service, profile.sdo_answer_ns)

    def _make_process_data(self) -> Exchanged:
        return ProcessData(self.objects, self._may_change, is_fixed=self.profile.fixed_pdos)

    def _make_service(self) -> MailboxService:
        profile = self.profile
        return CoeServer(self.objects, described(profile), profile, self._mailbox_size)

    def _mailbox_size(self) -> int:
        return self.managers[MAILBOX_IN].length

    # As a slave on the line

    def process(self, frame: bytearray, passage: Passage) -> None:
        """Act on each datagram of a frame that has passed, and change the frame."""
        if self.is_on:
            self.controller.process(frame, passage)

    def broken(self, *, is_here: bool) -> None:
        """Count a frame with a wrong FCS."""
        if self.is_on:
            self.registers.broken(is_here=is_here)

    def jump(self, by_ns: TimeNs) -> None:
        """Let its clock show something else from now on."""
        self.time.jump(by_ns)
        self.sync.moved()

    # Power

    def _boot(self) -> None:
        self._stop()
        self.states.reset()
        self.registers.reset()
        self.servo.reset(self._clock.now_ns)
        self.storage.apply(self.settings.serial, *_EVERYTHING)
        self.servo.update()

    def _stop(self) -> None:
        self.cycle_clock.stop()
        self.watchdog.stop()
        self.mailbox.close()
        self.service.reset()

    # What the slave controller wakes up

    def al_control(self, value: int) -> None:
        """Follow the master after the frame, in an event of its own."""
        self._clock.call_at(
            self._clock.now_ns, Phase.APPLICATION, lambda: self._follow_master(value)
        )

    def activated(self) -> None:
        """Fall out of OP where SYNC0 was the clock and is no longer there."""
        if self.states.state is AlState.OP and not self.cycle_clock.has_clock:
            self._clock.call_at(self._clock.now_ns, Phase.APPLICATION, self._sync_gone)

    def before_latches(self) -> None:
        """Step the plant to now, so that its edges are there."""
        self.servo.axis.advance_to(self._clock.now_ns)
        self.latches.look()

    def _follow_master(self, value: int) -> None:
        if self.is_on:
            self.states.control(value)

    def _show_state(self, status: int, code: int) -> None:
        self.registers.show_state(status, code)

    def _written(self, number: int) -> None:
        if number == MAILBOX_OUT:
            self.mailbox.written()
        elif number == OUTPUTS and self.states.state in (_SAFEOP, _OP):
            self._outputs += 1
            self.cycle_clock.outputs_came()
            if self.states.state is _OP:
                self._feed()
            elif self.states.is_waiting:
                self._clock.call_at(self._clock.now_ns, Phase.APPLICATION, self._arrive)

    def _taken(self, number: int) -> None:
        if number == MAILBOX_IN:
            self.mailbox.taken()

    def _repeat(self, number: int) -> None:
        if number == MAILBOX_IN:
            self.mailbox.repeat()

    def _managers_changed(self) -> None:
        """Leave a state whose SyncManagers a master has changed under it."""
        state = self.states.state
        if state >= AlState.PREOP and not self._fitting.has_mailbox():
            self.states.fall(AlState.INIT, "INVALID_MAILBOX")
        elif state >= AlState.SAFEOP and (refused := self._fitting.wrong()) is not None:
            self.states.fall(AlState.PREOP, refused)

    # States

    def enter(self, state: AlState) -> str | None:
        """Go up one state."""
        if state is AlState.PREOP:
            return self._enter_preop()
        if state is AlState.SAFEOP:
            return self._enter_safeop()
        return self._enter_op()

    def _enter_preop(self) -> str | None:
        if not self._fitting.has_mailbox():
            return "INVALID_MAILBOX"
        self.service.reset()
        self.mailbox.open()
        return None

    def _enter_safeop(self) -> str | None:
        now_ns = self._clock.now_ns
        carried = self.process_data.compile()
        if (refused := self._fitting.wrong()) is not None:
            return refused
        refused = self.cycle_clock.start()
        if refused is not None:
            self.cycle_clock.stop()
            return refused
        self.servo.watch(carried)
        self._outputs = 0
        self.servo.refresh(now_ns)
        self._show_inputs()
        return None

    def _enter_op(self) -> str | None:
        refused = self.cycle_clock.start() or self.cycle_clock.disagrees()
        if refused is not None:
            return refused
        if self._arrives():
            return None
        self._no_sync.start(NO_SYNC_NS)
        return WAITS

    def _sync_stays_away(self) -> None:
        if self.states.is_waiting and not self.cycle_clock.has_begun:
            self.states.refuse("NO_SYNC")

    def _arrives(self) -> bool:
        needs_outputs = self.process_data.outputs.codec.size > 0
        if (needs_outputs and not self._outputs) or not self.cycle_clock.has_begun:
            return False
        self._feed()
        return True

    def _arrive(self) -> None:
        if self.states.is_waiting and self._arrives():
            self.states.arrive()

    def leave(self, before: AlState, after: AlState, code: str) -> None:
        """Go down; outputs count no more, and the drive follows 6007 where it moves."""
        if after < AlState.OP:
            self.watchdog.stop()
        if after < AlState.SAFEOP:
            self.cycle_clock.stop()
        if after < AlState.PREOP:
            self.mailbox.close()
            self.service.reset()
        if before is AlState.OP and self.servo.state in MOVING:
            lost = SYNC_LOST if code in _SYNC_CODES else OUTPUTS_LOST
            self.servo.connection_lost(self._clock.now_ns, lost)

    def _may_change(self) -> bool:
        return self.states.state is AlState.PREOP

    # The cycle

    def _cycle(self) -> None:
        """One cycle of the drive: the order is that of any carrier."""
        now_ns, servo = self._clock.now_ns, self.servo
        if self.states.is_waiting:
            self._arrive()
        servo.begin(now_ns)  # plant, edges: under the values of the cycle that ends
        if self.states.state is _OP and self._outputs:
            self.process_data.take(servo.image, self.managers[OUTPUTS].latest)
        servo.cycle(now_ns)
        if self.settings.sample_ns:
            self._plan_sample(now_ns)
        else:
            self._show_inputs()
        limit = self.profile.sync_loss_periods
        if limit and self.cycle_clock.missing >= limit and self.states.state is _OP:
            self.states.fall(AlState.SAFEOP, "SYNC_ERROR")

    def _plan_sample(self, now_ns: TimeNs) -> None:
        """Sample apart from the cycle, at an instant of the slave's own clock."""
        self._samples += 1
        after_ns = self.settings.sample_ns % max(self.cycle_clock.cycle_ns, 1)
        at_ns = self.time.instant_ns(self.time.system_ns(now_ns) + after_ns, now_ns)
        self._clock.call_at(at_ns, Phase.APPLICATION, partial(self._sample, self._samples))

    def _sample(self, number: int) -> None:
        """Sample, unless the next cycle has come before."""
        if number == self._samples and self.cycle_clock.is_running:
            self.servo.refresh(self._clock.now_ns, is_apart=True)
            self._show_inputs()

    def _show_inputs(self) -> None:
        if self.process_data.inputs.fields:
            self.managers[INPUTS].put(self.process_data.message(self.servo.image))

    def _sync0(self) -> None:
        self.cycle_clock.sync0()

    def _feed(self) -> None:
        if self.managers[OUTPUTS].is_watched:
            self.watchdog.feed()

    def _outputs_stay_away(self) -> None:
        self.states.fall(AlState.SAFEOP, "WATCHDOG")

    def _sync_gone(self) -> None:
        if not self.cycle_clock.has_clock:
            self.states.fall(AlState.SAFEOP, "FATAL_SYNC")

    def _changed(self) -> None:
        """Between two cycles inputs stay as they were sampled."""

    def _send_emergency(self, code: int, register: int, info: int) -> None:
        CoeServer.emergency(self.mailbox, code, register, info)

    def _note_change(self, row: ObjectRow) -> None:
        self.storage.note_change(row)


def _nothing() -> None:
    """SYNC1 does nothing in this drive."""
