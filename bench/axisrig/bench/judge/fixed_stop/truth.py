"""What the plant gives of an axis and its stop, for the closed forms of a run to a fixed stop."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.plant_values import PlantValues
from axisrig.bench.oracles.fixed_stop.contact import StopPath
from axisrig.bench.oracles.fixed_stop.following import Course, shifted
from axisrig.bench.oracles.fixed_stop.lists import Written
from axisrig.bench.oracles.fixed_stop.pressing import Axis, Pressing, Stop, drive_limit_n
from axisrig.bench.record.axes import AxisRecord, PlantRecord
from axisrig.bench.record.series import Signal, Times
from axisrig.kernel.time.clock import S, TimeNs

FAR_AWAY_MM = 100_000.0
"""A stop as far away as this counts as none."""
PLANT_MM = 1e-7
"""How well positions of a plant are known at the end of a step, which another length of the steps
of its integration may change (inferred; `tests/study` holds it).
"""


@dataclass(frozen=True)
class AxisTruth:
    """One axis of a finished run. Signals have one value per row of the trace, mm, mm/s, N.

    syncs_ns: instants of `course`, the SYNCs of its own segment. zero_mm: place of the plant that
    the positions of the machine count from. peak_n: largest force at the stop since the row before.
    force_n: of the motor. None where the plant does not give it. fine_s: its steps in contact.
    """

    name: str
    record: AxisRecord
    plant: PlantRecord
    times_ns: Times
    syncs_ns: Times
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
    fine_s: float

    @cached_property
    def written(self) -> Written:
        """What its parameter list and the plan have set."""
        return dict(self.record.written)

    @cached_property
    def values(self) -> PlantValues:
        """What its FMU gives beside the roles."""
        return PlantValues(self.plant, self.record.arm_m)

    @property
    def tells_stop(self) -> bool:
        """Whether the plant gives where its stop is, or that it has none.

        One that gives a force or a face, and no parameter for the side of its stop, does not.
        """
        gives = self.stop_force_n is not None or self.stop_face_mm is not None
        return not gives or self.values.get("stop_direction") is not None

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
        """The stop with its stiffness, None where the plant gives none."""
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
        """What presses, None where the plant gives no mass."""
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
        """Return the largest force at the stop in some rows, between them too where it is given.

        The peak of the first row is of the time before it, which is none of theirs.
        """
        forces_n = self.stop_force_n
        if forces_n is None or not len(forces_n[rows]):
            return None
        if self.peak_n is None:
            return float(np.max(forces_n[rows]))
        return float(np.max([forces_n[rows][0], *self.peak_n[rows][1:]]))

    def force_beside_n(self, rows: slice) -> float:
        """Return by how much the forces of the rows beside some pass the largest one of these.

        What the rows belong to begins and ends between two SYNCs: by so much its largest force may
        be larger than that of its rows.
        """
        forces_n, largest_n = self.stop_force_n, self.stop_force_max_n(rows)
        if forces_n is None or largest_n is None:
            return 0.0
        beside = [
            *forces_n[max(rows.start - 1, 0) : rows.start],
            *forces_n[rows.stop : rows.stop + 1],
        ]
        return max(0.0, *(float(force_n) - largest_n for force_n in beside), 0.0)

    def force_doubt_n(self, force_n: float) -> float:
        """Return how well a force at the stop is known; 0 where its stiffness is not known."""
        return 0.0 if self.stop is None else self.stop.doubt_n(force_n, PLANT_MM)

    def peak_doubt_n(self, force_n: float) -> float:
        """Return how well the largest force at a stop is known, which lies between two steps."""
        doubt_n = self.force_doubt_n(force_n)
        if self.stop is None or self.axis is None or self.peak_n is None:
            return doubt_n
        return doubt_n + self.stop.summit_doubt_n(force_n, self.axis.mass_kg, self.fine_s)

    def pressing(self, time_ns: TimeNs) -> Pressing | None:
        """Return axis against stop with the force limit that acts at an instant."""
        if self.stop is None or self.axis is None:
            return None
        limit_n = self._limit_n(time_ns, self.stop.direction)
        limits_n = [limit_n, self.values.get("force_limit_motor", "torque_limit_motor")]
        known_n = [limit for limit in limits_n if limit is not None]
        return Pressing(self.stop, self.axis, min(known_n)) if known_n else None

    def _limit_n(self, time_ns: TimeNs, direction: int) -> float | None:
        """Return the limit of the drive that acted at an instant in a direction (1, -1)."""
        limits, record = self.record.torque_limits, self.record
        known = [limit for limit in limits if limit.since_ns <= time_ns] or limits[:1]
        if not known:
            return None
        now = known[-1]
        acting = (now.most, now.positive if direction > 0 else now.negative)
        return drive_limit_n(record.rated_torque_mnm, record.lead_um, acting)


def axis_truth(observed: Observed, axis: str, zero_mm: float) -> AxisTruth:
    """Take the truth of an axis from a finished run; zero_mm: as in `AxisTruth`.

    The encoder of its drive is the actual position as it came over the bus, at the SYNC that it is
    of; with the lag of the drive, the plant's own, it gives the demand.
    """

    def column(name: str) -> Signal | None:
        return observed.column(axis, name) if observed.has(axis, name) else None

    plant = observed.plant_of(axis)
    assert plant is not None, "an axis outside has no truth"
    record = observed.axes[axis]
    came_mm = observed.column(axis, "actual_mm") + zero_mm
    last_mm = float(came_mm[-1]) if len(came_mm) else 0.0
    encoder_mm = shifted(came_mm, record.later_cycles, fill=last_mm)
    return AxisTruth(
        name=axis,
        record=record,
        plant=plant,
        times_ns=observed.times_ns,
        syncs_ns=observed.syncs_ns(axis),
        position_mm=observed.column(axis, "truth_mm"),
        velocity_mm_s=observed.column(axis, "velocity_mm_s"),
        course=Course(observed.column(axis, "drive_lag_mm") + encoder_mm, encoder_mm),
        set_mm=observed.column(axis, "set_mm"),
        cnc_lag_mm=observed.column(axis, "cnc_lag_mm"),
        zero_mm=zero_mm,
        stop_force_n=column("stop_force_n"),
        peak_n=column("stop_force_peak_n"),
        force_n=column("force_n"),
        stop_face_mm=column("stop_mm"),
        fine_s=observed.facts.fine_ns / S,
    )
