"""The coordinate systems of a channel, their shifts, and where its axes have been sent.

PCS   programmed coordinates of the active coordinate system.
ABS   PCS + all shifts of the axis, same coordinate system.
BASE  ABS through the stack of coordinate systems: axis coordinates, or while a kinematic is on
      the coordinates of the tool.
ACS   axis coordinates: BASE through the kinematic, the same without one.

Shifts take effect for an axis with its next absolute programming. A new coordinate system is
relative to the shifted one below it and begins without shifts; those programmed in it end with it.
A tool acts on top of whatever system is active.
Source: programming manual, G54 (206487307), G92 (206057739), G101, D (306370955), #CS (208480907).
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.nc.coordinates.circle import CircleWords, GeometryError, plane_arc
from axisrig.kernel.nc.coordinates.frames import MAIN_AXES, Array, Frame
from axisrig.kernel.nc.coordinates.kinematic import axis_positions, tool_coordinates
from axisrig.kernel.nc.coordinates.places import XY, Plane, main_places
from axisrig.kernel.nc.coordinates.shifts import Shifts
from axisrig.kernel.nc.coordinates.state import Arc, AxisState, Level, Measured
from axisrig.kernel.nc.coordinates.tools import Tool

# An axis whose target differs by less does not move: far below every encoder increment, far above
# the rounding of a turn there and back.
SAME_POSITION_MM = 1e-9
# 2^31 steps of 0.1 um (0.0001 deg): travel of an axis. TF5200 programming manual 15556764811
FARTHEST_MM = 214_748.3647


@dataclass
class Coordinates:
    """The coordinate systems of a channel and the position it has been sent to.

    axes: all axes, main axes first. acs_mm: where every axis is. tool: data of the tool in
    use, a copy that may be written. plane: of circles, and where the length of the tool acts.
    kinematic: between BASE and ACS, None without; it works on the first axes.
    """

    axes: tuple[str, ...]
    acs_mm: dict[str, float]
    tool: Tool = field(default_factory=Tool)
    plane: Plane = XY
    kinematic: Kinematic | None = field(init=False, default=None)
    _base_mm: dict[str, float] = field(init=False)  # acs_mm itself without a kinematic
    _levels: list[Level] = field(init=False)
    _state: dict[str, AxisState] = field(init=False)
    _direction: dict[str, float] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        self._base_mm = self.acs_mm
        identity = Frame.identity()
        self._levels = [Level.begin(identity, identity, self._none())]
        self._places = main_places(self.axes)
        self._state = {}
        self._renew()

    def _none(self) -> dict[str, float]:
        return dict.fromkeys(self.axes, 0.0)

    # ---- what is in force

    @property
    def transformed(self) -> bool:
        """Whether a machining coordinate system is on."""
        return len(self._levels) > 1

    @property
    def main_axes(self) -> tuple[str, ...]:
        """The axes that a coordinate system turns."""
        return self.axes[:MAIN_AXES]

    @property
    def kinematic_axes(self) -> tuple[str, ...]:
        """The axes that the kinematic which is on contains; none without one."""
        return () if self.kinematic is None else self.axes[: self.kinematic.count]

    @property
    def common_axes(self) -> tuple[str, ...]:
        """The axes whose positions are converted together: one alone has no coordinate."""
        turned = self.main_axes if self.transformed else ()
        return tuple(dict.fromkeys((*turned, *self.kinematic_axes)))

    @property
    def origin_acs_mm(self) -> tuple[float, ...]:
        """Where the origin of the active coordinate system is, by main axis."""
        return tuple(float(part) for part in self._levels[-1].frame.offset_mm)

    @property
    def normal_acs(self) -> tuple[float, float, float]:
        """Z of the active coordinate system, a unit vector in those of the machine."""
        x, y, z = (float(part) for part in self._levels[-1].frame.rotation[:, 2])
        return (x, y, z)

    @property
    def zero_group(self) -> int:
        """The group of zero offsets in use; 0 without."""
        return self._levels[-1].zero_group

    def programmed_mm(self, axis: str) -> float:
        """Give V.A.PROG."""
        return self._state[axis].programmed_mm

    def absolute_mm(self, axis: str) -> float:
        """Give V.A.ABS."""
        return self._state[axis].absolute_mm

    def measurement_offset_mm(self, axis: str) -> float:
        """Give V.A.MEIN."""
        return self._levels[-1].measurement_mm[axis]

    def shifts(self, axis: str) -> Shifts:
        """Give the shifts that the next absolute programming of the axis takes."""
        level = self._levels[-1]
        return Shifts(
            carried_mm=level.carried_mm[axis],
            zero_mm=level.zero_mm[axis],
            reference_mm=level.reference_mm[axis],
            measurement_mm=level.measurement_mm[axis],
            tool_mm=self._tool_mm(axis),
        )

    # ---- coordinate systems

    def switch_on(self, frame: Frame) -> None:
        """Put a coordinate system on top of the active one, at its shifted origin."""
        carried = {axis: self.shifts(axis).system_mm for axis in self.axes}
        carried.update(dict.fromkeys(self.main_axes, 0.0))  # theirs are in the origin
        below = self._on_top(self._levels[-1])
        self._levels.append(Level.begin(frame, below.then(frame), carried))
        self._renew()

    def switch_off(self) -> None:
        """Take off the last coordinate system and the shifts programmed in it."""
        assert self.transformed, "no coordinate system is on"
        self._levels.pop()
        self._renew()

    def switch_off_all(self) -> None:
        """Take off all coordinate systems."""
        del self._levels[1:]
        self._renew()

    def redefine(self, depth: int, frame: Frame) -> None:
        """Change a coordinate system that is on (1: the lowest); shifts in it and above stay."""
        self._levels[depth].own = frame
        for below, level in zip(self._levels[depth - 1 :], self._levels[depth:], strict=False):
            level.frame = self._on_top(below).then(level.own)
        self._renew()

    def _on_top(self, level: Level) -> Frame:
        """Give the frame of a level with its shifts in the origin, but for the tool."""
        offset = [
            level.carried_mm[a] + level.zero_mm[a] + level.reference_mm[a] + level.measurement_mm[a]
            for a in self.main_axes
        ]
        offset += [0.0] * (MAIN_AXES - len(offset))
        return level.frame.then(Frame.shifted(offset))

    def use_kinematic(self, kinematic: Kinematic | None, acs_mm: Mapping[str, float]) -> None:
        """Program in the coordinates of the tool from here on, None: of the axes.

        acs_mm: where every axis is, as the position to begin with (position initialised).
        Raises Alarm for a pose that the kinematic refuses; nothing has changed then.
        """
        acs_mm = {axis: acs_mm[axis] for axis in self.axes}
        base_mm = tool_coordinates(self.axes, kinematic, acs_mm)
        if kinematic is not None:  # a pose that has no way back to the axes is refused here
            axis_positions(self.axes, kinematic, base_mm, acs_mm)
        self.kinematic, self.acs_mm, self._base_mm = kinematic, acs_mm, base_mm
        self._renew()

    # ---- shifts

    def select_zero(self, group: int, offsets_mm: Sequence[float]) -> None:
        """Take zero offsets into use (G53 to G59): one per axis, in their order."""
        level = self._levels[-1]
        level.zero_group = group
        level.zero_mm = dict(zip(self.axes, offsets_mm, strict=True))

    def write_zero(self, axis: str, offset_mm: float) -> None:
        """Change the zero offset in use of one axis (V.G.NP_AKT)."""
        self._levels[-1].zero_mm[axis] = offset_mm

    def shift_reference(self, axis: str, shift_mm: float, *, added: bool) -> None:
        """Set the reference point offset of an axis (G92), or add to it (in G91)."""
        shifts = self._levels[-1].reference_mm
        shifts[axis] = shifts[axis] + shift_mm if added else shift_mm

    def include_measurement(self, axis: str, shift_mm: float) -> None:
        """Set the measurement offset of an axis: G101; zero for G102."""
        self._levels[-1].measurement_mm[axis] = shift_mm

    def _tool_mm(self, axis: str) -> float:
        """Give what the tool adds to a coordinate of the active system.

        Length along the third axis of the plane, less the axis offsets. Source: TF5200 304765835
        (#TLAX [Z+] is the rule of G17), HLI 174744587 (ACS = PCS - TotalOffset, where the axis
        offsets of the tool count positive), P-TOOL-00010 (fixed tools). While a kinematic is on the
        tool is a part of it.
        """
        if axis in self.kinematic_axes:
            return 0.0
        main = self.main_axes
        if axis not in main or not (self.transformed and self.tool.fixed):
            return self._tool_of_axis_mm(axis)
        in_axes = np.array([self._tool_of_axis_mm(name) for name in main])
        turned = self._levels[-1].frame.rotation.T @ in_axes
        return float(turned[main.index(axis)])

    def _tool_of_axis_mm(self, axis: str) -> float:
        length_mm = self.tool.length_mm if axis == self._places[self.plane.third] else 0.0
        return length_mm - self.tool.offsets_mm.get(self.axes.index(axis), 0.0)

    # ---- moves

    def aim(self, programmed_mm: Mapping[str, float], *, absolute: bool) -> dict[str, float]:
        """Take the axis words of a move; return the new BASE of every axis that changes.

        absolute: G90, values are coordinates; otherwise distances from where the axis is.
        Raises GeometryError for a position that no axis can have.
        """
        before = self._main_abs()
        self._program(programmed_mm, absolute)
        self._take_direction(before)
        return self._go()

    def _take_direction(self, before: Mapping[str, float]) -> None:
        """Keep the direction of a move as a unit vector of the main axes.

        Axes that are not converted together keep theirs when they do not move: nobody asks for it,
        and an axis of its own may still be under way.
        """
        common = self.common_axes
        way = {axis: self._state[axis].absolute_mm - at for axis, at in before.items()}
        length = math.hypot(*way.values())
        for axis, part in way.items():
            if axis in common or abs(part) > SAME_POSITION_MM:
                self._direction[axis] = part / length if length > SAME_POSITION_MM else 0.0

    def aim_arc(
        self, programmed_mm: Mapping[str, float], words: CircleWords, *, absolute: bool
    ) -> Arc:
        """Take the words of an arc in the plane. Raises GeometryError for words that make none."""
        axes = self.plane_axes()
        start = self._in_plane(axes)
        height = self._main_abs()
        self._program(programmed_mm, absolute)
        words = self._with_centre(words, axes, start)
        plane = plane_arc(start, self._in_plane(axes), words)
        changed = self._go()
        moved = self.main_axes if self.transformed else axes
        target = {a: self._base_mm[a] for a in self.axes if a in moved or a in changed}
        centre = height | dict(zip(axes, plane.centre, strict=True))
        tangent = self._none() | dict(zip(axes, plane.tangent, strict=True))
        if self.transformed:
            frame = self._levels[-1].frame
            centre = self._by_axis(frame.down(self._vector(centre)))
            tangent = self._by_axis(frame.rotation @ self._vector(tangent))
        return Arc(
            target_mm=target,
            centre_mm={axis: centre[axis] for axis in moved},
            tangent={axis: tangent[axis] for axis in moved},
            angle_rad=abs(plane.angle_rad),
            plane=plane,
        )

    def plane_axes(self) -> tuple[str, str]:
        """Give the axes of the plane. Raises GeometryError where the rig has not both."""
        first, second = (self._places[at] for at in (self.plane.first, self.plane.second))
        if first is None or second is None:
            raise GeometryError(900152, plane=self.plane.g, axes=" ".join(self.axes))
        return first, second

    def centre_letters(self) -> tuple[str, str]:
        """Give the letters of the centre in the plane: I and J in G17."""
        return "IJK"[self.plane.first], "IJK"[self.plane.second]

    def _with_centre(
        self, words: CircleWords, axes: tuple[str, str], start: tuple[float, float]
    ) -> CircleWords:
        if words.centre is None:
            return words
        base = [self.shifts(a).total_mm for a in axes] if words.centre_absolute else start
        return replace(words, centre=(words.centre[0] + base[0], words.centre[1] + base[1]))

    def _in_plane(self, axes: tuple[str, str]) -> tuple[float, float]:
        return self._state[axes[0]].absolute_mm, self._state[axes[1]].absolute_mm

    def _main_abs(self) -> dict[str, float]:
        return {axis: self._state[axis].absolute_mm for axis in self.main_axes}

    def _program(self, programmed_mm: Mapping[str, float], absolute: bool) -> None:
        for axis, value_mm in programmed_mm.items():
            state = self._state[axis]
            if absolute:
                state.shifts = self.shifts(axis)
                state.absolute_mm = value_mm + state.shifts.total_mm
                state.programmed_mm = value_mm
            else:
                state.absolute_mm += value_mm
                state.programmed_mm = state.absolute_mm - state.shifts.total_mm

    def _go(self) -> dict[str, float]:
        target_mm = self._to_base({axis: self._state[axis].absolute_mm for axis in self.axes})
        for axis, position_mm in target_mm.items():
            if not abs(position_mm) <= FARTHEST_MM:  # also when it is no number
                raise GeometryError(
                    900156, axis=axis, value_mm=f"{position_mm:g}", limit_mm=FARTHEST_MM
                )
        changed = {
            axis: position_mm
            for axis, position_mm in target_mm.items()
            if abs(position_mm - self._base_mm[axis]) > SAME_POSITION_MM
        }
        self._base_mm.update(changed)
        if self.kinematic is not None and changed:
            self.acs_mm = axis_positions(self.axes, self.kinematic, self._base_mm, self.acs_mm)
        return changed

    @property
    def base_mm(self) -> dict[str, float]:
        """Where every axis has been sent, in BASE."""
        return dict(self._base_mm)

    def stops_mm(self, begin_mm: Mapping[str, float]) -> list[dict[str, float]]:
        """Give the places in BASE where the way from `begin_mm` to here has a kink of the axes.

        A path stops there, since an axis would change its speed at once (docs/kinematics.md).
        """
        kinematic, end_mm = self.kinematic, self._base_mm
        if kinematic is None:
            return []
        inside = self.kinematic_axes
        start, end = (tuple(place[axis] for axis in inside) for place in (begin_mm, end_mm))
        return [
            {a: at + (end_mm[a] - at) * share for a, at in begin_mm.items() if end_mm[a] != at}
            for share in kinematic.kinks(start, end)
        ]

    def stand_at(self, acs_mm: Mapping[str, float]) -> None:
        """Take over where axes really ended; what was programmed stays as it is."""
        self.acs_mm.update(acs_mm)
        self._base_mm = tool_coordinates(self.axes, self.kinematic, self.acs_mm)
        for axis, position_mm in self._from_base(self._base_mm).items():
            self._state[axis].absolute_mm = position_mm

    def begin_at(self, acs_mm: Mapping[str, float]) -> None:
        """Take over where axes are, as what was programmed for them (position initialised).

        Where positions are converted together the place of one axis is part of all coordinates.
        """
        self.stand_at(acs_mm)
        common = self.common_axes if acs_mm.keys() & set(self.common_axes) else ()
        self.take_as_target({*acs_mm, *common})

    def without_shifts_mm(self, acs_mm: Mapping[str, float], axis: str) -> float:
        """Give where an axis is in the active system without its shifts, from axis positions."""
        position_mm = self._from_acs(acs_mm)[axis]
        return position_mm - self._state[axis].shifts.total_mm

    def take_as_target(self, axes: Iterable[str]) -> None:
        """Let what was programmed for axes be where they are.

        Source: programming manual 206197003, G310 after the signal.
        """
        for axis in axes:
            state = self._state[axis]
            state.programmed_mm = state.absolute_mm - state.shifts.total_mm

    # ---- measured values

    def measured(
        self, latched_acs_mm: Mapping[str, float], *, ball_radius_mm: float = 0.0
    ) -> dict[str, Measured]:
        """Convert latched axis positions of the run just ended, with what was programmed for it.

        Axes that are converted together, the main axes under a coordinate system and all of a
        kinematic, need the latched values of all of them; without them none has a value.
        Formulas: MEAS.PCS = MESS - all shifts + ball radius in the direction of the run;
        MOFFS = MESS - PROG - zero shifts - tool.
        Source: FCT-C4 section 5, table of the variables; P-CHAN-00311.
        """
        usable = dict(latched_acs_mm)
        common = set(self.common_axes)
        if not usable.keys() >= common:
            usable = {a: v for a, v in usable.items() if a not in common}
        in_system_mm = self._from_acs({**self.acs_mm, **usable})
        values = {}
        for axis, acs_mm in usable.items():
            state, mess_mm = self._state[axis], in_system_mm[axis]
            shifts = state.shifts
            ball_mm = ball_radius_mm * self._direction.get(axis, 0.0)
            values[axis] = Measured(
                acs_mm=acs_mm,
                mess_mm=mess_mm,
                pcs_mm=mess_mm - shifts.total_mm + ball_mm,
                offset_mm=mess_mm - (shifts.zero_shifts_mm + shifts.tool_mm) - state.programmed_mm,
            )
        return values

    # ---- through the stack

    def _vector(self, position: Mapping[str, float]) -> Array:
        return np.array([position[axis] for axis in self.main_axes])

    def _by_axis(self, vector: Array) -> dict[str, float]:
        return dict(zip(self.main_axes, vector.tolist(), strict=True))

    def _to_base(self, absolute_mm: Mapping[str, float]) -> dict[str, float]:
        position = dict(absolute_mm)
        if self.transformed:
            lower = self._levels[-1].frame.down(self._vector(position))
            position.update(self._by_axis(lower))
        return position

    def _from_acs(self, acs_mm: Mapping[str, float]) -> dict[str, float]:
        if self.kinematic is None:
            return self._from_base(acs_mm)
        return self._from_base(
            tool_coordinates(self.axes, self.kinematic, {**self.acs_mm, **acs_mm})
        )

    def _from_base(self, base_mm: Mapping[str, float]) -> dict[str, float]:
        position = dict(base_mm)
        if self.transformed:
            upper = self._levels[-1].frame.up(self._vector(position))
            position.update(self._by_axis(upper))
        return position

    def _renew(self) -> None:
        """Express where the axes are in the coordinate system that is active now."""
        for axis, position_mm in self._from_base(self._base_mm).items():
            shifts = self.shifts(axis)
            self._state[axis] = AxisState(
                absolute_mm=position_mm,
                shifts=shifts,
                programmed_mm=position_mm - shifts.total_mm,
            )
