"""Inches, relative blocks and shifts together, where a mistake shows in one combination only."""

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import ArcMove, LinearMove, Message
from axisrig.kernel.nc.coordinates import OffsetTables, Tool, Tools, ZeroOffsets

XYZ = ("X", "Y", "Z")


def messages_of(commands):
    """The numbers of all messages."""
    return [number for c in commands if isinstance(c, Message) for number in c.values]


def arc_of(commands):
    (arc,) = [command for command in commands if isinstance(command, ArcMove)]
    return arc


def target_of(commands):
    position = dict.fromkeys(XYZ, 0.0)
    for command in commands:
        if isinstance(command, LinearMove | ArcMove):
            position.update(command.target_mm)
    return tuple(position[axis] for axis in XYZ)


def with_tool(**data):
    return OffsetTables(tools=Tools({1: Tool(valid=True, **data)}))


def test_a_radius_in_inches(run):
    """Half a circle over 2 inches: the centre lies 25.4 mm from the start."""
    arc = arc_of(run("G70 G2 X2 R1 F10"))
    assert arc.centre_mm == pytest.approx({"X": 25.4, "Y": 0}, abs=1e-9)


def test_the_last_arc_is_read_in_inches(run):
    commands = run('G70 G3 X2 I1 F10\n#MSG ["%f %f", V.G.I, V.G.R]')
    assert messages_of(commands) == pytest.approx([1, 1])


def test_angles_of_a_system_are_degrees_under_g70(run):
    """X of a system that is turned by 90 degrees about Z is Y of the axes."""
    commands = run("G70\n#CS ON[0,0,0,0,0,90]\nG0 X1 Y0")
    assert target_of(commands) == pytest.approx((0, 25.4, 0), abs=1e-9)


def test_where_a_system_lies_and_zero_offsets_are_read_in_inches(run):
    table = OffsetTables(zero_offsets=ZeroOffsets({(1, 2): 254.0}))
    commands = run(
        '#CS ON[50.8,0,0]\nG70\n#MSG ["%f %f", V.G.SELECTED_CS.TRANS.X, V.G.NP[1].V.Z]',
        tables=table,
    )
    assert messages_of(commands) == pytest.approx([2, 10])


OF_AXES = ("V.G.NP[1].V", "V.G.NP_AKT.V", "V.G.WZ_AKT.V", "V.G.WZ[3].V")
OF_TOOLS = ("V.G.WZ_AKT.L", "V.G.WZ_AKT.R", "V.G.WZ[3].L", "V.G.WZ[3].R")


@pytest.mark.parametrize(
    "name", [*OF_TOOLS, *(f"{name}{axis}" for name in OF_AXES for axis in (".X", "[0]"))]
)
@pytest.mark.parametrize("rotary", ["", "X"])
def test_each_length_that_a_program_writes_is_written_and_read_in_its_unit(run, name, rotary):
    """2 inch are 50.8 mm; degrees of a rotary axis stay."""
    tables = OffsetTables(rotary=frozenset(rotary))
    text = f"G70\n{name}=2\nP1={name}\nG71\nP2={name}\n{name}=25.4\nG70\n"
    commands = run(text + f'#MSG ["%f %f %f", P1, P2, {name}]', tables=tables)
    turns = rotary and name not in OF_TOOLS
    assert messages_of(commands) == pytest.approx([2, 2, 25.4] if turns else [2, 50.8, 1])


def test_the_programmed_position_goes_along_with_a_distance(run):
    """G92 7, X 10, 5 further on: PROG 15, ABS 22."""
    commands = run('G92 X7\nG0 X10\nG91 X5\n#MSG ["%f %f", V.A.PROG.X, V.A.ABS.X]')
    assert messages_of(commands) == [15, 22]


def test_an_absolute_centre_is_shifted_by_the_tool_as_coordinates_are(run):
    """ACS = PCS - axis offset: half a circle from 10 to -10 about 0 has its centre at -3."""
    commands = run("D1 G0 X10 Y0\nG161 G3 X-10 I0 J0 F100", tables=with_tool(offsets_mm={0: 3.0}))
    assert arc_of(commands).centre_mm == pytest.approx({"X": -3, "Y": 0}, abs=1e-9)


def test_the_actual_position_is_without_the_tool(run):
    commands = run('D1 G0 Z10\n#MSG SYN ["%f", V.A.ACT_POS.Z]', tables=with_tool(length_mm=50.0))
    assert messages_of(commands) == pytest.approx([10])


@pytest.mark.parametrize("name", ["V.G.WZ_AKT", "V.G.WZ[1]"])
def test_length_and_radius_of_a_tool_are_in_the_unit_of_the_block(run, name):
    """2 inch and 0.125 inch, read in inches, in mm, and after a program has written inches."""
    commands = run(
        f'D1\nG70\n#MSG ["%f %f", {name}.L, {name}.R]\nG71\n#MSG ["%f %f", {name}.L, {name}.R]\n'
        f'G70\n{name}.L = 1\n{name}.R = 0.5\nG71\n#MSG ["%f %f", {name}.L, {name}.R]',
        tables=with_tool(length_mm=50.8, radius_mm=3.175),
    )
    assert messages_of(commands) == pytest.approx([2.0, 0.125, 50.8, 3.175, 25.4, 12.7])


def test_what_a_program_writes_into_the_tool_in_use_ends_with_it(run):
    """V.G.WZ_AKT is what is in use; D takes the data of the list in again."""
    commands = run(
        'D1\nV.G.WZ_AKT.L = 99\nD0\nD1\n#MSG ["%f", V.G.WZ_AKT.L]', tables=with_tool(length_mm=50.0)
    )
    assert messages_of(commands) == [50]


def test_a_measurement_offset_is_in_the_origin_of_the_next_system(run, plane_machine):
    """Contact at 100, target 20: G101 shifts by 80, and the system lies there."""
    machine = plane_machine({"X": 0.0, "Y": 0.0, "Z": 200.0}, ("Z", 100.0))
    commands = run("G100 Z20 F100\nG101 Z1\n#CS ON[0,0,5]\nG0 X0 Y0 Z1", machine)
    assert target_of(commands)[2] == pytest.approx(86)


def test_an_axis_that_is_named_and_stands_does_not_keep_g310_from_jumping(run, plane_machine):
    machine = plane_machine({"X": 0.0, "Y": 0.0, "Z": 200.0}, ("Z", 100.0))
    commands = run(
        '#MEAS MODE[5]\nG310 X0 Z20 F100 $GOTO[L]\n#MSG ["%d", 1]\n[L] #MSG ["%d", 2]', machine
    )
    assert messages_of(commands) == [2]


@pytest.mark.parametrize("program", ["G100 X10 I5 F100", "G100 G2 X10 I5 F100", "G92 X1 J3"])
def test_a_centre_in_a_block_that_makes_no_arc(run, program):
    """Never left out in silence: G100 is straight, whatever G2 says of the blocks behind it."""
    with pytest.raises(Alarm) as alarm:
        run(program)
    assert alarm.value.id == 900153
    assert program.split()[0] in str(alarm.value)


@pytest.mark.parametrize(
    ("block", "word", "where"),
    [
        ("G0 X1 I5", "I", "with G0"), ("G1 X1 J5 F100", "J", "with G1"),
        ("X1 K5 F100", "K", "with G1"),
        ("G100 X1 I5 J6 F100", "I", "with G100"), ("G92 X1 J3", "J", "with G92"),
        ("G18 G2 X1 J5 F100", "J", "in plane G18"), ("G19 G3 Y1 I5 F100", "I", "in plane G19"),
        ("G17 G2 X1 I1 K5 F100", "K", "in plane G17"),
    ],
)  # fmt: skip
def test_900153_names_the_letter_and_what_it_does_not_go_with(run, block, word, where):
    with pytest.raises(Alarm) as alarm:
        run(block)
    assert (alarm.value.id, alarm.value.values) == (900153, {"word": word, "where": where})
