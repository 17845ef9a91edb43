"""What a row of testplans/fixed_stop_timing.csv or fixed_stop_sercos.csv has on the bench.

Nothing of the bench is imported: plan, rigs, lists and programs are read as the text they are.
Lengths in mm, times in s, forces in N.
"""

import csv
import functools
import math
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

PLANS = Path(__file__).parents[2] / "testplans"
SYNC_S = 48e-6  # test_shipped_bands.py recomputes it
DEMAND_CYCLES = 2

# What rigs leave out: fmus/README.md, "ServoAxis", "GravityAxis", "ScrewAxis"
PLANT_DEFAULTS = {
    "position_start_mm": 0.0,
    "kv": 10.0,
    "feed_forward": 0.0,
    "mass_kg": 120.0,
    "coulomb_friction_n": 120.0,
    "counterbalance_n": 877.0,
    "backlash_um": 0.0,
    "stop_position_mm": 1e6,
    "stop_direction": 1.0,
    "stop_stiffness_n_um": 20.0,
    "stop_damping": 20.0,
    "stop_speed_mm_s": 0.0,
}
ROTOR_INERTIA, VISCOUS, SCREW_STIFFNESS = 1.8e-4, 800.0, 120e3
FRICTION_COULOMB, FRICTION_BREAKAWAY, STRIBECK_MM_S = 120.0, 160.0, 5.0
GRAVITY = 9.80665
TORQUE_LIMIT = "(?:KEY=TORQUE_LIMIT|ID=S-0-0092)"
DETECT, OLDER = "kenngr.measure.fixed_stop_detect.", "antr.fixed_stop.detect."


def rows(plan: str = "fixed_stop_timing") -> dict[str, dict[str, str]]:
    """Return a plan by case."""
    with (PLANS / f"{plan}.csv").open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


def _merged(base: dict[str, Any], top: dict[str, Any]) -> dict[str, Any]:
    whole = dict(base)
    for key, value in top.items():
        below = whole.get(key)
        both = isinstance(below, dict) and isinstance(value, dict)
        whole[key] = _merged(below, value) if both else value  # type: ignore[arg-type]
    return whole


@functools.cache
def _rig(path: Path) -> dict[str, Any]:
    own = tomllib.loads(path.read_text(encoding="utf-8"))
    return _merged(_rig(path.parent / own["base"]), own) if "base" in own else own


@functools.cache
def _list(path: Path) -> dict[str, str]:
    lines = (
        line.partition("#")[0].split() for line in path.read_text(encoding="utf-8").split("\n")
    )
    return {words[0]: words[1] for words in lines if len(words) > 1}


@dataclass(frozen=True)
class Criteria:
    """None = no criterion. tau_cycles: whole cycles, rounded up."""

    lag_mm: float | None
    window_mm: float | None
    tau_cycles: int

    @property
    def can_detect(self) -> bool:
        """Whether anything can find a stop."""
        return self.lag_mm is not None or self.window_mm is not None


@dataclass(frozen=True)
class Setup:
    """One axis of a row.

    direction: +1 or -1. v: along the axis. block: length of the path. armed_from: path of the
    interpolator along this axis from which on any axis is judged.
    """

    row: dict[str, str]
    name: str
    direction: int
    v: float
    block: float
    armed_from: float = 0.0

    @property
    def rig(self) -> dict[str, Any]:
        """The rig with its base."""
        return _rig(PLANS / self.row["rig"])

    def plant(self, name: str) -> float:
        """A value of the plant: row, rig, model."""
        of_axis = self.rig["axis"][self.name]["plant"]
        cell = self.row.get(f"plant:{of_axis}.{name}")
        start = self.rig["plant"][of_axis].get("start", {})
        return float(cell or start.get(name, PLANT_DEFAULTS.get(name, 0.0)))

    def listed(self, name: str) -> str | None:
        """A parameter: row, list; None when neither sets it."""
        cell = self.row.get(f"set:{self.name}.{name}")
        return cell or _list(PLANS / "rigs" / self.rig["axis"][self.name]["list"]).get(name)

    def _chain(self, *names: tuple[str, int]) -> float:
        """The first link that its rule does not pass on; each with its default."""
        *links, (last, default) = names
        for name, unset in links:
            value = float(self.listed(name) or unset)
            is_passed_on = value == 0 if "min_time" in name else value < 0
            if not is_passed_on:
                return value
        return float(self.listed(last) or default)

    @property
    def T(self) -> float:  # noqa: N802 - the letter of the formulas
        """Period."""
        return float(self.rig["cycle"]["period_us"]) * 1e-6

    @property
    def judged_s(self) -> float:
        """From the instant of an actual position to the NC cycle that judges it."""
        return float(self.rig["cycle"]["cycle_offset_us"]) * 1e-6 - SYNC_S

    @property
    def buffer_cycles(self) -> int:
        """Set positions between interpolator and drive."""
        return int(self.rig["cycle"].get("buffer_cycles", 0))

    @property
    def delay_cycles(self) -> int:
        """P-AXIS-00191."""
        return int(self.listed("antr.nbr_delay_cycles") or 4)

    @property
    def a(self) -> float:
        """Of the run: rapid dynamics (P-CHAN-00296 = 0), one step only; mm/s²."""
        first = float(self.listed("getriebe[0].lslope_profil.a_grenz_stufe_1") or 1000)
        assert self.v <= 100, "the second step would need its own term"
        return first

    @property
    def window_mm(self) -> float:
        """Exact-stop window."""
        return float(self.listed("getriebe[0].window") or 0) * 1e-4

    @property
    def criteria(self) -> Criteria:
        """774, 769, 331; 778, 773; 775, 770, 332. Without a time there is no window."""
        lag = self._chain(
            (DETECT + "pos_lag_limit", -1),
            (OLDER + "pos_lag_limit", -1),
            ("kenngr.fixed_stop_pos_lag_limit", 0),
        )
        window = self._chain(
            (DETECT + "max_delta_position_window", -1), (OLDER + "max_delta_position_window", -1)
        )
        tau_us = self._chain((DETECT + "min_time", 0), (OLDER + "min_time", 0))
        cycles = math.ceil(tau_us * 1e-6 / self.T - 1e-9)
        cycles = cycles or int(self.listed("kenngr.fixed_stop_nbr_cycles") or 0)
        return Criteria(
            lag * 1e-4 if lag > 0 else None,
            window * 1e-4 if window >= 0 and cycles else None,
            cycles,
        )

    @property
    def arming(self) -> float:
        """776, 771 and 777, 772: the smaller of what is specified; path of the block.

        Unset, 776 is 0 and does not ask 771; 777 is -1 and asks 772.
        """
        ways = []
        for last, scale, unset in (
            ("start_distance", 1e-4, None),
            ("start_distance_per_mille", self.block / 1e3, "-1"),
        ):
            own, older = self.listed(DETECT + last) or unset, self.listed(OLDER + last) or "-1"
            if own is not None and max(float(own), float(older)) >= 0:
                ways.append((float(own) if float(own) >= 0 else float(older)) * scale)
        return min(ways, default=0.0)

    @property
    def limit_n(self) -> float:
        """Force at the torque limit: per mille of the rated torque, 2 pi / lead."""
        drive = self.rig["drive"]["servo"]
        rated_mnm = float(
            self.row.get("drive:servo.rated_torque_mnm") or drive.get("rated_torque_mnm", 2200)
        )
        program = (PLANS / self.row["program"]).read_text(encoding="utf-8")
        (value,) = set(re.findall(rf"AX={self.name} {TORQUE_LIMIT} VAL=(\S+) ", program)[:1])
        scale = float(self.listed("antr.function[1].scaling_factor") or 1)
        per_mille = (
            float(self.row["plc:V.E.LIMIT"]) if value == "V.E.LIMIT" else float(value) * scale
        )
        return rated_mnm * 1e-3 * 2 * math.pi / (float(drive["lead_mm"]) * 1e-3) * per_mille / 1000

    @property
    def model(self) -> str:
        """Name of the plant model."""
        return str(self.rig["plant"][self.rig["axis"][self.name]["plant"]]["fmu"]).split(".")[-1]

    @property
    def increment(self) -> float:
        """Of the encoder."""
        drive = self.rig["drive"]["servo"]
        return float(drive["lead_mm"]) / float(drive["encoder_increments"])

    def position(self, path: float) -> float:
        """Position of a path."""
        return self.plant("position_start_mm") + self.direction * path


# What stands in a cell of the table


def band(text: str) -> tuple[str, str]:
    """Both ends of `low .. high`."""
    low, high = text.split(" .. ")
    return low, high


def tolerance(text: str) -> tuple[str, str]:
    """Middle and width of `middle +- width`."""
    middle, width = text.split(" +- ")
    return middle, width


def most(text: str) -> str:
    """The limit of `<= limit`."""
    sign, limit = text.split()
    assert sign == "<="
    return limit


def is_rounded(text: str, value: float, digits: int) -> bool:
    """Whether a limit is the value rounded to so many digits behind the point."""
    assert len(text.partition(".")[2]) == digits, text
    return abs(float(text) - value) <= 0.5000001 * 10**-digits
