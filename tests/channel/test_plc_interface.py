"""What a channel and its PLC side have in common, without a machine."""

import itertools
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.plc.interface import PlcInterface, PlcParticipant
from axisrig.kernel.plc.probing import (
    AxisWrites,
    LatchOrder,
    LatchTask,
    PlcTask,
    ProbingUnit,
    StampRelation,
)
from axisrig.kernel.plc.unit import AxisUnit

BLOCK = Block(1, 10, "N10")


def interface(*axes: str) -> tuple[PlcInterface, Any]:
    """An interface and its clock."""
    clock: Any = SimpleNamespace(now_ns=0)
    return PlcInterface(clock, axes or ("Z",)), clock


def function(letter: str, number: int) -> canon.TechnologyFunction:
    return canon.TechnologyFunction(BLOCK, letter, number)


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
def test_who_joins_takes_nothing_from_who_was_there(order: tuple[int, ...]) -> None:
    """Turns in the order of joining; of each property the one who has it counts."""
    plc, _ = interface()
    turns: list[int] = []
    rests = [False, False, False]
    task: Any = object()
    more: list[dict[str, Any]] = [
        {"outlives_program": True, "is_idle": lambda: rests[0]},
        {"acknowledged_later": frozenset({"M50"}), "is_idle": lambda: rests[1]},
        {"acknowledged_later": frozenset({"M60"}), "task": task},
    ]
    for number in order:
        plc.join(PlcParticipant(lambda number=number: turns.append(number), **more[number]))  # type: ignore[misc]
    plc.take_turn()
    plc.take_turn()
    assert turns == [*order, *order]
    assert plc.outlives_program
    assert plc.task is task
    assert plc.acknowledged_later == {"M50", "M60"}
    seen = []
    for rests[0], rests[1] in itertools.product((False, True), repeat=2):
        seen.append(plc.is_idle())
    assert seen == [False, False, False, True]


def test_who_has_nothing_to_say_changes_nothing() -> None:
    plc, _ = interface()
    plc.join(PlcParticipant(lambda: None))
    assert (plc.outlives_program, plc.task, plc.acknowledged_later) == (False, None, frozenset())
    assert plc.is_idle()


def test_a_function_is_waited_for_where_it_is_acknowledged_later() -> None:
    """Each time that it is sent; other ones count as acknowledged, of another letter too."""
    plc, clock = interface()
    plc.join(PlcParticipant(lambda: None, acknowledged_later=frozenset({"M50"})))
    waits = []
    for clock.now_ns, one in enumerate((function("M", 5), function("M", 50), function("S", 50))):
        plc.send(one)
        waits.append(plc.is_waiting())
    assert waits == [False, True, False]
    for _ in range(2):
        plc.send(function("M", 50))
        assert plc.is_waiting()
        plc.acknowledge()
        assert not plc.is_waiting()
    assert [(event.time_ns, event.command) for event in plc.events[:2]] == [
        (0, function("M", 5)),
        (1, function("M", 50)),
    ]


def test_a_value_is_there_at_once_and_noted() -> None:
    plc, clock = interface()
    clock.now_ns = 7
    plc.write(canon.ExternalWrite(BLOCK, "FEED", 2.5))
    plc.note("feedhold on", "plc:feedhold")
    plc.report(Alarm(900315, owner="Z", source="VARIABLE V.E.S"))
    assert plc.values == {"FEED": 2.5}
    assert [event.time_ns for event in plc.events] == [7, 7]
    assert [alarm.id for alarm in plc.reported] == [900315]


def test_the_tool_is_shown_where_a_program_has_its_variables() -> None:
    """Zero without a kinematic: a variable is a number."""
    tilt, length = canon.SHOWN_OF_TOOL
    plc, _ = interface()
    plc.show_tool(30.0, 80.0)
    assert plc.values == {}
    plc.values = {tilt: 1.0, length: 1.0}
    for shown, expected in (((30.0, 80.0), (30.0, 80.0)), ((None, None), (0.0, 0.0))):
        plc.show_tool(*shown)
        assert (plc.tool.tilt_deg, plc.tool.length_mm) == shown
        assert (plc.values[tilt], plc.values[length]) == expected


@pytest.mark.parametrize("feedhold", [False, True])
@pytest.mark.parametrize("override_permille", [0, 1, 500, 1000])
def test_an_axis_is_held_by_its_feedhold_or_by_an_override_of_0(
    feedhold: bool, override_permille: int
) -> None:
    assert AxisUnit(feedhold, override_permille).holds is (feedhold or not override_permille)


def test_nothing_of_an_axis_is_commanded_before_its_plc_says_so() -> None:
    plc, _ = interface("X", "Z")
    for unit in plc.axis.values():
        assert not unit.holds
        assert not unit.distance.enable_w
        assert not unit.distance.command_semaphor_rw
        assert unit.probing.writes.signal is None
    plc.axis["X"].distance.enable_w = True
    assert not plc.axis["Z"].distance.enable_w


def test_an_order_is_in_force_when_the_one_before_is_acknowledged() -> None:
    """And has its time from then on; a further one waits behind it."""
    unit = ProbingUnit()
    orders = [LatchOrder(LatchTask.PREPARE, n, edge) for n, edge in ((1, "POS"), (2, "NEG"))]
    assert unit.is_idle
    for number, order in enumerate(orders):
        unit.give(order, 10 + number)
    assert (unit.order, unit.number, unit.given_ns, unit.is_idle) == (orders[0], 1, 10, False)
    unit.take(AxisWrites(done_order=0), 20)
    assert (unit.order, unit.number, unit.given_ns, unit.is_idle) == (orders[0], 1, 10, False)
    unit.take(AxisWrites(done_order=1), 30)
    assert (unit.order, unit.number, unit.given_ns, unit.is_idle) == (orders[1], 2, 30, False)
    for now_ns in (40, 50):
        unit.take(AxisWrites(done_order=2), now_ns)
        assert (unit.order, unit.number, unit.given_ns, unit.is_idle) == (orders[1], 2, 30, True)


def test_orders_that_wait_come_in_the_order_in_which_they_were_given() -> None:
    unit = ProbingUnit()
    orders = [LatchOrder(LatchTask.ENABLE, probe_input) for probe_input in (7, 3, 9, 1)]
    for order in orders:
        unit.give(order, 5)
    for number, order in enumerate(orders, start=1):
        assert (unit.order, unit.number, unit.is_idle) == (order, number, False)
        unit.take(AxisWrites(done_order=number), 10 * number)
    assert (unit.order, unit.number, unit.given_ns) == (orders[-1], 4, 30)
    assert unit.is_idle


@pytest.mark.parametrize("offset_ns", [-2_500, 0, 700, -3_000_000_000, 86_400_000_000_000])
@pytest.mark.parametrize("drift_ppm", [-40.0, 0.0, 100.0])
def test_a_stamp_is_the_bus_time_by_offset_and_drift_of_its_clock(
    offset_ns: int, drift_ppm: float
) -> None:
    """A clock may have been on for a day, or have been set back: its drift counts by bus time."""
    relation = StampRelation(offset_ns, drift_ppm)
    for bus_ns in (0, 1_000_000, 3_600_000_000_000):
        stamp_ns = bus_ns + offset_ns + round(bus_ns * drift_ppm / 1e6)
        assert relation.bus_ns(stamp_ns) == pytest.approx(bus_ns, abs=1)


def test_a_task_is_silent_for_longer_than_its_watchdog() -> None:
    task = PlcTask(watchdog_ns=100)
    assert [task.silent_ns(now_ns) for now_ns in (0, 100, 101)] == [None, None, 101]
    task.written_ns = 50
    assert [task.silent_ns(now_ns) for now_ns in (50, 150, 151)] == [None, None, 101]
