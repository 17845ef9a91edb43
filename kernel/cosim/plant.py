"""The plants of a rig: FMUs, how they are wired, and who steps first.

Axes are stepped first over an exchange step (the drive tick), then every sensor over the same
step: a sensor reads positions only, so it needs the trajectory of the step and no iteration.
A trajectory is handed over as position and velocity at both ends; inside the sensor it is a cubic
Hermite polynomial, whose error over 0.25 ms across an acceleration step of 1000 mm/s2 is
0.0162 * 1000 * 0.00025**2 = 0.001 um (docs/architecture.md, "How exact is an edge").
"""

import struct
from bisect import bisect_right
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kernel.clock import US, TimeNs, seconds_to_ns
from kernel.cosim.fmu import Exchange, FmuSlave, PlantError
from kernel.errors import UserError

AXIS_INPUTS = ("reference_position", "reference_velocity", "reference_time", "reference_end")
AXIS_OUTPUTS = (
    "position",
    "velocity",
    "motor_position",
    "motor_velocity",
    "demand_position",
)
TRAJECTORY_INPUTS = ("start", "rate_start", "end", "rate_end")
DEFAULT_EXCHANGE_NS = 250 * US
HISTORY_TICKS = 2048


def hermite(time_s: float, step_s: float, ends: tuple[float, float, float, float]) -> float:
    """Evaluate the cubic Hermite polynomial at `time_s` of a step of `step_s`.

    ends: value and slope at the begin, value and slope at the end (unit, unit/s).
    Source: any text on interpolation; error |x''''| h^4 / 384 for a smooth motion.
    """
    x0, v0, x1, v1 = ends
    u = time_s / step_s
    w = 1.0 - u
    return (
        w * w * (1.0 + 2.0 * u) * x0
        + u * u * (3.0 - 2.0 * u) * x1
        + step_s * u * w * (w * v0 - u * v1)
    )


class PlantAxis:
    """A servo axis of the plant as the drive in front of it sees it (SI units).

    Holds the last 2048 drive ticks of the motion, so that a latch up to half a second old can be
    looked up.
    """

    def __init__(self, slave: FmuSlave, plant: "Plant") -> None:
        self.slave, self._plant = slave, plant
        self._inputs = Exchange(slave, AXIS_INPUTS)
        self._enabled = Exchange(slave, ["enabled"])
        self.outputs = Exchange(slave, AXIS_OUTPUTS)
        self.tick = (0.0, 0.0, 0.0, 0.0)
        self.kv_per_s = 0.0
        self._times: deque[TimeNs] = deque(maxlen=HISTORY_TICKS)
        self._motion: deque[list[float]] = deque(maxlen=HISTORY_TICKS)

    def start(self, start_ns: TimeNs) -> None:
        """Initialise the FMU; `kv_per_s` is the gain of its position loop, 0 when it tells none."""
        self.slave.initialize(start_ns)
        self.kv_per_s = self.slave.get("kv") if self.slave.has("kv") else 0.0
        self.sample()

    def sample(self) -> None:
        """Read the outputs at the present time into the history."""
        self.outputs.read()
        self._times.append(self.slave.time_ns)
        self._motion.append(self.outputs.values[:])

    def step_to(self, end_ns: TimeNs) -> None:
        """Step the FMU; `tick` then holds load position and velocity at both ends."""
        begin = self._motion[-1]
        self.slave.step_to(end_ns)
        self.sample()
        end = self._motion[-1]
        self.tick = (begin[0], begin[1], end[0], end[1])

    def advance_to(self, time_ns: TimeNs) -> None:
        """Bring the whole plant to `time_ns`."""
        self._plant.advance_to(time_ns)

    def command(
        self,
        time_ns: TimeNs,
        position_m: float,
        velocity_m_s: float,
        end_ns: TimeNs,
        enabled: bool,
    ) -> None:
        """Give the demand from `time_ns` on: a ramp from `position_m` that ends at `end_ns`."""
        values = self._inputs.values
        values[0], values[1], values[2], values[3] = (
            position_m,
            velocity_m_s,
            time_ns * 1e-9,
            end_ns * 1e-9,
        )
        self._inputs.write()
        if self._enabled.values[0] != enabled:
            self._enabled.values[0] = enabled
            self._enabled.write()

    def position_m(self) -> float:
        """Return the load position now: the truth, which no drive ever sees."""
        return self._motion[-1][0]

    def motor_position_m(self) -> float:
        """Return what the motor encoder sees now, in load units."""
        return self._motion[-1][2]

    def motor_velocity_m_s(self) -> float:
        """Return the motor velocity now, in load units."""
        return self._motion[-1][3]

    def demand_position_m(self) -> float:
        """Return the demand that the position controller of the drive follows now."""
        return self._motion[-1][4]

    def motor_position_m_at(self, time_ns: TimeNs) -> float:
        """Return the motor position at a past instant, by cubic Hermite inside its drive tick."""
        after = bisect_right(self._times, time_ns)
        if after == 0 or time_ns > self._times[-1]:
            raise PlantError(self.slave.name, time_ns, "no motion is recorded for this instant")
        begin_ns, begin = self._times[after - 1], self._motion[after - 1]
        if after == len(self._times) or begin_ns == time_ns:
            return begin[2]
        end = self._motion[after]
        step_s = (self._times[after] - begin_ns) * 1e-9
        ends = (begin[2], begin[3], end[2], end[3])
        return hermite((time_ns - begin_ns) * 1e-9, step_s, ends)


class PlantSignal:
    """The switching output of a probe: its level and every edge, located inside the step.

    edges: (time_ns, new level), oldest first, grows during the run.
    """

    def __init__(self, level: bool) -> None:
        self.level = level
        self.edges: list[tuple[TimeNs, bool]] = []

    def add(self, time_ns: TimeNs, level: bool) -> None:
        """Append an edge."""
        self.edges.append((time_ns, level))
        self.level = level


@dataclass(frozen=True)
class Contact:
    """The plant's own truth of a touch: when the gap closed and where the axes were (mm)."""

    time_ns: TimeNs
    position_mm: Mapping[str, float]


class PlantProbe:
    """A touch probe of the plant, fed with the trajectories of the axes it is wired to."""

    COUNTS = ("rising_count", "falling_count", "contact_count")
    TIMES = ("rising_time", "falling_time", "contact_time")

    def __init__(self, slave: FmuSlave, sources: Mapping[str, PlantAxis]) -> None:
        """sources: input group of the FMU (`x`) -> the axis whose load position it reads."""
        self.slave = slave
        self.sources = list(sources.values())
        names = ["step_time", "step_size"]
        names += [f"{group}_{part}" for group in sources for part in TRAJECTORY_INPUTS]
        self._inputs = Exchange(slave, names)
        self._counts = Exchange(slave, self.COUNTS)
        self._pack = struct.Struct(f"={len(names)}d").pack_into  # ten assignments in one call
        self._last_counts = [0, 0, 0]
        self._times = Exchange(slave, self.TIMES)
        self._contact = Exchange(slave, [f"contact_{group}" for group in sources])
        self.signal = PlantSignal(False)
        self.contacts: list[Contact] = []

    def hold(self) -> None:
        """Hand over the present positions as a trajectory at rest (initialisation)."""
        values = self._inputs.values
        values[0], values[1] = self.slave.time_ns * 1e-9, 1.0
        for index, axis in enumerate(self.sources):
            x = axis.outputs.values[0]
            values[2 + 4 * index : 6 + 4 * index] = [x, 0.0, x, 0.0]
        self._inputs.write()

    def start(self) -> None:
        """Take the level that the initialisation found."""
        level = Exchange(self.slave, ["signal"])
        level.read()
        self.signal.level = bool(level.values[0])
        self._counts.read()
        self._last_counts = self._counts.values[:]

    def step(self, begin_ns: TimeNs, end_ns: TimeNs, motion: Sequence[float]) -> None:
        """Step over [begin_ns, end_ns].

        motion: per source position and velocity at the begin and at the end, m and m/s.
        """
        self._pack(self._inputs.values, 0, begin_ns * 1e-9, (end_ns - begin_ns) * 1e-9, *motion)
        self._inputs.write()
        self.slave.step_to(end_ns)
        self._counts.read()
        counts = self._counts.values[:]
        if counts != self._last_counts:
            self._collect(counts)
            self._last_counts = counts

    def _collect(self, counts: list[int]) -> None:
        new = [now - last for now, last in zip(counts, self._last_counts, strict=True)]
        if max(new) > 1:
            raise PlantError(
                self.slave.name,
                self.slave.time_ns,
                f"{max(new)} edges of one direction inside one exchange step, only the last is "
                "known; choose a smaller exchange_us in the rig",
            )
        self._times.read()
        rising_s, falling_s, contact_s = self._times.values
        edges = [(seconds_to_ns(rising_s), True)] * new[0]
        edges += [(seconds_to_ns(falling_s), False)] * new[1]
        for time_ns, level in sorted(edges):
            self.signal.add(time_ns, level)
        if new[2]:
            self._contact.read()
            where = {
                axis.slave.name: value * 1e3
                for axis, value in zip(self.sources, self._contact.values, strict=True)
            }
            self.contacts.append(Contact(seconds_to_ns(contact_s), where))


class Plant:
    """All plant FMUs of a rig under one time.

    exchange_ns: longest step over which axes and sensors exchange their trajectories.
    """

    def __init__(self, exchange_ns: TimeNs = DEFAULT_EXCHANGE_NS) -> None:
        self.exchange_ns = exchange_ns
        self.now_ns: TimeNs = 0
        self.axes: dict[str, PlantAxis] = {}
        self.probes: dict[str, PlantProbe] = {}

    def add_axis(self, slave: FmuSlave) -> PlantAxis:
        """Add an axis; UserError when its FMU lacks a variable of the axis interface."""
        axis = PlantAxis(slave, self)
        self.axes[slave.name] = axis
        return axis

    def add_probe(self, slave: FmuSlave, sources: Mapping[str, str]) -> PlantProbe:
        """Add a touch probe; sources: input group -> instance name of an axis."""
        for group, name in sources.items():
            if name not in self.axes:
                raise UserError(
                    f"plant {slave.name}: input {group} is wired to an unknown axis",
                    value=name,
                    allowed=self.axes,
                )
        wired = {group: self.axes[name] for group, name in sources.items()}
        probe = PlantProbe(slave, wired)
        self.probes[slave.name] = probe
        return probe

    def initialize(self, start_ns: TimeNs = 0) -> None:
        """Initialise axes first, then the sensors at the axes' positions."""
        self.now_ns = start_ns
        for axis in self.axes.values():
            axis.start(start_ns)
        for probe in self.probes.values():
            probe.slave.time_ns = start_ns
            probe.hold()
            probe.slave.initialize(start_ns)
            probe.start()

    def advance_to(self, time_ns: TimeNs) -> None:
        """Advance every FMU to `time_ns` in equal steps of at most `exchange_ns`."""
        begin_ns = self.now_ns
        span_ns = time_ns - begin_ns
        if span_ns <= 0:
            return
        count = -(-span_ns // self.exchange_ns)
        for index in range(1, count + 1):
            self._step(begin_ns + span_ns * index // count)

    def _step(self, end_ns: TimeNs) -> None:
        for axis in self.axes.values():
            axis.step_to(end_ns)
        for probe in self.probes.values():
            motion: list[float] = []
            for axis in probe.sources:
                motion += axis.tick
            probe.step(self.now_ns, end_ns, motion)
        self.now_ns = end_ns

    def close(self) -> None:
        """Free every instance."""
        for axis in self.axes.values():
            axis.slave.close()
        for probe in self.probes.values():
            probe.slave.close()
