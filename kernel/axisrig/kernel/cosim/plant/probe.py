"""A touch probe of the plant: what it gets of the motion, and the edges it gives.

A probe follows the motion only where an edge can be. Elsewhere it rests, and the bench reckons how
far the axes may go before they could use up the `clearance` that it reported last.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import hypot, sqrt
from typing import Final

from axisrig.kernel.cosim.fmi.fmu import EdgeMayBeLostError, FmuState, PlantError
from axisrig.kernel.cosim.fmi.roles import Roles
from axisrig.kernel.cosim.fmi.slave import Exchange
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.outputs import POSITION, VELOCITY
from axisrig.kernel.time.clock import MS, S, TimeNs

SPEED_GAIN_M_S2: Final = 500.0
"""By how much an axis gains speed at most. Linear motors without load reach 300 m/s2; a stop or a
collision brakes harder, but only drives speed an axis up."""


WORTH: Final = 2
"""How many times longer a step must be able to become, for a probe to be asked for it."""
SUPPLY = "switched_on"
SWITCHING_NS: Final = MS
"""For how long a probe is followed after it was switched; from then on its clearance decides."""
FAR_M: Final = 1e3
"""A clearance that needs no better number, also when an FMU reports infinity."""


class PlantSignal:
    """The switching output of a probe: its level and every edge, located inside the step.

    edges: (time_ns, new level), oldest first, grows during the run. watches: called with the
    instant of each edge when the plant has been stepped over it; they change nothing.
    """

    def __init__(self, level: bool) -> None:
        self.level = level
        self.edges: list[tuple[TimeNs, bool]] = []
        self.watches: list[Callable[[TimeNs], None]] = []

    def add(self, time_ns: TimeNs, level: bool) -> None:
        """Append an edge."""
        self.edges.append((time_ns, level))
        self.level = level
        for watch in self.watches:
            watch(time_ns)


@dataclass(frozen=True)
class Contact:
    """The plant's own truth of a touch: when the gap closed and where the axes were (mm)."""

    time_ns: TimeNs
    position_mm: Mapping[str, float]


def free_s(room_m: float, speed_m_s: float, gain_m_s2: float) -> float:
    """Return how long a motion surely takes for a way of `room_m`.

    That is t in v t + a t^2/2 = room: the speed now is v and grows by at most a.
    """
    if room_m <= 0.0:
        return 0.0
    return 2.0 * room_m / (speed_m_s + sqrt(speed_m_s * speed_m_s + 2.0 * gain_m_s2 * room_m))


class PlantProbe(ABC):
    """A touch probe of the plant, wired to axes.

    roles: what its FMU gives. sources: coordinate of the FMU (`x`) -> the axis whose load position
    it reads. edge_uncertainty_ns: how well the instants of edges and contacts are known.
    free_until_ns: no edge before. hold_ns: for how long after an edge the motion is needed in fine
    steps, because a drive latches then; look_back_ns: how long before. is_switched_on: as the PLC
    has ordered it last, at the start as its FMU has it.
    """

    edge_uncertainty_ns: float

    def __init__(self, roles: Roles, sources: Mapping[str, PlantAxis]) -> None:
        self.roles, self.slave = roles, roles.slave
        self.sources = list(sources.values())
        self.signal = PlantSignal(False)
        self.contacts: list[Contact] = []
        self.hold_ns = self.look_back_ns = 0
        self.free_until_ns: TimeNs = 0
        self._signal = roles.exchange(["signal"])
        self._has_clearance = roles.has("clearance")
        self._hold_until_ns: TimeNs = 0
        self._gain_m_s2 = SPEED_GAIN_M_S2 * sqrt(len(self.sources))
        # As they were when free_until_ns was found
        self._seen_ns: TimeNs = 0
        self._clearance_m = self._room_m = self._moved_m = self._speed_m_s = 0.0
        self._places_m = [0.0] * len(self.sources)
        self._saved: FmuState | None = None
        self.is_switched_on, self.is_supply_held = True, False

    # What differs: how the motion is handed over and how edges are found

    @abstractmethod
    def _write_rest(self, begin_ns: TimeNs, end_ns: TimeNs) -> None:
        """Give the FMU axes that rest where they are, over a step."""

    @abstractmethod
    def _read_start(self) -> None:
        """Read what the initialisation found."""

    @abstractmethod
    def _read_clearance_m(self) -> float:
        """Read the clearance of an FMU that has one."""

    @abstractmethod
    def _has_new_edges(self) -> bool:
        """Return whether an edge came that was not accepted."""

    @abstractmethod
    def step(self, begin_ns: TimeNs, end_ns: TimeNs) -> int:
        """Follow the axes over [begin_ns, end_ns], their last step.

        Return how many edges came, the most of one kind; `accept` takes them.
        """

    @abstractmethod
    def _take_edges(self) -> None:
        """Append the edges of the last step to `signal`, and its contacts to `contacts`."""

    # At rest

    def start(self, start_ns: TimeNs) -> None:
        """Initialise the FMU where the axes are; the level it finds is no edge."""
        self.slave.time_ns = start_ns
        self._write_rest(start_ns, start_ns + S)
        self.slave.initialize(start_ns)
        self._signal.read()
        self.signal.level = bool(self._signal.values[0])
        if self.can_be_switched():
            self.is_switched_on = bool(self.slave.get(SUPPLY))
        self._read_start()
        self._look()

    def _look(self) -> None:
        if self._has_clearance:
            self._clearance_m = min(max(0.0, self._read_clearance_m()), FAR_M)
            self._places_m = [axis.motion[POSITION] for axis in self.sources]

    # Where no edge can be

    def look_ahead(self, now_ns: TimeNs, wanted_ns: TimeNs) -> TimeNs:
        """Return `free_until_ns`, at least `wanted_ns` later if that can be known.

        Raises EdgeMayBeLostError when an axis has gained speed faster than SPEED_GAIN_M_S2.
        """
        if self.free_until_ns < now_ns + wanted_ns:
            self.free_until_ns = now_ns
            if self._has_clearance and now_ns >= self._hold_until_ns:
                free_ns = self._free_ns(now_ns)
                is_behind = free_ns < wanted_ns and self.slave.time_ns < now_ns
                if is_behind and self._hoped_ns() >= min(wanted_ns, WORTH * free_ns):
                    self._catch_up(now_ns)
                    free_ns = self._free_ns(now_ns)
                self.free_until_ns += max(free_ns, 0)
        return self.free_until_ns

    def _free_ns(self, now_ns: TimeNs) -> TimeNs:
        moved = [
            axis.motion[POSITION] - x for axis, x in zip(self.sources, self._places_m, strict=True)
        ]
        self._seen_ns, self._moved_m = now_ns, hypot(*moved)
        self._room_m = self._clearance_m - self._moved_m
        self._speed_m_s = hypot(*[axis.motion[VELOCITY] for axis in self.sources])
        if self._room_m < 0.0:
            self._bound_is_broken(now_ns)
        return int(free_s(self._room_m, self._speed_m_s, self._gain_m_s2) * S) - self.look_back_ns

    def _hoped_ns(self) -> TimeNs:
        """Return what `_free_ns` would be if all of the way since the last look led away."""
        room_m = self._clearance_m + self._moved_m
        return int(free_s(room_m, self._speed_m_s, self._gain_m_s2) * S) - self.look_back_ns

    def _catch_up(self, now_ns: TimeNs) -> None:
        """Advance the FMU to now, at rest where the axes are: no edge is between."""
        self._write_rest(self.slave.time_ns, now_ns)
        self.slave.step_to(now_ns)
        if self._has_new_edges():
            raise PlantError(
                self.slave.name, now_ns, "an edge came where its clearance said that none can be"
            )
        self._look()

    def passed_over(self, now_ns: TimeNs) -> None:
        """Check that a step without this probe was what `look_ahead` reckoned with."""
        since_s = (now_ns - self._seen_ns) * 1e-9
        limit_m_s = self._speed_m_s + self._gain_m_s2 * since_s
        square = 0.0
        for axis in self.sources:
            speed_m_s = axis.motion[VELOCITY]
            square += speed_m_s * speed_m_s
        if square > limit_m_s * limit_m_s and sqrt(square) * since_s > self._room_m:
            self._bound_is_broken(now_ns)

    def _bound_is_broken(self, now_ns: TimeNs) -> None:
        names = ", ".join(axis.name for axis in self.sources)
        raise EdgeMayBeLostError(
            self.slave.name,
            now_ns,
            f"an edge may be lost: {names} gained more speed than {SPEED_GAIN_M_S2:g} m/s2 near an"
            " edge; set exchange_us in [cycle] to the value of fine_us",
        )

    # Its supply

    def can_be_switched(self) -> bool:
        """Whether its FMU has an input `switched_on`."""
        return SUPPLY in self.slave.names("input")

    def switch(self, is_on: bool, now_ns: TimeNs) -> None:
        """Switch its supply; the plants are at `now_ns`. It is followed until its output rests.

        While the supply is held (`is_supply_held`) the order is kept in `is_switched_on` alone.
        """
        if self.is_switched_on is is_on:
            return
        self.is_switched_on = is_on
        if self.is_supply_held:
            return
        self.wake(now_ns)
        supply = Exchange(self.slave, [SUPPLY])
        supply.values[0] = is_on
        supply.write()

    def wake(self, now_ns: TimeNs) -> None:
        """Follow it from now on: an input changes. The plants are at `now_ns`."""
        if self.slave.time_ns < now_ns:
            self._catch_up(now_ns)
        self.free_until_ns, self._hold_until_ns = now_ns, now_ns + SWITCHING_NS

    # Where an edge can be

    def save(self) -> None:
        """Keep the present state for `restore`; the FMU must be able to."""
        self._saved = self.slave.save_state(self._saved)

    def restore(self) -> None:
        """Go back to where `save` was called last; a step since then must not be accepted yet."""
        assert self._saved is not None
        self.slave.restore_state(self._saved)

    def accept(self, step_ns: TimeNs) -> None:
        """Take the edges of the last step, which was of this length."""
        known = len(self.signal.edges)
        self._take_edges()
        if len(self.signal.edges) > known:
            self._hold_until_ns = self.signal.edges[-1][0] + self.hold_ns
            if not all(axis.tells_velocity for axis in self.sources):
                # Only the ends of the step are known, not how the axes go between them
                self.edge_uncertainty_ns = max(self.edge_uncertainty_ns, float(step_ns))
        self._look()
