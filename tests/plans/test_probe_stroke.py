"""Every limit of testplans/probe_stroke.csv, recomputed from closed forms written out here.

Nothing of the bench is imported: rigs, lists and plan are read as the text files they are.
Lengths in mm, times in s.
"""

import csv
import re
import tomllib
from decimal import Decimal
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
RIGS = PLANS / "rigs"
METRIC = "check:probe_deflection_mm_max"

with (PLANS / "probe_stroke.csv").open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file)}

BASE, SOFT, BREAKS = (
    tomllib.loads((RIGS / f"probe-z{end}.toml").read_text(encoding="utf-8"))
    for end in ("", "-stroke", "-breaks")
)
T = BASE["cycle"]["period_us"] * Decimal("1e-6")
INPUT_DELAY = Decimal(str(BASE["drive"]["servo"]["input_delay_us"])) * Decimal("1e-6")
KV = Decimal(SOFT["plant"]["z"]["start"]["kv"])
STROKE = Decimal(str(SOFT["plant"]["probe"]["stroke_mm"]))
SURFACE = Decimal(BASE["plant"]["probe"]["start"]["surface_mm"])
LIST = (RIGS / BASE["axis"]["Z"]["list"]).read_text(encoding="utf-8")
A = Decimal(re.search(r"^getriebe\[0\].lslope_profil.a_grenz_stufe_1\s+(\d+)", LIST, re.M)[1])  # type: ignore[index]

RUNS = [name for name, row in ROWS.items() if row["check:overtravel_mm"]]
BREAKING = [name for name, row in ROWS.items() if "900072" in row["check:alarms"]]


def _speed(row: dict[str, str]) -> Decimal:
    """F, or in type 4 what stops on the stroke of the list: v² = 2 a s (P-AXIS-00086)."""
    wanted = Decimal(row["plc:V.E.FEED"]) / 60
    if row["plc:V.E.TYPE"] != "4":
        return wanted
    allowed = (2 * A * Decimal(row["set:Z.kenngr.hub_messtaster"]) / 10000).sqrt()
    assert ("900222" in row["check:alarms"]) == (allowed < wanted)
    return min(allowed, wanted)


def _band(row: dict[str, str]) -> tuple[Decimal, Decimal]:
    """v t_d + v²/2a + (1-f) v/Kv; t_d = delays + U + T, U in [0, T): when the next SYNC comes."""
    v = _speed(row)
    delays = Decimal(row["plant:probe.trigger_delay_us"] or 0) * Decimal("1e-6") + INPUT_DELAY
    lag = (1 - Decimal(row["plant:z.feed_forward"] or 0)) * v / KV
    least = v * (delays + T) + v * v / (2 * A) + lag
    return least, least + v * T


def _limits(text: str) -> tuple[Decimal, Decimal]:
    low, high = map(Decimal, text.split(" .. "))
    return low, high


@pytest.mark.parametrize("case", RUNS)
def test_the_deflection_is_reaction_ramp_and_lag(case: str) -> None:
    row = ROWS[case]
    for found, expected in zip(_limits(row[METRIC]), _band(row), strict=True):
        assert abs(found - expected) <= Decimal("0.000005")
    assert row["check:overtravel_mm"] == row[METRIC], "the trace says the same"


def test_only_a_list_that_leaves_room_keeps_to_the_stroke() -> None:
    kept = {name for name in RUNS if _band(ROWS[name])[1] <= STROKE}
    assert kept == {"room-left", "breaks-within"}
    assert all(_band(ROWS[name])[0] > STROKE for name in RUNS if name not in kept)


def test_a_probe_breaks_where_the_rig_says_so_and_the_stroke_is_passed() -> None:
    assert BREAKS["plant"]["probe"] == {"breaks": True}
    assert BREAKS["base"] == "probe-z-stroke.toml"
    assert set(BREAKING) == {"breaks", "crash"}
    for name in BREAKING:
        assert ROWS[name]["rig"] == "rigs/probe-z-breaks.toml"
    assert _band(ROWS["breaks"])[0] > STROKE
    assert ROWS["breaks"][METRIC] == f">= {STROKE}"


def test_a_crash_ends_behind_the_stroke_by_lag_ramp_and_reaction() -> None:
    """Seen at a SYNC up to v T beyond the stroke; the set value is two cycles ahead of the drive
    and brakes in one of the next two cycles.
    """
    row = ROWS["crash"]
    v = Decimal(row["plc:V.E.FEED"]) / 60
    least = STROKE + v / KV + v * v / (2 * A)
    assert _limits(row[METRIC]) == (least + 2 * v * T, least + 5 * v * T)
    recorded = ROWS["crash-recorded"]
    target = SURFACE - Decimal(recorded["plc:V.E.TARGET"])
    assert Decimal(recorded[METRIC].partition(" +- ")[0]) == target


def test_what_touches_nothing_is_not_deflected() -> None:
    row = ROWS["touches-nothing"]
    assert Decimal(row["plc:V.E.TARGET"]) > SURFACE
    assert row[METRIC] == "== 0"
