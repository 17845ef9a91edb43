"""The control's end of one SERCOS drive: set values out, actual values and latches in."""

from typing import Final

from axisrig.kernel.drives.interface import Drive, DriveHoming
from axisrig.kernel.drives.position_check import Answered, PositionCheck
from axisrig.kernel.drives.power import Power, PowerRequest
from axisrig.kernel.drives.sercos.data import TelegramData
from axisrig.kernel.drives.sercos.latch import SercosLatch
from axisrig.kernel.drives.sercos.service_channel import ServiceChannel, SoeError
from axisrig.kernel.drives.sercos.settings import SercosSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.profiles.sercos import words
from axisrig.kernel.profiles.sercos.service import (
    RUN,
    Element,
    ident_name,
    ident_number,
    read_text,
)
from axisrig.kernel.time.clock import Clock

TEXT, RESET = ident_number("S-0-0095"), ident_number("S-0-0099")
C1D, NUMBER = ident_number("S-0-0011"), ident_number("S-0-0390")
FEEDBACK: Final = ident_number("S-0-0051")
BY_CHANNEL: Final = "the service channel (S-0-0051)"
MOVING: Final = words.ON | words.ENABLE | words.RUN
HALTED: Final = words.ON | words.ENABLE
READY_NAMES: Final = ("NOT_READY", "LOGIC_READY", "POWER_READY", "OPERATES")


class SercosDrive(Drive):
    """One drive, read and written once per cycle. data: its telegrams. channel: its idents.

    status, control: S-0-0135 as it came last, S-0-0134 as it was sent. knows_level: a real-time bit
    shows whether the probe is actuated.
    """

    def __init__(
        self, settings: SercosSettings, data: TelegramData, channel: ServiceChannel
    ) -> None:
        super().__init__(settings, Arrival(0, settings.missing_cycles, is_new=False))
        self._of_drive, self._data, self.channel = settings, data, channel
        self.drive_number = 0
        self.is_sercos = True
        self._has_second = any(
            mapped.field == "second" for pdo in settings.inputs for mapped in pdo.objects
        )
        self.status = self.control = 0
        self._toggle = 0
        self._second: int | None = None
        self._last_target = 0
        self.knows_level = False
        self._error: str | None = None
        self._questions = 0
        self._is_resetting = False
        control, target = data.sent_place("controlword"), data.sent_place("target")
        assert control is not None, "each MDT has it"
        assert target is not None, "the rig has been checked"
        self._control_out, self._target_out = control, target
        self._latch = self._make_latch()
        if settings.proves_places:
            self.place_check = PositionCheck(self._ask_place, BY_CHANNEL)

    def _ask_place(self, answered: Answered) -> bool:
        """Read S-0-0051 over the service channel."""

        def done(found: bytes | SoeError) -> None:
            if isinstance(found, SoeError):
                answered(str(found))
            else:
                answered(int.from_bytes(found, "little", signed=True))

        self.channel.read(self.drive_number, FEEDBACK, Element.VALUE, done)
        return True

    def _make_latch(self) -> SercosLatch:
        settings = self._of_drive
        return SercosLatch(
            settings.bits,
            self.drive_number,
            words.PROBES[self.probe_input, self.edge],
            self.channel,
            settings.echo_cycles,
            proves=settings.proves_latches,
        )

    def begin(self) -> None:
        """Begin the exchange: what came during the start-up does not count."""
        self._data.begin()

    # A cycle

    def begin_cycle(self) -> None:
        """Forget what is there: a cycle counts with its own answers only."""
        self._data.begin_cycle()

    def take(self) -> None:
        """Take the AT of this cycle. Raises Alarm 900730, 900731, 900733 when it stays out."""
        data = self._data
        self._has_sent = False
        status, actual, _, latch, _, _, second, _ = data.take()
        if status is not None:
            self.status = status
            self._note_power(self._power())
        if actual is not None:
            self._take_place(actual)
        elif self._actual_age is not None:
            self._actual_age += 1
        self.arrival.is_new = status is not None
        if status is not None:
            self._latch.take(status, latch, self.actual_increments)
        if second is not None:
            self._second = second
        self.second_age_cycles = 0 if second is not None else self.second_age_cycles + 1
        if data.is_disturbed and data.missing[0] > self._of_drive.missing_cycles:
            raise data.missing_alarm(self.name, 0)

    @property
    def ready(self) -> int:
        """Bits 15 and 14 of S-0-0135."""
        return self.status >> words.READY_SHIFT & words.READY_MASK

    def _power(self) -> Power:
        if self.status & words.C1D:
            return Power.FAULT
        if self.ready != words.OPERATES:
            return Power.OFF
        if self.request is PowerRequest.STOP:
            return Power.STOPPING
        needs = words.FOLLOWS if self._of_drive.needs_following else 0
        return Power.OPERATING if self.status & needs == needs else Power.OFF

    def send(self, set_mm: float) -> None:
        """Send S-0-0134 and the position command of this cycle."""
        self._toggle ^= words.TOGGLE
        self.control = self._power_bits() | self._toggle | self._latch.enable
        self._note_sent(set_mm)
        values, place = self._control_out
        values[place] = self.control
        target = round(set_mm * self._per_mm)
        self.is_still = target == self._last_target
        self._last_target = target
        values, place = self._target_out
        values[place] = target
        self._data.send()

    def _power_bits(self) -> int:
        if self.power is Power.FAULT:
            if self.acknowledges_faults:
                self._reset_fault()
            return 0
        request = self.request
        if request is PowerRequest.ON:
            return MOVING if self.is_placed or self.power is Power.OPERATING else 0
        is_moving = self.ready == words.OPERATES
        if request is PowerRequest.KEEP:
            return MOVING if is_moving else 0
        return HALTED if request is PowerRequest.STOP and is_moving else 0

    # Faults

    @property
    def state_name(self) -> str:
        """How far the drive is ready."""
        return "CLASS_1_ERROR" if self.status & words.C1D else READY_NAMES[self.ready]

    @property
    def is_in_fault(self) -> bool:
        """Whether class 1 has an error."""
        return bool(self.status & words.C1D)

    @property
    def has_reported(self) -> bool:
        """A drive says nothing by itself but the bit of its status word."""
        return False

    def ask_for_fault(self) -> None:
        """Read S-0-0011, S-0-0390 and S-0-0095."""
        self._error = ""
        self._questions = 3
        for ident in (C1D, NUMBER, TEXT):
            self._ask(ident)

    def _ask(self, ident: int) -> None:
        def done(found: bytes | SoeError) -> None:
            self._questions -= 1
            if self._error is None:
                return
            if isinstance(found, SoeError):
                words_ = str(found)
            elif ident == TEXT:
                words_ = read_text(found)
            else:
                words_ = f"{ident_name(ident)} 0x{int.from_bytes(found, 'little'):X}"
            self._error = f"{self._error}, {words_}" if self._error else words_

        self.channel.read(self.drive_number, ident, Element.VALUE, done)

    @property
    def is_asked(self) -> bool:
        """Whether an answer about a fault is still to come."""
        return self._questions > 0

    def fault(self) -> Alarm:
        """Return Alarm 900005 with what the drive reports of its fault."""
        return Alarm(
            900005, axis=self.name, statusword=f"0x{self.status:04X}", emcy=self._error or "none"
        )

    def forget_fault(self) -> None:
        """Begin anew: what led here is over."""
        self._error = None
        self.acknowledges_faults = False

    def _reset_fault(self) -> None:
        """Let S-0-0099 run, then cancel it."""
        if self._is_resetting:
            return
        self._is_resetting = True

        def set_(_found: bytes | SoeError) -> None:
            self.channel.write(self.drive_number, RESET, bytes(2), cancelled)

        def cancelled(_found: bytes | SoeError) -> None:
            self._is_resetting = False

        run = RUN.to_bytes(2, "little")
        self.channel.write(self.drive_number, RESET, run, set_)

    # The latch

    def choose_latch(self, probe_input: int, edge: str) -> None:
        """Measure with another input or edge from the next run on.

        Raises Alarm 900223 where the AT does not carry its value.
        """
        wanted = words.PROBES[probe_input, edge].value
        if not self._data.choose_latch(wanted, 0):
            raise Alarm(
                900223, axis=self.name, input=probe_input, edge=edge, object=ident_name(wanted)
            )
        if (probe_input, edge) != (self.probe_input, self.edge):
            self.probe_input, self.edge = probe_input, edge
            self._latch = self._make_latch()

    def arm(self) -> None:
        """Enable the latch with the next MDT."""
        self._latch.arm()

    def disarm(self) -> None:
        """Switch the latch off with the next MDT."""
        self._latch.disarm()

    @property
    def is_probing(self) -> bool:
        """Whether the latch has been ordered on and not off again."""
        return self._latch.is_ordered

    @property
    def is_clear(self) -> bool:
        """Whether the drive shows neither an enabled latch nor a done measurement."""
        return self._latch.is_clear

    @property
    def is_armed(self) -> bool:
        """Whether the drive has had the enable bit."""
        return self._latch.is_armed

    @property
    def is_prepared(self) -> bool:
        """Whether the probing cycle is known to run. Raises Alarm 900746 where it does not."""
        if self._latch.is_refused:
            raise Alarm(900746, axis=self.name)
        return self._latch.is_prepared

    @property
    def has_latched(self) -> bool:
        """Whether the drive reports a done measurement."""
        return self._latch.has_latched

    @property
    def latched_mm(self) -> float | None:
        """The measured value, None while none is reported."""
        increments = self._latch.increments
        return None if increments is None else increments / self._per_mm

    @property
    def latched_speed_mm(self) -> float:
        """Travel in one cycle at the speed that the axis had at the latch."""
        return self._latch.speed_increments / self._per_mm

    def is_confirmed(self) -> bool:
        """Whether the service channel gives the measured value too."""
        return self._latch.is_confirmed()

    @property
    def is_actuated(self) -> bool | None:
        """Whether the probe has the level that the edge leads to; None: no bit shows it."""
        if not self.knows_level:
            return None
        return bool(self.status & self._of_drive.bits.actuated) == (self.edge == "POS")

    # The second encoder

    @property
    def has_second(self) -> bool:
        """Whether the AT carries S-0-0053."""
        return self._has_second

    @property
    def second_increments(self) -> int | None:
        """S-0-0053; None until it has come."""
        return self._second

    def second_period_ns(self, cycle_ns: int) -> int | None:
        """Return how often S-0-0053 is promised: with each cycle."""
        return cycle_ns if self._has_second else None

    def home(self, clock: Clock) -> DriveHoming:
        """Raise Alarm 900747: homing by a SERCOS drive (S-0-0148) is not built."""
        raise Alarm(900747, axis=self.name)
