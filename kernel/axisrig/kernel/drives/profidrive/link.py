"""The control's end of one PROFIdrive drive: set values out, actual values and latches in."""

from typing import Final

from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.cyclic.image_drive import ImageDrive
from axisrig.kernel.drives.frozen_encoder import FrozenEncoder
from axisrig.kernel.drives.interface import DriveHoming
from axisrig.kernel.drives.position_check import Answered, PositionCheck
from axisrig.kernel.drives.power import Power, PowerRequest
from axisrig.kernel.drives.profidrive.encoder import EncoderControl
from axisrig.kernel.drives.profidrive.settings import ProfidriveSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.profidrive import words
from axisrig.kernel.time.clock import Clock, TimeNs

BY_ABSOLUTE: Final = "G1_XIST2 (bit 13 of G1_STW)"
OFF: Final = words.BY_CONTROL | words.NO_OFF2 | words.NO_OFF3 | words.ENABLE | words.SETPOINT
"""STW1 of a drive that stops by its ramp and goes off."""
MOVING: Final = OFF | words.ON
HALTED: Final = MOVING & ~words.SET_VALUE
RUNS: Final = words.READY | words.OPERATES
LIMIT: Final = (1 << 31) - 1
_STATES: Final = (
    (words.FAULT, "FAULT"),
    (words.INHIBITED, "SWITCHING_ON_INHIBITED"),
    (words.OPERATES, "OPERATION"),
    (1 << 1, "SWITCHED_ON"),
    (1 << 0, "READY_TO_SWITCH_ON"),
)


class ProfidriveDrive(ImageDrive):
    """One drive, read and written once per cycle. status, control: ZSW1 and STW1."""

    def __init__(self, settings: ProfidriveSettings, port: ImagePort) -> None:
        super().__init__(settings, port, settings.missing_cycles)
        self._of_drive = settings
        telegram = settings.telegram
        self._in, self._out = (
            words.codec_of(names) for names in (telegram.from_drive, telegram.to_drive)
        )
        self._input_names, self._output_names = telegram.from_drive, telegram.to_drive
        self._has_second = telegram.has_second
        self.control = 0
        self._life = self._heard = 0  # signs of life, own and the drive's
        self._second: int | None = None
        self._encoder = self._make_encoder()
        if settings.gain:  # the loop in the drive runs on with XERR as one of the CNC with its lag
            self.frozen = FrozenEncoder(settings.increments_per_mm, settings.period_s)
        if settings.proves_places:
            self.place_check = PositionCheck(self._ask_place, BY_ABSOLUTE)

    def _make_encoder(self) -> EncoderControl:
        function = words.FUNCTION_OF[self.probe_input, self.edge]
        return EncoderControl(function, self._of_drive.echo_cycles)

    def _ask_place(self, answered: Answered) -> bool:
        """Read the absolute position."""
        return self._encoder.ask_absolute(answered)

    # A cycle

    def take(self) -> None:
        """Take the telegram of this cycle. Raises Alarm 900764 when it stays out.

        One with the sign of life of the one before is old: the drive has not made it anew.
        """
        self._has_sent = False
        values = self._new_values()
        self.arrival.is_new = values is not None
        if values is None:
            self._note_missing(900764)
            return
        self._missing = 0
        self.status = values["ZSW1"]
        self._note_power(self._power())
        actual = values["G1_XIST1"]
        self._take_place(actual)
        self._encoder.take(values["G1_ZSW"], values["G1_XIST2"], actual)
        if self._has_second:
            self._second = values["G2_XIST1"]
            self.second_age_cycles = 0

    def _new_values(self) -> dict[str, int] | None:
        data = self.port.inputs
        if data is None or len(data) != self._in.size:
            return None
        values = dict(zip(self._input_names, self._in.unpack(data), strict=True))
        heard = values["ZSW2"] >> words.LIFE_SHIFT
        if heard in (0, self._heard):
            return None
        self._heard = heard
        return values

    def _power(self) -> Power:
        if self.status & words.FAULT:
            return Power.FAULT
        if self.status & RUNS != RUNS:
            return Power.OFF
        return Power.STOPPING if self.request is PowerRequest.STOP else Power.OPERATING

    def send(self, set_mm: float) -> None:
        """Send STW1, set speed, sign of life, G1_STW and what DSC needs."""
        before_mm = self.set_mm
        self.control = self._power_bits()
        self._note_target(set_mm)
        self._life = words.next_life(self._life)
        speed, deviation = self._set_values(set_mm, before_mm)
        values = {
            "STW1": self.control,
            "NSOLL_B": _limited(speed),
            "STW2": self._life << words.LIFE_SHIFT,
            "G1_STW": self._encoder.control,
            "XERR": _limited(deviation),
            "KPC": self._of_drive.gain,
        }
        self.port.outputs = self._out.pack(*(values.get(name, 0) for name in self._output_names))

    def _set_values(self, set_mm: float, before_mm: float) -> tuple[float, float]:
        """Return NSOLL_B and XERR; standstill while the drive does not follow."""
        settings = self._of_drive
        if self.power is not Power.OPERATING:
            self._hold_loop(set_mm)
            return 0.0, 0.0
        if self.loop is not None:
            return self._loop_mm_s(set_mm) * settings.speed_counts, 0.0
        demand_mm_s = (set_mm - before_mm) / settings.period_s
        deviation = set_mm * self._per_mm - self.actual_increments
        gain_per_s = settings.gain / words.KPC_PER_S  # 0: the drive closes no loop over XERR
        if gain_per_s and self._has_no_place(gain_per_s * deviation / self._per_mm):
            return demand_mm_s * settings.speed_counts, 0.0
        return settings.feed_forward * demand_mm_s * settings.speed_counts, deviation

    def _power_bits(self) -> int:
        if self.power is Power.FAULT:
            return OFF | words.ACKNOWLEDGE if self.acknowledges_faults else OFF
        request, is_moving = self.request, self.status & RUNS == RUNS
        if request is PowerRequest.ON:
            may_go_on = not self.status & words.INHIBITED and (self.is_placed or is_moving)
            return MOVING if may_go_on else OFF
        if request is PowerRequest.KEEP:
            return MOVING if is_moving else OFF
        return HALTED if request is PowerRequest.STOP and is_moving else OFF

    # Faults

    @property
    def state_name(self) -> str:
        """The state that ZSW1 shows."""
        return next((name for bit, name in _STATES if self.status & bit), "NOT_READY")

    @property
    def is_in_fault(self) -> bool:
        """Whether ZSW1 has a fault."""
        return bool(self.status & words.FAULT)

    @property
    def status_text(self) -> str:
        """ZSW1 as messages have it."""
        return f"0x{self.status:04X}"

    @property
    def encoder_error(self) -> int | None:
        """The error code of the encoder interface, None without one."""
        return self._encoder.error

    # The latch

    def choose_latch(self, probe_input: int, edge: str) -> None:
        """Measure with another input or edge; what it cannot do the drive reports (900763)."""
        if (probe_input, edge) != (self.probe_input, self.edge):
            self.probe_input, self.edge = probe_input, edge
            self._encoder = self._make_encoder()

    def arm(self) -> None:
        """Activate the function of input and edge."""
        self._encoder.arm()

    def disarm(self) -> None:
        """End the function, and drop what it has."""
        self._encoder.disarm()

    @property
    def is_probing(self) -> bool:
        """Whether the latch has been ordered on and not off again."""
        return self._encoder.is_ordered

    @property
    def is_clear(self) -> bool:
        """Whether the drive shows neither function nor value."""
        return self._encoder.is_clear

    @property
    def is_armed(self) -> bool:
        """Whether the drive waits for the edge, or has its value."""
        return self._encoder.is_armed

    @property
    def has_latched(self) -> bool:
        """Whether all functions have ended and a value is there."""
        return self._encoder.is_ordered and self._encoder.has_latched

    @property
    def latched_mm(self) -> float | None:
        """The measured value, None until it has been read."""
        increments = self._encoder.increments
        return None if increments is None else increments / self._per_mm

    @property
    def latched_speed_mm(self) -> float:
        """Travel in one cycle at the speed that the axis had at the latch."""
        return self._encoder.speed_increments / self._per_mm

    def is_confirmed(self) -> bool:
        """Whether two telegrams after the command to read had the same value."""
        return self._encoder.increments is not None

    @property
    def is_actuated(self) -> bool | None:
        """Whether the probe has the level that the edge leads to (bits 8 and 9 of G1_ZSW)."""
        return self._encoder.is_deflected(self.probe_input) == (self.edge == "POS")

    # The second encoder

    @property
    def has_second(self) -> bool:
        """Whether the telegram carries G2_XIST1."""
        return self._has_second

    @property
    def second_increments(self) -> int | None:
        """G2_XIST1; None until it has come."""
        return self._second

    def second_period_ns(self, cycle_ns: TimeNs) -> TimeNs | None:
        """Return how often G2_XIST1 is promised: with each cycle."""
        return cycle_ns if self._has_second else None

    def home(self, clock: Clock) -> DriveHoming:
        """Raise Alarm 900765: homing with a PROFIdrive drive is not built."""
        raise Alarm(900765, axis=self.name)


def _limited(value: float) -> int:
    return max(-LIMIT, min(round(value), LIMIT))
