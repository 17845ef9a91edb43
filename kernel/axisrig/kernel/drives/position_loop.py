"""The position loop of an axis where the CNC closes it: set speed from lag and set position.

u(k) = Kv e(k) + f (s(k) - s(k - 1))/T with e(k) = s(k) - x(k): s the set position of this cycle, x
the actual position that came with it, Kv P-AXIS-00099, f the share of the feed-forward. At a steady
speed v the lag is e = (1 - f) v/Kv. x is as old as its telegram: the axis is nearer to s by v times
that age. Source: TF5200 position lag 102079243, commissioning 436095115; which share acts is
a decision of ours (docs/ambiguities.md).
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class LoopSettings:
    """Gain of a position loop and its feed-forward.

    kv_per_s: P-AXIS-00099. period_s: of the cycle. feed_forward: share of the set speed, 0 = none.
    """

    kv_per_s: float
    period_s: float
    feed_forward: float = 0.0


class PositionLoop:
    """One axis. lag_mm: what the controller has computed last. period_s: of the cycle.

    demand_mm_s: the speed of the set positions alone, (s(k) - s(k - 1))/T.
    """

    def __init__(self, settings: LoopSettings) -> None:
        self._kv = settings.kv_per_s
        self._forward_per_s = settings.feed_forward / settings.period_s
        self._per_s = 1.0 / settings.period_s
        self._set_mm = 0.0
        self.lag_mm = self.demand_mm_s = 0.0
        self.period_s = settings.period_s

    def hold(self, set_mm: float, actual_mm: float) -> None:
        """Take note of a cycle in which the drive does not follow."""
        self._set_mm, self.lag_mm = set_mm, set_mm - actual_mm

    def speed_mm_s(self, set_mm: float, actual_mm: float) -> float:
        """Return the set speed of this cycle."""
        moved_mm, self._set_mm = set_mm - self._set_mm, set_mm
        self.lag_mm, self.demand_mm_s = set_mm - actual_mm, self._per_s * moved_mm
        return self._kv * self.lag_mm + self._forward_per_s * moved_mm

    def open_mm_s(self, set_mm: float) -> float:
        """Return the set speed where the actual position is not known any more.

        That of the set positions alone, (s(k) - s(k - 1))/T: a lag from an old actual position
        would drive the axis on for ever.
        """
        moved_mm, self._set_mm = set_mm - self._set_mm, set_mm
        self.demand_mm_s = self._per_s * moved_mm
        return self.demand_mm_s
