"""The oscillator of one slave: its local time in ns as a function of simulated time."""

from typing import Final

from axisrig.kernel.time.clock import TimeNs

_PARTS: Final = 1_000_000_000
MASK_64: Final = (1 << 64) - 1


class LocalClock:
    """Local time = start_ns + t (1 + drift).

    start_ns: what it shows at instant 0. drift_ppm: how much faster than simulated time it runs.
    """

    def __init__(self, start_ns: TimeNs = 0, drift_ppm: float = 0.0) -> None:
        self._start_ns = start_ns
        self._parts = round(drift_ppm * 1000)  # of 1e9

    @property
    def parts(self) -> int:
        """Its drift in parts of 1e9."""
        return self._parts

    def at(self, time_ns: TimeNs) -> int:
        """Return the local time at an instant, not wrapped."""
        if not self._parts:
            return self._start_ns + time_ns
        return self._start_ns + time_ns + time_ns * self._parts // _PARTS

    def jump(self, by_ns: TimeNs) -> None:
        """Let it show something else from now on."""
        self._start_ns += by_ns
