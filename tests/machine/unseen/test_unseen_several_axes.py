"""Unseen programs in which several axes measure at once."""

from typing import Any

import numpy as np
import pytest
from unseen_geometry import PATH_MM, Run, meets, near, plane, show, starts


@pytest.mark.long
@pytest.mark.parametrize(
    ("begin", "target", "normal", "surface_mm"),
    [
        ((30, 0, 50), (60, 15, 50), (-1, 0, 0), -40.0),
        ((5, -7, 60), (25, -7, 40), (0, 0, 1), 48.5),
        ((5, -7, 60), (25, -37, 30), (0, 0, 1), 48.5),
        ((0, 0, 40), (12, 4, 10), (0.6, 0, 0.8), 22.0),
        ((-10, 20, 30), (5, 8, 3), (2 / 7, 3 / 7, 6 / 7), 18.0),
    ],
)
def test_every_axis_reads_where_the_line_meets_the_plane(
    run_nc: Run, begin: Any, target: Any, normal: Any, surface_mm: float
) -> None:
    """Equal loops keep the axes on the straight line, whatever their lag."""
    moved = [a for a, p, q in zip("XYZ", begin, target, strict=True) if p != q]
    words = " ".join(f"{a}{q}" for a, q in zip("XYZ", target, strict=True) if a in moved)
    out = run_nc(
        f"N10 G100 {words} F900\n" + show(*(f"MESS.{a}" for a in moved)),
        starts(*begin) + "\n" + plane(normal, surface_mm),
    )
    assert out.alarms == []
    point = dict(zip("XYZ", meets(begin, target, normal, surface_mm), strict=True))
    for axis in moved:
        assert out.printed(f"MESS.{axis}") == near([point[axis]], PATH_MM)


@pytest.mark.long
def test_axes_with_different_gains_latch_a_point_of_their_true_path(run_nc: Run) -> None:
    """Each axis lags v_i / Kv_i behind the line: the path is shifted, and so is the value.

    A 3-4-5 line: 18 mm/s of X at Kv 60 and 24 mm/s of Z at Kv 25; feed-forward 0.5 on X.
    """
    begin, target, wall, v = (0.0, 0.0, 100.0), (30.0, 0.0, 60.0), 78.0, 30.0
    rig = """
    [plant.x]
    start = { position_start_mm = 0.0, kv = 60, feed_forward = 0.5 }
    [plant.z]
    start = { position_start_mm = 100.0, kv = 25 }
    """
    out = run_nc(
        f"N10 G100 X{target[0]} Z{target[2]} F{v * 60}\n" + show("MESS.X", "MESS.Z"),
        rig + plane((0, 0, 1), wall),
    )
    lag_x, lag_z = 0.5 * 0.6 * v / 60, -0.8 * v / 25
    x, _, _ = meets(begin, target, (0, 0, 1), wall + lag_z) - np.array([lag_x, 0, 0])
    assert out.printed("MESS.Z") == near([wall], PATH_MM)
    assert out.printed("MESS.X") == near([x], PATH_MM)
    on_the_line = meets(begin, target, (0, 0, 1), wall)[0]
    assert abs(x - on_the_line) > 0.5, "the path error must be far above what is compared"


@pytest.mark.long
def test_two_drives_on_one_segment_of_an_own_rig(run_own: Run, tmp_path: Any) -> None:
    """Axis names of one's own, nothing taken from a shipped rig but the base's tables."""
    for name in ("channel", "u", "w"):
        text = "" if name == "channel" else f"kopf.log_achs_name {name.upper()}\n"
        text += "messtyp 1\n" if name == "channel" else "kenngr.messachse 1\n"
        text += "" if name == "channel" else "getriebe[0].window 100\nantr.nbr_delay_cycles 2\n"
        (tmp_path / f"{name}.lst").write_text(text, encoding="utf-8")
    axis = """
    [axis.{0}]
    list = "{1}.lst"
    segment = "bus"
    node = {2}
    drive = "d"
    plant = "p{1}"
    probe_2 = "touch"
    [plant.p{1}]
    fmu = "AxisRig.Drives.ServoAxis"
    start = {{ kv = 30, position_start_mm = {3} }}
    """
    rig = f"""
    title = "two axes"
    [cycle]
    cycle_offset_us = 620
    [channel]
    list = "channel.lst"
    [segment.bus]
    [drive.d]
    input_delay_us = 0.0
    {axis.format("U", "u", 11, 7.0)}
    {axis.format("W", "w", 12, -4.0)}
    [plant.touch]
    fmu = "AxisRig.Sensors.TouchProbe"
    start = {{ normal_y = 0.8, normal_z = -0.6, surface_mm = -12 }}
    wire = {{ z = "pu", y = "pw" }}
    """
    rig_file, program = tmp_path / "own.toml", tmp_path / "own.nc"
    rig_file.write_text(rig, encoding="utf-8")
    program.write_text(
        f"%own\nN1 G100 U17 W-9 F600\n{show('MESS.U', 'MESS.W')}\nN9 M30\n", encoding="utf-8"
    )
    sets = ["set:U.kenngr.measure.input=2", "set:W.kenngr.measure.input=2"]
    out = run_own(program, rig_file, sets)
    assert out.alarms == []
    w, u = meets((-4, 7), (-9, 17), (0.8, -0.6), -12)
    assert out.printed("MESS.U") == near([u], PATH_MM)
    assert out.printed("MESS.W") == near([w], PATH_MM)
