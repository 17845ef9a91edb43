"""Limits of testplans/fixed_stop_profidrive.csv from closed forms, without the bench.

The laws are those of testplans/fixed_stop_timing.csv. The position of instant k T - T_I is judged
in NC cycle k, offset + T_I later. With DSC the CNC judges e = s(k - 2) - x(k), v/Kv - v (T + t)/2
in steady motion (docs/profidrive.md) and K v T^2/12 more at most; with the loop in the CNC the lag
v/Kv that the controller computed one cycle before.
"""

import math
from dataclasses import dataclass

import pytest
from tests.plans.fixed_stop_law import Axis, axis
from tests.plans.fixed_stop_setup import PLANS, band, is_rounded, most, rows, tolerance

ROWS = rows("fixed_stop_profidrive")
TICK_S = 250e-6  # tick_us, its default
RATED_NM = 2.2
FULL_REDUCTION = 16384
FOUND = [case for case, row in ROWS.items() if row["check:contact_to_detection_ms"]]


@dataclass(frozen=True)
class OnCyclic(Axis):
    """The axis of a row on a cyclic segment; T_I, T_DX and T_O are 0."""

    @property
    def is_dsc(self) -> bool:
        """Whether the drive closes the loop."""
        return self.row["drive:servo.telegram"] not in ("3", "4")

    @property
    def gain(self) -> float:
        """P-AXIS-00099, 1/s."""
        return float(self.listed("getriebe[0].kv") or 0) / 100

    @property
    def increment(self) -> float:
        """Of G1_XIST1."""
        drive = self.rig["drive"]["servo"]
        return float(drive["lead_mm"]) / (drive["lines"] << drive["p1042"])

    @property
    def judged_s(self) -> float:
        """From the sample of a position to the NC cycle that judges it."""
        later = self.T if not self.is_dsc and self.criteria.lag_mm is not None else 0.0
        return float(self.rig["cycle"]["cycle_offset_us"]) * 1e-6 + later

    @property
    def cnc_lag(self) -> float:
        """What the CNC judges in steady motion."""
        if not self.is_dsc:
            return self.v / self.gain
        delay = (2 - max(self.delay_cycles, 1)) * self.v * self.T
        return self.v / self.gain - self.v * (self.T + TICK_S) / 2 + delay

    def _quantised(self, low: float, high: float) -> tuple[float, float]:
        least, highest = super()._quantised(low, high)
        return least - (self.gain * self.T**2 / 12 if self.is_dsc else 0.0), highest


def on_cyclic(row: dict[str, str]) -> OnCyclic:
    """Return the axis of a row; armed from the begin of the block."""
    found = axis(row)
    assert found.armed_from == 0 or found.armed_from < found.stop - 1, "never what decides"
    made = OnCyclic(found.row, found.name, found.direction, found.v, found.block, found.armed_from)
    assert made.gain == made.plant("kv"), "what is left of the start-up dies away with it"
    return made


@pytest.mark.parametrize("case", FOUND)
def test_detection_is_one_cycle_exactly(case: str) -> None:
    found = on_cyclic(ROWS[case])
    low, high = band(ROWS[case]["check:contact_to_detection_ms"])
    expected_low, expected_high = found.detection
    assert is_rounded(low, expected_low * 1e3, 4)
    assert is_rounded(high, expected_high * 1e3, 4)
    assert found.T <= expected_high - expected_low <= found.T * 1.4


@pytest.mark.parametrize("case", FOUND)
def test_place_and_forces_at_the_stop(case: str) -> None:
    """x_stop + F/k; F of the torque limit P1230, 0.1 % of the rated torque."""
    row, found = ROWS[case], on_cyclic(ROWS[case])
    force = RATED_NM * 2 * math.pi / 0.01 * float(row["plc:V.E.LIMIT"]) / 1000
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
    """1 um at the force; the torque limit is as before behind it.

    `detection_followed_error_ms` needs a set position that the drive has, which here none gets.
    """
    row = ROWS[case]
    assert "check:detection_followed_error_ms" not in row
    assert row["check:latch_force_error_um"] == "-1 .. 1"
    assert row["check:msg:N60"] == "== 1"
    assert row["check:alarms"] == "none"
    start = on_cyclic(row).rig["drive"]["servo"]["p1230"]
    assert row["check:msg:N120"] == f"== {start}"


def test_largest_force() -> None:
    low, high = band(ROWS["peak"]["check:stop_force_n_max"])
    least, highest = on_cyclic(ROWS["peak"]).peak
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
    found = on_cyclic(ROWS[case])
    assert found.criteria.lag_mm == pytest.approx(lag_mm)
    assert found.criteria.tau_cycles == cycles


def test_a_limit_that_the_drive_does_not_take_is_no_limit() -> None:
    """P1230 is 5 to 900 %: 10 000 is 1000 %."""
    row = ROWS["limit-refused"]
    assert float(row["plc:V.E.LIMIT"]) > 9000
    assert row["check:alarms"] == "== 900032"


def test_what_the_plan_is_about() -> None:
    known = [on_cyclic(ROWS[case]) for case in FOUND]
    assert {round(each.v * 60) for each in known} >= {100, 300, 600, 1500, 3000}
    assert {round(each.T * 1e6) for each in known} == {1000, 2000, 4000}
    assert {each.criteria.lag_mm is None for each in known} == {True, False}
    assert {each.direction for each in known} == {1, -1}
    assert {each.is_dsc for each in known} == {True, False}
    assert {float(ROWS[case]["plc:V.E.LIMIT"]) for case in FOUND} >= {100, 362, 800}
    program = (PLANS / ROWS["feed-600"]["program"]).read_text(encoding="utf-8")
    assert program.count("#DRIVE WR SYN") == 2
