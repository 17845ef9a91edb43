"""The objects of the device profile, as whoever carries their values reads and writes them."""

from collections.abc import Callable
from typing import Final

from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.store import Owner
from axisrig.bench.drive.cia402.servo import Servo
from axisrig.kernel.time.clock import Clock

PROFILE_OBJECTS: Final = range(0x6000, 0xA000)
INTERPOLATION_TIME: Final = 0x60C2


class ProfileObjects(Owner):
    """The objects of the device profile: read as they are now, acting when they are written.

    changed(): called after a write has acted.
    """

    def __init__(
        self, servo: Servo, profile: DriveProfile, clock: Clock, changed: Callable[[], None]
    ) -> None:
        self._servo, self._clock, self._changed = servo, clock, changed
        self._profile = profile
        self._rows = variables()

    def read(self, index: int, sub: int) -> None:
        """Sample, so that the value is that of this instant."""
        row = self._rows.get((index, sub))
        if row is not None and row.value:
            self._servo.refresh(self._clock.now_ns)

    def check(self, index: int, sub: int, value: int) -> None:
        """Refuse what the drive cannot do; the time until now belongs to the old value."""
        if (index == 0x60B8 and not self._servo.touch_probe.supports(value)) or (
            index == 0x60D0 and value not in self._profile.source_values
        ):
            abort(AbortCode.INVALID_VALUE)
        refusal = self._servo.refuses(index, value)
        if refusal is not None:
            raise SdoAbortedError(refusal)
        self._servo.begin(self._clock.now_ns)

    def written(self, index: int, sub: int, value: int) -> None:
        """Act now, and say that values have changed."""
        if index == INTERPOLATION_TIME:
            self._servo.interpolation.written()
        self._servo.update()
        self._servo.react(self._clock.now_ns)
        self._changed()
