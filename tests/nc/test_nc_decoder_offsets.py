"""Zero offsets, tools, planes, units and arcs as the decoder hands them to the channel."""

import math

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import ArcMove, LinearMove
from axisrig.kernel.nc.coordinates import OffsetTables, Tool, Tools, ZeroOffsets
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.syntax import Assign, Number, Program, ProgramBlock, Variable, Words

XYZ = ("X", "Y", "Z")


def words(g="", **values):
    """A block: G functions in one text, axis words and addresses by letter."""
    numbers = {letter: Number(float(value)) for letter, value in values.items()}
    return Words(
        g=tuple(g.split()),
        axes=tuple((a, v) for a, v in numbers.items() if a in (*XYZ, "A")),
        addresses=tuple((a, v) for a, v in numbers.items() if a not in (*XYZ, "A")),
    )


@pytest.fixture
def decode(plane_machine):
    def run(*blocks, axes=XYZ, tables=None):
        program = Program(
            "",
            "test.nc",
            axes,
            tuple(
                ProgramBlock(Block(line, None, ""), block) for line, block in enumerate(blocks, 1)
            ),
            (),
        )
        machine = plane_machine(dict.fromkeys(axes, 0.0), None)
        commands = Interpreter(program, axes, machine, external={}, tables=tables).commands()
        return [c for c in commands if isinstance(c, LinearMove | ArcMove)]

    return run


def test_zero_offsets_of_the_rig_act_in_their_block_already(decode):
    """G54 to G59 are groups 1 to 6 of the table, G53 takes them off."""
    table = ZeroOffsets({(1, 0): 10.0, (6, 0): 60.0, (0, 0): 999.0})
    moves = decode(
        words("G0 G54", X=1),
        words("G59", X=1),
        words("G53", X=1),
        tables=OffsetTables(zero_offsets=table),
    )
    assert [dict(move.target_mm) for move in moves] == [{"X": 11.0}, {"X": 61.0}, {"X": 1.0}]


def test_g159_takes_any_group_of_the_table_and_is_modal(decode):
    """TF5200 zero offsets 103721099: G159 = 0 is G53, 6 is G59, then up to 96."""
    table = ZeroOffsets({(1, 0): 10.0, (96, 0): 960.0})
    moves = decode(
        words("G0 G159", G159=96, X=1),
        words("", X=2),
        words("G159", G159=1, X=1),
        words("G159", G159=0, X=1),
        tables=OffsetTables(zero_offsets=table),
    )
    assert [move.target_mm["X"] for move in moves] == [961.0, 962.0, 11.0, 1.0]


@pytest.mark.parametrize(("group", "alarm_id"), [(97, 20403), (-1, 20403), (1.5, 900105)])
def test_g159_of_a_group_that_no_table_has(decode, group, alarm_id):
    with pytest.raises(Alarm) as caught:
        decode(words("G0 G159", G159=group, X=1))
    assert caught.value.id == alarm_id


def test_the_group_of_the_program_start_and_the_values_of_g53(decode):
    """P-ZERO-00002 and P-ZERO-00001; an axis that is inactive in a group has none."""
    table = ZeroOffsets({(2, 0): 20.0, (2, 1): 20.0, (0, 0): 1.0}, {(2, 1)}, True, 2)
    moves = decode(
        words("G0", X=0, Y=5), words("G53", X=0), tables=OffsetTables(zero_offsets=table)
    )
    assert [dict(move.target_mm) for move in moves] == [{"X": 20.0, "Y": 5.0}, {"X": 1.0}]


def test_d_takes_a_tool_in_and_d0_takes_it_off(decode):
    tools = Tools({7: Tool(length_mm=50.0, offsets_mm={0: 3.0}, valid=True)})
    moves = decode(
        words("G0", D=7, X=0, Z=5),
        words("G18", Y=0, Z=5),
        words("G17", D=0, X=0, Y=0, Z=5),
        tables=OffsetTables(tools=tools),
    )
    assert [dict(move.target_mm) for move in moves] == [
        {"X": -3.0, "Z": 55.0},
        {"Y": 50.0, "Z": 5.0},
        {"X": 0.0, "Y": 0.0},
    ]


def test_inches_are_input_and_not_degrees(decode):
    moves = decode(
        words("G70 G1", X=1, A=90, F=10),
        words("G92", Y=1),
        words("", Y=0),
        words("G71", X=2),
        axes=(*XYZ, "A"),
        tables=OffsetTables(rotary=frozenset("A")),
    )
    assert [dict(m.target_mm) for m in moves] == [{"X": 25.4, "A": 90.0}, {"Y": 25.4}, {"X": 2}]
    assert [move.feed_mm_min for move in moves] == [254.0, 254.0, 254.0]


def test_an_arc_by_its_centre(decode):
    (arc,) = decode(words("G2", X=20, I=10, F=600))
    assert isinstance(arc, ArcMove)
    assert arc.target_mm == {"X": 20.0, "Y": 0.0}
    assert arc.centre_mm == {"X": 10.0, "Y": 0.0}
    assert arc.tangent == pytest.approx({"X": 0.0, "Y": 1.0})
    assert arc.angle_rad == pytest.approx(math.pi)
    assert arc.feed_mm_min == 600.0


def test_the_half_circles_of_the_manual(decode):
    """TF5200 programming manual, radius programming: R stays, R alone does not move."""
    arcs = decode(
        words("G90 G1", X=0, Y=0, F=500),
        words("G2", R=50),
        words("", X=100),
        words("G3", X=200),
    )
    assert [arc.centre_mm["X"] for arc in arcs] == [50.0, 150.0]
    assert [math.degrees(arc.angle_rad) for arc in arcs] == pytest.approx([180.0, 180.0])
    assert [arc.tangent["Y"] for arc in arcs] == pytest.approx([1.0, -1.0])


def test_the_helix_of_the_manual(decode):
    """TF5200 programming manual 206109707: a turn about the zero point from X-10 up to Z20."""
    _, helix = decode(words("G17 G90 G1 G161", X=-10, Y=0, Z=0, F=500), words("G3", I=0, J=0, Z=20))
    assert helix.centre_mm == {"X": 0.0, "Y": 0.0}
    assert helix.target_mm == {"X": -10.0, "Y": 0.0, "Z": 20.0}
    assert helix.angle_rad == pytest.approx(math.tau)


def test_an_arc_in_inches_in_another_plane(decode):
    (arc,) = decode(words("G70 G18 G3", Z=2, K=1, F=1))
    assert arc.target_mm == {"X": 0.0, "Z": 50.8}
    assert arc.centre_mm == {"X": 0.0, "Z": 25.4}
    assert arc.tangent == pytest.approx({"X": -1.0, "Z": 0.0})


@pytest.mark.provokes(20034, 2)
@pytest.mark.provokes(20036, 2)
@pytest.mark.provokes(20020, 2, word="I", value_mm="1e+06")
@pytest.mark.provokes(20054, 2, value_mm="-2e+09", limit_mm="1e+09")
@pytest.mark.provokes(21024, 2)
@pytest.mark.provokes(21758, 2, difference_mm="0.1000", limit_mm="0.0050")
@pytest.mark.provokes(900150, 2, offset_mm="1.0000", limit_mm="0.2500")
@pytest.mark.provokes(900151, 2, radius_mm="4.0000", distance_mm="10.0000")
@pytest.mark.provokes(900152, 2, plane="G19", axes="X Y")
@pytest.mark.provokes(900153, 2, word="K", where="in plane G17")
@pytest.mark.provokes(900154, 2, word="D7")
@pytest.mark.provokes(900155, 2, value="1.5", last=200)
@pytest.mark.parametrize(
    ("alarm_id", "axes", "block"),
    [
        (20034, XYZ, words("G2", X=0, R=5, F=1)),
        (20036, XYZ, words("G2", X=10, F=1)),
        (20020, XYZ, words("G2", X=10, I=1e6, F=1)),
        (20054, XYZ, words("G2", X=10, R=-2e9, F=1)),
        (21024, XYZ, words("G2", X=10, I=5, R=5, F=1)),
        (21758, XYZ, words("G2 G164", X=20.1, I=10, F=1)),
        (900150, XYZ, words("G2", X=10, I=6, F=1)),
        (900151, XYZ, words("G2", X=10, R=4, F=1)),
        (900152, ("X", "Y"), words("G2 G19", Y=10, J=5, F=1)),
        (900153, XYZ, words("G2", X=10, K=5, F=1)),
        (900154, XYZ, words("", D=7)),
        (900155, XYZ, words("", D=1.5)),
    ],
)
def test_what_makes_no_arc_and_no_tool(decode, alarm_id, axes, block):
    with pytest.raises(Alarm) as alarm:
        decode(block, axes=axes)
    assert alarm.value.id == alarm_id


def test_a_centre_without_an_arc_is_refused(decode):
    with pytest.raises(Alarm, match="I is no centre of an arc with G1"):
        decode(words("G1", X=1, I=5, F=1))


def test_an_arc_needs_a_feed(decode):
    with pytest.raises(Alarm) as alarm:
        decode(words("G2", X=10, I=5))
    assert alarm.value.id == 20008


def number(name, *indices):
    return Variable(name, tuple(Number(float(index)) for index in indices))


def assign(name, *indices, value):
    return Assign(number(name, *indices), Number(float(value)))


def test_tool_and_zero_offset_of_a_program(decode):
    """V.G.WZ_AKT acts at once, V.G.WZ and V.G.NP when they are selected again."""
    moves = decode(
        assign("V.G.WZ_AKT.L", value=80),
        words("G0", Z=1),
        assign("V.G.WZ[].L", 3, value=10),
        assign("V.G.WZ[].OK", 3, value=1),
        words("", Z=1.5),
        words("", D=3, Z=1),
        assign("V.G.NP[].V.X", 1, value=7),
        words("G54", X=0),
        assign("V.G.NP[].V[]", 1, 0, value=8),
        words("", X=1),
        words("G54", X=0),
        assign("V.G.NP_AKT.V.X", value=100),
        words("", X=0),
        words("G54", X=0),
    )
    found = [next(iter(move.target_mm.values())) for move in moves]
    # X1 after V.G.NP[1] = 8 is still 7 + 1, which is where G54 X0 stands then
    assert found == [81.0, 81.5, 11.0, 7.0, 8.0, 100.0, 8.0]


def test_the_data_of_a_tool_may_be_used_while_they_are_valid(decode):
    """V.G.WZ[].OK on, off and on again; off it is no tool for D."""
    data, zero = assign("V.G.WZ[].L", 3, value=10), words("G0", Z=0)
    on, off = (assign("V.G.WZ[].OK", 3, value=value) for value in (1, 0))
    take = words("", D=3, Z=0)
    assert decode(data, on, off, on, zero, take)[-1].target_mm == {"Z": 10.0}
    for blocks in ((data, take), (data, on, off, take)):
        with pytest.raises(Alarm) as caught:
            decode(zero, *blocks)
        assert (caught.value.id, caught.value.values) == (900154, {"word": "D3"})


@pytest.mark.parametrize(("g", "given"), [("G162", {"I": 10}), ("G161", {"I": 15, "J": 7})])
def test_g164_takes_no_wrong_centre_however_it_is_given(decode, g, given):
    """From X5 Y7 the centre is X15 Y7, and X25.1 is 0.1 mm beside the circle; G165 moves it."""
    start = words("G0", X=5, Y=7)
    with pytest.raises(Alarm) as caught:
        decode(start, words(f"G2 G164 {g}", X=25.1, F=1, **given))
    assert (caught.value.id, caught.value.values["difference_mm"]) == (21758, "0.1000")
    for correcting in ("G165", ""):
        arc = decode(start, words(f"G2 {correcting} {g}", X=25.1, F=1, **given))[-1]
        assert arc.centre_mm == pytest.approx({"X": 15.05, "Y": 7.0})


@pytest.mark.parametrize(
    ("block", "name", "upper"),
    [
        (words("G159", G159=97), "G159", 96),
        (assign("V.G.NP[].V.X", 97, value=1), "V.G.NP[]", 96),
        (assign("V.G.WZ[].L", 201, value=1), "V.G.WZ[]", 200),
        (assign("V.G.NP[].V[]", 1, 3, value=1), "V[]", 2),
    ],
)
def test_20403_names_what_has_the_index_and_the_last_one(decode, block, name, upper):
    with pytest.raises(Alarm) as caught:
        decode(block)
    assert caught.value.id == 20403
    assert (caught.value.values["name"], caught.value.values["upper"]) == (name, upper)
