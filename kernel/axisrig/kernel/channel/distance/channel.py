"""3D distance control: the one control of a channel, over its kinematic (FCT-M3 12).

It owns what the control of an axis owns, a `DistanceControl` and a sensor; its offset goes through
a `Guide` to the axes. The PLC side gives the orthogonal distance h of the tool clamping point from
the surface, positive. The control counts as that of an axis, sensor = -h, so that the surface is at
n times the clamping point plus sensor in every mode.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Final, NamedTuple

from axisrig.kernel.channel.distance.guide import (
    ACS,
    LEAST_COSINE,
    MCS,
    STEEPEST_DEG,
    AxisGuide,
    Guide,
    Positions,
    StayingGuide,
    ToolGuide,
)
from axisrig.kernel.channel.distance.sensing import NO_SECOND_ENCODER, Sensing
from axisrig.kernel.channel.distance.sensor import (
    SECOND_ENCODER,
    VARIABLE,
    Sensor,
    SensorSettings,
    VariableSensor,
)
from axisrig.kernel.channel.distance.settings import ChannelDistanceSettings
from axisrig.kernel.distance import DistanceCommand, DistanceControl, DistanceState, Reading
from axisrig.kernel.distance.limiter import UNLIMITED, AxesAllow
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import Kinematic, Vector
from axisrig.kernel.plc.unit import Refreshed
from axisrig.kernel.time.clock import S, TimeNs

OWNER = "the channel"
MODE_CHANGED: Final = 310025
NO_KINEMATIC, NO_DIRECTION, OTHER_GUIDE, TOO_STEEP, OTHER_LENGTH, UNFIT_TIME = (
    900460,
    900461,
    900462,
    900463,
    900464,
    900465,
)
# A rate below it is the rounding of a kinematic
STILL: Final = 1e-7
# Two guides that put an axis this near to each other do the same
SAME_MM: Final = 1e-6
MACHINE_Z: Vector = (0.0, 0.0, 1.0)
ORIGIN: Vector = (0.0, 0.0, 0.0)


class AxisPositions(NamedTuple):
    """Positions of an axis in a cycle: without the offset, with it, as sent, actual."""

    base_mm: float
    superposed_mm: float
    set_mm: float
    actual_mm: float


class ChannelDistance(Sensing):
    """The 3D distance control of a channel.

    limits: what every axis may do, mm/s and mm/s2. links: in the same order, those of the kinematic
    first. kinematic: gives the active one, None without. values: V.E. variables, by the name after
    `V.E.`; refreshed: those that come with a period.

    guide: where the offset acts, None while nothing says it; fixed from ON until the control is
    INACTIVE without an offset. moved: axes that the offset moves in the present pose. allowed: what
    they allow it. deltas_mm: what was superposed in the last cycle, by axis. output_step_mm: change
    of the offset that was sent. logged_events: alarms of its cycles.
    """

    def __init__(
        self,
        settings: ChannelDistanceSettings,
        limits: Sequence[AxesAllow],
        links: Sequence[Drive],
        kinematic: Callable[[], Kinematic | None],
        values: Mapping[str, float],
        refreshed: Mapping[str, Refreshed],
        period_ns: TimeNs,
    ) -> None:
        self.settings = settings
        self._links, self._kinematic = tuple(links), kinematic
        self.names = tuple(link.name for link in links)
        self._limits = dict(zip(self.names, limits, strict=True))
        self._values, self._refreshed = values, refreshed
        super().__init__(
            DistanceControl(OWNER, settings.control, period_ns),
            VariableSensor("", values, SensorSettings(), refreshed),
            period_ns,
            None,
            is_optimized=settings.is_optimized,
            increment_mm=max(1.0 / link.settings.increments_per_mm for link in links),
        )
        self.guide: Guide | None = None
        self.moved: tuple[str, ...] = ()
        self.allowed = UNLIMITED
        self.deltas_mm: dict[str, float] = {}
        self.output_step_mm = 0.0
        self.logged_events = 0
        self._mode: str | None = None  # as programmed
        self._direction: str | None = None
        self._normal, self._origin_mm = MACHINE_Z, ORIGIN
        self._base: Positions | None = None  # set positions before the offset, of the last cycle
        self._fault: Alarm | None = None  # of the kinematic on the way to the axes
        self._was_steep = False
        self._sent: Positions = ()

    @property
    def wanted_mode(self) -> str:
        """The mode: without MODE it is MCS with a kinematic, else ACS."""
        return self._mode or (ACS if self._kinematic() is None else MCS)

    @property
    def next_mode(self) -> str | None:
        """The mode of the next ON; None while it is off and the program has said nothing."""
        return None if self._mode is None and self.is_idle else self.wanted_mode

    @property
    def period_s(self) -> float:
        """The cycle of the control."""
        return self._period_ns / S

    @property
    def wanted_axis(self) -> str | None:
        """The axis of DIRECTION."""
        return self._direction

    def lengthening_mm(self) -> float:
        """Return by how much the tool is virtually extended; 0 without a kinematic."""
        kinematic = self._kinematic()
        if kinematic is None:
            return 0.0
        tool = kinematic.forward(self._actual()[: kinematic.count])
        return kinematic.length_mm(tool) - kinematic.nominal_length_mm(tool)

    @property
    def is_licensed(self) -> bool:
        """Whether the option is there that `#DIST CTRL` needs."""
        return self.settings.is_licensed

    @property
    def plane(self) -> str | None:
        """In which coordinates the offset may change now; None while no axis offset changes."""
        return self.guide.mode if self.guide is not None and self.is_moving else None

    # Sensor

    def sensor_for(self, source: str, variable: str | None) -> Sensor:
        """Return the variable of the PLC side; 3D control has no second encoder."""
        if source != VARIABLE:
            raise Alarm(NO_SECOND_ENCODER, owner=OWNER, source=SECOND_ENCODER)
        settings = SensorSettings(ref_offset_mm=self.settings.ref_offset_mm)
        return VariableSensor(variable or "", self._values, settings, self._refreshed)

    def read_mm(self) -> float | None:
        """Return -h."""
        height_mm = self.sensor.read_mm()
        return None if height_mm is None else -height_mm

    # What the program says

    def plan(self, mode: str | None, direction: str | None, normal: Vector, origin: Vector) -> None:
        """Take MODE and DIRECTION, None where they are not programmed, and the active #CS.

        Raises Alarm 310025 for another mode while control is on.
        """
        before = self._mode, self._direction
        self._mode, self._direction = mode or self._mode, direction or self._direction
        guide = self.guide
        if (mode or direction) and guide is not None and not self.is_idle:
            programmed = _shown(self.wanted_mode, self._direction)
            current = _shown(guide.mode, guide.axes[0])
            if programmed != current:
                self._mode, self._direction = before
                raise Alarm(MODE_CHANGED, owner=OWNER, current=current, programmed=programmed)
        self._normal, self._origin_mm = normal, origin

    def parameters(self, given: Mapping[str, float | str]) -> dict[str, float | str]:
        """Return parameters as the control has them: FILTER_TIME as a number of cycles.

        Raises Alarm 900465 for a time that is not at least one cycle.
        """
        found = dict(given)
        time_s = found.pop("filter_time_s", None)
        if time_s is not None:
            cycles = round(float(time_s) * S / self._period_ns)
            if cycles < 1:
                cycle_s = self._period_ns / S
                raise Alarm(UNFIT_TIME, owner=OWNER, value_s=time_s, cycle_s=cycle_s)
            found["n_cycles"] = cycles
        return found

    def prepare(self, wanted: DistanceCommand) -> Alarm | None:
        """Fix the guide before control is switched on; return a warning of its tool length.

        Raises Alarm 900460 for a mode without kinematic, 900461 for ACS without axis, 900462 when
        an offset is there that acts elsewhere, 900463 for a tool that leans too much.
        """
        guide = self._wanted_guide()
        if guide is None:
            mode = self.wanted_mode
            if mode == ACS:
                raise Alarm(NO_DIRECTION, axes=" ".join(self.names))
            raise Alarm(NO_KINEMATIC, mode=mode)
        if self._would_jump(guide):
            offset_mm = round(self.control.offset_mm, 6)
            raise Alarm(OTHER_GUIDE, owner=OWNER, mode=guide.mode, offset_mm=offset_mm)
        cosine = guide.cosine(self._actual())
        if cosine < LEAST_COSINE:
            raise self._steep(cosine)
        self.guide = guide
        self.look()
        is_constant = wanted is DistanceCommand.ON_CONST_DIST
        return self._length_warning() if is_constant and guide.mode != ACS else None

    def set_distance(self, set_dist_mm: float) -> Alarm | None:
        """Take SET_DIST; return a warning of the tool length for a change while it acts."""
        control, guide = self.control, self.guide
        is_change = set_dist_mm != control.set_dist_mm
        control.set_distance(set_dist_mm)
        if control.state is not DistanceState.ACTIVE_CONST_DIST or not is_change:
            return None
        return None if guide is None or guide.mode == ACS else self._length_warning()

    def _would_jump(self, guide: Guide) -> bool:
        """Whether the offset that is there would move the axes if it acted by another guide."""
        present = self.guide
        if self.is_idle or present is None or guide.is_same(present):
            return False
        base, offset_mm = self._base or self._actual(), self.output_mm
        before, after = (g.superposed(base, offset_mm) for g in (present, guide))
        return any(abs(a - b) > SAME_MM for a, b in zip(before, after, strict=True))

    def _wanted_guide(self) -> Guide | None:
        mode, kinematic = self.wanted_mode, self._kinematic()
        if mode == ACS:
            axis = self._direction
            return None if axis is None else AxisGuide(axis, self.names.index(axis))
        if kinematic is None:
            return None
        return ToolGuide(mode, kinematic, self.names, self._normal, self._origin_mm)

    def _length_warning(self) -> Alarm | None:
        kinematic, set_dist_mm = self._kinematic(), self.control.set_dist_mm
        if kinematic is None or set_dist_mm is None:
            return None
        tool = kinematic.forward(self._actual()[: kinematic.count])
        length_mm = kinematic.nominal_length_mm(tool)
        if length_mm > 0 and math.isclose(length_mm, set_dist_mm, abs_tol=1e-6):
            return None
        return Alarm(
            OTHER_LENGTH,
            owner=OWNER,
            set_dist_mm=f"{set_dist_mm:g}",
            length_mm=f"{length_mm:g}",
        )

    def may_move(self, axes: Iterable[str]) -> bool:
        """Whether the offset can move one of these axes."""
        return self.guide is not None and not set(axes).isdisjoint(self.guide.axes)

    def switch_off_kept(self) -> None:
        """Follow no more, with the offset kept; ERROR stays."""
        if self.control.state is not DistanceState.ERROR:
            self.control.switch_off_kept()

    def end_program(self) -> None:
        """Keep the offset and follow no more (FCT-M3 12.4.4); what was programmed is forgotten."""
        self.switch_off_kept()
        self.forget()

    def forget(self) -> None:
        """Forget set values, mode and direction."""
        self.control.forget_set_values()
        self._mode = self._direction = None

    # Each cycle

    def look(self) -> None:
        """Find which axes the offset moves in the present pose, and what they allow it."""
        if self.is_idle:
            self.guide = self._kept_or_new()
        guide = self.guide
        if guide is None:
            self.moved, self.allowed = (), UNLIMITED
            return
        if isinstance(guide, AxisGuide):
            self.moved, self.allowed = guide.axes, UNLIMITED
            return
        base = self._base or tuple(link.set_mm for link in self._links)
        try:
            rates = guide.rates(base)
        except Alarm as alarm:
            self._fault, self.moved = alarm, guide.axes
            return
        by_axis = {a: abs(r) for a, r in zip(guide.axes, rates, strict=True) if abs(r) > STILL}
        self.moved = tuple(by_axis)
        self.allowed = AxesAllow(
            min((self._limits[a].v_mm_s / r for a, r in by_axis.items()), default=math.inf),
            min((self._limits[a].a_mm_s2 / r for a, r in by_axis.items()), default=math.inf),
        )

    def _kept_or_new(self) -> Guide | None:
        new = self._wanted_guide()
        if new is not None and self.guide is not None and new.is_same(self.guide):
            return self.guide
        return new

    @property
    def axes_share(self) -> float:
        """How much of its speed and acceleration the axes leave the offset, at most 1."""
        settings = self.control.settings
        v = self.allowed.v_mm_s / settings.v_max_mm_s
        return min(1.0, v, self.allowed.a_mm_s2 / settings.a_mm_s2)

    @property
    def has_surface(self) -> bool:
        """Whether something says along which normal the surface counts."""
        return self.guide is not None

    @property
    def shown_sensor_mm(self) -> float:
        """The distance as the PLC gives it, less ref_offset and what REF has made 0."""
        return self.control.sensor_mm * self.control.settings.sensor_sign

    def positions_of(self, axis: str) -> AxisPositions:
        """Return the positions of an axis in the present cycle."""
        at = self.names.index(axis)
        link = self._links[at]
        base_mm = link.set_mm if self._base is None else self._base[at]
        superposed_mm = base_mm + self.deltas_mm.get(axis, 0.0)
        return AxisPositions(base_mm, superposed_mm, link.set_mm, link.actual_mm)

    def _actual(self) -> Positions:
        return tuple(link.actual_mm for link in self._links)

    def step(self) -> None:
        """Control with the values of this cycle; raises the alarms of the control."""
        if self.guide is None:
            self._listen()
            return
        try:
            self._step(self.guide)
        except Alarm:
            self.logged_events += 1
            raise

    def _listen(self) -> None:
        """Take the sensor value for REF: any axis that moves may change it."""
        sent = tuple(link.set_mm for link in self._links)
        if sent != self._sent:
            self.control.forget_readings()
        self._sent = sent
        if self.sensor_mm is not None:
            self.control.listen(self.sensor_mm)

    def _step(self, guide: Guide) -> None:
        actual, sent = self._actual(), tuple(link.set_mm for link in self._links)
        self._check(guide, actual)
        if self.sensor_mm is None:
            return
        if guide.mode != ACS and sent != self._sent:
            self.control.forget_readings()
        self._sent = sent
        shorter_mm = (self.control.set_dist_mm or 0.0) * (1.0 - guide.shortening(actual))
        reading = Reading(
            self.sensor_mm,
            guide.height_mm(actual),
            guide.height_mm(sent),
            self.is_held,
            self.silence(),
            self.override,
            shorter_mm,
            self.allowed,
        )
        self.control_within_limits(reading)

    def _check(self, guide: Guide, actual: Positions) -> None:
        """Hold the offset where the kinematic cannot follow, or where the tool leans too much."""
        fault, self._fault = self._fault, None
        cosine = guide.cosine(actual)
        is_steep = cosine < LEAST_COSINE and not self.is_idle
        if is_steep and not self._was_steep:
            fault = self._steep(cosine)
        self._was_steep = is_steep
        if fault is not None and not self.is_idle:
            self.control.fail(fault)

    def _steep(self, cosine: float) -> Alarm:
        angle_deg = round(math.degrees(math.acos(max(min(cosine, 1.0), -1.0))), 4)
        return Alarm(TOO_STEEP, owner=OWNER, angle_deg=angle_deg, limit_deg=STEEPEST_DEG)

    def superpose(self, positions: Positions) -> Positions:
        """Return set positions with the offset; to be called once per cycle, after everything else.

        Where the kinematic has no axes for it, they keep what was superposed before; the alarm
        comes in the next cycle.
        """
        before_mm = self.output_mm
        self._let_stay(before_mm)
        self._base = positions
        offset_mm = self.put_out()
        self.output_step_mm = offset_mm - before_mm
        if not offset_mm or self.guide is None:
            self.deltas_mm = {}
            return positions
        try:
            moved = self.guide.superposed(positions, offset_mm)
        except Alarm as alarm:
            self._fault = alarm
            kept = self.deltas_mm
            return tuple(p + kept.get(n, 0.0) for n, p in zip(self.names, positions, strict=True))
        pairs = zip(self.names, positions, moved, strict=True)
        self.deltas_mm = {name: after - before for name, before, after in pairs if after != before}
        return moved

    def _let_stay(self, offset_mm: float) -> None:
        """Let an offset whose kinematic has gone stay on the axes that it was sent to."""
        guide = self.guide
        if self.is_idle or not isinstance(guide, ToolGuide) or isinstance(guide, StayingGuide):
            return
        if guide.kinematic is not self._kinematic():
            self.guide = StayingGuide(guide, offset_mm, self.names, self.deltas_mm)

    def hand_over(self) -> Mapping[str, float]:
        """Return by axis what was superposed last: no offset is left."""
        kept, self.deltas_mm = self.deltas_mm, {}
        self.control.hand_over()
        self.forget_offset()
        return kept


def _shown(mode: str, axis: str | None) -> str:
    """Name a mode, ACS with its axis."""
    return f"{mode} {axis}" if mode == ACS and axis is not None else mode
