"""Homing and adoption among the single axes by hand: order, times, breaking off, the way back."""

from typing import Any

from tests.channel.program_by_hand import Program
from tests.channel.single_axes.test_independent_by_hand import BLOCK, Bench, single

from axisrig.kernel.channel.axes.single_axes import SingleAxes
from axisrig.kernel.channel.path.settling import REST_CYCLES
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS


class DriveHome:
    """The homing of one drive, which ends when the test says so."""

    def __init__(self) -> None:
        self.is_done = False
        self.steps = self.aborts = 0

    def step(self) -> None:
        self.steps += 1

    def abort(self) -> None:
        self.aborts += 1


class Homed(Bench):
    """Single axes X and Y with drives that home; put: what the path was put to, newest last."""

    def __init__(self) -> None:
        super().__init__()
        self.homes: dict[str, DriveHome] = {}
        self.put: list[tuple[str, float]] = []
        self.forgotten: list[str] = []
        self.settled_anew: list[int] = []
        for name, link in self.links.items():
            link.home = lambda _clock, name=name: self.homes.setdefault(name, DriveHome())
            link.place_mm, link.actual_increments = self.places_mm[name] + 0.5, 500
        path: Any = self.axes._path
        path.put = lambda axis, mm: self.put.append((axis, mm))
        path.is_in_position = lambda: True
        path.settle_anew = lambda: self.settled_anew.append(self.clock.now_ns)
        measured: Any = self.measured
        measured.forget_prepared = self.forgotten.append
        self.single: SingleAxes = single(self)
        self.program = Program(self.single)

    def turn(self, count: int = 1) -> None:
        for _ in range(count):
            self.clock.now_ns += MS
            self.single.step()
            self.single.advance()

    def lead_back(self, count: int = 1) -> list[bool]:
        answers = []
        for _ in range(count):
            self.clock.now_ns += MS
            answers.append(self.single.lead_back())
        return answers

    def state(self) -> tuple[bool, bool]:
        return self.program.is_busy(), self.single.is_active


def test_groups_home_one_after_the_other_and_the_path_settles_after_the_last() -> None:
    """Y in 3 cycles, X in 2 more; the set position is the actual one while its drive looks."""
    bench = Homed()
    bench.program.say(canon.Homing(BLOCK, (("Y",), ("X",))))
    assert bench.forgotten == ["Y", "X"]
    assert (list(bench.homes), bench.state()) == (["Y"], (True, True))
    bench.turn(2)
    bench.homes["Y"].is_done = True
    bench.turn()
    assert bench.put == [("Y", 5.5)] * 2
    assert (bench.single.homed, bench.settled_anew) == ([(3 * MS, "Y")], [])
    assert (list(bench.homes), bench.state()) == (["Y", "X"], (True, True))
    bench.turn()
    bench.homes["X"].is_done = True
    bench.turn()
    assert bench.put[2:] == [("X", 0.5)]
    assert bench.single.homed == [(3 * MS, "Y"), (5 * MS, "X")]
    assert (bench.settled_anew, bench.state()) == ([5 * MS], (False, False))
    bench.turn(3)
    assert (bench.settled_anew, len(bench.single.homed), len(bench.put)) == ([5 * MS], 2, 3)
    assert bench.lead_back() == [True]


def test_a_second_stop_leaves_a_homing_that_was_broken_off_as_it_is() -> None:
    """The alarm stops and the reset stops again: the drive of Y still has to leave its mode."""
    bench = Homed()
    bench.program.say(canon.Homing(BLOCK, (("X", "Y"),)))
    bench.turn()
    bench.homes["X"].is_done = True
    bench.turn()
    bench.single.stop()
    bench.single.stop()
    assert bench.state() == (False, False)
    assert [bench.homes[axis].aborts for axis in "XY"] == [0, 1]
    bench.put.clear()
    assert bench.lead_back(REST_CYCLES) == [False] * REST_CYCLES
    assert bench.put == [("Y", 5.5)] * REST_CYCLES
    before = bench.homes["Y"].steps
    bench.links["Y"].actual_increments += 3  # it is moved once more: the rest begins anew
    assert bench.lead_back(REST_CYCLES) == [False] * REST_CYCLES
    assert bench.homes["Y"].steps == before
    bench.lead_back(2)
    assert bench.homes["Y"].steps > before
    bench.homes["Y"].is_done = True
    assert bench.lead_back(3) == [True] * 3
    assert bench.put[-1] == ("Y", 5.5)
    assert len(bench.put) == 2 * REST_CYCLES + 3
    assert bench.homes["X"].steps == 1


def test_every_way_back_waits_for_a_rest_of_its_own() -> None:
    bench = Homed()
    for axis in "XY":
        bench.program.say(canon.Homing(BLOCK, ((axis,),)))
        bench.turn(2)
        bench.single.stop()
        assert bench.lead_back(REST_CYCLES) == [False] * REST_CYCLES
        assert bench.homes[axis].steps == 2
        bench.homes[axis].is_done = True
        assert bench.lead_back() == [True]


def test_what_was_adopted_before_a_stop_is_adopted_no_more() -> None:
    bench = Homed()
    bench.program.say(canon.AdoptActual(BLOCK, ("X", "Y")))
    bench.turn(REST_CYCLES - 1)
    assert (bench.put, bench.state()) == ([], (True, True))
    bench.single.stop()
    bench.turn(2 * REST_CYCLES)
    assert (bench.put, bench.state()) == ([], (False, False))
    bench.program.say(canon.AdoptActual(BLOCK, ("Y", "X")))
    bench.turn(2 * REST_CYCLES)
    assert (bench.put, bench.state()) == ([("Y", 5.5), ("X", 0.5)], (False, False))


def test_an_alarm_on_the_way_home_names_no_axis_as_homed() -> None:
    bench = Homed()
    bench.program.say(canon.WaitIndependent(BLOCK, ("Y",)), canon.Homing(BLOCK, (("X",), ("Y",))))
    bench.turn()
    bench.single.stop()
    bench.homes["X"].is_done = True
    bench.turn(3)
    assert (bench.single.homed, list(bench.homes)) == ([], ["X"])
    assert (bench.settled_anew, bench.state()) == ([], (False, False))


def test_coupled_axes_are_watched_while_one_of_them_has_limits() -> None:
    bench = Homed()
    watched_ns: list[int] = []
    couplings: Any = bench.single.couplings
    couplings.watch = lambda: watched_ns.append(bench.clock.now_ns)
    couplings.switch_on = lambda _command: setattr(couplings, "watched", True)
    couplings.switch_off = lambda _command: setattr(couplings, "watched", False)
    couplings.end_program = lambda: setattr(couplings, "watched", False)
    bench.turn()
    bench.program.say(canon.AxisLinkOn(BLOCK, 1, ()))
    assert bench.single.is_active
    bench.turn(2)
    assert watched_ns == [2 * MS, 3 * MS]
    bench.single.stop()
    assert bench.single.is_active
    bench.program.say(canon.AxisLinkOff(BLOCK, 1))
    assert not bench.single.is_active
    bench.turn()
    bench.program.say(canon.AxisLinkOn(BLOCK, 1, ()))
    bench.single.end_program()
    assert not bench.single.is_active
    assert watched_ns == [2 * MS, 3 * MS]


def test_orders_of_single_axes_wait_until_the_independent_ones_are_there() -> None:
    bench = Homed()
    bench.program.say(canon.IndependentMove(BLOCK, "X", 1.0))
    ready = bench.program._ready
    kinds = (
        canon.AxisLinkOn, canon.AxisLinkOff, canon.Homing, canon.AxisExchange, canon.AdoptActual,
    )  # fmt: skip
    assert not any(ready[kind]() for kind in kinds)
    bench.turn(200)
    assert all(ready[kind]() for kind in kinds)
    path: Any = bench.axes._path
    path.is_in_position = lambda: False
    at_rest = {kind for kind in kinds if ready[kind]()}
    assert at_rest == {canon.AxisLinkOff, canon.AxisExchange, canon.AdoptActual}
    path.has_stopped, path.is_in_position = False, lambda: True
    assert not any(ready[kind]() for kind in (canon.AxisLinkOff, canon.AxisExchange))
    assert not ready[canon.AdoptActual]()
