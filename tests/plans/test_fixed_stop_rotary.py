"""Every limit of testplans/fixed_stop_rotary.csv, from closed forms of a turning table.

Nothing of the bench is imported: rig, list and plan are read as the text files they are. Angles in
degrees where a name does not say rad, times in s, torques in N.m.
"""

import csv
import math
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.plans.shipped_files import limits

PLANS = Path(__file__).parents[2] / "testplans"
SYNC_S = 48e-6  # test_shipped_bands.py recomputes it
DEMAND_CYCLES = 2  # P-AXIS-00191 of the list: the lag that the CNC judges is that of the drive

with (PLANS / "fixed_stop_rotary.csv").open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file)}

RIG = tomllib.loads((PLANS / "rigs" / "fixed-stop-rotary.toml").read_text(encoding="utf-8"))
LIST = (PLANS / "rigs" / RIG["axis"]["C"]["list"]).read_text(encoding="utf-8")
START = RIG["plant"]["table"]["start"]
DRIVE = RIG["drive"]["worm"]
T = RIG["cycle"]["period_us"] * 1e-6
AGE = RIG["cycle"]["cycle_offset_us"] * 1e-6 - SYNC_S
RATED = 2.2  # rated_torque_mnm, default of docs/rigs.md
DETECT = "set:C.kenngr.measure.fixed_stop_detect."


def _listed(name: str) -> float:
    match = re.search(rf"^{re.escape(name)}\s+(\d+)", LIST, re.M)
    assert match is not None, name
    return float(match[1])


A = _listed("getriebe[0].lslope_profil.a_grenz_stufe_1")
assert _listed("antr.nbr_delay_cycles") == DEMAND_CYCLES
INCREMENT = DRIVE["lead_mm"] / DRIVE["encoder_increments"]


@dataclass(frozen=True)
class Law:
    """What follows for one row; v in degrees/s, delta in degrees, torque in N.m."""

    row: dict[str, str]

    def _plant(self, name: str, start: str) -> float:
        return float(self.row[f"plant:table.{name}"] or START.get(start, 0.0))

    @property
    def direction(self) -> int:
        """Of the stop: 1 is met in positive direction."""
        return int(self.row["plant:table.stop_direction"] or 1)

    @property
    def stop(self) -> float:
        """Where it is."""
        return self._plant("stop_position_deg", "stop_position_deg")

    @property
    def v(self) -> float:
        """Feed."""
        return float(self.row["plc:V.E.FEED"]) / 60

    @property
    def torque(self) -> float:
        """Limit of the motor at the table, less what the imbalance takes: M i - d M_u sin phi."""
        gear = 360 / DRIVE["lead_mm"]
        limit = float(self.row["plc:V.E.LIMIT"]) / 1000 * RATED * gear
        pull = self._plant("imbalance", "imbalance") * math.sin(math.radians(self.stop))
        return limit - self.direction * pull

    @property
    def delta(self) -> float:
        """How deep it presses in: M/K."""
        return math.degrees(self.torque / self._plant("stop_stiffness", "stop_stiffness"))

    @property
    def lag(self) -> float:
        """In steady motion: w/Kv."""
        return self.v / START["kv"]

    @property
    def tau(self) -> float:
        """Minimum time."""
        return float(self.row[f"{DETECT}min_time"]) * 1e-6

    @property
    def found_after(self) -> float:
        """From the contact to the instant at which the criterion has held for the minimum time."""
        window = self.row[f"{DETECT}max_delta_position_window"]
        if window:
            assert float(window) / 1e4 >= self.delta, "else the coming to rest decides"
            return self.tau - (float(window) / 1e4 - self.delta) / self.v
        limit = float(self.row[f"{DETECT}pos_lag_limit"]) / 1e4
        assert limit > self.lag
        return (limit - self.lag + self.delta) / self.v + self.tau

    @property
    def excess(self) -> tuple[float, float]:
        """Of the set value beyond the latched position: it goes on until it has braked."""
        lead = self.lag + self.v * self.found_after - self.delta
        least = lead + self.v * (DEMAND_CYCLES - 1) * T + self.v**2 / (2 * A)
        return least, least + self.v * T


def expected(row: dict[str, str]) -> dict[str, tuple[float, float]]:
    """The limits of a row by metric."""
    law = Law(row)
    found = 1e3 * (law.found_after + AGE)
    latch = law.stop + law.direction * law.delta
    return {
        "contact_deg": (law.stop - 1e-4, law.stop + 1e-4),
        "contact_velocity_deg_s": (law.direction * law.v - 1e-3, law.direction * law.v + 1e-3),
        "contact_to_detection_ms": (found, found + 1e3 * T),
        "detection_error_ms": (1e3 * AGE, 1e3 * (AGE + T)),
        "latch_deg": (latch - 2e-5, latch + 2e-5),
        "latch_force_error_mdeg": (-0.01, 0.01),
        "stop_torque_nm": (law.torque - 0.02, law.torque + 0.02),
        "stop_torque_end_nm": (-math.inf, law.torque + 0.02),
        "command_overtravel_deg": law.excess,
        "lag_deg_max": law.excess,
        "after_run_torque_nm_max": (-math.inf, law.torque + 0.02),
        "after_run_motion_mdeg": (-math.inf, _listed("getriebe[0].window") / 10),
    }


@pytest.mark.parametrize("case", ROWS)
def test_limits_are_those_of_the_closed_forms(case: str) -> None:
    row = ROWS[case]
    for metric, (low, high) in expected(row).items():
        text = row[f"check:{metric}"]
        assert limits(text) == pytest.approx((low, high), abs=1e-5, rel=1e-6), metric
    assert 0.5 * INCREMENT * 1e3 < 0.01 / 2, "half an increment and its uncertainty"


def test_the_rows_differ_in_what_the_rotation_brings_in() -> None:
    torques = {name: round(Law(row).torque, 3) for name, row in ROWS.items()}
    assert torques["lag"] == 47.784
    assert torques["torque"] == pytest.approx(3 * torques["lag"])
    assert torques["imbalance"] == pytest.approx(
        47.784 - 20 * math.sin(math.radians(105)), abs=1e-3
    )
    assert Law(ROWS["stiff"]).delta == pytest.approx(Law(ROWS["lag"]).delta / 5)
    assert {Law(row).direction for row in ROWS.values()} == {1, -1}
