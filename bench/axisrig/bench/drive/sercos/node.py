"""A SERCOS drive on EtherCAT (SoE): its words, before the servo that other drives have too.

Phases: PREOP is phase 2, SAFEOP 3, OP 4. Source: docs/sercos.md.
"""

from collections.abc import Callable, Mapping
from typing import Final

from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.bench.drive.axis.switches import HOME
from axisrig.bench.drive.ethercat.description import Description
from axisrig.bench.drive.ethercat.mailbox import MailboxService
from axisrig.bench.drive.ethercat.node import EthercatDrive, SlaveSettings
from axisrig.bench.drive.ethercat.process_data import Exchanged
from axisrig.bench.drive.sercos.commands import DONE, FAILED, INTERRUPTED, RUNNING, Commands
from axisrig.bench.drive.sercos.description import describe
from axisrig.bench.drive.sercos.front import NO_ERROR, Front
from axisrig.bench.drive.sercos.idents import Idents, rows_of
from axisrig.bench.drive.sercos.probe_unit import AUTOMATIC, ProbeUnit
from axisrig.bench.drive.sercos.profiles import SercosProfile, units_per_turn
from axisrig.bench.drive.sercos.service_channel import ServiceChannel
from axisrig.bench.drive.sercos.telegrams import Telegrams
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.profiles.sercos import words
from axisrig.kernel.profiles.sercos.service import ident_number, pack_text
from axisrig.kernel.time.clock import Clock

CONTROL_CYCLE, BUS_CYCLE = ident_number("S-0-0001"), ident_number("S-0-0002")
INVALID_3, INVALID_4 = ident_number("S-0-0021"), ident_number("S-0-0022")
MODE = ident_number("S-0-0032")
SCALING = tuple(ident_number(f"S-0-00{number}") for number in (76, 77, 78, 79))
TORQUE_LIMIT, WINDOW = ident_number("S-0-0092"), ident_number("S-0-0159")
TEXT, RESET = ident_number("S-0-0095"), ident_number("S-0-0099")
CHECK_3, CHECK_4 = ident_number("S-0-0127"), ident_number("S-0-0128")
ENABLES: Final = (ident_number("S-0-0405"), ident_number("S-0-0406"))
MODES: Final = {3: 8, 11: 8}
"""Primary operation modes S-0-0032: position with feedback 1, with lag and without."""
NO_WINDOW: Final = 0xFFFF_FFFF
WHOLE_MS: Final = 1000
HALF_MS: Final = 500
_PHASES: Final = {AlState.SAFEOP: 3, AlState.OP: 4}


class SercosDrive(EthercatDrive):
    """One drive on the line: it moves an axis and has up to two probe signals.

    Arguments as those of `EthercatDrive`; sercos: its profile.
    """

    def __init__(  # noqa: PLR0913
        self,
        name: str,
        clock: Clock,
        axis: AxisPort,
        probes: tuple[SignalPort | None, SignalPort | None],
        sercos: SercosProfile,
        settings: SlaveSettings | None = None,
        seed: int = 0,
        *,
        switches: Mapping[str, SignalPort] | None = None,
        entered: Callable[[State], None] | None = None,
    ) -> None:
        self.sercos = sercos
        super().__init__(
            name,
            clock,
            axis,
            probes,
            sercos.drive,
            settings,
            seed,
            switches=switches,
            entered=entered,
        )

    def _describe(self) -> Description:
        return describe(self.sercos, self.settings.serial, self.settings.mailbox_bytes)

    def _make_process_data(self) -> Exchanged:
        self.front = Front(self.servo)
        self.probing = ProbeUnit(self.sercos, self.servo.touch_probe, self._select, self._enabled)
        self._names = {ident_number(row["ident"]): row["value"] for row in rows_of(self.sercos)}
        self.idents = Idents(
            self.sercos, self._live(), self._image_value, self._check, self._ident_written
        )
        runs = {
            words.PROBE_COMMAND: self._probe,
            RESET: self._reset_error,
            CHECK_3: self._check_phase_3,
            CHECK_4: self._check_phase_4,
        }
        self.commands = Commands(self.idents, runs, self._cancelled)
        self.telegrams = Telegrams(
            self.idents, self._names.__getitem__, self._take_control, self._status
        )
        self.servo.power_on.own["mode"] = MODES[self.idents.number(MODE)]
        return self.telegrams

    def _make_service(self) -> MailboxService:
        self.channel = ServiceChannel([self.idents.table], self._mailbox_size, lambda: self.phase)
        return self.channel

    @property
    def phase(self) -> int:
        """Communication phase, 2 to 4."""
        return _PHASES.get(self.states.state, 2)

    # Values

    def _live(self) -> dict[str, Callable[[], int]]:
        front, probing, switches = self.front, self.probing, self.servo.switches
        found: dict[str, Callable[[], int]] = {
            "c1d": front.class_1,
            "c2d": lambda: 0,
            "c3d": lambda: 0,
            "interface": lambda: self.phase,
            "control": lambda: front.control,
            "status": self._status,
            "diagnosis": lambda: (front.error or NO_ERROR).number,
            "latched": probing.latches,
            "home_switch": lambda: int(switches.is_on(HOME)),
            "probe_1": lambda: probing.level(0),
            "probe_2": lambda: probing.level(1),
            "latched_0": lambda: probing.latched(0),
            "latched_1": lambda: probing.latched(1),
            "latched_2": lambda: probing.latched(2),
            "latched_3": lambda: probing.latched(3),
        }
        return found

    def _image_value(self, name: str) -> int:
        value: int = getattr(self.servo.image, name)
        return 0 if name == "following_window" and value == NO_WINDOW else value

    def _select(self) -> int:
        return self.idents.number(words.PROBE_CONTROL)

    def _enabled(self, probe: int) -> bool:
        ident = ENABLES[probe]
        return ident in self.idents.table and bool(self.idents.number(ident) & 1)

    # The telegrams

    def _take_control(self, control: int) -> None:
        """Act on S-0-0134: real-time bits write bit 0 of their idents."""
        self.front.control = control
        for mask, allocation in zip(words.REAL_TIME, words.CONTROL_BITS, strict=True):
            ident = self.idents.number(allocation)
            if ident in ENABLES and ident in self.idents.table:
                self.idents.put(ident, int(bool(control & mask)))
            elif ident == words.PROBE_COMMAND:
                self._switch_probing(is_on=bool(control & mask))
        self._tell_servo()

    def _switch_probing(self, *, is_on: bool) -> None:
        """Begin or end the probing cycle by a real-time bit."""
        if is_on is not self.probing.is_running:
            command = self.idents.table[words.PROBE_COMMAND]
            if is_on and self.probing.begin():
                command.state = RUNNING
            elif not is_on:
                self.probing.end()
                command.state = 0

    def _tell_servo(self) -> None:
        """Give the servo what follows from the idents."""
        image = self.servo.image
        image.controlword = self.front.controlword()
        image.probe_function = self.probing.function()
        if self.front.is_resetting and not self.front.has_error:
            self.front.is_resetting = False
            self.commands.end(RESET, DONE)

    def _status(self) -> int:
        word = self.front.status(command_changed=self.commands.has_changed)
        for mask, allocation in zip(words.REAL_TIME, words.STATUS_BITS, strict=True):
            ident = self.idents.number(allocation)
            if ident and self.idents.number(ident) & 1:
                word |= mask
        return word

    # Writes over the service channel

    def _check(self, ident: int, number: int) -> str | None:
        """Return the name of the code that refuses a value, None."""
        if ident in words.REAL_TIME_BITS:
            return None if self._may_have_bit(ident, number) else "INVALID"
        if ident == words.PROBE_CONTROL and self.sercos.locks_select and self.probing.is_running:
            return "PROTECTED_NOW"
        if ident in ENABLES and self.sercos.locks_control and number:
            has_bit = any(self.idents.number(bit) == ident for bit in words.CONTROL_BITS)
            return "BY_OTHERS" if has_bit else None
        return None if self._is_valid(ident, number) else "INVALID"

    def _may_have_bit(self, allocation: int, ident: int) -> bool:
        is_control = allocation in words.CONTROL_BITS
        allowed = self.sercos.control_bits if is_control else self.sercos.status_bits
        is_known = ident == 0 or ident in self.idents.table
        return is_known and (allowed is None or ident in allowed)

    def _is_valid(self, ident: int, number: int) -> bool:
        if ident == words.PROBE_CONTROL:
            return not number & ~self.sercos.select
        if ident in (CONTROL_CYCLE, BUS_CYCLE):
            return number == HALF_MS or not number % WHOLE_MS
        if ident == MODE:
            return number in MODES
        return ident != SCALING[0] or self._units(number) is not None

    def _units(self, kind: int) -> object:
        _, factor, exponent, resolution = (self.idents.number(ident) for ident in SCALING)
        lead_um = self.profile.lead_um
        return units_per_turn(kind, factor, exponent, resolution, lead_um)

    def _ident_written(self, ident: int) -> None:
        """Act on a write that was taken."""
        servo, now_ns = self.servo, self._clock.now_ns
        number = 0 if self.idents.table[ident].attribute.is_variable else self._written_to(ident)
        servo.begin(now_ns)
        image = servo.image
        if ident in self.commands.known:
            self.commands.written(ident)
        elif ident in SCALING:
            self._rescale()
        elif ident == BUS_CYCLE:
            image.interpolation_value, image.interpolation_index = number, -6
            servo.interpolation.written()
        elif ident == MODE:
            image.mode = MODES[number]
        elif ident == TORQUE_LIMIT:
            image.max_torque = number
        elif ident == WINDOW:
            image.following_window = number or NO_WINDOW
        self._tell_servo()
        servo.update()
        servo.react(now_ns)
        self._changed()

    def _written_to(self, ident: int) -> int:
        found = self.idents.table[ident]
        return found.number(found.value)

    def _rescale(self) -> None:
        """Count positions as S-0-0076 to 79 say."""
        kind, factor, exponent, resolution = (self.idents.number(ident) for ident in SCALING)
        units = units_per_turn(kind, factor, exponent, resolution, self.profile.lead_um)
        if units is not None:
            image = self.servo.image
            image.feed, image.feed_shaft = units.numerator, units.denominator

    # Procedure commands

    def _check_phase_3(self) -> int:
        """S-0-0127: whether phase 3 can be; S-0-0021 has what is wrong."""
        wrong = self.telegrams.wrong()
        self.idents.put_list(INVALID_3, wrong)
        return FAILED if wrong else DONE

    def _check_phase_4(self) -> int:
        """S-0-0128: whether phase 4 can be; S-0-0022 has what is wrong."""
        wrong = []
        if self.idents.number(CONTROL_CYCLE) != self.idents.number(BUS_CYCLE):
            wrong = [CONTROL_CYCLE, BUS_CYCLE]
        self.idents.put_list(INVALID_4, wrong)
        return FAILED if wrong else DONE

    def _probe(self) -> int:
        """S-0-0170: probe until it is cancelled."""
        return RUNNING if self.probing.begin() else FAILED

    def _reset_error(self) -> int:
        """S-0-0099: clear the error of class 1, where it can be."""
        self.front.is_resetting = self.front.has_error
        return RUNNING if self.front.has_error else DONE

    def _cancelled(self, ident: int) -> None:
        if ident == words.PROBE_COMMAND:
            self.probing.end()
        elif ident == RESET:
            self.front.is_resetting = False

    # Faults

    def hold_bit(self, name: str, *, level: bool | None) -> None:
        """Let a real-time bit keep its level on the wire; None: it passes again."""
        self.telegrams.hold(name, level=level)

    def disturb_channel(self, answers: Callable[[], str | None]) -> None:
        """Ask this before each request: None, "" = no answer, name of the code that refuses it."""
        self.channel.disturbances.append(answers)

    def interrupt_probing(self) -> None:
        """Let the probing cycle end by itself."""
        servo, now_ns = self.servo, self._clock.now_ns
        servo.begin(now_ns)
        self.probing.end()
        self.commands.end(words.PROBE_COMMAND, INTERRUPTED)
        self._tell_servo()
        servo.update()
        servo.react(now_ns)

    # States of the slave

    def _boot(self) -> None:
        self.front.reset()
        self.probing.end()
        self.idents.reset()
        super()._boot()

    def _enter_safeop(self) -> str | None:
        if self.telegrams.wrong():
            is_input = self.telegrams.has_wrong_inputs
            return "INVALID_INPUT_MAPPING" if is_input else "INVALID_OUTPUT_MAPPING"
        return super()._enter_safeop()

    def _enter_op(self) -> str | None:
        if self.idents.number(CONTROL_CYCLE) != self.idents.number(BUS_CYCLE):
            return "INVALID_SYNC_CYCLE"
        result = super()._enter_op()
        if self._select() & AUTOMATIC:
            self.idents.table[words.PROBE_COMMAND].state = self._probe()
        return result

    def leave(self, before: AlState, after: AlState, code: str) -> None:
        """Go down; the control word counts no more, and the probing cycle ends with its phase."""
        if before is AlState.OP:
            self.front.control = 0
        super().leave(before, after, code)
        if after < AlState.SAFEOP:
            self.probing.end()
            self.idents.table[words.PROBE_COMMAND].state = 0

    def _cycle(self) -> None:
        super()._cycle()
        self._changed()

    def _changed(self) -> None:
        """Go on with S-0-0099 where no telegram does: in phases 2 and 3."""
        if self.front.is_resetting and self.states.state is not AlState.OP:
            self._tell_servo()
            self.servo.react(self._clock.now_ns)
            self._tell_servo()

    def _send_emergency(self, code: int, register: int, info: int) -> None:
        self.front.report(code)
        text = "" if self.front.error is None else self.front.error.text
        self.idents.table[TEXT].value = pack_text(text, self.idents.table[TEXT].capacity)
