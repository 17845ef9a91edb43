"""Rules of the PLC side beside a channel by hand: each moment, each action, what waits for what.

Turns at 0, 1, 2 ms ... A happening is written into the channel, and the next turn notices it.
"""

from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any, ClassVar

import pytest

from axisrig.bench.machine.plc.side import PlcSide
from axisrig.bench.plan.assignment import parse_column
from axisrig.bench.rig.plc.words import read_rules
from axisrig.kernel.distance import DistanceCommand
from axisrig.kernel.drives.cia402.objects import SdoError
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.plc.interface import PlcInterface
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

BLOCK = Block(5, 50, "N50")
Answer = bytes | SdoError


class Sdo:
    """Keeps what is written until a test answers."""

    def __init__(self) -> None:
        self.writes: list[tuple[int, int, bytes]] = []
        self._open: list[Callable[[Answer], None]] = []

    def write(self, index: int, sub: int, data: bytes, done: Callable[[Answer], None]) -> None:
        self.writes.append((index, sub, data))
        self._open.append(done)

    def answer(self, answer: Answer = b"") -> None:
        self._open.pop(0)(answer)


class Rules:
    """The PLC side of a channel with X and Z; mapped: objects that RPDOs of Z carry.

    DRIVES: axes whose drives have objects.
    """

    DRIVES: ClassVar[str] = "Z"

    def __init__(self, *mapped: int, **cells: str) -> None:
        self.clock = new_scheduler()
        self.plc = PlcInterface(self.clock, "XZ")
        self.objects: list[tuple[str, str, Any]] = []
        self.programs: list[str | None] = []
        control: Any = SimpleNamespace(set_pos_mm=1.0, set_dist_mm=4.0)
        channel: Any = SimpleNamespace(
            plc=self.plc, path=SimpleNamespace(is_moving=False), records=[], program_ends_ns=[],
            resets_ns=[], sync_ns=0,
            distance=SimpleNamespace(
                axes={"Z": SimpleNamespace(control=control)},
                write_object=lambda *words: self.objects.append(words),
            ),
        )  # fmt: skip
        self.channel, self.sdos = channel, {name: Sdo() for name in self.DRIVES}
        self.sdo = self.sdos["Z"]

        def get_object(index: int, sub: int) -> int:
            if index not in mapped or sub:
                raise KeyError(index)
            return 0

        link = SimpleNamespace(get_object=get_object)
        ways: Any = {name: SimpleNamespace(link=link, sdo=sdo) for name, sdo in self.sdos.items()}
        rules = [
            rule
            for name, cell in cells.items()
            for rule in read_rules(parse_column(f"plc:{_column(name)}", cell), "XZ")[1]
        ]
        self.side = PlcSide(channel, ways, rules, self.clock, MS, self._program)

    def _program(self, file: str | None) -> Iterator[canon.Command]:
        self.programs.append(file)
        return iter(())

    def turns(self, count: int = 1) -> "Rules":
        for _ in range(count):
            self.plc.take_turn()
            self.clock.run_until(self.clock.now_ns + MS)
        return self

    def sends(self, *numbers: int) -> "Rules":
        for number in numbers:
            self.plc.send(canon.TechnologyFunction(BLOCK, "M", number))
        return self

    def words(self) -> list[tuple[float, str]]:
        """What the PLC side has done and when, ms."""
        return [
            (event.time_ns / MS, event.command.words)
            for event in self.plc.events
            if not isinstance(event.command, canon.TechnologyFunction | canon.ExternalWrite)
            and hasattr(event.command, "words")
        ]

    def times(self) -> list[float]:
        return [at for at, _ in self.words()]


def _column(name: str) -> str:
    """A keyword as the name of its column: two underscores are a dot."""
    return name.replace("__", ".")


# --- moments


def variable(moment: str, **more: str) -> Rules:
    """A variable that is written at a moment."""
    return Rules(V__E__A=f"0; 7 at={moment}", **more)


def test_a_time_counts_from_the_first_turn() -> None:
    on = variable("2ms")
    on.clock.run_until(5 * MS)
    assert on.turns(6).words() == [(7.0, "V.E.A = 7 from the PLC")]


def test_motion_and_standing_count_from_the_cycle_of_the_motion() -> None:
    """Noticed a turn later: a time after it is shorter by a cycle."""
    for moment, expected in (
        ("motion", [2.0, 8.0]),
        ("motion+3ms", [4.0, 10.0]),
        ("standing", [5.0]),
        ("standing+2ms", [6.0]),
    ):
        on = variable(moment)
        for turn in range(12):
            on.channel.path.is_moving = 2 <= turn < 5 or turn >= 8
            on.turns()
        assert on.times() == expected, moment


def test_runs_begin_and_end_each_by_itself() -> None:
    """Two runs beside each other; the second one ends first."""
    for moment, expected in (
        ("run", [1.0, 2.0]),
        ("run_end", [4.0, 6.0]),
        ("run_end nth=2", [6.0]),
        ("run+3ms", [4.0, 5.0]),
    ):
        on = variable(moment)
        first, second = (SimpleNamespace(begin_ns=at * MS, end_ns=None) for at in (1, 2))
        for turn in range(9):
            if turn in (1, 2):
                on.channel.records.append((first, second)[turn - 1])
            second.end_ns = 4 * MS if turn >= 4 else None
            first.end_ns = 6 * MS if turn >= 6 else None
            on.turns()
        assert on.times() == expected, moment


def test_ends_of_programs_and_resets_are_moments_of_their_own() -> None:
    for moment, expected in (("program_end", [1.0, 5.0]), ("reset", [3.0])):
        on = variable(moment)
        for turn in range(7):
            on.channel.program_ends_ns += [turn * MS] * (turn in (1, 5))
            on.channel.resets_ns += [turn * MS] * (turn == 3)
            on.turns()
        assert on.times() == expected, moment


def test_a_variable_is_a_moment_with_any_value_or_with_one() -> None:
    for moment, expected in (
        ("V.E.GO", [1.0, 2.0, 3.0]),
        ("V.E.go=2", [2.0]),
        ("V.E.GO=2+5ms", [7.0]),
        ("V.E.OTHER", []),
    ):
        on = variable(moment)
        for turn in range(9):
            if 1 <= turn <= 3:
                on.plc.write(canon.ExternalWrite(BLOCK, "Go", float(turn)))
            on.turns()
        assert on.times() == expected, moment


def test_of_several_functions_each_rule_takes_its_own() -> None:
    """What is due at one instant acts in the order in which it was found to be due."""
    on = Rules(V__E__A="0; 1 at=M50; 2 at=M50 nth=3; 3 at=M51+2ms")
    on.turns().sends(50, 51, 50).turns().sends(51).turns().sends(50).turns(5)
    assert [(at, words.split()[2]) for at, words in on.words()] == [
        (1.0, "1"), (1.0, "1"), (3.0, "3"), (3.0, "1"), (3.0, "2"), (4.0, "3"),
    ]  # fmt: skip
    assert on.plc.values["A"] == 3.0


def test_what_has_not_come_is_named() -> None:
    on = Rules(V__E__A="0; 1 at=M50; 2 at=M51", feedhold="at=M50 nth=2 for=1ms")
    on.turns().sends(50).turns(2)
    assert on.side.not_come() == [
        "plc:V.E.A: 2 at=M51 has not come",
        "plc:feedhold: at=M50 nth=2 for=1ms has not come",
    ]
    on.sends(50, 51).turns(2)
    assert on.side.not_come() == []


# --- what a function waits for


def test_a_function_is_acknowledged_when_all_that_it_causes_is_done() -> None:
    """Two objects of the drive, and a variable 3 ms later; M51 causes nothing that waits."""
    on = Rules(Z__torque_limit="300 at=M50", Z__6065="1000 at=M50", V__E__A="0; 1 at=M50+3ms",
               V__E__B="0; 1 at=M51")  # fmt: skip
    on.turns().sends(50)
    assert on.plc.is_waiting()
    on.turns()
    # UNS16 and UNS32, least significant byte first (CiA 301)
    assert on.sdo.writes == [
        (0x6072, 0, (300).to_bytes(2, "little")), (0x6065, 0, (1000).to_bytes(4, "little")),
    ]  # fmt: skip
    on.sdo.answer()
    on.turns(3)
    assert on.plc.is_waiting()
    assert on.plc.values["A"] == 1.0
    on.sdo.answer()
    assert not on.plc.is_waiting()
    on.turns().sends(51)
    assert on.plc.is_waiting()
    on.turns()
    assert not on.plc.is_waiting()


def test_a_drive_that_refuses_a_value_is_an_alarm_and_the_function_goes_on() -> None:
    on = Rules(Z__torque_limit="300 at=M50")
    on.turns().sends(50).turns()
    on.sdo.answer(SdoError(0x6072, 0, 0x06090030))
    (alarm,) = on.plc.reported
    assert (alarm.id, alarm.values["axis"], alarm.values["value"]) == (900270, "Z", 300)
    assert not on.plc.is_waiting()
    assert on.words() == [(1.0, "Z.torque_limit = 300 from the PLC")]


def test_no_function_waits_for_a_reset_or_a_start() -> None:
    on = Rules(reset="at=M50+2ms", program_start="at=M51 file=second.nc")
    assert on.plc.acknowledged_later == frozenset()
    on.turns().sends(50).turns()
    assert (on.plc.is_waiting(), on.plc.wants_reset) == (False, False)
    on.turns(2)
    assert on.plc.wants_reset
    on.sends(51, 51).turns()
    assert (on.programs, on.plc.program is not None) == (["second.nc"], True)
    assert [words for _, words in on.words()] == [
        "reset from the PLC", "start of second.nc from the PLC",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("cells", "outlives"),
    [
        ({"V__E__A": "0; 1 at=M50"}, False),
        ({"V__E__A": "0; 1 at=program_end"}, True),
        ({"V__E__A": "0; 1 at=reset"}, True),
        ({"reset": "at=M50"}, True),
        ({"program_start": "at=400ms"}, True),
        ({"feedhold": "at=M50 until=program_end"}, True),
        ({"feedhold": "at=M50 until=M51"}, False),
        ({"feedhold": "at=M50 until=reset"}, True),
        # One of several is enough, in whatever order
        ({"V__E__A": "0; 1 at=M50", "V__E__B": "0; 1 at=program_end"}, True),
        ({"V__E__B": "0; 1 at=program_end", "V__E__A": "0; 1 at=M50"}, True),
        ({"V__E__A": "0; 1 at=M50; 2 at=reset; 3 at=M51"}, True),
        ({"feedhold": "at=M50 for=5ms", "program_start": "at=M51"}, True),
        ({"V__E__A": "0; 1 at=M50", "override": "20 at=M51"}, False),
    ],
)
def test_who_acts_behind_the_program_outlives_it(cells: dict[str, str], outlives: bool) -> None:
    assert Rules(**cells).plc.outlives_program is outlives


def test_the_plc_side_is_idle_when_nothing_is_left_to_do() -> None:
    on = Rules(Z__torque_limit="300 at=program_end", V__E__A="0; 1 at=program_end+3ms")
    on.turns()
    assert on.plc.is_idle()
    on.channel.program_ends_ns.append(MS)  # not noticed yet
    assert not on.plc.is_idle()
    on.turns()
    on.sdo.answer()
    assert not on.plc.is_idle()  # 3 ms
    on.turns(3)
    assert on.plc.is_idle()
    on.channel.resets_ns.append(9 * MS)
    assert not on.plc.is_idle()
    assert on.turns().plc.is_idle()
    other = Rules(Z__torque_limit="300 at=program_end")
    other.turns().channel.program_ends_ns.append(MS)
    assert not other.turns().plc.is_idle()  # the drive has not answered
    other.sdo.answer()
    assert other.plc.is_idle()


# --- actions


def test_overrides_are_led_from_where_they_are_each_by_itself() -> None:
    """The path from 100 to 20 % in 4 ms, Z to 50 % at once; each in whole steps of 0.1 %."""
    on = Rules(override="20 at=1ms over=4ms", Z__override="50 at=2ms; 0.3 at=4ms over=2ms")
    found = []
    for _ in range(8):
        on.turns()
        x, z = on.plc.axis.values()
        found.append((on.plc.override_permille, x.override_permille, z.override_permille))
    path = [1000, 1000, 800, 600, 400, 200, 200, 200]
    of_z = [1000, 1000, 500, 500, 500, 252, 3, 3]  # half way from 500 to 3: 251.5
    assert found == [(p, 1000, z) for p, z in zip(path, of_z, strict=True)]
    assert [words for _, words in on.words()] == [
        "override = 20 % over 4 ms from the PLC", "Z.override = 50 % from the PLC",
        "Z.override = 0.3 % over 2 ms from the PLC",
    ]  # fmt: skip


def test_a_function_waits_until_an_override_has_arrived() -> None:
    on = Rules(override="20 at=M50 over=3ms")
    on.turns().sends(50)
    waits = []
    for _ in range(5):
        on.turns()
        waits.append(on.plc.is_waiting())
    assert waits == [True, True, True, False, False]


def test_distance_control_gets_commands_set_values_and_objects() -> None:
    on = Rules(Z__dist_ctrl="ON set_pos=3 at=1ms", Z__set_dist="2 at=2ms",
               **{"Z__object__DIST_CTRL::kp": "0.3 at=3ms"})  # fmt: skip
    unit = on.plc.axis["Z"].distance
    taken = []
    for _ in range(5):
        on.turns()
        if unit.command_semaphor_rw:
            wanted = unit.command_w
            taken.append((wanted.transition, wanted.set_pos_mm, wanted.set_dist_mm))
            unit.command_semaphor_rw = False
    assert taken == [(DistanceCommand.ON, 3.0, None), (None, None, 2.0)]
    assert on.objects == [("Z", "DIST_CTRL::kp", 0.3)]
    assert on.words() == [
        (1.0, "Z.dist_ctrl = ON set_pos=3 from the PLC"),
        (2.0, "Z.set_dist_mm = 2 from the PLC"),
        (3.0, "Z DIST_CTRL::kp = 0.3 from the PLC"),
    ]
    assert not on.plc.axis["X"].distance.enable_w


def test_a_probing_signal_has_its_level_from_its_moment_on() -> None:
    on = Rules(Z__probing_signal="0; 1 at=2ms", X__probing_position="99.998 at=3ms")
    found = []
    for _ in range(5):
        on.channel.sync_ns = on.clock.now_ns
        on.turns()
        x, z = (unit.probing.writes for unit in on.plc.axis.values())
        found.append((z.signal, z.position_units, x.signal, x.position_units))
    assert found == [
        (False, None, None, None), (False, None, None, None), (True, None, None, None),
        (True, None, None, 999_980), (True, None, None, 999_980),
    ]  # fmt: skip
    assert on.plc.task is not None
    assert on.plc.task.sync_ns == {"X": 4 * MS, "Z": 4 * MS}


# --- what is refused


@pytest.mark.parametrize(
    ("mapped", "cells", "words"),
    [
        ((0x6072,), {"Z__torque_limit": "300"}, "an RPDO of axis Z carries torque_limit"),
        ((), {"X__torque_limit": "300"}, "the drive of axis X has no objects"),
        ((), {"X__object__DIST_CTRL::kp": "0.3"}, "axis X has no distance control"),
    ],
)
def test_what_would_do_nothing_is_refused(
    mapped: tuple[int, ...], cells: dict[str, str], words: str
) -> None:
    with pytest.raises(UserError) as caught:
        Rules(*mapped, **cells)
    assert words in caught.value.message
    Rules(0x60E0, **{name.replace("X", "Z"): cell for name, cell in cells.items()})


def test_without_rules_nobody_takes_part() -> None:
    on = Rules()
    assert (on.plc.is_idle(), on.side.writes_variables, on.side.not_come()) == (True, False, [])
    assert variable("M50").side.writes_variables
    assert Rules(feedhold="at=M50 for=1ms", V__E__A="0; 1 at=M51").side.writes_variables
    assert Rules(V__E__A="0; 1 at=M51", feedhold="at=M50 for=1ms").side.writes_variables
    assert not Rules(feedhold="at=M50 for=1ms").side.writes_variables
