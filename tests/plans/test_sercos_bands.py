"""Limits of testplans/sercos.csv from closed forms; nothing of the bench is imported.

Lengths in mm, v in mm/s. 2^20 increments are a turn, and a turn is a lead of 10 mm.
"""

import csv
import re

import pytest
from tests.plans.shipped_files import PLANS, limits, rig_of, rows_of

ROWS = rows_of("sercos")
RIG = rig_of(PLANS / "rigs" / "probe-z-sercos.toml")
DRIVE = RIG["drive"]["servo"]
PER_MM = 2**20 / 10.0
DELAY_US = DRIVE["input_delay_us"]
LATCHED = [case for case, row in ROWS.items() if row["check:latch_error_um"]]


def given(case: str, name: str) -> str:
    """A value of the column `inputs`; "" where it has none."""
    found = re.search(rf"(?:^|;; ){re.escape(name)}=(.*?)(?: ;; |$)", ROWS[case]["inputs"])
    return found[1] if found else ""


def checks(case: str) -> list[str]:
    return ROWS[case]["checks"].split(" ;; ")


@pytest.mark.parametrize("case", LATCHED)
def test_error_of_a_latch_is_the_delay_and_half_an_increment(case: str) -> None:
    """-v t_d, and half of what the drive counts: 10 mm / 2^20, or 0.1 um."""
    delay_us = float(given(case, "drive:servo.input_delay_us") or DELAY_US)
    v = float(ROWS[case]["plc:V.E.FEED"]) / 60
    is_coarse = case in ("linear", "resolution")
    unit_um = 0.1 if is_coarse else 1000 / PER_MM
    low, high = limits(ROWS[case]["check:latch_error_um"])
    assert (low + high) / 2 == pytest.approx(-v * delay_us * 1e-3, abs=1e-9)
    assert unit_um / 2 <= (high - low) / 2 <= unit_um + 1e-4


def test_the_place_of_the_first_telling_row() -> None:
    """12.3456 mm are 1 294 529.99 increments; the drive counts whole ones."""
    assert float(given("at-12-3456", "plant:probe.surface_mm")) == 12.3456
    exact = 12.3456 * PER_MM
    assert exact == pytest.approx(1_294_529.98656)
    assert f"msg:N60 == {round(exact)}" in checks("at-12-3456")
    assert DRIVE["encoder_increments"] == 2**20
    assert DRIVE["lead_mm"] == 10.0


def test_the_edge_that_the_telegram_leaves() -> None:
    """The AT has S-0-0130, then S-0-0131: the falling edge at 100 mm counts."""
    rig = rig_of(PLANS / "rigs" / "probe-z-sercos-open.toml")
    assert rig["drive"]["servo"]["at"][-1] == "S-0-0131"
    text = (PLANS / "rigs" / rig["axis"]["Z"]["list"]).read_text(encoding="utf-8")
    assert not re.search(r"^kenngr\.measure\.(input|edge)", text, re.M)
    assert f"msg:N40 == {round(100 * PER_MM)}" in checks("last-in-at")
    assert "alarms == 70390" in checks("last-in-at")


def study() -> tuple[dict[str, str], list[dict[str, str]]]:
    """The row `*` of the study, and the others."""
    with (PLANS / "sercos_study.csv").open(encoding="utf-8", newline="") as file:
        default, *rows = csv.DictReader(file)
    return default, rows


def test_the_study_has_the_delay_at_each_feed_edge_and_cycle() -> None:
    """Mean -v t_d to half an increment, all values of a feed within one.

    The slope is t_d; a value that is up to half an increment off at each feed, always the same as
    the place is, moves it by q/2 sum|v - m| / sum(v - m)^2 at most.
    """
    default, rows = study()
    feeds = [float(word) for word in re.findall(r"\d+", default["plc:V.E.FEED"])]
    assert feeds == [60, 300, 1000, 3000]
    speeds = [feed / 60 for feed in feeds]
    mean = sum(speeds) / len(speeds)
    increment_um = 1000 / PER_MM
    slope = sum(abs(v - mean) for v in speeds) / sum((v - mean) ** 2 for v in speeds)
    expected = [f"{-v * DELAY_US * 1e-3:.4f} +- {increment_um / 2:.4f}" for v in speeds]
    for row in rows:
        assert row["check:mean(latch_error_um; each)"] == f"[{' | '.join(expected)}]"
        assert row["check:range(latch_error_um; each)"] == f"<= {increment_um:.4f}"
        cell = row["check:slope(latch_error_um; contact_velocity_mm_s)"]
        assert cell == f"{DELAY_US * 1e-3:.6f} +- {increment_um / 2 * slope:.6f}"
    cycles = {(row["plc:V.E.CYCLE_MS"], "NEG" in row["inputs"]) for row in rows}
    assert cycles == {(cycle, is_neg) for cycle in "124" for is_neg in (True, False)}
