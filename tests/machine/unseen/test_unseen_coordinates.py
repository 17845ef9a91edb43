"""Unseen programs with coordinate systems and shifts."""

import math
from itertools import product

import numpy as np
import pytest
from unseen_geometry import ONE_AXIS_MM, PATH_MM, Run, meets, near, plane, show, starts, turned


@pytest.mark.long
@pytest.mark.parametrize("nested", [False, True])
def test_a_coordinate_system_with_two_rotations_and_one_inside_it(
    run_nc: Run, nested: bool
) -> None:
    origin, rotation = np.array([10.0, 20.0, 30.0]), turned(0, 15, 30)
    blocks = "#CS ON[10,20,30,0,15,30]\n"
    if nested:
        origin = origin + rotation @ np.array([5.0, -2.0, 1.5])
        rotation = rotation @ turned(-20, 0, 7)
        blocks += "#CS ON[5,-2,1.5,-20,0,7]\n"
    start, end = np.array([4.0, 6.0, 40.0]), np.array([4.0, 9.0, 5.0])
    start_acs, end_acs = origin + rotation @ start, origin + rotation @ end
    wall = float(start_acs[2] + 0.45 * (end_acs[2] - start_acs[2]))
    blocks += "N10 G1 G90 X4 Y6 Z40 F3000\nN20 G100 Y9 Z5 F1500\n"
    out = run_nc(
        blocks
        + show(*(f"{n}.{a}" for n, a in product(("MESS", "MEAS.ACS.VALUE", "MOFFS"), "XYZ"))),
        starts(*(start_acs + 0.2)) + "\n" + plane((0, 0, 1), wall),
    )
    assert out.alarms == []
    acs = meets(start_acs, end_acs, (0, 0, 1), wall)
    pcs = rotation.T @ (acs - origin)
    programmed = {"X": 4.0, "Y": 9.0, "Z": 5.0}
    # Three roundings meet in one turned coordinate
    tolerance_mm = math.sqrt(3) * PATH_MM
    for index, axis in enumerate("XYZ"):
        assert out.printed(f"MEAS.ACS.VALUE.{axis}") == near([acs[index]], tolerance_mm)
        assert out.printed(f"MESS.{axis}") == near([pcs[index]], tolerance_mm)
        offset = pcs[index] - programmed[axis]
        assert out.printed(f"MOFFS.{axis}") == near([offset], tolerance_mm)


@pytest.mark.long
def test_relative_programming_and_shifts(run_nc: Run) -> None:
    """Z 50; G92 Z7 acts with the next absolute block, a second one in G91 adds to it.

    G91 goes from where the axis is: 48, then the run to 48 - 30. MESS holds all shifts, MEAS.PCS
    none, PROG of the run is 18 - 9.5.
    """
    wall = 41.3
    out = run_nc(
        "N10 G92 Z7\nN20 G90 G1 Z43 F6000\n"  # ABS 50
        "N30 G91 G92 Z2.5\nN40 G90 G1 Z38.5\n"  # ABS 38.5 + 9.5 = 48
        "N50 G91 G100 Z-30 F1200\n"
        + show("MESS.Z", "MEAS.ACS.VALUE.Z", "MEAS.PCS.VALUE.Z", "MOFFS.Z", "PROG.Z"),
        starts(0, 0, 60) + "\n" + plane((0, 0, 1), wall),
    )
    expected = {
        "MESS.Z": wall,
        "MEAS.ACS.VALUE.Z": wall,
        "MEAS.PCS.VALUE.Z": wall - 9.5,
        "MOFFS.Z": wall - (18 - 9.5) - 9.5,
        "PROG.Z": 18 - 9.5,
    }
    for name, value in expected.items():
        assert out.printed(name) == near([value]), name


@pytest.mark.long
@pytest.mark.parametrize("factor", [1.0, 0.5, -1.0, 0.0])
def test_the_measurement_offset_acts_by_its_factor(run_nc: Run, factor: float) -> None:
    wall = 244.4
    offset = wall - 230.0
    out = run_nc(
        "N10 G100 Z230 F3000\n" + show("MOFFS.Z") + f"\nN20 G101 Z{factor}\n" + show("MEIN.Z")
        + "\nN30 G1 Z246 F6000\n" + show("ABS.Z", "PROG.Z")
        + "\nN40 G102\n" + show("MEIN.Z") + "\nN50 G1 Z248\n" + show("ABS.Z"),
        plane((0, 0, 1), wall),
    )  # fmt: skip
    assert out.printed("MOFFS.Z") == near([offset])
    assert out.printed("MEIN.Z") == near([factor * offset, 0.0])
    assert out.printed("ABS.Z") == near([246 + factor * offset, 248])
    assert out.printed("PROG.Z") == [246.0]
    assert out.column("Z.truth_mm")[-1] == pytest.approx(248, abs=2e-4)


@pytest.mark.long
def test_a_second_run_inside_the_offset_measures_the_same_workpiece(run_nc: Run) -> None:
    """With MEIN m active MESS stays, MEAS.PCS loses m, and MOFFS does not (FCT-C4 section 5)."""
    wall = 240.25
    first = wall - 235.0
    shown = show("MESS.Z", "MEAS.PCS.VALUE.Z", "MOFFS.Z")
    out = run_nc(
        f"N10 G100 Z235 F3000\n{shown}\nN20 G101 Z1\nN30 G1 Z238 F6000\n"
        f"N40 G100 Z230 F1500\n{shown}",
        plane((0, 0, 1), wall),
    )
    two = 2 * ONE_AXIS_MM  # the offset has its own rounding
    assert out.printed("MESS.Z") == near([wall, wall])
    assert out.printed("MEAS.PCS.VALUE.Z") == near([wall, wall - first], two)
    assert out.printed("MOFFS.Z") == near([first, wall - 230], two)


@pytest.mark.long
def test_runs_at_two_points_of_an_inclined_plane(run_nc: Run) -> None:
    """Retract, measure the same point slower, then another one 6 mm beside it."""
    slope, d = math.radians(20), 90.0
    normal = (math.sin(slope), 0.0, math.cos(slope))

    def height(x: float) -> float:
        return (d - normal[0] * x) / normal[2]

    shown = show("MESS.Z", "MERF.Z")
    out = run_nc(
        f"N10 G100 Z80 F3000\n{shown}\n{show('ABS.Z')}\nN20 G1 Z97.5 F6000\n"
        f"N30 G100 Z80 F300\n{shown}\nN40 G1 Z105\nN50 G1 X-6\nN60 G100 Z80 F2000\n{shown}",
        starts(0, 0, 100) + "\n" + plane(normal, d),
    )
    assert out.alarms == []
    # No block waits for the one before to settle, so X creeps in while Z is under way
    x_mm = out.machine.plant.probes["probe"].contacts[2].position_mm["x"]
    assert x_mm == pytest.approx(-6.0, abs=0.005)
    heights = [height(0.0), height(0.0), height(x_mm)]
    assert out.printed("MESS.Z") == near(heights)
    assert out.printed("MERF.Z") == [1.0, 1.0, 1.0]
    assert out.printed("ABS.Z") == pytest.approx([out.stand_mm("Z")], abs=1.5e-4)
    assert len(out.machine.channel.records) == 3
