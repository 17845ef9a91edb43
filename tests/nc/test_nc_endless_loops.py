"""Loops without end: an alarm where the machine has nothing to do, none where time passes.

The alarm names the busiest loop.
"""

from itertools import islice

import pytest
from tests.nc.conftest import XYZ, PlaneMachine

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import Message, Wait
from axisrig.kernel.nc.decoder import Interpreter, interpreter
from axisrig.kernel.nc.text.parser import parse_program


@pytest.mark.provokes(900120, 2, blocks=100_000, turns=33334)
@pytest.mark.long
def test_900120_for_a_loop_that_never_ends(run):
    with pytest.raises(Alarm) as caught:
        run("G0 X1\nN10 $WHILE 1\nP1=1\n$ENDWHILE")
    assert caught.value.id == 900120
    assert "line 2 (N10 $WHILE 1)" in str(caught.value.values["loop"])


@pytest.mark.parametrize(
    "text",
    [
        "[A] P1=1\n$GOTO [A]",
        "$DO\nP1=1\n$ENDDO 1",
        "$FOR P1=1,2,V.A.ABS.X\n$ENDFOR",
        "$WHILE 1\nX0\n$ENDWHILE",
    ],
    ids=["jumps", "do", "for with step 0", "moves that lead nowhere"],
)
def test_every_kind_of_loop_without_end_is_found(run, monkeypatch, text):
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 250)
    with pytest.raises(Alarm) as caught:
        run(f"G0\n{text}")
    assert caught.value.id == 900120


SUBPROGRAM = "%L SUB\n" + "P1=P1+1\n" * 300 + "M17\n%MAIN\nP1=0\n"


@pytest.mark.long
def test_a_straight_program_is_no_endless_loop(run):
    (message,) = [
        c
        for c in run("P1=0\n" + "P1=P1+1\n" * 100_100 + '#MSG ["%d", P1]\n')
        if isinstance(c, Message)
    ]
    assert message.text == "100100"


@pytest.mark.long
def test_a_straight_program_of_blocks_and_calls_is_no_endless_loop(run, monkeypatch):
    """900 blocks in three calls, none of which comes from a loop."""
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 250)
    loop = "$FOR P2=1,5,1\n$ENDFOR\n"
    text = "P1=0\n" + loop + "P1=P1+1\n" * 300 + '#MSG ["%d", P1]\n'
    (message,) = [c for c in run(text) if isinstance(c, Message)]
    assert message.text == "300"
    text = SUBPROGRAM + "LL SUB\n" * 3 + '#MSG ["%d", P1]\nM30\n'
    (message,) = [c for c in run(text) if isinstance(c, Message)]
    assert message.text == "900"


@pytest.mark.long
def test_behind_a_motion_in_a_subprogram_no_block_has_come_again(run, monkeypatch):
    """300 blocks in each of three calls of a loop, a motion before them in all but the first."""
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 250)
    sub = "%L SUB\nG0 X=P1\n" + "P2=P2+1\n" * 300 + "M17\n%MAIN\nP2=0\n"
    text = sub + '$FOR P1=0,2,1\nLL SUB\n$ENDFOR\n#MSG ["%d", P2]\nM30'
    (message,) = [c for c in run(text) if isinstance(c, Message)]
    assert message.text == "900"


@pytest.mark.parametrize(
    "text",
    [
        SUBPROGRAM + "$WHILE 1\nLL SUB\n$ENDWHILE\nM30\n",
        "X1 F100 G1\n" + "P1=1\n" * 40 + "$WHILE 1\nP1=1\n$ENDWHILE",
    ],
    ids=["calls", "behind a motion"],
)
def test_blocks_that_come_again_are_counted_wherever_they_are(run, monkeypatch, text):
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 250)
    with pytest.raises(Alarm) as caught:
        run(text)
    assert caught.value.id == 900120


def test_blocks_of_a_subprogram_that_is_called_again_come_again(run, monkeypatch):
    """The second turn: $WHILE and the call, then the blocks from line 2 on; the 251st is too many.

    No block of the subprogram comes twice within one call.
    """
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 250)
    with pytest.raises(Alarm) as caught:
        run(SUBPROGRAM + "$WHILE 1\nLL SUB\n$ENDWHILE\nM30\n")
    assert caught.value.place == f"test.nc line {2 + 251 - 2 - 1}"


@pytest.mark.parametrize(("turns", "goes_on"), [(12, True), (60, False)])
def test_a_motion_begins_the_count_anew(monkeypatch, turns, goes_on):
    """Some 2 blocks in each turn of the inner loop, of which 50 may come again; then a motion."""
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 50)
    body = f"$FOR P2=1,{turns},1\n$ENDFOR\nX1\nX0"
    if goes_on:
        assert len(decoded(body, 300)) == 300
    else:
        with pytest.raises(Alarm) as caught:
            decoded(body, 300)
        assert caught.value.id == 900120


def test_the_alarm_names_the_loop_without_end(run, monkeypatch):
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 250)
    with pytest.raises(Alarm) as caught:
        run("$WHILE 1\n$FOR P1=1,5,1\nP2=P1\n$ENDFOR\n$ENDWHILE")
    assert "line 1 ($WHILE 1)" in str(caught.value.values["loop"])


class Drives(PlaneMachine):
    """Its drives answer 0 to every question."""

    def drive_value(self, axis, key):
        return 0.0


def decoded(body, count):
    """So many commands of a program that runs for ever, or fewer if it ends."""
    machine = Drives(dict.fromkeys(XYZ, 0.0), None)
    program = parse_program(f"N1 F100 G1 P1=0\nN2 $WHILE 1\n{body}\n$ENDWHILE", axes=XYZ)
    found = []
    external = {"READY": 0.0}
    for command in islice(Interpreter(program, XYZ, machine, external=external).commands(), count):
        found.append(command)
        machine.queue.append(command)
        if isinstance(command, Wait):
            machine.execute()
    return found


@pytest.mark.parametrize(
    "body",
    [
        "G4 0", "#TIME 0", "M1", "M8", "G60", "#FLUSH", "G261", "T3", "H4", "G92 X1", "G54",
        "P1=1-P1", "X0", "#MEAS PREPARE[AX=X]", "#MEAS[AX=X INPUT=2]", "#SLOPE[TYPE=TRAPEZ]",
        "G131 = 70", '#MSG["again"]', "#CS ON[0,0,1]\n#CS OFF",
        "P1=V.A.ACT_POS.X", "P1=V.A.MERF.X", "P1=V.A.ACT_POS.X+V.A.ACT_POS.Y", "#FLUSH WAIT",
        "#CHANNEL INIT[ACTPOS AX=X]", "$IF V.A.ACT_POS.X > 5\nP1=1\n$ENDIF",
    ],
)  # fmt: skip
def test_a_loop_that_gives_the_machine_nothing_to_do_ends_with_900120(monkeypatch, body):
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 250)
    with pytest.raises(Alarm) as caught:
        decoded(body, 2000)
    assert caught.value.id == 900120
    assert "line 2 (N2 $WHILE 1)" in str(caught.value.values["loop"])


@pytest.mark.parametrize(
    "body",
    [
        "G4 0.1", "#TIME 0.1", "M0", "X1\nX0", "G0 X1\nX0", "G2 X10 I5", "G100 X1\nX0", "G74 X1",
        "X[INDP_ASYN POS=1 G01 FEED=100]\nX[INDP_ASYN POS=0 G01 FEED=100]", "P1=V.E.READY",
        "P1=V.A.ACT_POS.X+V.E.READY", "P1=V.E.READY+V.A.ACT_POS.X", "$IF V.E.READY > 1\n$ENDIF",
        "#WAIT FOR V.E.READY > 1",
        "#DRIVE RD[AX=X KEY=A P=P1]", "#DRIVE WAIT SYN[AX=X]",
    ],
)  # fmt: skip
def test_a_loop_in_which_time_passes_may_go_on_for_ever(monkeypatch, body):
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 50)
    assert len(decoded(body, 300)) == 300


LOOPS = {
    "$WHILE P1<5": ("P1=0\n$WHILE P1<5\nP1=P1+1\n$ENDWHILE", 5),
    "$DO": ("P1=0\n$DO\nP1=P1+1\n$ENDDO P1<5", 4),
    "$REPEAT": ("P1=0\n$REPEAT\nP1=P1+1\n$UNTIL P1>4", 4),
    "$FOR P1=1,5,1": ("$FOR P1=1,5,1\n$ENDFOR", 4),
}
"""Each goes through its body five times; how often it jumps back meanwhile."""


@pytest.mark.parametrize("begin", LOOPS)
@pytest.mark.parametrize("entries", [1, 2, 3])
def test_the_turns_of_a_loop_count_from_its_entry_on(begin, entries):
    """An outer loop begins it anew; two loops behind one another have their own turns."""
    body, turns = LOOPS[begin]
    text = f"$FOR P2=1,{entries},1\n{body}\n$ENDFOR\n$WHILE P3<2\nP3=P3+1\n$ENDWHILE"
    machine = PlaneMachine(dict.fromkeys(XYZ, 0.0), None)
    program = parse_program(f"P3=0\n{text}", axes=XYZ)
    interpreter = Interpreter(program, XYZ, machine, external={})
    assert interpreter.busiest_loop() is None
    list(interpreter.commands())
    busiest = interpreter.busiest_loop()
    assert busiest is not None
    assert (busiest[0].text, busiest[1]) == (begin, turns)


@pytest.mark.parametrize(
    "loop",
    [
        "$WHILE 1\nP1=V.A.ACT_POS.X\n$ENDWHILE",
        "$WHILE 1\n#FLUSH WAIT\n$ENDWHILE",
        '$DO\n#MSG SYN ["again"]\n$ENDDO 1',
        "[A] P1=V.A.MERF.X\n$GOTO [A]",
        "$REPEAT\n#CHANNEL INIT [CMDPOS]\n$UNTIL 0",
    ],
)
def test_900120_for_a_loop_that_only_waits_for_what_is_done_already(run, monkeypatch, loop):
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", 60)
    with pytest.raises(Alarm) as caught:
        run(f"G0 X1\n{loop}")
    assert caught.value.id == 900120
    assert caught.value.values["blocks"] == 60


@pytest.mark.parametrize(("most", "messages"), [(250, 63), (251, 64), (6, 2), (7, 3)])
def test_900120_comes_with_the_first_block_that_is_too_many(monkeypatch, most, messages):
    """Four blocks a turn, of which the first turn comes for the first time; 250 = 62 turns + 2."""
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", most)
    text = 'P1=0\n$WHILE 1\nP1=P1+1\n#MSG ["%d", P1]\n$ENDWHILE'
    machine = PlaneMachine(dict.fromkeys(XYZ, 0.0), None)
    decoding = Interpreter(parse_program(text, axes=XYZ), XYZ, machine, external={})
    found = []
    with pytest.raises(Alarm) as caught:
        found.extend(command.text for command in decoding.commands())  # as far as it gets
    assert caught.value.values["blocks"] == most
    assert found == [str(number + 1) for number in range(messages)]


def test_a_loop_of_the_caller_is_the_busiest_while_its_subprogram_turns_less():
    text = (
        "%L SUB\n$FOR P2=1,3,1\nG4 X1\n$ENDFOR\nM17\n%MAIN\nN10 $FOR P1=1,9,1\nLL SUB\n$ENDFOR\nM30"
    )
    program = parse_program(text, axes=XYZ)
    machine = PlaneMachine(dict.fromkeys(XYZ, 0.0), None)
    decoding = Interpreter(program, XYZ, machine, external={})
    commands, found = decoding.commands(), []
    for _ in range(18):  # three in each of six calls
        next(commands)
        busiest = decoding.busiest_loop()
        found.append(None if busiest is None else (busiest[0].line, busiest[1]))
    assert found[:3] == [None, (2, 1), (2, 2)]
    assert found[9] == (7, 3)  # the fourth call: its loop has not turned yet
    assert found[11:] == [(7, 3), *[(7, 4)] * 3, *[(7, 5)] * 3]


NESTED = "$FOR P1=1,9,1\nG4 X1\n$FOR P2=1,4,1\nG4 X2\n$ENDFOR\n$ENDFOR"


@pytest.mark.parametrize(
    ("count", "line", "turns"),
    [(1, None, None), (3, 3, 1), (5, 3, 3), (9, 3, 2), (36, 1, 7), (37, 1, 7)],
)
def test_the_busiest_loop_is_the_one_that_was_jumped_back_to_most(count, line, turns):
    """An outer turn is five dwell times: its own, and four of the inner loop."""
    program = parse_program(NESTED, axes=XYZ)
    machine = PlaneMachine(dict.fromkeys(XYZ, 0.0), None)
    decoding = Interpreter(program, XYZ, machine, external={})
    commands = decoding.commands()
    for _ in range(count):
        next(commands)
    busiest = decoding.busiest_loop()
    if line is None:
        assert busiest is None
        return
    assert busiest is not None
    assert (busiest[0].line, busiest[1]) == (line, turns)
