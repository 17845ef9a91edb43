"""Verdicts on a kp of 3D control over inclined surfaces, by what its sensor measures."""

import math
import re
from pathlib import Path

import pytest
from tests.rig.test_channel_distance_check import limit_of_mean, settings_of

from axisrig.bench.rig.distance.channel import (
    channel_warnings,
    describe_channel,
    is_released,
    largest_tilt_deg,
)

LIMIT = limit_of_mean(4, 2)  # of the shipped list: a mean of 4, 2 dead cycles
ORTHOGONAL, ELECTRODE = "distance-5axis-orthogonal", "distance-5axis-electrode"


def text_of(tmp_path: Path, *lines: str, keys: str = "", base: str = "distance-5axis") -> str:
    (text,) = describe_channel(settings_of(tmp_path, keys, *lines, base=base))
    return text


def worst_verdict(text: str) -> tuple[float, str]:
    """Limit and verdict of the steepest tilt in ECS."""
    ((kp, verdict),) = re.findall(r"stable below kp ([\d.]+) +ECS, worst: .*: (.+)$", text, re.M)
    return float(kp), verdict


@pytest.mark.parametrize(
    ("kp", "flat", "inclined"),
    [
        (0.03, "stable", "stable"),
        (0.0370, "stable", "stable"),
        (0.0380, "stable", "UNSTABLE"),
        (0.2, "stable", "UNSTABLE"),  # as shipped
        (0.42, "stable", "UNSTABLE"),
        (0.44, "UNSTABLE", "UNSTABLE"),
    ],
)
def test_a_kp_may_be_stable_over_a_parallel_surface_and_not_over_an_inclined_one(
    tmp_path: Path, kp: float, flat: str, inclined: str
) -> None:
    """8 sin^2(pi/16)/sin(pi/4) = 0.4306 with 2 dead cycles; times cos 85 deg 0.0375."""
    text = text_of(tmp_path, f"dist_ctrl[0].kp {kp}", base=ORTHOGONAL)
    assert f"CONST_DIST: {flat} as listed" in text
    assert worst_verdict(text)[1] == f"{inclined} as listed"


@pytest.mark.parametrize(
    ("hd4", "tilt_deg"),
    [(850_000, 85.0), (800_000, 80.0), (600_000, 60.0), (890_000, 85.0), (0, 85.0)],
)
def test_the_steepest_tilt_is_the_end_of_the_listed_kinematic(
    tmp_path: Path, hd4: int, tilt_deg: float
) -> None:
    """HD4 of kinematic 98 in 0.0001 deg, at most the 85 degrees of ECS; 0 = none is given."""
    line = f"kin_step[1].trafo[0].param[3] {hd4}"
    settings = settings_of(tmp_path, "", line, base=ORTHOGONAL)
    assert largest_tilt_deg(settings) == pytest.approx(tilt_deg)
    (text,) = describe_channel(settings)
    limit = LIMIT * math.cos(math.radians(tilt_deg))
    assert worst_verdict(text)[0] == pytest.approx(limit, rel=1e-3)
    assert f"tool at b = {tilt_deg:g} deg" in text
    stable = "stable" if limit > 0.2 else "UNSTABLE"  # the listed kp
    assert worst_verdict(text)[1] == f"{stable} as listed"


def test_without_the_extension_the_tilt_is_that_of_ecs(tmp_path: Path) -> None:
    lines = ("default_id_of_kin_step[1] 0", "kin_step[1].trafo[0].param[3] 600000")
    assert largest_tilt_deg(settings_of(tmp_path, "", *lines)) == 85.0


@pytest.mark.parametrize("hd4", [850_000, 600_000])
@pytest.mark.parametrize("kp", [0.05, 0.2, 0.4])
def test_the_slope_that_a_tool_turned_away_bears_follows_from_its_kp(
    tmp_path: Path, kp: float, hd4: int
) -> None:
    """kp = (1 - tan p tan b) limit: with the tool at the end of its kinematic."""
    lines = (f"dist_ctrl[0].kp {kp}", f"kin_step[1].trafo[0].param[3] {hd4}")
    text = text_of(tmp_path, *lines)
    (slope,) = re.findall(r"stable up to p -([\d.]+) deg +MCS, ACS", text)
    tilt = math.radians(hd4 / 10_000)
    # The slope has three digits: 0.05 deg at 60 deg and 0.005 deg at 85 deg change kp by less
    assert (1 - math.tan(math.radians(float(slope))) * math.tan(tilt)) * LIMIT == pytest.approx(
        kp, abs=0.002 * LIMIT
    )
    assert f"kp {kp:g} as listed: tool at b = {hd4 / 10_000:g} deg" in text
    assert "up to p = b - 90 deg no kp is left" in text


@pytest.mark.parametrize(("kp", "is_unstable"), [(0.43, False), (0.4315, True), (1.0, True)])
def test_a_kp_beyond_its_limit_bears_no_slope(tmp_path: Path, kp: float, is_unstable: bool) -> None:
    text = text_of(tmp_path, f"dist_ctrl[0].kp {kp}")
    words = "MCS, ACS: as listed, also over a parallel surface"
    assert (words in text) is is_unstable
    assert ("stable up to p" in text) is not is_unstable


@pytest.mark.parametrize(
    ("base", "keys", "words"),
    [
        ("distance-5axis", "", "ECS as above over any surface"),
        ("distance-5axis", 'normalise = "none"', "the value is not normalised"),
        (ORTHOGONAL, "", "ECS, worst"),
        (ORTHOGONAL, 'normalise = "along"', 'set normalise = "none" in [plc]'),
        (ELECTRODE, "", "a disc electrode does not give the distance"),
        # Whatever the sensor measures, the PLC takes it for that of an electrode
        (ORTHOGONAL, 'normalise = "electrode"', "a disc electrode does not give the distance"),
        ("distance-robot", "", "ECS as above over any surface"),
        ("distance-robot-orthogonal", "", "ECS, worst"),
    ],
)
def test_each_sensor_and_what_the_plc_makes_of_it_has_its_own_words(
    tmp_path: Path, base: str, keys: str, words: str
) -> None:
    text = text_of(tmp_path, keys=keys, base=base)
    every = (
        "ECS as above over any surface",
        "the value is not normalised",
        "ECS, worst",
        'set normalise = "none" in [plc]',
        "a disc electrode does not give the distance",
    )
    assert [one for one in every if one in text] == [words]
    is_parallel = "over a surface parallel to the assumed plane" in text
    assert is_parallel is (words in (every[0], every[2], every[4]))


@pytest.mark.parametrize(
    ("base", "keys", "is_warned"),
    [
        ("distance-5axis", "", False),
        ("distance-5axis", 'normalise = "none"', True),
        (ORTHOGONAL, "", False),
        (ELECTRODE, 'normalise = "none"', True),
        ("distance-robot", 'normalise = "none"', True),
        ("distance-robot-orthogonal", "", False),
    ],
)
def test_a_value_along_the_tool_that_nobody_normalises_is_warned_of(
    tmp_path: Path, base: str, keys: str, is_warned: bool
) -> None:
    found = channel_warnings(settings_of(tmp_path, keys, base=base))
    wanted = "3D distance control (P-CHAN-00500): gap in V.E.SENSOR measures along the tool"
    assert [text.startswith(wanted) for text in found] == [True] * is_warned


@pytest.mark.parametrize(
    ("word", "released"), [("FCT_3D_DIST_CTRL", True), ("FCT_VOL_COMP_COMPUTATION", False)]
)
def test_it_is_released_by_its_own_word_alone(tmp_path: Path, word: str, released: bool) -> None:
    settings = settings_of(tmp_path, "sign = -1", f"configuration.decoder.function {word}")
    assert is_released(settings) is released
    assert bool(channel_warnings(settings)) is released
    assert bool(describe_channel(settings)) is released


@pytest.mark.parametrize(
    ("steps", "words"),
    [
        (("9", "98"), "#TRAFO ON: 9, 98 by P-CHAN-00264"),
        (("9", "0"), "#TRAFO ON: 9 by P-CHAN-00264"),
        (("0", "98"), "#TRAFO ON: 98 by P-CHAN-00264"),
        (("0", "0"), "no kinematic is listed (P-CHAN-00264), MCS and ECS need one"),
    ],
)
def test_the_mode_without_a_word_follows_from_the_listed_kinematic(
    tmp_path: Path, steps: tuple[str, str], words: str
) -> None:
    lines = [f"default_id_of_kin_step[{n}] {step}" for n, step in enumerate(steps)]
    text = text_of(tmp_path, *lines)
    (mode,) = re.findall(r"  mode +(.*)", text)
    assert words in mode
    assert mode.startswith("without MODE ACS" if steps == ("0", "0") else "without MODE MCS while")


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("", "made orthogonal by the tilt that the channel shows"),
        ("tilt_delay_cycles = 1", ", 1 cycles older than the value"),
        ("tilt_error_deg = -2.5", ", wrong by -2.5 degrees"),
        ("tilt_delay_cycles = 2, tilt_error_deg = 1", "value, wrong by 1 degrees"),
        ('normalise = "none"', "as the sensor gives it: right where that is the orthogonal"),
    ],
)
def test_how_the_value_comes_to_the_control_is_shown(tmp_path: Path, keys: str, words: str) -> None:
    (value,) = re.findall(r"  value +(.*)", text_of(tmp_path, keys=keys))
    assert words in value
    assert ("older" in value) is ("delay" in keys)
    assert ("wrong by" in value) is ("error" in keys)


@pytest.mark.parametrize(
    ("keys", "words"),
    [("", "the value grows when the tool lifts, as 3D control wants it"),
     ("sign = -1", "WRONG: the value falls when the tool lifts; the control runs away")],
)  # fmt: skip
def test_the_direction_of_the_value_is_shown(tmp_path: Path, keys: str, words: str) -> None:
    (sign,) = re.findall(r"  sign +(.*)", text_of(tmp_path, keys=keys))
    assert sign == words
