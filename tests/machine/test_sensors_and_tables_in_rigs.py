"""Distance sensors, linear encoder and rotary table of the library in runs of a whole rig."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

Run = Callable[..., Any]
AXIS_LIST = """\
kopf.log_achs_name {name}
getriebe[0].vb_eilgang 100000
getriebe[0].dynamik.vb_max 100000
antr.nbr_delay_cycles 2
"""
HEAD = """
title = "without a probe"
[cycle]
cycle_offset_us = 620
[channel]
list = "channel.lst"
[segment.bus]
[drive.screw]
[drive.worm]
lead_mm = 6
"""
AXIS = """
[axis.{name}]
list = "{name}.lst"
segment = "bus"
node = {node}
drive = "{drive}"
plant = "{name}"
"""


def run(run_own: Run, folder: Path, axes: dict[str, str], plants: str, program: str) -> Any:
    """Run a program on axes (name: drive) and their plants."""
    (folder / "channel.lst").write_text("messtyp 1\n")
    text = HEAD
    for node, (name, drive) in enumerate(axes.items(), start=1):
        (folder / f"{name}.lst").write_text(AXIS_LIST.format(name=name))
        text += AXIS.format(name=name, node=node, drive=drive)
    (folder / "own.toml").write_text(text + plants, encoding="utf-8")
    (folder / "own.nc").write_text(f"%own\n{program}\nN99 M30\n", encoding="utf-8")
    out = run_own(folder / "own.nc", folder / "own.toml")
    assert out.alarms == []
    return out


SPEED_MM_S, HEIGHT_MM = 50.0, 3.0
AMPLITUDE_MM, WAVE_MM, CORNER_HZ = 0.2, 10.0, 50.0
RADIUS_MM, SLOPE = 2.0, math.tan(math.radians(2))
ABOVE = f"""
[plant.X]
fmu = "AxisRig.Drives.ServoAxis"
start = {{ kv = 40 }}
[plant.Z]
fmu = "AxisRig.Drives.ServoAxis"
start = {{ kv = 40, position_start_mm = {HEIGHT_MM} }}
[plant.wave]
fmu = "AxisRig.Sensors.DistanceSensor"
wire = {{ x = "X", z = "Z" }}
[plant.wave.start]
electrode_radius_um = 1
bandwidth_hz = {CORNER_HZ}
"workpiece.sine.amplitude_mm" = {AMPLITUDE_MM}
"workpiece.sine.wavelength_mm" = {WAVE_MM}
[plant.scale]
fmu = "AxisRig.Sensors.SecondEncoder"
kind = "distance"
wire = {{ x = "X" }}
start = {{ resolution_um = 1, offset_mm = 5 }}
map = {{ distance = "position", distance_true = "position_true" }}
[plant.slope]
fmu = "AxisRig.Sensors.DistanceSensor"
wire = {{ x = "X", z = "Z" }}
start = {{ electrode_radius_mm = {RADIUS_MM}, "workpiece.inclined.angle_deg" = 2 }}
"""


@pytest.mark.long
def test_what_sensors_tell_at_each_sync_is_recorded(run_own: Run, tmp_path: Path) -> None:
    """The filter of first order at a steady speed; the mean of 1/d over a disc above a plane."""
    axes = {"X": "screw", "Z": "screw"}
    out = run(run_own, tmp_path, axes, ABOVE, "N10 G90 G1 X60 F3000")
    x_mm, z_mm = out.column("X.truth_mm"), out.column("Z.truth_mm")
    number = 2 * math.pi / WAVE_MM
    waves = z_mm - AMPLITUDE_MM * np.sin(number * x_mm)
    assert out.column("wave.distance_true_mm") == pytest.approx(waves, abs=1e-9)
    slope = z_mm - SLOPE * x_mm
    assert out.column("slope.distance_true_mm") == pytest.approx(slope, abs=1e-9)
    for name in ("wave", "slope"):
        assert set(out.column(f"{name}.valid")) == {1}
    assert set(out.column("wave.touching")) == {0}

    steady = (x_mm > 30) & (x_mm < 50)
    assert out.column("X.velocity_mm_s")[steady] == pytest.approx(SPEED_MM_S, abs=0.01)
    lag = number * SPEED_MM_S / (2 * math.pi * CORNER_HZ)
    filtered = np.sin(number * x_mm - math.atan(lag)) / math.hypot(1, lag)
    found = out.column("wave.distance_mm")[steady]
    assert found == pytest.approx((z_mm - AMPLITUDE_MM * filtered)[steady], abs=1e-5)

    # harmonic mean over the disc, and the filter of 1 kHz behind it
    seen = slope / 2 * (1 + np.sqrt(1 - (RADIUS_MM * SLOPE / slope) ** 2))
    behind = SLOPE * SPEED_MM_S / (2 * math.pi * 1000)
    assert np.all((slope - seen)[steady] > 4e-4)
    found = out.column("slope.distance_mm")[steady]
    assert found == pytest.approx((seen + behind)[steady], abs=2e-6)

    # a linear encoder 5 mm off, in whole micrometres
    counts = out.column("scale.distance_mm") * 1e3
    assert counts == pytest.approx(np.round(counts), abs=1e-6)
    assert counts == pytest.approx((x_mm + 5.0) * 1e3, abs=0.5 + 1e-6)


ROLES = (
    *("reference_position", "reference_velocity", "position", "velocity"),
    *("motor_position", "motor_velocity", "demand_position"),
)
TABLE = """
[plant.C]
fmu = "AxisRig.Drives.RotaryAxis"
start = { kv = 20, position_start_deg = 90 }
[plant.C.map]
""" + "\n".join(f'{role} = {{ variable = "{role}", lead_mm = 360 }}' for role in ROLES)


@pytest.mark.long
def test_rotary_table_is_an_axis_of_degrees(run_own: Run, tmp_path: Path) -> None:
    """1 mm stands for 1 degree, also at the encoder; in steady motion it lags by v/kv."""
    out = run(run_own, tmp_path, {"C": "worm"}, TABLE, "N10 G90 G1 C180 F3600")
    degrees = out.column("C.truth_deg")
    assert degrees[0] == pytest.approx(90.0, abs=1e-9)
    steady = (degrees > 130) & (degrees < 160)
    assert out.column("C.velocity_deg_s")[steady] == pytest.approx(60.0, rel=1e-4)
    assert out.column("C.drive_lag_deg")[steady] == pytest.approx(60.0 / 20, rel=1e-4)
    assert out.column("C.actual_deg") == pytest.approx(degrees, abs=6 / 2**20)
    assert out.column("C.set_deg")[-1] == 180.0
    assert degrees[-1] == pytest.approx(180.0, abs=0.1)
