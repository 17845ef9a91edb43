"""Limits of testplans/io_node.csv, recomputed from the cycles of the rig.

contact, filter, wait for the SYNC that samples, telegram, wait for the PLC, NC cycle: the position
is that of the SYNC before this NC cycle. Nothing of the bench is imported.
"""

import csv
import math
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
INCREMENT_UM = 10_000 / 2**20
SYNC_US = 48  # 44 bits and 4 stuff bits at 1 Mbit/s
WIDE = 8.0  # as in test_statistics_bands.py: so many standard errors

with (PLANS / "io_node.csv").open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file)}


def _rig(name: str) -> dict[str, Any]:
    return tomllib.loads((PLANS / "rigs" / name).read_text(encoding="utf-8"))


NODE, BASE = _rig("plc-io-node.toml"), _rig("plc-signal.toml")


def _input(row: dict[str, str], name: str, usual: float) -> float:
    found = re.search(rf"(?:^|;; ){re.escape(name)}=(\S+)", row["inputs"])
    return usual if found is None else float(found[1])


def _delays_us(row: dict[str, str]) -> tuple[float, float]:
    """The least and the most from contact to the SYNC whose position counts.

    What the PLC reads at n period + offset is of the SYNC before it, and the NC cycle after it
    takes the position of the same SYNC: what is left is the wait for the SYNC that the PLC reads.
    """
    cycle = BASE["cycle"]
    period = _input(row, "plc:period_us", NODE["plc"]["period_us"])
    assert period % cycle["period_us"] == 0
    assert SYNC_US < NODE["plc"]["offset_us"] < cycle["cycle_offset_us"]
    filter_us = _input(row, "plc:terminal.filter_us", 0.0)
    return filter_us, filter_us + period


BANDS = [name for name, row in ROWS.items() if row["check:latch_error_um"]]


@pytest.mark.parametrize("case", BANDS)
def test_the_band_is_the_wait_for_the_sync_that_the_plc_reads(case: str) -> None:
    row = ROWS[case]
    least_us, most_us = _delays_us(row)
    v_um_us = float(row["plc:V.E.FEED"]) / 60 / 1000
    low, high = (float(text) for text in row["check:latch_error_um"].split(" .. "))
    assert low == pytest.approx(-v_um_us * most_us - INCREMENT_UM, abs=1e-4)
    assert high == pytest.approx(-v_um_us * least_us + INCREMENT_UM, abs=1e-4)


def test_the_telegram_is_there_before_the_plc_reads_in_the_worst_case() -> None:
    """SYNC, TPDO1 and TPDO2 of the drive, the node's, and the longest event frame before them.

    Bits of a frame of n bytes at most: 55 + 10 n with the intermission (Davis et al. 2007).
    """
    assert 95 + sum(55 + 10 * n for n in (0, 8, 1, 6)) < NODE["plc"]["offset_us"]


def test_phases_spread_over_a_sync_give_half_of_it() -> None:
    row = ROWS["phases"]
    touches = int(_input(row, "plc:V.E.TOUCHES", 0))
    v, period_ms = float(row["plc:V.E.FEED"]) / 60, _input(row, "plc:period_us", 0) / 1000
    assert touches * _input(row, "plc:V.E.SHIFT", 0) == pytest.approx(v * period_ms / 1000)
    middle, width = (float(part) for part in row["check:mean(latch_error_um)"].split(" +- "))
    assert middle == pytest.approx(-v * period_ms / 2)
    assert width == pytest.approx(WIDE * v * period_ms / math.sqrt(12 * touches), abs=1e-4)
    (most,) = (float(part) for part in row["check:range(latch_error_um)"].split("<= ")[1:])
    assert most == pytest.approx(v * period_ms + 2 * INCREMENT_UM, abs=1e-4)


def test_what_stops_the_carrier_gives_an_alarm_and_no_value() -> None:
    stopped = {name for name, row in ROWS.items() if row["check:alarms"] == "== 900401"}
    assert stopped == {"telegram-lost", "heartbeat-lost", "power-lost", "not-started"}
    assert not any(ROWS[name]["check:msg:N30"] for name in stopped)
