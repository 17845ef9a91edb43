"""What a drive node needs of its plant: one axis and its switching signals."""

from collections.abc import Sequence
from typing import Protocol

from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import TimeNs

__all__ = ["AxisPort", "ControlKind", "SignalPort"]


class AxisPort(Protocol):
    """A servo axis of the plant, in SI units; positions, velocities, forces in terms of the slide.

    A rotary axis takes and gives rad, rad/s, N.m in their places. The last command counts: it says
    which loop of the drive is the outermost. Power is off before the first one.
    """

    @property
    def kinds(self) -> frozenset[ControlKind]:
        """Kinds of control that the plant offers; position always."""
        ...

    @property
    def limits_force(self) -> bool:
        """Whether `limit_force` acts on this plant."""
        ...

    def advance_to(self, time_ns: TimeNs) -> None:
        """Step the plant to `time_ns`; nothing happens when it is there already."""
        ...

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
        ...

    def command_velocity(
        self,
        time_ns: TimeNs,
        velocity_m_s: float,
        acceleration_m_s2: float,
        end_ns: TimeNs,
    ) -> None:
        """Control the velocity, power on: it changes evenly until `end_ns`, then rests.

        Only where `kinds` has it.
        """
        ...

    def command_force(self, time_ns: TimeNs, force_n: float) -> None:
        """Control the motor force, power on; only where `kinds` has it."""
        ...

    def limit_force(self, negative_n: float, positive_n: float) -> None:
        """Limit the motor force, whatever the kind of control; amounts, 0 or more.

        They count from the present instant on and beside the plant's own limit.
        """
        ...

    def force_n(self) -> float | None:
        """Return the motor force now; None: the plant does not give it."""
        ...

    def second_encoder_m(self) -> float | None:
        """Return what an encoder at the load sees now; None: there is none."""
        ...

    def second_encoder_m_at(self, time_ns: TimeNs) -> float:
        """Return what the encoder at the load saw at a past instant; only where there is one."""
        ...

    def motor_position_m(self) -> float:
        """Return what the motor encoder sees now, in load units."""
        ...

    def motor_velocity_m_s(self) -> float:
        """Return the motor velocity now, in load units."""
        ...

    def demand_position_m(self) -> float:
        """Return the demand that the position controller follows now.

        The actual position while it follows none (control of velocity or force).
        """
        ...

    def motor_position_m_at(self, time_ns: TimeNs) -> float:
        """Return the motor position at a past instant."""
        ...


class SignalPort(Protocol):
    """A switching signal wired to a digital input."""

    @property
    def level(self) -> bool:
        """Level now."""
        ...

    @property
    def edges(self) -> Sequence[tuple[TimeNs, bool]]:
        """Every edge so far, oldest first: instant and new level."""
        ...
