"""The rigs with a sensor at an inclined tool: the plant has its own kinematic, wired in degrees."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from axisrig.kernel.channel import Channel

Run = Callable[..., Any]
EXACT_MM = 1e-9
COUNT_MM, COUNT_DEG = 1e-5, 1e-4
"""Position units of the drives in these rigs."""
LEVER_MM, TOOL_MM = 180.0, 80.0

TILTING = """N10 G90 G01 Z180 F6000
N20 V.G.WZ_AKT.L = 80
N30 #TRAFO [9, 98]
N40 G01 X5 C20 A40 F3000
N50 G01 X0 A-45
N60 #TRAFO OFF"""
MOVING = """N10 G90 G01 X4 Y3 Z195 C6 A8 F6000
N20 G01 X0 Y0 Z200 C0 A0"""
JOINTS = """N10 G90 G01 X3 Y2 Z-4 A5 B80 C20 F6000
N20 G01 X0 Y0 Z0 A0 B90 C0"""


def columns(out: Any, name: str, unit: str = "mm") -> np.ndarray:
    """x, y, z of a point, a row for each SYNC."""
    return np.column_stack([out.column(f"{name}_{g}_{unit}") for g in "xyz"])


def head(out: Any, what: str) -> tuple[np.ndarray, np.ndarray]:
    """Clamping point and direction of the rig's head by a column of its axes."""
    c, a = out.column(f"C.{what}_deg"), out.column(f"A.{what}_deg")
    u = Rotation.from_euler("ZX", np.column_stack([c, a]), degrees=True).apply([0, 0, 1])
    pivot = np.column_stack([out.column(f"{g}.{what}_mm") for g in "XYZ"])
    return pivot - (LEVER_MM - TOOL_MM) * u, u


@pytest.mark.parametrize(
    ("rig", "within_mm"), [("distance-5axis", EXACT_MM), ("distance-5axis-servo", EXACT_MM)]
)
@pytest.mark.long
def test_place_of_the_tool_is_that_of_the_loads(run_nc: Run, rig: str, within_mm: float) -> None:
    """Ideal axes, then servo axes with rotary plants in rad; level surface at 0."""
    out = run_nc(MOVING, "", base=f"{rig}.toml")
    point, u = head(out, "truth")
    assert out.alarms == []
    assert np.ptp(out.column("gap.tilt_deg")) > 7.9
    assert np.max(np.abs(columns(out, "gap.clamping") - point)) < within_mm
    assert np.max(np.abs(columns(out, "gap.tcp") - (point - TOOL_MM * u))) < within_mm
    assert np.max(np.abs(out.column("gap.distance_true_mm") - point[:, 2])) < within_mm
    along = point[:, 2] / u[:, 2]
    assert np.max(np.abs(out.column("gap.along_mm") - along)) < within_mm


@pytest.mark.long
def test_tool_centre_point_rests_while_the_tool_tilts(run_nc: Run) -> None:
    """Half an increment of each linear axis and half a rotary one at each end of both levers.

    The kernel's kinematic moves the axes, the plant's own one says where the tool then is. The
    program moves X by 5 mm on the surface; Y and Z of the tool centre point do not move.
    """
    shown: list[tuple[float, bool]] = []

    def look(channel: Channel) -> None:
        is_shown = channel.plc.tool.tilt_deg is not None
        shown.append((channel.plc.values["SENSOR"] * 1e-4, is_shown))

    out = run_nc(TILTING, "", base="distance-5axis.toml", watch=look)
    assert out.alarms == []
    tcp, tilt = columns(out, "gap.tcp"), out.column("gap.tilt_deg")
    on = np.flatnonzero(tilt > 1e-3)
    assert tilt.max() == pytest.approx(45.0, abs=COUNT_DEG)
    bound = COUNT_MM / 2 + LEVER_MM * np.radians(COUNT_DEG) / 2 * np.sqrt(2)
    assert np.abs(tcp[on][:, 1:]).max() < bound
    assert np.ptp(tcp[on][:, 0]) == pytest.approx(5.0, abs=0.1)
    # The PLC makes h of what the sensor measures along the tool: half a step of the variable, and
    # half an increment of A in the tilt, s sin t
    orthogonal, (value, is_shown) = out.column("gap.distance_true_mm"), np.array(shown).T
    tilted = (tilt > 1e-3) & (is_shown > 0)
    assert np.ptp(tilt[tilted]) > 44.0
    bound = 0.5e-4 + TOOL_MM * np.radians(COUNT_DEG) / 2
    assert np.abs(value - orthogonal)[tilted].max() < bound


@pytest.mark.long
def test_joints_of_a_robot_reach_its_sensor(run_nc: Run) -> None:
    """Matrices by scipy from the true joints; offsets of the channel list in mm."""
    out = run_nc(JOINTS, "", base="distance-robot.toml")
    assert out.alarms == []
    q = {name: out.column(f"{name}.truth_deg") for name in "XYZABC"}

    def turn(axis: str, angle: np.ndarray) -> Rotation:
        return Rotation.from_euler(axis, angle[:, None], degrees=True)

    base = turn("z", q["X"])
    upper = base * turn("y", q["Y"])
    arm = upper * turn("y", q["Z"])
    flange = arm * turn("x", q["A"]) * turn("y", q["B"]) * turn("x", q["C"])
    point = base.apply([150, 0, 450]) + upper.apply([0, 0, 600]) + arm.apply([640, 0, -100])
    point = point + flange.apply([100 + 50, 0, 0])
    u = flange.apply([-1, 0, 0])
    assert np.max(np.abs(columns(out, "gap.clamping") - point)) < EXACT_MM
    assert np.max(np.abs(columns(out, "gap.tcp") - (point - TOOL_MM * u))) < EXACT_MM
    assert out.column("gap.distance_true_mm")[0] == pytest.approx(80.0, abs=EXACT_MM)
    assert out.machine.channel.plc.values["SENSOR"] > 0
