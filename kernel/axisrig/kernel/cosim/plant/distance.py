"""A distance sensor of the plant: it follows the motion of axes and reports a distance."""

from collections import deque
from collections.abc import Mapping, Sequence
from typing import Final

from axisrig.kernel.cosim.fmi.library import PlantError
from axisrig.kernel.cosim.fmi.roles import Roles
from axisrig.kernel.cosim.fmi.steps import StepsInARow, offers_steps, plain_references
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.edges import Trajectory
from axisrig.kernel.cosim.plant.outputs import HISTORY_STEPS, POSITION
from axisrig.kernel.time.clock import S, TimeNs

Reported = tuple[float, float | None, bool, bool]


TOOL = (
    "distance_along",
    *("clamping_x", "clamping_y", "clamping_z"),
    *("tcp_x", "tcp_y", "tcp_z"),
    *("virtual_length", "tilt"),
)
"""What a sensor at an inclined tool says besides, in m and rad."""


def _place(role: str, roles: Sequence[str]) -> int:
    return roles.index(role) if role in roles else -1


FOLLOW_NS: Final = 250_000
"""Longest step of a plant with distance sensors: over it the cubic between the ends of a step
is within 1 nm of the motion, across an acceleration jump of 1000 mm/s2 (docs/architecture.md)."""


class PlantDistance:
    """A distance sensor, wired to axes.

    roles: what its FMU gives. sources: coordinate of the FMU (`x`) -> the axis whose load position
    it reads. An FMU with plain positions sees those at the end of a step. distance_m: what the
    sensor reports; distance_true_m: None when the FMU does not report it. is_valid, is_touching:
    True and False when it does not report them.
    """

    def __init__(self, roles: Roles, sources: Mapping[str, PlantAxis]) -> None:
        self.roles, self.slave = roles, roles.slave
        self.distance_m = 0.0
        self.distance_true_m: float | None = None
        self.is_valid, self.is_touching = True, False
        self._past: deque[tuple[TimeNs, Reported]] = deque(maxlen=HISTORY_STEPS)
        self._tool = roles.exchange(TOOL) if roles.has_group("tool") else None
        self._tools: deque[tuple[TimeNs, list[float]]] = deque(maxlen=HISTORY_STEPS)
        self._sources = list(sources.values())
        self._trajectory = Trajectory(roles, sources) if roles.has_group("trajectory") else None
        if self._trajectory is None:
            self._positions = roles.exchange([f"{group}_position" for group in sources])
        self._has_true = roles.has("distance_true")
        self._lengths = roles.exchange(["distance", *["distance_true"] * self._has_true])
        self._levels = [role for role in ("valid", "touching") if roles.has(role)]
        self._flags = roles.exchange(self._levels) if self._levels else None
        self._valid_at = _place("valid", self._levels)
        self._touching_at = _place("touching", self._levels)
        self._many: StepsInARow | None = None
        self._row: list[float] | None = None  # of `_lengths`, when the last walk has read them

    def start(self, start_ns: TimeNs) -> None:
        """Initialise the FMU where the axes are."""
        self.slave.time_ns = start_ns
        if self._trajectory is not None:
            self._trajectory.write_rest(start_ns, start_ns + S)
        else:
            self._write_positions()
        self.slave.initialize(start_ns)
        if self._trajectory is not None and offers_steps(self.slave):
            inputs = plain_references([self._trajectory.inputs])
            lengths = plain_references([self._lengths])
            if inputs is not None and lengths is not None:
                self._many = StepsInARow(self.slave, inputs, lengths)
        self.look()

    def step(self, begin_ns: TimeNs, end_ns: TimeNs) -> None:
        """Follow the axes over [begin_ns, end_ns], their last step; `look` reads the result."""
        if self._trajectory is not None:
            self._trajectory.write_step(begin_ns, end_ns)
        else:
            self._write_positions()
        self.slave.step_to(end_ns)

    def walk(self, begin_ns: TimeNs, ends_ns: Sequence[TimeNs]) -> None:
        """Follow the last walk of the axes, which began at `begin_ns`; only where `walks`."""
        assert self._many is not None
        assert self._trajectory is not None
        done = self._many.take(ends_ns, self._trajectory.rows(begin_ns, ends_ns))
        if len(done) < len(ends_ns):
            self._many.refuse(ends_ns[len(done)])
        self._row = done[-1]

    @property
    def walks(self) -> bool:
        """Whether the FMU can take several steps in one call."""
        return self._many is not None

    def reported_at(self, time_ns: TimeNs) -> Reported:
        """Return distance, true distance, validity and touch at an instant at which `look` was."""
        for end_ns, report in reversed(self._past):
            if end_ns <= time_ns:
                return report
        raise PlantError(self.slave.name, time_ns, "no distance is kept for this instant")

    @property
    def has_tool(self) -> bool:
        """Whether it is at an inclined tool and reports where that is."""
        return self._tool is not None

    def tool_at(self, time_ns: TimeNs) -> list[float]:
        """Return the values of TOOL at an instant at which `look` was; only where `has_tool`."""
        for end_ns, values in reversed(self._tools):
            if end_ns <= time_ns:
                return values
        raise PlantError(self.slave.name, time_ns, "no place of the tool is kept for this instant")

    def _write_positions(self) -> None:
        self._positions.values[:] = [axis.motion[POSITION] for axis in self._sources]
        self._positions.write()

    def look(self) -> None:
        """Read what the sensor reports now; for `reported_at` too."""
        row, self._row = self._row, None
        if row is None:
            self._lengths.read()
            row = self._lengths.values[:]
        self.distance_m = row[0]
        if self._has_true:
            self.distance_true_m = row[1]
        if self._flags is not None:
            self._flags.read()
            levels = self._flags.values[:]
            if self._valid_at >= 0:
                self.is_valid = bool(levels[self._valid_at])
            if self._touching_at >= 0:
                self.is_touching = bool(levels[self._touching_at])
        report = (self.distance_m, self.distance_true_m, self.is_valid, self.is_touching)
        self._past.append((self.slave.time_ns, report))
        if self._tool is not None:
            self._tool.read()
            self._tools.append((self.slave.time_ns, self._tool.values[:]))
