"""What the decoder makes of dwell times, block ends, stops and functions for the PLC side."""

from collections.abc import Iterator
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.syntax import (
    Chain,
    Command,
    Number,
    Program,
    ProgramBlock,
    Statement,
    Variable,
    Words,
)

ORIGIN = dict.fromkeys("XYZ", 0.0)


class Standing:
    """A machine that stands at the origin."""

    def position_acs_mm(self, axis: str) -> float:
        return ORIGIN[axis]

    def measured_acs_mm(self, axis: str) -> float | None:
        return None

    def measurement_ok(self, axis: str) -> bool:
        return False

    def drive_value(self, axis: str, key: str) -> float:
        raise AssertionError


def decoded(*statements: Statement) -> list[Any]:
    """Decode blocks N10, N20, ... and leave the end of the program out."""
    return list(commands_of(statements, {}))[:-1]


def commands_of(
    statements: tuple[Statement, ...], external: dict[str, float]
) -> Iterator[canon.Command]:
    blocks = tuple(
        ProgramBlock(Block(n, 10 * n, ""), statement) for n, statement in enumerate(statements, 1)
    )
    program = Program("", None, ("X", "Y", "Z"), blocks, ())
    return Interpreter(program, ("X", "Y", "Z"), Standing(), external=external).commands()


def words(*g: str, m: tuple[str, ...] = (), **values: float) -> Words:
    """Words with axes X, Y, Z and other addresses by letter; G4=... stands for the bare number."""
    axes = tuple((name, Number(v)) for name, v in values.items() if name in ORIGIN)
    addresses = tuple((name, Number(v)) for name, v in values.items() if name not in ORIGIN)
    return Words(g, m, axes, addresses)


def kinds(commands: list[Any]) -> list[str]:
    return [type(command).__name__ for command in commands]


# ---- dwell


@pytest.mark.parametrize(
    ("statement", "ns"),
    [
        (words("G4", X=4.5), 4_500_000_000),
        (words("G4", G4=3.0), 3_000_000_000),
        (words("G4", G4=0.0), 0),
        (Command("TIME", (Number(2.5),)), 2_500_000_000),
        (Command("TIME", (Number(71.0),)), 71_000_000_000),
        (Command("TIME", (Number(0.0004),)), 400_000),
    ],
)
def test_dwell_times_are_seconds(statement: Statement, ns: int) -> None:
    """The manual's G04 X4.5, G04 3.0 and #TIME 2.5; #TIME 71 of FCT-M3."""
    (command,) = decoded(statement)
    assert command == canon.Dwell(Block(1, 10, ""), ns)


def test_dwell_moves_nothing_and_changes_no_modal_word() -> None:
    commands = decoded(words("G0", X=1.0), words("G4", X=4.5), words(X=2.0))
    assert kinds(commands) == ["LinearMove", "Dwell", "LinearMove"]
    assert commands[2].rapid
    assert commands[2].target_mm == {"X": 2.0}


@pytest.mark.provokes(20685, 1, axis="Y")
def test_further_axes_beside_a_dwell_time_are_ignored_with_a_warning() -> None:
    for statement in (words("G4", X=2.0, Y=3.0, Z=4.0), words("G4", G4=2.0, Y=3.0, Z=4.0)):
        *warnings, dwell = decoded(statement)
        assert [(warning.alarm.id, warning.alarm.values) for warning in warnings] == [
            (20685, {"axis": axis}) for axis in "YZ"
        ]
        assert dwell.duration_ns == 2_000_000_000


@pytest.mark.provokes(20013, 2)
@pytest.mark.provokes(900171, 2, word="G4")
@pytest.mark.provokes(20752, 2, value="-1000000", lower="0", upper="4294967295")
@pytest.mark.provokes(20751, 2, value="4294967296", lower="0", upper="4294967295")
@pytest.mark.parametrize(
    ("statement", "alarm_id", "values"),
    [
        (words("G4", X=2.0, G4=10.0), 20013, {}),
        (words("G4"), 900171, {"word": "G4"}),
        (words("G4", G4=-1.0), 20752, {"value": "-1000000", "lower": 0, "upper": 4294967295}),
        (
            Command("TIME", (Number(4294.967296),)),
            20751,
            {"value": "4294967296", "lower": 0, "upper": 4294967295},
        ),
    ],
)
def test_dwell_times_that_are_refused(
    statement: Statement, alarm_id: int, values: dict[str, object]
) -> None:
    with pytest.raises(Alarm) as caught:
        decoded(statement)
    assert (caught.value.id, caught.value.values) == (alarm_id, values)


# ---- ends of blocks


def test_exact_stop_holds_for_its_block_only() -> None:
    commands = decoded(words("G0", "G60", X=1.0), words(X=2.0))
    assert kinds(commands) == ["LinearMove", "ExactStop", "LinearMove"]


def test_exact_stop_over_several_blocks() -> None:
    commands = decoded(words("G360"), words("G0", X=1.0), words(X=2.0), words("G359"), words(X=3.0))
    assert kinds(commands) == [*["LinearMove", "ExactStop"] * 2, "LinearMove"]


@pytest.mark.provokes(20003, 1, g_function="G60")
def test_exact_stop_without_motion_is_a_warning() -> None:
    (warning,) = decoded(words("G60"))
    assert (warning.alarm.id, warning.alarm.entry.reaction_class) == (20003, 1)


@pytest.mark.parametrize("function", ["G8", "G9", "G900", "G901", "G61", "G261", "G260"])
def test_other_functions_of_block_ends_change_nothing_of_the_path(function: str) -> None:
    plain = decoded(words("G0", X=1.0), words(X=2.0))
    assert decoded(words("G0", function, X=1.0), words(X=2.0)) == plain


MEASURING = {"X": 100.0, "F": 1000.0}


@pytest.mark.provokes(120652, 2)
@pytest.mark.parametrize(
    ("before", "g"),
    [
        ([words("G261")], ()),
        ([Command("CONTOUR MODE ON")], ()),
        ([words("G0", "G61", X=1.0)], ()),
        ([], ("G61",)),
    ],
)
def test_measuring_run_under_polynomial_contouring_is_refused(
    before: list[Statement], g: tuple[str, ...]
) -> None:
    """FCT-C4 section 2; the diagnosis manual's N010 G261 ... N040 G100 X100 F1000."""
    program = [*before, words(*g, "G100", **MEASURING)]
    with pytest.raises(Alarm) as caught:
        decoded(*program)
    assert caught.value.id == 120652
    assert f"N{10 * len(program)}" in str(caught.value)


@pytest.mark.parametrize(
    "before",
    [
        [],
        [words("G261"), words("G260")],
        [Command("CONTOUR MODE ON"), Command("CONTOUR MODE OFF")],
        [Command("CONTOUR MODE")],
        [words("G0", "G61", X=1.0), words(X=2.0)],
    ],
)
def test_measuring_run_without_polynomial_contouring(before: list[Statement]) -> None:
    assert "MeasuringRun" in kinds(decoded(*before, words("G100", **MEASURING)))


def test_emptying_the_channel_waits_only_where_it_says_so() -> None:
    assert decoded(Command("FLUSH"), Command("FLUSH CONTINUE")) == []
    assert kinds(decoded(Command("FLUSH WAIT"))) == ["Wait"]


def test_waiting_for_the_plc_side_asks_in_every_cycle() -> None:
    """The manual's #WAIT FOR V.E.EXT1 == 5."""
    external = {"EXT1": 0.0}
    condition = Chain(Variable("V.E.EXT1"), (("==", Number(5.0)),))
    commands = commands_of((Command("WAIT FOR", (condition,)),), external)
    for _ in range(4):
        wait = next(commands)
        assert isinstance(wait, canon.Wait)
        assert wait.for_cycle
    external["EXT1"] = 5.0
    assert isinstance(next(commands), canon.EndOfProgram)


@pytest.mark.parametrize(("value", "waits"), [(0.5, True), (0.51, False), (1.0, False)])
def test_a_condition_holds_above_one_half(value: float, waits: bool) -> None:
    commands = commands_of((Command("WAIT FOR", (Variable("V.E.READY"),)),), {"READY": value})
    next(commands)  # a block that reads V.E. waits for the machine
    assert isinstance(next(commands), canon.Wait) is waits


@pytest.mark.provokes(900173, 2)
def test_waiting_for_what_nothing_changes_is_refused() -> None:
    with pytest.raises(Alarm) as caught:
        decoded(Command("WAIT FOR", (Number(0.0),)))
    assert caught.value.id == 900173
    assert decoded(Command("WAIT FOR", (Number(1.0),))) == []


def test_exact_stop_behind_a_full_circle_without_axis_words() -> None:
    commands = decoded(words("G2", "G60", "G162", I=5.0, F=100.0))
    assert kinds(commands) == ["ArcMove", "ExactStop"]


# ---- stops and functions


def test_stops_act_behind_the_motion_of_their_block() -> None:
    commands = decoded(words("G0", X=1.0, m=("M0",)), words(X=2.0, m=("M1",)))
    assert kinds(commands) == ["LinearMove", "ProgramStop", "LinearMove", "ProgramStop"]
    assert [command.optional for command in commands[1::2]] == [False, True]


def test_functions_are_told_before_the_motion_of_their_block() -> None:
    commands = decoded(words("G0", X=1.0, m=("M8", "M80"), H=4.0, T=12.0))
    assert kinds(commands) == [*["TechnologyFunction"] * 4, "LinearMove"]
    message = [f"{command.letter}{command.number}" for command in commands[:4]]
    assert message == ["M8", "M80", "H4", "T12"]


def test_ends_of_program_and_stops_are_not_told() -> None:
    assert kinds(decoded(words(m=("M0",)), words(m=("M30",)))) == ["ProgramStop"]


@pytest.mark.provokes(21548, 2, spindles="0", release="0", number="3")
@pytest.mark.provokes(20160, 2, word="M1001", upper="999")
@pytest.mark.provokes(900172, 2, word="H-1", upper="999")
@pytest.mark.parametrize(
    ("statement", "alarm_id", "values"),
    [
        (words(m=("M3",)), 21548, {"spindles": 0, "release": 0, "number": "3"}),
        (words(m=("M1001",)), 20160, {"word": "M1001", "upper": 999}),
        (words(H=-1.0), 900172, {"word": "H-1", "upper": 999}),
    ],
)
def test_functions_that_nobody_takes(
    statement: Statement, alarm_id: int, values: dict[str, object]
) -> None:
    with pytest.raises(Alarm) as caught:
        decoded(statement)
    assert (caught.value.id, caught.value.values) == (alarm_id, values)


@pytest.mark.parametrize("number", [3, 4, 5, 19, 40, 45])
def test_functions_of_a_spindle_need_one(number: int) -> None:
    with pytest.raises(Alarm) as caught:
        decoded(words(m=(f"M{number}",)))
    assert caught.value.id == 21548


# ---- as programs write them


def test_dwell_times_as_the_manual_writes_them(run: Any) -> None:
    """G04 X4.5, G04 3.0, G04 P1, #TIME 2.5, #TIME P1: TF5200 programming manual 206132747."""
    commands = run("G04 X4.5\nG04 3.0\nP1=2\nG04 P1\nG4 XP1\n#TIME 2.5\n#TIME P1\nG04 [P1*2]")
    dwells = [command for command in commands if isinstance(command, canon.Dwell)]
    assert [dwell.duration_ns / 1e9 for dwell in dwells] == [4.5, 3.0, 2.0, 2.0, 2.5, 2.0, 4.0]


def test_block_ends_stops_and_functions_as_programs_write_them(run: Any) -> None:
    commands = run(
        "N10 G1 F1000 G94 G60 X10 M8\nN20 G360\nN30 G3 X0 Y10 R10\nN40 G359 T12 H3\nN50 M00\nM1\nM2"
    )
    assert kinds(commands) == [
        "TechnologyFunction", "LinearMove", "ExactStop", "ArcMove", "ExactStop",
        *["TechnologyFunction"] * 2, "ProgramStop", "ProgramStop", "EndOfProgram",
    ]  # fmt: skip


@pytest.mark.parametrize(
    "before",
    ["G261", "#CONTOUR MODE ON [DEV PATH_DEV=1.0]", "G61 G1 X1 F100"],
)
def test_programs_that_measure_under_polynomial_contouring(run: Any, before: str) -> None:
    with pytest.raises(Alarm) as caught:
        run(f"#CONTOUR MODE [DEV PATH_DEV=0.5]\n{before}\nG100 X10 F100")
    assert caught.value.id == 120652
    assert kinds(run(f"{before}\nG260\nG100 X10 F100"))[-3:-1] == ["MeasuringRun", "Wait"]
