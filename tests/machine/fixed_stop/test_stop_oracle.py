"""The oracle of a run to a fixed stop beside the run: metrics, marks, and the block for the report.

The numbers: 600 mm/min, Kv 40 1/s, T 1 ms, offset 600 us, SYNC of 48 us, 40 % of 1382 N on 20 N/um.
"""

import csv
import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
from tests.machine.conftest import RIGS
from tests.machine.fixed_stop.conftest import blocks, observed

from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.judge.topics import events
from axisrig.bench.plan.plan import read_plan

DETECT = "set:Z.kenngr.measure.fixed_stop_detect."
METRICS = (
    *("detection_error_ms", "detection_followed_error_ms", "detection_criterion"),
    *("found_without_contact", "latch_force_error_um", "contact_mm", "latch_error_um"),
    *("contact_to_detection_ms", "stop_force_n", "stop_force_n_max", "stop_force_end_n"),
    *("command_overtravel_mm", "relax_lag_mm", "relax_ms", "after_run_motion_um"),
)
PROGRAM = """\
%oracle
N030 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=40 WAIT]
N040 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=4294967295 WAIT]
N050 #MEAS MODE[7]
N060 G100 G90 Z140 F600
N070 #TIME 0.02
N080 M30
"""
Run = Callable[..., tuple[dict[str, Any], dict[str, str], CaseResult]]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Return `run(name=value)`: criteria of Z; gives values and notes of METRICS and the result."""

    def go(**detect: int) -> tuple[dict[str, Any], dict[str, str], CaseResult]:
        (tmp_path / "p.nc").write_text(PROGRAM, encoding="utf-8")
        cells = {
            "case": "c",
            "program": "p.nc",
            "rig": str(RIGS / "drive-functions.toml"),
            "set:Z.kenngr.measure.signal": "FIXED_STOP",
            "plant:z.stop_position_mm": "135",
            "plant:z.stop_damping": "60",
            **{f"{DETECT}{name}": str(value) for name, value in detect.items()},
            **{f"check:{name}": "!= none" if "crit" in name else "> -1e9" for name in METRICS},
        }
        plan = tmp_path / "plan.csv"
        with plan.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(cells))
            writer.writeheader()
            writer.writerow(cells)
        (case,) = read_plan(plan).cases
        result = run_case(case, RunFiles())
        assert result.error is None, result.error
        values = {item.check.metric: item.value for item in result.checks}
        return values, {item.check.metric: item.note for item in result.checks}, result

    return go


@pytest.mark.long
def test_a_run_shows_what_the_closed_forms_say(run: Run) -> None:
    values, notes, result = run(
        pos_lag_limit=9000, min_time=65_400, max_delta_position_window=200, start_distance=10_000
    )
    assert 0.5 < values["detection_error_ms"] < 1.6, notes
    assert values["detection_followed_error_ms"] == 0.0
    assert values["detection_criterion"] == "lag"
    assert values["found_without_contact"] == 0
    assert abs(values["latch_force_error_um"]) < 0.02
    assert values["contact_mm"] == pytest.approx(135.0, abs=1e-9)
    assert values["latch_error_um"] is None
    assert "a stop yields" in notes["latch_error_um"]
    assert values["stop_force_n"] == pytest.approx(552.9, abs=1.0)  # 0.4 * 2.2 Nm * 2 pi / 10 mm
    assert values["stop_force_n_max"] >= values["stop_force_n"] - 1e-6
    assert values["after_run_motion_um"] < 0.1

    (found,) = blocks(result)
    assert json.dumps(asdict(found), allow_nan=False), "finite numbers"
    marks = {mark.key: mark for mark in found.marks}
    assert found.is_found
    for key in ("armed", "beyond", "window", "detected"):
        assert marks[key].is_inside, marks[key]
    assert marks["beyond"].high_ns - marks["beyond"].low_ns < 1.2e6
    order = [mark.key for mark in found.marks]
    assert order == [key for key in order if key in marks], "one mark of each for one axis"
    assert {"monitoring_off", "contact", "relax_begin", "relax_end", "monitoring_on"} <= set(order)
    for value in found.values:
        if value.low is not None:
            assert value.low - 1e-4 <= value.measured, value
        if value.high is not None:
            assert value.measured <= value.high + 1e-4, value
    values_told = {value.key: value for value in found.values}
    # F + sqrt(F² + k m v²), m = 120 kg and 1.8e-4 kg m² on 10 mm: 191.06 kg
    assert values_told["stop_force_max"].high == pytest.approx(552.9 + 829.3, abs=2.0)
    assert found.prediction == "contact of Z with its stop, found by lag and window"
    labels = [event.label for event in events(observed(result))]
    assert "Z: contact at the stop" in labels
    assert "Z: lag above its limit" in labels
    assert "SYNC that sampled the latch status" not in labels


@pytest.mark.long
def test_a_limit_below_the_running_lag_is_a_false_trigger_in_the_predicted_cycle(run: Run) -> None:
    values, notes, result = run(pos_lag_limit=2000, min_time=20_000, start_distance_per_mille=300)
    assert values["found_without_contact"] == 1
    assert values["detection_error_ms"] is None
    assert "meets no stop" in notes["detection_error_ms"]
    assert values["detection_followed_error_ms"] == 0.0
    (found,) = blocks(result)
    assert "the lag limit 0.2 mm is not above the running lag" in found.prediction
    assert found.limits["Z"].arming_mm == pytest.approx(3.0)


@pytest.mark.long
def test_without_a_criterion_nothing_is_foretold_or_found(run: Run) -> None:
    values, notes, result = run(pos_lag_limit=0)
    assert values["detection_error_ms"] is None
    assert notes["detection_error_ms"] == "no stop was found"
    assert values["detection_criterion"] == "none"
    (found,) = blocks(result)
    assert found.prediction == "nothing can detect: no criterion is on"
    assert not found.is_found
