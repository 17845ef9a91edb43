"""The control's end of a drive whose words come as one image in each cycle.

What such drives have alike: a status word shows a fault and nothing its number, an image may stay
out for some cycles, and nothing is asked beside the cycle. A family derives its own words.
"""

from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.drives.settings import DriveSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival


class ImageDrive(Drive):
    """One drive, read and written once per cycle. port: its images. status: its status word.

    missing_cycles: how many images in a row may stay out.
    """

    def __init__(self, settings: DriveSettings, port: ImagePort, missing_cycles: int) -> None:
        super().__init__(settings, Arrival(0, missing_cycles, is_new=False))
        self.port = port
        self.status = 0
        self._missing, self._missing_max = 0, missing_cycles
        self._last_target = 0

    # A cycle

    def begin_cycle(self) -> None:
        """Forget what is there: a cycle counts with its own answers only."""
        self.port.begin_cycle()

    def _note_missing(self, alarm_id: int) -> None:
        """Count an image that has stayed out; raise the alarm when too many have."""
        self._missing += 1
        self.second_age_cycles += 1
        if self._actual_age is not None:
            self._actual_age += 1
        if self._missing > self._missing_max:
            raise Alarm(alarm_id, axis=self.name, cycles=self._missing)

    def _note_target(self, set_mm: float) -> int:
        """Note a set position; return it in increments."""
        self._note_sent(set_mm)
        target = round(set_mm * self._per_mm)
        self.is_still = target == self._last_target
        self._last_target = target
        return target

    # Faults

    @property
    def status_text(self) -> str:
        """The status word as messages have it."""
        raise NotImplementedError

    @property
    def has_reported(self) -> bool:
        """A drive says nothing by itself but the bit of its status word."""
        return False

    def ask_for_fault(self) -> None:
        """No image carries the number of a fault."""

    @property
    def is_asked(self) -> bool:
        """Nothing was asked."""
        return False

    def fault(self) -> Alarm:
        """Return Alarm 900005; what the fault is no image says."""
        return Alarm(900005, axis=self.name, statusword=self.status_text, emcy="none")

    def forget_fault(self) -> None:
        """Begin anew: what led here is over."""
        self.acknowledges_faults = False

    def left_operation(self) -> Alarm:
        """Return Alarm 900027."""
        text = self.status_text
        return Alarm(900027, axis=self.name, statusword=text, state=self.state_name)

    # The latch

    @property
    def is_prepared(self) -> bool:
        """Nothing but the latch is needed."""
        return True
