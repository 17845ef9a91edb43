"""Limits of testplans/cyclic_study.csv from closed forms; nothing of the bench is imported.

Error of a latched value against the contact: -v t_d, to an increment of what the telegram carries,
at each feed, cycle and edge of each family on a cyclic segment.
"""

import csv
import re
from math import ceil

import pytest
from tests.plans.shipped_files import PLANS, rig_of

with (PLANS / "cyclic_study.csv").open(encoding="utf-8", newline="") as file:
    DEFAULT, *_ROWS = csv.DictReader(file)
ROWS = {row["case"]: row for row in _ROWS}
# Increment of the position, and of a latched value: it is rounded to both where they differ
INCREMENTS_UM = {
    "conventional": (1e4 / 4096, 0.0),
    "terminal": (1e4 / 4096, 0.0),
    "lightbus": (1e4 / 2**20, 1.0),
    "profidrive": (1e4 / 2**22, 0.0),
}
EDGES = {"terminal": ("pos",)}
SPEEDS = [float(word) / 60 for word in re.findall(r"\d+", DEFAULT["plc:V.E.FEED"])]


def delay_us(row: dict[str, str]) -> float:
    """The delay that the row sets, or that of its rig."""
    found = re.search(r"input_delay_us=(\d+)", row["inputs"])
    rig = rig_of(PLANS / row["rig"])
    return float(found[1]) if found else float(rig["drive"]["servo"]["input_delay_us"])


@pytest.mark.parametrize("case", ROWS)
def test_limits_of_a_row(case: str) -> None:
    """Slope: t_d; an increment at each feed moves it by q sum|v - m| / sum(v - m)^2 at most."""
    row, (family, edge, cycle) = ROWS[case], case.split("-")
    increment_um = sum(INCREMENTS_UM[family])
    width = f"{ceil(increment_um * 1e4) / 1e4:.4f}"
    means = [f"{-v * delay_us(row) * 1e-3:.4f} +- {width}" for v in SPEEDS]
    assert row["check:mean(latch_error_um; each)"] == f"[{' | '.join(means)}]"
    assert row["check:range(latch_error_um; each)"] == f"<= {width}"
    mean = sum(SPEEDS) / len(SPEEDS)
    turned = sum(abs(v - mean) for v in SPEEDS) / sum((v - mean) ** 2 for v in SPEEDS)
    slope = row["check:slope(latch_error_um; contact_velocity_mm_s)"]
    assert slope == f"{delay_us(row) * 1e-3:.6f} +- {increment_um * turned:.6f}"
    rig = rig_of(PLANS / row["rig"])
    assert rig["cycle"]["period_us"] == 1000 * int(row["plc:V.E.CYCLE_MS"])
    assert f"{row['plc:V.E.CYCLE_MS']}ms" == cycle
    assert ("edge=NEG" in row["inputs"]) is (edge == "neg")


def test_each_family_has_each_cycle_and_edge() -> None:
    expected = {
        f"{family}-{edge}-{cycle}ms"
        for family in INCREMENTS_UM
        for edge in EDGES.get(family, ("pos", "neg"))
        for cycle in (1, 2, 4)
    }
    assert set(ROWS) == expected
    assert [round(v * 60) for v in SPEEDS] == [60, 300, 1000, 3000]
    assert DEFAULT["check:count(latch_error_um)"] == "== 40"


@pytest.mark.parametrize("family", INCREMENTS_UM)
def test_the_increments_used_here_are_those_of_the_rig(family: str) -> None:
    drive = rig_of(PLANS / ROWS[f"{family}-pos-1ms"]["rig"])["drive"]["servo"]
    lines, lead_um = drive.get("lines"), drive["lead_mm"] * 1e3
    fine = {"profidrive": 2 ** drive.get("p1042", 0)}.get(family, 4)
    per_turn = lines * fine if lines else 2**20
    assert INCREMENTS_UM[family][0] == lead_um / per_turn
    assert "latch_variable" not in drive
