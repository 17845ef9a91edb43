"""Studies of a measuring device: type 1 against a reference, repeatability and reproducibility."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from axisrig.bench.statistics.estimates import (
    CONFIDENCE,
    Estimate,
    Numbers,
    Sample,
    cp_of,
    cpk_of,
    mean,
    numbers,
    standard_deviation,
)
from axisrig.kernel.errors import UserError

POOLED_ABOVE = 0.05
"""An interaction whose p-value is above this is counted as repeatability."""
DRAWS, SEED = 20_000, 1
"""Of the variances that the mean squares of a study may have come from."""
TOLERANCE_SHARE = 0.2
"""Part of the tolerance that a type-1 study allows for 6 s of the device."""


@dataclass(frozen=True)
class TypeOne:
    """A type-1 study. bias: mean less reference. s: standard deviation. Both in the values' unit.

    cg, cgk: capability of the device without and with its bias. bias_p_value: of no bias, by t.
    """

    bias: Estimate
    s: float
    cg: Estimate
    cgk: Estimate
    bias_p_value: float


@dataclass(frozen=True)
class Source:
    """A row of the analysis of variance. f, p_value: None where nothing is tested."""

    degrees: int
    sum_of_squares: float
    f: float | None = None
    p_value: float | None = None

    @property
    def mean_square(self) -> float:
        """Sum of squares for each degree of freedom."""
        return self.sum_of_squares / self.degrees


@dataclass(frozen=True)
class GageStudy:
    """A crossed study of repeatability and reproducibility. Standard deviations, values' unit.

    repeatability: equipment. operator, interaction: make up `reproducibility`. part: between parts.
    grr: of the device, repeatability and reproducibility; grr_pct: in percent of the total, 0 where
    nothing varies. is_pooled: the interaction is counted as repeatability, and is 0 here.
    counts: of parts, operators, repeats. rows: part, operator, interaction, repeatability (of both
    when pooled).
    """

    repeatability: float
    operator: float
    interaction: float
    part: float
    reproducibility: float
    grr: float
    total: float
    grr_pct: float
    is_pooled: bool
    rows: tuple[Source, Source, Source, Source]
    counts: tuple[int, int, int]

    @property
    def categories(self) -> int:
        """Parts that the device can tell apart: 1.41 part / grr, rounded down.

        Source: AIAG, Measurement Systems Analysis, 4th edition, III-B (ndc).
        """
        return int(1.41 * self.part / self.grr) if self.grr else 0

    def estimate(self, name: str) -> Estimate:
        """Return one of the standard deviations, or `grr_pct`, with its bounds.

        Each mean square is a variance times chi-square over its degrees of freedom; the bounds are
        those of the value over DRAWS sets of variances that may have given the mean squares
        (generalized confidence intervals). Source: Hamada and Weerahandi, Journal of Quality
        Technology 32 (2000) 241.
        """
        generator = np.random.default_rng(SEED)
        drawn = [row.sum_of_squares / generator.chisquare(row.degrees, DRAWS) for row in self.rows]
        values = _spreads(np.array(drawn), self.counts, is_pooled=self.is_pooled)[name]
        tail = 50.0 * (1.0 - CONFIDENCE)
        lower, upper = np.percentile(values, (tail, 100.0 - tail))
        n = self.counts[0] * self.counts[1] * self.counts[2]
        return Estimate(float(getattr(self, name)), float(lower), float(upper), n)


def _spreads(
    squares: Numbers, counts: tuple[int, int, int], *, is_pooled: bool
) -> dict[str, Numbers]:
    """Return what mean squares say, shape (4, n): of part, operator, interaction, repeatability.

    A variance below 0 counts as 0.
    """
    parts, operators, repeats = counts
    part, operator, both, rest = squares
    against = rest if is_pooled else both

    def deviation(row: Numbers, under: Numbers, count: int) -> Numbers:
        return np.sqrt(np.maximum((row - under) / count, 0.0))

    of_operator = deviation(operator, against, parts * repeats)
    interaction = np.zeros_like(rest) if is_pooled else deviation(both, rest, repeats)
    of_part, repeatability = deviation(part, against, operators * repeats), np.sqrt(rest)
    reproducibility = np.hypot(of_operator, interaction)
    grr = np.hypot(repeatability, reproducibility)
    total = np.hypot(grr, of_part)
    percent = 100.0 * np.divide(grr, total, out=np.zeros_like(total), where=total > 0.0)
    return {
        "repeatability": repeatability,
        "operator": of_operator,
        "interaction": interaction,
        "part": of_part,
        "reproducibility": reproducibility,
        "grr": grr,
        "total": total,
        "grr_pct": percent,
    }


def type_1(values: Sample, reference: float, tolerance: float) -> TypeOne:
    """Judge a device by n measurements of one thing that is known.

    Cg = 0.2 T / (6 s), Cgk = (0.1 T - |bias|) / (3 s), T the tolerance that the device has to
    measure; bias by Student's t. Bounds of Cg by chi-square, of Cgk by Bissell's approximation, as
    of Cp and Cpk. reference, tolerance: unit of the values.
    Source: Bosch, Quality Management booklet 10; VDA 5. Raises UserError for fewer than 2 values,
    for a tolerance that is not positive, and without spread.
    """
    from scipy.special import stdtr  # noqa: PLC0415 - takes long to load

    if not tolerance > 0.0:
        raise UserError("the tolerance is not positive", value=tolerance, allowed="above 0")
    s, n = standard_deviation(values), len(values)
    found = mean(values)
    off = found.value - reference
    allowed = TOLERANCE_SHARE * tolerance
    cg, cgk = cp_of(allowed, s, n), cpk_of(allowed / 2.0 - abs(off), s, n)
    t = abs(off) / (s / n**0.5)
    bias = Estimate(off, found.lower - reference, found.upper - reference, n)
    return TypeOne(bias, s, cg, cgk, 2.0 * float(stdtr(n - 1, -t)))


def gage_study(values: npt.ArrayLike, *, is_pooled: bool | None = None) -> GageStudy:
    """Analyse a crossed study by the variance between parts, operators and repeats.

    values: shape (parts, operators, repeats). is_pooled: count the interaction as repeatability;
    None: where its p-value is above POOLED_ABOVE. A variance below 0 counts as 0.
    Source: AIAG, Measurement Systems Analysis, 4th edition, appendix A; Montgomery, Design and
    Analysis of Experiments, 13.3 (two-factor random effects).
    Raises UserError for fewer than 2 parts, operators or repeats.
    """
    from scipy.special import fdtrc  # noqa: PLC0415 - takes long to load

    x = np.asarray(values, dtype=np.float64)
    if x.ndim != 3 or min(x.shape) < 2:
        raise UserError("needs two or more parts, operators and repeats", value=x.shape)
    numbers(x.ravel().tolist(), x.size)
    p, o, r = x.shape
    x = x - np.mean(x)
    of_parts, of_operators, cells = np.mean(x, (1, 2)), np.mean(x, (0, 2)), np.mean(x, 2)
    apart = cells - of_parts[:, None] - of_operators[None, :]
    rest = Source(p * o * (r - 1), float(np.sum((x - cells[:, :, None]) ** 2)))
    both = Source((p - 1) * (o - 1), float(r * np.sum(apart**2)))

    def tested(row: Source, against: Source) -> Source:
        if against.mean_square == 0.0:
            return row
        f = row.mean_square / against.mean_square
        p_value = float(fdtrc(row.degrees, against.degrees, f))
        return Source(row.degrees, row.sum_of_squares, f, p_value)

    both = tested(both, rest)
    if is_pooled is None:
        is_pooled = both.sum_of_squares == 0.0 or (
            both.p_value is not None and both.p_value > POOLED_ABOVE
        )
    if is_pooled:
        rest = Source(rest.degrees + both.degrees, rest.sum_of_squares + both.sum_of_squares)
    against = rest if is_pooled else both
    part = tested(Source(p - 1, float(o * r * np.sum(of_parts**2))), against)
    operator = tested(Source(o - 1, float(p * r * np.sum(of_operators**2))), against)

    rows = (part, operator, both, rest)
    squares = np.array([[row.mean_square] for row in rows])
    found = _spreads(squares, (p, o, r), is_pooled=is_pooled)
    spreads = {name: float(value[0]) for name, value in found.items()}
    return GageStudy(**spreads, is_pooled=is_pooled, rows=rows, counts=(p, o, r))
