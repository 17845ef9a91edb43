"""Limits of testplans/distance_sercos.csv: the formulas of distance_control.csv, one cycle later.

The sensor is S-0-0053; on EtherCAT a line adds a dead cycle to those of CAN.
"""

import csv

import pytest
from tests.plans.distance_bands import restated
from tests.plans.distance_law import PLANS, Setup, rig_of, rows

ON_CAN = rows()
LATER = 1
with (PLANS / "distance_sercos.csv").open(encoding="utf-8", newline="") as file:
    ROWS = {row["case"]: row for row in csv.DictReader(file)}


@pytest.mark.long
@pytest.mark.parametrize("case", ROWS)
def test_a_row_is_that_of_can_with_one_dead_cycle_more(case: str) -> None:
    row, on_can = ROWS[case], ON_CAN[case]
    expected = on_can | restated(Setup(on_can, LATER))
    of_row = {name: text for name, text in row.items() if name.startswith(("check:", "set:", "pl"))}
    assert {name: expected[name] for name in of_row} == of_row
    said = {name for name, text in expected.items() if text and name.startswith(("check:", "set:"))}
    assert said <= {*row}


def test_the_sensor_is_position_feedback_2() -> None:
    drive = rig_of("rigs/distance-z-sercos.toml")["drive"]["servo"]
    assert (drive["family"], drive["at"]) == ("sercos", ["S-0-0051", "S-0-0053"])
    assert {row["rig"] for row in ROWS.values()} == {"rigs/distance-z-sercos.toml"}


def test_what_the_rows_are_about() -> None:
    words = {word for row in ROWS.values() for word in row["tags"].split()}
    assert words >= {
        "dead-time", "stability", "ramp", "const", "both", "surface", "sine", "freeze", "step",
        "alarm", "sign", "skew",
    }  # fmt: skip
