"""#DRIVE as programs write it: forms, refusals with their place, what the channel gets."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.text.parser import parse_program

AXES = ("X", "Y", "Z")


def _commands(run: Callable[..., list[Any]], text: str, **options: Any) -> list[Any]:
    return [c for c in run(text, **options) if not isinstance(c, canon.EndOfProgram)]


@pytest.mark.parametrize(
    "text",
    [
        "#DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=10 WAIT]",
        "N30 #DRIVE WR SYN[AX=Z KEY=TORQUE_LIMIT VAL=10 WAIT]",
        "# drive  wr syn [ax = z, key = TORQUE_LIMIT, val = 5*2, wait]",
        "#DRIVE WR SYN [WAIT VAL=2*[3+2] KEY=TORQUE_LIMIT AX=Z]",
        "#DRIVE WR SYN [AX Z KEY TORQUE_LIMIT VAL 10 WAIT]",
        "#DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT \\\n VAL=10 WAIT]",
        "#DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=V.E.LIMIT WAIT] ; comment",
    ],
)
def test_a_write_in_all_its_forms(run: Callable[..., list[Any]], text: str) -> None:
    commands = _commands(run, text, external={"LIMIT": 10.0})
    (command,) = (c for c in commands if not isinstance(c, canon.Wait))
    assert isinstance(command, canon.DriveWrite)
    assert (command.axis, command.key, command.value, command.waits) == (
        "Z", "TORQUE_LIMIT", 10.0, True,
    )  # fmt: skip


def test_without_wait_the_program_goes_on(run: Callable[..., list[Any]]) -> None:
    (command,) = _commands(run, "#DRIVE WR SYN [AX=Y KEY=a VAL=-3]")
    assert (command.value, command.waits) == (-3.0, False)


def test_a_drive_is_named_by_the_number_of_its_axis_and_syn_may_be_left_out(
    run: Callable[..., list[Any]],
) -> None:
    """The machine of these tests numbers its axes from 1."""
    (write,) = _commands(run, "#DRIVE WR [AXNR=2 KEY=a VAL=3 WAIT]")
    assert (write.axis, write.value, write.waits) == ("Y", 3.0, True)
    (wait,) = _commands(run, "#DRIVE WAIT SYN [AXNR=3]")
    assert wait.axis == "Z"


def test_no_axis_has_this_number(run: Callable[..., list[Any]]) -> None:
    with pytest.raises(Alarm) as caught:
        _commands(run, "#DRIVE WR SYN [AXNR=7 KEY=a VAL=3]")
    assert (caught.value.id, caught.value.values) == (20312, {"number": "7"})


def test_a_function_may_be_called_like_a_keyword(run: Callable[..., list[Any]]) -> None:
    (command,) = _commands(run, "#DRIVE WR SYN [AX=X KEY=WAIT VAL=1]")
    assert (command.key, command.waits) == ("WAIT", False)


@pytest.mark.parametrize("text", ["#DRIVE WAIT SYN [AX=X SWITCH_OK]", "#DRIVE WAIT SYN [AX=X]"])
def test_waiting_for_all_writes(run: Callable[..., list[Any]], text: str) -> None:
    (command,) = _commands(run, text)
    assert command == canon.DriveWait(command.block, "X")


def test_reading_waits_and_gives_the_value_to_a_variable(
    run: Callable[..., list[Any]], plane_machine: Any
) -> None:
    machine = plane_machine(dict.fromkeys(AXES, 0.0), None)
    machine.drive_value = lambda axis, key: {("Z", "TORQUE_LIMIT"): 12.0}[axis, key]
    commands = _commands(
        run,
        "#DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=V.P.old]\nG1 F100 X=V.P.OLD*2\n",
        machine=machine,
    )
    read, wait, move = commands
    assert read == canon.DriveRead(read.block, "Z", "TORQUE_LIMIT")
    assert isinstance(wait, canon.Wait)
    assert move.target_mm == {"X": 24.0}


@pytest.mark.provokes(900113, 2, name="V.P.TORQUE", near="nothing has written it or a name like it")
def test_900113_for_a_variable_that_nothing_was_read_into(run: Callable[..., list[Any]]) -> None:
    with pytest.raises(Alarm) as caught:
        run(
            "N10 #DRIVE WR SYN [AX=Z KEY=A VAL=V.P.TORQUE]\nN20 #DRIVE RD [AX=Z KEY=A P=V.P.TORQUE]"
        )
    assert caught.value.id == 900113
    assert "N10" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "column", "message", "found"),
    [
        ("#DRIVE WR SYN", 1, "needs its keywords in one bracket", None),
        ("#DRIVE WR SYN []", 1, "needs its keywords in one bracket", None),
        ("#DRIVE WR SYN [AX=Z VAL=1]", 1, "lacks KEY", None),
        ("#DRIVE WR SYN [AX=W KEY=A VAL=1]", 19, "no such axis", "W"),
        ("#DRIVE WR SYN [AX=Z KEY=A VAL=1.5]", 31, "whole number", "1.5"),
        ("#DRIVE WR SYN [AX=Z KEY=A VAL=]", 31, "does not belong here", "]"),
        ("#DRIVE WR SYN [AX=Z KEY=A VAL=1 VAL=2]", 33, "keyword twice", "VAL"),
        ("#DRIVE WR SYN [AX=Z AX=X KEY=A VAL=1]", 21, "keyword twice", "AX"),
        ("#DRIVE WR SYN [AXIS=Z KEY=A VAL=1]", 16, "unknown keyword", "AXIS"),
        ("#DRIVE WR SYN [AX=Z KEY=MON WINDOW VAL=1]", 29, "unknown keyword", "WINDOW"),
        ("#DRIVE WR SYN [AX=Z KEY=A VAL=1*]", 33, "does not belong here", "]"),
        ("#DRIVE WR SYN [AX=Z KEY=A VAL=V.X.B]", 31, "unknown variable", "V.X.B"),
        ("#DRIVE RD [AX=Z KEY=A P=V.A.ABS.X]", 25, "the variable that gets", "V.A.ABS.X"),
    ],
)
def test_refusals_name_their_place(text: str, column: int, message: str, found: str | None) -> None:
    with pytest.raises(UserError) as caught:
        parse_program(text, file="p.nc", axes=AXES)
    error = caught.value
    assert message in error.message
    assert (error.line, error.column) == (1, column)
    assert error.value == found


def test_the_blank_of_the_printed_key_has_a_hint() -> None:
    with pytest.raises(UserError) as caught:
        parse_program("#DRIVE WR SYN [AX=Z KEY=MON WINDOW VAL=1]", file=None, axes=AXES)
    assert "MON_WINDOW" in str(caught.value)
