"""Programs with coordinate systems, zero offsets, tools, inches and arcs, from their text."""

import math

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import ArcMove, LinearMove, Message
from axisrig.kernel.nc.coordinates import OffsetTables, Tool, Tools, ZeroOffsets

XYZ = ("X", "Y", "Z")


def last_target(commands):
    """Where the axes stand in the end, from 0."""
    position = dict.fromkeys(XYZ, 0.0)
    for command in commands:
        if isinstance(command, LinearMove | ArcMove):
            position.update(command.target_mm)
    return tuple(position[axis] for axis in XYZ)


def messages_of(commands):
    """The numbers of all messages."""
    return [number for c in commands if isinstance(c, Message) for number in c.values]


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("#CS ON[10,20,30]", (11, 22, 33)),
        ("#CS ON[,,30]", (1, 2, 33)),
        ("#CS ON[10,20,30,0,0,90]", (8, 21, 33)),
        ("#CS DEF[2][10,20,30]\n#CS ON[2]", (11, 22, 33)),
        ("#CS DEF[2][1,1,1]\n#CS DEF[2][10,20,30]\n#CS ON", (11, 22, 33)),
        ("#CS ON[3][10,20,30]\n#CS OFF\n#CS ON[3]", (11, 22, 33)),
        ("#CS ON [ICS][10,20,30]\n#CS OFF\n#CS ON[ICS]", (11, 22, 33)),
        ("#CS ON[10,0]\n#CS ON[1,1,1]", (12, 3, 4)),
        ("#CS ON[10,0]\n#CS ON[1,1,1]\n#CS OFF", (11, 2, 3)),
        ("#CS ON[10,0]\n#CS ON[1,1,1]\n#CS OFF ALL", (1, 2, 3)),
        ("G70\n#CS ON[1,0,0]\nG71", (26.4, 2, 3)),
    ],
)
def test_stored_and_nested_systems(run, program, expected):
    assert last_target(run(f"{program}\nG0 X1 Y2 Z3")) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("#CS DEF[10,20,30]\n#CS ON[1]", (11, 22, 33)),
        ("#CS DEF[1][1,1,1]\n#CS DEF[3][2,2,2]\n#CS DEF[10,20,30]\n#CS ON[2]", (11, 22, 33)),
        ("#CS DEF[2][1,1,1]\n#CS DEF[10,20,30]\n#CS ON", (11, 22, 33)),
    ],
)
def test_a_system_without_an_id_gets_the_next_one_that_is_free(run, program, expected):
    assert last_target(run(f"{program}\nG0 X1 Y2 Z3")) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("first", ["#CS DEF[1,1,1]", "#CS DEF[1][1,1,1]", "#CS ON[1][1,1,1]"])
def test_a_stored_system_that_is_on_counts_once(run, first):
    """Five may be there; the first one is on, as it was defined last."""
    text = f"{first}\n#CS ON\n" + "\n".join(f"#CS DEF[{n}][1,2,3]" for n in range(2, 6))
    assert last_target(run(f"{text}\n#CS OFF ALL\n#CS ON[5]\nG0 X0 Y0 Z0")) == (1, 2, 3)
    with pytest.raises(Alarm, match="21234"):
        run(f"{text}\n#CS DEF[6][1,2,3]")


STACK = """\
#CS ADD [ICS] [10,10,0,0,0,90]
#CS ADD [WCS] [15,20,0,0,0,0]
#CS ADD [PCS] [1,2,3,0,0,0]
"""


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("", (0, 0, 0)),
        ("#CS SELECT [ICS]", (10, 10, 0)),
        ("#CS SELECT [WCS]", (-10, 25, 0)),
        ("#CS SELECT [PCS]", (-12, 26, 3)),
        ("#CS SELECT [PCS]\n#CS SELECT [ICS]", (10, 10, 0)),
        ("#CS SELECT [PCS]\n#CS OFF", (-10, 25, 0)),
        ("#CS SELECT [WCS]\n#CS SET [ICS] [100,0,0]", (115, 20, 0)),
        ("#CS SET [ICS] [100,0,0]\n#CS SELECT [WCS]", (115, 20, 0)),
        ("#CS ON [7,7,7]\n#CS SELECT [WCS]\n#CS SET [ICS] [100,0,0]", (115, 20, 0)),
        ("#CS SELECT [PCS]\n#CS SELECT [ICS]\n#CS SET [WCS] [1,1,1]", (10, 10, 0)),
        ("#CS SELECT [WCS]\n#CS OFF\n#CS SET [WCS] [1,1,1]", (10, 10, 0)),
        ("#CS SELECT [ICS]\n#CS OFF ALL\n#CS ON [7,7,7]\n#CS SET [ICS] [1,1,1]", (7, 7, 7)),
    ],
)
def test_linked_systems_of_the_manual(run, program, expected):
    """TF5200 programming manual 1037259147; the turn of the lowest one is 90 degrees here."""
    commands = run(f"{STACK}{program}\nG0 X0 Y0 Z0")
    assert last_target(commands) == pytest.approx(expected, abs=1e-9)


LEVELS = "#CS ADD[A][10,0,0]\n#CS ADD[B][0,20,0]\n#CS ADD[C][0,0,30,0,0,90]\n"


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("#CS SELECT[C]", (10, 20, 30)),
        ("#CS SELECT[C]\n#CS SET[A][1,0,0]", (1, 20, 30)),
        ("#CS SELECT[C]\n#CS SET[B][0,2,0]", (10, 2, 30)),
        ("#CS SELECT[C]\n#CS SET[C][0,0,3]", (10, 20, 3)),
        ("#CS SELECT[C]\n#CS SET[B][0,2,0]\n#CS SET[A][1,0,0]\n#CS SET[C][0,0,3]", (1, 2, 3)),
        ("#CS SELECT[C]\n#CS SET[B][5,2,0]\n#CS OFF", (15, 2, 0)),
        ("#CS SELECT[B]\n#CS ON[0,0,7]\n#CS SET[B][0,2,0]", (10, 2, 7)),
        ("#CS SELECT[B]\n#CS SET[C][1,1,1]\n#CS SELECT[C]", (11, 21, 1)),
        ("#CS SELECT[C]\n#CS SET[B][0,2,0,0,0,90]", (10, 2, 30)),
        ("#CS SELECT[C]\n#CS SET[A][1,0,0,0,0,90]", (1 - 20, 0, 30)),
    ],
)
def test_each_linked_system_gets_another_place_while_it_is_on(run, program, expected):
    """That one alone: those below it stay, those above it go with it."""
    assert last_target(run(f"{LEVELS}{program}\nG0 X0 Y0 Z0")) == pytest.approx(expected, abs=1e-9)


def test_where_the_active_system_lies(run):
    names = ", ".join(f"V.G.SELECTED_CS.TRANS.{axis}" for axis in XYZ)
    commands = run(f'{STACK}#CS SELECT [WCS]\n#MSG ["%f %f %f", {names}]')
    assert messages_of(commands) == pytest.approx([-10, 25, 0], abs=1e-9)


@pytest.mark.provokes(20820, 2, value="1.5")
@pytest.mark.provokes(20821, 2, word="#CS ON[4]")
@pytest.mark.provokes(21234, 2, word="#CS", value=6, upper=5)
@pytest.mark.provokes(21599, 2, name="MCS")
@pytest.mark.provokes(21601, 2, name="XCS", known="ICS WCS PCS")
@pytest.mark.parametrize(
    ("alarm_id", "program"),
    [
        (20820, "#CS ON[1.5]"),
        (20821, "#CS DEF[2][1,2,3]\n#CS ON[4]"),
        (21234, "\n".join(f"#CS DEF[{n}][1,2,3]" for n in range(1, 7))),
        (21599, "#CS ADD [MCS] [1,2,3]"),
        (21601, f"{STACK}#CS SELECT [XCS]"),
    ],
)
def test_what_is_no_system(run, alarm_id, program):
    with pytest.raises(Alarm) as alarm:
        run(program)
    assert alarm.value.id == alarm_id


@pytest.mark.parametrize(
    ("program", "alarm_id"),
    [
        ("#CS ON", 20821),
        ("#CS ON[0]", 20820),
        ("#CS DEF[-1][1,2,3]", 20820),
        ("\n".join(["#CS ON[1,2,3]"] * 6), 21234),
        (f"{STACK}#CS ADD [WCS] [1,2,3]", 21599),
        ("#CS ADD [FARTOOLONG] [1,2,3]", 21599),
        ("\n".join(f"#CS ADD [A{n}] [1,2,3]" for n in range(6)), 21234),
        ("#CS SET [WCS] [1,2,3]", 21601),
        ("#CS OFF", 900108),
    ],
)
def test_further_ways_to_get_there(run, program, alarm_id):
    with pytest.raises(Alarm) as alarm:
        run(program)
    assert alarm.value.id == alarm_id


@pytest.mark.parametrize(
    ("program", "words"),
    [
        (f"{STACK}#CS SELECT [MCS]", "system of a kinematic"),
        ("#CS MODE ON [AXES_OFFSETS_LAYER_SPECIFIC]", "#CS MODE ON"),
    ],
)
def test_what_belongs_to_kinematics_ends_when_the_machine_gets_there(run, program, words):
    with pytest.raises(Alarm, match=words) as alarm:
        run(f"{program}\nG0 X1")
    assert alarm.value.id == 900100


def test_parameters_of_a_kinematic_are_kept(run):
    commands = run(
        "V.G.KIN_STEP[1].ID[98].PARAM[0] = 1000000\n#KIN ID[9.98]\n#TRAFO OFF\n"
        '#MSG ["%f", V.G.KIN_STEP[1].ID[98].PARAM[0]]'
    )
    assert messages_of(commands) == [1_000_000]


def test_the_tool_of_the_seeds(run):
    """FCT-M3 12.4: V.G.WZ_AKT.L = 80 without any D."""
    commands = run('V.G.WZ_AKT.L = 80\nG0 Z10\n#MSG ["%f %f", V.G.WZ_AKT.L, V.A.ABS.Z]')
    assert last_target(commands) == (0, 0, 90)
    assert messages_of(commands) == [80, 90]


TOOL_DATA = ("T_AKT", "D_AKT", "WZ_AKT.L", "WZ_AKT.R", "WZ_AKT.V.X", "WZ[7].V[0]")


def test_tool_numbers_and_data(run):
    tools = Tools({7: Tool(length_mm=50.0, radius_mm=2.0, offsets_mm={0: 3.0}, valid=True)})
    names = [f"V.G.{name}" for name in TOOL_DATA]
    asked = f'#MSG ["{"%f " * 6}", {", ".join(names)}]'
    commands = run(f"T5 D7\n{asked}\nG70\n{asked}\nD0\n{asked}", tables=OffsetTables(tools=tools))
    in_mm = [50.0, 2.0, 3.0, 3.0]
    assert messages_of(commands) == pytest.approx(
        [*(5, 7), *in_mm, *(5, 7), *(mm / 25.4 for mm in in_mm), *(5, 0), 0, 0, 0, 3 / 25.4]
    )


def test_what_a_program_writes_of_the_tool_in_use_is_not_in_the_table(run):
    """And the other way round; D takes the data of the table again, those of another one too."""
    tools = Tools(
        {
            7: Tool(length_mm=50.0, radius_mm=2.0, offsets_mm={0: 3.0}, valid=True),
            8: Tool(length_mm=8.0, offsets_mm={0: 1.0}, valid=True),
        }
    )
    names = [f"V.G.{name}" for name in TOOL_DATA[2:]]
    asked = f'#MSG ["{"%f " * 4}", {", ".join(names)}]'
    in_use, in_table = "V.G.WZ_AKT.L=80\nV.G.WZ_AKT.V.X=5", "V.G.WZ[7].L=60\nV.G.WZ[7].V[0]=6"
    text = f"D7\n{in_use}\n{asked}\nD8\nD7\n{asked}\n{in_table}\n{asked}\nD7\n{asked}\nD8\n{asked}"
    given = OffsetTables(tools=tools)
    for _ in range(2):  # a second program has the data of the rig
        assert messages_of(run(text, tables=given)) == [
            *(80, 2, 5, 3),
            *(50, 2, 3, 3),
            *(50, 2, 3, 6),
            *(60, 2, 6, 6),
            *(8, 0, 1, 6),
        ]


def test_zero_offset_of_the_manual(run):
    """TF5200 programming manual 206487307: V.G.NP[1].V.X=10, G54, X=100."""
    commands = run("V.G.NP[1].V.X=10\nG54\nG0 X=100")
    assert last_target(commands) == (110, 0, 0)


def test_variables_of_zero_offsets(run):
    table = ZeroOffsets({(1, 0): 10.0, (1, 2): 30.0})
    commands = run(
        "G54\nV.G.NP_AKT.V.Z = V.G.NP_AKT.V.Z + 5\nG92 X7\n"
        '#MSG ["%f %f %f %f %f", V.G.NP_AKT.V.X, V.G.NP_AKT.V[2], V.G.NP[1].V.Z, V.A.BZP.X,'
        " V.G.NP_DEFAULT]",
        tables=OffsetTables(zero_offsets=table),
    )
    assert messages_of(commands) == [10, 35, 30, 7, 0]


def test_inches_in_and_out(run):
    """Under G70 variables of lengths are inches, factors and degrees are not lengths."""
    commands = run(
        "G70 G1 X1 F10\nG92 X1\nX1\n"
        '#MSG ["%f %f %f %f", V.A.PROG.X, V.A.ABS.X, V.A.BZP.X, V.G.MASS_MM]\n'
        'G71\n#MSG ["%f %f", V.A.ABS.X, V.G.MASS_MM]'
    )
    assert messages_of(commands) == pytest.approx([1, 2, 1, 1, 50.8, 0])


@pytest.mark.parametrize(
    "program", ["G2 X100 R50 F1", "G2 R=50 F1\nX100", "R1=50\nG2 X100 F1", "G2 X100 I=50 F1"]
)
def test_spellings_of_half_a_circle(run, program):
    (arc,) = [command for command in run(program) if isinstance(command, ArcMove)]
    assert arc.centre_mm == {"X": 50, "Y": 0}


def test_the_last_arc_in_variables(run):
    commands = run('G18 G2 Z20 K10.001 F100\n#MSG ["%f %f %f", V.G.K, V.G.I, V.G.R]')
    assert messages_of(commands) == pytest.approx([10, 0, 10], abs=1e-9)


def test_an_arc_under_a_tilted_system(run):
    """Half a circle in the plane that B 90 puts into Y, Z of the axes: X of it is -Z."""
    commands = run("#CS ON[0,0,0,0,90,0]\nG0 X0 Y0 Z0\nG2 X20 I10 F100")
    (arc,) = [command for command in commands if isinstance(command, ArcMove)]
    assert arc.target_mm == pytest.approx({"X": 0, "Y": 0, "Z": -20}, abs=1e-12)
    assert arc.centre_mm == pytest.approx({"X": 0, "Y": 0, "Z": -10}, abs=1e-12)
    assert arc.tangent == pytest.approx({"X": 0, "Y": 1, "Z": 0}, abs=1e-12)
    assert arc.angle_rad == pytest.approx(math.pi)


def test_a_helix_under_a_tilted_system_has_its_centre_at_the_height_of_its_begin(run):
    """B 90: X of the system is -Z, its Z is X. The radius from there is that of the circle, 10."""
    commands = run("#CS ON[0,0,0,0,90,0]\nG0 X0 Y0 Z5\nG2 X20 I10 Z13 F100")
    (arc,) = [command for command in commands if isinstance(command, ArcMove)]
    assert arc.target_mm == pytest.approx({"X": 13, "Y": 0, "Z": -20}, abs=1e-12)
    assert arc.centre_mm == pytest.approx({"X": 5, "Y": 0, "Z": -10}, abs=1e-12)
    assert arc.tangent == pytest.approx({"X": 0, "Y": 1, "Z": 0}, abs=1e-12)


@pytest.mark.provokes(900156, 2, axis="X", limit_mm=214748.3647)
@pytest.mark.parametrize(
    "program",
    [
        "G0 X214749",
        "G70 G0 X=10**308",
        "G92 X=10**300\nG0 X0",
        "#CS ON[10**308,0,0,0,0,10**300]\nG0 X1",
        "V.G.WZ_AKT.V.X = -[10**200]\nG0 X0",
    ],
)
def test_a_position_that_no_axis_can_have(run, program):
    with pytest.raises(Alarm) as alarm:
        run(program)
    assert alarm.value.id == 900156


@pytest.mark.parametrize("name", ["V.G.NP[97].V.X", "V.G.NP[1].V[3]", "V.G.WZ[201].L"])
def test_an_index_that_is_too_large(run, name):
    with pytest.raises(Alarm) as alarm:
        run(f'#MSG ["%f", {name}]')
    assert alarm.value.id == 20403


def test_the_ball_of_the_manual(run, plane_machine):
    """FCT-C4 section 5, %meas_example: D1 has a ball of 2 mm; its centre is at 102 in contact."""
    program = (
        "D1\nG0 X150 Z200\nG100 Z20 F100\n"
        '#MSG ["%f %f %f %f", V.A.MEAS.PCS.VALUE.Z, V.A.MESS.Z, V.A.MOFFS.Z, V.A.MEAS.ACS.VALUE.Z]'
    )
    tools = Tools({1: Tool(radius_mm=2.0, valid=True)})
    for counts, expected in ((True, 100.0), (False, 102.0)):
        machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("Z", 102.0))
        tables = OffsetTables(tools=tools, ball_radius_counts=counts)
        assert messages_of(run(program, machine, tables=tables)) == [expected, 102.0, 82.0, 102.0]


def test_a_probe_with_length_measures_the_workpiece(run, plane_machine):
    """MOFFS = MESS - PROG - zero shifts - tool: 155 - 20 - 3 - 50."""
    program = (
        "G54 D1\nG0 Z200\nG100 Z20 F100\n"
        '#MSG ["%f %f %f", V.A.MEAS.PCS.VALUE.Z, V.A.MESS.Z, V.A.MOFFS.Z]\n'
        'G101 Z1\nG0 Z20\n#MSG ["%f", V.A.ABS.Z]'
    )
    tables = OffsetTables(
        zero_offsets=ZeroOffsets({(1, 2): 3.0}),
        tools=Tools({1: Tool(length_mm=50.0, radius_mm=2.0, valid=True)}),
    )
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), ("Z", 155.0))
    assert messages_of(run(program, machine, tables=tables)) == [100.0, 155.0, 82.0, 155.0]


@pytest.mark.parametrize(("unit", "mm"), [("G71", 1.0), ("G70", 25.4)])
@pytest.mark.parametrize(
    ("angles", "expected"),
    [
        # lower = R upper for (0, 1, 0): Rx(90), Ry(90), Rz(90)
        ("90,0,0", (1.0, 2.0, 4.0)), ("0,90,0", (1.0, 3.0, 3.0)),
        ("0,0,90", (0.0, 2.0, 3.0)),
    ],
)  # fmt: skip
def test_shifts_of_a_system_are_lengths_and_its_angles_are_none(run, unit, mm, angles, expected):
    commands = run(f"{unit} G0\n#CS ON[1,2,3,{angles}]\nX0 Y1 Z0")
    assert last_target(commands) == pytest.approx([at * mm for at in expected], abs=1e-9)


@pytest.mark.parametrize(
    ("name", "is_right"),
    [
        ("A", True), ("ABCDEFG", True), ("ABCDEFGH", True), ("ABCDEFGHI", False), ("7", True),
        ("ACS", False), ("MCS", False), ("IMCS", False), ("acs", False), ("ACS1", True),
    ],
)  # fmt: skip
def test_the_name_of_a_linked_system_has_eight_signs_and_is_not_reserved(run, name, is_right):
    """TF5200 programming manual 1037259147. It is on by its name then."""
    text = f"#CS ADD [{name}] [5,0,0]\n"
    if is_right:
        assert last_target(run(f"{text}#CS SELECT [{name}]\nG0 X1")) == (6.0, 0.0, 0.0)
        return
    with pytest.raises(Alarm) as caught:
        run(text)
    assert (caught.value.id, caught.value.values) == (21599, {"name": name.upper()})


@pytest.mark.parametrize("systems", [0, 1, 2])
def test_the_offset_of_a_tool_on_an_axis_beside_the_systems_counts_once(run, systems):
    """Zero offset 10 is carried into each system; the tool, 3 against the axis, is on top."""
    on = "#CS ON[1,0,0,0,0,30]\n" * systems
    text = f"V.G.NP[1].V.A = 10\nV.G.WZ_AKT.V.A = 3\nG54\n{on}G0 A1"
    (move,) = [c for c in run(text, axes=(*XYZ, "A")) if isinstance(c, LinearMove)]
    assert move.target_mm == {"A": 1.0 + 10.0 - 3.0}
