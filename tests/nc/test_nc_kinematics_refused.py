"""What #KIN ID, #TRAFO and parameters of a kinematic are refused or warned of for."""

import pytest
from tests.nc.conftest import run_text
from tests.nc.five_axes import FIVE, ON, TABLES, run5

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.canon import KinematicChoice, Warn
from axisrig.kernel.nc.coordinates import OffsetTables, Tool, Tools
from axisrig.kernel.nc.text.parser import parse_program


@pytest.mark.provokes(900482, 2, axis="X", name="9", word="G74")
def test_an_axis_of_the_kinematic_is_not_homed() -> None:
    with pytest.raises(Alarm) as alarm:
        run5(ON + "G74 X1")
    assert alarm.value.id == 900482


@pytest.mark.parametrize(
    ("program", "alarm_id"),
    [
        (ON + "X[INDP_ASYN G90 POS=5 G01 FEED=100]", 21071),
        (ON + "#PUT AX [A]", 900482),
        ("V.G.WZ_AKT.V.X = 3\n#TRAFO [9]", 900480),
        ("#TRAFO ON", 900441),
        ("#TRAFO [98]", 900441),
    ],
)
def test_what_does_not_go_together(program: str, alarm_id: int) -> None:
    with pytest.raises(Alarm) as alarm:
        run5(program)
    assert alarm.value.id == alarm_id
    assert alarm.value.place is not None
    assert "line" in alarm.value.place


def test_a_tilt_that_98_forbids_is_refused_when_it_is_switched_on() -> None:
    parameters = (
        "V.G.KIN_STEP[1].ID[98].PARAM[1] = 100000\nV.G.KIN_STEP[1].ID[98].PARAM[3] = 300000"
    )
    with pytest.raises(Alarm) as alarm:
        run5(f"{parameters}\nG0 A40\n#TRAFO [9, 98]")
    assert (alarm.value.id, "line 4" in str(alarm.value.place)) == (900444, True)


def test_a_rig_without_these_axes_refuses_the_kinematic() -> None:
    with pytest.raises(Alarm, match="needs the axes X") as alarm:
        run_text("#TRAFO [9]")
    assert alarm.value.id == 292040


@pytest.mark.provokes(900480, 2, axes="X")
def test_a_tool_of_the_list_with_offsets_is_refused() -> None:
    tools = Tools({1: Tool(length_mm=80.0, offsets_mm={0: 3.0}, valid=True)})
    with pytest.raises(Alarm) as alarm:
        run5("D1\n#TRAFO [9]", tables=OffsetTables(tools=tools, rotary=frozenset("CA")))
    assert alarm.value.id == 900480


@pytest.mark.provokes(20403, 2, name="V.G.KIN_STEP[].ID[].PARAM[]")
@pytest.mark.parametrize(
    ("place", "value", "last"),
    [("[2].ID[9].PARAM[0]", 2, 1), ("[0].ID[9].PARAM[74]", 74, 73)],
)
@pytest.mark.parametrize("block", ["V.G.KIN_STEP{} = 1", "V.P.X = V.G.KIN_STEP{}"])
def test_a_parameter_of_no_step_or_no_number_is_refused(
    block: str, place: str, value: int, last: int
) -> None:
    with pytest.raises(Alarm) as alarm:
        run5(block.format(place))
    found = alarm.value
    assert (found.id, found.values["value"], found.values["upper"]) == (20403, value, last)
    run5("V.G.KIN_STEP[1].ID[98].PARAM[73] = 1")


@pytest.mark.parametrize("number", ["65536", "18446744073709551616", "99999.0"])
@pytest.mark.parametrize("word", ["KIN ID", "TRAFO", "TRAFO ON"])
def test_a_number_that_no_kinematic_can_have_is_refused_when_the_text_is_read(
    word: str, number: str
) -> None:
    """P-CHAN-00262 is UNS16; 65535 may be one, which only a list knows."""
    parse_program(f"#{word}[65535]\nM30\n", axes="XYZ")
    with pytest.raises(UserError, match="no kinematic has such an ID"):
        parse_program(f"#{word}[{number}]\nM30\n", axes="XYZ")


@pytest.mark.parametrize("block", ["#TRAFO []", "#TRAFO ON []", "#KIN ID[]"])
def test_brackets_without_a_kinematic_are_refused(block: str) -> None:
    with pytest.raises(UserError):
        run5(block)


@pytest.mark.provokes(292005, 2)
@pytest.mark.parametrize(
    ("block", "alarm_id"),
    [("#KIN ID[9,99]", 292005), ("#KIN ID[5]", 900440), ("V.P.K = 9.5\n#KIN ID[V.P.K]", 292005)],
)
def test_what_cannot_be_switched_on_is_refused_where_it_is_chosen(
    block: str, alarm_id: int
) -> None:
    with pytest.raises(Alarm) as alarm:
        run5(block)
    assert alarm.value.id == alarm_id


@pytest.mark.parametrize(("ids", "step"), [("P1", 0), ("P1, 98", 0), ("9, P1", 1)])
@pytest.mark.parametrize("word", ["KIN ID", "TRAFO", "TRAFO ON"])
def test_a_computed_id_with_a_fraction_is_named_with_its_step(
    word: str, ids: str, step: int
) -> None:
    """The first kinematic is step 0, the one behind it step 1."""
    with pytest.raises(Alarm) as alarm:
        run5(f"P1 = 98.5\n#{word}[{ids}]")
    assert alarm.value.id == 292005
    assert (alarm.value.values["id"], alarm.value.values["step"]) == ("98.5", step)


@pytest.mark.provokes(900484, 1)
@pytest.mark.parametrize("word", ["KIN ID", "TRAFO"])
def test_a_point_for_a_comma_is_a_warning_in_a_run(word: str) -> None:
    text = f"V.G.KIN_STEP[1].ID[98].PARAM[3] = 800000\n#{word}[{{}}]"
    (warning,) = [c.alarm for c in run5(text.format("9.98")) if isinstance(c, Warn)]
    assert (warning.id, warning.values["remark"]) == (900484, f"#{word}[9.98] read as [9,98]")
    assert not [c for c in run5(text.format("9, 98")) if isinstance(c, Warn)]


@pytest.mark.parametrize(
    ("number", "message"),
    [
        ("18446744073709551616", "no kinematic has such an ID"),
        ("99999999999999999999.5", "no kinematic has such an ID"),
        ("1e20", "takes a number or an expression"),
    ],
)
@pytest.mark.parametrize("word", ["KIN ID", "TRAFO", "TRAFO ON"])
def test_a_number_of_many_digits_names_no_kinematic(word: str, number: str, message: str) -> None:
    """Python writes it with an exponent, which is no fraction."""
    with pytest.raises(UserError, match=message):
        run5(f"#{word}[{number}]")


@pytest.mark.parametrize(
    ("program", "alarm_id"),
    [
        ("#SET AX LINK[1, C=X]\n#ENABLE AX LINK[1]\n#TRAFO [9]", 900196),
        (ON + "#SET AX LINK[1, C=X]\n#ENABLE AX LINK[1]", 900482),
        ("#PUT AX [A]\n#TRAFO [9]", 900195),
    ],
)
def test_an_axis_of_the_kinematic_neither_follows_another_nor_is_away(
    program: str, alarm_id: int
) -> None:
    """A slave goes where its master leads it, so that no path of the tool would hold."""
    with pytest.raises(Alarm) as alarm:
        run5(program)
    assert alarm.value.id == alarm_id


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
    text = f"V.G.WZ_AKT.L = 80\n{blocks}\n#TRAFO [9]"
    axes = (*FIVE, "U", "V")
    if refused is None:
        (choice,) = [
            each
            for each in run_text(text, axes=axes, tables=TABLES)
            if isinstance(each, KinematicChoice)
        ]
        assert choice.axes == FIVE
        return
    with pytest.raises(Alarm) as caught:
        run_text(text, axes=axes, tables=TABLES)
    assert (caught.value.id, caught.value.values) == refused


@pytest.mark.parametrize(
    ("written", "named"),
    [
        ({"X": 0.0}, None), ({"X": 0.0, "A": 0.0}, None), ({"X": 3.0}, "X"), ({"A": -1.0}, "A"),
        ({"X": 0.0, "Y": 2.0, "C": 1.0}, "Y C"),
    ],
)  # fmt: skip
def test_offsets_of_0_are_none_and_the_others_are_all_named(
    written: dict[str, float], named: str | None
) -> None:
    text = "".join(f"V.G.WZ_AKT.V.{axis} = {value}\n" for axis, value in written.items())
    if named is None:
        assert any(isinstance(c, KinematicChoice) for c in run5(f"{text}{ON}"))
        return
    with pytest.raises(Alarm) as caught:
        run5(f"{text}{ON}")
    assert (caught.value.id, caught.value.values) == (900480, {"axes": named})
