"""Several things at once on the PLC side: happenings of one turn, commands that wait, courses.

Turns at 0, 1, 2 ms ... as in `test_plc_side_by_hand.py`.
"""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.cnc_beside_task import Cnc
from tests.machine.test_plc_side_by_hand import BLOCK, Rules
from tests.machine.test_plc_terminal import Signal
from tests.machine.test_plc_unit_values import Both

from axisrig.bench.machine.plc.hli import BoolUnit, ExtLatchUnit, Hli, Inputs, unknown_element
from axisrig.bench.machine.plc.terminal import Terminal
from axisrig.bench.machine.wiring.plc import StampFault
from axisrig.bench.rig.reading.plc_task import PlcTaskTable, TerminalTable
from axisrig.kernel.distance import DistanceCommand
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.probing import LatchOrder, LatchTask
from axisrig.kernel.plc.unit import UnitCommand
from axisrig.kernel.time.clock import MS, US

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


@pytest.mark.parametrize(("other", "is_first"), [("M", True), ("V.E.", True), ("V.E.", False)])
def test_a_function_waits_for_its_own_action_whatever_came_with_it(
    other: str, is_first: bool
) -> None:
    """M50 waits for the drive. A function that no rule waits for, or a variable, is none of it."""
    on = Rules(Z__torque_limit="300 at=M50", V__E__A="0; 1 at=V.E.B+5ms")
    on.turns()

    def beside() -> None:
        if other == "M":
            on.sends(60)
        else:
            on.plc.write(canon.ExternalWrite(BLOCK, "B", 2.0))

    if is_first:
        beside()
    on.sends(50)
    if not is_first:
        beside()
    on.turns(3)
    assert on.plc.is_waiting()
    on.sdo.answer()
    assert not on.plc.is_waiting()


@pytest.mark.parametrize(("delay_ms", "released"), [(0, 5), (1, 6), (3, 8)])
def test_a_feedhold_that_lasts_until_a_moment_may_last_a_time_after_it(
    delay_ms: int, released: int
) -> None:
    """M51 comes at 5 ms."""
    until = f"M51+{delay_ms}ms" if delay_ms else "M51"
    on = Rules(Z__feedhold=f"at=1ms until={until}")
    held = []
    for turn in range(10):
        if turn == 5:
            on.sends(51)
        on.turns()
        held.append(on.plc.axis["Z"].feedhold)
    assert held == [1 <= turn < released for turn in range(10)]


@pytest.mark.parametrize("column", ["feedhold", "X__feedhold"])
@pytest.mark.parametrize("times", [1, 2, 3])
def test_a_moment_ends_all_feedholds_that_have_waited_for_it(column: str, times: int) -> None:
    """M50 comes that often before M51, and once more behind it: that one waits for the next."""
    on = Rules(**{column: "at=M50 until=M51"})
    unit: Any = on.plc if column == "feedhold" else on.plc.axis["X"]
    on.turns()
    for _ in range(times):
        on.sends(50).turns()
        assert unit.feedhold
    on.sends(51).turns()
    assert not unit.feedhold
    on.sends(50).turns()
    assert unit.feedhold
    on.sends(51).turns()
    assert not unit.feedhold


def test_commands_of_one_turn_go_over_in_their_order() -> None:
    """Each as soon as the unit has taken the one before."""
    on = Rules(Z__dist_ctrl="ON at=1ms; FREEZE at=1ms; OFF at=1ms")
    unit, taken = on.plc.axis["Z"].distance, []
    for _ in range(6):
        on.turns()
        if unit.command_semaphor_rw:
            taken.append(unit.command_w.transition)
            unit.command_semaphor_rw = False
    assert taken == [DistanceCommand.ON, DistanceCommand.FREEZE, DistanceCommand.OFF]


def test_a_set_value_that_waits_for_its_unit_is_where_the_next_course_begins() -> None:
    """4 mm in force, 8 mm asked for while the unit is busy; then to 0 in 4 ms: 8, 6, 4, 2, 0."""
    on = Rules(Z__set_dist="8 at=1ms; 0 at=2ms over=4ms")
    unit = on.plc.axis["Z"].distance
    unit.command_semaphor_rw = True
    on.turns(4)  # the last one at 3 ms
    unit.command_semaphor_rw = False
    found = []
    for _ in range(4):
        on.turns()
        found.append(unit.command_w.set_dist_mm if unit.command_semaphor_rw else None)
        unit.command_semaphor_rw = False
    assert found == [4.0, 2.0, 0.0, None]


def test_courses_of_both_set_values_run_beside_each_other() -> None:
    """From 1 mm to 5 mm and from 4 mm to 0, each in 4 ms."""
    on = Rules(Z__set_pos="5 at=1ms over=4ms", Z__set_dist="0 at=2ms over=4ms")
    unit, found = on.plc.axis["Z"].distance, []
    for _ in range(8):
        on.turns()
        wanted = unit.command_w
        found.append((wanted.set_pos_mm, wanted.set_dist_mm) if unit.command_semaphor_rw else None)
        unit.command_semaphor_rw = False
    assert found == [None, (1, None), (2, 4), (3, 3), (4, 2), (5, 1), (None, 0), None]


# The task of the PLC


def test_a_task_of_a_probe_is_asked_for_once(tmp_path: Path) -> None:
    """Without a task please_rw stays away; taken back it comes again with the next task alone."""
    cnc, asked = Cnc(tmp_path), list[bool]()
    probing = cnc.plc.axis["Z"].probing

    def script(inputs: Inputs, hli: Hli) -> None:
        unit = hli.ax["Z"].lr_mc_control.ext_latch
        asked.append(unit.please_rw)
        if inputs.cycle in (3, 6):  # it takes its time
            unit.please_rw, unit.done_w = False, True

    cnc.runner.start()
    cnc.run(2.5, script)
    probing.give(LatchOrder(LatchTask.ENABLE, 3), cnc.clock.now_ns)
    cnc.run(10.5)
    probing.give(LatchOrder(LatchTask.DISABLE, 3), cnc.clock.now_ns)
    cnc.run(18.5)
    # Cycles 0 and 1 before the first task, 2 and 3 with it, 6 with the second
    assert asked == [number in (2, 3, 6) for number in range(10)]


def test_a_command_of_the_task_waits_until_the_cnc_has_taken_the_one_before() -> None:
    """That may be one of an event column."""
    both = Both()
    unit = both.axes["Z"].distance
    column = UnitCommand(DistanceCommand.OFF, 1.0, 2.0)
    unit.command_w, unit.command_semaphor_rw, unit.enable_w = column, True, False
    both.plc["Z"].enable_w = False
    both.order(transition=int(DistanceCommand.ON), set_pos=30_000)
    both.plc["Z"].enable_w = False
    both.turn()
    assert (unit.command_w, both.notes, both.taken) == (column, [], [])
    assert both.plc["Z"].command_semaphor_rw
    unit.command_semaphor_rw = False
    both.plc["Z"].enable_w = True
    both.turn()
    assert both.taken == [("Z", DistanceCommand.ON, 3.0, None)]
    assert both.notes == ["Z.distance_control = ON"]


# The terminal


@pytest.mark.parametrize("step_ns", [1, 100, 1000])
@pytest.mark.parametrize("jitter_ns", [0, 700])
def test_a_stamp_with_jitter_is_one_of_the_clock_of_the_terminal_too(
    step_ns: int, jitter_ns: int
) -> None:
    """What is stamped is the later instant, in whole steps of the clock below it."""
    edges = [(n * MS + 333, n % 2 == 1) for n in range(1, 31)]
    table = TerminalTable(input_1="p", stamp_resolution_ns=step_ns, stamp_jitter_ns=jitter_ns)
    plc = PlcTaskTable(period_us=1000, program="p.py")
    clock: Any = SimpleNamespace(now_ns=0)
    made = Terminal(plc, table, {"p": Signal(edges)}, lambda _: None, 1, StampFault(clock))
    late = []
    for n in range(1, 31):
        made.exchange_until(n * MS + MS)
        image = made.image[1]
        stamp_ns = max(image.latch_pos_ns, image.latch_neg_ns)
        assert stamp_ns % step_ns == 0
        late.append(stamp_ns - n * MS)
    assert all(333 // step_ns * step_ns <= each <= 333 + jitter_ns for each in late)
    assert (len(set(late)) == 1) is (jitter_ns == 0 or step_ns > 333 + jitter_ns)


@pytest.mark.parametrize(
    ("offset_ns", "ppm", "later_ns"),
    [(250, 0.0, 250), (-250, 0.0, -250), (0, 100.0, 100), (0, -100.0, -100), (40, 10.0, 50)],
)
def test_a_clock_that_is_off_stamps_later_or_earlier_from_then_on(
    offset_ns: int, ppm: float, later_ns: int
) -> None:
    """From 2 ms on, read at an edge at 3 ms: 100 ppm of 1 ms are 100 ns. At 5 ms it is right."""
    edges = [(1 * MS, True), (1_500 * US, False), (3 * MS, True), (3_500 * US, False),
             (6 * MS, True)]  # fmt: skip
    clock: Any = SimpleNamespace(now_ns=2 * MS)
    trouble = StampFault(clock)
    plc = PlcTaskTable(period_us=1000, program="p.py")
    made = Terminal(
        plc, TerminalTable(input_1="p"), {"p": Signal(edges)}, lambda _: None, 0, trouble
    )
    trouble.begin(offset_ns, ppm)
    made.exchange_until(2 * MS)
    assert made.image[1].latch_pos_ns == 1 * MS
    made.exchange_until(4 * MS)
    assert made.image[1].latch_pos_ns == 3 * MS + later_ns
    clock.now_ns = 5 * MS
    trouble.end()
    made.exchange_until(7 * MS)
    assert made.image[1].latch_pos_ns == 6 * MS


@pytest.mark.parametrize(
    ("holder", "name", "allowed"),
    [
        (BoolUnit("u"), "command_r", "command_w"), (BoolUnit("u"), "state_w", "state_r"),
        (BoolUnit("u"), "enable_r", "enable_w"), (ExtLatchUnit("u"), "task_w", "task_r"),
        (ExtLatchUnit("u"), "pleaserw", "please_rw"),
        (ExtLatchUnit("u"), "task_number", "task_number_r"),
    ],
)  # fmt: skip
def test_of_the_elements_that_are_near_the_nearest_alone_is_named(
    holder: Any, name: str, allowed: str
) -> None:
    with pytest.raises(AttributeError) as caught:
        getattr(holder, name)
    error = unknown_element(caught.value)
    assert error is not None
    assert (error.message, error.value, error.allowed) == (
        "the PLC program asks for an unknown element of u", name, allowed,
    )  # fmt: skip
