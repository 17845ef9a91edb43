"""What is asked of a drive of any family: scale, reach, instants of its latch; by its keys.

2^31 increments on either side are the reach of a position of 32 bits. A latch looks at samples from
one period before the edge on, moved by what the drive compensates and by delay and filter.
"""

from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.rig.sercos.keys import DriveTable
from axisrig.kernel.nc.coordinates.circle import CircleLimits
from axisrig.kernel.time.clock import US

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
BASES = {
    "canopen": "probe-z.toml",
    "sercos": "probe-z-sercos.toml",
    "profidrive": "probe-z-profidrive.toml",
    "conventional": "probe-z-conventional.toml",
    "encoder_terminal": "probe-z-encoder-terminal.toml",
    "lightbus": "probe-z-lightbus.toml",
}


def drive(family: str, *keys: str) -> Any:
    changes = [f"drive:servo.{key}" for key in keys]
    return settings_of(RIGS / BASES[family], changes).rig.drive["servo"]


PER_TURN: dict[tuple[str, ...], Fraction | int] = {
    ("canopen", "encoder_increments=4096"): 4096,
    # Of the bus, in the place of increments
    ("canopen", "encoder_increments=4096", "position_unit_um=0.5"): 10_000,
    ("sercos", "resolution=1048576"): 1 << 20,
    ("sercos", "resolution=65536"): 1 << 16,
    ("sercos", "scaling=linear"): 50_000,  # of 0.1 um
    ("sercos", "scaling=linear", "idents=S-0-0078=-6"): 5_000,  # S-0-0077 x 10^-6 m
    ("profidrive", "lines=512", "p1042=9"): 512 << 9,
    ("conventional", "lines=500"): 2000,
    ("encoder_terminal", "lines=500"): 2000,
    ("lightbus",): 1 << 20,
}


@pytest.mark.parametrize("given", PER_TURN, ids=" ".join)
def test_positions_are_units_of_a_turn_of_the_screw(given: tuple[str, ...]) -> None:
    """5 mm a turn."""
    family, *keys = given
    facts = drive(family, "lead_mm=5", *keys).facts()
    assert facts.units_per_mm == Fraction(PER_TURN[given]) / 5
    assert facts.lead_mm == 5.0
    if not any(key.startswith("position_unit") for key in keys):
        assert facts.reach_mm == pytest.approx(float(2**31 / facts.units_per_mm))


@pytest.mark.parametrize("family", BASES)
def test_the_instants_of_a_latch_are_those_of_its_keys(family: str) -> None:
    """Delay 7 us, filter 11 us, jitter 3 us, 40 us compensated, samples of 125 us."""
    keys = ("input_delay_us=7", "input_filter_us=11", "input_jitter_us=3",
            "delay_compensation_us=40", "rated_torque_mnm=2500")  # fmt: skip
    exact = drive(family, *keys, "latch=interpolated", "sample_us=125").facts()
    assert exact.latch == LatchTimes(18 * US, 40 * US, 0, 3 * US)
    assert (exact.look_back_ns, exact.look_ahead_ns) == (22 * US, 21 * US)
    assert exact.rated_torque_mnm == 2500
    sampled = drive(family, *keys, "latch=sampled", "sample_us=125").facts()
    assert sampled.latch == LatchTimes(18 * US, 40 * US, 125 * US, 3 * US)
    assert (sampled.look_back_ns, sampled.look_ahead_ns) == ((125 + 22) * US, 21 * US)
    linear = drive(family, *keys, "latch=linear", "sample_us=125").facts()
    assert linear.latch == LatchTimes(18 * US, 40 * US, 0, 3 * US)
    assert (linear.look_back_ns, linear.look_ahead_ns) == ((125 + 22) * US, (21 + 125) * US)


@pytest.mark.parametrize("family", ["canopen", "sercos", "profidrive"])
def test_a_second_encoder_is_as_old_as_its_key_says(family: str) -> None:
    assert drive(family, "second_delay_cycles=2").facts().second_delay_cycles == 2


@pytest.mark.parametrize("family", ["conventional", "encoder_terminal", "lightbus"])
def test_a_drive_that_only_takes_a_speed_has_the_scale_of_its_output(family: str) -> None:
    """1200 rpm of 5 mm are 100 mm/s at 32767, the largest of 16 bits with a sign."""
    rpm = "rpm_at_full=1200" if family == "lightbus" else "rpm_at_10v=1200"
    table = drive(family, "lead_mm=5", rpm, "watchdog_cycles=9")
    made = table.make()
    assert table.full_mm_s == 100
    assert made.speed_m_s == Fraction(1, 10) / 32767
    assert (made.rpm_at_full, made.watchdog_cycles) == (1200.0, 9)
    assert table.output == (made.output_bits, made.output_offset) == (16, 0)
    assert [made.given_out(counts) for counts in (1, -1, 32767)] == [1, -1, 32767]
    assert table.facts().second_delay_cycles == 0


@pytest.mark.parametrize("family", ["conventional", "encoder_terminal"])
def test_an_analogue_output_has_fewer_bits_and_an_offset(family: str) -> None:
    """12 bits: steps of 16 counts, cut off towards below; 5 counts are there at 0."""
    made = drive(family, "output_bits=12", "output_offset=5").make()
    assert [made.given_out(counts) for counts in (0, 15, 16, -1)] == [5, 5, 21, -11]


@pytest.mark.parametrize(
    ("variable", "in_turn", "per_mm"),
    [("LATCH32", False, Fraction(1000)), ("LATCH16", True, Fraction(1 << 16, 5))],
)
def test_a_latched_value_of_lightbus_counts_um_or_parts_of_a_turn(
    variable: str, in_turn: bool, per_mm: Fraction
) -> None:
    table = drive("lightbus", "lead_mm=5", f"latch_variable={variable}")
    assert (table.is_in_turn, table.latch_per_mm) == (in_turn, per_mm)
    assert table.facts().latch_per_mm == per_mm


@pytest.mark.parametrize(
    ("keys", "proves"),
    [
        ((), True),
        (("position_check=false",), False),
        (("p1043=10",), False),  # the absolute position is coarser than G1_XIST1
        (("p1042=10", "p1043=10"), True),
    ],
)
def test_a_profidrive_position_is_proved_where_both_have_the_same_fine_bits(
    keys: tuple[str, ...], proves: bool
) -> None:
    assert drive("profidrive", *keys).proves_places is proves


def test_a_profidrive_drive_is_made_of_its_own_parameters() -> None:
    keys = ("telegram=105", "p0660=80", "p0880=3000", "p0925=4", "p1042=8", "p1043=10",
            "p1230=1500", "p0881=40", "lead_mm=5")  # fmt: skip
    made = drive("profidrive", *keys).make()
    assert made.telegram.number == 105
    assert (made.p0660, made.p0880_rpm, made.p0925, made.p1042) == (80, 3000, 4, 8)
    assert (made.p1230, made.p0881, made.absolute_shift) == (1500, 40, 2)
    # 3000 rpm of 5 mm are 0.25 m/s at 2^30
    assert made.speed_m_s == Fraction(1, 4) / 2**30


def test_idents_of_a_cell_take_the_place_of_the_same_idents_and_follow_the_others() -> None:
    """The rig has S-0-0169, 0301, 0305 and 0307, in this order."""
    table = drive("sercos", "idents=S-0-0305=S-0-0410 S-0-0044=0x20 S-0-0169=3")
    assert table.idents == [
        ["S-0-0169", 3], ["S-0-0301", "S-0-0405"], ["S-0-0305", "S-0-0410"],
        ["S-0-0307", "S-0-0401"], ["S-0-0044", 32],
    ]  # fmt: skip
    assert table.start_list[2:] == [(305, 410), (307, 401), (44, 32)]


@pytest.mark.parametrize("family", [name for name in BASES if name != "canopen"])
def test_a_drive_as_canopen_keeps_its_axis_and_its_limits(family: str) -> None:
    """And leaves what its words need."""
    keys = ("lead_mm=5", "input_delay_us=9", "missing_cycles=6", "lag_limit_mm=0.5",
            "jump_factor=3", "fault_reset=true", "as_canopen=true")  # fmt: skip
    assert not drive(family).replaces_others
    table = drive(family, *keys)
    assert (table.family_name, table.replaces_others) == ("canopen", True)
    assert (table.lead_mm, table.input_delay_us, table.missing_cycles) == (5.0, 9.0, 6)
    assert (table.lag_limit_mm, table.jump_factor, table.fault_reset) == (0.5, 3.0, True)


def test_limits_of_circles_are_lengths_and_shares() -> None:
    """P-CHAN-00059 and 00171 in 0.1 um, P-CHAN-00060 and 00172 in 0.1 % of the radius."""
    listed = ("mittelpkt_diff=12000", "mittelpkt_faktor=30", "max_radius_diff_circle=70",
              "max_proz_radius_diff_circle=4")  # fmt: skip
    settings = settings_of(RIGS / "probe-z.toml", [f"set:channel.{one}" for one in listed])
    found = settings.offset_tables.circle
    assert found == CircleLimits(1.2, 0.03, 0.007, 0.004)


START_UP = 'each entry is an ident and its value, ["S-0-0301", "S-0-0405"]'


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ([], START_UP),
        (["S-0-0301"], START_UP),
        (["S-0-0301", "S-0-0405", "S-0-0401"], START_UP),
        ([301, 405], START_UP),
        (["S-0-301x", 1], "S-0-301x"),
        (["S-0-0301", "S-0-405x"], "S-0-405x"),
    ],
)
def test_an_entry_of_a_start_up_list_is_an_ident_and_its_value(
    entry: list[str | int], words: str
) -> None:
    """A number, or an ident again; what is neither is refused with its words."""
    good: list[list[str | int]] = [["S-0-0301", "S-0-0405"], ["P-0-0010", 0], ["S-0-0169", -1]]
    table = DriveTable.model_validate({"family": "sercos", "idents": good})
    assert table.start_list == [(301, 405), ((1 << 15) + 10, 0), (169, -1)]
    with pytest.raises(ValidationError) as caught:
        DriveTable.model_validate({"family": "sercos", "idents": [*good, entry]})
    (error,) = caught.value.errors()
    assert words in error["msg"]
    assert error["loc"] == ("idents", 3)


@pytest.mark.parametrize("key", ["at", "mdt"])
def test_a_telegram_of_a_sercos_drive_is_made_of_idents(key: str) -> None:
    drives = {"family": "sercos", key: ["S-0-0051", "S-0-0130"]}
    assert getattr(DriveTable.model_validate(drives), key) == ["S-0-0051", "S-0-0130"]
    with pytest.raises(ValidationError) as caught:
        DriveTable.model_validate(drives | {key: ["S-0-0051", "6064"]})
    (error,) = caught.value.errors()
    assert error["loc"] == (key, 1)
