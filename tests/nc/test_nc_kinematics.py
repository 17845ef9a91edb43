"""Programs in the coordinates of the tool: #KIN ID and #TRAFO, with the head of kinematic 9."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.nc.conftest import run_text
from tests.nc.five_axes import (
    FIVE,
    ON,
    TABLES,
    FiveAxes,
    direction,
    machine,
    pivot_mm,
    printed,
    run5,
)

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.motion.curves import Arc as CurveArc
from axisrig.kernel.motion.dynamics import Dynamics
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.motion.tool_path import ToolCurve, tool_dynamics
from axisrig.kernel.nc.canon import (
    ArcMove,
    KinematicChoice,
    LinearMove,
    MeasuringRun,
    Warn,
)
from axisrig.kernel.nc.coordinates import OffsetTables


def test_coordinates_are_those_of_the_tool_tip() -> None:
    at = machine()
    commands = run5(
        ON + '#MSG ["%f %f", V.A.ABS.Z, V.A.PROG.X]\nG0 X1 Y2 Z3 C20 A-35\n'
        '#MSG ["%f %f %f", V.A.ABS.X, V.A.ABS.Z, V.A.ACS.ABS.Z]',
        at,
    )
    assert printed(commands) == pytest.approx(
        [120.0, 10.0, 1.0, 3.0, pivot_mm((1, 2, 3), 20, -35)[2]]
    )
    assert list(at.acs_mm.values()) == pytest.approx([*pivot_mm((1, 2, 3), 20, -35), 20, -35])


def test_a_turn_of_the_tool_keeps_its_tip() -> None:
    at = machine()
    commands = run5(ON + "G0 X1 Y2 Z3\nG90 A=-45\n", at)
    assert commands[-2].target_mm == {"A": -45.0}
    assert list(at.acs_mm.values()) == pytest.approx([*pivot_mm((1, 2, 3), 0, -45), 0, -45])


def test_off_begins_where_the_axes_are_and_the_length_shifts_z_again() -> None:
    commands = run5(
        ON + 'G0 X1 Y2 Z3 A90\n#TRAFO OFF\n#MSG ["%f %f", V.A.ABS.Y, V.A.PROG.Z]\nG91 G0 Y5'
    )
    pivot = pivot_mm((1, 2, 3), 0, 90)
    assert printed(commands) == pytest.approx([pivot[1], pivot[2] - 80.0])
    assert commands[-2].target_mm == pytest.approx({"Y": pivot[1] + 5.0})


def test_a_coordinate_system_is_on_top_of_the_tool() -> None:
    at = machine()
    run5(ON + "#CS ON[5,6,7,30,0,0]\nG0 X1 Y2 Z3 A20", at)
    tcp = np.array([5, 6, 7]) + Rotation.from_euler("X", 30, degrees=True).apply([1, 2, 3])
    assert list(at.acs_mm.values()) == pytest.approx([*pivot_mm(tcp, 0, 20), 0, 20])


def test_a_coordinate_system_does_not_turn_the_orientation_of_the_head() -> None:
    """B30 of #CS turns the place of the TCP; C and A stay axes of the machine."""
    at = machine()
    run5(ON + "#CS ON[0,0,0,0,30,0]\nG0 X10 Y20 Z30 C20 A-35", at)
    tcp = Rotation.from_euler("Y", 30, degrees=True).apply([10, 20, 30])
    assert list(at.acs_mm.values()) == pytest.approx([*pivot_mm(tcp, 20, -35), 20, -35])


def test_a_coordinate_system_does_not_turn_the_orientation_of_the_robot() -> None:
    """A B C stay those of the machine: the tool points down whether #CS is turned or not."""
    six = ("X", "Y", "Z", "A", "B", "C")
    lengths = {0: 50, 6: 450, 7: 600, 8: 640, 9: 100, 10: 150, 11: 100}  # HD1, HD7 ..
    written = [f"V.G.KIN_STEP[0].ID[45].PARAM[{n}]={mm}0000" for n, mm in lengths.items()]
    at = FiveAxes(dict(zip(six, (0.0, 0.0, 0.0, 0.0, 90.0, 0.0), strict=True)), None)
    text = "V.G.WZ_AKT.L = 80\n#TRAFO [45]\n#CS ON[0,0,0,0,30,0]\nG0 X100 Y20 Z900 A10 B15 C5\n"
    run_text(
        "\n".join(written) + "\n" + text,
        at,
        axes=six,
        tables=OffsetTables(rotary=frozenset(six)),
    )
    assert at.kinematic is not None
    found = at.kinematic.forward(tuple(at.acs_mm.values()))
    tcp = Rotation.from_euler("Y", 30, degrees=True).apply([100, 20, 900])
    assert found == pytest.approx((*tcp, 10, 15, 5))


@pytest.mark.parametrize("choice", ["#TRAFO [9]", "#KIN ID[9]\n#TRAFO", "#KIN ID[9]\n#TRAFO ON"])
def test_ways_to_switch_it_on(choice: str) -> None:
    (command,) = [c for c in run5(choice) if isinstance(c, KinematicChoice)]
    assert command.kinematic is not None
    assert command.kinematic.name == "9"
    assert command.axes == FIVE


@pytest.mark.parametrize(
    ("chosen", "named", "on"),
    [("9", "9, 98", (9, 98)), ("9,98", "9", (9,)), ("9", "45", None), ("9", "12", None)],
)
def test_what_trafo_names_counts_and_not_what_was_chosen_before(
    chosen: str, named: str, on: tuple[int, ...] | None
) -> None:
    """#TRAFO ON after it takes what #KIN ID has chosen again. 45 has other axes, 12 is none."""
    text = f"V.G.KIN_STEP[1].ID[98].PARAM[3] = 850000\n#KIN ID[{chosen}]\n#TRAFO [{named}]\n"
    if on is None:
        with pytest.raises(Alarm):
            run5(text)
        return
    commands = run5(text + "#TRAFO OFF\n#TRAFO ON\n")
    switched = [c.ids for c in commands if isinstance(c, KinematicChoice) and c.kinematic]
    assert switched == [on, tuple(int(number) for number in chosen.split(","))]


def test_98_extends_the_tool() -> None:
    """FCT-M3 12.2, example 2, with 30 and 60 degrees: 97.980 mm at 45 degrees, HD1 100 mm."""
    at = machine()
    parameters = "".join(
        f"V.G.KIN_STEP[1].ID[98].PARAM[{n}] = {value}\n"
        for n, value in enumerate((1_000_000, 300_000, 600_000, 910_000))
    )
    run5(parameters + "V.G.WZ_AKT.L = 80\n#KIN ID[9,98]\n#TRAFO ON\nG0 X0 Y0 Z0 A-45", at)
    lever_mm = 100.0 + 80.0 * np.cos(np.radians(30)) / np.cos(np.radians(45))
    assert [at.acs_mm[axis] for axis in "XYZ"] == pytest.approx([*lever_mm * direction(0, -45)])


def test_a_block_across_the_angles_of_98_stops_at_them() -> None:
    """L2 begins to grow at 30 degrees and ends to at 60: an axis would change its speed at once."""
    parameters = "".join(
        f"V.G.KIN_STEP[1].ID[98].PARAM[{n}] = {value}\n"
        for n, value in enumerate((0, 300_000, 600_000, 910_000))
    )
    commands = run5(parameters + "V.G.WZ_AKT.L = 80\n#TRAFO [9, 98]\nG0 X0 A0\nX10 A-80\nX0\nA0")
    targets = [c.target_mm for c in commands if isinstance(c, LinearMove)]
    assert [t["A"] for t in targets if "A" in t] == pytest.approx([-30, -60, -80, -60, -30, 0])
    assert [t["X"] for t in targets if "X" in t][-4:-1] == pytest.approx([3.75, 7.5, 10.0])


def parts_of_an_arc(kinematic: str, arc: str) -> tuple[list[ArcMove], Kinematic]:
    """An arc from X0 Y0 with the tool upright; HD2 is 30 and HD3 60 degrees."""
    parameters = "".join(
        f"V.G.KIN_STEP[1].ID[98].PARAM[{n}] = {value}\n"
        for n, value in enumerate((0, 300_000, 600_000, 910_000))
    )
    choice = f"V.G.WZ_AKT.L = 80\n#TRAFO {kinematic}\nG0 X0 Y0 Z0 C0 A0\n"
    commands = run5(f"{parameters}{choice}G17 F3000 {arc}")
    (chosen,) = [c for c in commands if isinstance(c, KinematicChoice)]
    assert chosen.kinematic is not None
    return [c for c in commands if isinstance(c, ArcMove)], chosen.kinematic


def test_an_arc_across_the_angles_of_98_stops_at_them() -> None:
    """Half a circle of 10 mm with a height of 8 mm: every part lies on the same helix."""
    parts, _ = parts_of_an_arc("[9, 98]", "G2 X20 Y0 Z8 A-80 I10 J0")
    assert [part.target_mm["A"] for part in parts] == pytest.approx([-30, -60, -80])
    assert sum(part.angle_rad for part in parts) == pytest.approx(np.pi)
    for part in parts:
        share = part.target_mm["A"] / -80.0
        angle = np.pi * (1.0 - share)  # from the left over the top: G2 is clockwise
        at = [part.target_mm[axis] for axis in "XYZ"]
        assert at == pytest.approx([10 + 10 * np.cos(angle), 10 * np.sin(angle), 8 * share])
    (whole,), _ = parts_of_an_arc("[9]", "G2 X20 Y0 Z8 A-80 I10 J0")
    assert whole.angle_rad == pytest.approx(np.pi)


@pytest.mark.parametrize(
    "arc", ["G2 X20 Y0 Z8 A-80 I10 J0", "G3 X0 Y0 A-80 I10 J5", "G2 X20 Y0 A-80 C90 R-15"]
)
def test_in_no_part_of_an_arc_an_axis_passes_its_acceleration(arc: str) -> None:
    """The places of every ms; in one piece there are 2595 of 800 mm/s2 in the cycle of a kink."""
    parts, kinematic = parts_of_an_arc("[9, 98]", arc)
    slope = Slope(800.0, 800.0, 500.0)
    axes = [Dynamics(slope, slope, slope, 500.0)] * 5
    tool: tuple[float, ...] = (0.0,) * 5
    near = kinematic.inverse(tool, tool)
    places = [near] * 2
    for part in parts:
        end = tuple(part.target_mm.get(axis, at) for axis, at in zip(FIVE, tool, strict=True))
        centre = tuple(part.centre_mm.get(axis, at) for axis, at in zip(FIVE, tool, strict=True))
        tangent = tuple(part.tangent.get(axis, 0.0) for axis in FIVE)
        curve = ToolCurve(CurveArc(tool, end, centre, tangent, part.angle_rad), kinematic, near)
        dynamics = tool_dynamics(axes, curve, 50.0)
        speed_mm_s = min(50.0, dynamics.speed_max_mm_s)
        profile = dynamics.acceleration.plan(curve.length_mm, speed_mm_s, dynamics.deceleration)
        times = np.arange(1e-3, profile.duration_s + 1e-3, 1e-3)
        places += [curve.at(profile.at(float(at))[0]) for at in times]
        tool, near = end, curve.end_mm
    assert np.abs(np.diff(np.array(places), 2, axis=0)).max() / 1e-6 <= 800.0 * (1.0 + 1e-3)


def test_what_a_run_gives() -> None:
    """FCT-C4 section 5, third column: no tool in MOFFS; every axis of the head is latched."""
    at = machine(plane=("Z", 50.0))
    commands = run5(
        ON + "G54 G0 X0 Y0 Z90 C20 A-35\nF500\nG100 Z40\n"
        '#MSG ["%f %f %f %f", V.A.MESS.Z, V.A.MEAS.ACS.VALUE.Z, V.A.MOFFS.Z, V.A.MEAS.PCS.VALUE.A]',
        at,
    )
    (run,) = [c for c in commands if isinstance(c, MeasuringRun)]
    assert run.measuring_axes == FIVE
    assert printed(commands) == pytest.approx([50.0, pivot_mm((0, 0, 50), 20, -35)[2], 10.0, -35.0])


def test_without_the_signal_of_one_axis_there_is_no_value() -> None:
    with pytest.raises(Alarm, match=r"V\.A\.MESS\.Z") as alarm:
        run5(
            ON + 'G0 Z90\nF500\nG100 Z40\n#MSG ["%f", V.A.MESS.Z]',
            machine(plane=("Z", 50.0), silent=("A",)),
        )
    assert alarm.value.id == 900101


@pytest.mark.provokes(900481, 1, name="9")
def test_a_new_tool_acts_with_the_next_transformation() -> None:
    at = machine()
    commands = run5(ON + "G0 Z0\nV.G.WZ_AKT.L = 100\nG0 Z10\n#TRAFO OFF\n#TRAFO ON\nG0 Z20", at)
    (warning,) = [c.alarm for c in commands if isinstance(c, Warn)]
    assert warning.id == 900481
    assert at.acs_mm["Z"] == pytest.approx(120.0)


def test_the_transformation_waits_for_every_axis_of_the_kinematic() -> None:
    """Also for a rotary one that a coordinate system would not wait for."""
    commands = run5("A[INDP_ASYN G90 POS=30 G01 FEED=100]\n#TRAFO [9]")
    kinds = [type(command).__name__ for command in commands]
    waits = kinds.index("WaitIndependent")
    assert waits < kinds.index("KinematicChoice")
    assert commands[waits].axes == ("A",)


def test_a_coordinate_system_that_is_on_stays_on_top() -> None:
    at = machine()
    run5("V.G.WZ_AKT.L = 80\n#CS ON[5,6,7,30,0,0]\n#TRAFO [9]\nG0 X1 Y2 Z3 A20", at)
    tcp = np.array([5, 6, 7]) + Rotation.from_euler("X", 30, degrees=True).apply([1, 2, 3])
    assert list(at.acs_mm.values()) == pytest.approx([*pivot_mm(tcp, 0, 20), 0, 20])


def test_what_was_chosen_is_in_the_command() -> None:
    (on,) = [
        c
        for c in run5("V.G.KIN_STEP[0].ID[9].PARAM[0] = 1000\n" + ON)
        if isinstance(c, KinematicChoice)
    ]
    assert (on.ids, on.tool_mm, on.written) == ((9,), 80.0, {(0, 9, 0): 1000.0})


def test_the_ball_counts_in_the_direction_of_the_run_alone() -> None:
    """X has moved before the run and not in it: its value has no share of the ball."""
    tables = OffsetTables(rotary=frozenset("CA"), ball_radius_counts=True)
    commands = run5(
        "V.G.WZ_AKT.R = 2\n" + ON + "G0 X1 Y2 Z90\nG0 X7\nF500\nG100 Z40\n"
        '#MSG ["%f %f", V.A.MEAS.PCS.VALUE.X, V.A.MEAS.PCS.VALUE.Z]',
        machine(plane=("Z", 50.0)),
        tables,
    )
    assert printed(commands) == pytest.approx([7.0, 48.0])


def test_an_axis_outside_of_the_kinematic_stands_where_it_has_been_sent() -> None:
    """W beside the head: away, with the tool at rest and in one block with it, and back."""
    at = FiveAxes(dict.fromkeys((*FIVE, "W"), 0.0), None)
    show = '#MSG ["%f %f %f", V.A.ACS.ABS.W, V.A.ABS.W, V.A.ACS.ABS.Z]\n'
    commands = run_text(
        f"{ON}G0 X0 Y0 Z0 C0 A0\n{show}W5\n{show}W7 Z3\n{show}Z4\n{show}W0\n{show}"
        f"#TRAFO OFF\n{show}",
        at, axes=(*FIVE, "W"), tables=TABLES,
    )  # fmt: skip
    w_mm, z_mm = (0, 5, 7, 7, 0, 0), (80, 80, 83, 84, 84, 84)
    expected = [each for w, z in zip(w_mm, z_mm, strict=True) for each in (w, w, z)]
    assert printed(commands) == pytest.approx(expected)
