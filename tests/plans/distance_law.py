"""What follows for a row of testplans/distance_control.csv, from formulas written out here.

Nothing of the bench is imported: plan, rigs and lists are read as the text they are. Lengths in mm,
times in s. q delays by one cycle of T. An offset of cycle k stands at the SYNC of cycle k + 2, or
k + 3 without optimized scheduling: n = 1 or 2 dead cycles beside a loop that sees it in k + 1.
A carrier may bring 6064 and 60E4 `late` cycles later; a V.E. variable comes on none.
"""

import csv
import functools
import io
import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from axisrig.bench.plan.expanded import expanded_text
from axisrig.bench.plan.plan import read_plan

PLANS = Path(__file__).parents[2] / "testplans"
Polynomial = npt.NDArray[np.float64]
CONST, BOTH, SURFACE = "const", "both", "surface"
SURFACE_WORDS = ("SET_POS=", "set_pos=")
KALMAN_WALK = 0.1  # docs/ambiguities.md
HEIGHT = 30.0  # of the workpiece in every rig


def rows() -> dict[str, dict[str, str]]:
    """Return the plan by case, a column for each input and check."""
    text = expanded_text(read_plan(PLANS / "distance_control.csv"))
    return {row["case"]: row for row in csv.DictReader(io.StringIO(text))}


def _merged(base: dict[str, Any], top: dict[str, Any]) -> dict[str, Any]:
    whole = dict(base)
    for key, value in top.items():
        both = isinstance(value, dict) and isinstance(whole.get(key), dict)
        whole[key] = _merged(whole[key], value) if both else value
    return whole


@functools.cache
def rig_of(name: str) -> dict[str, Any]:
    """Return a rig with its base."""
    path = PLANS / name
    own = tomllib.loads(path.read_text(encoding="utf-8"))
    return _merged(rig_of(f"rigs/{own['base']}"), own) if "base" in own else own


@functools.cache
def _list(name: str) -> dict[str, str]:
    text = (PLANS / "rigs" / name).read_text(encoding="utf-8")
    lines = (line.partition("#")[0].split() for line in text.splitlines())
    return {words[0]: words[1] for words in lines if len(words) > 1}


@dataclass(frozen=True)
class Setup:
    """A row with what stands on the bench."""

    row: dict[str, str]
    late: int = 0

    def listed(self, name: str, otherwise: float = 0.0) -> float:
        """A number of distance control: row, else list."""
        return float(self.word(name) or otherwise)

    def word(self, name: str) -> str:
        """The same as a text, empty without one."""
        newer, older = f"kenngr.dist_ctrl[0].{name}", f"kenngr.distc.{name}"
        texts = (self.row.get(f"set:Z.{newer}"), self.row.get(f"set:Z.{older}"))
        return next((text for text in texts if text), "") or _list(
            self.rig["axis"]["Z"]["list"].removeprefix("rigs/")
        ).get(older, "")

    def number(self, column: str, otherwise: float = 0.0) -> float:
        """The number in a cell."""
        return float(self.row.get(column) or otherwise)

    @property
    def rig(self) -> dict[str, Any]:
        """The rig."""
        return rig_of(self.row["rig"])

    @property
    def program(self) -> str:
        """Text of the program."""
        return (PLANS / self.row["program"]).read_text(encoding="utf-8")

    @property
    def T(self) -> float:  # noqa: N802 - the letter of the formulas
        """Period."""
        return float(self.rig["cycle"]["period_us"]) * 1e-6

    @property
    def mode(self) -> str:
        """The law."""
        answer = self.program + (self.row.get("plc:Z.dist_ctrl") or "")
        if any(word in answer for word in SURFACE_WORDS):
            return SURFACE
        return BOTH if self.listed("mode_dist_use_both_encoder") else CONST

    @property
    def is_optimized(self) -> bool:
        """P-AXIS-00509."""
        return bool(self.listed("optimized_scheduling"))

    @property
    def is_clamped(self) -> bool:
        """Whether v_max and a_max clamp; else they are a slope."""
        table = self.rig.get("distance", {})
        return (self.row.get("distance:limiter") or table.get("limiter")) == "clamp"

    @property
    def reaction(self) -> int:
        """Cycles until an offset is sent."""
        return 0 if self.is_optimized else 1

    @property
    def n(self) -> int:
        """Dead cycles of a sensor value that is as old as the actual position."""
        return 1 + self.reaction + self.late

    @property
    def age(self) -> int:
        """By how many cycles the sensor value is older; below 0: newer."""
        if "SENSOR_VAR" in self.program:
            return int(self.rig["plc"]["V.E.SENSOR"].get("delay_cycles", 0)) - self.late
        return int(self.number("drive:servo.second_delay_cycles"))

    @property
    def sign(self) -> int:
        """-1 where the sensor value grows when the tool lifts."""
        if "SENSOR_VAR" in self.program:
            return -int(self.rig["plc"]["V.E.SENSOR"]["sign"])
        return -1 if self.row.get("set:Z.lr_hw[1].vz_istw") == "0" else 1

    @property
    def increment(self) -> float:
        """Of the sensor value."""
        return 1e-4 if "SENSOR_VAR" in self.program else 1e-5

    @property
    def kp(self) -> float:
        """P-AXIS-00759."""
        return self.listed("kp", 1.0)

    @property
    def g(self) -> float:
        """T/Tn."""
        tn = self.listed("i_tn")
        return self.T / tn if tn else 0.0

    @property
    def r(self) -> float:
        """Tv/T."""
        return self.listed("d_tv") / self.T

    @property
    def count(self) -> int:
        """P-AXIS-00413."""
        return int(self.listed("n_cycles", 4))

    @property
    def drive_lag(self) -> float:
        """(1 - f)/Kv of the drive; an axis that follows its ramp has none."""
        kv = self.number("plant:z.kv")
        return (1 - self.number("plant:z.feed_forward")) / kv if kv else 0.0

    @property
    def filter(self) -> tuple[Polynomial, Polynomial]:
        """Above and below of the filter in q."""
        count, share = self.count, self.listed("smoothing_factor", 0.7)
        mean = np.full(count, 1 / count)
        weights = (1 - share) ** np.arange(count)
        weights /= weights.sum()
        kind = self.word("filter_type")
        if kind == "LOWPASS":
            w = math.tan(math.pi * self.listed("low_pass_filter_fg_f0") * self.T)
            order = int(self.listed("low_pass_filter_order"))
            stage = np.array([1.0, 1.0]) * w, np.array([1 + w, w - 1])
            return tuple(  # type: ignore[return-value]
                functools.reduce(np.convolve, [part] * order) for part in stage
            )
        if kind == "EXPO_MEAN":
            return weights, np.ones(1)
        if kind.startswith("KALMAN"):
            return self._kalman(mean if kind == "KALMAN_MA" else weights), np.ones(1)
        return mean, np.ones(1)

    def _kalman(self, mean: Polynomial) -> Polynomial:
        late = float(np.arange(len(mean)) @ mean)
        ahead = np.zeros(2 * len(mean) - 1)
        ahead[: len(mean)] = mean * (1 + (1 + late) / late)
        ahead -= np.convolve(mean, mean) * (1 + late) / late
        sigma, energy = self.listed("kalman_sigma") * 1e-4, float(ahead @ ahead)
        ratio = (KALMAN_WALK / sigma) ** 2
        trust = (energy + ratio) / (energy + ratio + 1)
        return np.concatenate([[trust], (1 - trust) * ahead])

    @property
    def filter_delay(self) -> float:
        """By how many cycles the filter is late on a ramp."""
        above, below = self.filter
        parts = [float(np.arange(len(p)) @ p) / float(p.sum()) for p in (above, below)]
        return parts[0] - parts[1]

    # The loop: (1 - q)^j + kp (..) = 0

    @property
    def polynomials(self) -> tuple[Polynomial, Polynomial]:
        """A and B of A(q) + kp B(q); a drive without lag."""
        above, below = self.filter
        way = np.concatenate([np.zeros(1 + self.n), above])
        skewed = self.sign * np.concatenate([np.zeros(1 + self.n + self.age), above])
        add = np.polynomial.polynomial.polyadd
        if self.mode == CONST:
            back = skewed
        elif self.mode == BOTH:
            sent = np.concatenate([np.zeros(1 + self.reaction), above])
            back = add(add(skewed, -way), sent)
        else:
            back = add(np.concatenate([[0.0], below]), add(skewed, -way))
        start, control = np.convolve([1.0, -1.0], below), self.control
        if self.g:
            start = np.convolve(start, [1.0, -1.0])
        return start, np.convolve(control, back)

    @property
    def control(self) -> Polynomial:
        """C = 1 + g/(1 - q) + r (1 - q), times 1 - q with an integral part."""
        plain: Polynomial = np.array([1 + self.r, -self.r])
        if self.g:
            plain = np.convolve(plain, [1.0, -1.0])
            plain[0] += self.g
        return plain

    def growth(self, kp: float) -> float:
        """Magnitude of the largest pole."""
        start, gain = self.polynomials
        found = np.roots(np.polynomial.polynomial.polyadd(start, kp * gain))
        return float(np.max(np.abs(found), initial=0.0))

    @property
    def limit(self) -> float:
        """The kp at which a pole leaves the unit circle, at most 2."""
        low, high = (
            0.0,
            next(
                (kp for kp in np.arange(0.01, 2.2, 0.01) if self.growth(float(kp)) > 1 + 1e-10),
                math.inf,
            ),
        )
        if high > 2:
            return 2.0
        low = high - 0.01
        while high - low > 1e-9:
            middle = (low + high) / 2
            low, high = (low, middle) if self.growth(middle) > 1 + 1e-10 else (middle, high)
        return min(low, 2.0)

    def response(self, f: float) -> complex:
        """Offset over surface at a frequency (Hz)."""
        q = np.exp(-2j * math.pi * f * self.T)
        value = np.polynomial.polynomial.polyval
        above, _ = self.filter
        start, gain = self.polynomials
        driving = self.kp * value(q, self.control) * value(q, above) * q**self.age
        # below stands in start as well
        return complex(driving / (value(q, start) + self.kp * value(q, gain)))

    def sine_gain(self, f: float) -> float:
        """Error of the distance over the surface."""
        q = np.exp(-2j * math.pi * f * self.T)
        return abs(1 - self.response(f) * q ** (1 + self.n))

    # On a ramp

    @property
    def rise(self) -> float:
        """Speed of the surface that the row judges."""
        ramp = self.number("plant:gap.workpiece.ramp.rise_mm")
        if ramp:
            length = self.number("plant:gap.workpiece.ramp.length_mm")
            return ramp / length * self.number("plc:V.E.FEED") / 60
        times = self.number("plant:gap.lift_end_ms") - self.number("plant:gap.lift_begin_ms")
        return self.number("plant:gap.lift_mm") / times * 1e3

    @property
    def behind(self) -> float:
        """By how much the tool is behind on it."""
        cycles = 1 / self.kp
        if self.mode == SURFACE:
            cycles += self.n + self.filter_delay
        if self.mode == BOTH:
            cycles += self.n - self.reaction
        lag = self.drive_lag if self.mode != CONST else 0.0
        return self.rise * (cycles * self.T + lag)
