"""What the plant tells of an axis and its stop, for the closed forms of a run to a fixed stop."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from axisrig.bench.machine.machine import Machine
from axisrig.bench.oracles.fixed_stop.contact import StopPath
from axisrig.bench.oracles.fixed_stop.following import Course
from axisrig.bench.oracles.fixed_stop.lists import Written
from axisrig.bench.oracles.fixed_stop.pressing import Axis, Pressing, Stop
from axisrig.bench.rig.rotary import arm_m
from axisrig.kernel.cosim.fmi.units import Exponents, find_unit, unit_name
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.time.clock import TimeNs

_INERTIA: Exponents = (1, 2, 0, 0, 0, 0, 0, 0)
Signal = npt.NDArray[np.float64]
Times = npt.NDArray[np.int64]

FAR_AWAY_MM = 100_000.0
"""A stop as far away as this stands for none."""


class PlantValues:
    """Parameters of the FMU of an axis by their names in the library, SI units.

    An FMU of two axes (`position_1`, `position_2`) names those of each with the same ending. Those
    of one that turns are given as a slide has them that moves by `arm_m` per radian: its positions
    and forces are.
    """

    def __init__(self, plant: PlantAxis, arm_m: float | None = None) -> None:
        self._slave = plant.slave
        bound = plant.roles.bound.get("position")
        self.arm_m = arm_m
        variable = bound.variable if bound is not None else ""
        self._ending = variable.removeprefix("position") if "position_" in variable else ""

    def get(self, *names: str) -> float | None:
        """Return the first one that the FMU has, None without any."""
        for name in names:
            for whole in dict.fromkeys((name + self._ending, name)):
                if self._slave.has(whole):
                    return self._in_si(whole)
        return None

    def number(self, *names: str, otherwise: float = 0.0) -> float:
        """Return the first one that the FMU has, else a value that does nothing."""
        value = self.get(*names)
        return otherwise if value is None else value

    def _in_si(self, name: str) -> float:
        value = self._slave.get(name)
        told = unit_name(self._slave.variable(name))
        unit = find_unit(self._slave.description, told) if told else None
        if unit is None:
            return value
        si = unit.to_si(value)
        return si if self.arm_m is None else si * self.arm_m ** power_of_arm(unit.exponents)


def power_of_arm(exponents: Exponents) -> int:
    """Return the power of the arm r that makes a quantity of a rotation one of a slide.

    x = r phi, F = M/r, and of them k = K/r^2, m = J/r^2, d = D/r^2; a J does not name the rad of
    its N.m/(rad/s2).
    """
    kg, m, *_, rad = exponents
    if exponents == _INERTIA:
        return -2
    return rad - 1 if (kg, m) == (1, 2) else rad


@dataclass(frozen=True)
class AxisTruth:
    """One axis of a finished run. Signals have one value per row of the trace, mm, mm/s, N.

    zero_mm: place of the plant that the positions of the machine count from. peak_n: largest force
    at the stop since the row before. force_n: of the motor. None where the plant does not tell it.
    """

    name: str
    machine: Machine
    times_ns: Times
    position_mm: Signal
    velocity_mm_s: Signal
    course: Course
    set_mm: Signal
    cnc_lag_mm: Signal
    zero_mm: float
    stop_force_n: Signal | None
    peak_n: Signal | None
    force_n: Signal | None
    stop_face_mm: Signal | None

    @cached_property
    def written(self) -> Written:
        """What its parameter list and the plan have set."""
        return dict(self.machine.settings.axis[self.name].items())

    @cached_property
    def values(self) -> PlantValues:
        """What its FMU tells beside the roles."""
        settings = self.machine.settings
        plant = self.machine.plant.axes[settings.rig.axis[self.name].plant]
        return PlantValues(plant, arm_m(settings, self.name))

    @cached_property
    def stop_path(self) -> StopPath | None:
        """Where the stop is, None without one in reach."""
        direction = self.values.get("stop_direction")
        place_m = self.values.get("stop_position")
        rows = len(self.times_ns)
        if self.stop_face_mm is not None and direction is not None:
            seconds = self.times_ns * 1e-9
            moves = rows > 1 and np.ptp(self.stop_face_mm) > 0.0
            speed = np.gradient(self.stop_face_mm, seconds) if moves else np.zeros(rows)
            return StopPath(self.stop_face_mm, speed, int(direction))
        if direction is None or place_m is None or abs(place_m) * 1e3 >= FAR_AWAY_MM:
            return None
        return StopPath.at_rest(place_m * 1e3, int(direction), rows)

    @cached_property
    def kv_per_s(self) -> float | None:
        """Gain of the position loop."""
        return self.values.get("kv")

    @cached_property
    def stop(self) -> Stop | None:
        """The stop with its stiffness, None where the plant tells none."""
        stiffness, path = self.values.get("stop_stiffness"), self.stop_path
        if stiffness is None or path is None:
            return None
        get = self.values.number
        return Stop(
            path.direction,
            stiffness,
            get("stop_exponent", otherwise=1.0),
            get("stop.reference_penetration", otherwise=1e-5),
            get("stop_damping"),
        )

    @cached_property
    def axis(self) -> Axis | None:
        """What presses, None where the plant tells no mass."""
        get = self.values.number
        mass = self.values.get("effective_mass", "effective_inertia")
        if mass is None:
            return None
        return Axis(
            mass_kg=mass,
            weight_n=get("weight") + self._imbalance_n,
            friction_n=get("coulomb_friction", "friction.coulomb"),
            viscous_n_s_m=get("viscous_friction", "friction.viscous"),
            joint_n_m=self.values.get("screw_stiffness"),
            backlash_mm=get("backlash") * 1e3,
        )

    @property
    def _imbalance_n(self) -> float:
        """Return what the imbalance of a turning axis pulls with where its stop is, M_u sin phi."""
        place_m, radius_m = self.values.get("stop_position"), self.values.arm_m
        if place_m is None or radius_m is None:
            return 0.0
        return self.values.number("imbalance") * math.sin(place_m / radius_m)

    def pressed_encoder_mm(self, row: int) -> float:
        """Return where the encoder must be by the force at the stop in a row: x_stop + F/k.

        The damping of the stop counts with the velocity in that row, F = k p (1 + a dp/dt), and so
        does what a screw gives under the force of the motor.
        """
        assert self.stop is not None
        assert self.stop_path is not None
        assert self.stop_force_n is not None
        stop, path = self.stop, self.stop_path
        into_m_s = stop.direction * (self.velocity_mm_s[row] - path.velocity_mm_s[row]) * 1e-3
        spring_n = float(self.stop_force_n[row]) / max(1.0 + stop.damping_s_m * into_m_s, 1e-3)
        deep_mm = stop.penetration_mm(spring_n)
        if self.axis is not None and self.axis.joint_n_m is not None:
            force_n = spring_n if self.force_n is None else abs(float(self.force_n[row]))
            deep_mm += self.axis.give_mm(force_n)
        return float(path.position_mm[row]) + stop.direction * deep_mm

    def stop_force_max_n(self, rows: slice) -> float | None:
        """Return the largest force at the stop in some rows, between them too where it is told."""
        told = self.stop_force_n if self.peak_n is None else self.peak_n
        return None if told is None or not len(told[rows]) else float(np.max(told[rows]))

    def pressing(self, time_ns: TimeNs) -> Pressing | None:
        """Return axis against stop with the force limit that acts at an instant."""
        if self.stop is None or self.axis is None:
            return None
        told_n = self.machine.torque_limits.at(self.name, time_ns, self.stop.direction)
        limits_n = [told_n, self.values.get("force_limit_motor", "torque_limit_motor")]
        known_n = [limit for limit in limits_n if limit is not None]
        return Pressing(self.stop, self.axis, min(known_n)) if known_n else None


def axis_truth(machine: Machine, trace: pa.Table, axis: str, zero_mm: float) -> AxisTruth:
    """Take the truth of an axis from the trace of a finished run.

    The encoder of its drive is the actual position as it came over the bus; with the lag of the
    drive, the plant's own, it gives the demand.
    """

    def column(name: str) -> Signal | None:
        whole = f"{axis}.{name}"
        return trace.column(whole).to_numpy() if whole in trace.column_names else None

    def needed(name: str) -> Signal:
        values = column(name)
        assert values is not None, f"the recorder tells {name} of every axis with a plant"
        return values

    encoder_mm = needed("actual_mm") + zero_mm
    return AxisTruth(
        name=axis,
        machine=machine,
        times_ns=trace.column("time_ns").to_numpy(),
        position_mm=needed("truth_mm"),
        velocity_mm_s=needed("velocity_mm_s"),
        course=Course(needed("drive_lag_mm") + encoder_mm, encoder_mm),
        set_mm=needed("set_mm"),
        cnc_lag_mm=needed("cnc_lag_mm"),
        zero_mm=zero_mm,
        stop_force_n=column("stop_force_n"),
        peak_n=column("stop_force_peak_n"),
        force_n=column("force_n"),
        stop_face_mm=column("stop_mm"),
    )
