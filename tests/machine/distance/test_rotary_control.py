"""Distance control of an axis that turns: degrees everywhere, under names that say so.

Z of the shipped rig is made a rotator: from 32 degrees, over a surface at 30, to a distance of 2;
the surface rises by 0.05.
"""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.judge.distance.findings import control_findings
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.judge.topics import DISTANCE_METRICS, observe
from axisrig.bench.plan.checks import known_metrics, parse_check, rotary_twin
from axisrig.reports.distance.section import sections
from axisrig.reports.distance.signals import plots, with_signals
from axisrig.reports.signals import chart

ROTATOR = "set:Z.kenngr.achs_typ=ACHSTYP_ROTATOR"
STEP = ("plant:gap.lift_mm=0.05", "plant:gap.lift_begin_ms=40.2", "plant:gap.lift_end_ms=40.2")
CALM = "set:Z.kenngr.distc.max_act_value_change=9000000"
PROGRAM = "N10 Z[DIST_CTRL ON CONST_DIST SET_DIST=2]\nN20 G04 0.15\nN30 Z[DIST_CTRL OFF NO_MOVE]"
COLUMNS = ("offset", "sensor", "distance_cnc", "surface_cnc", "filtered", "error", "delta", "step")
LENGTHS = ("mm", "um", "mm/s", "mm/s2")

Run = Callable[..., Any]


@pytest.fixture
def turned(run_nc: Run) -> Any:
    return run_nc(PROGRAM, "", CALM, ROTATOR, *STEP, base="distance-z.toml").observed


@pytest.fixture
def linear(run_nc: Run) -> Any:
    return run_nc(PROGRAM, "", CALM, *STEP, base="distance-z.toml").observed


def of(observed: Any, metric: str) -> Observation:
    return observe(observed, parse_check(metric, "!= 77", "here"))


def test_every_length_of_distance_control_has_an_angle() -> None:
    missing = [
        name
        for name in DISTANCE_METRICS
        if (metric := known_metrics()[name]).scope == "axis" and metric.unit in LENGTHS
        if rotary_twin(name) is None
    ]
    assert missing == []
    for name in DISTANCE_METRICS:
        twin = rotary_twin(name)
        if twin is not None:
            pairs = {"mm": "deg", "um": "mdeg", "mm/s": "deg/s", "mm/s2": "deg/s2"}
            assert known_metrics()[twin].unit == pairs[known_metrics()[name].unit]


def test_signals_and_metrics_of_an_axis_that_turns_are_angles(turned: Any, linear: Any) -> None:
    """The same numbers as those of the linear axis, which has its own names as before."""
    names, of_linear = set(turned.series.names), set(linear.series.names)
    assert {f"Z.{name}_deg" for name in COLUMNS} <= names
    assert {f"Z.{name}_mm" for name in COLUMNS} <= of_linear
    assert not [name for name in names if name.startswith("Z.") and name.endswith("_mm")]
    assert not [name for name in of_linear if name.startswith("Z.") and name.endswith("_deg")]
    for metric in ("offset_end_mm", "offset_mm_max", "distance_behind_end_um"):
        twin = rotary_twin(metric)
        assert twin is not None
        assert of(turned, twin).value == pytest.approx(of(linear, metric).value, abs=1e-6)
        assert of(turned, metric).value is None
        assert f"ask {twin}" in of(turned, metric).note
        assert f"ask {metric}" in of(linear, twin).note
    assert of(turned, "offset_model_error_mdeg").value == pytest.approx(0.0, abs=1e-9)


def test_the_report_of_an_axis_that_turns_has_degrees(turned: Any, linear: Any) -> None:
    for observed, unit, small, plot in ((turned, "°", "m°", "_angle"), (linear, "mm", "µm", "")):
        (block,) = control_findings(observed)
        assert {row.unit for row in block.limits} == {unit, f"{unit}/s", f"{unit}/s²"}
        info, trace = RunFindings(of_topics=[block]), observed.series.table()
        (section,) = sections(info, trace, "run", {})
        words = " ".join(line for _, line in section["happened"])
        assert f"SET_DIST 2 {unit}: offset 0 {unit} to 0.05 {unit}" in words
        assert (section["unit"], section["small"]) == (unit, small)
        shown, _ = chart(trace, info)
        found = {p["plot"] for p in shown["plots"]}
        assert {f"offset{plot}", f"distance{plot}", f"step{plot}"} <= found
        assert {limit["plot"] for limit in plots(trace, info).limits} <= found
        after = with_signals(trace, info).column_names
        assert f"Z.filtered_distance_{'deg' if plot else 'mm'}" in after
        assert not {name for name in after if name.startswith("Z.filtered_m")}
