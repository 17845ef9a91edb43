"""A probe that is not there: the CNC makes its signal from the set positions (P-AXIS-00112).

What a simulated drive of the manual does: its actual position is the set position, and so is what
it latches, to one cycle. Source: TF5200 axis parameters 118162699 and 118165771.

    1  the axis reaches or crosses a position (P-AXIS-00145, 0.1 um) in its direction
    2  so many cycles after the motion has begun
    3  the way that is left to the axis is less than so many per cent of its whole way
    4  all axes are at the target; SIMU_OFFSET of #MEAS shifts that along the path
    5  the first axis is at its target, at once when it is there already
    6  the axes are in a body, which their P-AXIS-00145 to 00148 describe (`Body`)

Under a kinematic 1 and 6 are about positions of axes, 3 to 5 about the programmed path, which is in
tool coordinates; what is latched is the position of the axis.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from math import copysign, dist
from typing import Final

from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.parameters.units import UNITS_PER_MM

POSITION, CYCLES, REST, ALL, FIRST, BODY = 1, 2, 3, 4, 5, 6
ACTS = (POSITION, CYCLES, REST, ALL, FIRST, BODY)
SAME_MM: Final = 1e-9


@dataclass(frozen=True)
class Way:
    """The programmed way of a run in the coordinates of targets, mm; offset_mm: SIMU_OFFSET.

    target_mm: of the axes that move. programmed: the axes of the block; one without a target is
    at it already. share: length of the path by distance in the coordinates, which under a
    kinematic are not of one kind.
    """

    start_mm: Mapping[str, float]
    target_mm: Mapping[str, float]
    offset_mm: float = 0.0
    programmed: Collection[str] = ()
    share: float = 1.0

    def travelled_mm(self, here_mm: Mapping[str, float]) -> float:
        """Return how much of the path lies between the start and a place on it."""
        here = tuple(here_mm[name] for name in self.start_mm)
        return self.share * dist(tuple(self.start_mm.values()), here)

    def has_axis_at_target(self, here_mm: Mapping[str, float]) -> bool:
        """Return whether one of the axes is at its target."""
        ends_mm = self.target_mm
        return any(name not in ends_mm for name in self.programmed) or any(
            abs(end_mm - here_mm[name]) <= SAME_MM for name, end_mm in ends_mm.items()
        )

    @property
    def length_mm(self) -> float:
        """The whole way."""
        return self.travelled_mm({**self.start_mm, **self.target_mm})


@dataclass(frozen=True)
class Body:
    """A body that is touched: cuboid, sphere, cylinder, or their like in a plane (mode 6).

    axes: what each axis of mode 6 gives, moved or not, in mm: least and largest position, centre
    and radius (P-AXIS-00145 to 00148). An axis with a radius is one of the round part, one whose
    positions differ is bounded by them; one with neither of both does not limit the body.
    """

    axes: Mapping[str, tuple[float, float, float, float]] = field(default_factory=dict)

    @classmethod
    def of(cls, simulated: Mapping[str, Sequence[int]]) -> "Body":
        """Make the body of axes; simulated: P-AXIS-00112 and 00145 to 00148 of each."""
        axes = {}
        for name, numbers in simulated.items():
            if numbers[0] != BODY:
                continue
            low, high, centre, radius = (number / UNITS_PER_MM for number in numbers[1:5])
            if low != high or radius:
                axes[name] = low, high, centre, radius
        return cls(axes)

    def contains(self, here_mm: Mapping[str, float]) -> bool:
        """Return whether a position is in the body or on it; a body without limits is none."""
        square = 0.0
        for name, (low, high, centre, radius) in self.axes.items():
            here = here_mm[name]
            if low != high and not low - SAME_MM <= here <= high + SAME_MM:
                return False
            if radius:
                square += ((here - centre) / radius) ** 2
        return bool(self.axes) and square <= 1.0 + SAME_MM


@dataclass
class SimulatedProbe:
    """The latch of one axis; mode and parameter: P-AXIS-00112 and 00145. body: of mode 6.

    places_mm: positions of the axis along the path, the first where it begins.
    """

    name: str
    mode: int
    parameter: int
    way: Way
    places_mm: Sequence[float]
    body: Body = field(default_factory=Body)
    is_armed: bool = False
    has_latched: bool = False
    latched_mm: float | None = None
    latched_speed_mm: float = field(init=False)
    doubt_mm: float | None = field(init=False)
    is_actuated: bool | None = field(init=False)
    is_prepared: bool = field(init=False)
    arrival: Arrival = field(default_factory=Arrival, init=False)
    _cycles: int = field(init=False)

    def __post_init__(self) -> None:
        self.latched_speed_mm, self.is_actuated, self.is_prepared = 0.0, None, True
        self.doubt_mm = None
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

    def look(self, axes_mm: Mapping[str, float], here_mm: Mapping[str, float]) -> None:
        """Signal or not, once in a cycle of the motion.

        axes_mm: positions of the axes. here_mm: the same place in the coordinates of targets.
        """
        self._cycles += 1
        if self.is_armed and not self.has_latched and self._signals(axes_mm, here_mm):
            self.has_latched, self.latched_mm = True, axes_mm[self.name]

    def _signals(self, axes_mm: Mapping[str, float], here_mm: Mapping[str, float]) -> bool:
        way, axis = self.way, self.name
        if self.mode == POSITION:
            position_mm = self.parameter / UNITS_PER_MM
            sign = towards(self.places_mm, position_mm)
            return sign * (axes_mm[axis] - position_mm) >= -SAME_MM
        if self.mode == CYCLES:
            return self._cycles >= self.parameter
        if self.mode == REST:
            start, target = way.start_mm[axis], way.target_mm.get(axis)
            left = 0.0 if target is None else abs(target - here_mm[axis]) / abs(target - start)
            return left * 100.0 < self.parameter
        if self.mode == BODY:
            return self.body.contains(axes_mm)
        if self.mode == ALL:
            return way.travelled_mm(here_mm) >= way.length_mm + way.offset_mm - SAME_MM
        return way.has_axis_at_target(here_mm)


def towards(places_mm: Sequence[float], position_mm: float) -> float:
    """Return in which direction an axis reaches a position, 1 or -1.

    places_mm: of the axis along its path. It is that of the first time, and for a position that is
    nowhere on the path that of the path as a whole.
    """
    start_mm, end_mm = places_mm[0], places_mm[-1]
    if start_mm != position_mm and min(places_mm) <= position_mm <= max(places_mm):
        return copysign(1.0, position_mm - start_mm)
    return 1.0 if end_mm >= start_mm - SAME_MM else -1.0
