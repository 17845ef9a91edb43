"""Over which time a drive leads its demand to the set value of a cyclic mode.

Source: CiA 402-2, object 60C2 (value and power of ten of a second); CiA 301, object 1006. Which of
two that differ counts is the drive's choice (docs/ambiguities.md).
"""

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.kernel.time.clock import US, S, TimeNs


class InterpolationTime:
    """60C2 once a master has written it; before that 1006, and 60C2 where that is 0."""

    __slots__ = ("_default", "_image", "_is_written", "_time_ns")

    def __init__(self, image: ProcessImage) -> None:
        self._image = image
        self._default = image.interpolation_value, image.interpolation_index
        self._is_written = False
        self._time_ns: TimeNs = 0
        self.update()

    def forget(self) -> None:
        """Be as after power on: no master has written 60C2."""
        self._is_written = False
        self.update()

    def written(self) -> None:
        """Take 60C2 for what a master wants, the default value too."""
        self._is_written = True
        self.update()

    def update(self) -> None:
        """Read 60C2 again; what 1010 has stored was written by a master."""
        value, index = self._image.interpolation_value, self._image.interpolation_index
        if (value, index) != self._default:
            self._is_written = True
        parts_of_s: int = 10**-index
        self._time_ns = value * S // parts_of_s

    def period_ns(self) -> TimeNs:
        """Return the time from one set value to the next."""
        period_us = self._image.sync_period_us
        return period_us * US if period_us and not self._is_written else self._time_ns
