"""Unseen programs with other probes, drives and time bases."""

import math
from collections.abc import Sequence

import pytest
from unseen_geometry import A_MM_S2, Run, near, plane, show, starts

from axisrig.kernel.cosim.plant.axis import PlantAxis


@pytest.mark.long
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
@pytest.mark.long(but=1)
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
@pytest.mark.long
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


@pytest.mark.long
@pytest.mark.interpreted
def test_what_is_latched_is_the_encoder_and_not_the_load(
    run_nc: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The shipped axis is rigid; here its encoder reads 5 um more than the slide."""
    sample, keep = PlantAxis._sample, PlantAxis._keep

    def shifted(axis: PlantAxis) -> None:
        sample(axis)
        axis.motion[2] += 5e-6

    def all_shifted(axis: PlantAxis, times_ns: Sequence[int], motions: list[list[float]]) -> None:
        for motion in motions:
            motion[2] += 5e-6
        keep(axis, times_ns, motions)

    monkeypatch.setattr(PlantAxis, "_sample", shifted)
    monkeypatch.setattr(PlantAxis, "_keep", all_shifted)
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


@pytest.mark.long
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
@pytest.mark.long(but=1)
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
@pytest.mark.long(but=1)
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


@pytest.mark.long
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


@pytest.mark.long
def test_a_run_behind_a_move_of_another_axis_starts_from_its_end(run_nc: Run) -> None:
    """At X -6 the plane of 20 degrees is 6 tan 20 higher; contact 0.04 mm below the start."""
    slope, d = math.radians(20), 90.0
    height = d / math.cos(slope) + 6 * math.tan(slope)
    out = run_nc(
        f"N10 G1 X-6 F6000\nN20 G100 Z80 F1000\n{show('MESS.Z')}",
        starts(0, 0, height + 0.04) + "\n" + plane((math.sin(slope), 0, math.cos(slope)), d),
    )
    assert out.printed("MESS.Z") == near([height], 0.002)
