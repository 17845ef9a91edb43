"""A rotary axis against a stop: degrees and N.m under their names, and no number under others."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.reports.pages import opened, whole

from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter, RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.judge.fixed_stop.findings import stop_findings
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.plant_values import power_of_arm
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.plan.plan import read_plan
from axisrig.kernel.cosim.fmi.units import known_units
from axisrig.reports.build import build_report

PLAN = read_plan(Path(__file__).parents[3] / "testplans" / "fixed_stop_rotary.csv")
# 8 um of lag in the drive of a linear axis are no millidegrees, and so on
ASKED = {
    "latch_force_error_um": "axis C turns: ask latch_force_error_mdeg",
    "latch_mm:C": "axis C turns: ask latch_deg",
    "stop_force_n_max": "axis C turns: ask stop_torque_nm_max",
    "lag_mm_max": "axis C turns: ask lag_deg_max",
    "probe_deflection_mm_max": "axis C turns and has no value in mm",
}


@pytest.fixture(scope="module")
def result() -> CaseResult:
    case = next(case for case in PLAN.cases if case.case == "lag")
    checks = [parse_check(metric, ">= 0", "here") for metric in ASKED]
    return run_case(replace(case, checks=(*case.checks, *checks)), RunFiles())


@pytest.mark.long
def test_what_is_told_in_mm_has_no_number_and_says_what_to_ask(result: CaseResult) -> None:
    found = {item.check.metric: (item.value, item.note) for item in result.checks}
    for metric, note in ASKED.items():
        assert found[metric] == (None, note)
    error_mdeg, _ = found["latch_force_error_mdeg"]
    assert abs(float(str(error_mdeg))) < 0.005, "half an increment, and not the -6.9 of N.m/rad"


@pytest.mark.long
def test_an_axis_that_does_not_turn_is_not_asked_in_degrees() -> None:
    plan = read_plan(PLAN.path.with_name("probe_stroke.csv"))
    case = next(case for case in plan.cases if case.case == "type-1")
    checks = [parse_check(metric, ">= 0", "here") for metric in ("latch_deg", "stop_torque_nm:Z")]
    deg, torque = run_case(replace(case, checks=tuple(checks)), RunFiles()).checks
    assert (deg.value, deg.note) == (None, "axis Z is given in mm: ask latch_mm")
    assert (torque.value, torque.note) == (None, "axis Z is given in N: ask stop_force_n")


@pytest.mark.long
def test_trace_and_report_are_in_degrees_and_newton_metres(
    result: CaseResult, tmp_path: Path
) -> None:
    assert result.facts is not None
    assert result.series is not None
    names = {name.partition(".")[2] for name in result.series.names}
    assert {"truth_deg", "velocity_deg_s", "cnc_lag_deg", "stop_deg", "stop_torque_nm"} <= names
    assert not {name for name in names if name.endswith(("_mm", "_mm_s", "_n"))}
    (stop,) = stop_findings(Observed(result.facts, result.series))
    assert stop.rotary == {"C": True}
    assert {value.unit for value in stop.values} == {"deg", "N.m"}
    (end,) = (v for v in stop.values if v.key == "stop_force_end")
    assert end.measured == pytest.approx(47.784, abs=0.002)

    with ResultsWriter(tmp_path / "out", [replace(PLAN, cases=(result.case,))], {}) as writer:
        writer.add(result)
    path = build_report(tmp_path / "out")
    page, (run,) = whole(path), opened(path).values()
    assert "lag above 1.5° for 100 ms" in page
    assert "47.78 N.m at the end" in page
    assert "47.78 N " not in page
    assert {"angle", "torque"} <= {plot["plot"] for plot in run.chart["plots"]}


@pytest.mark.parametrize(
    ("unit", "power"),
    [
        ("rad", 1),  # x = r phi
        ("rad/s", 1),
        ("N.m", -1),  # F = M/r
        ("1/s", 0),
        ("N/m", 0),
        ("kg", 0),
    ],
)
def test_a_quantity_of_a_rotation_as_a_slide_has_it(unit: str, power: int) -> None:
    assert power_of_arm(known_units()[unit].exponents) == power


@pytest.mark.parametrize(
    ("exponents", "power"),
    [
        ((1, 2, -2, 0, 0, 0, 0, -1), -2),  # N.m/rad: k = K/r^2
        ((1, 2, -1, 0, 0, 0, 0, -1), -2),  # N.m.s/rad
        ((1, 2, 0, 0, 0, 0, 0, 0), -2),  # kg.m2: m = J/r^2
        ((0, 0, 1, 0, 0, 0, 0, -1), -1),  # s/rad: share of damping per speed
    ],
)
def test_stiffness_inertia_and_damping_of_a_rotation(
    exponents: tuple[int, ...], power: int
) -> None:
    assert power_of_arm(exponents) == power
