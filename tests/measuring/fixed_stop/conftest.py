"""Axes that follow a path of constant speed until a stop holds them; no machine, no ramps.

One cycle is 1 ms. The path leads every axis from 0 to its target; an axis is where its set position
is, less the running lag while that moves, and never behind its stop.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import hypot, inf

import pytest

from kernel.measuring.fixed_stop.run import FixedStopRun, StopPlan, Watched
from kernel.measuring.fixed_stop.settings import FixedStopSettings
from kernel.measuring.run import Order

MS = 1_000_000


@dataclass
class Axis:
    """A port of the run. force_mm: how far the set position leads an axis at its stop on."""

    name: str
    stop_mm: float = inf
    running_mm: float = 0.0
    set_mm: float = 0.0
    actual_mm: float = 0.0
    watches_lag: bool = True

    @property
    def lag_mm(self) -> float:
        return self.set_mm - self.actual_mm

    def follow(self, set_mm: float) -> None:
        moves, self.set_mm = set_mm != self.set_mm, set_mm
        self.actual_mm = min(set_mm - (self.running_mm if moves else 0.0), self.stop_mm)


@dataclass
class Stage:
    """A run, its axes and the motion that it orders: the motion of the run itself too."""

    axes: dict[str, Axis]
    target_mm: dict[str, float]
    speed_mm_s: float = 10.0
    settings: dict[str, FixedStopSettings] = field(default_factory=dict)
    beside: tuple[Axis, ...] = ()
    is_error: bool = True
    brake_cycles: int = 3
    holds: range = range(0)  # cycles of a feedhold
    exact_stop_mm: float = 0.01
    travelled_mm: float = 0.0
    cycle: int = 0
    orders: list[tuple[int, Order]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._way: list[dict[str, float]] = []
        moved = [self.axes[name] for name in self.target_mm]
        self.length_mm = hypot(*self.target_mm.values())
        watched = [Watched(axis, self.settings[axis.name], self.exact_stop_mm) for axis in moved]
        measuring = (*self.axes.values(),)
        plan = StopPlan(
            measuring,
            watched,
            moved,
            self.length_mm,
            self.is_error,
            self._rest,
            slaves=self.beside,
        )
        self.run = FixedStopRun(plan, self, "block N20", 0, MS)

    def _rest(self) -> Callable[[], bool]:
        begin, places = self.cycle, [axis.actual_mm for axis in self.axes.values()]

        def rests() -> bool:
            assert places == [axis.actual_mm for axis in self.axes.values()]
            return self.cycle >= begin + 50

        return rests

    @property
    def has_stopped(self) -> bool:
        return not self._way

    def is_in_position(self) -> bool:
        return not self._way and all(abs(a.lag_mm) < self.exact_stop_mm for a in self.axes.values())

    def step(self) -> Order:
        """One cycle: the run is evaluated, then the set positions go on."""
        self.cycle += 1
        order = self.run.evaluate(self.cycle * MS)
        if order is not Order.NONE:
            self.orders.append((self.cycle, order))
        if order is Order.START:
            self._lead(self.target_mm, self.length_mm)
        elif order is Order.BRAKE:
            del self._way[self.brake_cycles :]
        elif order is Order.RELAX:
            here = {name: self.axes[name].set_mm for name in self.run.targets_mm}
            way = [self.run.targets_mm[name] - at for name, at in here.items()]
            self._lead(self.run.targets_mm, hypot(*way))
        if self._way and self.cycle not in self.holds:
            for name, set_mm in self._way.pop(0).items():
                if name:
                    self.axes[name].follow(set_mm)
                else:
                    self.travelled_mm = set_mm
        else:
            for axis in self.axes.values():
                axis.follow(axis.set_mm)
        return order

    def _lead(self, target_mm: dict[str, float], length_mm: float) -> None:
        """Fill the way; the nameless entry is the path travelled."""
        here = {name: self.axes[name].set_mm for name in target_mm}
        count = max(1, round(length_mm / self.speed_mm_s * 1000))
        self._way = [
            {"": length_mm * k / count}
            | {n: at + (target_mm[n] - at) * k / count for n, at in here.items()}
            for k in range(1, count)
        ] + [{"": length_mm, **target_mm}]

    def finish(self, cycles_max: int = 20_000) -> FixedStopRun:
        while not self.run.is_done:
            self.step()
            assert self.cycle < cycles_max, "no end"
        return self.run

    def at(self, order: Order) -> int:
        """The cycle in which something was ordered."""
        (cycle,) = [cycle for cycle, given in self.orders if given is order]
        return cycle


@pytest.fixture
def stage() -> Callable[..., Stage]:
    """Return `make(Axis(..), .., target={..}, settings or lag criteria for all of them)`."""

    def make(*axes: Axis, target: dict[str, float], **more: object) -> Stage:
        detect = more.pop("detect", FixedStopSettings(lag_limit_mm=1.0, min_time_ns=50 * MS))
        settings = detect if isinstance(detect, dict) else dict.fromkeys(target, detect)
        return Stage({a.name: a for a in axes}, target, settings=settings, **more)  # type: ignore[arg-type]

    return make
