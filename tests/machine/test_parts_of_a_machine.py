"""Parts of a machine alone: rest, courses of the PLC side, control units, what a program waits for,
and printed lines. Nothing here runs a machine.
"""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.machine.mechanics import PlantMechanics
from axisrig.bench.machine.plc.control_units import PlcUnits
from axisrig.bench.machine.plc.side import PlcSide
from axisrig.bench.machine.recording.lag import largest_lag
from axisrig.bench.machine.unfinished_program import at_work, in_words, waited_for
from axisrig.bench.plan.assignment import parse_column
from axisrig.bench.rig.fmu_output import BYTES_MAX, cut, lines_in, output_lines
from axisrig.bench.rig.plc.axis_words import SetCourse, UnitWrite
from axisrig.bench.rig.plc.courses import Courses
from axisrig.bench.rig.plc.words import read_rules
from axisrig.kernel.channel import ChannelState
from axisrig.kernel.cosim.plant.outputs import MOTOR_VELOCITY
from axisrig.kernel.distance import DistanceCommand
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcInterface
from axisrig.kernel.plc.unit import DistanceUnit
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import new_scheduler

# --- rest after an alarm


class Rests:
    """Plants of two axes, X and Z, asked at an instant with the speeds of their motors."""

    def __init__(self, *, waits: bool = True, after_end_ms: int = 0) -> None:
        self.clock = SimpleNamespace(now_ns=0)
        self.axes = {name: SimpleNamespace(motion=[0.0] * 16) for name in "XZ"}
        plant: Any = SimpleNamespace(axes=self.axes)
        clock: Any = self.clock
        after_ns = after_end_ms * MS
        self.mechanics = PlantMechanics(clock, plant, waits=waits, after_end_ns=after_ns)

    def at(self, time_ms: float, x: float = 0.0, z: float = 0.0) -> bool:
        self.clock.now_ns = round(time_ms * MS)
        self.axes["X"].motion[MOTOR_VELOCITY], self.axes["Z"].motion[MOTOR_VELOCITY] = x, z
        return self.mechanics.has_come_to_rest()


@pytest.mark.interpreted
def test_rest_is_20_ms_below_a_tenth_of_a_mm_per_second() -> None:
    rests = Rests()
    assert not rests.at(100, z=1.0)
    assert not rests.at(110, x=1e-4, z=-1e-4)  # just slow enough
    assert not rests.at(129.999)
    assert rests.at(130)


@pytest.mark.interpreted
@pytest.mark.parametrize("axes", [{}, {"X": object()}])
def test_plants_go_on_to_the_sync_where_an_axis_is_simulated(axes: dict[str, Any]) -> None:
    """Without one nothing here moves: probes alone are asked at the instants of their readers."""
    went_ns: list[int] = []
    plant: Any = SimpleNamespace(axes=axes, advance_to=went_ns.append)
    mechanics = PlantMechanics(SimpleNamespace(now_ns=0), plant, waits=True)  # type: ignore[arg-type]
    for sync_ns in (1 * MS, 2 * MS):
        mechanics.advance_to(sync_ns)
    assert went_ns == ([1 * MS, 2 * MS] if axes else [])


@pytest.mark.interpreted
@pytest.mark.parametrize(("x", "z"), [(1.001e-4, 0.0), (0.0, -1.001e-4), (-5.0, 0.0)])
def test_an_axis_that_moves_again_begins_the_time_anew(x: float, z: float) -> None:
    rests = Rests()
    assert not rests.at(0)
    assert not rests.at(19)
    assert not rests.at(20, x, z)
    assert not rests.at(21)
    assert not rests.at(40)
    assert rests.at(41)


@pytest.mark.interpreted
def test_an_axis_that_does_not_rest_is_waited_for_half_a_second() -> None:
    rests = Rests()
    assert not rests.at(1000, z=0.5)
    assert not rests.at(1499.999, z=0.5)
    assert rests.at(1500, z=0.5)
    assert Rests(waits=False).at(0, z=5.0)


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("waits", "after_end_ms", "z", "over_ms"),
    [
        # Whatever takes longest: the time after the end, 20 ms of rest, 500 ms for who never rests
        (False, 30, 5.0, 30), (False, 0, 5.0, 0), (True, 0, 0.0, 20), (True, 10, 0.0, 20),
        (True, 100, 0.0, 100), (True, 100, 0.5, 500), (True, 600, 0.5, 600), (True, 600, 0.0, 600),
    ],
)  # fmt: skip
def test_a_run_goes_on_after_its_end_for_its_time_at_least(
    waits: bool, after_end_ms: int, z: float, over_ms: int
) -> None:
    rests = Rests(waits=waits, after_end_ms=after_end_ms)
    assert rests.mechanics.goes_on is (after_end_ms > 0)
    if over_ms:
        assert not rests.at(1000, z=z)
        assert not rests.at(1000 + over_ms - 0.001, z=z)
    assert rests.at(1000 + over_ms, z=z)


# --- lag between two rows


@pytest.mark.parametrize("tick_ns", [100_000, 250_000, 300_000])
def test_the_largest_lag_is_looked_for_at_the_ticks(tick_ns: int) -> None:
    """Motor on a cubic, demand on a line: both by numpy, at each tick and at the row itself."""
    period_s, demand = 1e-3, np.array([0.0, 0.4])
    motor, velocity = np.array([-0.1, 0.55]), np.array([900.0, -300.0])
    times = np.array([5_000_000, 6_000_000])
    found = largest_lag(times, (demand, motor, velocity), tick_ns)
    matrix = [[0, 0, 0, 1], [1, 1, 1, 1], [0, 0, 1, 0], [3, 2, 1, 0]]
    curve = np.linalg.solve(matrix, [*motor, *(velocity * period_s)])
    u = np.array([*np.arange(tick_ns, 1_000_000, tick_ns), 1_000_000]) / 1e6
    lags = np.abs(demand[0] + (demand[1] - demand[0]) * u - np.polyval(curve, u))
    assert found == pytest.approx([0.1, lags.max()])


def test_rows_apart_by_different_times_have_ticks_of_their_own() -> None:
    """A motor at rest, the demand away and back: within 1 ms no tick of 1 ms, within 2 ms one."""
    times = np.array([0, 1_000_000, 3_000_000, 3_000_000 + 500_000])
    demand = np.array([0.0, 1.0, -3.0, 0.0])
    lag = largest_lag(times, (demand, np.zeros(4), np.zeros(4)), 1_000_000)
    assert lag == pytest.approx([0.0, 1.0, 3.0, 0.0])
    # An axis that follows exactly with a speed at one end that is not its way: it is straight
    motor, velocity = np.array([0.0, 1.0]), np.array([0.0, 1000.0])
    lag = largest_lag(np.array([0, 1_000_000]), (motor, motor, velocity), 250_000)
    assert lag == pytest.approx([0.0, 0.0], abs=1e-12)


# --- feedholds of columns


class Held:
    """The PLC side of a channel with X and Z, and columns; turns of 1 ms."""

    def __init__(self, **cells: str) -> None:
        self.clock = new_scheduler()
        self.plc = PlcInterface(self.clock, "XZ")
        path = SimpleNamespace(is_moving=False)
        channel: Any = SimpleNamespace(
            plc=self.plc, path=path, records=[], program_ends_ns=[], resets_ns=[],
            distance=SimpleNamespace(axes={}), sync_ns=0,
        )  # fmt: skip
        columns = {name.replace("_", "."): cell for name, cell in cells.items()}
        rules = [
            rule
            for name, cell in columns.items()
            for rule in read_rules(parse_column(f"plc:{name}", cell), "XZ")[1]
        ]
        self.side = PlcSide(channel, {}, rules, self.clock, MS, lambda _: iter(()))

    def turn(self, *functions: int) -> str:
        """A cycle after these M functions; return what is held: P the path, X, Z."""
        block: Any = SimpleNamespace()
        for number in functions:
            self.plc.send(canon.TechnologyFunction(block, "M", number))
        self.side.take_turn()
        held = {"P": self.plc.feedhold, **{n: unit.feedhold for n, unit in self.plc.axis.items()}}
        self.clock.run_until(self.clock.now_ns + MS)
        return "".join(name for name, is_held in held.items() if is_held)


@pytest.mark.interpreted
def test_a_feedhold_until_a_moment_ends_there_and_comes_again() -> None:
    """The path from M50 to M51; Z from M50 until 2 ms after M52; X is nobody's."""
    on = Held(feedhold="at=M50 until=M51", Z_feedhold="at=M50 until=M52+2ms")
    assert [on.turn(), on.turn(50), on.turn(), on.turn(51), on.turn(52)] == [
        "",
        "PZ",
        "PZ",
        "Z",
        "Z",
    ]
    assert [on.turn() for _ in range(3)] == ["Z", "", ""]
    assert [on.turn(50), on.turn(52), on.turn(), on.turn(), on.turn(51)] == [
        *("PZ", "PZ", "PZ", "P", ""),
    ]
    assert on.turn(51, 52) == on.turn() == on.turn() == on.turn() == ""  # none is on


@pytest.mark.interpreted
def test_feedholds_that_overlap_hold_until_the_last_one_ends() -> None:
    """M50 holds Z 4 ms and until M51; twice M50 is let go by one M51."""
    on = Held(Z_feedhold="at=M50 for=4ms; at=M50 until=M51")
    assert [on.turn(50), on.turn(51)] == ["Z", "Z"]
    assert [on.turn() for _ in range(3)] == ["Z", "Z", ""]
    assert [on.turn(50), on.turn(50), *(on.turn() for _ in range(5))] == ["Z"] * 7
    assert [on.turn(51), on.turn(50), on.turn(51)] == ["", "Z", "Z"]
    assert [on.turn() for _ in range(4)] == ["Z", "Z", "", ""]


# --- courses and control units of the PLC side


class Plc:
    """A channel with the control units of Y and Z; turns of 1 ms."""

    def __init__(self) -> None:
        self.clock = new_scheduler()
        self.units = {name: DistanceUnit() for name in "YZ"}
        self.control = SimpleNamespace(set_pos_mm=None, set_dist_mm=2.0)
        channel: Any = SimpleNamespace(
            distance=SimpleNamespace(axes={"Z": SimpleNamespace(control=self.control)}),
            plc=SimpleNamespace(
                axis={name: SimpleNamespace(distance=unit) for name, unit in self.units.items()}
            ),
        )
        courses = Courses(self.clock, MS, self._at)
        self.plc = PlcUnits(channel, courses)
        self.done: list[str] = []

    def _at(self, time_ns: int, what: Callable[[], None]) -> None:
        self.clock.call_at(time_ns, Phase.APPLICATION, what)

    def course(self, name: str, **given: Any) -> None:
        self.plc.follow(SetCourse(**given), lambda: self.done.append(name))

    def turn(self, name: str = "Z") -> tuple[Any, Any, Any] | None:
        """Hand over and let the kernel take it; return what it took."""
        self.plc.hand_over()
        unit = self.units[name]
        if not unit.command_semaphor_rw:
            return None
        unit.command_semaphor_rw = False
        command = unit.command_w
        return command.transition, command.set_pos_mm, command.set_dist_mm


def test_a_set_value_is_led_evenly_from_where_it_is() -> None:
    plc = Plc()
    plc.course("one", axis="Z", value="set_dist_mm", to_mm=4.0, over_ns=4 * MS)
    values = []
    for time_ms in range(6):
        plc.clock.run_until(time_ms * MS)
        values.append(plc.turn())
    assert values == [*((None, None, mm) for mm in (2.0, 2.5, 3.0, 3.5, 4.0)), None]
    assert plc.done == ["one"]
    assert not plc.plc.is_waiting


def test_without_a_value_it_is_there_at_once_and_a_later_course_ends_this_one() -> None:
    plc = Plc()
    plc.course("at once", axis="Z", value="set_pos_mm", to_mm=7.0, over_ns=9 * MS)
    plc.course("of an axis without control", axis="Y", value="set_dist_mm", to_mm=1.0, over_ns=MS)
    assert plc.done == ["at once", "of an axis without control"]
    assert (plc.turn(), plc.turn("Y")) == ((None, 7.0, None), (None, None, 1.0))
    plc.course("first", axis="Z", value="set_dist_mm", to_mm=4.0, over_ns=4 * MS)
    plc.clock.run_until(2 * MS)
    plc.course("second", axis="Z", value="set_dist_mm", to_mm=-1.0, over_ns=0)
    assert plc.turn() == (None, None, -1.0)
    assert plc.done[2:] == ["second"]
    plc.clock.run_until(3 * MS)
    assert plc.done[2:] == ["second", "first"]
    assert plc.turn() is None


@pytest.mark.parametrize("waiting_mm", [8.0, 0.0, -1.0])
def test_a_course_goes_on_from_the_value_that_still_waits(waiting_mm: float) -> None:
    """Also from 0; the other value of the axis and those of another one begin where they are."""
    plc = Plc()
    plc.control.set_pos_mm = 20.0
    plc.units["Z"].command_semaphor_rw = True  # the kernel has not taken the one before
    plc.course("first", axis="Z", value="set_dist_mm", to_mm=waiting_mm, over_ns=0)
    plc.course("second", axis="Z", value="set_dist_mm", to_mm=10.0, over_ns=2 * MS)
    plc.course("other", axis="Z", value="set_pos_mm", to_mm=30.0, over_ns=2 * MS)
    plc.plc.hand_over()
    assert plc.plc.is_waiting
    plc.clock.run_until(MS)
    plc.units["Z"].command_semaphor_rw = False
    assert plc.turn() == (None, 25.0, (waiting_mm + 10.0) / 2)


def test_commands_go_over_one_by_one_with_the_set_values() -> None:
    plc = Plc()
    plc.plc.command(UnitWrite("Z", DistanceCommand.ON, set_pos_mm=1.0))
    plc.plc.command(UnitWrite("Z", DistanceCommand.FREEZE, set_dist_mm=5.0))
    plc.plc.command(UnitWrite("Y", DistanceCommand.OFF))
    plc.course("one", axis="Z", value="set_dist_mm", to_mm=4.0)
    assert plc.turn() == (DistanceCommand.ON, 1.0, 4.0)
    assert plc.units["Y"].command_w.transition is DistanceCommand.OFF
    assert (plc.units["Y"].enable_w, plc.units["Y"].command_semaphor_rw) == (True, True)
    assert plc.plc.is_waiting
    assert plc.turn() == (DistanceCommand.FREEZE, None, 5.0)
    assert not plc.plc.is_waiting
    assert plc.turn() is None


# --- what a program that does not end is about

BLOCK: Any = SimpleNamespace(place="main.nc:7", text="N70 G1 X1")


def channel(command: Any = None, state: ChannelState = ChannelState.RUNNING, **more: Any) -> Any:
    execution = SimpleNamespace(begun=command, head=None, is_busy=lambda: True, **more)
    links = [SimpleNamespace(name="X", actual_mm=1.0), SimpleNamespace(name="Z", actual_mm=-2.5)]
    return SimpleNamespace(
        state=state, execution=execution, path=SimpleNamespace(is_held=False), links=links
    )


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (canon.Dwell(BLOCK, 1_500_000_000), "the end of its dwell time of 1.5 s"),
        (canon.ProgramStop(BLOCK, optional=False), "the start of the operator (plc:start_ms)"),
        (canon.Wait(BLOCK, for_cycle=True), "the next cycle to ask the PLC side"),
        (canon.Wait(BLOCK), "the machine"),
        (canon.LinearMove(BLOCK, {"X": 1.5, "Z": -2.0}, False, 600.0),
         "the end of its move to X 1.5, Z -2 mm with 600 mm/min"),
        (canon.LinearMove(BLOCK, {"X": 1.5}, True, None), "the end of its move to X 1.5 mm"),
        (canon.IndependentMove(BLOCK, "Z", 12.25), "axis Z at 12.25 mm"),
        (canon.ExactStop(BLOCK), "the axes in their exact-stop windows"),
        (canon.EndOfProgram(BLOCK), "the axes in their exact-stop windows"),
        (canon.WaitIndependent(BLOCK, ("X",)), "independent axes at their targets"),
        (canon.DriveRead(BLOCK, "Z", "KEY"), "the answer of a drive"),
        (canon.Homing(BLOCK, (("X",),)), "homing"),
        (canon.TechnologyFunction(BLOCK, "M", 50), "the PLC side to acknowledge it"),
        (canon.AxisExchange(BLOCK, (), ("X",)), "the machine"),
    ],
)  # fmt: skip
def test_what_a_command_waits_for(command: Any, words: str) -> None:
    at = channel(command)
    assert waited_for(at) == words
    interpreter: Any = SimpleNamespace(busiest_loop=lambda: None)
    assert in_words(at, interpreter) == (
        f"main.nc:7 (N70 G1 X1) waits for {words}; the axes are at X 1.000, Z -2.500 mm"
    )


@pytest.mark.parametrize(
    ("state", "words"),
    [
        (ChannelState.STARTING, "the drives have not started"),
        (ChannelState.POWERING, "the drives are not enabled"),
        (ChannelState.STOPPING, "the axes do not come to rest after an alarm"),
        (ChannelState.RESETTING, "the axes do not come to rest after a reset"),
        (ChannelState.READY, "the PLC side still has something to do"),
        (ChannelState.ERROR, "the PLC side still has something to do after an alarm"),
        (ChannelState.ENDED, "the program has ended"),
        (ChannelState.RUNNING, "nothing has begun"),
    ],
)
def test_what_is_missing_where_no_command_is_at_work(state: ChannelState, words: str) -> None:
    at = channel(None if state is ChannelState.RUNNING else canon.ExactStop(BLOCK), state)
    assert at_work(at) is None
    assert waited_for(at) == words


def test_the_command_at_work_is_the_next_one_where_nothing_is_busy() -> None:
    begun, head = canon.ExactStop(BLOCK), canon.Wait(BLOCK)
    for is_busy, waits, expected in (
        (True, head, begun), (False, head, head), (False, None, begun),
    ):  # fmt: skip
        at = channel(begun)
        at.execution.is_busy, at.execution.head = lambda busy=is_busy: busy, waits
        assert at_work(at) is expected
    at = channel(begun)
    at.path.is_held = True
    loop = (SimpleNamespace(place="main.nc:3", text="$WHILE 1"), 17)
    interpreter: Any = SimpleNamespace(busiest_loop=lambda: loop)
    words = in_words(at, interpreter)
    assert (
        "; the loop of main.nc:3 ($WHILE 1) has made 17 turns; the PLC side holds the path" in words
    )


# --- what FMUs print


def test_the_first_20_lines_are_said_and_how_many_more_there_are() -> None:
    assert output_lines("plant z", []) == []
    assert output_lines("plant z", ["a"]) == ["plant z wrote to standard output: a"]
    assert len(output_lines("plant z", ["a"] * 20)) == 20
    said = output_lines("plant z", [str(n) for n in range(22)])
    assert said[19] == "plant z wrote to standard output: 19"
    assert said[20:] == ["plant z wrote 2 more lines to standard output"]


def test_lines_of_a_file_are_short_and_printable(tmp_path: Path) -> None:
    file = tmp_path / "out"
    assert lines_in(file) == []
    cut(file)
    file.write_bytes(b"one\n\n  \n\xff\x1b[1mtwo\n" + b"x" * 300 + b"\n")
    first, second, long = lines_in(file)
    assert first == "one"
    assert "\x1b" not in second
    assert second.endswith("two")
    assert long == "x" * 200
    for size in (BYTES_MAX, BYTES_MAX + 1):
        file.write_bytes(b"y" * size)
        cut(file)
        assert file.stat().st_size == BYTES_MAX
