"""The clocks of a measurement; the command line gives them, nothing here reads one."""

from collections.abc import Callable
from typing import NamedTuple


class Clocks(NamedTuple):
    """Two clocks, ns: wall time, and CPU time of this process and its children that have ended."""

    wall_ns: Callable[[], int]
    cpu_ns: Callable[[], int]

    def cpu_s(self) -> float:
        """Return the CPU time, s: the stopwatch of a run."""
        return self.cpu_ns() / 1e9
