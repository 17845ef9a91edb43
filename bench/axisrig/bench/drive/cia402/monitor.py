"""What a drive watches while a mode has the axis: following error, or speed in cst."""

import math
from typing import Final

from axisrig.bench.drive.axis.hold_time import HoldTime
from axisrig.bench.drive.axis.ports import AxisPort
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.functions.limits import Limits
from axisrig.bench.drive.cia402.functions.units import U32_MAX
from axisrig.bench.drive.cia402.modes import Mode
from axisrig.kernel.time.clock import TimeNs

FOLLOWING_ERROR: Final = 0x8611  # emergency code of CiA 402
OVERSPEED: Final = 0x8400  # emergency code of CiA 402: velocity controller


class Monitor:
    """Finds the faults of a mode. is_active: there is something to watch, so ticks are needed."""

    def __init__(self, image: ProcessImage, limits: Limits, axis: AxisPort) -> None:
        self._image, self._limits, self._axis = image, limits, axis
        self._mode: Mode | None = None
        self._beyond = HoldTime()
        self.is_active = False

    def begin(self, mode: Mode) -> None:
        """Watch a mode from now on."""
        self._mode = mode
        self._beyond.since_ns = None
        self.update()

    def update(self) -> None:
        """Look anew at what 6065 and 6080 ask for."""
        mode = self._mode
        if mode is not None and mode.limits_speed:
            self.is_active = math.isfinite(self._limits.speed_m_s)
        else:
            # Of the kind of mode: homing follows no position while it presses against a stop
            is_followed = mode is not None and mode.follows_position
            self.is_active = is_followed and self._image.following_window != U32_MAX
        if not self.is_active:
            self._beyond.since_ns = None

    @property
    def is_warning(self) -> bool:
        """Whether |60F4| is above 6065 and the time 6066 runs."""
        return self._beyond.since_ns is not None

    def look(self, now_ns: TimeNs) -> int | None:
        """Return the emergency code of a fault that is there now.

        Source: CiA 402-2: |60F4| above 6065 for the time 6066. In cst 606C above 6080.
        """
        if self._mode is not None and self._mode.limits_speed:
            is_fast = abs(self._axis.motor_velocity_m_s()) > self._limits.speed_m_s
            return OVERSPEED if is_fast else None
        image = self._image
        is_followed = self._mode is not None and self._mode.is_following
        is_beyond = is_followed and abs(image.following_error) > image.following_window
        late = self._beyond.holds(now_ns, is_beyond, image.following_timeout_ms)
        return FOLLOWING_ERROR if late else None
