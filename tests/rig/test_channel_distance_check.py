"""Checks of the 3D distance control of a channel; limits by the printed formula."""

import math
import re
from pathlib import Path

import pytest

from axisrig.bench.rig.distance.channel import channel_ages, channel_warnings, describe_channel
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, read_settings

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
RIG_NAMES = ("distance-5axis", "distance-5axis-servo", "distance-robot")


def settings_of(
    folder: Path,
    keys: str,
    *lines: str,
    base: str = RIG_NAMES[0],
    of_list: str = "channel-5axis",
    limiter: str = "slope",
    more: str = "",
) -> Settings:
    """A shipped rig with other keys of its variable, and other lines in its channel list."""
    table = f'[plc]\n"V.E.SENSOR" = {{ {keys} }}\n' if keys else ""
    table += f'[distance]\nlimiter = "{limiter}"\n{more}'
    if lines:
        text = (RIGS / "lists" / f"{of_list}.lst").read_text(encoding="utf-8")
        names = [line.split()[0] for line in lines]
        kept = [row for row in text.splitlines() if row.split()[:1] not in [[n] for n in names]]
        (folder / "channel.lst").write_text("\n".join([*kept, *lines, ""]), encoding="utf-8")
        table += '[channel]\nlist = "channel.lst"\n'
    path = folder / "rig.toml"
    text = f'base = "{(RIGS / base).as_posix()}.toml"\n{table}'
    path.write_text(text, encoding="utf-8")
    return read_settings(*read_rig(path), [])


def limit_of_mean(count: int, dead: int) -> float:
    """Kp of CONST_DIST with a mean of `count`: 2 N sin^2(w/2)/sin(N w/2), w = pi/(N + 2 n)."""
    w = math.pi / (count + 2 * dead)
    return 2 * count * math.sin(w / 2) ** 2 / math.sin(count * w / 2)


@pytest.mark.parametrize("lags_s", [(0.03, 0.01), (0.01, 0.03), (0.0, 0.03)])
def test_the_slowest_drive_of_all_counts(tmp_path: Path, lags_s: tuple[float, float]) -> None:
    """A lag makes the loop slower: its limit of kp is that of the slowest alone."""
    settings = settings_of(tmp_path, "", base="distance-5axis-servo")
    (text,) = describe_channel(settings, dict(zip("XZ", lags_s, strict=True)))
    assert "the slowest lags by 30 ms" in text
    assert describe_channel(settings, {"Z": 0.03}) == [text]
    (without,) = describe_channel(settings)
    assert "lags by" not in without


@pytest.mark.parametrize("rig", RIG_NAMES)
def test_the_shipped_rigs_lack_nothing(tmp_path: Path, rig: str) -> None:
    settings = settings_of(tmp_path, "", base=rig)
    assert channel_warnings(settings) == []
    (text,) = describe_channel(settings)
    assert "gap in V.E.SENSOR" in text
    assert "made orthogonal by the tilt that the channel shows" in text
    assert "a value every 1 ms is promised" in text


@pytest.mark.parametrize(
    ("keys", "lines", "count", "dead"),
    [
        ("", (), 4, 2),
        ("", ("dist_ctrl[0].optimized_scheduling 1",), 4, 1),
        ("delay_cycles = 2", (), 4, 4),
        ("", ("dist_ctrl[0].n_cycles 20",), 20, 2),
    ],
)
def test_limit_of_kp_is_that_of_the_closed_form(
    tmp_path: Path, keys: str, lines: tuple[str, ...], count: int, dead: int
) -> None:
    (text,) = describe_channel(settings_of(tmp_path, keys, *lines))
    assert f"n = {dead}:" in text
    (limit,) = re.findall(r"below kp ([\d.]+) +CONST_DIST:", text)
    assert float(limit) == pytest.approx(limit_of_mean(count, dead), rel=5e-4)


@pytest.mark.parametrize(("kp", "verdict"), [("0.42", "stable"), ("0.44", "UNSTABLE")])
def test_a_kp_above_its_limit_is_unstable(tmp_path: Path, kp: str, verdict: str) -> None:
    settings = settings_of(tmp_path, "", f"dist_ctrl[0].kp {kp}")
    assert f"CONST_DIST: {verdict} as listed" in describe_channel(settings)[0]


def test_a_wrong_sign_and_a_wrong_tilt_are_reported(tmp_path: Path) -> None:
    (warning,) = channel_warnings(settings_of(tmp_path, "sign = -1"))
    assert "V.E.SENSOR falls when the tool lifts" in warning
    keys = "tilt_error_deg = 0.5, tilt_delay_cycles = 3"
    (text,) = describe_channel(settings_of(tmp_path, keys))
    assert "3 cycles older than the value, wrong by 0.5 degrees" in text
    (text,) = describe_channel(settings_of(tmp_path, 'normalise = "none"'))
    assert "as the sensor gives it" in text


PLACES = ((60.0, 10.0), (75.0, 10.0), (75.0, -10.0))


def inclined_limits(text: str) -> list[tuple[float, float, float]]:
    """Tilt, slope and limit of kp as printed."""
    found = re.findall(r"([\d.]+) at ([-\d.]+)/([-\d.]+) deg", text)
    return [(float(tilt), float(slope), float(kp)) for kp, tilt, slope in found]


@pytest.mark.parametrize("rig", RIG_NAMES)
def test_the_limit_over_an_inclined_surface_of_a_sensor_along_the_tool(
    tmp_path: Path, rig: str
) -> None:
    """ECS as over a parallel surface; MCS and ACS times 1 + tan p tan b: 0.147 at 75/-10 deg."""
    (text,) = describe_channel(settings_of(tmp_path, "", base=rig))
    limit = limit_of_mean(4, 2)
    expected = [
        (b, p, limit * (1 + math.tan(math.radians(p)) * math.tan(math.radians(b))))
        for b, p in PLACES
    ]
    assert inclined_limits(text) == [pytest.approx(place, rel=5e-4) for place in expected]
    assert expected[-1][-1] == pytest.approx(0.1473, abs=1e-4)
    assert "ECS as above over any surface" in text
    assert "worst" not in text
    assert ("at best all of what follows" in text) is rig.endswith("servo")
    (slope,) = re.findall(r"stable up to p -([\d.]+) deg", text)
    left = 1 - math.tan(math.radians(float(slope))) * math.tan(math.radians(85))
    assert limit * left == pytest.approx(0.2, rel=5e-3)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_one_axis_with_a_loop_of_its_own_is_enough_for_at_best(tmp_path: Path, axis: str) -> None:
    """The others follow without a lag."""
    plain = settings_of(tmp_path, "")
    assert "at best" not in describe_channel(plain)[0]
    servo = f'[plant.{axis}]\nfmu = "AxisRig.Drives.ServoAxis"\nstart = {{ kv = 40 }}\n'
    (text,) = describe_channel(settings_of(tmp_path, "", more=servo))
    assert "  drives       what else their loops add is not counted" in text
    assert "at best all of what follows" in text
    assert re.search(r"at best below kp [\d.]+ +CONST_DIST: not known as listed", text)
    (text,) = describe_channel(settings_of(tmp_path, "", more=servo), {axis.upper(): 0.02})
    assert "the slowest lags by 20 ms" in text


def test_that_of_a_sensor_of_the_orthogonal_distance(tmp_path: Path) -> None:
    (text,) = describe_channel(settings_of(tmp_path, "", base="distance-5axis-orthogonal"))
    limit = limit_of_mean(4, 2)
    expected = [
        (b, p, limit * math.cos(math.radians(b)) / math.cos(math.radians(b - p))) for b, p in PLACES
    ]
    assert inclined_limits(text) == [pytest.approx(place, rel=5e-4) for place in expected]
    (worst,) = re.findall(r"below kp ([\d.]+) +ECS, worst", text)
    assert float(worst) == pytest.approx(limit * math.cos(math.radians(85)), rel=5e-4)


@pytest.mark.parametrize(("v_max", "rings"), [("50000", True), ("2500", False)])
def test_limits_that_may_make_it_ring(tmp_path: Path, v_max: str, rings: bool) -> None:
    """a_max T/kp = 500 mm/s2 x 1 ms/0.2 = 2.5 mm/s; (v - a/K)^2/2a = 47.5^2/1000 = 2.26 mm."""
    line = f"dist_ctrl[0].v_max {v_max}"
    (text,) = describe_channel(settings_of(tmp_path, "", line, limiter="clamp"))
    assert "a_max T/kp = 2.5 mm/s" in text
    assert ("they may make it ring" in text) is rings
    assert ("the law brakes in time" in text) is not rings
    if rings:
        assert "change its speed by 0.5 mm/s in a cycle; after a large step it goes 2.26 mm" in text
        assert "a_max >= 10000 mm/s2, v_max <= 2.5 mm/s or kp <= 0.01" in text


def test_a_slope_goes_past_by_what_the_error_is_late(tmp_path: Path) -> None:
    """50 mm/s x 1 ms x (2 + 1.5), and 50^2/1000 mm behind a surface that rises so."""
    (text,) = describe_channel(settings_of(tmp_path, "", "dist_ctrl[0].v_max 50000"))
    assert "by 0.175 mm in CONST_DIST, whose error is 3.5 cycles old" in text
    assert "behind one that rises with v_max by 2.5 mm" in text
    assert "limiter slope" in text
    assert "P-AXIS-00191 = 2, P-AXIS-00276 = 0: of the displayed lag" in text


def test_what_no_limit_holds_for_is_said(tmp_path: Path) -> None:
    (text,) = describe_channel(settings_of(tmp_path, 'normalise = "none"'))
    assert "the value is not normalised" in text
    (text,) = describe_channel(settings_of(tmp_path, "", base="distance-5axis-electrode"))
    assert "a disc electrode does not give the distance" in text
    wrong = settings_of(tmp_path, 'normalise = "along"', base="distance-5axis-orthogonal")
    assert 'set normalise = "none"' in describe_channel(wrong)[0]


def test_a_channel_without_sensor_is_warned_of_and_one_without_release_is_not(
    tmp_path: Path,
) -> None:
    release = "configuration.decoder.function FCT_3D_DIST_CTRL"
    lines = (release, "dist_ctrl[0].a_max 100")
    released = settings_of(tmp_path, "", *lines, base="distance-z", of_list="channel")
    (warning,) = channel_warnings(released)
    assert "no entry of [plc] reads a distance sensor" in warning
    plain = settings_of(tmp_path, "", base="distance-z")
    assert channel_warnings(plain) == describe_channel(plain) == []


@pytest.mark.parametrize(("tn_s", "is_stable"), [(0.002, False), (0.006, True)])
def test_an_integral_part_that_is_faster_than_the_loop_is_late_leaves_no_kp(
    tmp_path: Path, tn_s: float, is_stable: bool
) -> None:
    """s^2 + kp (s + 1/Tn) e^(-d s) has a stable kp for Tn > d; d = 2 dead cycles and 1.5 of
    the mean of 4, 3.5 ms.
    """
    (text,) = describe_channel(settings_of(tmp_path, "", f"dist_ctrl[0].i_tn {tn_s}"))
    assert ("unstable with any kp     CONST_DIST: UNSTABLE as listed" in text) is not is_stable
    assert bool(re.search(r"stable below kp [\d.]+ +CONST_DIST:", text)) is is_stable
    assert bool(re.search(r"stable below kp [\d.]+ +SET_POS: stable", text))


def test_a_variable_that_nobody_promises_may_fall_silent(tmp_path: Path) -> None:
    """Of two entries the one without a period, and none where 3D control is not released."""
    two = 'sensor = "gap", period_ms = 2.0 }\n"V.E.OTHER" = { sensor = "gap"'
    (text,) = channel_ages(settings_of(tmp_path, two))
    assert "gap in V.E.OTHER promises no time for its next value" in text
    assert channel_ages(settings_of(tmp_path, 'sensor = "gap", period_ms = 2.0')) == []
    released = "configuration.decoder.function FCT_VOL_COMP_COMPUTATION"
    assert channel_ages(settings_of(tmp_path, two, released)) == []
