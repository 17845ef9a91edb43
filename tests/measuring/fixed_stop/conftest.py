"""Axes that follow a path of constant speed until a stop holds them; no machine, no ramps.

One cycle is 1 ms. The path leads every axis from 0 to its target; an axis is where its set position
is, less the running lag while that moves, and never behind its stop.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import accumulate
from math import hypot, inf

import pytest

from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.measuring.fixed_stop_run import FixedStopRun, StopPlan, Watched
from axisrig.kernel.measuring.run import Order

MS = 1_000_000


@dataclass
class Axis:
    """A port of the run. swing_mm: how far it is off to either side from cycle to cycle.

    sign: of the direction in which its stop is, stop_mm and running_mm are amounts.
    """

    name: str
    stop_mm: float = inf
    running_mm: float = 0.0
    set_mm: float = 0.0
    actual_mm: float = 0.0
    watches_lag: bool = True
    swing_mm: float = 0.0
    sign: int = 1

    @property
    def lag_mm(self) -> float:
        return self.set_mm - self.actual_mm

    def follow(self, set_mm: float) -> None:
        moves, self.set_mm = set_mm != self.set_mm, set_mm
        way_mm = self.sign * set_mm - (self.running_mm if moves else 0.0)
        self.actual_mm = self.sign * min(way_mm, self.stop_mm)
        self.swing_mm = -self.swing_mm
        self.actual_mm += self.swing_mm


@dataclass
class Stage:
    """A run, its axes and the motion that it orders.

    slowing: the last cycles of the way to the target, each shorter than the one before. buffer: set
    positions reach the axes so many cycles late.
    """

    axes: dict[str, Axis]
    target_mm: dict[str, float]
    speed_mm_s: float = 10.0
    settings: dict[str, FixedStopSettings] = field(default_factory=dict)
    beside: tuple[Axis, ...] = ()
    is_error: bool = True
    brake_cycles: int = 3
    holds: range = range(0)  # cycles of a feedhold
    exact_stop_mm: float = 0.01
    slowing: int = 0
    buffer: int = 0
    travelled_mm: float = 0.0
    cycle: int = 0
    orders: list[tuple[int, Order]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._way: list[dict[str, float]] = []
        self._sent = deque([{n: a.set_mm for n, a in self.axes.items()}] * (self.buffer + 1))
        moved = [self.axes[name] for name in self.target_mm]
        self.length_mm = hypot(*self.target_mm.values())
        watched = [Watched(axis, self.settings[axis.name], self.exact_stop_mm) for axis in moved]
        measuring = (*self.axes.values(),)
        plan = StopPlan(
            measuring,
            watched,
            moved,
            lambda: tuple(axis.set_mm for axis in moved),
            self.length_mm,
            self.is_error,
            self._rest,
            slaves=self.beside,
        )
        self.run = FixedStopRun(plan, self, "block N20", 0, MS)

    def _rest(self) -> Callable[[], bool]:
        begin, places = self.cycle, [axis.actual_mm for axis in self.axes.values()]

        def rests() -> bool:
            assert [axis.actual_mm for axis in self.axes.values()] == pytest.approx(
                places, abs=1e-5
            )
            return self.cycle >= begin + 50

        return rests

    @property
    def has_stopped(self) -> bool:
        return not self._way and all(sent == self._sent[0] for sent in self._sent)

    def is_in_position(self) -> bool:
        return self.has_stopped and all(
            abs(a.lag_mm) < self.exact_stop_mm for a in self.axes.values()
        )

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
            here = {name: self._sent[-1][name] for name in self.run.targets_mm}
            way = [self.run.targets_mm[name] - at for name, at in here.items()]
            self._lead(self.run.targets_mm, hypot(*way))
        newest = dict(self._sent[-1])
        if self._way and self.cycle not in self.holds:
            newest |= self._way.pop(0)
            self.travelled_mm = newest.pop("")
        self._sent.append(newest)
        self._sent.popleft()
        for name, set_mm in self._sent[0].items():
            if name in self.target_mm:
                self.axes[name].follow(set_mm)
        return order

    def _lead(self, target_mm: dict[str, float], length_mm: float) -> None:
        """Fill the way; the nameless entry is the path travelled."""
        here = {name: self._sent[-1][name] for name in target_mm}
        step_mm, slowing = self.speed_mm_s / 1000, self.slowing
        steps = [step_mm * (slowing - k) / (slowing + 1) for k in range(slowing)]
        count = max(1, round((length_mm - sum(steps)) / step_mm))
        free = [step_mm * (k + 1) for k in range(count)]
        places = [*free, *(free[-1] + way for way in accumulate(steps))]
        shares = [place / places[-1] for place in places]
        self._way = [
            {"": length_mm * share}
            | {n: at + (target_mm[n] - at) * share for n, at in here.items()}
            for share in shares[:-1]
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
