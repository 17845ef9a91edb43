"""What a run leaves of the runs before it, loops over calls, and a kinematic beside other axes."""

import pytest
from tests.nc.conftest import run_text
from tests.nc.five_axes import FIVE

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import KinematicChoice, Message
from axisrig.kernel.nc.coordinates import OffsetTables
from axisrig.kernel.nc.decoder import Interpreter, interpreter
from axisrig.kernel.nc.text.parser import parse_program

XYZ = ("X", "Y", "Z")
RESULTS = ("V.A.MESS", "V.A.MOFFS", "V.A.MEAS.ACS.VALUE", "V.A.MEAS.PCS.VALUE")


@pytest.fixture
def touching(plane_machine):
    """Its probe signals where X crosses 5 mm."""
    return plane_machine(dict.fromkeys(XYZ, 0.0), ("X", 5.0))


@pytest.mark.parametrize("name", RESULTS)
def test_900101_after_a_run_without_a_signal_whatever_the_run_before_gave(run, touching, name):
    """FCT-C4 section 5: the values are those of the last run."""
    first = f'G100 F9 X10\n#MSG ["%g %d", {name}.X, V.A.MERF.X]\nG0 X10\n'
    second = "G100 X12"
    show = f'{second}\n#MSG ["%d", V.A.MERF.X]\n'
    texts = [each.text for each in run(first + show, touching) if isinstance(each, Message)]
    assert [text.split()[-1] for text in texts] == ["1", "0"]
    for reading in (f"P1={name}.X", *(["G101 X1"] if name == "V.A.MOFFS" else [])):
        touching.acs_mm.update(dict.fromkeys(XYZ, 0.0))
        with pytest.raises(Alarm) as caught:
            run(f"{first}{second}\n{reading}", touching)
        assert (caught.value.id, caught.value.values["axis"]) == (900101, "X")


def test_an_axis_that_was_not_in_a_run_keeps_what_it_had(run, touching):
    """FCT-C4 section 5, several runs: other axes keep theirs."""
    text = "G100 F9 X10\nG0 X0\nG100 Y1\nP1=V.A.MESS.X\n"
    show = '#MSG ["%g %d %d", P1, V.A.MERF.X, V.A.MERF.Y]'
    texts = [each.text for each in run(text + show, touching) if isinstance(each, Message)]
    assert texts == ["5 1 0"]


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
def test_900120_comes_with_the_first_block_that_is_too_many(
    plane_machine, monkeypatch, most, messages
):
    """Four blocks a turn, of which the first turn comes for the first time; 250 = 62 turns + 2."""
    monkeypatch.setattr(interpreter, "IDLE_BLOCKS_MAX", most)
    text = 'P1=0\n$WHILE 1\nP1=P1+1\n#MSG ["%d", P1]\n$ENDWHILE'
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    decoding = Interpreter(parse_program(text, axes=XYZ), XYZ, machine, external={})
    found = []
    with pytest.raises(Alarm) as caught:
        found.extend(command.text for command in decoding.commands())  # as far as it gets
    assert caught.value.values["blocks"] == most
    assert found == [str(number + 1) for number in range(messages)]


def test_a_loop_of_the_caller_is_the_busiest_while_its_subprogram_turns_less(plane_machine):
    text = (
        "%L SUB\n$FOR P2=1,3,1\nG4 X1\n$ENDFOR\nM17\n%MAIN\nN10 $FOR P1=1,9,1\nLL SUB\n$ENDFOR\nM30"
    )
    program = parse_program(text, axes=XYZ)
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    decoding = Interpreter(program, XYZ, machine, external={})
    commands, found = decoding.commands(), []
    for _ in range(18):  # three in each of six calls
        next(commands)
        busiest = decoding.busiest_loop()
        found.append(None if busiest is None else (busiest[0].line, busiest[1]))
    assert found[:3] == [None, (2, 1), (2, 2)]
    assert found[9] == (7, 3)  # the fourth call: its loop has not turned yet
    assert found[11:] == [(7, 3), *[(7, 4)] * 3, *[(7, 5)] * 3]


@pytest.mark.parametrize(
    ("blocks", "refused"),
    [
        ("#PUT AX [U]", None),
        ("#SET AX LINK [1, U=V]\n#ENABLE AX LINK [1]", None),
        ("#PUT AX [A]", (900195, {"axis": "A"})),
        ("#SET AX LINK [1, A=V]\n#ENABLE AX LINK [1]",
         (900196, {"axis": "A", "master": "V", "group": 1})),
        ("#SET AX LINK [1, U=V]\n#ENABLE AX LINK [1]\n#PUT AX [C]", (900195, {"axis": "C"})),
    ],
)  # fmt: skip
def test_only_its_own_axes_have_to_be_free_for_a_kinematic(blocks, refused):
    tables = OffsetTables(rotary=frozenset("CA"))
    text = f"V.G.WZ_AKT.L = 80\n{blocks}\n#TRAFO [9]"
    axes = (*FIVE, "U", "V")
    if refused is None:
        (choice,) = [
            each
            for each in run_text(text, axes=axes, tables=tables)
            if isinstance(each, KinematicChoice)
        ]
        assert choice.axes == FIVE
        return
    with pytest.raises(Alarm) as caught:
        run_text(text, axes=axes, tables=tables)
    assert (caught.value.id, caught.value.values) == refused
