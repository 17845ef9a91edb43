"""#IDENT as programs write it: forms, refusals with their place, what the channel gets."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.text.parser import parse_program

AXES = ("X", "Y", "Z")
WRITE = "#IDENT WR SYN [AXNR 1 ID S-0-0092 VAL=100 TYP 2 DEC 0 SERC]"


def _commands(run: Callable[..., list[Any]], text: str, **options: Any) -> list[Any]:
    return [c for c in run(text, **options) if not isinstance(c, canon.EndOfProgram)]


@pytest.mark.parametrize(
    "text",
    [
        WRITE,
        "#IDENT WR SYN [AX=X ID=S-0-0092 VAL=100 TYP=2 DEC=0 SERC]",
        "#IDENT WR [AX X ID s-0-0092 VAL100 TYP2 DEC0 SERC]",
        "#IDENT WR SYN [AX X ID S-0-0092 VAL=10.0 TYP 2 DEC 1 SERC]",
        "P1092=100\n#IDENT WR SYN [AXNR 1 ID S-0-0092 VAL=P1092 TYP 2 DEC 0 SERC]",
    ],
)
def test_a_write_in_all_its_forms_waits_for_the_drive(
    run: Callable[..., list[Any]], text: str
) -> None:
    """Programming manual 207365515: without NO_WAIT the interpolation waits."""
    (command,) = _commands(run, text)
    assert command == canon.DriveWrite(command.block, "X", "S-0-0092", 100.0, True, 2)
    assert command.word == "#IDENT WR"


def test_no_wait_lets_the_program_go_on(run: Callable[..., list[Any]]) -> None:
    (command,) = _commands(run, WRITE.replace("SERC]", "SERC NO_WAIT]"))
    assert not command.waits


@pytest.mark.parametrize("word", ["RD", "RD SYN"])
@pytest.mark.parametrize(("decimals", "read"), [(0, 250.0), (1, 25.0), (3, 0.25)])
def test_reading_gives_the_value_in_digits_of_dec_to_the_parameter(
    run: Callable[..., list[Any]], plane_machine: Any, word: str, decimals: int, read: float
) -> None:
    machine = plane_machine(dict.fromkeys(AXES, 0.0), None)
    machine.drive_value = lambda axis, key: {("Z", "S-0-0092"): 250.0}[axis, key]
    text = f"#IDENT {word} [AXNR 3 ID S-0-0092 P=P2092 TYP 2 DEC {decimals} SERC]\nG1 F100 X=P2092"
    asked, wait, move = _commands(run, text, machine=machine)
    assert asked == canon.DriveRead(asked.block, "Z", "S-0-0092", 2)
    assert isinstance(wait, canon.Wait)
    assert move.target_mm == {"X": read}


def test_waiting_for_one_drive_and_for_all(run: Callable[..., list[Any]]) -> None:
    assert [c.axis for c in _commands(run, "#IDENT WAIT SYN [AX=Y SERC]")] == ["Y"]
    assert [c.axis for c in _commands(run, "#IDENT WAIT SYN")] == ["X", "Y", "Z"]


@pytest.mark.parametrize(
    ("text", "value", "allowed"),
    [
        (WRITE.replace("TYP 2", "TYP P1"), "3", "2, 4"),
        (WRITE.replace("DEC 0", "DEC P1/2"), "1.5", "0, 1, 2, 3, 4, 5, 6, 7, 8, 9"),
    ],
)
@pytest.mark.provokes(900256, 2)
def test_900256_for_a_computed_attribute_that_cannot_be(
    run: Callable[..., list[Any]], text: str, value: str, allowed: str
) -> None:
    with pytest.raises(Alarm) as caught:
        run(f"P1=3\n{text}")
    assert caught.value.id == 900256
    assert (caught.value.values["value"], caught.value.values["allowed"]) == (value, allowed)


@pytest.mark.parametrize(
    ("old", "new", "message", "found"),
    [
        ("S-0-0092", "TORQUE", "number of an ident", "TORQUE"),
        ("S-0-0092", "0x6072_00", "number of an ident", "0x6072_00"),
        ("S-0-0092", "0X6072_00", "number of an ident", "0X6072_00"),
        ("TYP 2", "TYP 3", "TYP out of range", "3"),
        (" DEC 0", "", "lacks DEC", None),
    ],
)
def test_refusals_name_their_place(old: str, new: str, message: str, found: str | None) -> None:
    with pytest.raises(UserError) as caught:
        parse_program(WRITE.replace(old, new), file="p.nc", axes=AXES)
    assert message in caught.value.message
    assert caught.value.value == found


def test_a_value_that_is_read_goes_to_a_variable_of_the_program() -> None:
    text = "#IDENT RD [AX X ID S-0-0092 P=V.A.ABS.X TYP 2 DEC 0 SERC]"
    with pytest.raises(UserError, match="the variable that gets the value"):
        parse_program(text, file=None, axes=AXES)


@pytest.mark.parametrize(
    "text",
    [
        "#IDENT WR SYN [AX X ID 0x6072_00 VAL 100 TYP 2 DEC 0 CAN]",
        "#IDENT WR SYN [AX X ID 0X6072_00 VAL 100 TYP 2 DEC 0 CAN]",
        "#IDENT RD SYN [AX X ID S-0-0092 P=P1 TYP 2 DEC 0 SERC NO_WAIT]",
    ],
)
def test_what_of_it_does_not_act_ends_with_900100(run: Callable[..., list[Any]], text: str) -> None:
    with pytest.raises(Alarm) as caught:
        run(text)
    assert caught.value.id == 900100


@pytest.mark.parametrize(
    ("named", "axes"),
    [("", AXES), ("AX=Y", ("Y",)), ("AXNR=2", ("Y",)), ("AXNR=P1", ("Z",))],
)
def test_a_wait_is_for_the_axis_that_it_names_or_for_all(
    run: Callable[..., list[Any]], named: str, axes: tuple[str, ...]
) -> None:
    for word, more in (("IDENT WAIT SYN", ""), ("COMMAND WAIT SYN", "ID=S-0-0148")):
        bracket = f"[{named} {more} SERC]"
        _, *commands = _commands(run, f'#MSG ["waits"]\nP1=3\n#{word} {bracket}')
        assert tuple(c.axis for c in commands) == axes
        assert {(c.commands, c.key) for c in commands} == {
            (True, "S-0-0148") if more else (False, "")
        }


@pytest.mark.parametrize("name", ["S-0-0148", "s-0-0148"])
def test_the_ident_of_a_command_is_the_same_in_either_case(
    run: Callable[..., list[Any]], name: str
) -> None:
    """The wait finds what was started, however either is spelled."""
    text = f"#COMMAND WR SYN [AX=X ID={name} SERC]\n#COMMAND WAIT SYN [AX=X ID={name} SERC]"
    start, wait = _commands(run, text)
    assert (start.key, start.value, start.is_command) == ("S-0-0148", 3, True)
    assert (wait.key, wait.commands) == ("S-0-0148", True)
