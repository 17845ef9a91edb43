"""`axisrig distance readings`: what a real control shows under each reading of the law.

Expected values by hand: 0.3 (0.1/20 (1 + r)) mm of a sensor that steps by 0.1 mm, r = 0.01/T per
second and 0.01 per cycle; of SET_DIST 0.3 x 0.1 (1 + r) with a derivative of the error, else
0.3 x 0.1. Past a step: v T (n + 9.5) with the slope, with clamps as the domain notes have it.
"""

import re
from pathlib import Path

import pytest

from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.distance import readings
from axisrig.bench.tools.distance.readings import readings_text
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def shown(rig: str, *changes: str) -> list[tuple[str, str, float]]:
    """Step, choice and first number of each line."""
    text = readings_text(settings_of(RIGS / f"{rig}.toml", list(changes)))
    found = re.findall(
        r"^   (\S+) steps by .*? mm  +(\S.*?)  +(?:goes past it by )?([\d.]+)", text, re.M
    )
    return [(step, choice, float(value)) for step, choice, value in found]


@pytest.mark.long
@pytest.mark.parametrize(
    ("rig", "per_second", "of_error"),
    [("distance-z", 16.5, 330.0), ("distance-z-2ms", 9.0, 180.0), ("distance-z-4ms", 5.25, 105.0)],
)
def test_the_first_cycle_of_a_dry_run(rig: str, per_second: float, of_error: float) -> None:
    found = shown(rig)
    assert [(step, value) for step, _, value in found[:5]] == [
        ("sensor", per_second),
        ("sensor", 1.515),
        ("SET_DIST", 30.0),
        ("SET_DIST", of_error),
        ("SET_DIST", 30.3),
    ]
    text = readings_text(settings_of(RIGS / f"{rig}.toml", []))
    assert text.count(" 30.0 from cycle 20 on") == 5
    assert f"{per_second} um in the first cycle" in text


@pytest.mark.long
@pytest.mark.parametrize(
    ("changes", "sloped_mm", "clamped_mm"),
    [(["set:Z.kenngr.distc.optimized_scheduling=1"], 0.105, 0.47), ([], 0.115, 0.48)],
)
def test_how_far_the_offset_goes_past_a_step(
    changes: list[str], sloped_mm: float, clamped_mm: float
) -> None:
    sloped, clamped = shown("distance-z", *changes)[5:]
    assert sloped == ("surface", 'limiter = "slope"', sloped_mm)
    assert clamped == ("surface", 'limiter = "clamp"', clamped_mm)


@pytest.mark.interpreted
def test_each_source_of_a_distance_has_its_own_dead_cycles(monkeypatch: pytest.MonkeyPatch) -> None:
    """The second encoder has 2; the variable of the PLC is two cycles older.

    v T (n + 9.5): 10 mm/s, 1 ms, and a mean of 20 values is (20 - 1)/2 cycles late.
    """
    monkeypatch.setattr(readings, "_CYCLES", 500)  # the offset is past the surface before that
    text = readings_text(settings_of(RIGS / "distance-z-variable-late.toml", []))
    found = re.findall(r"n = (\d)|limiter = \"slope\" +goes past it by ([\d.]+)", text)
    assert found == [("2", ""), ("", "0.115"), ("4", ""), ("", "0.135")]


@pytest.mark.long
def test_the_choice_of_the_rig_is_shown_and_changes_no_number() -> None:
    chosen = ["distance:limiter=clamp", "distance:derivative=per_cycle"]
    assert shown("distance-z", *chosen) == shown("distance-z")
    text = readings_text(settings_of(RIGS / "distance-z.toml", chosen))
    assert 'limiter = "clamp", derivative = "per_cycle"' in text


@pytest.mark.long
def test_3d_control_is_a_control_too_and_a_rig_without_any_is_refused() -> None:
    assert "3D control, n = 2" in readings_text(settings_of(RIGS / "distance-5axis.toml", []))
    with pytest.raises(UserError, match="no axis of the rig has distance control"):
        readings_text(settings_of(RIGS / "probe-z.toml", []))
