"""Limits of testplans/fixed_stop_speed_drives.csv from closed forms, without the bench.

The laws are those of testplans/fixed_stop_timing.csv. The CNC closes the loop: it judges the lag
v/Kv that its controller computed one cycle before, and the window at once, of the position of
instant k T - T_I. Positions come in increments, which are coarse here: a crossing is early or late
by the way of one, and by what a step of the output makes of the lag. No word limits the torque: F
is the largest force of the motor.
"""

from dataclasses import dataclass

import pytest
from tests.plans.fixed_stop_law import Axis, axis
from tests.plans.fixed_stop_setup import PLANS, band, is_rounded, most, rows, tolerance

ROWS = rows("fixed_stop_speed_drives")
FAMILIES = {"conventional": "1", "lightbus": "5", "encoder-terminal": "6"}
FOUND = [case for case, row in ROWS.items() if row["check:contact_to_detection_ms"]]
FULL, TURN_BITS, EDGES_PER_LINE = 32_767, 20, 4
PLACE_MM = 1e-3
LAG_LIMIT = "set:Z.kenngr.measure.fixed_stop_detect.pos_lag_limit"


@dataclass(frozen=True)
class OnSpeedDrive(Axis):
    """The axis of a row; T_I, T_DX and T_O are 0."""

    @property
    def drive(self) -> dict[str, float]:
        """Keys of the drive."""
        found: dict[str, float] = self.rig["drive"]["servo"]
        return found

    @property
    def gain(self) -> float:
        """P-AXIS-00099, 1/s."""
        return float(self.listed("getriebe[0].kv") or 0) / 100

    @property
    def increment(self) -> float:
        """Of the counter; Lightbus has 2^20 a turn."""
        lines = self.drive.get("lines")
        return self.drive["lead_mm"] / (EDGES_PER_LINE * lines if lines else 1 << TURN_BITS)

    @property
    def limit_n(self) -> float:
        """The largest force of the motor."""
        return self.plant("force_limit_motor_n")

    @property
    def judged_s(self) -> float:
        """From the sample of a position to the NC cycle that judges it."""
        later = self.T if self.criteria.lag_mm is not None else 0.0
        return float(self.rig["cycle"]["cycle_offset_us"]) * 1e-6 + later

    @property
    def cnc_lag(self) -> float:
        """What the CNC judges in steady motion."""
        return self.v / self.gain

    @property
    def loose_mm(self) -> float:
        """An increment, and the lag of a step of the output where the lag is judged."""
        rpm = self.drive.get("rpm_at_10v") or self.drive["rpm_at_full"]
        step = rpm / 60 * self.drive["lead_mm"] / FULL / self.gain
        return self.increment + (step if self.criteria.lag_mm is not None else 0.0)

    def _quantised(self, low: float, high: float) -> tuple[float, float]:
        least, highest = super()._quantised(low, high)
        return least - self.loose_mm / self.v, highest + self.loose_mm / self.v

    @property
    def force(self) -> tuple[float, float]:
        """At the detection: what presses, the last ringing, and a hundredth of PLACE_MM.

        The plant is integrated to a hundredth of that (fmus/README.md).
        """
        rest = self.k * (self.ringing(self.detection[0]) + PLACE_MM / 100)
        return self.pressing_n - rest, self.pressing_n + rest


def on_speed_drive(row: dict[str, str]) -> OnSpeedDrive:
    """Return the axis of a row; armed from the begin of the block.

    A conventional drive does not have P-AXIS-00774.
    """
    is_kept = family_of(row) != "conventional"
    found = axis(row if is_kept else {**row, LAG_LIMIT: ""})
    assert found.armed_from == 0 or found.armed_from < found.stop - 1, "never what decides"
    made = OnSpeedDrive(
        found.row, found.name, found.direction, found.v, found.block, found.armed_from
    )
    assert made.gain == made.plant("kv"), "what is left of the start-up dies away with it"
    return made


def family_of(row: dict[str, str]) -> str:
    """Return the family of the rig of a row."""
    return next(family for family in FAMILIES if f"fixed-stop-z-{family}" in row["rig"])


@pytest.mark.parametrize("case", FOUND)
def test_detection_is_one_cycle_and_what_increments_are(case: str) -> None:
    found = on_speed_drive(ROWS[case])
    low, high = band(ROWS[case]["check:contact_to_detection_ms"])
    expected_low, expected_high = found.detection
    assert is_rounded(low, expected_low * 1e3, 4)
    assert is_rounded(high, expected_high * 1e3, 4)
    steps_s = 2 * found.loose_mm / found.v
    assert found.T <= expected_high - expected_low - steps_s <= found.T * 1.4


@pytest.mark.parametrize("case", FOUND)
def test_place_and_forces_at_the_stop(case: str) -> None:
    """x_stop + F/k, to 1 um and an increment."""
    row, found = ROWS[case], on_speed_drive(ROWS[case])
    middle, width = tolerance(row["check:latch_mm"])
    assert is_rounded(middle, found.place[0], 5)
    assert is_rounded(width, PLACE_MM + found.increment, 5)
    low, high = band(row["check:latch_force_error_um"])
    assert is_rounded(high, (PLACE_MM + found.increment) * 1e3, 4)
    assert float(low) == -float(high)
    low, high = band(row["check:stop_force_n"])
    assert is_rounded(low, found.force[0], 3)
    assert is_rounded(high, found.force[1], 3)
    assert is_rounded(most(row["check:stop_force_end_n"]), found.force[1], 3)


@pytest.mark.parametrize("case", FOUND)
def test_the_motor_gives_its_whole_force_long_before_the_detection(case: str) -> None:
    """A lag of the limit is Kv e m 2 pi 60 Hz of the velocity loop alone: more than the force."""
    found = on_speed_drive(ROWS[case])
    since_contact_s = found.detection[0]
    loop = found.m_eff * 2 * 3.1415926535 * 60
    behind_mm = found.cnc_lag + found.v * (since_contact_s - 0.04)
    integral_n = loop * found.gain * behind_mm * 1e-3 * 0.04 / 8e-3
    assert loop * found.gain * behind_mm * 1e-3 + integral_n > 2 * found.limit_n


@pytest.mark.parametrize("case", FOUND)
def test_what_a_run_leaves(case: str) -> None:
    row = ROWS[case]
    assert row["check:msg:N60"] == "== 1"
    assert row["check:alarms"] == ("== 900741" if "00774" in case else "none")


@pytest.mark.parametrize("family", FAMILIES)
def test_each_family_has_its_own_parameters(family: str) -> None:
    """A conventional drive has no P-AXIS-00774: it counts as not set, and 00331 acts (900741)."""
    own = {case: row for case, row in ROWS.items() if family_of(row) == family}
    listed = on_speed_drive(next(iter(own.values()))).listed("kenngr.antr_typ")
    assert listed == FAMILIES[family]
    with_it = [case for case, row in own.items() if row[LAG_LIMIT] not in ("", "0")]
    if family == "conventional":
        assert with_it == ["conventional-00774"]
    else:
        assert len(with_it) >= 4
    found = [on_speed_drive(row) for case, row in own.items() if case in FOUND]
    assert {round(each.v * 60) for each in found} >= {100, 600, 3000}
    assert {round(each.T * 1e6) for each in found} == {1000, 2000}
    assert {each.criteria.lag_mm is None for each in found} == {True, False}
    assert {each.direction for each in found} == {1, -1}
    older = [row for row in own.values() if row["set:Z.kenngr.fixed_stop_nbr_cycles"]]
    assert older
    assert "900240" in {row["check:alarms"].removeprefix("== ") for row in own.values()}


def test_the_program_limits_no_torque() -> None:
    (program,) = {row["program"] for row in ROWS.values()}
    assert "#DRIVE" not in (PLANS / program).read_text(encoding="utf-8")
