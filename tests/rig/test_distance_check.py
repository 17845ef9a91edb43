"""What a rig lacks for distance control, and the limits of kp that `axisrig check` reckons."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from axisrig.bench.campaign.checking import check_file
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.distance.check import (
    age_warnings,
    describe_distance,
    distance_warnings,
)
from axisrig.bench.rig.distance.loops import listed_for, unstable
from axisrig.bench.rig.distance.sensors import sensors_of
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
RATE = "[drive.servo]\npdo_map = "


def settings_of(folder: Path, table: str, *assignments: str, base: str = "distance-z") -> Settings:
    path = folder / "rig.toml"
    text = f'base = "{(RIGS / base).as_posix()}.toml"\n{table}\n'
    path.write_text(text, encoding="utf-8")
    changes = [(parse_assignment(item), as_written) for item in assignments]
    return read_settings(*read_rig(path), changes)


def limits(settings: Settings, lags_s: dict[str, float] | None = None) -> dict[str, float]:
    """Limit of kp by mode, as printed for the first sensor."""
    text = describe_distance(settings, lags_s or {})[0]
    return {mode: float(kp) for kp, mode in re.findall(r"below kp ([\d.]+) +(.+?):", text)}


def unstable_as_listed(settings: Settings, mode: str) -> str | None:
    """What a run with the listed control in a mode would warn of."""
    (sensor,) = sensors_of(settings, "Z")
    return unstable(settings, "Z", sensor, mode, listed_for(settings, "Z").control)


RUNS_AWAY = "distance-z-variable-gap"  # for the cases of the sign table
SILENT = "distance-z-variable-silent"  # for the case of a sensor that stops
WRONG_SIGN = "distance-5axis-sign"  # for the case of a control that runs away
OF_THE_CHANNEL = {
    p.stem for word in ("5axis", "robot") for p in RIGS.glob(f"distance-{word}*.toml")
}
SHIPPED = {path.stem for path in RIGS.glob("distance-*.toml")} - {RUNS_AWAY, SILENT}


def test_the_rig_that_runs_away_is_warned_of() -> None:
    (warning,) = distance_warnings(read_settings(*read_rig(RIGS / f"{RUNS_AWAY}.toml"), []))
    assert "gap in V.E.SENSOR counts with the motor" in warning


def test_strict_refuses_a_rig_for_each_warning_of_it(tmp_path: Path) -> None:
    """Of distance control, and of start values, which are warned of elsewhere."""
    away, bare = RIGS / f"{RUNS_AWAY}.toml", tmp_path / "bare.toml"
    start = "[plant.probe.start]\nsurface = 0.1\n"
    bare.write_text(f'base = "{(RIGS / "probe-z.toml").as_posix()}"\n{start}', encoding="utf-8")
    for rig, words in ((away, "counts with the motor"), (bare, "names no unit and counts in m")):
        assert words in check_file(rig)
        with pytest.raises(UserError, match=words):
            check_file(rig, is_strict=True)
    good = RIGS / "distance-z.toml"
    assert check_file(good, is_strict=True) == check_file(good)


@pytest.mark.parametrize("rig", sorted(SHIPPED - OF_THE_CHANNEL))
def test_the_shipped_rigs_lack_nothing(rig: str) -> None:
    settings = read_settings(*read_rig(RIGS / f"{rig}.toml"), [])
    assert distance_warnings(settings) == age_warnings(settings) == []
    sensor = {"sercos": "S-0-0053", "profidrive": "G2_XIST1"}.get(rig.rpartition("-")[2], "60E4:1")
    assert f"distance control of axis Z: gap on {sensor}" in check_file(RIGS / f"{rig}.toml")


@pytest.mark.parametrize("rig", sorted(OF_THE_CHANNEL - {WRONG_SIGN}))
def test_the_shipped_rigs_with_3d_control_lack_no_sensor(rig: str) -> None:
    """Some of them are wrong on purpose in what the PLC makes of the value, and say so."""
    settings = read_settings(*read_rig(RIGS / f"{rig}.toml"), [])
    assert [w for w in distance_warnings(settings) if "measures along the tool" not in w] == []
    assert "3D distance control of the channel: gap in V.E.SENSOR" in check_file(
        RIGS / f"{rig}.toml"
    )


def test_a_wrong_sign_of_3d_control_is_warned_of() -> None:
    (warning,) = distance_warnings(read_settings(*read_rig(RIGS / f"{WRONG_SIGN}.toml"), []))
    assert "gap in V.E.SENSOR falls when the tool lifts" in warning


def test_a_sensor_without_released_distance_control_is_told_and_no_warning(tmp_path: Path) -> None:
    settings = settings_of(tmp_path, "", "set:Z.lr_param.distance_control_on=0")
    assert distance_warnings(settings) == []
    assert describe_distance(settings, {}) == [
        "axis Z: gap is its second encoder, and distance control is not released (P-AXIS-00328 = 0)"
    ]


def test_a_gain_at_its_limit_is_beyond_it(tmp_path: Path) -> None:
    """kp 2 has a pole at -1 in surface mode: it rings for ever (physics: 1 - kp)."""
    settings = settings_of(tmp_path, "", "set:Z.kenngr.distc.kp=2")
    assert str(unstable_as_listed(settings, SET_POS)).startswith("axis Z: SET_POS")
    assert "SET_POS: UNSTABLE as listed" in describe_distance(settings, {})[0]


TURNED = '[plant.gap.map]\ndistance = { variable = "distance", sign = -1 }'
MAP = """pdo,transmission,inhibit_100us,index,sub,bits,signed,field
RPDO1,1,0,0x6040,0,16,no,controlword
RPDO1,1,0,0x607A,0,32,yes,target
TPDO1,1,0,0x6041,0,16,no,statusword
TPDO1,1,0,0x6064,0,32,yes,actual
"""
PLAIN = """
[cycle]
cycle_offset_us = 600
[channel]
list = "{rigs}/lists/channel.lst"
[segment.can1]
[drive.servo]
encoder_increments = 1_000_000
[axis.Z]
list = "{rigs}/lists/axis-z-distance.lst"
segment = "can1"
node = 3
drive = "servo"
plant = "z"
[plant.z]
fmu = "AxisRig.Drives.KinematicAxis"
"""


def test_a_rig_without_a_sensor(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text('title = "x"\n' + PLAIN.format(rigs=RIGS.as_posix()), encoding="utf-8")
    (warning,) = distance_warnings(read_settings(*read_rig(path), []))
    assert "no sensor gives it a distance: name a distance sensor as encoder_2" in warning
    assert "310029" in warning
    assert f"warning: {warning}" in check_file(path)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ('[axis.Z]\nencoder_2 = "load"', "encoder_2 = load is a scale"),
        (RATE + '"map.csv"', "the mapping table of drive servo does not map 60E4:1"),
        (
            '[axis.Z]\nencoder_2 = "other"\n[plant.other]\nfmu = "AxisRig.Sensors.DistanceSensor"\n'
            'wire = { z = "y" }\n[plant.y]\nfmu = "AxisRig.Drives.KinematicAxis"\n',
            "the sensor other on 60E4:1, TPDO4 with every SYNC is not wired to z",
        ),
        ("[drive.servo]\nlead_mm = 5.0", "every distance is 2 times what it is"),
    ],
)
def test_what_is_missing_or_does_not_fit(tmp_path: Path, table: str, words: str) -> None:
    (tmp_path / "map.csv").write_text(MAP)
    (warning,) = distance_warnings(settings_of(tmp_path, table))
    assert words in warning


@pytest.mark.parametrize(
    ("table", "inverts", "base", "warns"),
    [
        ("", 1, "distance-z", False),
        ("", 0, "distance-z", True),
        (
            '[plant.gap.map]\ndistance = { variable = "distance", sign = -1 }',
            0,
            "distance-z",
            False,
        ),
        ('[plant.gap.map]\ndistance = { variable = "distance", sign = -1 }', 1, "distance-z", True),
        ('[plc]\n"V.E.SENSOR" = { sign = 1 }', 1, "distance-z-variable", True),
    ],
)
def test_signs_that_cannot_converge(
    tmp_path: Path, table: str, inverts: int, base: str, warns: bool
) -> None:
    settings = settings_of(tmp_path, table, f"set:Z.lr_hw[1].vz_istw={inverts}", base=base)
    found = [text for text in distance_warnings(settings) if "wrong sign" in text]
    assert len(found) == warns
    assert any("run away until 70330" in t for t in describe_distance(settings, {})) is warns


def test_a_drive_type_without_distance_control(tmp_path: Path) -> None:
    text = (RIGS / "lists" / "axis-z-distance.lst").read_text()
    other = re.sub(r"(kenngr.antr_typ +)8", r"\g<1>4", text)
    (tmp_path / "z.lst").write_text(other)
    stand_in = "[drive.servo]\nas_canopen = true\n"
    settings = settings_of(tmp_path, stand_in + '[axis.Z]\nlist = "z.lst"')
    assert [alarm.id for alarm in settings.warnings] == [110547]
    assert distance_warnings(settings) == []
    assert "warning: ID 110547" in check_file(tmp_path / "rig.toml")


@pytest.mark.parametrize(
    ("assignments", "table", "dead", "expected"),
    [
        # physics: 2 sin(pi/(2(2n+1))) without filter, mean of N: 2N sin2(w/2)/sin(Nw/2)
        (["n_cycles=1"], "", "n = 2:", 0.618),
        (["n_cycles=1", "optimized_scheduling=1"], "", "n = 1:", 1.0),
        ([], "", "n = 2:", 0.431),
        (["optimized_scheduling=1"], "", "n = 1:", 0.619),
        (["n_cycles=20"], "[drive.servo]\nsecond_delay_cycles = 1", "n = 3:", 0.156),
        ([], "[drive.servo]\nsecond_delay_cycles = 1", "n = 3:", 0.333),
    ],
)
def test_dead_cycles_and_limit_of_constant_distance(
    tmp_path: Path, assignments: list[str], table: str, dead: str, expected: float
) -> None:
    settings = settings_of(tmp_path, table, *(f"set:Z.kenngr.distc.{a}" for a in assignments))
    assert dead in describe_distance(settings, {})[0]
    assert limits(settings)["CONST_DIST"] == pytest.approx(expected, rel=0, abs=0.0006)


def test_default_gain_and_filter_are_unstable_in_constant_distance_only(tmp_path: Path) -> None:
    settings = settings_of(tmp_path, "", "set:Z.kenngr.distc.kp=1.0")
    assert distance_warnings(settings) == []  # whether anybody uses it only a run shows
    assert unstable_as_listed(settings, SET_POS) is None
    warning = str(unstable_as_listed(settings, CONST_DIST))
    assert warning.startswith("axis Z: CONST_DIST by gap on 60E4:1, TPDO4 with every SYNC is unst")
    assert "with kp 1 (P-AXIS-00759): its limit is 0.431 with 2 dead cycles" in warning
    (text,) = describe_distance(settings, {})
    assert "SET_POS: stable as listed" in text
    assert "CONST_DIST: UNSTABLE as listed" in text


def test_the_filter_that_acts_decides_not_the_listed_one(tmp_path: Path) -> None:
    """A mean of 20 has its limit at 0.17 with two dead cycles, no filter at 0.618."""
    for listed, acting, is_right in ((1, 20, False), (20, 1, True), (1, 1, True), (20, 20, False)):
        settings = settings_of(tmp_path, "", f"set:Z.kenngr.distc.n_cycles={listed}")
        (sensor,) = sensors_of(settings, "Z")
        control = replace(listed_for(settings, "Z").control, kp=0.4, count=acting)
        warning = unstable(settings, "Z", sensor, CONST_DIST, control)
        assert (warning is None) is is_right, (listed, acting)


@pytest.mark.parametrize(("v_max", "rings"), [(10000, True), (300, False)])
def test_limits_that_may_make_a_stable_loop_ring(tmp_path: Path, v_max: int, rings: bool) -> None:
    """The sample set of the manual: 10 mm/s, 100 mm/s2, kp 0.3, 1 ms: 0.47 mm too far."""
    values = {"kp": 0.3, "a_max": 100, "v_max": v_max}
    items = [f"set:Z.kenngr.distc.{name}={value}" for name, value in values.items()]
    items.append("distance:limiter=clamp")
    (text,) = describe_distance(settings_of(tmp_path, "", *items), {})
    assert "CONST_DIST: stable as listed" in text
    assert "a_max T/kp = 0.3333 mm/s" in text
    assert ("they may make it ring" in text) is rings
    assert ("0.467 mm too far" in text) is rings
    # An adaptive acceleration whose a_min is above a_max raises nothing: 500 mm/s2 by default
    larger = [*items, "set:Z.kenngr.distc.use_adaptive_acceleration=1"]
    (text,) = describe_distance(settings_of(tmp_path, "", *larger), {})
    assert "a_max T/kp = 0.3333 mm/s" in text
    # Near the surface an adaptive acceleration is the smaller one: 20 mm/s2, (v - a T/kp)^2/2a
    items += [f"set:Z.kenngr.distc.{item}" for item in ("use_adaptive_acceleration=1", "a_min=20")]
    (text,) = describe_distance(settings_of(tmp_path, "", *items), {})
    assert "a_max T/kp = 0.06667 mm/s" in text
    assert ("2.47 mm too far" if rings else "0.00136 mm too far") in text


def test_a_slope_goes_past_by_what_the_error_is_late(tmp_path: Path) -> None:
    """v_max T (n + delay of the filter) = 10 x 1 ms x (2 + 1.5); behind a ramp by v^2/2a."""
    values = {"kp": 0.3, "a_max": 100, "v_max": 10000}
    items = [f"set:Z.kenngr.distc.{name}={value}" for name, value in values.items()]
    (text,) = describe_distance(settings_of(tmp_path, "", *items), {})
    assert "Past a far surface by 0.035 mm in CONST_DIST, whose error is 3.5 cycles old" in text
    assert "behind one that rises with v_max by 0.5 mm" in text
    assert "ring" not in text
    adaptive = ("use_adaptive_acceleration=1", "a_min=20")
    items += [f"set:Z.kenngr.distc.{item}" for item in adaptive]
    (text,) = describe_distance(settings_of(tmp_path, "", *items), {})
    assert "behind one that rises with v_max by 2.5 mm" in text


@pytest.mark.parametrize(
    ("choices", "words"),
    [
        ([], "derivative of the feedback, Tv/T in a cycle; limiter slope"),
        (
            ["distance:derivative_of=error", "distance:derivative=per_cycle"],
            "derivative of the error, Tv in a cycle; limiter slope",
        ),
        (["distance:limiter=clamp"], "Tv/T in a cycle; limiter clamp"),
    ],
)
def test_the_law_that_the_rig_has_chosen_is_shown(
    tmp_path: Path, choices: list[str], words: str
) -> None:
    (text,) = describe_distance(settings_of(tmp_path, "", *choices), {})
    assert words in text


def test_a_choice_that_there_is_not_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="'slope' or 'clamp'"):
        settings_of(tmp_path, "", "distance:limiter=ramp")
    with pytest.raises(UserError, match="no such key"):
        settings_of(tmp_path, "", "distance:limit=slope")


def test_the_limit_of_kp_knows_the_derivative(tmp_path: Path) -> None:
    """12.8.3: SET_POS is stable up to 2, or with a derivative of the error to 2/(1 + 2 x 10)."""
    items = [f"set:Z.kenngr.distc.{item}" for item in ("kp=0.3", "d_tv=0.01", "n_cycles=20")]
    items.append("set:Z.kenngr.distc.filter_type=MOVING_AVERAGE")
    found = limits(settings_of(tmp_path, "", *items))
    assert found["SET_POS"] == pytest.approx(2.0, rel=1e-3)
    assert found["CONST_DIST"] == pytest.approx(0.233, rel=2e-3)
    of_error = limits(settings_of(tmp_path, "", *items, "distance:derivative_of=error"))
    assert of_error["SET_POS"] == pytest.approx(2 / 21, rel=1e-3)
    assert of_error["CONST_DIST"] == found["CONST_DIST"]
    per_cycle = limits(settings_of(tmp_path, "", *items, "distance:derivative=per_cycle"))
    assert per_cycle["CONST_DIST"] == pytest.approx(0.178, rel=5e-3)


# Cycles of a real control


@pytest.mark.parametrize(("delay", "optimised"), [(4, 0), (0, 0), (10, 1), (2, 1)])
def test_two_parameters_about_cycles_are_shown_and_change_no_dead_cycle(
    tmp_path: Path, delay: int, optimised: int
) -> None:
    items = [
        f"set:Z.antr.nbr_delay_cycles={delay}",
        f"set:Z.lr_param.field_bus_allows_optimized_schedule={optimised}",
    ]
    settings = settings_of(tmp_path, "", *items)
    (text,) = describe_distance(settings, {})
    assert f"P-AXIS-00191 = {delay}, P-AXIS-00276 = {optimised}: of the displayed lag" in text
    assert "dead cycles  n = 2" in text
    assert limits(settings) == limits(settings_of(tmp_path, ""))


def test_a_lag_of_the_drive_lowers_the_limit(tmp_path: Path) -> None:
    settings = settings_of(tmp_path, "", base="distance-z-servo")
    assert limits(settings, {"Z": 0.025})["CONST_DIST"] < 0.3 < limits(settings)["CONST_DIST"]
    text = check_file(RIGS / "distance-z-servo.toml", ["plant:z.feed_forward=0"])
    assert "lags by 25 ms" in text
    assert "CONST_DIST: not known as listed" in text
    assert "SET_POS: stable as listed" in text


def test_a_value_with_every_second_sync(tmp_path: Path) -> None:
    """Below the limit of a value with every SYNC and above that of one that is always older."""
    settings = settings_of(tmp_path, "", base="distance-z-every-second")
    assert "n = 2 to 3" in describe_distance(settings, {})[0]
    assert 0.333 < limits(settings)["CONST_DIST"] < 0.431


EVENT = "TPDO4,254,10,0x60E4,1,32,yes,second\n"


@pytest.mark.parametrize(
    ("table", "base", "sensor"),
    [
        (RATE + '"event.csv"', "distance-z", "gap on 60E4:1, TPDO4 when it changes"),
        ('[plc]\n"V.E.OTHER" = { sensor = "gap" }', "distance-z", "gap in V.E.OTHER"),
    ],
)
def test_a_sensor_without_an_age_is_told_by_check(
    tmp_path: Path, table: str, base: str, sensor: str
) -> None:
    (tmp_path / "event.csv").write_text(MAP + EVENT)
    settings = settings_of(tmp_path, table, base=base)
    (warning,) = age_warnings(settings)
    assert warning.startswith(f"axis Z: {sensor} promises no time for its next value")
    text = check_file(tmp_path / "rig.toml")
    assert f"warning: {warning}" in text
    assert "silence      not noticed" in text


@pytest.mark.parametrize(
    ("table", "base", "words"),
    [
        ("", "distance-z", "every 1 ms is promised; control freezes when it is older than 3 ms"),
        ("", "distance-z-every-second", "every 2 ms is promised; .* older than 6 ms"),
        ("", "distance-z-event", "every 10 ms is promised; .* older than 30 ms"),
        ("[axis.Z]\nsensor_age_limit_ms = 12.5", "distance-z", "older than 12.5 ms"),
        ('[plc]\n"V.E.SENSOR" = { period_ms = 4 }', "distance-z-variable", "older than 12 ms"),
    ],
)
def test_the_age_of_a_sensor_and_its_limit(
    tmp_path: Path, table: str, base: str, words: str
) -> None:
    message = describe_distance(settings_of(tmp_path, table, base=base), {})
    assert any(re.search(words, text) for text in message)


@pytest.mark.parametrize(("row", "words"), [
    ("TPDO4,1,0,10,0x60E4,1,32,yes,second\n", "event_ms"),
    ("TPDO4,254,10,70000,0x60E4,1,32,yes,second\n", "event_ms"),
])  # fmt: skip
def test_an_event_timer_is_for_event_driven_telegrams(tmp_path: Path, row: str, words: str) -> None:
    lines = [line.split(",") for line in MAP.splitlines()]
    with_timer = [
        [*line[:3], "event_ms" if n == 0 else "", *line[3:]] for n, line in enumerate(lines)
    ]
    (tmp_path / "map.csv").write_text("\n".join(",".join(c) for c in with_timer) + "\n" + row)
    with pytest.raises(UserError, match=words):
        check_file_of(tmp_path)


def check_file_of(folder: Path) -> None:
    distance_warnings(settings_of(folder, RATE + '"map.csv"'))


# ---- 3D control

THREE_D = "set:channel.configuration.decoder.function=FCT_3D_DIST_CTRL"
ALONE = (THREE_D, "set:Z.lr_param.distance_control_on=0", "set:channel.dist_ctrl[0].a_max=100")


def test_3d_control_wants_the_distance_itself(tmp_path: Path) -> None:
    (warning,) = distance_warnings(settings_of(tmp_path, "", *ALONE, base="distance-z-variable"))
    assert "V.E.SENSOR falls when the tool lifts" in warning
    assert "with sign in [plc] as it is the control runs away" in warning
    assert distance_warnings(settings_of(tmp_path, "", *ALONE, base=RUNS_AWAY)) == []


def test_3d_control_wants_a_variable(tmp_path: Path) -> None:
    (warning,) = distance_warnings(settings_of(tmp_path, "", *ALONE))
    assert "no entry of [plc] reads a distance sensor" in warning


def test_where_an_axis_has_its_own_control_the_variable_may_be_for_it(tmp_path: Path) -> None:
    settings = settings_of(tmp_path, "", THREE_D, base="distance-z-variable")
    assert distance_warnings(settings) == []
