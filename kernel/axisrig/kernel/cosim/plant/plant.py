"""The plants of a rig: FMUs, how they are wired, and who steps how far.

Axes are stepped first, then the sensors over the same step: a sensor reads positions only, so it
needs the trajectory of the step and no iteration. Steps are long where no edge can be and fine
where one can; a fine step with an edge is repeated in parts (docs/architecture.md, "How exact is
an edge").
"""

from collections.abc import Callable, Mapping, Sequence
from math import isclose, lcm
from typing import Final

from axisrig.kernel.cosim.fmi.fmu import FmuSlave, PlantError
from axisrig.kernel.cosim.fmi.roles import Roles, map_roles
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.distance import FOLLOW_NS, PlantDistance
from axisrig.kernel.cosim.plant.edges import make_probe
from axisrig.kernel.cosim.plant.grid import GridAxis
from axisrig.kernel.cosim.plant.probe import PlantProbe
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US, S, TimeNs

DEFAULT_EXCHANGE_NS: Final = 20 * MS
DEFAULT_FINE_NS: Final = 50 * US
PARTS: Final = 16
"""Into how many parts a step with an edge is divided: 3 us of the default 50."""
DIVISIONS: Final = 2
"""How often it is divided; the second time only for several edges of one direction, or where a
velocity is a numeric derivative."""
SHORTEST_DIVIDED_NS: Final = 1 * US
# A step that goes further than at its higher end speed; the share is for a motion that swings in it
_JUMP: Final = 2.0
_ROUNDING_M: Final = 1e-7


class Plant:
    """All plant FMUs of a rig under one time.

    exchange_ns: longest step. fine_ns: step where an edge can be; `initialize` shortens it to whole
    internal steps of the axes, so that they integrate over the same grid whatever the steps are.
    hold_ns, look_back_ns: around an edge, what the drives look up in the motion. notes: what an
    FMU lacks, by instance, and what is done without it; remarks: what else a user should read.
    """

    def __init__(
        self,
        exchange_ns: TimeNs = DEFAULT_EXCHANGE_NS,
        fine_ns: TimeNs = DEFAULT_FINE_NS,
        hold_ns: TimeNs = 0,
        look_back_ns: TimeNs = 0,
    ) -> None:
        self.exchange_ns = exchange_ns
        self.fine_ns = min(fine_ns, exchange_ns)
        self._hold_ns, self._look_back_ns = hold_ns, look_back_ns
        self._follows_always = exchange_ns <= fine_ns
        self._can_repeat = self._derives_velocity = self._walks = False
        self.now_ns: TimeNs = 0
        self.notes: dict[str, list[str]] = {}
        self.remarks: dict[str, list[str]] = {}
        self.axes: dict[str, PlantAxis] = {}
        self.probes: dict[str, PlantProbe] = {}
        self.distances: dict[str, PlantDistance] = {}
        self._axes: list[PlantAxis] = []
        self._probes: list[PlantProbe] = []
        self._distances: list[PlantDistance] = []

    def add_axis(
        self, slave: FmuSlave, roles: Roles | None = None, second_encoder: str | None = None
    ) -> PlantAxis:
        """Add an axis; roles: None = its variables have the names of the roles.

        second_encoder: name of what the second encoder of its drive reads, a distance sensor of
        this plant (it may be added later) or an axis of it, whose load it then is; None = there is
        no such encoder. Raises UserError when its FMU lacks what an axis needs.
        """
        known, second = roles or map_roles(slave, "axis", {}), self._reader(second_encoder)
        axis = (
            PlantAxis(known, self.advance_to, None, second)
            if slave.grid_ns is None
            else GridAxis(known, self.advance_to, second)
        )
        self.axes[slave.name] = axis
        return axis

    def add_axis_beside(
        self, name: str, first: str, roles: Roles, second_encoder: str | None = None
    ) -> PlantAxis:
        """Add a further axis of an FMU that moves several, as a gantry does.

        first: name of the axis that was added with this FMU. second_encoder: as for `add_axis`.
        Raises UserError where the FMU does not follow ramps by itself: it gets its demands for all
        axes at once.
        """
        beside = self.axes[first]
        if roles.slave.grid_ns is not None or not (
            roles.has_group("ramp") and beside.roles.has_group("ramp")
        ):
            raise UserError(
                f"plant {name} shares the FMU of {first}, which must take steps of any length"
                " and its demand by reference_position, _velocity, _time, _end",
                value=name,
            )
        second = self._reader(second_encoder)
        self.axes[name] = PlantAxis(roles, self.advance_to, beside, second, name)
        return self.axes[name]

    def _reader(self, name: str | None) -> Callable[[], float] | None:
        """Return what reads an encoder at the load of an axis, or at a sensor."""
        if name is None:
            return None

        def read() -> float:
            axis = self.axes.get(name)
            return self.distances[name].distance_m if axis is None else axis.position_m()

        return read

    def add_probe(
        self, slave: FmuSlave, sources: Mapping[str, str], roles: Roles | None = None
    ) -> PlantProbe:
        """Add a touch probe; sources: coordinate of the FMU -> instance name of an axis.

        Raises UserError for an unknown axis, or when its FMU lacks what a probe needs.
        """
        wired = self._wired(slave, sources)
        probe = make_probe(roles or map_roles(slave, "probe", {}, list(sources)), wired)
        probe.hold_ns, probe.look_back_ns = self._hold_ns, self._look_back_ns
        self.probes[slave.name] = probe
        return probe

    def add_distance(
        self, slave: FmuSlave, sources: Mapping[str, str], roles: Roles | None = None
    ) -> PlantDistance:
        """Add a distance sensor; arguments and errors as `add_probe`."""
        wired = self._wired(slave, sources)
        found = roles or map_roles(slave, "distance", {}, list(sources))
        self.distances[slave.name] = PlantDistance(found, wired)
        return self.distances[slave.name]

    def _wired(self, slave: FmuSlave, sources: Mapping[str, str]) -> dict[str, PlantAxis]:
        for group, name in sources.items():
            if name not in self.axes:
                raise UserError(
                    f"plant {slave.name}: input {group} is wired to an unknown axis",
                    value=name,
                    allowed=self.axes,
                )
        return {group: self.axes[name] for group, name in sources.items()}

    def initialize(self, start_ns: TimeNs = 0) -> None:
        """Initialise axes first, then the sensors at the axes' positions."""
        self.now_ns = start_ns
        self._axes, self._probes = list(self.axes.values()), list(self.probes.values())
        self._distances = list(self.distances.values())
        for axis in self.axes.values():
            axis.start(start_ns)
        for probe in self.probes.values():
            probe.start(start_ns)
        for sensor in self.distances.values():
            sensor.start(start_ns)
        if self.distances:
            self.exchange_ns = min(self.exchange_ns, FOLLOW_NS)
        can_walk = all(sensor.walks for sensor in self._distances)
        self._walks = can_walk and bool(self._distances) and not self._probes
        self.fine_ns = self._whole_steps_ns(self.fine_ns)
        for axis in self._axes:
            axis.fine_ns = self.fine_ns
        self._can_repeat = all(axis.slave.can.can_save_state for axis in self.axes.values())
        self._derives_velocity = not all(axis.tells_velocity for axis in self.axes.values())
        if self._derives_velocity:
            self._follows_always = True  # a numeric derivative is no base to reckon ahead from

    def _whole_steps_ns(self, fine_ns: TimeNs) -> TimeNs:
        """Return the longest span up to `fine_ns` that is whole internal steps of every axis.

        An axis that gives none, or one that is no whole nanosecond or too long, does not count.
        """
        fixed_steps_s = [axis.slave.can.fixed_step_s or 0.0 for axis in self._axes]
        steps_ns = [round(step_s * S) for step_s in fixed_steps_s]
        common_ns = lcm(
            *[
                step_ns
                for step_ns, step_s in zip(steps_ns, fixed_steps_s, strict=True)
                if 0 < step_ns <= fine_ns and isclose(step_ns, step_s * S, rel_tol=1e-9)
            ]
        )
        return fine_ns // common_ns * common_ns or fine_ns

    def advance_to(self, time_ns: TimeNs) -> None:
        """Advance every FMU to `time_ns`; nothing happens when they are there already."""
        if self.now_ns >= time_ns:
            return
        if self._walks:
            self._walk(time_ns)
        while self.now_ns < time_ns:
            self._step(time_ns)
        for sensor in self._distances:
            sensor.look()

    def _walk(self, time_ns: TimeNs) -> None:
        """Do all steps to `time_ns`, each FMU in one call: nothing but distance sensors looks."""
        end_ns, ends_ns = self.now_ns, []
        while end_ns < time_ns:
            end_ns += self._span_ns(time_ns - end_ns)
            ends_ns.append(end_ns)
        for axis in self._axes:
            axis.walk(ends_ns)
        for sensor in self._distances:
            sensor.walk(self.now_ns, ends_ns)
        self.now_ns = end_ns

    def _step(self, limit_ns: TimeNs) -> None:
        """Take one step, as far as it may go but not past `limit_ns`."""
        end_ns = self.now_ns + self._span_ns(limit_ns - self.now_ns)
        near: list[PlantProbe] = []
        for probe in self._probes:
            if self._follows_always or probe.free_until_ns < end_ns:
                near.append(probe)
        if near:
            can_repeat = self._can_repeat and all(p.slave.can.can_save_state for p in near)
            self._follow(end_ns, near, DIVISIONS if can_repeat else 0)
        else:
            for axis in self._axes:
                axis.step_to(end_ns)
            self._measure(end_ns)
        self.now_ns = end_ns
        for probe in self._probes:
            if probe not in near:
                probe.passed_over(end_ns)

    def _span_ns(self, rest_ns: TimeNs) -> TimeNs:
        """Return how far the next step goes: to the end, or over whole fine steps before it."""
        fine_ns = self.fine_ns
        span_ns = rest_ns
        if self._follows_always:
            return min(rest_ns, fine_ns)
        if rest_ns > self.exchange_ns:
            span_ns = self.exchange_ns // fine_ns * fine_ns
        for probe in self._probes:
            free_ns = probe.look_ahead(self.now_ns, span_ns) - self.now_ns
            if free_ns < span_ns:
                span_ns = max(free_ns // fine_ns * fine_ns, min(fine_ns, rest_ns))
        return span_ns

    def _follow(self, end_ns: TimeNs, near: Sequence[PlantProbe], divisions: int) -> None:
        """Take a step that these probes follow; divide it when an edge comes, or more than one.

        An edge is found once more in short parts, so that what bends the motion between two points
        of a fine step (a stop, a limit of the drive) does not move it.
        """
        begin_ns = self.now_ns
        plants: list[PlantAxis | PlantProbe] = [*self.axes.values(), *near]
        span_ns = end_ns - begin_ns
        can_divide = divisions > 0 and span_ns >= SHORTEST_DIVIDED_NS
        if can_divide:
            for plant in plants:
                plant.save()
        edges = self._move(end_ns, near)
        if edges:
            for axis in self._axes:
                refuse_held_outputs(axis, begin_ns, end_ns)
        is_enough = divisions < DIVISIONS and edges <= 1 and not self._derives_velocity
        if can_divide and edges and not is_enough:
            for plant in plants:
                plant.restore()
            for index in range(1, PARTS + 1):
                self._follow(begin_ns + span_ns * index // PARTS, near, divisions - 1)
            return
        for probe in near:
            probe.accept(span_ns)
        self._measure(end_ns)
        self.now_ns = end_ns

    def _measure(self, end_ns: TimeNs) -> None:
        """Let distance sensors follow a step that is not repeated any more."""
        for sensor in self._distances:
            sensor.step(self.now_ns, end_ns)

    def _move(self, end_ns: TimeNs, near: Sequence[PlantProbe]) -> int:
        """Step axes, then these probes; return how many edges of one kind came, the most."""
        for axis in self._axes:
            axis.step_to(end_ns)
        return max(probe.step(self.now_ns, end_ns) for probe in near)

    def close(self) -> None:
        """Free every instance."""
        for axis in self.axes.values():
            axis.slave.close()
        for probe in self.probes.values():
            probe.slave.close()
        for sensor in self.distances.values():
            sensor.slave.close()


def refuse_held_outputs(axis: PlantAxis, begin_ns: TimeNs, end_ns: TimeNs) -> None:
    """Raise PlantError where the last step of an axis, in which an edge came, is none of its own.

    Its position stood still although it has a speed, or jumped further than its speeds allow: the
    FMU steps inside more coarsely than it is asked to, as a container of other FMUs may.
    """
    begin_m, begin_m_s, end_m, end_m_s = axis.tick
    span_s, moved_m = (end_ns - begin_ns) * 1e-9, end_m - begin_m
    highest_m_s = max(abs(begin_m_s), abs(end_m_s))
    is_held = moved_m == 0.0 and begin_m_s == end_m_s and highest_m_s * span_s > _ROUNDING_M
    is_jump = abs(moved_m) > _JUMP * highest_m_s * span_s + _ROUNDING_M
    if is_held or is_jump:
        raise PlantError(
            axis.name,
            end_ns,
            f"its position moved by {moved_m * 1e6:.3g} um in a step of {span_s * 1e6:g} us with an"
            f" edge, at {highest_m_s * 1e3:.3g} mm/s: it steps inside more coarsely than that;"
            " `axisrig fmu check` says how coarsely, set fine_us and exchange_us in [cycle] to it,"
            " or export it with a shorter step",
        )
