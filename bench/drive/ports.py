"""What a drive node needs of the world behind it: one axis and up to two probe signals."""

from collections.abc import Sequence
from typing import Protocol

from kernel.clock import TimeNs


class AxisPort(Protocol):
    """A servo axis of the plant, in SI units."""

    def advance_to(self, time_ns: TimeNs) -> None:
        """Bring the plant to `time_ns`; nothing happens when it is there already."""
        ...

    def command(
        self,
        time_ns: TimeNs,
        position_m: float,
        velocity_m_s: float,
        end_ns: TimeNs,
        enabled: bool,
    ) -> None:
        """Give the demand from `time_ns` on: a ramp from `position_m` that ends at `end_ns`."""
        ...

    def motor_position_m(self) -> float:
        """Return what the motor encoder sees now, in load units."""
        ...

    def motor_velocity_m_s(self) -> float:
        """Return the motor velocity now, in load units."""
        ...

    def demand_position_m(self) -> float:
        """Return the demand that the position controller follows now."""
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
