"""Loops that wait for the PLC side where nothing changes it: they end at once, with a name."""

import pytest
from tests.nc.conftest import PlaneMachine

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import Wait
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import parse_program

AXES = ("X", "Y", "Z")
MANY = 200


def decode(text: str, external: dict[str, float], *, constant: bool = True) -> int:
    """Decode at most MANY commands; how many there were."""
    machine = PlaneMachine(dict.fromkeys(AXES, 0.0), None)
    program = parse_program(text, file="wait.nc", axes=AXES)
    interpreter = Interpreter(program, AXES, machine, external=external, plc_is_constant=constant)
    count = 0
    for command in interpreter.commands():
        machine.queue.append(command)
        if isinstance(command, Wait):
            machine.execute()
        count += 1
        if count == MANY:
            break
    return count


@pytest.mark.provokes(900126, 2, loop="line 2 (N20 $WHILE V.E.READY == 0)", names="V.E.READY")
def test_900126_for_a_loop_that_waits_for_a_constant_plc_side() -> None:
    with pytest.raises(Alarm) as caught:
        decode("G1 X1 F100\nN20 $WHILE V.E.READY == 0\n$ENDWHILE", {"READY": 0.0})
    assert caught.value.id == 900126
    assert caught.value.values == {
        "loop": "line 2 (N20 $WHILE V.E.READY == 0)",
        "names": "V.E.READY",
    }


@pytest.mark.parametrize(
    "text",
    [
        "$WHILE V.E.READY == 0\nG4 X0.1\n$ENDWHILE",
        '$WHILE V.E.READY == 0\n#MSG ["not yet"]\n#TIME 0.1\n$ENDWHILE',
        "$DO\n$ENDDO V.E.READY == 0",
        "$REPEAT\n$UNTIL V.E.READY == 1",
        "$WHILE 1\n$IF V.E.READY == 1\n$BREAK\n$ENDIF\n$ENDWHILE",
        "N10:\n$IF V.E.READY == 0 $GOTO N10",
        "%L ASK\n$WHILE V.E.READY == 0\n$ENDWHILE\nM17\n%MAIN\nLL ASK",
        "#WAIT FOR V.E.READY == 1",
        "$WHILE V.E.READY == V.P.WANTED\n$ENDWHILE",
    ],
)
def test_every_way_of_waiting_is_found(text: str) -> None:
    if "WANTED" in text:
        text = f"V.P.WANTED = 0\n{text}"
    with pytest.raises(Alarm) as caught:
        decode(text, {"READY": 0.0})
    assert caught.value.id == 900126
    assert "V.E.READY" in str(caught.value)


def test_all_that_was_asked_is_named_in_the_order_of_the_alphabet() -> None:
    text = "P1 = 1\n$WHILE V.E.READY + V.E.GO[P1] == V.E.ABOVE\nG4 X0.1\n$ENDWHILE"
    with pytest.raises(Alarm) as caught:
        decode(text, {"READY": 0.0, "GO[1]": 0.0, "ABOVE": 0.0})
    assert caught.value.values["names"] == "V.E.ABOVE, V.E.GO[1], V.E.READY"


@pytest.mark.parametrize("changing", [1, 2, 3, 7])
@pytest.mark.parametrize("turns", [1, 2])
def test_a_loop_that_stops_to_change_anything_is_found_then(changing: int, turns: int) -> None:
    """Its first turns count; of an outer loop that ends, so do those of each time it is begun."""
    waiting = f"$WHILE V.E.READY == 0\n$IF P1 < {changing}\nP1 = P1 + 1\n$ENDIF\n$ENDWHILE"
    ends = "$WHILE V.E.READY == 0 AND P2 < 2\nP2 = P2 + 1\n$ENDWHILE"
    text = f"P1 = 0\n$FOR P3 = 1, {turns}, 1\nP2 = 0\n{ends}\n$ENDFOR\n{waiting}"
    with pytest.raises(Alarm) as caught:
        decode(text, {"READY": 0.0})
    assert caught.value.id == 900126
    assert caught.value.values == {
        "loop": "line 8 ($WHILE V.E.READY == 0)",
        "names": "V.E.READY",
    }


@pytest.mark.parametrize(
    "text",
    [
        "P1 = 0\n$WHILE V.E.READY == 0\nP1 = P1 + 1\n$IF P1 > 5\n$BREAK\n$ENDIF\n$ENDWHILE",
        '$FOR P1 = 1, 5, 1\n$IF V.E.READY == 1\n#MSG ["on"]\n$ENDIF\n$ENDFOR',
        "$WHILE V.E.READY == 0 AND V.A.ABS.X < 5\nG91 G1 X1 F100\n$ENDWHILE",
        "$WHILE V.E.READY == 1\n$ENDWHILE",
    ],
)
def test_a_loop_that_can_end_is_left_alone(text: str) -> None:
    assert decode(text, {"READY": 0.0}) < MANY


def test_a_loop_that_writes_or_moves_is_not_judged() -> None:
    """What it does may still end the program, by an alarm at the latest."""
    for body in ("V.E.DONE = 1", "G91 G1 X1 F100", "M10", "G4 X0.1 M10", "#MEAS PREPARE [AX=X]"):
        text = f"$WHILE V.E.READY == 0\n{body}\n$ENDWHILE"
        assert decode(text, {"READY": 0.0, "DONE": 0.0}) == MANY


def test_a_plc_side_that_may_change_is_waited_for() -> None:
    text = "$WHILE V.E.READY == 0\n$ENDWHILE"
    assert decode(text, {"READY": 0.0}, constant=False) == MANY


@pytest.mark.parametrize(
    "before",
    [
        "$FOR P1 = 1, 2, 1\nP2 = V.E.READY\n$ENDFOR",
        "P2 = V.E.READY",
        "P1 = 2\n$WHILE P1 > V.E.READY\nP1 = P1 - 1\n$ENDWHILE",
    ],
)
def test_a_loop_that_asks_nothing_waits_for_nobody(before: str) -> None:
    """What blocks before it have asked of the PLC side is none of its own."""
    loop = "$WHILE 1\nG4 X0.1\n$ENDWHILE"
    assert decode(f"{before}\n{loop}", {"READY": 0.0}) == MANY
    assert decode(loop, {"READY": 0.0}) == MANY
