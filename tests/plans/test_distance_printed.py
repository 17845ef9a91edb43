"""testplans/distance_printed.csv: every printed controller setting, each mode, 1, 2 and 4 ms.

Growths are those of `law_table.csv` (see `tests/oracles/distance`), for one dead cycle or, with
both encoders, none of Z_com. The verdict is foretold by a walk of its own through the loop with the
slope and the printed limits of FCT-M3 12.8.3: it is that of the poles but for two loops whose D
part alone makes them ring; a slope bounds it.
"""

import csv
import io
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from tests.plans.distance_law import Setup
from tests.plans.distance_walk import walk

from axisrig.bench.plan.expanded import expanded_text
from axisrig.bench.plan.plan import read_plan

ROOT = Path(__file__).parents[2]
TABLES = ROOT / "tests" / "oracles" / "distance"
MODES = {"CONST_DIST": "const", "both": "both", "SET_POS": "surface"}
DEAD = {"CONST_DIST": "1", "both": "0", "SET_POS": ""}
BROUGHT_TO_REST = {"start-pid-const-1ms", "dist-5-expo-const-1ms"}
STABILITY, GROWTH = "check:distance_stability", "check:distance_growth_expected"


@cache
def rows() -> dict[str, dict[str, str]]:
    text = expanded_text(read_plan(ROOT / "testplans" / "distance_printed.csv"))
    return {row["case"]: row for row in csv.DictReader(io.StringIO(text))}


def table(name: str) -> list[dict[str, str]]:
    return list(csv.DictReader((TABLES / name).read_text(encoding="utf-8").splitlines()))


def key(setup: Setup) -> tuple[str, ...]:
    """Mode, cycle and controller of a row, as text."""
    words = [setup.word(name) for name in ("kp", "i_tn", "d_tv", "filter_type", "n_cycles")]
    numbers = [f"{float(word or 0):g}" if "_" not in word else word for word in words]
    mean = setup.word("smoothing_factor") if "EXPO" in words[3] else ""
    return (setup.mode, f"{setup.T * 1e3:g}", *numbers, mean)


def test_every_printed_setting_in_each_mode_and_cycle_has_the_growth_of_the_table() -> None:
    settings = {row["setting"]: row for row in table("law_settings.csv")}
    found = {key(Setup(row)): row for row in rows().values()}
    assert len(found) == len(rows()) == 12 * 3 * 3
    count = 0
    for cell in table("law_table.csv"):
        if (cell["derivative"], cell["derivative_of"]) != ("per_second", "feedback"):
            continue
        if cell["dead_cycles"] != DEAD[cell["mode"]]:
            continue
        one = settings[cell["setting"]]
        numbers = [f"{float(one[name]):g}" for name in ("kp", "tn_s", "tv_s")]
        of_filter = (one["filter_type"], one["count"], one["alpha"])
        row = found[(MODES[cell["mode"]], cell["period_ms"], *numbers, *of_filter)]
        low, high = map(float, row[GROWTH].split(" .. "))
        growth = float(cell["growth"])
        assert (low, high) == pytest.approx((growth - 5e-5, growth + 5e-5), abs=6e-6)
        assert f"growth {growth:.4f}" in row["title"]
        is_stable = growth < 1.0 or row["case"] in BROUGHT_TO_REST
        assert row[STABILITY] == ("== stable" if is_stable else "== unstable")
        count += 1
    assert count == len(rows())


@pytest.mark.long(but=1)
@pytest.mark.parametrize("case", [*sorted(BROUGHT_TO_REST), *sorted(set(rows()) - BROUGHT_TO_REST)])
def test_the_verdict_is_that_of_a_walk(case: str) -> None:
    """Steps of the last half of the time: none but of increments, or less of them in its end."""
    setup = Setup(rows()[case])
    cycles = round(setup.number("plc:V.E.TIME") / setup.T)
    steps = np.abs(np.diff(walk(setup, np.zeros(cycles)).offset, prepend=0.0))
    half = cycles // 2
    early, late = (float(part.max()) for part in np.array_split(steps[half:], 2))
    is_still = early <= 6 * setup.increment * max(setup.kp, 0.1)
    word = "stable" if is_still or late < 0.9 * early else "unstable"
    assert rows()[case][STABILITY] == f"== {word}"
