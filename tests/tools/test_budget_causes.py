"""Which causes of a budget are on in a rig, and what switches each off (`causes.csv`)."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.budget.causes import (
    Active,
    active_causes,
    has_finer_encoder,
    increment_of_value_um,
    measuring_axis,
    probe_of,
    terminal_probe,
)
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def causes_of(
    rig: str, *assignments: str, latched: bool = True, inputs: dict[str, str] | None = None,
    **more: Any,
) -> dict[str, Active]:  # fmt: skip
    """Causes that are on, by their names."""
    settings = settings_of(RIGS / f"{rig}.toml", assignments)
    case: Any = SimpleNamespace(inputs=inputs or {})
    found = active_causes(case, settings, "Z", latched, **more)
    return {each.cause.cause: each for each in found}


def new(rig: str, *assignments: str, **more: Any) -> dict[str, Active]:
    """Those that are on with the assignments and not without them."""
    base = causes_of(rig, **more)
    return {
        name: each
        for name, each in causes_of(rig, *assignments, **more).items()
        if name not in base
    }


def test_a_plain_rig_has_what_it_says() -> None:
    """Its input delay, and increments of 10 mm/2^20 that 2^26 take away."""
    found = causes_of("probe-z")
    assert list(found) == ["input", "encoder"]
    assert (found["input"].value, found["input"].setting) == ("4", "input_delay_us 4")
    assert dict(found["input"].off) == {"drive:servo.input_delay_us": "0"}
    assert found["encoder"].value == "1048576"
    assert dict(found["encoder"].off) == {"drive:servo.encoder_increments": str(2**26)}


ON_DRIVE = [
    ("plant:probe.pretravel_um=8", "pre-travel", "8", "pretravel 8 um",
     {"plant:probe.pretravel_um": "0"}),
    ("plant:probe.pretravel_mm=0.008", "pre-travel", "8", "pretravel 8 um",
     {"plant:probe.pretravel_um": "0"}),
    ("plant:probe.trigger_delay_us=250", "trigger", "250", "trigger_delay 250 us",
     {"plant:probe.trigger_delay_us": "0"}),
    ("plant:probe.trigger_delay_ms=0.25", "trigger", "250", "trigger_delay 250 us",
     {"plant:probe.trigger_delay_us": "0"}),
    ("plant:probe.bounce_count=3", "bounce", "3", "bounce_count 3",
     {"plant:probe.bounce_count": "0"}),
    ("drive:servo.input_jitter_us=2", "input jitter", "2", "input_jitter_us 2",
     {"drive:servo.input_jitter_us": "0"}),
    ("drive:servo.input_filter_us=50.5", "filter", "50.5", "input_filter_us 50.5",
     {"drive:servo.input_filter_us": "0"}),
    ("drive:servo.delay_compensation_us=4", "compensation", "4", "delay_compensation_us 4",
     {"drive:servo.delay_compensation_us": "0"}),
    ("plant:z.noise_um=0.5", "encoder noise", "0.5", "noise 0.5 um", {"plant:z.noise_um": "0"}),
    ("plant:z.backlash_um=-3", "backlash", "-3", "backlash -3 um", {"plant:z.backlash_um": "0"}),
    ("plant:z.coulomb_friction_n=30", "friction", "30", "coulomb_friction 30 n",
     {"plant:z.coulomb_friction_n": "0", "plant:z.breakaway_friction_n": "0"}),
    ("plant:z.breakaway_friction_n=40", "friction", "0", "breakaway_friction 40 n",
     {"plant:z.coulomb_friction_n": "0", "plant:z.breakaway_friction_n": "0"}),
    ("set:Z.kenngr.probe_actuation_time_delay=7", "dead time", "7",
     "kenngr.probe_actuation_time_delay 7", {"set:Z.kenngr.probe_actuation_time_delay": "0"}),
]  # fmt: skip


@pytest.mark.parametrize(("assignment", "name", "value", "setting", "off"), ON_DRIVE)
def test_what_is_set_in_any_unit_is_a_cause(
    assignment: str, name: str, value: str, setting: str, off: dict[str, str]
) -> None:
    """Value and words in the unit of the table; the columns that switch it off have this unit."""
    (found,) = new("probe-z", assignment).values()
    assert (found.cause.cause, found.value, dict(found.off)) == (name, value, off)
    assert found.setting == setting


@pytest.mark.parametrize(
    "assignment",
    ["plant:probe.pretravel_um=0", "drive:servo.input_jitter_us=0", "plant:z.noise_um=0",
     "plant:z.coulomb_friction_n=0", "set:Z.kenngr.probe_actuation_time_delay=0"],
)  # fmt: skip
def test_what_is_set_to_nothing_is_none(assignment: str) -> None:
    assert new("probe-z", assignment) == {}


def test_the_last_value_of_a_row_wins_over_the_rig() -> None:
    row = ("plant:probe.pretravel_um=8", "plant:probe.pretravel_um=9")
    assert causes_of("probe-z", *row)["pre-travel"].value == "9"
    off = causes_of("probe-z", "drive:servo.input_delay_us=0")
    assert list(off) == ["encoder"]


def test_friction_of_the_model_is_on_where_nobody_sets_it() -> None:
    """Defaults of ServoAxis and ScrewAxis, 120 and 160 N; of other models the keys are others."""
    screw = settings_of(RIGS / "probe-z.toml", [])
    table = screw.rig.plant["z"]
    for fmu, names in (
        ("AxisRig.Drives.ScrewAxis", {"screw friction", "viscous friction"}),
        ("AxisRig.Drives.ServoAxis", {"friction"}),
        ("AxisRig.Drives.KinematicAxis", set()),
        ("own/ScrewAxis.fmu", {"screw friction", "viscous friction"}),
    ):
        bare = table.model_copy(update={"fmu": fmu, "start": {}})
        screw.rig.plant["z"] = bare
        case: Any = SimpleNamespace(inputs={})
        found = {e.cause.cause: e for e in active_causes(case, screw, "Z", True)}
        assert set(found) - {"input", "encoder"} == names
        if "screw friction" in names:
            assert found["screw friction"].value == "120"
            assert dict(found["screw friction"].off) == {
                "plant:z.friction.coulomb_n": "0", "plant:z.friction.breakaway_n": "0",
            }  # fmt: skip
            assert found["viscous friction"].value == "800"
            assert dict(found["viscous friction"].off) == {"plant:z.friction.viscous_n_s_m": "0"}


def test_a_latch_that_samples_is_on_and_an_interpolated_one_is_not() -> None:
    (found,) = new("probe-z", "drive:servo.latch=sampled").values()
    assert (found.cause.cause, found.value) == ("sampling", "sampled")
    assert dict(found.off) == {"drive:servo.latch": "interpolated"}
    assert new("probe-z", "drive:servo.latch=interpolated") == {}


@pytest.mark.parametrize(
    ("increments", "farthest_mm", "off"),
    [
        (2**20, 0.0, 2**26),
        (2**20, 159.9, 2**26),  # twice 159.9 mm of 10 mm/2^26 are below 2^31
        (2**20, 160.0, 2**25),
        (2**20, 320.0, 2**24),
        (2**20, 1e9, 2**20),  # not coarser than it is
    ],
)
def test_finer_increments_reach_as_far_as_the_axis_has_been(
    increments: int, farthest_mm: float, off: int
) -> None:
    """32 bits with a sign: 2^31 increments on either side, of which half are kept free."""
    found = causes_of("probe-z", farthest_mm=farthest_mm).get("encoder")
    if off == increments:
        assert found is None
    else:
        assert found is not None
        assert dict(found.off) == {"drive:servo.encoder_increments": str(off)}


def test_faults_of_the_row_are_a_cause_of_their_own() -> None:
    inputs = {"fault:Z.TPDO1": "drop@5", "plc:V.E.X": "1", "fault:probe": "stick@9"}
    found = causes_of("probe-z", inputs=inputs)["PDO"]
    assert dict(found.off) == {"fault:Z.TPDO1": None, "fault:probe": None}
    assert found.setting == "fault:Z.TPDO1 drop@5, fault:probe stick@9"
    assert "PDO" not in causes_of("probe-z", inputs={"plc:V.E.X": "1"})


# A signal at the PLC


def test_of_a_signal_at_the_plc_the_chain_counts_and_not_the_input_of_the_drive() -> None:
    """The rig has a task of 2 ms."""
    at_plc = causes_of("plc-signal", latched=False)
    assert not {"input", "filter", "sampling"} & set(at_plc)
    period = at_plc["PLC cycle"]
    assert dict(period.off) == {"plc:period_us": "50", "plc:busy_us": "0"}
    assert period.value == "2000"
    latched = causes_of("plc-signal", latched=True)
    assert not {"PLC cycle", "terminal cycle"} & set(latched)
    assert "input" in latched


def test_what_acts_on_an_input_counts_without_a_latch_and_what_acts_on_one_does_not() -> None:
    """The PLC reads 60FD of the drive: delay, jitter and filter act; it has no latch."""
    rig = "plc-drive-input"
    for key, value, name in (
        ("input_delay_us", "9", "input"), ("input_jitter_us", "2", "input jitter"),
        ("input_filter_us", "50", "filter"),
    ):  # fmt: skip
        found = causes_of(rig, f"drive:servo.{key}={value}", latched=False)[name]
        assert (found.value, dict(found.off)) == (value, {f"drive:servo.{key}": "0"})
    for assignment in ("drive:servo.latch=sampled", "drive:servo.delay_compensation_us=4"):
        assert new(rig, assignment, latched=False) == {}
        assert len(new(rig, assignment, latched=True)) == 1


@pytest.mark.parametrize(
    ("assignment", "name", "off"),
    [
        ("plc:terminal.filter_us=100", "terminal filter", {"plc:terminal.filter_us": "0"}),
        ("plc:terminal.stamp_edge=last", "stamp edge", {"plc:terminal.stamp_edge": "first"}),
        ("plc:terminal.stamp_jitter_ns=10", "stamp jitter", {"plc:terminal.stamp_jitter_ns": "0"}),
        ("plc:clock_offset_ns=500", "clock offset", {"plc:clock_offset_ns": "0"}),
        ("plc:clock_drift_ppm=2", "clock drift", {"plc:clock_drift_ppm": "0"}),
    ],
)
def test_what_a_terminal_adds_is_there_without_a_latch_alone(
    assignment: str, name: str, off: dict[str, str]
) -> None:
    (found,) = new("plc-timestamp", assignment, latched=False).values()
    assert (found.cause.cause, dict(found.off)) == (name, off)
    assert new("plc-timestamp", assignment, latched=True) == {}


def test_a_clock_that_the_cnc_knows_is_none_and_one_that_it_knows_wrongly_is() -> None:
    both = ("plc:clock_offset_ns=500", "plc:assumed_offset_ns=500")
    assert new("plc-timestamp", *both, latched=False) == {}
    wrong = new("plc-timestamp", "plc:assumed_offset_ns=500", latched=False)["clock offset"]
    assert (wrong.value, dict(wrong.off)) == ("0", {"plc:clock_offset_ns": "500"})


def test_the_position_that_is_handed_over_is_of_external_hardware_alone() -> None:
    rig, handed = "plc-external", "plc:V.E.POSITION=1"
    found = new(rig, handed, latched=False, is_external=True)["handed-over position"]
    assert (found.value, found.setting) == ("1", "V.E.POSITION 1")
    assert dict(found.off) == {"plc:V.E.POSITION": "0"}
    assert new(rig, handed, latched=False, is_external=False) == {}
    assert new(rig, "plc:V.E.POSITION=0", latched=False, is_external=True) == {}


# A line of EtherCAT


def test_the_clocks_of_a_line_count_where_the_terminal_is_on_it() -> None:
    rig = "plc-timestamp-ethercat"
    assert not {"line delay", "line drift"} & set(causes_of(rig, latched=False))
    for key, name in (("delay_compensation", "line delay"), ("drift_compensation", "line drift")):
        on_line = new("plc-timestamp-line", f"bus:ec1.{key}=false", latched=False)
        assert list(on_line) == [name]
        assert (on_line[name].value, dict(on_line[name].off)) == (
            "false",
            {f"bus:ec1.{key}": "true"},
        )
        assert new("plc-timestamp-line", f"bus:ec1.{key}=false", latched=True) == {}
        assert new(rig, f"bus:ec1.{key}=false", latched=False) == {}  # its terminal is elsewhere
        assert new(rig, f"bus:ec1.{key}=true", latched=False) == {}


def test_samples_are_a_cause_where_the_cnc_assumes_others() -> None:
    rig, name = "plc-timestamp-line", "assumed sampling"
    (found,) = new(rig, "bus:ec1.assumed_sample_us=70", latched=False).values()
    assert (found.cause.cause, found.value) == (name, "70")
    (column,) = found.off
    assert column == "bus:ec1.assumed_sample_us"
    same = ("bus:ec1.assumed_sample_us=70", "bus:ec1.sample_us=70")
    assert name not in causes_of(rig, *same, latched=False)


# Which axis, which probe, which increment


def test_the_measuring_axis_is_the_one_with_a_probe() -> None:
    one = settings_of(RIGS / "probe-z.toml", [])
    assert measuring_axis(one, None) == measuring_axis(one, "Z") == "Z"
    with pytest.raises(UserError, match="which axis has the measured value"):
        measuring_axis(one, "Q")
    several = settings_of(RIGS / "probe-xyz.toml", [])
    with pytest.raises(UserError, match="which axis") as refused:
        measuring_axis(several, None)
    assert refused.value.hint == "--axis X"
    assert measuring_axis(several, "Y") == "Y"
    without = settings_of(RIGS / "fixed-stop-xy.toml", [])
    with pytest.raises(UserError, match="no axis of the rig has a probe"):
        measuring_axis(without, None)


def test_the_probe_of_an_axis_is_at_its_input_or_at_the_terminal() -> None:
    by_drive = settings_of(RIGS / "probe-z.toml", [])
    assert (probe_of(by_drive, "Z"), terminal_probe(by_drive)) == ("probe", None)
    at_plc = settings_of(RIGS / "plc-signal.toml", [])
    assert (probe_of(at_plc, "Z"), terminal_probe(at_plc)) == ("probe", "probe")


@pytest.mark.parametrize(
    ("rig", "um", "is_finer"),
    [
        ("probe-z", 10_000 / 2**20, True),
        ("probe-z-sercos", 10_000 / 2**20, False),  # the default of its resolution
        ("probe-z-profidrive", 10_000 / (2048 << 11), False),  # lines and fine bits, P1042
        ("probe-z-lightbus", 1.0, False),  # LATCH32 counts um (docs/drives)
    ],
)
def test_the_increment_of_a_value_is_of_what_its_drive_latches(
    rig: str, um: float, is_finer: bool
) -> None:
    """A turn is 10 mm."""
    settings = settings_of(RIGS / f"{rig}.toml", [])
    assert increment_of_value_um(settings, "Z") == pytest.approx(um)
    assert has_finer_encoder(settings, "Z") is is_finer
    assert ("encoder" in causes_of(rig)) is is_finer
