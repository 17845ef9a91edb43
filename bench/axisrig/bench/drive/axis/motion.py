"""What the axis follows: one loop at a time, or no power at all."""

from axisrig.bench.drive.axis.ports import AxisPort, ControlKind
from axisrig.kernel.time.clock import S, TimeNs

POSITION, VELOCITY, FORCE = ControlKind.POSITION, ControlKind.VELOCITY, ControlKind.FORCE


class Motion:
    """The demand of an axis in SI units. kind: the loop that is the outermost, None = power off."""

    __slots__ = ("_begin_ns", "_end_ns", "_rate", "_start", "axis", "kind")

    def __init__(self, axis: AxisPort) -> None:
        self.axis = axis
        self.kind: ControlKind | None = None
        self._begin_ns = self._end_ns = 0
        self._start = self._rate = 0.0

    @property
    def controls_velocity(self) -> bool:
        """Whether the plant takes a velocity."""
        return VELOCITY in self.axis.kinds

    def off(self, now_ns: TimeNs) -> None:
        """Take the power away; the demand is where the axis is."""
        self.kind = None
        self.axis.command(now_ns, self.axis.motor_position_m(), 0.0, now_ns, False)

    def ramp(self, now_ns: TimeNs, from_m: float, to_m: float, end_ns: TimeNs) -> None:
        """Move the position demand evenly to `to_m`, where it is at `end_ns`."""
        rate = (to_m - from_m) * S / (end_ns - now_ns) if end_ns > now_ns else 0.0
        self.glide(now_ns, from_m, rate, end_ns)

    def glide(self, now_ns: TimeNs, from_m: float, velocity_m_s: float, end_ns: TimeNs) -> None:
        """Move the position demand from `from_m` with a velocity until `end_ns`."""
        self.kind = POSITION
        self._begin_ns, self._end_ns, self._rate = now_ns, end_ns, velocity_m_s
        self.axis.command(now_ns, from_m, velocity_m_s, end_ns, True)

    def speed(self, now_ns: TimeNs, from_m_s: float, to_m_s: float, end_ns: TimeNs) -> None:
        """Change the velocity demand evenly to `to_m_s`, where it is at `end_ns`, then keep it."""
        if end_ns > now_ns:
            self._start, self._rate = from_m_s, (to_m_s - from_m_s) * S / (end_ns - now_ns)
        else:
            self._start, self._rate = to_m_s, 0.0
        self.kind = VELOCITY
        self._begin_ns, self._end_ns = now_ns, end_ns
        self.axis.command_velocity(now_ns, self._start, self._rate, end_ns)

    def force(self, now_ns: TimeNs, force_n: float) -> None:
        """Demand a motor force."""
        self.kind = FORCE
        self.axis.command_force(now_ns, force_n)

    def position_m(self) -> float:
        """Return the position demand now; the actual position where none is followed."""
        if self.kind is POSITION:
            return self.axis.demand_position_m()
        return self.axis.motor_position_m()

    def velocity_m_s(self, now_ns: TimeNs) -> float:
        """Return the velocity of the demand now; the actual one where none is followed.

        A position demand whose end is less than one period ago counts as moving: its next
        piece is about to come.
        """
        if self.kind is POSITION:
            is_late = now_ns - self._end_ns > self._end_ns - self._begin_ns
            return 0.0 if is_late else self._rate
        if self.kind is VELOCITY:
            return self._start + self._rate * (min(now_ns, self._end_ns) - self._begin_ns) / S
        return self.axis.motor_velocity_m_s()
