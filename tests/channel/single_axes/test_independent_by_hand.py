"""Axes beside the path by hand: how each begins, is overridden, measures, stops and ends."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.program_by_hand import Program

from axisrig.kernel.channel.axes.independent import IndependentAxes
from axisrig.kernel.channel.axes.single_axes import SingleAxes
from axisrig.kernel.channel.path.settling import SETTLED_CYCLES
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.run import Order
from axisrig.kernel.motion.dynamics import Dynamics, Motion
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.time.clock import MS

A_MM_S2, FASTEST_MM_S = 1000.0, 50.0
SLOPE = Slope(A_MM_S2, A_MM_S2, 1.0)
DYNAMICS = Dynamics(SLOPE, SLOPE, Slope(4000.0, 4000.0, 1.0), FASTEST_MM_S)
BLOCK = Block(2, 20, "N20")
SETTLED = SETTLED_CYCLES + 2
"""Cycles after which an axis without a lag is at rest: the first and the last count too."""


class Measured:
    """The measurement of a channel that lets every run be led by hand."""

    def __init__(self) -> None:
        self.kept: list[Any] = []
        self.checked: list[tuple[str, int, bool]] = []
        self.armed: list[tuple[Any, ...]] = []
        self.orders: list[Order] = []
        self.alarm: Alarm | None = None
        self.rests: list[Any] = []
        self.wanted_mm_s: list[float] = []
        self.run: Any = None

    def check(self, axis: str, type_: int, *, is_beside: bool) -> None:
        self.checked.append((axis, type_, is_beside))

    def arm(self, kind: int, axes: tuple[str, ...], block: Block, **more: Any) -> Any:
        self.armed.append((kind, axes, block.number, more["error_no_signal"]))
        self.run = SimpleNamespace(
            record=object(), is_done=False, aborted=0, state=SimpleNamespace(name="MOVING"),
            evaluate=self._evaluate, abort=self._abort,
        )  # fmt: skip
        return self.run

    def _evaluate(self, _now_ns: int, is_standing: bool, rest_ns: int | None) -> Order:
        self.rests.append((is_standing, rest_ns))
        if self.alarm is not None:
            raise self.alarm
        return self.orders.pop(0) if self.orders else Order.NONE

    def _abort(self) -> None:
        self.run.aborted += 1

    def standstill(self, _axes: tuple[str, ...]) -> Any:
        return SimpleNamespace(look=lambda has_ended: 77 if has_ended else None)

    def within_stroke(self, _type: int, _axes: tuple[str, ...], dynamics: Dynamics) -> Dynamics:
        return replace(dynamics, speed_max_mm_s=8.0)

    def speed_mm_s(self, _type: int, _block: Block, *given: Any) -> float:
        _, _, wanted_mm_s, dynamics = given
        self.wanted_mm_s.append(wanted_mm_s)
        return min(0.5 * float(wanted_mm_s), float(dynamics.speed_max_mm_s))

    def keep(self, record: Any) -> None:
        self.kept.append(record)


class Bench:
    """Axes beside a path at (0, 5) whose drives follow without a lag."""

    def __init__(self) -> None:
        self.clock: Any = SimpleNamespace(now_ns=0)
        self.places_mm = {"X": 0.0, "Y": 5.0}
        self.stands = True
        self.released: list[str] = []
        self.asked: list[tuple[Motion, str]] = []
        path: Any = SimpleNamespace(
            position_acs_mm=self.places_mm.__getitem__, settings=self._settings,
            require_reach=lambda *_any: None, lead=self.places_mm.__setitem__, has_stopped=True,
            release=self.released.append, has_axis_stopped=lambda _axis: self.stands,
            superposed_mm=lambda _axis: 0.0,
            programmed=SimpleNamespace(default_slope="STEP"),
        )  # fmt: skip
        self.links: Any = {name: SimpleNamespace(name=name, lag_mm=0.0) for name in self.places_mm}
        self.measured = Measured()
        self.overrides = dict.fromkeys(self.places_mm, 1000)
        given: Any = (
            self.clock, SimpleNamespace(period_ns=MS, offset_ns=0), path, self.measured, self.links,
        )  # fmt: skip
        self.axes = IndependentAxes(*given, self.overrides.__getitem__)
        self.track_mm: dict[str, list[float]] = {name: [] for name in self.places_mm}

    def _settings(self, axis: str) -> Any:
        return SimpleNamespace(
            name=axis, window_mm=0.1, settling_ns=0, dynamics_of=self._dynamics,
            measuring=SimpleNamespace(overtravel_mm=lambda _type: 0.5),
        )  # fmt: skip

    def _dynamics(self, motion: Motion, slope: str) -> Dynamics:
        self.asked.append((motion, slope))
        return DYNAMICS

    def cycle(self, count: int = 1) -> None:
        for _ in range(count):
            self.clock.now_ns += MS
            self.axes.step()
            self.axes.advance()
            for name, track_mm in self.track_mm.items():
                track_mm.append(self.places_mm[name])

    def go(self, axis: str = "X", target_mm: float = 10.0, **more: Any) -> None:
        self.axes.begin(canon.IndependentMove(BLOCK, axis, target_mm, **more))

    def steps(self, axis: str = "X") -> list[float]:
        track_mm = [0.0 if axis == "X" else 5.0, *self.track_mm[axis]]
        return [b - a for a, b in pairwise(track_mm)]

    def cycles_to(self, place_mm: float, axis: str = "X") -> int:
        return next(n for n, mm in enumerate(self.track_mm[axis], 1) if mm == place_mm)


# Motion


@pytest.mark.parametrize(
    ("more", "cycles", "motion"),
    [
        ({}, 250, Motion.RAPID),
        ({"feed_mm_min": 600.0}, 1010, Motion.FEED),
        ({"time_s": 2.0}, 2000, Motion.FEED),
        ({"speed_share": 0.4}, 520, Motion.FEED),
        ({"feed_mm_min": 6000.0}, 250, Motion.FEED),
        ({"feed_mm_min": 600.0, "acceleration_share": 0.1}, 1100, Motion.FEED),
    ],
)  # fmt: skip
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_motion_takes_way_by_speed_and_speed_by_acceleration(
    more: dict[str, float], cycles: int, motion: Motion, sign: float
) -> None:
    """10 mm at v with a: 10 / v + v / a; 50 mm/s and 1000 mm/s² are the most."""
    bench = Bench()
    bench.go(target_mm=10.0 * sign, **more)
    bench.cycle(cycles + 2)
    assert bench.cycles_to(10.0 * sign) == cycles
    assert bench.asked == [(motion, "STEP")]
    assert not bench.axes.is_moving
    (ended,) = bench.axes.ended
    assert (ended[0], ended[1].block, ended[2]) == (cycles * MS, BLOCK, False)
    assert (bench.released, bench.axes.block_of("X")) == (["X"], None)


def test_the_braking_too_has_the_share_of_its_acceleration() -> None:
    bench = Bench()
    bench.go(feed_mm_min=600.0, acceleration_share=0.1)
    bench.cycle(1100)
    steps = bench.steps()
    assert steps == pytest.approx(steps[::-1], abs=1e-9)
    assert steps[0] == pytest.approx(0.5 * 100.0 * 1e-6, abs=1e-9)


def test_an_axis_has_the_slope_that_its_command_names() -> None:
    bench = Bench()
    bench.go(slope="TRAPEZ")
    bench.go("Y", 0.0)
    assert bench.asked == [(Motion.RAPID, "TRAPEZ"), (Motion.RAPID, "STEP")]
    assert (bench.axes.is_moving, bench.axes.are_moving(("Z",))) == (True, False)
    assert bench.axes.are_moving(("Z", "Y"))
    assert bench.axes.block_of("Y") is BLOCK


def test_an_axis_at_its_target_does_not_begin() -> None:
    bench = Bench()
    bench.go(target_mm=0.0)
    assert not bench.axes.is_moving
    with pytest.raises(Alarm) as caught:
        bench.go(target_mm=0.0, measuring_type=1)
    assert (caught.value.id, bench.axes.is_moving) == (900103, False)


@pytest.mark.parametrize(("permille", "cycles"), [(500, 2005), (1500, 682), (1000, 1010)])
def test_an_override_scales_the_speed_from_the_begin_on(permille: int, cycles: int) -> None:
    """10 mm at 5, 15 and 10 mm/s: 2 s + 5 ms, 0.667 s + 15 ms, 1 s + 10 ms."""
    bench = Bench()
    bench.overrides["X"] = permille
    bench.go(feed_mm_min=600.0)
    bench.cycle(cycles + 1)
    assert bench.cycles_to(10.0) == cycles


def test_an_axis_that_is_held_from_the_begin_on_goes_when_it_may() -> None:
    bench = Bench()
    bench.overrides["X"] = 0
    bench.go(feed_mm_min=600.0)
    bench.cycle(50)
    assert (bench.places_mm["X"], bench.axes.is_moving) == (0.0, True)
    bench.overrides["X"] = 1000
    bench.cycle(1011)
    assert bench.cycles_to(10.0) == 1060
    assert max(bench.steps()) == pytest.approx(0.01, abs=1e-9)


def test_an_axis_that_is_held_on_its_way_brakes_and_goes_on() -> None:
    bench = Bench()
    bench.go(feed_mm_min=600.0)
    bench.cycle(100)
    bench.overrides["X"] = 0
    bench.cycle(50)
    assert bench.steps()[-1] == 0.0
    assert bench.places_mm["X"] == pytest.approx(1.0, abs=1e-9)  # 0.95 + 0.05
    bench.overrides["X"] = 1000
    bench.cycle(920)
    assert (bench.places_mm["X"], bench.axes.is_moving) == (10.0, False)


def test_a_stop_brakes_as_a_signal_does_and_is_reported() -> None:
    bench = Bench()
    bench.go(feed_mm_min=2400.0)
    bench.go("Y", 5.04, feed_mm_min=600.0)
    bench.cycle(100)
    before_mm = bench.places_mm["X"]
    bench.axes.stop()
    bench.cycle(20)
    assert bench.places_mm["X"] - before_mm == pytest.approx(40.0**2 / 8000.0, abs=1e-9)
    assert [(c.axis, is_stopped) for _, c, is_stopped in bench.axes.ended] == [
        ("Y", False), ("X", True),
    ]  # fmt: skip


# Measuring


def test_a_run_begins_when_its_axis_is_at_rest_and_ends_by_its_signal() -> None:
    bench = Bench()
    bench.stands = False
    bench.go(target_mm=-10.0, feed_mm_min=1200.0, measuring_type=1, error_no_signal=True)
    bench.cycle(40)
    assert (bench.axes.measuring_state("X"), bench.measured.armed) == ("WAITING", [])
    bench.stands = True
    bench.cycle(5)
    bench.stands = False
    bench.cycle(1)
    bench.stands = True
    bench.cycle(10)
    assert bench.axes.measuring_state("X") == "WAITING"
    bench.cycle(2)
    assert bench.measured.armed == [(1, ("X",), 20, True)]
    assert (bench.axes.measuring_state("X"), bench.axes.measuring_state("Y")) == ("MOVING", None)
    assert bench.measured.checked == [("X", 1, True)]
    assert bench.asked == [(Motion.MEASURING, "STEP")]
    bench.measured.orders = [Order.START]
    bench.cycle(100)
    assert min(bench.steps()) == pytest.approx(-0.008, abs=1e-9)  # within the stroke
    bench.measured.orders = [Order.BRAKE]
    bench.cycle(30)
    assert bench.steps()[-1] == 0.0
    assert bench.axes.is_moving
    assert bench.measured.rests[-1] == (True, 77)
    bench.measured.run.is_done = True
    bench.cycle()
    assert (bench.measured.kept, bench.axes.is_moving) == ([bench.measured.run.record], False)
    assert [ended[2] for ended in bench.axes.ended] == [False]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_run_without_a_signal_goes_past_its_target(sign: float) -> None:
    bench = Bench()
    bench.go(target_mm=sign, feed_mm_min=600.0, measuring_type=1)
    bench.cycle(SETTLED)
    bench.measured.orders = [Order.START]
    bench.cycle(400)
    assert bench.places_mm["X"] == 1.5 * sign
    assert max(abs(step) for step in bench.steps()) == pytest.approx(0.005, abs=1e-9)


@pytest.mark.parametrize("feed_mm_min", [600.0, 3000.0, 6000.0])
def test_the_speed_of_a_run_is_asked_for_by_what_its_block_has(feed_mm_min: float) -> None:
    """A warning that it is too fast shows the feed of the program, also one above 50 mm/s."""
    bench = Bench()
    bench.go(target_mm=1.0, feed_mm_min=feed_mm_min, measuring_type=1)
    bench.cycle(SETTLED)
    bench.measured.orders = [Order.START]
    bench.cycle(2)
    assert bench.measured.wanted_mm_s == [feed_mm_min / 60.0]


@pytest.mark.parametrize(
    ("alarm_id", "reported_id"), [(900002, 50664), (900082, 50664), (900003, 900003)]
)
def test_an_alarm_of_a_run_has_the_place_of_its_block(alarm_id: int, reported_id: int) -> None:
    bench = Bench()
    bench.go(measuring_type=1)
    bench.cycle(SETTLED)
    bench.measured.alarm = Alarm(alarm_id, axis="X", cycles=1, others="")
    with pytest.raises(Alarm) as caught:
        bench.axes.step()
    assert (caught.value.id, caught.value.place) == (reported_id, BLOCK.place)


@pytest.mark.parametrize(
    ("place", "shown"), [(None, "line 2, block N20"), ("line 9, block N90", "line 9, block N90")]
)
def test_an_alarm_of_a_run_beside_the_path_keeps_the_place_that_it_has(
    place: str | None, shown: str
) -> None:
    bench = Bench()
    bench.go(measuring_type=1)
    bench.cycle(SETTLED)
    bench.measured.alarm = Alarm(900003, place=place, axis="X", others="Y")
    with pytest.raises(Alarm) as caught:
        bench.axes.step()
    assert (caught.value.id, caught.value.place) == (900003, shown)


@pytest.mark.parametrize("has_begun", [False, True])
def test_a_stop_ends_a_run_without_a_result(has_begun: bool) -> None:
    bench = Bench()
    bench.go(feed_mm_min=600.0, measuring_type=1)
    bench.cycle(SETTLED)
    if has_begun:
        bench.measured.orders = [Order.START]
        bench.cycle(50)
    bench.axes.stop()
    assert bench.measured.run.aborted == 1
    assert bench.axes.measuring_state("X") is None
    bench.cycle(10)
    assert (bench.axes.is_moving, bench.measured.kept) == (False, [])
    assert [is_stopped for _, _, is_stopped in bench.axes.ended] == [has_begun]


def test_a_stop_ends_a_run_that_waits_for_its_axis() -> None:
    bench = Bench()
    bench.stands = False
    bench.go(measuring_type=1)
    bench.cycle(3)
    bench.axes.stop()
    bench.stands = True
    bench.cycle(2 * SETTLED)
    assert (bench.axes.is_moving, bench.measured.armed) == (False, [])


# All single axes


def single(bench: Bench) -> SingleAxes:
    couplings: Any = SimpleNamespace(watched=False)
    given: Any = (
        bench.clock, SimpleNamespace(period_ns=MS, offset_ns=0), bench.axes._path,
        bench.measured, bench.links, couplings, bench.overrides.__getitem__,
    )  # fmt: skip
    return SingleAxes(*given)


def test_a_wait_is_over_when_the_axes_that_it_names_are_there() -> None:
    bench = Bench()
    axes = single(bench)
    program = Program(axes)
    assert not axes.is_active
    program.say(
        canon.IndependentMove(BLOCK, "X", 1.0), canon.IndependentMove(BLOCK, "Y", 50.0),
        canon.WaitIndependent(BLOCK, ("X",)),
    )  # fmt: skip
    assert (program.is_busy(), axes.is_active) == (True, True)
    was_busy = []
    while axes.independent.are_moving(("X",)):
        was_busy.append(program.is_busy())
        axes.step()
        axes.advance()
    assert set(was_busy) == {True}
    assert (program.is_busy(), axes.is_moving) == (False, True)
    program.say(canon.WaitIndependent(BLOCK, ("Y",)))
    assert program.is_busy()
    axes.stop()
    assert not program.is_busy()


def test_an_axis_that_is_given_away_is_forgotten_and_one_that_comes_is_not() -> None:
    bench = Bench()
    forgotten: list[str] = []
    measured: Any = bench.measured
    measured.forget_prepared = lambda axis: forgotten.append(f"latch {axis}")
    path: Any = bench.axes._path
    path.programmed.forget_times = lambda axis: forgotten.append(f"times {axis}")
    program = Program(single(bench))
    program.say(canon.AxisExchange(BLOCK, ("Y",), ("X",)))
    assert forgotten == ["latch Y", "times Y"]


def test_the_lag_of_an_axis_at_rest_becomes_its_position() -> None:
    bench = Bench()
    link: Any = bench.links["Y"]
    link.actual_increments, link.place_mm = 4000, 4.0
    put: list[tuple[str, float]] = []
    path: Any = bench.axes._path
    path.put = lambda axis, mm: put.append((axis, mm))
    axes = single(bench)
    program = Program(axes)
    program.say(canon.AdoptActual(BLOCK, ("Y",)))
    for _ in range(60):
        assert program.is_busy() is not bool(put)
        bench.clock.now_ns += MS
        axes.step()
        axes.advance()
    assert put == [("Y", 4.0)]
    assert (program.is_busy(), axes.is_active) == (False, False)
    program.say(canon.AdoptActual(BLOCK, ("Y",)))
    axes.stop()
    assert (program.is_busy(), axes.is_active) == (False, False)
