"""Axes beside the path by hand: runs to a fixed stop, what is asked before a motion, its speed."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.program_by_hand import Program
from tests.channel.single_axes.test_independent_by_hand import (
    BLOCK,
    FASTEST_MM_S,
    SETTLED,
    Bench,
    single,
)

from axisrig.kernel.channel.path.stop_way import StopWay
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.fixed_stop_run import FixedStopRun
from axisrig.kernel.measuring.run import Order
from axisrig.kernel.motion.dynamics import Motion
from axisrig.kernel.nc import canon

TO_STOP = 7  # the measuring type


class ByHand(FixedStopRun):
    """A run whose orders come from the test."""

    def __init__(self, orders: list[Order]) -> None:
        self.orders, self.asked_ns, self.aborted = orders, [], 0  # type: ignore[var-annotated]
        self.record: Any = object()
        self.targets_mm: dict[str, float] = {}
        self.is_over = False

    @property
    def state(self) -> Any:
        return SimpleNamespace(name="BRAKING")

    @property
    def is_done(self) -> bool:
        return self.is_over

    def evaluate(self, now_ns: int) -> Order:
        self.asked_ns.append(now_ns)
        return self.orders.pop(0) if self.orders else Order.NONE

    def abort(self) -> None:
        self.aborted += 1


class Stops(Bench):
    """Axes that run to a stop, with an offset of distance control; asked_mm: for their reach."""

    def __init__(self) -> None:
        super().__init__()
        self.armed: list[tuple[Any, ...]] = []
        self.asked_mm: list[tuple[str, float]] = []
        self.offset_mm = 0.0
        self.runs: dict[str, ByHand] = {}
        self.motions: dict[str, Any] = {}
        measured: Any = self.measured
        measured.arm_stop = self._arm_stop
        measured.speed_mm_s = lambda _type, _block, named, moving, wanted, dynamics: wanted
        measured.within_stroke = lambda _type, _axes, dynamics: dynamics
        path: Any = self.axes._path
        path.superposed_mm = lambda _axis: self.offset_mm
        path.require_reach = lambda axis, mm: self.asked_mm.append((axis, mm))

    def _arm_stop(self, axes: tuple[str, ...], way: StopWay, block: Any, motion: Any) -> ByHand:
        self.armed.append((axes, tuple(way.moved), way.length_mm, way.sent, block))
        run = self.runs[axes[0]] = ByHand([])
        self.motions[axes[0]] = motion
        return run

    def begin_run(self, axis: str, target_mm: float) -> ByHand:
        self.go(axis, target_mm, feed_mm_min=600.0, measuring_type=TO_STOP)
        self.cycle(SETTLED)
        run = self.runs[axis]
        run.orders.append(Order.START)
        self.cycle()
        return run


@pytest.mark.parametrize(
    ("axis", "target_mm", "way_mm"), [("X", 10.0, 10.0), ("X", -4.0, 4.0), ("Y", 2.0, 3.0)]
)
def test_a_run_to_a_stop_knows_its_way_whatever_its_direction(
    axis: str, target_mm: float, way_mm: float
) -> None:
    bench = Stops()
    bench.begin_run(axis, target_mm)
    assert bench.armed == [((axis,), (axis,), way_mm, None, BLOCK)]
    assert bench.asked == [(Motion.MEASURING, "STEP")]
    assert bench.axes.measuring_state(axis) == "BRAKING"
    motion = bench.motions[axis]
    bench.cycle(99)
    assert motion.travelled_mm == pytest.approx(0.95, abs=1e-9)  # 10 mm/s for 0.1 s, 1000 mm/s²
    assert not motion.has_stopped
    assert not motion.is_in_position()


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("offset_mm", [0.0, 0.25, -0.25])
def test_an_axis_at_a_stop_is_led_back_to_where_it_is_less_its_offset(
    sign: float, offset_mm: float
) -> None:
    """The speed is that of the run; the offset of distance control is added to what is sent."""
    bench = Stops()
    bench.offset_mm = offset_mm
    run = bench.begin_run("X", sign * 10.0)
    bench.cycle(300)
    run.orders.append(Order.BRAKE)
    bench.cycle(20)
    motion = bench.motions["X"]
    assert motion.has_stopped
    run.targets_mm = {"X": sign * 2.5}
    run.orders.append(Order.RELAX)
    before = len(bench.track_mm["X"])
    bench.cycle(100)
    assert bench.places_mm["X"] == pytest.approx(sign * 2.5 - offset_mm, abs=1e-12)
    assert max(abs(s) for s in bench.steps()[before:]) == pytest.approx(0.01, abs=1e-9)
    assert motion.is_in_position()
    run.is_over = True
    bench.cycle()
    assert bench.measured.kept == [run.record]
    assert (bench.axes.is_moving, bench.axes.is_measuring) == (False, False)
    assert [is_stopped for _, _, is_stopped in bench.axes.ended] == [False]


def test_an_axis_that_is_where_it_was_held_off_is_not_moved_back() -> None:
    bench = Stops()
    run = bench.begin_run("X", 10.0)
    run.orders.append(Order.BRAKE)
    bench.cycle(20)
    run.targets_mm = {"X": bench.places_mm["X"]}
    run.orders.append(Order.RELAX)
    bench.cycle(20)
    assert bench.steps()[-15:] == [0.0] * 15
    assert bench.motions["X"].is_in_position()


def test_a_stop_ends_a_run_to_a_stop_without_a_result() -> None:
    bench = Stops()
    run = bench.begin_run("X", 10.0)
    bench.cycle(50)
    bench.axes.stop()
    bench.cycle(20)
    assert (run.aborted, bench.measured.kept, bench.axes.is_moving) == (1, [], False)
    assert [is_stopped for _, _, is_stopped in bench.axes.ended] == [True]


# Whether any axis measures, and how far it is


def test_axes_measure_from_their_command_on_until_their_runs_are_over() -> None:
    bench = Stops()
    assert not bench.axes.is_measuring
    bench.go("Y", 6.0)
    bench.cycle()
    assert (bench.axes.is_moving, bench.axes.is_measuring) == (True, False)
    assert bench.axes.measuring_state("Y") is None
    bench.stands = False
    bench.go("X", 10.0, feed_mm_min=600.0, measuring_type=TO_STOP)
    assert bench.axes.is_measuring
    assert bench.axes.measuring_state("X") == "WAITING"
    bench.cycle(20)
    assert bench.axes.is_measuring  # it waits for its rest, with no probe armed yet
    bench.stands = True
    bench.cycle(SETTLED)
    assert bench.axes.is_measuring
    bench.runs["X"].is_over = True
    bench.cycle()
    assert not bench.axes.is_measuring
    assert bench.axes.measuring_state("X") is None


@pytest.mark.parametrize(
    ("on_path", "beside", "state"),
    [(None, False, None), ("MOVING", False, "MOVING"), (None, True, "WAITING"),
     ("ARMING", True, "ARMING")],
)  # fmt: skip
def test_the_run_of_an_axis_is_found_on_the_path_and_beside_it(
    on_path: str | None, beside: bool, state: str | None
) -> None:
    bench = Stops()
    measured: Any = bench.measured
    measured.state_of = lambda axis: on_path if axis == "X" else None
    axes = single(bench)
    if beside:
        axes.independent.begin(canon.IndependentMove(BLOCK, "X", 1.0, measuring_type=TO_STOP))
    assert (axes.measuring_state("X"), axes.measuring_state("Y")) == (state, None)


# What is asked before a motion


@pytest.mark.parametrize("measuring_type", [None, TO_STOP])
@pytest.mark.parametrize("target_mm", [4.0, 6.0, -1.0])
def test_the_reach_of_a_target_is_asked_for_in_both_directions(
    target_mm: float, measuring_type: int | None
) -> None:
    bench = Stops()
    bench.go("Y", target_mm, measuring_type=measuring_type)
    assert bench.asked_mm == [("Y", target_mm)]


def test_a_target_where_the_axis_stands_needs_no_reach_and_a_refused_one_moves_nothing() -> None:
    """An axis may stand past its switch; a run from there has no way left and is refused."""
    bench = Stops()
    bench.go("Y", 5.0)
    with pytest.raises(Alarm):
        bench.go("Y", 5.0, measuring_type=TO_STOP)
    assert bench.asked_mm == []
    assert bench.measured.checked == [("Y", TO_STOP, True)]

    def refuse(axis: str, _target_mm: float) -> None:
        raise Alarm(120002, axis=axis, position_mm="6.0000", limit_mm="5.5000")

    path: Any = bench.axes._path
    path.require_reach = refuse
    with pytest.raises(Alarm) as caught:
        bench.go("Y", 6.0)
    assert (caught.value.id, bench.axes.is_moving) == (120002, False)


# Speed


@pytest.mark.parametrize(("permille", "speed_mm_s"), [(1000, 50.0), (500, 25.0), (1500, 50.0)])
@pytest.mark.parametrize("more", [{"feed_mm_min": 6000.0}, {"feed_mm_min": 3000.0}, {}])
def test_an_override_is_of_the_speed_that_the_axis_can_have(
    more: dict[str, float], permille: int, speed_mm_s: float
) -> None:
    """A feed of 100 mm/s that the axis does not reach: half of it is half of its 50 mm/s."""
    bench = Stops()
    bench.overrides["X"] = permille
    bench.go(**more)
    bench.cycle(100)
    assert max(bench.steps()) == pytest.approx(speed_mm_s * 1e-3, abs=1e-9)


def test_the_share_of_a_speed_is_of_the_largest_and_none_is_all_of_it() -> None:
    assert FASTEST_MM_S == 50.0
    for share, speed_mm_s in ((None, 50.0), (1.0, 50.0), (0.1, 5.0)):
        bench = Stops()
        bench.go(speed_share=share)
        bench.cycle(100)
        assert max(bench.steps()) == pytest.approx(speed_mm_s * 1e-3, abs=1e-9)


@pytest.mark.parametrize("slope", ["STEP", "TRAPEZ", "SIN2"])
def test_a_motion_without_a_slope_has_that_of_the_channel(slope: str) -> None:
    bench = Bench()
    path: Any = bench.axes._path
    path.programmed.default_slope = slope
    bench.go()
    bench.go("Y", 1.0, slope="STEP", measuring_type=1)
    assert bench.asked == [(Motion.RAPID, slope), (Motion.MEASURING, "STEP")]


# Homings that were broken off


@pytest.mark.parametrize("groups", [(("X", "Y"),), (("X",), ("Y",))])
def test_every_homing_that_was_broken_off_is_led_back(groups: tuple[tuple[str, ...], ...]) -> None:
    """Whether one stop breaks off both or each has its own one."""
    bench = Bench()
    homes: dict[str, Any] = {}
    put: list[str] = []
    for name, link in bench.links.items():
        home = homes[name] = SimpleNamespace(is_done=False, abort=lambda: None, step=lambda: None)
        link.home = lambda _clock, home=home: home
        link.place_mm, link.actual_increments = 0.0, 0
    path: Any = bench.axes._path
    path.put = lambda axis, _mm: put.append(axis)
    path.is_in_position = lambda: True
    measured: Any = bench.measured
    measured.forget_prepared = lambda _axis: None
    axes = single(bench)
    program = Program(axes)
    for group in groups:
        program.say(canon.Homing(BLOCK, (group,)))
        axes.stop()
    put.clear()
    assert not axes.lead_back()
    assert put == ["X", "Y"]
    for home in homes.values():
        home.is_done = True
    bench.clock.now_ns += 10**9
    axes.lead_back()
    assert axes.lead_back()
