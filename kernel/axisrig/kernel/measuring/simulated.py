"""A probe that is not there: the CNC makes its signal from the set positions (P-AXIS-00112).

What a simulated drive of the manual does: its actual position is the set position, and so is what
it latches, to one cycle. Source: TF5200 axis parameters 118162699 and 118165771.

    1  the axis reaches or crosses a position (P-AXIS-00145, 0.1 um) in its direction
    2  so many cycles after the motion has begun
    3  the way that is left to the axis is less than so many per cent of its whole way
    4  all axes are at the target; SIMU_OFFSET of #MEAS shifts that along the path
    5  the first axis is at its target, at once when it is there already
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import dist

from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.parameters.units import UNITS_PER_MM

POSITION, CYCLES, REST, ALL, FIRST = 1, 2, 3, 4, 5
ACTS = (POSITION, CYCLES, REST, ALL, FIRST)
SAME_MM = 1e-9


@dataclass(frozen=True)
class Way:
    """The programmed way of a run, axis positions in mm; offset_mm: SIMU_OFFSET."""

    start_mm: Mapping[str, float]
    target_mm: Mapping[str, float]
    offset_mm: float = 0.0

    def travelled_mm(self, here_mm: Mapping[str, float]) -> float:
        """Return how far a position is from the start."""
        return dist(tuple(self.start_mm.values()), tuple(here_mm[name] for name in self.start_mm))

    @property
    def length_mm(self) -> float:
        """The whole way."""
        return self.travelled_mm({**self.start_mm, **self.target_mm})


@dataclass
class SimulatedProbe:
    """The latch of one axis; mode and parameter: P-AXIS-00112 and 00145."""

    name: str
    mode: int
    parameter: int
    way: Way
    is_armed: bool = False
    has_latched: bool = False
    latched_mm: float | None = None
    latched_speed_mm: float = field(init=False)
    is_actuated: bool | None = field(init=False)
    is_prepared: bool = field(init=False)
    arrival: Arrival = field(default_factory=Arrival, init=False)
    _cycles: int = field(init=False)

    def __post_init__(self) -> None:
        self.latched_speed_mm, self.is_actuated, self.is_prepared = 0.0, None, True
        self._cycles = 0

    def arm(self) -> None:
        """Wait for the signal from now on."""
        self.is_armed, self._cycles = True, 0

    def disarm(self) -> None:
        """Wait no longer, and forget the latch."""
        self.is_armed = self.has_latched = False
        self.latched_mm = None

    @property
    def is_clear(self) -> bool:
        """Whether the probe waits for nothing and has nothing."""
        return not self.is_armed and not self.has_latched

    def is_confirmed(self) -> bool:
        """Whether the latch is proved, which a simulated one is."""
        return self.has_latched

    def look(self, here_mm: Mapping[str, float]) -> None:
        """Take the set positions of one cycle of the motion."""
        self._cycles += 1
        if self.is_armed and not self.has_latched and self._signals(here_mm):
            self.has_latched, self.latched_mm = True, here_mm[self.name]

    def _signals(self, here_mm: Mapping[str, float]) -> bool:
        way, axis = self.way, self.name
        start, target, here = way.start_mm[axis], way.target_mm.get(axis), here_mm[axis]
        if self.mode == POSITION:
            sign = 1.0 if target is None or target >= start else -1.0
            return sign * (here - self.parameter / UNITS_PER_MM) >= -SAME_MM
        if self.mode == CYCLES:
            return self._cycles >= self.parameter
        if self.mode == REST:
            left = 0.0 if target is None else abs(target - here) / abs(target - start)
            return left * 100.0 < self.parameter
        if self.mode == ALL:
            return way.travelled_mm(here_mm) >= way.length_mm + way.offset_mm - SAME_MM
        return any(abs(end - here_mm[name]) <= SAME_MM for name, end in way.target_mm.items())
