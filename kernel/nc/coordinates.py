"""Machining coordinate systems, shifts, and the way from a programmed to an axis position.

PCS   programmed coordinates of the active coordinate system.
ABS   PCS + reference point offset (G92) + measurement offset (G101), same coordinate system.
ACS   axis coordinates: ABS through the stack of coordinate systems.

Shifts take effect for an axis with its next absolute programming. A new coordinate system lies
relative to the shifted one below it; shifts programmed in it end with it.
Source: programming manual, G92, G101 and #CS.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MAIN_AXES = 3

# An axis whose target differs by less does not move: far below every encoder increment, far above
# the rounding of a turn there and back.
SAME_POSITION_MM = 1e-9


@dataclass(frozen=True, eq=False)
class Frame:
    """A coordinate system: lower = offset_mm + rotation · upper.

    offset_mm: shape (3,). rotation: shape (3, 3), orthonormal.
    """

    offset_mm: Array
    rotation: Array

    @classmethod
    def of(cls, components: Sequence[float]) -> "Frame":
        """Make the frame of `#CS ON[v1,v2,v3,a1,a2,a3]`: shifts in mm, angles in degrees.

        The right-handed turns run third angle about Z, second about the new Y, first about the
        newest X: R = Rz(a3) · Ry(a2) · Rx(a1).
        Source: programming manual, #CS; P-CHAN-00394, default rotation sequence.
        """
        x, y, z, *angles_deg = components
        a1, a2, a3 = np.radians(angles_deg)
        c1, c2, c3 = np.cos(a1), np.cos(a2), np.cos(a3)
        s1, s2, s3 = np.sin(a1), np.sin(a2), np.sin(a3)
        about_x = np.array([[1.0, 0.0, 0.0], [0.0, c1, -s1], [0.0, s1, c1]])
        about_y = np.array([[c2, 0.0, s2], [0.0, 1.0, 0.0], [-s2, 0.0, c2]])
        about_z = np.array([[c3, -s3, 0.0], [s3, c3, 0.0], [0.0, 0.0, 1.0]])
        return cls(np.array([x, y, z], dtype=np.float64), about_z @ about_y @ about_x)

    @classmethod
    def identity(cls) -> "Frame":
        """Make the frame of the axes themselves."""
        return cls(np.zeros(MAIN_AXES), np.eye(MAIN_AXES))

    def down(self, upper_mm: Array) -> Array:
        """Convert a position, shape (3,), to the coordinate system below."""
        lower: Array = self.offset_mm + self.rotation @ upper_mm
        return lower

    def up(self, lower_mm: Array) -> Array:
        """Convert a position, shape (3,), from the coordinate system below."""
        upper: Array = self.rotation.T @ (lower_mm - self.offset_mm)
        return upper

    def then(self, upper: "Frame") -> "Frame":
        """Put a frame that is relative to this one on top of it; the result is one frame."""
        return Frame(self.down(upper.offset_mm), self.rotation @ upper.rotation)


@dataclass
class _Level:
    """One coordinate system of the stack, down to the axes, with the shifts programmed in it."""

    frame: Frame
    reference_mm: dict[str, float]
    measurement_mm: dict[str, float]


@dataclass
class _AxisState:
    """Where one axis stands in the active coordinate system, and how it got there.

    absolute_mm: ABS. reference_mm, measurement_mm: the shifts that were in effect when it was
    programmed absolutely. programmed_mm: PCS of the last block that programmed it.
    """

    absolute_mm: float
    reference_mm: float
    measurement_mm: float
    programmed_mm: float


@dataclass(frozen=True)
class Measured:
    """The values of one axis after a measuring run, in mm; see `variables.csv`."""

    acs_mm: float
    mess_mm: float
    pcs_mm: float
    offset_mm: float


@dataclass
class Coordinates:
    """The coordinate systems of a channel and the position it has been sent to.

    axes: all axes, main axes first. acs_mm: where every axis stands.
    """

    axes: tuple[str, ...]
    acs_mm: dict[str, float]
    _levels: list[_Level] = field(init=False)
    _state: dict[str, _AxisState] = field(init=False)

    def __post_init__(self) -> None:
        none = dict.fromkeys(self.axes, 0.0)
        self._levels = [_Level(Frame.identity(), none, dict(none))]
        self._state = {}
        self._renew()

    @property
    def transformed(self) -> bool:
        """Whether a machining coordinate system is on."""
        return len(self._levels) > 1

    @property
    def main_axes(self) -> tuple[str, ...]:
        """The axes that a coordinate system turns."""
        return self.axes[:MAIN_AXES]

    def programmed_mm(self, axis: str) -> float:
        """Give V.A.PROG."""
        return self._state[axis].programmed_mm

    def absolute_mm(self, axis: str) -> float:
        """Give V.A.ABS."""
        return self._state[axis].absolute_mm

    def measurement_offset_mm(self, axis: str) -> float:
        """Give V.A.MEIN."""
        return self._levels[-1].measurement_mm[axis]

    def switch_on(self, frame: Frame) -> None:
        """Put a coordinate system on top of the active one, at its shifted origin."""
        below = self._levels[-1]
        shift_mm = np.array([self._shift_mm(axis) for axis in self.main_axes])
        shifted = below.frame.then(Frame(shift_mm, np.eye(MAIN_AXES)))
        # The shifts of the main axes are in the origin now; those of the others have no frame.
        reference = {**below.reference_mm, **dict.fromkeys(self.main_axes, 0.0)}
        measurement = {**below.measurement_mm, **dict.fromkeys(self.main_axes, 0.0)}
        self._levels.append(_Level(shifted.then(frame), reference, measurement))
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

    def shift_reference(self, axis: str, shift_mm: float, *, added: bool) -> None:
        """Set the reference point offset of an axis (G92), or add to it (in G91)."""
        shifts = self._levels[-1].reference_mm
        shifts[axis] = shifts[axis] + shift_mm if added else shift_mm

    def include_measurement(self, axis: str, shift_mm: float) -> None:
        """Set the measurement offset of an axis: G101; zero for G102."""
        self._levels[-1].measurement_mm[axis] = shift_mm

    def aim(self, programmed_mm: Mapping[str, float], *, absolute: bool) -> dict[str, float]:
        """Take the axis words of a move; return the new axis position of every axis that changes.

        absolute: G90, values are coordinates; otherwise distances from where the axis stands.
        """
        shifts = self._levels[-1]
        for axis, value_mm in programmed_mm.items():
            state = self._state[axis]
            if absolute:
                state.reference_mm = shifts.reference_mm[axis]
                state.measurement_mm = shifts.measurement_mm[axis]
                state.absolute_mm = value_mm + state.reference_mm + state.measurement_mm
                state.programmed_mm = value_mm
            else:
                state.absolute_mm += value_mm
                state.programmed_mm = state.absolute_mm - state.reference_mm - state.measurement_mm
        target_mm = self._to_acs({axis: self._state[axis].absolute_mm for axis in self.axes})
        changed = {
            axis: position_mm
            for axis, position_mm in target_mm.items()
            if abs(position_mm - self.acs_mm[axis]) > SAME_POSITION_MM
        }
        self.acs_mm.update(changed)
        return changed

    def stand_at(self, acs_mm: Mapping[str, float]) -> None:
        """Take over where axes really ended; what was programmed stays as it is."""
        self.acs_mm.update(acs_mm)
        for axis, position_mm in self._from_acs(self.acs_mm).items():
            self._state[axis].absolute_mm = position_mm

    def measured(self, latched_acs_mm: Mapping[str, float]) -> dict[str, Measured]:
        """Convert latched axis positions of the run just ended, with what was programmed for it.

        Main axes under a coordinate system need the latched values of all three; without them
        none of them has a value. Formulas: MEAS.PCS = MESS - zero shifts - measurement offset;
        MOFFS = MESS - PROG - zero shifts. Source: FCT-C4 section 5, table of the variables.
        """
        usable = dict(latched_acs_mm)
        if self.transformed and not usable.keys() >= set(self.main_axes):
            usable = {a: v for a, v in usable.items() if a not in self.main_axes}
        in_system_mm = self._from_acs({**self.acs_mm, **usable})
        values = {}
        for axis, acs_mm in usable.items():
            state, mess_mm = self._state[axis], in_system_mm[axis]
            without_zero_mm = mess_mm - state.reference_mm
            values[axis] = Measured(
                acs_mm=acs_mm,
                mess_mm=mess_mm,
                pcs_mm=without_zero_mm - state.measurement_mm,
                offset_mm=without_zero_mm - state.programmed_mm,
            )
        return values

    def _shift_mm(self, axis: str) -> float:
        level = self._levels[-1]
        return level.reference_mm[axis] + level.measurement_mm[axis]

    def _to_acs(self, absolute_mm: Mapping[str, float]) -> dict[str, float]:
        position = dict(absolute_mm)
        if self.transformed:
            main = np.array([position[axis] for axis in self.main_axes])
            lower = self._levels[-1].frame.down(main).tolist()
            position.update(zip(self.main_axes, lower, strict=True))
        return position

    def _from_acs(self, acs_mm: Mapping[str, float]) -> dict[str, float]:
        position = dict(acs_mm)
        if self.transformed:
            main = np.array([position[axis] for axis in self.main_axes])
            upper = self._levels[-1].frame.up(main).tolist()
            position.update(zip(self.main_axes, upper, strict=True))
        return position

    def _renew(self) -> None:
        """Express where the axes stand in the coordinate system that is active now."""
        level = self._levels[-1]
        for axis, position_mm in self._from_acs(self.acs_mm).items():
            self._state[axis] = _AxisState(
                absolute_mm=position_mm,
                reference_mm=level.reference_mm[axis],
                measurement_mm=level.measurement_mm[axis],
                programmed_mm=position_mm - self._shift_mm(axis),
            )
