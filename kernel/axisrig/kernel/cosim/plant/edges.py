"""How the edges of a probe are found: reported by its FMU, or by looking at its level.

An FMU that gets the trajectory of a step and reports the instants of its edges locates them itself.
Any other one is asked for its level: where it changes the step is repeated from the saved state
until the instant is enclosed; without saved states the step remains the uncertainty.
"""

import struct
from collections.abc import Mapping, Sequence
from typing import Final

from axisrig.kernel.cosim.fmi.fmu import FmuState, PlantError
from axisrig.kernel.cosim.fmi.roles import Roles
from axisrig.kernel.cosim.fmi.steps import StepsInARow, offers_steps, plain_references
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.curves import hermite
from axisrig.kernel.cosim.plant.outputs import POSITION, VELOCITY
from axisrig.kernel.cosim.plant.probe import Contact, PlantProbe
from axisrig.kernel.time.clock import TimeNs, seconds_to_ns

TRAJECTORY_INPUTS = ("start", "rate_start", "end", "rate_end")
COUNTS = ("rising_count", "falling_count", "contact_count")
TIMES = ("rising_time", "falling_time", "contact_time")
ENCLOSED_NS: Final = 1


def make_probe(roles: Roles, sources: Mapping[str, PlantAxis]) -> PlantProbe:
    """Make the kind of probe that the roles of the FMU allow."""
    tells_edges = roles.has_group("trajectory") and roles.has_group("edges")
    return LocatingProbe(roles, sources) if tells_edges else LevelProbe(roles, sources)


class Trajectory:
    """Hands over position and velocity at both ends of a step; the FMU interpolates.

    inputs: where a row of `rows` is written to.
    """

    def __init__(self, roles: Roles, sources: Mapping[str, PlantAxis]) -> None:
        names = ["step_time", "step_size"]
        names += [f"{group}_{part}" for group in sources for part in TRAJECTORY_INPUTS]
        self._sources = list(sources.values())
        self.inputs = self._inputs = roles.exchange(names)
        self._pack = struct.Struct(f"={len(names)}d").pack_into  # ten assignments in one call

    def write(self, begin_ns: TimeNs, end_ns: TimeNs, motion: Sequence[float]) -> None:
        """Hand over a step; motion: per source position and velocity at its begin and its end."""
        self._pack(self._inputs.values, 0, begin_ns * 1e-9, (end_ns - begin_ns) * 1e-9, *motion)
        self._inputs.write()

    def write_rest(self, begin_ns: TimeNs, end_ns: TimeNs) -> None:
        """Hand over a step in which the axes rest where they are."""
        motion: list[float] = []
        for axis in self._sources:
            place = axis.motion[POSITION]
            motion += (place, 0.0, place, 0.0)
        self.write(begin_ns, end_ns, motion)

    def rows(self, begin_ns: TimeNs, ends_ns: Sequence[TimeNs]) -> list[float]:
        """Return the inputs of each step of the last walk of the axes, one step after the other."""
        values: list[float] = []
        for number, end_ns in enumerate(ends_ns):
            values += (begin_ns * 1e-9, (end_ns - begin_ns) * 1e-9)
            for axis in self._sources:
                begin, end = axis.walked[number], axis.walked[number + 1]
                values += (begin[POSITION], begin[VELOCITY], end[POSITION], end[VELOCITY])
            begin_ns = end_ns
        return values

    def write_step(self, begin_ns: TimeNs, end_ns: TimeNs) -> None:
        """Hand over the last step of the axes."""
        self._pack(self._inputs.values, 0, *self.row(begin_ns, end_ns))
        self._inputs.write()

    def row(self, begin_ns: TimeNs, end_ns: TimeNs) -> list[float]:
        """Return the inputs of the last step of the axes."""
        values = [begin_ns * 1e-9, (end_ns - begin_ns) * 1e-9]
        for axis in self._sources:
            values += axis.tick
        return values


class LocatingProbe(PlantProbe):
    """A probe whose FMU gets the trajectory of a step and reports number and instant of edges."""

    def __init__(self, roles: Roles, sources: Mapping[str, PlantAxis]) -> None:
        super().__init__(roles, sources)
        self.edge_uncertainty_ns = float(ENCLOSED_NS)
        self._trajectory = Trajectory(roles, sources)
        kinds = 3 if roles.has_group("contact") else 2
        self._counts = roles.exchange(COUNTS[:kinds])
        self._seen = [0] * kinds
        clearance = ["clearance"] * self._has_clearance
        self._results = roles.exchange([*TIMES[:kinds], *clearance])
        places = [f"contact_{group}" for group in sources]
        self._places = roles.exchange(places) if kinds == 3 else None
        self._many: StepsInARow | None = None
        self._row: list[float] | None = None  # of `_results`, when the last step has read them

    def _write_rest(self, begin_ns: TimeNs, end_ns: TimeNs) -> None:
        self._row = None
        self._trajectory.write_rest(begin_ns, end_ns)

    def _read_start(self) -> None:
        self._counts.read()
        self._seen = self._counts.values[:]
        inputs = plain_references([self._trajectory.inputs])
        results = plain_references([self._results])
        if inputs is not None and results is not None and offers_steps(self.slave):
            self._many = StepsInARow(self.slave, inputs, results)

    def _read_results(self) -> list[float]:
        row = self._row
        if row is None:
            self._results.read()
            row = self._results.values[:]
        return row

    def _read_clearance_m(self) -> float:
        return self._read_results()[-1]

    def _has_new_edges(self) -> bool:
        self._counts.read()
        return bool(self._counts.values[:] != self._seen)

    def step(self, begin_ns: TimeNs, end_ns: TimeNs) -> int:
        """Follow the axes over one step."""
        if self._many is None:
            self._trajectory.write_step(begin_ns, end_ns)
            self.slave.step_to(end_ns)
        else:
            rows = self._many.take([end_ns], self._trajectory.row(begin_ns, end_ns))
            if not rows:
                self._many.refuse(end_ns)
            self._row = rows[0]
        self._counts.read()
        counts: list[int] = self._counts.values[:]
        if counts == self._seen:
            return 0
        return max(now - seen for now, seen in zip(counts, self._seen, strict=True))

    def _take_edges(self) -> None:
        counts: list[int] = self._counts.values[:]
        if counts == self._seen:
            return
        new = [now - seen for now, seen in zip(counts, self._seen, strict=True)]
        self._seen = counts
        if max(new) > 1:
            raise PlantError(
                self.slave.name,
                self.slave.time_ns,
                f"{max(new)} edges of one direction inside one step, only the last is known; choose"
                " a smaller fine_us in the rig",
            )
        times_ns = [seconds_to_ns(time_s) for time_s in self._read_results()[: len(new)]]
        edges = [(times_ns[0], True)] * new[0] + [(times_ns[1], False)] * new[1]
        for time_ns, level in sorted(edges):
            self.signal.add(time_ns, level)
        if self._places is not None and new[2]:
            self._places.read()
            where = {
                axis.name: value * 1e3
                for axis, value in zip(self.sources, self._places.values, strict=True)
            }
            self.contacts.append(Contact(times_ns[2], where))


class LevelProbe(PlantProbe):
    """A probe whose FMU reports its level only, or gets positions instead of trajectories.

    A position is handed over as it is at the end of a step, so that the level then belongs to it. A
    level that changes back inside a step is not seen. `edge_uncertainty_ns` is the worst so far: 1
    where the instant was enclosed, or where an FMU that has the trajectory returned early at it;
    else the longest step in which it was followed. That holds also where time alone changes the
    level: an FMU that delays what it sees has seen a position since the beginning of its step.
    """

    def __init__(self, roles: Roles, sources: Mapping[str, PlantAxis]) -> None:
        super().__init__(roles, sources)
        self.edge_uncertainty_ns = float(ENCLOSED_NS)
        self._trajectory = None
        if roles.has_group("trajectory"):
            self._trajectory = Trajectory(roles, sources)
        else:
            self._positions = roles.exchange([f"{group}_position" for group in sources])
        self._clearance = roles.exchange(["clearance"]) if self._has_clearance else None
        self._can_enclose = self.slave.can.can_save_state and self.slave.can.can_vary_step
        self._begin_state: FmuState | None = None
        self._step_ns: tuple[TimeNs, TimeNs] = (0, 1)
        self._longest_ns = 0.0
        self._new: list[tuple[TimeNs, bool, float]] = []

    def _write_rest(self, begin_ns: TimeNs, end_ns: TimeNs) -> None:
        if self._trajectory is not None:
            self._trajectory.write_rest(begin_ns, end_ns)
        else:
            self._positions.values[:] = [axis.motion[POSITION] for axis in self.sources]
            self._positions.write()

    def _read_start(self) -> None:
        pass

    def _read_clearance_m(self) -> float:
        assert self._clearance is not None
        self._clearance.read()
        clearance_m: float = self._clearance.values[0]
        return clearance_m

    def _has_new_edges(self) -> bool:
        return self._level() != self.signal.level

    def _level(self) -> bool:
        self._signal.read()
        return bool(self._signal.values[0])

    def step(self, begin_ns: TimeNs, end_ns: TimeNs) -> int:
        """Follow the axes over one step; look for the edges in it."""
        self._step_ns, self._new = (begin_ns, end_ns), []
        self._longest_ns = max(self._longest_ns, float(end_ns - begin_ns))
        if self._trajectory is not None:
            self._trajectory.write_step(begin_ns, end_ns)
        level = self.signal.level
        for _ in self.slave.parts_to(end_ns):
            level = self._step_or_edge(end_ns, level)
        rising = sum(is_high for _, is_high, _ in self._new)
        return max(rising, len(self._new) - rising)

    def _step_or_edge(self, end_ns: TimeNs, level: bool) -> bool:
        """Step towards `end_ns`, not past the next edge; return the level there."""
        begin_ns = self.slave.time_ns
        if self._can_enclose:
            self._begin_state = self.slave.save_state(self._begin_state)
        stand_ns = self._go(end_ns)
        if self._level() == level:
            return level
        is_exact = self._trajectory is not None and stand_ns < end_ns
        if self._can_enclose:
            stand_ns, is_of_time = self._enclose(begin_ns, stand_ns, level)
            is_exact = self._trajectory is not None or not is_of_time
        uncertainty_ns = float(ENCLOSED_NS)
        if not is_exact:
            fixed_ns = (self.slave.can.fixed_step_s or 0.0) * 1e9
            uncertainty_ns = max(self._longest_ns, fixed_ns, float(self.slave.grid_ns or 0))
        self._new.append((stand_ns, not level, uncertainty_ns))
        return not level

    def _enclose(self, low_ns: TimeNs, high_ns: TimeNs, level: bool) -> tuple[TimeNs, bool]:
        """Find the change of the level in (low_ns, high_ns], 1 ns apart; stop at it.

        Return its instant, and whether time alone changed the level. Starts from `_begin_state`.
        """
        assert self._begin_state is not None
        while high_ns - low_ns > ENCLOSED_NS:
            middle_ns = (low_ns + high_ns) // 2
            self.slave.restore_state(self._begin_state)
            self._go_to(middle_ns)
            if self._level() == level:
                low_ns = middle_ns
                self._begin_state = self.slave.save_state(self._begin_state)
            else:
                high_ns = middle_ns
        self.slave.restore_state(self._begin_state)
        self.slave.step_to(high_ns)  # with the position as it was
        is_of_time = self._level() != level
        self.slave.restore_state(self._begin_state)
        self._go_to(high_ns)
        return high_ns, is_of_time

    def _go(self, end_ns: TimeNs) -> TimeNs:
        if self._trajectory is None:
            begin_ns, last_ns = self._step_ns
            time_s, step_s = (end_ns - begin_ns) * 1e-9, (last_ns - begin_ns) * 1e-9
            self._positions.values[:] = [
                axis.motion[POSITION] if end_ns == last_ns else hermite(time_s, step_s, axis.tick)
                for axis in self.sources
            ]
            self._positions.write()
        return self.slave.step_towards(end_ns)

    def _go_to(self, end_ns: TimeNs) -> None:
        for _ in self.slave.parts_to(end_ns):
            self._go(end_ns)

    def _take_edges(self) -> None:
        for time_ns, level, uncertainty_ns in self._new:
            self.signal.add(time_ns, level)
            self.edge_uncertainty_ns = max(self.edge_uncertainty_ns, uncertainty_ns)
        self._new = []
