"""An axis of the plant: its FMU, the demand it gets, and the motion it has made."""

from bisect import bisect_right
from collections import deque
from collections.abc import Callable

from kernel.clock import TimeNs
from kernel.cosim.fmu import Exchange, FmuSlave, FmuState, PlantError

AXIS_INPUTS = ("reference_position", "reference_velocity", "reference_time", "reference_end")
AXIS_OUTPUTS = (
    "position",
    "velocity",
    "motor_position",
    "motor_velocity",
    "demand_position",
)
# Two SYNC periods of 20 ms in steps of 10 us: a latch is looked up at the SYNC after it
HISTORY_STEPS = 4096


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

    advance_to: brings the whole plant to an instant. `motion` holds AXIS_OUTPUTS at the present
    time, `tick` load position and velocity at both ends of the last step. The last 4096 steps are
    kept, so that the position at a latch can be looked up.
    """

    def __init__(self, slave: FmuSlave, advance_to: Callable[[TimeNs], None]) -> None:
        self.slave, self.advance_to = slave, advance_to
        self._inputs = Exchange(slave, AXIS_INPUTS)
        self._enabled = Exchange(slave, ["enabled"])
        self.outputs = Exchange(slave, AXIS_OUTPUTS)
        self.motion: list[float] = [0.0] * len(AXIS_OUTPUTS)
        self.tick = (0.0, 0.0, 0.0, 0.0)
        self.kv_per_s = 0.0
        self._times: deque[TimeNs] = deque(maxlen=HISTORY_STEPS)
        self._past: deque[list[float]] = deque(maxlen=HISTORY_STEPS)
        self._saved: FmuState | None = None

    def start(self, start_ns: TimeNs) -> None:
        """Initialise the FMU; `kv_per_s` is the gain of its position loop, 0 when it tells none."""
        self.slave.initialize(start_ns)
        self.kv_per_s = self.slave.get("kv") if self.slave.has("kv") else 0.0
        self._sample()

    def _sample(self) -> None:
        self.outputs.read()
        self.motion = self.outputs.values[:]
        self._times.append(self.slave.time_ns)
        self._past.append(self.motion)

    def step_to(self, end_ns: TimeNs) -> None:
        """Step the FMU to `end_ns`."""
        begin = self.motion
        self.slave.step_to(end_ns)
        self._sample()
        end = self.motion
        self.tick = (begin[0], begin[1], end[0], end[1])

    def save(self) -> None:
        """Keep the present state for `restore`; the FMU must be able to."""
        self._saved = self.slave.save_state(self._saved)

    def restore(self) -> None:
        """Go back to where `save` was called last."""
        assert self._saved is not None
        self.slave.restore_state(self._saved)
        while self._times[-1] > self.slave.time_ns:
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
        return self.motion[0]

    def motor_position_m(self) -> float:
        """Return what the motor encoder sees now, in load units."""
        return self.motion[2]

    def motor_velocity_m_s(self) -> float:
        """Return the motor velocity now, in load units."""
        return self.motion[3]

    def demand_position_m(self) -> float:
        """Return the demand that the position controller of the drive follows now."""
        return self.motion[4]

    def motor_position_m_at(self, time_ns: TimeNs) -> float:
        """Return the motor position at a past instant, by cubic Hermite inside its step."""
        after = bisect_right(self._times, time_ns)
        if after == 0 or time_ns > self._times[-1]:
            raise PlantError(self.slave.name, time_ns, "no motion is recorded for this instant")
        begin_ns, begin = self._times[after - 1], self._past[after - 1]
        if after == len(self._times) or begin_ns == time_ns:
            return begin[2]
        end = self._past[after]
        step_s = (self._times[after] - begin_ns) * 1e-9
        ends = (begin[2], begin[3], end[2], end[3])
        return hermite((time_ns - begin_ns) * 1e-9, step_s, ends)
