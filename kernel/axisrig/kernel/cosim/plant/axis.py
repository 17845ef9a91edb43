"""An axis of the plant: its FMU, the demand it gets, and the motion it has made."""

import sys
from bisect import bisect_right
from collections import deque
from collections.abc import Callable, Sequence
from math import sqrt
from typing import Final

from axisrig.kernel.cosim.fmi.fmu import FmuState, PlantError
from axisrig.kernel.cosim.fmi.roles import Roles
from axisrig.kernel.cosim.fmi.steps import StepsInARow, offers_steps, plain_references
from axisrig.kernel.cosim.plant.curves import drop_before, end_slope, hermite, peak, two_before
from axisrig.kernel.cosim.plant.demand import Control, Ramp, SampledDemand
from axisrig.kernel.cosim.plant.outputs import (
    AXIS_OUTPUTS,
    DEMAND_POSITION,
    FORCE,
    HISTORY_NS,
    HISTORY_STEPS,
    MOTOR_POSITION,
    MOTOR_VELOCITY,
    POSITION,
    STOP_FACE,
    STOP_FORCE,
    VELOCITY,
    Tick,
    tick_of,
)
from axisrig.kernel.cosim.plant.refused_outputs import refusal
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import S, TimeNs

# Towards a stop (docs/architecture.md): gain in speed of an axis at most; and speed of the stop
GAIN_M_S2: Final = 500.0
STOP_SPEED_M_S: Final = 1.0
SLOPE_NS: Final = 250_000
FINE_NS: Final = 50_000
_BY_POSITION = ControlKind.POSITION


class PlantAxis:
    """A servo axis of the plant as its drive sees it (SI units).

    roles: what its FMU takes and gives. advance_to: moves the whole plant to an instant. `motion`
    holds AXIS_OUTPUTS at the present time (0 for a force or stop that the FMU does not report),
    `tick` load position and velocity at both ends of the last step, `walked` the motion before the
    last `walk` and after each of its steps. The steps of the last second are kept for the position
    at a latch, 4096 at most. fine_ns: longest step where a stop can be touched, for the force of
    its contact alone. beside: the axis on the same FMU that steps it, None = this one does.
    second_encoder: returns what the second encoder of the drive sees. name: None = the FMU's.
    """

    def __init__(
        self,
        roles: Roles,
        advance_to: Callable[[TimeNs], None],
        beside: "PlantAxis | None" = None,
        second_encoder: Callable[[], float] | None = None,
        name: str | None = None,
    ) -> None:
        self.roles, self.slave, self.advance_to = roles, roles.slave, advance_to
        self.name = name or roles.slave.name
        self._samples = None if roles.has_group("ramp") else SampledDemand(roles)
        self._demand: Ramp | SampledDemand = self._samples or Ramp(roles)
        self._control, self._second_encoder = Control(roles), second_encoder
        self._enabled = roles.exchange(["enabled"]) if roles.has("enabled") else None
        self._is_enabled: bool | None = None
        self._known = [name for name in AXIS_OUTPUTS if roles.has(name)]
        self._outputs = roles.exchange(self._known)
        # What follows the last output that the FMU reports, where it reports all before
        is_begin = tuple(self._known) == AXIS_OUTPUTS[: len(self._known)]
        has_motion = is_begin and len(self._known) > DEMAND_POSITION
        self._rest = [0.0] * (len(AXIS_OUTPUTS) - len(self._known)) if has_motion else None
        self.motion: list[float] = [0.0] * len(AXIS_OUTPUTS)
        self._begin = self.motion  # of the step that is under way
        self.tick: Tick = (0.0, 0.0, 0.0, 0.0)
        self.walked: list[list[float]] = []
        self._kept: list[list[float]] = []  # after the last steps in a row
        self.kv_per_s = 0.0
        self.fine_ns: TimeNs = FINE_NS
        self._tells_force, self._tells_stop = roles.has("force"), roles.has("stop_force")
        self._tells_face = roles.has("stop_force", "stop_face")
        self._touched_ns: TimeNs = -1
        self._free_until_ns: TimeNs = -1
        self._commanded = (0, 0.0, 0.0, 0)
        self._times: deque[TimeNs] = deque(maxlen=HISTORY_STEPS)
        self._past: deque[list[float]] = deque(maxlen=HISTORY_STEPS)
        self._saved: FmuState | None = None
        self._saved_ns: TimeNs = 0
        self._many: StepsInARow | None = None
        self._is_whole = False  # a row of `_many` is the motion of this axis
        self._steps, self._stepped = beside is None, [self]
        if beside is not None:
            beside._stepped.append(self)

    @property
    def tells_velocity(self) -> bool:
        """Whether the velocity of the load comes from the FMU; else it is a numeric derivative."""
        return self.roles.has("velocity")

    def start(self, start_ns: TimeNs) -> None:
        """Initialise the FMU; `kv_per_s` is the gain of its position loop, 0 when it gives none."""
        if self._steps:
            self.slave.initialize(start_ns)
            self._many = self._steps_in_a_row()
        if self.roles.has("kv"):
            gain = self.roles.exchange(["kv"])
            gain.read()
            self.kv_per_s = float(gain.values[0])
        self._sample()
        self._command(start_ns, self.motion[MOTOR_POSITION], 0.0, start_ns)

    def _steps_in_a_row(self) -> StepsInARow | None:
        """Return what takes several steps with the outputs of all axes; None: the FMU cannot."""
        axes = self._stepped
        outputs = plain_references([axis._outputs for axis in axes])
        is_complete = all(axis._rest is not None for axis in axes)
        if outputs is None or not is_complete or self._samples or not offers_steps(self.slave):
            return None
        self._is_whole = len(axes) == 1 and not self._rest
        return StepsInARow(self.slave, outputs=outputs)

    def _command(self, time_ns: TimeNs, position: float, rate: float, end_ns: TimeNs) -> None:
        self._commanded = (time_ns, position, rate, end_ns)
        self._demand.command(time_ns, position, rate, end_ns)

    def _sample(self) -> None:
        """Read and keep where the FMU is now."""
        self._remember(self.slave.time_ns, self._read())

    def _remember(self, time_ns: TimeNs, motion: list[float]) -> None:
        total = sum(motion)
        if total - total != 0.0:  # one of them is no number or infinite
            raise refusal(self.roles, AXIS_OUTPUTS, motion)
        self.motion = motion
        self._times.append(time_ns)
        self._past.append(motion)
        drop_before(self._times, self._past, time_ns - HISTORY_NS)
        if motion[STOP_FORCE] > 0.0:
            self._touched_ns = time_ns

    def _keep(self, times_ns: Sequence[TimeNs], motions: list[list[float]]) -> None:
        """Keep where steps in a row led; their library gives finite numbers or an error."""
        self._kept = motions
        if not motions:
            return
        self.motion = motions[-1]
        self._times.extend(times_ns)
        self._past.extend(motions)
        drop_before(self._times, self._past, times_ns[-1] - HISTORY_NS)
        if self._tells_stop:
            for place in range(len(motions) - 1, -1, -1):
                if motions[place][STOP_FORCE] > 0.0:
                    self._touched_ns = times_ns[place]
                    break

    def _read(self) -> list[float]:
        self._outputs.read()
        return self._filled(self._outputs.values[:])

    def _filled(self, values: list[float]) -> list[float]:
        if self._rest is None:
            return self._completed(values)
        return values + self._rest if self._rest else values

    def _completed(self, values: Sequence[float]) -> list[float]:
        """Put in what the FMU does not report, see `roles.csv`; derivatives only where needed."""
        found = dict(zip(self._known, values, strict=True))
        position = found["position"]
        velocity = found["velocity"] if "velocity" in found else self._slope(POSITION, position)
        motor = found.get("motor_position", position)
        if "motor_velocity" in found:
            motor_velocity = found["motor_velocity"]
        elif "motor_position" in found:
            motor_velocity = self._slope(MOTOR_POSITION, motor)
        else:
            motor_velocity = velocity
        demand = found.get("demand_position", self._demand_at(self.slave.time_ns))
        forces = [found.get(role, 0.0) for role in AXIS_OUTPUTS[FORCE:]]
        return [position, velocity, motor, motor_velocity, demand, *forces]

    def _demand_at(self, time_ns: TimeNs) -> float:
        begin_ns, start, rate, end_ns = self._commanded
        return start + rate * (min(time_ns, end_ns) - begin_ns) * 1e-9

    def _slope(self, index: int, now: float) -> float:
        """Return the slope of an output now, from now and two points of the past."""
        now_ns = self.slave.time_ns
        # So far apart, because over 3 us the tolerance of an FMU's own integration would be speed
        before = two_before(self._times, self._past, now_ns, SLOPE_NS)
        return end_slope([(now_ns, now), *[(time_ns, motion[index]) for time_ns, motion in before]])

    def step_to(self, end_ns: TimeNs) -> None:
        """Step the FMU to `end_ns`, in fine steps where the stop can be touched.

        Nothing happens where the axis beside has stepped the FMU of both.
        """
        if not self._steps:
            return
        for axis in self._stepped:
            axis._begin = axis.motion
        if self._is_near_stop(end_ns):
            begin_ns, fine_ns = self.slave.time_ns, self.fine_ns
            self._go_through([*range(begin_ns + fine_ns, end_ns, fine_ns), end_ns])
        else:
            self._go_through([end_ns])
        for axis in self._stepped:
            axis.tick = tick_of(axis._begin, axis.motion)

    def walk(self, ends_ns: Sequence[TimeNs]) -> None:
        """Do `step_to` for each of these instants; `walked` then has the motion at each."""
        if not self._steps:
            return
        for axis in self._stepped:
            axis.walked = [axis.motion]
        if self._many is None or self._is_near_stop(ends_ns[-1]):
            for end_ns in ends_ns:
                self.step_to(end_ns)
                for axis in self._stepped:
                    axis.walked.append(axis.motion)
            return
        self._go_through(ends_ns)
        for axis in self._stepped:
            axis.walked += axis._kept
            axis.tick = tick_of(axis.walked[-2], axis.walked[-1])

    def _is_near_stop(self, end_ns: TimeNs) -> bool:
        """Return whether any axis of the FMU has, or can have until `end_ns`, a contact."""
        is_near = False
        for axis in self._stepped:
            if axis._free_until_ns < end_ns and axis._may_touch(end_ns):
                is_near = True
        return is_near

    def _go_through(self, ends_ns: Sequence[TimeNs]) -> None:
        """Step to each of these instants, if possible in one call; keep where the axes are."""
        many = self._many
        if many is None:
            for end_ns in ends_ns:
                self._go_alone(end_ns)
            return
        rows = many.take(ends_ns)
        reached_ns = ends_ns if len(rows) == len(ends_ns) else ends_ns[: len(rows)]
        if self._is_whole:
            self._keep(reached_ns, rows)
        else:
            first = 0
            for axis in self._stepped:
                last = first + len(axis._known)
                axis._keep(reached_ns, [axis._filled(row[first:last]) for row in rows])
                first = last
        if len(rows) < len(ends_ns):
            many.refuse(ends_ns[len(rows)])

    def _go_alone(self, end_ns: TimeNs) -> None:
        if self._samples is None:
            self.slave.step_to(end_ns)
        else:
            self._samples.step(self.slave, end_ns)
        for axis in self._stepped:
            axis._sample()

    def _may_touch(self, end_ns: TimeNs) -> bool:
        """Return whether there is, or can be until `end_ns`, a contact with the stop.

        The gap g is used up after t with (|v| + v_stop) t + A t^2/2 = g at the earliest. An FMU
        that does not report where its stop is has a contact while there is a force.
        """
        motion = self.motion
        if not self._tells_stop:
            self._free_until_ns = sys.maxsize
        elif self._tells_face and motion[STOP_FORCE] <= 0.0:
            gap_m = abs(motion[STOP_FACE] - motion[POSITION])
            speed = abs(motion[VELOCITY]) + STOP_SPEED_M_S
            free_s = (sqrt(speed * speed + 2.0 * GAIN_M_S2 * gap_m) - speed) / GAIN_M_S2
            self._free_until_ns = self.slave.time_ns + int(free_s * S)
        else:
            return motion[STOP_FORCE] > 0.0
        return self._free_until_ns < end_ns

    def forget(self) -> None:
        """Drop the steps that are kept; else who frees a machine would look through them."""
        self._times.clear()
        self._past.clear()

    def save(self) -> None:
        """Keep the present state for `restore`; the FMU must be able to."""
        if self._steps:
            self._saved = self.slave.save_state(self._saved)
        self._saved_ns = self._times[-1]

    def restore(self) -> None:
        """Go back to where `save` was called last."""
        if self._saved is not None:  # else the axis beside has restored the FMU of both
            self.slave.restore_state(self._saved)
        while self._times[-1] > self._saved_ns:
            self._times.pop()
            self._past.pop()
        self.motion = self._past[-1]

    def command(
        self,
        time_ns: TimeNs,
        position_m: float,
        velocity_m_s: float,
        end_ns: TimeNs,
        enabled: bool,
    ) -> None:
        """Control the position: a ramp from `position_m` at `time_ns` that ends at `end_ns`.

        enabled: False = power off, whatever was commanded before.
        """
        if not enabled and self._enabled is None:
            # Nothing switches this axis off: its demand stays where it was when that was asked for
            if not self._is_enabled:
                return
            position_m, velocity_m_s = self.motion[MOTOR_POSITION], 0.0
        if self._control.kind is not _BY_POSITION:
            self._control.choose(_BY_POSITION)
        self._command(time_ns, position_m, velocity_m_s, end_ns)
        if enabled is not self._is_enabled:
            self._enable(enabled)

    def _enable(self, enabled: bool) -> None:
        if self._enabled is not None and enabled != self._is_enabled:
            self._enabled.values[0] = enabled
            self._enabled.write()
        self._is_enabled = enabled

    @property
    def kinds(self) -> frozenset[ControlKind]:
        """Kinds of control that the FMU offers; position always."""
        return self._control.kinds

    def command_velocity(
        self, time_ns: TimeNs, velocity_m_s: float, acceleration_m_s2: float, end_ns: TimeNs
    ) -> None:
        """Control the velocity, power on: it changes evenly until `end_ns`, then rests.

        Only where `kinds` has it.
        """
        self._control.choose(ControlKind.VELOCITY)
        self._control.give_slope(acceleration_m_s2)
        self._command(time_ns, self.motion[MOTOR_POSITION], velocity_m_s, end_ns)
        self._enable(True)

    def command_force(self, time_ns: TimeNs, force_n: float) -> None:
        """Control the motor force, power on; only where `kinds` has it."""
        self._control.choose(ControlKind.FORCE)
        self._control.give_force(force_n)
        self._enable(True)

    @property
    def limits_force(self) -> bool:
        """Whether `limit_force` acts on this FMU."""
        return self._control.limits_force

    def limit_force(self, negative_n: float, positive_n: float) -> None:
        """Limit the motor force, whatever the kind of control; amounts, 0 or more.

        They count from now on and beside the FMU's own limit. An FMU with one input for both
        directions gets the smaller amount; one without is not limited.
        """
        self._control.limit(negative_n, positive_n)

    def force_n(self) -> float | None:
        """Return the motor force now; None: the FMU does not report it."""
        return self.motion[FORCE] if self._tells_force else None

    def stop_force_peak_n(self, since_ns: TimeNs, until_ns: TimeNs) -> float:
        """Return the largest force between slide and stop from `since_ns` to `until_ns`, N.

        Of the forces at the ends of steps, which are `fine_ns` apart while there is a contact, see
        `peak`. 0 when nothing that is still kept is there.
        """
        if self._touched_ns < since_ns:
            return 0.0
        return peak(self._times, self._past, STOP_FORCE, since_ns, until_ns)

    def second_encoder_m(self) -> float | None:
        """Return what the second encoder sees now; None: there is none."""
        return None if self._second_encoder is None else self._second_encoder()

    def position_m(self) -> float:
        """Return the load position now: the truth, which no drive ever sees."""
        return self.motion[POSITION]

    def motor_position_m(self) -> float:
        """Return what the motor encoder sees now, in load units."""
        return self.motion[MOTOR_POSITION]

    def motor_velocity_m_s(self) -> float:
        """Return the motor velocity now, in load units."""
        return self.motion[MOTOR_VELOCITY]

    def demand_position_m(self) -> float:
        """Return the demand that the position controller of the drive follows now.

        The actual position while it follows none (control of velocity or force).
        """
        if self._control.kind is not _BY_POSITION:
            return self.motion[MOTOR_POSITION]
        return self.motion[DEMAND_POSITION]

    def motion_at(self, time_ns: TimeNs) -> list[float]:
        """Return `motion` as it was at the end of a step: AXIS_OUTPUTS.

        Raises PlantError when no step that is still kept ended at `time_ns`.
        """
        after = bisect_right(self._times, time_ns)
        if after == 0 or self._times[after - 1] != time_ns:
            raise PlantError(self.name, time_ns, "no step ended at this instant")
        return self._past[after - 1]

    def motor_position_m_at(self, time_ns: TimeNs) -> float:
        """Return the motor position at a past instant, by cubic Hermite inside its step."""
        return self._past_m(time_ns, MOTOR_POSITION)

    def second_encoder_m_at(self, time_ns: TimeNs) -> float:
        """Return what the second encoder saw at a past instant; only where there is one.

        That is the load then and the error of the encoder now: how the error changed since (within
        one SYNC period) is not in it.
        """
        assert self._second_encoder is not None
        return self._past_m(time_ns, POSITION) + (self._second_encoder() - self.motion[POSITION])

    def _past_m(self, time_ns: TimeNs, index: int) -> float:
        """Return a position of AXIS_OUTPUTS at a past instant; its rate is the next output."""
        (begin_ns, begin), (end_ns, end) = self.ends_around(time_ns)
        if begin_ns == time_ns:
            return begin[index]
        ends = (begin[index], begin[index + 1], end[index], end[index + 1])
        return hermite((time_ns - begin_ns) * 1e-9, (end_ns - begin_ns) * 1e-9, ends)

    def ends_around(
        self, time_ns: TimeNs
    ) -> tuple[tuple[TimeNs, list[float]], tuple[TimeNs, list[float]]]:
        """Return instant and AXIS_OUTPUTS of the last end of a step up to an instant, and the next.

        Twice the same where a step ended at the instant. Raises PlantError outside what is kept.
        """
        after = bisect_right(self._times, time_ns)
        if after == 0 or time_ns > self._times[-1]:
            raise PlantError(self.name, time_ns, "no motion is recorded for this instant")
        begin_ns, begin = self._times[after - 1], self._past[after - 1]
        if begin_ns == time_ns:
            return (begin_ns, begin), (begin_ns, begin)
        return (begin_ns, begin), (self._times[after], self._past[after])
