"""Limits of testplans/fixed_stop_sercos.csv from closed forms; nothing of the bench is imported.

The laws are those of testplans/fixed_stop_timing.csv. On EtherCAT the position of SYNC0 is judged
in the NC cycle after the next one: T + offset - shift later, for a demand of three cycles ago.
"""

import math
import re
from dataclasses import dataclass

import pytest
from tests.plans.fixed_stop_law import Axis, axis
from tests.plans.fixed_stop_setup import PLANS, band, is_rounded, most, rows, tolerance
from tests.plans.shipped_files import rig_of

ROWS = rows("fixed_stop_sercos")
SHIFT_S = 100e-6  # shift_us, its default
SEEN_CYCLES = 3  # docs/ethercat.md: what an NC cycle sends is seen 3 cycles later
TENTH_PER_CENT = 1000
FOUND = [case for case, row in ROWS.items() if row["check:contact_to_detection_ms"]]
RATED_NM = 2.2


@dataclass(frozen=True)
class OnSercos(Axis):
    """The axis of a row on EtherCAT."""

    @property
    def judged_s(self) -> float:
        """From SYNC0 to the NC cycle that judges its position: a frame brings it in the next."""
        return self.T + float(self.rig["cycle"]["cycle_offset_us"]) * 1e-6 - SHIFT_S

    @property
    def cnc_lag(self) -> float:
        """s(k - d) - x(k) in steady motion, with s(k - 3) at the drive when x(k) was."""
        return self.lag + (SEEN_CYCLES - max(self.delay_cycles, 1)) * self.v * self.T


def on_sercos(row: dict[str, str]) -> OnSercos:
    """Return the axis of a row; armed from the begin of the block."""
    found = axis(row)
    assert found.armed_from == 0 or found.armed_from < found.stop - 1, "never what decides"
    return OnSercos(found.row, found.name, found.direction, found.v, found.block, found.armed_from)


@pytest.mark.parametrize("case", FOUND)
def test_detection_is_one_cycle_exactly(case: str) -> None:
    found = on_sercos(ROWS[case])
    low, high = band(ROWS[case]["check:contact_to_detection_ms"])
    expected_low, expected_high = found.detection
    assert is_rounded(low, expected_low * 1e3, 4)
    assert is_rounded(high, expected_high * 1e3, 4)
    assert found.T <= expected_high - expected_low <= found.T * 1.4


@pytest.mark.parametrize("case", FOUND)
def test_place_and_forces_at_the_stop(case: str) -> None:
    """x_stop + F/k; F of the torque limit S-0-0092, 0.1 % of the rated torque."""
    row, found = ROWS[case], on_sercos(ROWS[case])
    force = RATED_NM * 2 * math.pi / 0.01 * float(row["plc:V.E.LIMIT"]) / TENTH_PER_CENT
    assert found.limit_n == pytest.approx(force)
    middle, width = tolerance(row["check:latch_mm"])
    assert is_rounded(middle, found.place[0], 5)
    assert float(width) == 0.001
    low, high = band(row["check:stop_force_n"])
    assert is_rounded(low, found.force[0], 3)
    assert is_rounded(high, found.force[1], 3)
    assert is_rounded(most(row["check:stop_force_end_n"]), found.end_n, 3)


@pytest.mark.parametrize("case", FOUND)
def test_what_is_the_same_everywhere(case: str) -> None:
    """One cycle of the kernel exactly, 1 um at the force; both idents are as before behind it."""
    row = ROWS[case]
    assert row["check:detection_followed_error_ms"] == "== 0"
    assert row["check:latch_force_error_um"] == "-1 .. 1"
    assert row["check:msg:N60"] == "== 1"
    assert row["check:alarms"] == "none"
    start = dict(on_sercos(row).rig["drive"]["servo"]["idents"])
    assert row["check:msg:N120"] == f"== {start['S-0-0092']}"
    assert row["check:msg:N130"] == f"== {start['S-0-0159']}"


def test_largest_force() -> None:
    low, high = band(ROWS["peak"]["check:stop_force_n_max"])
    least, highest = on_sercos(ROWS["peak"]).peak
    assert is_rounded(low, least, 3)
    assert is_rounded(high, highest, 3)


@pytest.mark.parametrize(
    ("case", "lag_mm", "cycles"),
    [
        ("lag-00330-00331", 2.1, 65),
        ("time-00332", 0.9, 140),
        ("feed-600", 0.9, 65),
        ("cycle-4ms", 0.9, 17),
    ],
)
def test_the_older_parameters(case: str, lag_mm: float, cycles: int) -> None:
    """P-AXIS-00331 and 00332 where 00774 to 00770 leave it to them; 00330 is FIXED_STOP."""
    found = on_sercos(ROWS[case])
    assert found.criteria.lag_mm == pytest.approx(lag_mm)
    assert found.criteria.tau_cycles == cycles


def test_a_drive_that_watches_stops_before_the_control_has_found_anything() -> None:
    """S-0-0159 counts increments of 2^20 per turn: a window of 1.5 mm, a lag limit of 2 mm."""
    row = ROWS["drive-watches"]
    found = on_sercos(row)
    window_mm = float(row["plc:V.E.WATCH"]) * 10 / 2**20
    assert found.criteria.lag_mm is not None
    assert found.lag < window_mm < found.criteria.lag_mm
    assert row["check:alarms"] == "contains 900005"


def test_what_the_plan_is_about() -> None:
    known = [on_sercos(ROWS[case]) for case in FOUND]
    assert {round(each.v * 60) for each in known} >= {100, 300, 600, 1500, 3000}
    assert {round(each.T * 1e6) for each in known} == {1000, 2000, 4000}
    assert {each.criteria.lag_mm is None for each in known} == {True, False}
    assert {each.direction for each in known} == {1, -1}
    assert {float(ROWS[case]["plc:V.E.LIMIT"]) for case in FOUND} >= {100, 362, 800}
    program = (PLANS / ROWS["feed-600"]["program"]).read_text(encoding="utf-8")
    assert len(re.findall(r"#IDENT WR SYN", program)) == 4


def test_the_gantry_of_the_manual() -> None:
    """FCT-C4 7.3.1: VAL=100 is 10 % of 9 Nm on both sides; the master is at x_stop + F/k."""
    row = ROWS["gantry-printed"]
    drive = rig_of(PLANS / row["rig"])["drive"]["servo"]
    force_n = 0.1 * drive["rated_torque_mnm"] * 1e-3 * 2 * math.pi / 0.01
    assert row["checks"].split(" ;; ") == [
        f"stop_force_n:X = {force_n:.3f} +- 0.3",
        f"stop_force_n:X2 = {force_n:.3f} +- 0.3",
        f"latch_mm:X = {130 + force_n / 20e3:.5f} +- 0.001",
    ]
    program = (PLANS / row["program"]).read_text(encoding="utf-8")
    assert set(re.findall(r"ID S-0-0092 VAL=(\d+)", program)) == {"100"}
