"""The control's end of a drive that only takes a speed: the CNC closes the position loop.

A family derives its own: which images there are, where the position is, what a latch is.
"""

from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.cyclic.image_drive import ImageDrive
from axisrig.kernel.drives.interface import DriveHoming
from axisrig.kernel.drives.power import Power, PowerRequest
from axisrig.kernel.drives.speed_drive.probe_latch import ProbeLatch
from axisrig.kernel.drives.speed_drive.settings import SpeedDriveSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.speed_drive import words
from axisrig.kernel.profiles.speed_drive.words import Image
from axisrig.kernel.time.clock import Clock

_STATES = (
    (words.FAULT, "FAULT"),
    (words.OPERATES, "OPERATION"),
    (words.READY, "READY"),
)


class SpeedDrive(ImageDrive):
    """One drive, read and written once per cycle. status: DRIVE of its image.

    images: to the drive, and from it. latch: of its probing input.
    """

    def __init__(
        self,
        settings: SpeedDriveSettings,
        port: ImagePort,
        images: tuple[Image, Image],
        latch: ProbeLatch,
    ) -> None:
        super().__init__(settings, port, settings.missing_cycles)
        self._of_drive, self.latch = settings, latch
        self._out, self._in = images
        self._speed_mm_s = 0.0
        self._level: bool | None = None

    # Of a family

    def _place_of(self, values: dict[str, int]) -> int:
        """Return the actual position, increments."""
        raise NotImplementedError

    def _take_latch(self, values: dict[str, int], place: int, travel: int) -> None:
        """Take what the image shows of the latch."""
        raise NotImplementedError

    def _latched_mm(self, value: int, place: int) -> float:
        """Return the position of a latched value. place: of the telegram that brought it."""
        raise NotImplementedError

    def _own_outputs(self) -> dict[str, int]:
        """Return what goes to the drive besides DRIVE and SPEED."""
        raise NotImplementedError

    def wrong_reference(self) -> Alarm | None:
        """Return the alarm of a position that is none any more."""
        return None

    # A cycle

    def take(self) -> None:
        """Take the image of this cycle. Raises Alarm 900780 when it stays out."""
        self._has_sent = False
        data = self.port.inputs
        is_there = data is not None and len(data) == self._in.codec.size
        self.arrival.is_new = is_there
        if data is None or not is_there:
            self._note_missing(900780)
            return
        self._missing = 0
        values = self._in.values_of(data)
        self.status = values["DRIVE"]
        self._note_power(self._power())
        before, has_before = self.actual_increments, self._actual_age is not None
        place = self._place_of(values)
        self._take_place(place)
        self._take_latch(values, place, place - before if has_before else 0)

    def _power(self) -> Power:
        if self.status & words.FAULT:
            return Power.FAULT
        if not self.status & words.OPERATES:
            return Power.OFF
        return Power.STOPPING if self.request is PowerRequest.STOP else Power.OPERATING

    def send(self, set_mm: float) -> None:
        """Send enable, set speed and what the family has."""
        target = self._note_target(set_mm)
        self._speed_mm_s = self._set_speed_mm_s(set_mm, target)
        limit = words.OUTPUT_MAX
        output = max(-limit, min(round(self._speed_mm_s * self._of_drive.speed_counts), limit))
        values = {"DRIVE": self._power_bits(), "SPEED": output, **self._own_outputs()}
        self.port.outputs = self._out.packed(values)

    def _set_speed_mm_s(self, set_mm: float, target: int) -> float:
        loop = self.loop
        assert loop is not None, "the CNC closes it"
        if self.power is Power.OPERATING:
            if not self.has_actual:
                return loop.open_mm_s(set_mm)
            speed = self._loop_mm_s(set_mm)
            # Less than an increment cannot be seen: the axis would hunt between two
            return 0.0 if self.is_still and target == self.actual_increments else speed
        self._hold_loop(set_mm)
        if self.power is not Power.STOPPING:
            return 0.0
        less = self.settings.acceleration_mm_s2 * self._of_drive.period_s
        speed = self._speed_mm_s
        return max(0.0, speed - less) if speed > 0.0 else min(0.0, speed + less)

    def _power_bits(self) -> int:
        if self.power is Power.FAULT:
            return words.RESET if self.acknowledges_faults else 0
        is_moving = bool(self.status & words.OPERATES)
        if self.request is PowerRequest.ON:
            return words.ENABLE if self.is_placed or is_moving else 0
        keeps = self.request in (PowerRequest.KEEP, PowerRequest.STOP)
        return words.ENABLE if keeps and is_moving else 0

    # Faults

    @property
    def state_name(self) -> str:
        """The state that DRIVE shows."""
        return next((name for bit, name in _STATES if self.status & bit), "NOT_READY")

    @property
    def is_in_fault(self) -> bool:
        """Whether DRIVE has a fault."""
        return bool(self.status & words.FAULT)

    @property
    def status_text(self) -> str:
        """DRIVE as messages have it."""
        return f"0x{self.status:02X}"

    # The latch

    def choose_latch(self, probe_input: int, edge: str) -> None:
        """Measure with another edge from the next run on."""
        self.probe_input, self.edge = probe_input, edge

    def arm(self) -> None:
        """Enable the latch with the next image."""
        self.latch.arm()

    def disarm(self) -> None:
        """Switch it off, and drop what it has."""
        self.latch.disarm()

    @property
    def is_probing(self) -> bool:
        """Whether the latch has been ordered on and not off again."""
        return self.latch.is_ordered

    @property
    def is_clear(self) -> bool:
        """Whether the drive shows neither an enabled latch nor a value."""
        return self.latch.is_clear

    @property
    def is_armed(self) -> bool:
        """Whether the latch waits for the edge, or has its value."""
        return self.latch.is_armed

    @property
    def has_latched(self) -> bool:
        """Whether a value is there."""
        return self.latch.has_latched

    @property
    def latched_mm(self) -> float | None:
        """The latched position, None until two telegrams have the same."""
        value = self.latch.value
        return None if value is None else self._latched_mm(value, self.latch.place)

    @property
    def latched_speed_mm(self) -> float:
        """Travel in one cycle at the speed that the axis had at the latch."""
        return self.latch.travel / self._per_mm

    def is_confirmed(self) -> bool:
        """Whether two telegrams had the same value."""
        return self.latch.value is not None

    @property
    def is_actuated(self) -> bool | None:
        """Whether the input has the level that the edge leads to; None where no bit shows it."""
        return None if self._level is None else self._level == (self.edge == "POS")

    def home(self, clock: Clock) -> DriveHoming:
        """Raise Alarm 900782: homing with such a drive is not built."""
        raise Alarm(900782, axis=self.name)
