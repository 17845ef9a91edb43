"""Axes in closed form behind the drives of a channel, and a probe over a plane.

An axis is a position loop of first order, x' = Kv (demand - x). On a demand of constant velocity
x(t) = demand(t) - v/Kv + C exp(-Kv t), so every position and every crossing is exact.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from axisrig.bench.drive.axis.ports import ControlKind
from axisrig.kernel.time.clock import S


@dataclass(frozen=True)
class Piece:
    """Motion from `begin_ns` on: position there, and the demand (a ramp that ends at `end_ns`)."""

    begin_ns: int
    position_m: float
    demand_m: float
    velocity_m_s: float
    end_ns: int
    enabled: bool

    def demand_at(self, time_ns: int) -> float:
        return self.demand_m + self.velocity_m_s * (min(time_ns, self.end_ns) - self.begin_ns) / S

    def position_at(self, time_ns: int, kv: float) -> float:
        if not self.enabled:
            return self.position_m
        ramp_end_ns = max(self.begin_ns, min(time_ns, self.end_ns))
        lag_m = self.velocity_m_s / kv
        rest = self.position_m - self.demand_m + lag_m
        on_ramp_m = self.demand_at(ramp_end_ns) - lag_m
        on_ramp_m += rest * math.exp(-kv * (ramp_end_ns - self.begin_ns) / S)
        gap = on_ramp_m - self.demand_at(ramp_end_ns)
        return self.demand_at(ramp_end_ns) + gap * math.exp(-kv * (time_ns - ramp_end_ns) / S)


class FirstOrderAxis:
    """The axis. droop_m: how far it stays away from where it should be. stop_m: it gets no further
    up; the loop behind it goes on as if it did, as far as nothing else is asked of it.
    """

    kinds = frozenset({ControlKind.POSITION})
    limits_force = False

    def __init__(
        self,
        world: "World",
        start_m: float,
        kv: float,
        droop_m: float = 0.0,
        stop_m: float = math.inf,
    ) -> None:
        self._world, self.kv, self.droop_m, self.stop_m = world, kv, droop_m, stop_m
        self.height_mm: Callable[[int], float] | None = None
        self.pieces = [Piece(0, start_m, start_m, 0.0, 0, False)]

    def _piece(self, time_ns: int) -> Piece:
        return next(p for p in reversed(self.pieces) if p.begin_ns <= time_ns)

    def position_at(self, time_ns: int) -> float:
        return self._piece(time_ns).position_at(time_ns, self.kv)

    def demand_at(self, time_ns: int) -> float:
        return self._piece(time_ns).demand_at(time_ns)

    def advance_to(self, time_ns: int) -> None:
        self._world.advance_to(time_ns)

    def command(
        self, time_ns: int, position_m: float, velocity_m_s: float, end_ns: int, enabled: bool
    ) -> None:
        here_m = self.position_at(time_ns)
        self.pieces.append(Piece(time_ns, here_m, position_m, velocity_m_s, end_ns, enabled))

    def motor_position_m(self) -> float:
        return self.motor_position_m_at(self._world.now_ns)

    def motor_velocity_m_s(self) -> float:
        return 0.0

    def limit_force(self, negative_n: float, positive_n: float) -> None:
        pass

    def force_n(self) -> float | None:
        return None

    def second_encoder_m(self) -> float | None:
        if self.height_mm is None:
            return None
        now_ns = self._world.now_ns
        return (self.height_mm(now_ns) / 1e3) - self.position_at(now_ns)

    def demand_position_m(self) -> float:
        return self.demand_at(self._world.now_ns)

    def motor_position_m_at(self, time_ns: int) -> float:
        assert time_ns <= self._world.now_ns
        return min(self.position_at(time_ns) - self.droop_m, self.stop_m)


@dataclass
class PlaneProbe:
    """A probe that is deflected while an axis stands at or below a plane."""

    axis: FirstOrderAxis
    plane_m: float
    level: bool = False
    edges: list[tuple[int, bool]] = field(default_factory=list)

    def is_deflected(self, time_ns: int) -> bool:
        return self.axis.position_at(time_ns) <= self.plane_m

    def look(self, begin_ns: int, end_ns: int) -> None:
        """Find the crossing inside a step, to the nanosecond."""
        now = self.is_deflected(end_ns)
        if now == self.level:
            return
        low, high = begin_ns, end_ns
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if self.is_deflected(middle) == now else (middle, high)
        self.edges.append((high, now))
        self.level = now


class World:
    """All axes and the probe under one time."""

    def __init__(self) -> None:
        self.now_ns = 0
        self.probe: PlaneProbe | None = None

    def advance_to(self, time_ns: int) -> None:
        if time_ns > self.now_ns:
            if self.probe is not None:
                self.probe.look(self.now_ns, time_ns)
            self.now_ns = time_ns
