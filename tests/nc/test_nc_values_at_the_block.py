"""A value of the PLC side is read when the machining is at the block, wherever in it it stands."""

import pytest
from tests.nc.conftest import PlaneMachine

from axisrig.kernel.nc.canon import Command, Message, Wait
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import parse_program

AXES = ("X", "Y", "Z")
LOOP = '#MSG ["%g", P1]\n$ENDFOR'
SHOW = '#MSG ["%g", P1]'


def messages(text: str) -> list[str]:
    """V.E.N is 1 until a block waits for the next cycle, then 2."""
    machine = PlaneMachine(dict.fromkeys(AXES, 0.0), None)
    external = {"N": 1.0}
    program = parse_program(f"G1 X1 F100\n{text}", file="at.nc", axes=AXES)
    commands: list[Command] = []
    for command in Interpreter(program, AXES, machine, external=external).commands():
        commands.append(command)
        machine.queue.append(command)
        if isinstance(command, Wait):
            machine.execute()
            if command.for_cycle:
                external["N"] = 2.0
    return [each.text for each in commands if isinstance(each, Message)]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (f"$FOR P1 = V.E.N, 4, 1\n{LOOP}", ["2", "3", "4"]),
        (f"$FOR P1 = 0, V.E.N, 1\n{LOOP}", ["0", "1", "2"]),
        (f"$FOR P1 = 0, 4, V.E.N\n{LOOP}", ["0", "2", "4"]),
        (f"$FOR P1 = 4, 0, -V.E.N\n{LOOP}", ["4", "2", "0"]),
        (f"P1 = 3 + V.E.N\n{SHOW}", ["5"]),
        (f"P1 = 0\n$IF V.E.N == 2\nP1 = 7\n$ENDIF\n{SHOW}", ["7"]),
        (f"P1 = 0\n$IF 1 == 1 AND V.E.N == 2\nP1 = 7\n$ELSE\nP1 = 8\n$ENDIF\n{SHOW}", ["7"]),
        (f"P1 = 0\n$WHILE P1 < V.E.N\nP1 = P1 + 1\n$ENDWHILE\n{SHOW}", ["2"]),
        (f"P1 = 0\n$SWITCH V.E.N\n$CASE 1\nP1 = 5\n$BREAK\n$CASE 2\nP1 = 6\n$BREAK\n"
         f"$ENDSWITCH\n{SHOW}", ["6"]),
        ('#MSG ["%g", V.E.N]', ["2"]),
        (f"#VAR\nV.P.A = V.E.N\n#ENDVAR\nP1 = V.P.A\n{SHOW}", ["2"]),
        (f"#VAR\nV.P.A[3] = [4, 5, 6]\n#ENDVAR\nP1 = V.P.A[V.E.N]\n{SHOW}", ["6"]),
        (f"#VAR\nV.P.A[3] = [4, 5, 6]\n#ENDVAR\nV.P.A[V.E.N] = 9\nP1 = V.P.A[2]\n{SHOW}", ["9"]),
    ],
)  # fmt: skip
def test_every_place_of_a_block_that_reads_a_value_waits_for_the_machining(
    text: str, found: list[str]
) -> None:
    assert messages(text) == found


@pytest.mark.parametrize("other", ["V.A.ABS.Y", "P1", "V.G.WZ_AKT.R"])
def test_a_position_waits_whatever_else_its_block_reads(other: str) -> None:
    """X is at 5 mm once the block before is executed; the other value waits for nothing."""
    before, position = "P1 = 1\nG1 X5 F100\n", "V.A.ACT_POS.X"
    assert messages(f'{before}#MSG ["%g %g", {position}, {other}]')[0].split()[0] == "5"
    assert messages(f'{before}#MSG ["%g %g", {other}, {position}]')[0].split()[1] == "5"
    for sum_of_both in (f"{position} + 0 * {other}", f"0 * {other} + {position}"):
        assert messages(f"{before}P1 = {sum_of_both}\n{SHOW}") == ["5"]


@pytest.mark.parametrize("names", ["V.A.ACT_POS.X, V.E.N", "V.E.N, V.A.ACT_POS.X"])
def test_a_value_of_the_plc_side_beside_a_position_waits_for_the_cycle_too(names: str) -> None:
    found = messages(f'G1 X5 F100\n#MSG ["%g %g", {names}]')
    assert found == ["5 2" if names.startswith("V.A") else "2 5"]


MACHINE = ["V.A.MESS.X", "V.A.MEAS.ACS.VALUE.X", "V.A.MEAS.PCS.VALUE.X", "V.A.MOFFS.X",
           "V.A.MERF.X", "V.A.ACT_POS.X"]  # fmt: skip
NOTHING = ["P1", "V.A.PROG.X", "V.A.ABS.Y", "V.A.MEIN.X", "V.A.ACS.ABS.X", "V.A.BZP.X",
           "V.G.MEAS_TYPE", "V.G.T_AKT", "V.G.WZ_AKT.L", "V.G.NP[1].V.X", "V.G.FEEDRATE",
           "V.G.SELECTED_CS.TRANS.X"]  # fmt: skip


def waits(*names: str) -> list[bool]:
    """Whether each wait of a block that reads these variables is for the next cycle."""
    machine = PlaneMachine(dict.fromkeys(AXES, 0.0), ("X", 5.0))
    text = f'P1 = 1\nG100 X9 F100\n#MSG ["{"%g " * len(names)}", {", ".join(names)}]'
    program = parse_program(text, file="at.nc", axes=AXES)
    found = []
    for command in Interpreter(program, AXES, machine, external={"N": 1.0}).commands():
        machine.queue.append(command)
        if isinstance(command, Wait):
            machine.execute()
            found.append(command.for_cycle)
    return found[1:]  # the first one is that of the run


@pytest.mark.parametrize("name", NOTHING)
def test_what_the_decoder_knows_waits_for_nothing(name: str) -> None:
    assert waits(name) == []


@pytest.mark.parametrize("name", MACHINE)
def test_what_the_machine_knows_waits_until_everything_before_is_executed(name: str) -> None:
    assert waits(name) == [False]
    assert waits(name, "P1", name) == [False]


@pytest.mark.parametrize("name", [*MACHINE, *NOTHING])
def test_a_block_waits_once_for_the_next_cycle_wherever_it_asks_the_plc_side(name: str) -> None:
    """Before, after and between; the longer wait counts, whichever is asked for first."""
    for names in ((name, "V.E.N"), ("V.E.N", name), (name, "V.E.N", name), ("V.E.N", name, "P1")):
        assert waits(*names) == [True], names
