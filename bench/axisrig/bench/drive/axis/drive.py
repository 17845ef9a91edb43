"""What a machine asks of a virtual drive of any family, besides its words."""

from collections.abc import Callable, Sequence
from typing import Final, Protocol

from axisrig.bench.drive.axis.ports import AxisPort
from axisrig.kernel.time.clock import TimeNs

NEVER: Final = -1
"""Value of `sync_ns` until the first cycle."""
NO_TICK: Final = -1.0
"""Value of `lag_peak_m` where the drive has not looked between its last two cycles."""


class DriveLatch(Protocol):
    """What is seen of the latch of a probing input inside a drive, before any telegram shows it."""

    @property
    def is_enabled(self) -> bool:
        """Whether it is on."""
        ...

    def has_stored(self, is_rising: bool) -> bool:
        """Whether it has stored a position at an edge of this direction."""
        ...


class VirtualDrive:
    """A drive at an axis of the plant; a family derives its own from it.

    sync_ns: instant of the last cycle that it took part in, NEVER before the first one. tick_ns: of
    its own cycle, in which it gives the axis its demand. lag_peak_m: largest magnitude of demand -
    motor position at the ticks between the last two cycles, NO_TICK where it needed none: then the
    demand is straight between them. latches: of its probing inputs 1 and 2. latch_watches: called
    when one may have been enabled, switched off, or may have stored a position; they change
    nothing.
    """

    def __init__(self, tick_ns: TimeNs) -> None:
        self.sync_ns: TimeNs = NEVER
        self.tick_ns = tick_ns
        self.latches: Sequence[DriveLatch] = ()
        self.latch_watches: list[Callable[[], None]] = []
        self.lag_peak_m, self._lag_m = NO_TICK, NO_TICK

    def begin_cycle(self, now_ns: TimeNs) -> None:
        """Take part in a cycle: what was noted before belongs to the one that is over."""
        self.sync_ns = now_ns
        self.lag_peak_m, self._lag_m = self._lag_m, NO_TICK

    def note_lag(self, axis: AxisPort) -> None:
        """Note the lag at a tick, before anything acts there."""
        self._lag_m = max(self._lag_m, abs(axis.demand_position_m() - axis.motor_position_m()))

    @property
    def torque_limits(self) -> tuple[int, int, int] | None:
        """Largest torque, and the limits of negative and positive ones, per mille of the rated one.

        None where it has none.
        """
        return None

    @property
    def latch_instants_ns(self) -> list[list[TimeNs]]:
        """Instants of the edges that it has latched, by probing input."""
        return []

    @property
    def origin_units(self) -> int:
        """Where its zero is, in position units of its encoder."""
        return 0
