"""Measurement runs on workpieces through the whole chain, against the geometry of the ball."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., Any]
INCREMENT_MM = 10 / 2**20
FEED_MM_S = 5.0
RIG = """
title = "Z with a probe above a workpiece"
[cycle]
cycle_offset_us = 620
[channel]
list = "channel.lst"
[segment.bus]
[drive.d]
input_delay_us = 0.0
[axis.Z]
list = "z.lst"
segment = "bus"
node = 3
drive = "d"
plant = "z"
probe_2 = "probe"
[plant.z]
fmu = "AxisRig.Drives.ServoAxis"
start = {{ kv = 40, position_start_mm = 20 }}
[plant.probe]
fmu = "AxisRig.Sensors.WorkpieceProbe"
start = {{ {start} }}
wire = {{ z = "z" }}
"""


@pytest.mark.long
@pytest.mark.parametrize(
    ("start", "height_mm", "late_s"),
    [
        ('"workpiece.plane.level_mm" = 2.8', 2.8, 0.0),
        ('ball_radius_mm = 3, "workpiece.inclined.angle_deg" = 30', 3 / math.cos(math.pi / 6), 0.0),
        (
            'ball_radius_mm = 2, "workpiece.hole.radius_mm" = 5, "workpiece.hole.center_x_mm" = 4',
            math.sqrt(2**2 - 1**2),
            0.0,
        ),
        ("pretravel_um = 5, radio_delay_ms = 10, bounce_count = 4", 0.0, 0.010 + 5e-3 / FEED_MM_S),
    ],
    ids=["level", "ball on a slope", "ball on the rim of a bore", "radio and bounce"],
)
def test_measured_height_is_that_of_the_ball(
    run_own: Run, tmp_path: Path, start: str, height_mm: float, late_s: float
) -> None:
    (tmp_path / "channel.lst").write_text("messtyp 1\n")
    (tmp_path / "z.lst").write_text(
        "kopf.log_achs_name Z\nkenngr.messachse 1\n"
        "getriebe[0].window 100\nantr.nbr_delay_cycles 2\n"
    )
    rig, program = tmp_path / "own.toml", tmp_path / "own.nc"
    rig.write_text(RIG.format(start=start), encoding="utf-8")
    program.write_text(
        f'%own\nN10 G100 Z-5 F{FEED_MM_S * 60}\n#MSG SYN["MESS.Z=%f", V.A.MESS.Z]\nN30 M30\n',
        encoding="utf-8",
    )
    out = run_own(program, rig, ["set:Z.kenngr.measure.input=2"])
    assert out.alarms == []
    expected = height_mm - FEED_MM_S * late_s
    assert out.printed("MESS.Z") == pytest.approx([expected], rel=0, abs=INCREMENT_MM / 2 + 2e-6)
