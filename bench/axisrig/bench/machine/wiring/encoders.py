"""Wires of encoders: what a drive sees of the motor and of the load."""

from collections.abc import Callable

from axisrig.bench.drive.axis.ports import AxisPort, ControlKind
from axisrig.bench.machine.wiring.window import Span
from axisrig.kernel.time.clock import Clock, TimeNs

Seen = Callable[[TimeNs, float], float]


class EncoderWire:
    """An axis as its drive sees it. second: what is made of the second encoder.

    offset_m: what was lost of the motor encoder. The drive goes on with what it has counted, so its
    demand is off by as much. span: from when to when the motor encoder gives no new position. The
    position loop is a part of the plant and has an encoder of its own: it does not freeze.
    """

    def __init__(self, axis: AxisPort, clock: Clock, second: Seen) -> None:
        self._axis, self._clock, self._second = axis, clock, second
        self.offset_m = 0.0
        self.span = Span()
        self._frozen_m = 0.0

    def begin_freeze(self) -> None:
        """Keep the position that is seen now."""
        now_ns = self._clock.now_ns
        self._axis.advance_to(now_ns)
        self._frozen_m = self._axis.motor_position_m() - self.offset_m
        self.span.begin_ns, self.span.end_ns = now_ns, None

    def end_freeze(self) -> None:
        """See the motor again; what it went meanwhile is counted."""
        self.span.end_ns = self._clock.now_ns

    def lose(self, way_m: float) -> None:
        """Lose so much of the way that the motor goes in its present direction, up at rest."""
        self._axis.advance_to(self._clock.now_ns)
        self.offset_m += way_m if self._axis.motor_velocity_m_s() >= 0.0 else -way_m

    # What it changes

    def motor_position_m(self) -> float:
        """Return what the drive sees of the motor now."""
        return self._seen_m(self._clock.now_ns, self._axis.motor_position_m())

    def motor_position_m_at(self, time_ns: TimeNs) -> float:
        """Return what the drive saw of the motor at a past instant."""
        return self._seen_m(time_ns, self._axis.motor_position_m_at(time_ns))

    def motor_velocity_m_s(self) -> float:
        """Return the velocity that the drive sees."""
        is_frozen = self.span.holds(self._clock.now_ns)
        return 0.0 if is_frozen else self._axis.motor_velocity_m_s()

    def _seen_m(self, time_ns: TimeNs, position_m: float) -> float:
        return self._frozen_m if self.span.holds(time_ns) else position_m - self.offset_m

    def command(
        self,
        time_ns: TimeNs,
        position_m: float,
        velocity_m_s: float,
        end_ns: TimeNs,
        enabled: bool,
    ) -> None:
        """Control the position, in what the drive has counted."""
        self._axis.command(time_ns, position_m + self.offset_m, velocity_m_s, end_ns, enabled)

    def demand_position_m(self) -> float:
        """Return the demand now, in what the drive has counted."""
        return self._axis.demand_position_m() - self.offset_m

    def second_encoder_m(self) -> float | None:
        """Return what the second encoder sees now."""
        seen_m = self._axis.second_encoder_m()
        return None if seen_m is None else self._second(self._clock.now_ns, seen_m)

    def second_encoder_m_at(self, time_ns: TimeNs) -> float:
        """Return what the second encoder saw at a past instant."""
        return self._second(time_ns, self._axis.second_encoder_m_at(time_ns))

    # What it passes

    @property
    def kinds(self) -> frozenset[ControlKind]:
        """Kinds of control that the plant offers."""
        return self._axis.kinds

    @property
    def limits_force(self) -> bool:
        """Whether `limit_force` acts on this plant."""
        return self._axis.limits_force

    def advance_to(self, time_ns: TimeNs) -> None:
        """Step the plant to an instant."""
        self._axis.advance_to(time_ns)

    def command_velocity(
        self, time_ns: TimeNs, velocity_m_s: float, acceleration_m_s2: float, end_ns: TimeNs
    ) -> None:
        """Control the velocity."""
        self._axis.command_velocity(time_ns, velocity_m_s, acceleration_m_s2, end_ns)

    def command_force(self, time_ns: TimeNs, force_n: float) -> None:
        """Control the motor force."""
        self._axis.command_force(time_ns, force_n)

    def limit_force(self, negative_n: float, positive_n: float) -> None:
        """Limit the motor force."""
        self._axis.limit_force(negative_n, positive_n)

    def force_n(self) -> float | None:
        """Return the motor force now."""
        return self._axis.force_n()
