"""Whole measurement runs with every drive profile, and what a latch in the drive can and cannot do.

Closed forms: at a steady speed v the position stored is the contact plus v times the delay of the
input. On a screw with backlash b, dragged by the friction F through the stiffness k, the motor is
b/2 + F/k ahead of the slide, in the direction of motion.
"""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.profiles import habits, profile_names

Run = Callable[..., Any]
INCREMENT_MM = 10 / 2**20
DELAY_S = 4e-6

THREE_RUNS = """
N10 G01 G90 Z110 F3000
N20 G100 Z80 F600
#MSG SYN["FIRST=%f", V.A.MESS.Z]
N30 G01 Z104.37 F3000
N40 G100 Z80 F1500
#MSG SYN["SECOND=%f", V.A.MESS.Z]
N50 G01 Z101.11 F3000
N60 G100 Z80 F60
#MSG SYN["THIRD=%f", V.A.MESS.Z]
"""


@pytest.mark.long
@pytest.mark.parametrize("profile", profile_names())
@pytest.mark.parametrize("edge", ["POS", "NEG"])
def test_three_runs_at_one_surface_with_every_profile(run_nc: Run, profile: str, edge: str) -> None:
    """Each value belongs to its own run: 40, 100 and 4 nm beyond the surface.

    A profile that compensates a delay stores the position of so much before.
    """
    compensated_us = habits()["delay_compensation_us"].values.get(profile, 0.0)
    late_s = DELAY_S - float(compensated_us) * 1e-6
    out = run_nc(
        THREE_RUNS,
        f'[drive.servo]\nprofile = "{profile}"\nsample_us = 62.5',
        f"set:Z.kenngr.measure.edge={edge}",
        f"plant:probe.inverted={int(edge == 'NEG')}",
        base="probe-z.toml",
    )
    assert out.alarms == []
    for name, feed_mm_min in (("FIRST", 600), ("SECOND", 1500), ("THIRD", 60)):
        expected = 100 - feed_mm_min / 60 * late_s
        assert out.printed(name) == pytest.approx([expected], rel=0, abs=INCREMENT_MM)


@pytest.mark.long
@pytest.mark.parametrize("probe_input", [1, 2])
@pytest.mark.parametrize("source", ["CNC_DEFINED", "DRIVE_DEFINED"])
def test_the_trigger_source_of_either_input(run_nc: Run, probe_input: int, source: str) -> None:
    """DRIVE_DEFINED with 60D0 crosswise: probe 1 latches input 2, where the sensor is wired."""
    crosswise = source == "DRIVE_DEFINED"
    wired = 3 - probe_input if crosswise else probe_input
    rig = f"[axis.Z]\nprobe_{wired} = 'probe'\nprobe_{3 - wired} = 'other'\n"
    rig += "[plant.other]\nfmu = 'AxisRig.Sensors.TouchProbe'\nstart = { surface_mm = 20 }\n"
    rig += "wire = { z = 'z' }\n[drive.servo]\nsource_1 = 2\nsource_2 = 1"
    out = run_nc(
        THREE_RUNS,
        rig,
        f"set:Z.kenngr.measure.input={probe_input}",
        f"set:Z.antr.canopen.probing_trigger_source={source}",
        base="probe-z.toml",
    )
    assert out.alarms == []
    assert out.printed("THIRD") == pytest.approx([100.0], rel=0, abs=2 * INCREMENT_MM)


@pytest.mark.long
@pytest.mark.parametrize("downwards", [True, False])
def test_backlash_lies_between_motor_and_load(run_nc: Run, downwards: bool) -> None:
    """10 um of backlash; 120 N and 800 N s/m at 10 mm/s through 120 N/um: 5 + 128/120 um ahead."""
    out = backlash_run(run_nc, downwards)
    speed_mm_s = -10 if downwards else 10
    ahead_mm = (0.010 / 2 + 128 / 120e3) * (-1 if downwards else 1)
    expected = 100 + ahead_mm + speed_mm_s * DELAY_S
    values = out.printed("A") + out.printed("B")
    assert values == pytest.approx([expected] * 2, rel=0, abs=0.05e-3)
    assert abs(values[0] - values[1]) <= 2 * INCREMENT_MM  # one direction repeats


@pytest.mark.parametrize("downwards", [True, False])
@pytest.mark.long
def test_the_second_encoder_latches_the_load(run_nc: Run, downwards: bool) -> None:
    """With a scale at the load the backlash is gone: contact and delay only."""
    scales = "".join(f'[axis.{axis}]\nencoder_2 = "load"\n' for axis in "XYZ")
    more = f'latch_encoder = "second"\n{scales}'
    out = backlash_run(run_nc, downwards, more)
    expected = 100 + (-10 if downwards else 10) * DELAY_S
    values = out.printed("A") + out.printed("B")
    assert values == pytest.approx([expected] * 2, rel=0, abs=INCREMENT_MM)


def backlash_run(run_nc: Run, downwards: bool, more: str = "") -> Any:
    sign = -1 if downwards else 1
    begin, target = 100 - sign * 10, 100 + sign * 10
    rig = f"""
    [plant.z]
    fmu = "AxisRig.Drives.ScrewAxis"
    [plant.z.start]
    position_start_mm = {begin}.0
    backlash_um = 10
    "friction.breakaway_n" = 120
    [drive.servo]
    input_delay_us = 4.0
    {more}
    [plant.probe]
    start = {{ normal_x = 0, normal_y = 0, normal_z = {-sign}, surface_mm = {-sign * 100.0} }}
    """
    run = f"G100 Z{target} F600"
    program = (
        f'N10 {run}\n#MSG SYN["A=%f", V.A.MESS.Z]\nN20 G01 G90 Z{begin} F3000\n'
        f'N30 {run}\n#MSG SYN["B=%f", V.A.MESS.Z]'
    )
    out = run_nc(program, rig)
    assert out.alarms == []
    return out


@pytest.mark.long
@pytest.mark.parametrize("latch", ["interpolated", "linear", "sampled"])
def test_a_fine_encoder_at_full_speed_does_not_overflow(run_nc: Run, latch: str) -> None:
    """26 bits per revolution at 25 rev/s: 419430 increments between two samples of 250 us."""
    speed_mm_s = 250.0
    rig = f"""
    [drive.servo]
    encoder_increments = {2**26}
    latch = "{latch}"
    sample_us = 250.0
    [plant.z]
    start = {{ position_start_mm = 150.0 }}
    """
    out = run_nc(
        f'N10 G01 G90 Z150 F3000\nN20 G100 Z60 F{speed_mm_s * 60}\n#MSG SYN["A=%f", V.A.MESS.Z]',
        rig,
        "set:Z.getriebe[0].lslope_profil.a_grenz_stufe_1=20000",
        "set:Z.getriebe[0].lslope_profil.a_grenz_stufe_2=20000",
        base="probe-z.toml",
    )
    assert out.alarms == []
    (value,) = out.printed("A")
    late_mm = 100 - value
    latch_s = out.edge_ns() * 1e-9 + DELAY_S
    age_s = latch_s % 250e-6 if latch == "sampled" else 0.0
    # On its way the axis is at its full speed; what is left of its ramp is below 0.1 um
    assert late_mm == pytest.approx(speed_mm_s * (DELAY_S - age_s), abs=0.5e-3)


@pytest.mark.long
def test_jitter_belongs_to_the_seed(run_nc: Run) -> None:
    """Up to 200 us at 25 mm/s: values between 0.1 and 5.1 um behind the surface, drawn per edge."""
    rig = "[drive.servo]\ninput_jitter_us = 200.0"
    first, again = (run_nc(THREE_RUNS, rig, base="probe-z.toml") for _ in range(2))
    assert first.lines == again.lines
    speeds = (10, 25, 1)
    for name, speed_mm_s in zip(("FIRST", "SECOND", "THIRD"), speeds, strict=True):
        (value,) = first.printed(name)
        drawn_s = (100 - value) / speed_mm_s - DELAY_S
        assert -INCREMENT_MM <= drawn_s * speed_mm_s <= 200e-6 * speed_mm_s + INCREMENT_MM
        assert drawn_s != 0


@pytest.mark.long
@pytest.mark.parametrize("compensation_us", [4, 1000, 7000])
@pytest.mark.parametrize("latch", ["interpolated", "linear"])
def test_compensation_looks_back_as_far_as_it_is_told(
    run_nc: Run, compensation_us: int, latch: str
) -> None:
    """At a steady 10 mm/s the value lies v (delay - compensation) behind the surface."""
    out = run_nc(
        'N10 G01 G90 Z110 F3000\nN20 G100 Z80 F600\n#MSG SYN["A=%f", V.A.MESS.Z]',
        f'[drive.servo]\ndelay_compensation_us = {compensation_us}.0\nlatch = "{latch}"',
        base="probe-z.toml",
    )
    assert out.alarms == []
    expected = 100 - 10 * (DELAY_S - compensation_us * 1e-6)
    assert out.printed("A") == pytest.approx([expected], rel=0, abs=INCREMENT_MM)
