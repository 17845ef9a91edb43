"""Programs and rigs that ship nowhere, each against the geometry of its path and its workpiece."""

import math
from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from kernel.cosim.axis import PlantAxis

Vector = NDArray[np.float64]
Run = Callable[..., Any]
INCREMENT_MM = 10 / 2**20
# Half an increment of rounding, 1 nm of interpolation, 0.5 nm of %f, 0.5 nm of the crossing
ONE_AXIS_MM = INCREMENT_MM / 2 + 2e-6
# Set positions are rounded as well, so the path itself may lie beside the line
PATH_MM = INCREMENT_MM + 2e-6
A_MM_S2 = 1000.0


def starts(x: float, y: float, z: float) -> str:
    """Tables of a rig: where the axes stand first."""
    return "\n".join(
        f"[plant.{name}]\nstart = {{ position_start_mm = {value!r} }}"
        for name, value in zip("xyz", (float(x), float(y), float(z)), strict=True)
    )


def plane(normal: Any, surface_mm: float, more: str = "") -> str:
    """Table of a rig: the workpiece, n.p = surface, n towards free space."""
    x, y, z = (float(c) for c in normal)
    return (
        f"[plant.probe]\nstart = {{ normal_x = {x!r}, normal_y = {y!r}, normal_z = {z!r},"
        f" surface_mm = {float(surface_mm)!r}{more} }}"
    )


def show(*names: str) -> str:
    """Blocks that print variables as name=value."""
    return "\n".join(f'#MSG SYN["{name}=%f", V.A.{name}]' for name in names)


def near(values: list[float], tolerance_mm: float = ONE_AXIS_MM) -> Any:
    """Compare absolutely, in mm."""
    return pytest.approx(values, rel=0, abs=tolerance_mm)


def meets(start: Any, end: Any, normal: Any, surface_mm: float) -> Vector:
    """Where the straight line from start to end meets the plane n.p = surface."""
    p, q, n = (np.asarray(v, dtype=float) for v in (start, end, normal))
    share = (surface_mm - n @ p) / (n @ (q - p))
    assert 0 < share < 1
    point: Vector = p + share * (q - p)
    return point


def turned(a1: float, a2: float, a3: float) -> Vector:
    """Rz(a3) Ry(a2) Rx(a1), right-handed, degrees, element by element."""
    (s1, c1), (s2, c2), (s3, c3) = (
        (math.sin(math.radians(a)), math.cos(math.radians(a))) for a in (a1, a2, a3)
    )
    return np.array(
        [
            [c3 * c2, c3 * s2 * s1 - s3 * c1, c3 * s2 * c1 + s3 * s1],
            [s3 * c2, s3 * s2 * s1 + c3 * c1, s3 * s2 * c1 - c3 * s1],
            [-s2, c2 * s1, c2 * c1],
        ]
    )


# One axis


@pytest.mark.parametrize(
    ("axis", "begin", "wall", "feed"),
    [
        ("X", 30.0, 40.0123456, 1200),
        ("X", 0.3, -0.15, 60),
        ("Y", -8.0, -25.000004, 6000),
        ("Y", -120.0, -111.11111, 333.3),
        ("Z", 250.0, 241.7, 4321),
        ("Z", -3.0, 2.7182818, 600),
        ("Z", 3.0, -2.7182818, 600),
    ],
)
def test_any_axis_in_any_direction_at_any_feed(
    run_nc: Run, axis: str, begin: float, wall: float, feed: float
) -> None:
    towards = 1.0 if wall > begin else -1.0
    normal = {a: -towards if a == axis else 0.0 for a in "XYZ"}
    begins = {a: begin if a == axis else 10.0 for a in "XYZ"}
    target = wall + towards * 15
    rig = starts(*begins.values()) + "\n" + plane(normal.values(), -towards * wall)
    out = run_nc(
        f"N10 G100 {axis}{target} F{feed}\n" + show(f"MESS.{axis}", "MERF.X", "MERF.Y", "MERF.Z"),
        rig,
    )
    assert out.alarms == []
    assert out.printed(f"MESS.{axis}") == near([wall])
    for other in "XYZ":
        assert out.printed(f"MERF.{other}") == [float(other == axis)]


@pytest.mark.parametrize("depth_mm", [1.0, 3.1, 9.0, 16.9, 19.3])
def test_the_edge_may_fall_into_any_part_of_the_motion(run_nc: Run, depth_mm: float) -> None:
    """100 mm/s on 20 mm: speeding up until 5 mm, braking from 15 mm on, 2.5 mm of lag between."""
    wall = 200.0 - depth_mm
    out = run_nc(
        "N10 G100 Z180 F6000\n" + show("MESS.Z"), starts(0, 0, 200) + "\n" + plane((0, 0, 1), wall)
    )
    assert out.printed("MESS.Z") == near([wall])


@pytest.mark.parametrize("feed", [60, 137, 1234.5, 6000])
def test_the_input_delay_moves_the_value_by_v_times_it(run_nc: Run, feed: float) -> None:
    """probe-z.toml has 4 us; the wall is far enough for steady motion (10 time constants)."""
    v = feed / 60
    wall = 130.0 - v * 0.3 - v * v / (2 * A_MM_S2) - 0.00317
    out = run_nc(
        f"N10 G100 Z{wall - 20} F{feed}\n" + show("MESS.Z"),
        plane((0, 0, 1), wall),
        base="probe-z.toml",
    )
    assert out.printed("MESS.Z") == near([wall - v * 4e-6])


def test_no_contact_gives_no_value_and_reading_it_is_an_alarm(run_nc: Run) -> None:
    out = run_nc(
        "N10 G100 Z245 F3000\n" + show("MERF.Z") + "\nN30 " + show("MESS.Z"), plane((0, 0, 1), 200)
    )
    assert out.lines == ["MERF.Z=0.000000"]
    assert out.alarms == [900101]


# Several axes at once


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


# Coordinate systems and shifts


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


# Probe and drive


def test_ball_pretravel_and_delays_add_up_along_the_normal(run_nc: Run) -> None:
    """Approach in -Z to a plane of 30 degrees: the gap closes with v cos 30, latch where

    n.p = d + r - pretravel - v cos 30 (trigger delay + input delay).
    """
    slope, v, wall = math.radians(30), 20.0, 80.0
    normal = (0.0, -math.sin(slope), math.cos(slope))
    more = ", ball_radius_mm = 3.0, pretravel_um = 8, trigger_delay_us = 150"
    rig = starts(0, 10, 110) + "\n" + plane(normal, wall, more)
    out = run_nc(
        f"N10 G100 Z90 F{v * 60}\n" + show("MESS.Z"), rig + "\n[drive.servo]\ninput_delay_us = 25.0"
    )
    closing = v * math.cos(slope)
    latched = wall + 3.0 - 0.008 - closing * 175e-6
    z = (latched + math.sin(slope) * 10) / math.cos(slope)
    assert out.printed("MESS.Z") == near([z])


@pytest.mark.parametrize("filter_us", [0, 1000, 2700])
def test_an_input_filter_delays_the_latch(run_nc: Run, filter_us: int) -> None:
    v, wall = 25.0, 112.0
    out = run_nc(
        f"N10 G100 Z100 F{v * 60}\n" + show("MESS.Z"),
        plane((0, 0, 1), wall) + f"\n[drive.servo]\ninput_filter_us = {filter_us}.0",
        base="probe-z.toml",
    )
    late_mm = v * (4 + filter_us) * 1e-6
    assert out.printed("MESS.Z") == near([wall - late_mm])


@pytest.mark.parametrize("sample_us", [62.5, 400.0])
@pytest.mark.parametrize("wall", [112.0, 111.99931])
def test_a_sampling_drive_latches_its_last_sample(
    run_nc: Run, wall: float, sample_us: float
) -> None:
    """The last sample before the latch is up to v times their distance too early, here too high."""
    v = 25.0
    out = run_nc(
        f"N10 G100 Z100 F{v * 60}\n" + show("MESS.Z"),
        plane((0, 0, 1), wall) + f'\n[drive.servo]\nlatch = "sampled"\nsample_us = {sample_us}',
        base="probe-z.toml",
    )
    (contact,) = out.machine.plant.probes["probe"].contacts
    age_s = (contact.time_ns + 4000) % (sample_us * 1000) / 1e9
    expected = wall + v * (age_s - 4e-6)
    assert out.printed("MESS.Z") == near([expected])
    assert -v * 4e-6 <= expected - wall <= v * sample_us * 1e-6


def test_what_is_latched_is_the_encoder_and_not_the_load(
    run_nc: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The shipped axis is rigid; here its encoder reads 5 um more than the slide."""
    sample = PlantAxis._sample

    def shifted(axis: PlantAxis) -> None:
        sample(axis)
        axis.motion[2] += 5e-6

    monkeypatch.setattr(PlantAxis, "_sample", shifted)
    out = run_nc(
        "N10 G100 Z100 F1200\n" + show("MESS.Z"),
        plane((0, 0, 1), 119.0),
        # The axis stands 5 um beside where the kernel sees it
        "set:Z.getriebe[0].window=100",
        base="probe-z.toml",
    )
    (contact,) = out.machine.plant.probes["probe"].contacts
    assert contact.position_mm["z"] == pytest.approx(119.0, abs=1e-6)
    assert out.printed("MESS.Z") == near([119.005 - 20 * 4e-6])


@pytest.mark.parametrize(("edge", "inverted"), [("POS", "false"), ("NEG", "true")])
@pytest.mark.parametrize("number", [1, 2])
def test_both_edges_and_both_inputs_measure_alike(
    run_nc: Run, edge: str, inverted: str, number: int
) -> None:
    out = run_nc(
        "N10 G100 Z100 F1800\n" + show("MESS.Z"),
        plane((0, 0, 1), 118.765, f", inverted = {inverted}"),
        f"set:Z.kenngr.measure.edge={edge}",
        f"set:Z.kenngr.measure.input={number}",
        base="probe-z.toml",
    )
    assert out.printed("MESS.Z") == near([118.765 - 30 * 4e-6])


@pytest.mark.parametrize(
    ("increments", "lead_mm"), [(2048, 5.0), (65_536, 20.0), (2**23, 5.0), (1_000_000, 12.7)]
)
def test_the_value_is_a_whole_number_of_encoder_increments(
    run_nc: Run, increments: int, lead_mm: float
) -> None:
    wall, step_mm = 121.98765, lead_mm / increments
    # The window must hold what a coarse encoder cannot resolve
    out = run_nc(
        "N10 G100 Z110 F1200\n" + show("MESS.Z"),
        plane((0, 0, 1), wall)
        + f"\n[drive.servo]\nencoder_increments = {increments}\nlead_mm = {lead_mm}\n"
        "input_delay_us = 0.0",
        "set:Z.getriebe[0].window=50",
        base="probe-z.toml",
    )
    (value,) = out.printed("MESS.Z")
    assert abs(value - wall) <= step_mm / 2 + 2e-6
    assert abs(value / step_mm - round(value / step_mm)) * step_mm <= 0.6e-6


@pytest.mark.parametrize(
    ("period_us", "offset_us", "bitrate", "buffer", "kv", "feed_forward"),
    [
        (1000, 600, 1_000_000, 0, 80, 0.0),
        (1000, 600, 1_000_000, 5, 40, 0.5),
        (2000, 600, 1_000_000, 1, 10, 0.0),
        (2000, 1000, 500_000, 0, 40, 0.25),
        (4000, 3000, 500_000, 3, 25, 0.0),
        (4000, 700, 1_000_000, 0, 40, 0.8),
        (750, 380, 1_000_000, 2, 40, 0.0),
    ],
)
def test_value_and_overtravel_on_other_time_bases(
    run_nc: Run,
    period_us: int,
    offset_us: int,
    bitrate: int,
    buffer: int,
    kv: float,
    feed_forward: float,
) -> None:
    """The value knows neither period nor loop; the overtravel is

    v (t_in + U + (1 + n) T) + v²/2a + (1 - f) v/Kv, U the time from the latch to the next SYNC.
    """
    v, period_s = 20.0, period_us * 1e-6
    wall = 130.0 - v * (0.3 + 12 / kv)
    rig = f"""
    [cycle]
    period_us = {period_us}
    cycle_offset_us = {offset_us}
    buffer_cycles = {buffer}
    [segment.can1]
    bitrate = {bitrate}
    [plant.z]
    start = {{ kv = {kv}, feed_forward = {feed_forward} }}
    """
    out = run_nc(
        f"N10 G100 Z{wall - 30} F{v * 60}\n" + show("MESS.Z", "ABS.Z"),
        rig + plane((0, 0, 1), wall),
        base="probe-z.toml",
    )
    assert out.alarms == []
    assert out.printed("MESS.Z") == near([wall - v * 4e-6])
    delay_s = 4e-6 + out.waited_s(out.edge_ns() + 4000, bitrate) + (1 + buffer) * period_s
    over_mm = v * delay_s + v * v / (2 * A_MM_S2) + (1 - feed_forward) * v / kv
    # Exact-stop window 0.1 um and two roundings
    assert wall - out.stand_mm("Z") == pytest.approx(over_mm, abs=1.3e-4)
    assert out.printed("ABS.Z") == pytest.approx([wall - over_mm], abs=3e-5)


def test_a_short_retract_between_two_touches_is_enough(run_nc: Run) -> None:
    """0.2 mm off the surface: the slide is still below it when the block ends, so 50052 comes."""
    shown = show("MESS.Z")
    out = run_nc(
        f"N10 G100 Z90 F1000\n{shown}\nN20 G1 Z100.2 F3000\nN30 G100 Z90 F100\n{shown}",
        "[plant.z]\nstart = { position_start_mm = 102.0 }",
        base="probe-z.toml",
    )
    assert out.alarms == []
    assert len(out.printed("MESS.Z")) == 2


def test_a_run_behind_a_move_of_another_axis_starts_from_its_end(run_nc: Run) -> None:
    """At X -6 the plane of 20 degrees is 6 tan 20 higher; contact 0.04 mm below the start."""
    slope, d = math.radians(20), 90.0
    height = d / math.cos(slope) + 6 * math.tan(slope)
    out = run_nc(
        f"N10 G1 X-6 F6000\nN20 G100 Z80 F1000\n{show('MESS.Z')}",
        starts(0, 0, height + 0.04) + "\n" + plane((math.sin(slope), 0, math.cos(slope)), d),
    )
    assert out.printed("MESS.Z") == near([height], 0.002)
