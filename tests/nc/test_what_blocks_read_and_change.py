"""What a block reads before it is decoded, what it may change, and which words are passed over."""

import pytest
from tests.nc.conftest import PlaneMachine

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import LinearMove, Message, Wait
from axisrig.kernel.nc.decoder import Interpreter, interpreter
from axisrig.kernel.nc.decoder.base.waiting import may_change
from axisrig.kernel.nc.decoder.base.walk import read_by, written_by
from axisrig.kernel.nc.syntax import Statement
from axisrig.kernel.nc.text.parser import parse_program

XYZ = ("X", "Y", "Z")
AROUND = {
    "$ENDIF": ("$IF 1", ""), "$ENDFOR": ("$FOR P9=1,2,1", ""), "$UNTIL": ("$REPEAT", ""),
    "$ENDDO": ("$DO", ""), "$CASE": ("$SWITCH 1", "$ENDSWITCH"), "$IF": ("", "$ENDIF"),
    "$FOR": ("", "$ENDFOR"), "$WHILE": ("", "$ENDWHILE"), "$SWITCH": ("", "$ENDSWITCH"),
    "V.P.ARRAY": ("#VAR", "#ENDVAR"),
}  # fmt: skip


def statement(text: str) -> Statement:
    """A block with what belongs around it."""
    before, after = next((each for word, each in AROUND.items() if text.startswith(word)), ("", ""))
    program = parse_program(f"{before}\n{text}\n{after}".strip(), file="p.nc", axes=XYZ)
    found = program.blocks[1 if before else 0].statement
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("G1 X=V.P.A Y=V.P.B F=V.P.C H=V.P.D", "V.P.A V.P.B V.P.C V.P.D"),
        ("Y=V.P.A F=V.P.B X[INDP_ASYN POS=V.P.C FEED=V.P.D G91] H=V.P.E",
         "V.P.A V.P.B V.P.C V.P.D V.P.E"),
        ("X[INDP_SYN POS=1 FEED=5] Y[INDP_SYN POS=V.P.A FEED=5] F=V.P.B", "V.P.A V.P.B"),
        ("V.P.A=V.P.B+1", "V.P.B"),
        ("V.P.A[V.P.I]=V.P.B", "V.P.B V.P.I"),
        ("P1=P[V.P.I]", "P[] V.P.I"),
        ("$FOR V.P.A=V.P.B,V.P.C,V.P.D", "V.P.B V.P.C V.P.D"),
        ("$IF V.P.A > ABS[V.P.B]", "V.P.A V.P.B"),
        ("$WHILE NOT[V.P.A] AND -V.P.B", "V.P.A V.P.B"),
        ("$UNTIL V.P.A", "V.P.A"),
        ("$ENDDO V.P.A", "V.P.A"),
        ("$SWITCH V.P.A", "V.P.A"),
        ("$CASE V.P.A", "V.P.A"),
        ('#MSG ["%f %f", V.P.A, V.P.B]', "V.P.A V.P.B"),
        ("#CS ON[V.P.A,1,V.P.B]", "V.P.A V.P.B"),
        ("#CS DEF[V.P.I][V.P.A]", "V.P.A V.P.I"),
        ("#DRIVE WR [AX=X KEY=K VAL=V.P.A]", "V.P.A"),
        ("#KIN ID[V.P.A, V.P.B]", "V.P.A V.P.B"),
        ("Z[DIST_CTRL SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.A KP=V.P.B]", "V.P.B"),
        ("Z[DIST_CTRL SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.A[V.P.I]]", "V.P.I"),
        ("V.P.ARRAY[2] = [V.P.A, V.P.B]", "V.P.A V.P.B"),
        ("X1 Y2 F3", ""),
    ],
)  # fmt: skip
def test_every_place_of_a_block_that_reads_a_variable_is_found(text: str, names: str) -> None:
    assert sorted({variable.name for variable in read_by(statement(text))}) == names.split()


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("V.P.A[V.P.I]=V.P.B", "V.P.A[]"),
        ("P1=V.P.B", "P[]"),
        ("$FOR V.P.A=V.P.B,1,1", "V.P.A"),
        ("#DRIVE RD [AX=X KEY=K P=V.P.A]", "V.P.A"),
        ("V.P.ARRAY[2] = [V.P.A, V.P.B]", "V.P.ARRAY[]"),
        ("$IF V.P.A", ""),
        ("X=V.P.A F=V.P.B", ""),
    ],
)
def test_what_a_block_may_write_is_found(text: str, names: str) -> None:
    assert " ".join(variable.name for variable in written_by(statement(text))) == names


@pytest.mark.parametrize(
    ("text", "changes"),
    [
        ("G4 1", False), ("G4 X1", False), ("G4[V.P.A]", False),
        ("G4 1 M7", True), ("G4 1 X[INDP_ASYN POS=1 FEED=5]", True), ("G90 G4 1", True),
        ("X1", True), ("M7", True), ("X[INDP_ASYN POS=1 FEED=5]", True),
        ('#MSG ["a"]', False), ("#TIME [1]", False), ("#FLUSH WAIT", False),
        ("#WAIT FOR V.E.A", False), ("#CS ON[1]", True), ("#MEAS MODE[2]", True),
        ("P1=1", True), ("V.P.ARRAY[2] = [1, 2]", True), ("$FOR P1=1,2,1", True),
        ("$ENDFOR", True), ("$IF V.E.A", False), ("$ENDIF", False), ("$WHILE 1", False),
        ("$UNTIL V.E.A", False), ("$SWITCH 1", False), ("$CASE 1", False),
    ],
)  # fmt: skip
def test_a_block_changes_something_or_passes_time_only(text: str, changes: bool) -> None:
    assert may_change(statement(text)) is changes


class Drifting(PlaneMachine):
    """A machine of which X goes on by 1 mm whenever the program waits."""

    def execute(self) -> None:
        super().execute()
        self.acs_mm["X"] += 1.0


def texts(text: str, machine: PlaneMachine) -> list[str]:
    """Messages of a program; nothing but it changes a V.E. variable."""
    program = parse_program(text, file="p.nc", axes=XYZ)
    found = Interpreter(program, XYZ, machine, external={"A": 0.0}, plc_is_constant=True)
    shown = []
    for command in found.commands():
        machine.queue.append(command)
        if isinstance(command, Wait):
            machine.execute()
        if isinstance(command, Message):
            shown.append(command.text)
    return shown


def test_a_loop_that_looks_at_an_axis_may_wait_beside_the_plc_side() -> None:
    """What it waits for is the axis; the same loop without that look waits for nothing."""
    asks = "[AGAIN] $IF V.E.A == 1\n$ENDIF\n"
    looks = "$IF V.A.ACT_POS.X > 5\n$GOTO [END]\n$ENDIF\n"
    again = '$GOTO [AGAIN]\n[END] #MSG ["there"]'
    start = dict.fromkeys(XYZ, 0.0)
    assert texts(f"{asks}{looks}{again}", Drifting(start, None)) == ["there"]
    with pytest.raises(Alarm) as caught:
        texts(f"{asks}{again}", Drifting(start, None))
    assert caught.value.id == 900126


def test_behind_each_motion_the_blocks_of_a_turn_come_first(run, monkeypatch) -> None:
    """Eight of them in each of three turns, where five may come again."""
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 5)
    body = "P2=P2+1\n" * 8
    commands = run(f'P2=0\n$FOR P1=1,3,1\nG1 X=P1 F100\n{body}$ENDFOR\n#MSG ["%d", P2]')
    assert [c.text for c in commands if isinstance(c, Message)] == ["24"]
    assert len([c for c in commands if isinstance(c, LinearMove)]) == 3
    with pytest.raises(Alarm) as caught:
        run(f"P2=0\n$FOR P1=1,3,1\n{body}$ENDFOR")
    assert caught.value.id == 900120


@pytest.mark.parametrize(("block", "word"), [("G25 G41 X1", "G41"), ("G41 G25 X1", "G41")])
def test_a_word_that_is_passed_over_takes_no_other_one_with_it(block: str, word: str) -> None:
    program = parse_program(f"G0 X1\n{block}", file="p.nc", axes=XYZ)
    found = Interpreter(program, XYZ, PlaneMachine(dict.fromkeys(XYZ, 0.0), None), external={})
    found.pass_over(["G25"])
    with pytest.raises(Alarm) as caught:
        list(found.commands())
    assert (caught.value.id, caught.value.values["word"]) == (900100, word)


def test_a_case_that_the_one_before_it_leads_into_is_not_asked(run) -> None:
    """Without $BREAK: its value has no meaning then, and may have none."""
    text = (
        "P2=0\n$SWITCH 1\n$CASE 1\nP3=1\n$CASE 1/P2\nP3=P3+10\n$BREAK\n$CASE 2\nP3=99\n$ENDSWITCH"
    )
    (message,) = [c for c in run(f'{text}\n#MSG ["%d", P3]') if isinstance(c, Message)]
    assert message.text == "11"
    with pytest.raises(Alarm) as caught:
        run(text.replace("$SWITCH 1", "$SWITCH 5"))
    assert caught.value.id == 20396


@pytest.mark.parametrize(
    ("loop", "counter"),
    [("5,1,1", "5"), ("1,5,-1", "1"), ("1,1,1", "2"), ("1,3,1", "4"), ("3,1,-1", "0")],
)
def test_a_counter_stays_where_its_loop_was_left(run, loop: str, counter: str) -> None:
    """Behind a loop that makes no turn it has its first value."""
    commands = run(f'$FOR P1={loop}\nP2=1\n$ENDFOR\n#MSG ["%g", P1]')
    assert [c.text for c in commands if isinstance(c, Message)] == [counter]
