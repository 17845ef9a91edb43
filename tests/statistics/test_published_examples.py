"""Statistics against published examples and tables."""

import pytest

from axisrig.bench.statistics.distribution import grubbs, normal_plot
from axisrig.bench.statistics.estimates import cp, cp_of, cpk, cpk_of, line
from axisrig.bench.statistics.gage import GageStudy, gage_study
from axisrig.kernel.errors import UserError

# NIST StRD, linear regression, Norris: x, y
NORRIS_X = [
    *(0.2, 337.4, 118.2, 884.6, 10.1, 226.5, 666.3, 996.3, 448.6, 777.0, 558.2, 0.4),
    *(0.6, 775.5, 666.9, 338.0, 447.5, 11.6, 556.0, 228.1, 995.8, 887.6, 120.2, 0.3),
    *(0.3, 556.8, 339.1, 887.2, 999.0, 779.0, 11.1, 118.3, 229.2, 669.1, 448.9, 0.5),
]
NORRIS_Y = [
    *(0.1, 338.8, 118.1, 888.0, 9.2, 228.1, 668.5, 998.5, 449.1, 778.9, 559.2, 0.3),
    *(0.1, 778.1, 668.8, 339.3, 448.9, 10.8, 557.7, 228.3, 998.0, 888.8, 119.6, 0.3),
    *(0.6, 557.6, 339.3, 888.0, 998.5, 778.9, 10.2, 117.6, 228.9, 668.4, 449.2, 0.2),
]
T_34 = 2.0322445  # quantile of Student's t, 97.5 %, 34 degrees of freedom: tables

# AIAG, Measurement Systems Analysis, 4th edition: operators, repeats, ten parts
AIAG = [
    [
        [0.29, -0.56, 1.34, 0.47, -0.80, 0.02, 0.59, -0.31, 2.26, -1.36],
        [0.41, -0.68, 1.17, 0.50, -0.92, -0.11, 0.75, -0.20, 1.99, -1.25],
        [0.64, -0.58, 1.27, 0.64, -0.84, -0.21, 0.66, -0.17, 2.01, -1.31],
    ],
    [
        [0.08, -0.47, 1.19, 0.01, -0.56, -0.20, 0.47, -0.63, 1.80, -1.68],
        [0.25, -1.22, 0.94, 1.03, -1.20, 0.22, 0.55, 0.08, 2.12, -1.62],
        [0.07, -0.68, 1.34, 0.20, -1.28, 0.06, 0.83, -0.34, 2.19, -1.50],
    ],
    [
        [0.04, -1.38, 0.88, 0.14, -1.46, -0.29, 0.02, -0.46, 1.77, -1.49],
        [-0.11, -1.13, 1.09, 0.20, -1.07, -0.67, 0.01, -0.56, 1.45, -1.77],
        [-0.15, -0.96, 0.67, 0.11, -1.45, -0.49, 0.21, -0.49, 1.87, -2.16],
    ],
]
# README of the package GaugeRnR 0.6 (PyPI): operators, parts, repeats
README = [
    [[3.29, 3.41, 3.64], [2.44, 2.32, 2.42], [4.34, 4.17, 4.27], [3.47, 3.5, 3.64],
     [2.2, 2.08, 2.16]],
    [[3.08, 3.25, 3.07], [2.53, 1.78, 2.32], [4.19, 3.94, 4.34], [3.01, 4.03, 3.2],
     [2.44, 1.8, 1.72]],
    [[3.04, 2.89, 2.85], [1.62, 1.87, 2.04], [3.88, 4.09, 3.67], [3.14, 3.2, 3.11],
     [1.54, 1.93, 1.55]],
]  # fmt: skip


def by_part(data: list[list[list[float]]], order: str) -> list[list[list[float]]]:
    """Put a study into the order parts, operators, repeats; order: "opr" or "orp"."""
    part, repeat = (1, 2) if order == "opr" else (2, 1)
    counts = (len(data), len(data[0]), len(data[0][0]))
    return [
        [
            [row[p][r] if order == "opr" else row[r][p] for r in range(counts[repeat])]
            for row in data
        ]
        for p in range(counts[part])
    ]


def test_the_certified_line_of_norris_is_found() -> None:
    found = line(NORRIS_X, NORRIS_Y)
    assert found.slope.value == pytest.approx(1.00211681802045, rel=1e-13)
    assert found.intercept.value == pytest.approx(-0.262323073774029, rel=1e-10)
    assert found.residual_spread == pytest.approx(0.884796396144373, rel=1e-12)
    assert found.r_squared == pytest.approx(0.999993745883712, rel=1e-13)
    assert found.slope.bound == pytest.approx(T_34 * 0.429796848199937e-3, rel=1e-7)
    assert found.intercept.bound == pytest.approx(T_34 * 0.232818234301152, rel=1e-7)


def test_cp_and_its_bounds_are_those_of_montgomery() -> None:
    """Introduction to Statistical Quality Control, chapter 8: Cp 2.29 of 20 values."""
    found = cp_of(6.0 * 2.29, 1.0, 20)
    assert [round(v, 2) for v in (found.lower, found.upper)] == [1.57, 3.01]


def test_the_bounds_of_cpk_are_those_of_montgomery() -> None:
    """The same chapter: Cpk 1.33 of 20 values."""
    found = cpk_of(3.0 * 1.33, 1.0, 20)
    assert [round(v, 2) for v in (found.lower, found.upper)] == [0.88, 1.78]


def test_cp_and_cpk_are_those_of_the_handbook() -> None:
    """NIST/SEMATECH e-Handbook, 6.1.6: limits 8 and 20, mean 16, s 2."""
    values = (16.0 - 2.0**0.5, 16.0 + 2.0**0.5)
    assert cp(values, 8.0, 20.0).value == pytest.approx(1.0)
    assert cpk(values, 8.0, 20.0).value == pytest.approx(0.6667, abs=5e-5)
    assert cpk(values, None, 20.0).value == pytest.approx(0.6667, abs=5e-5)
    assert cpk(values, 8.0, None).value == pytest.approx(1.3333, abs=5e-5)
    with pytest.raises(UserError, match="needs a limit"):
        cpk(values, None, None)


def test_the_outlier_of_the_handbook_is_found() -> None:
    """NIST/SEMATECH e-Handbook, 1.3.5.17.1: Tietjen and Moore's mass spectrometer."""
    found = grubbs((199.31, 199.53, 200.19, 200.82, 201.92, 201.95, 202.18, 245.57))
    assert (found.index, round(found.statistic, 4)) == (7, 2.4688)
    assert found.ratio > 1.0


@pytest.mark.parametrize(
    ("n", "critical"), [(4, 1.481), (5, 1.715), (6, 1.887), (8, 2.126), (10, 2.290), (15, 2.549)]
)
def test_grubbs_critical_values_are_those_of_the_table(n: int, critical: float) -> None:
    """Two-sided, 5 %: ISO 5725-2, table 5; the last digit of old tables may be off by one."""
    assert grubbs(range(n)).critical == pytest.approx(critical, abs=1e-3)


def test_the_study_of_the_gage_package_comes_out() -> None:
    """The table of its README, where the interaction is not pooled."""
    found = gage_study(by_part(README, "opr"), is_pooled=False)
    assert [row.degrees for row in found.rows] == [4, 2, 8, 30]
    squares = [round(row.sum_of_squares, 3) for row in found.rows]
    assert squares == [28.909, 1.630, 0.065, 1.712]
    f = [row.f for row in found.rows]
    assert f == [pytest.approx(889.458, rel=1e-5), pytest.approx(100.322, rel=1e-5),
                 pytest.approx(0.142, abs=5e-4), None]  # fmt: skip
    assert found.rows[2].p_value == pytest.approx(0.996, abs=5e-4)
    assert deviations(found, 3) == (0.239, 0.232, 0.0, 0.896)
    assert round(found.total, 3) == 0.956


def deviations(study: GageStudy, digits: int) -> tuple[float, ...]:
    found = (study.repeatability, study.operator, study.interaction, study.part)
    return tuple(round(value, digits) for value in found)


def test_the_study_of_the_manual_comes_out() -> None:
    """AIAG, Measurement Systems Analysis, 4th edition, III-B: analysis of variance."""
    found = gage_study(by_part(AIAG, "orp"))
    assert found.is_pooled
    part, operator, both, rest = found.rows
    assert [round(row.sum_of_squares, 4) for row in (operator, part, both)] == [
        *(3.1673, 88.3619, 0.3590),
    ]
    assert (both.degrees, rest.degrees) == (18, 78)
    assert round(rest.sum_of_squares - both.sum_of_squares, 4) == 2.7589
    assert both.f == pytest.approx(0.434, abs=5e-4)
    assert deviations(found, 6) == (0.199933, 0.226838, 0.0, 1.042327)
    assert [round(v, 5) for v in (found.grr, found.total)] == [0.30237, 1.0853]
    assert (round(found.grr_pct, 1), found.categories) == (27.9, 4)


def test_the_ranks_of_the_normal_plot_are_fillibens() -> None:
    """NIST/SEMATECH e-Handbook, 1.3.3.21: medians 0.5^(1/n), (i - 0.3175) / (n + 0.365)."""
    from scipy.stats import norm, probplot  # noqa: PLC0415

    found = normal_plot((3.0, 1.0, 2.0, 5.0))
    medians = [1 - 0.5**0.25, 1.6825 / 4.365, 2.6825 / 4.365, 0.5**0.25]
    assert found.quantiles == pytest.approx([norm.ppf(p) for p in medians], abs=1e-12)
    assert found.values == (1.0, 2.0, 3.0, 5.0)
    (quantiles, _), (_, _, r) = probplot((3.0, 1.0, 2.0, 5.0))
    assert found.quantiles == pytest.approx(quantiles)
    assert found.correlation == pytest.approx(r)
