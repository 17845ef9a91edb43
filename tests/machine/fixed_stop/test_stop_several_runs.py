"""Several runs to fixed stops in one program: which of them a metric judges, and a lost contact."""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.machine.conftest import RIGS
from tests.machine.fixed_stop.conftest import blocks

from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.judge.observed.plant_values import PlantValues
from axisrig.bench.plan.plan import read_plan

PRESSED_MM = 0.1 * 2 * np.pi * 9.0 / 0.010 / 20e6 * 1e3  # 10 % of 9 N.m, 10 mm, 20 N/um
LIMITED = "\n".join(
    f"#IDENT WR SYN [AXNR {number} ID S-0-0092 VAL=100 TYP 2 DEC 0 SERC]\n"
    f"#IDENT WR SYN [AXNR {number} ID S-0-0159 VAL=0 TYP 4 DEC 0 SERC]"
    for number in (1, 2)
)
BOTH = f"""\
%both
{LIMITED}
X[INDP_SYN G100 G90 POS=200 FEED=600] Y[INDP_SYN G100 G90 POS=50 FEED=300]
G1 X120 Y0 F1000
M30
"""
STOPS = {
    "rig": str(RIGS / "fixed-stop-gantry.toml"),
    "plant:x.position_start_mm": "125",
    "plant:y.stop_position_mm": "6",
}
ONE = """\
%one
N030 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=40 WAIT]
N040 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=4294967295 WAIT]
N050 #MEAS MODE[7]
N060 G100 G90 Z140 F{feed}
N080 M30
"""
DETECT = "kenngr.measure.fixed_stop_detect."
STOP = {
    "rig": str(RIGS / "drive-functions.toml"),
    "set:Z.kenngr.measure.signal": "FIXED_STOP",
    f"set:Z.{DETECT}pos_lag_limit": "15000",
    f"set:Z.{DETECT}min_time": "100000",
    "plant:z.stop_position_mm": "135",
}
TELLS = ("contact_to_detection_ms", "found_without_contact")
OF_AXES = (
    *("latch_mm", "latch_force_error_um", "contact_mm", "contact_to_detection_ms"),
    *("detection_criterion", "found_without_contact", "stop_force_n_max"),
)
Seen = tuple[dict[str, Any], dict[str, str], CaseResult]
Judge = Callable[..., Seen]


@pytest.fixture
def judge(tmp_path: Path) -> Judge:
    """Return `judge(program, metrics, cells)`: values and notes of metrics, and the result."""

    def go(program: str, metrics: tuple[str, ...], cells: dict[str, str]) -> Seen:
        (tmp_path / "p.nc").write_text(program, encoding="utf-8")
        conditions = {
            f"check:{name}": "!= none" if "crit" in name else "> -1e9" for name in metrics
        }
        row = {"case": "c", "program": "p.nc", **cells, **conditions}
        with (tmp_path / "plan.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(row))
            writer.writeheader()
            writer.writerow(row)
        (case,) = read_plan(tmp_path / "plan.csv").cases
        result = run_case(case, RunFiles())
        assert result.error is None, result.error
        values = {item.check.metric: item.value for item in result.checks}
        return values, {item.check.metric: item.note for item in result.checks}, result

    return go


@pytest.fixture
def judge_both(judge: Judge) -> Judge:
    """Return `judge_both(cells)`: X from 125 to its stop at 130, Y from 0 to its stop at 6 mm."""

    def go(cells: dict[str, str]) -> Seen:
        metrics = [name for metric in OF_AXES for name in (metric, f"{metric}:X", f"{metric}:Y")]
        return judge(BOTH, tuple(metrics), {**STOPS, **cells})

    return go


@pytest.mark.long
def test_each_axis_is_judged_in_the_last_run_that_it_takes_part_in(judge_both: Judge) -> None:
    """Lag beyond 0.5 mm at t_c + (L - v/Kv + F/k)/v, then 100 ms; X 10 mm/s, Y 5 mm/s."""
    values, _, result = judge_both({})
    assert [list(run.axes) for run in result.facts.runs] == [["X"], ["Y"]]
    for axis, place_mm, feed_mm_s in (("X", 130.0, 10.0), ("Y", 6.0, 5.0)):
        assert values[f"latch_mm:{axis}"] == pytest.approx(place_mm + PRESSED_MM, abs=0.001)
        assert values[f"latch_force_error_um:{axis}"] == pytest.approx(0.0, abs=0.05)
        assert values[f"contact_mm:{axis}"] == pytest.approx(place_mm, abs=1e-6)
        wanted_ms = (0.5 - feed_mm_s / 40.0 + PRESSED_MM) / feed_mm_s * 1e3 + 100.0
        assert 0.0 <= values[f"contact_to_detection_ms:{axis}"] - wanted_ms <= 2.0
        assert values[f"detection_criterion:{axis}"] == "lag"
        assert values[f"found_without_contact:{axis}"] == 0
    assert values["contact_to_detection_ms"] == values["contact_to_detection_ms:Y"]


@pytest.mark.long
def test_a_stop_on_an_unknown_side_is_no_missing_contact(
    judge: Judge, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An FMU of another maker gives force and face of its stop, and parameters of its own."""
    known = PlantValues.get

    def others(values: PlantValues, *names: str) -> float | None:
        return None if any(name.startswith("stop") for name in names) else known(values, *names)

    monkeypatch.setattr(PlantValues, "get", others)
    values, notes, _ = judge(ONE.format(feed=600), (*TELLS, "stop_force_n_max"), STOP)
    assert values["stop_force_n_max"] > 100.0
    for name in TELLS:
        assert values[name] is None
        assert "no stop_direction" in notes[name]


@pytest.mark.long
def test_a_false_trigger_in_an_earlier_run_is_not_hidden_by_a_good_last_one(
    judge_both: Judge,
) -> None:
    """The running lag of X is 10/40 mm, its limit 0.2 mm."""
    values, notes, _ = judge_both({f"set:X.{DETECT}pos_lag_limit": "2000"})
    assert values["found_without_contact"] == 1
    assert notes["found_without_contact"] == "fixed stop 1 of 2, axis X"
    assert values["found_without_contact:X"] == 1
    assert values["found_without_contact:Y"] == 0
    assert 125.0 < values["latch_mm:X"] < 130.0
    assert values["latch_mm:Y"] == pytest.approx(6.0 + PRESSED_MM, abs=0.001)
    assert values["stop_force_n_max:X"] == 0.0
    assert values["stop_force_n_max"] == values["stop_force_n_max:Y"] > 500.0


def _force(result: CaseResult) -> tuple[Any, Any, int]:
    """Instants, force of Z at its stop (the plant's), and the detection, ns."""
    assert result.facts is not None
    assert result.series is not None
    (run,) = result.facts.runs
    assert run.fixed_stop is not None
    detected_ns = run.fixed_stop.detected_ns
    assert detected_ns is not None
    times, force = (result.series.column(name) for name in ("time_ns", "Z.stop_force_n"))
    return times, force, detected_ns


@pytest.mark.long
def test_the_contact_that_lasts_counts_when_the_stop_goes_away_and_is_met_again(
    judge: Judge,
) -> None:
    """The stop goes away with 20 mm/s for 100 ms, 2 mm; Z comes after with its lag."""
    times, force, _ = _force(judge(ONE.format(feed=600), TELLS, STOP)[2])
    first_ms = float(times[np.argmax(force > 0.0)]) / 1e6
    begin_ms = round(first_ms) + 30
    moves = {
        "plant:z.stop_speed_mm_s": "20",
        "plant:z.stop_begin_ms": str(begin_ms),
        "plant:z.stop_end_ms": str(begin_ms + 100),
    }
    values, notes, result = judge(ONE.format(feed=600), TELLS, {**STOP, **moves})
    times, force, detected_ns = _force(result)
    free = np.flatnonzero((force == 0.0) & (times < detected_ns) & (times > begin_ms * 1e6))
    lost_ms = (times[free[-1]] - times[free[0]]) / 1e6
    assert lost_ms > 60.0, "it was out of contact"
    again_ms = float(times[free[-1]]) / 1e6
    since_ms = values["contact_to_detection_ms"]
    assert since_ms == pytest.approx(detected_ns / 1e6 - again_ms, abs=1.01)
    (found,) = blocks(result)
    broken = found.broken_contacts["Z"]
    assert broken.since_ns == pytest.approx(detected_ns - since_ms * 1e6, abs=1.0)
    assert broken.first_ns / 1e6 == pytest.approx(first_ms, abs=1.01)
    assert broken.lost_ns / 1e6 == pytest.approx(lost_ms, abs=2.01)
    assert f"lost for {broken.lost_ns / 1e6:.0f} ms" in notes["contact_to_detection_ms"]
    assert values["found_without_contact"] == 0


@pytest.mark.long
def test_a_contact_that_is_over_at_the_detection_is_none(judge: Judge) -> None:
    """The stop goes away for good with 50 mm/s; the limit is below the running lag.

    Armed 1 mm before the stop, found 300 ms later.
    """
    times, force, _ = _force(judge(ONE.format(feed=600), TELLS, STOP)[2])
    begin_ms = round(float(times[np.argmax(force > 0.0)]) / 1e6) + 10
    gone = {
        f"set:Z.{DETECT}pos_lag_limit": "2000",
        f"set:Z.{DETECT}start_distance_per_mille": "400",
        f"set:Z.{DETECT}min_time": "300000",
        "plant:z.stop_speed_mm_s": "50",
        "plant:z.stop_begin_ms": str(begin_ms),
        "plant:z.stop_end_ms": str(begin_ms + 1000),
    }
    values, notes, result = judge(ONE.format(feed=600), TELLS, {**STOP, **gone})
    times, force, detected_ns = _force(result)
    last = int(np.flatnonzero((force > 0.0) & (times < detected_ns))[-1])
    assert detected_ns - times[last] > 50e6, "the case is about a lost contact"
    assert values["found_without_contact"] == 1
    assert values["contact_to_detection_ms"] is None
    assert "had lost its contact" in notes["contact_to_detection_ms"]
    assert blocks(result)[0].broken_contacts["Z"].since_ns is None


@pytest.mark.long
def test_bounces_at_the_first_touch_are_one_contact(judge: Judge) -> None:
    """An undamped stop throws the axis off: the contact is the first touch all the same."""
    hard = {"plant:z.stop_damping": "0"}
    values, notes, result = judge(ONE.format(feed=1200), TELLS, {**STOP, **hard})
    times, force, detected_ns = _force(result)
    first = int(np.argmax(force > 0.0))
    assert np.any(force[first:][times[first:] < detected_ns] == 0.0), "it bounces"
    since_ms = values["contact_to_detection_ms"]
    assert since_ms == pytest.approx((detected_ns - times[first]) / 1e6, abs=1.01)
    assert "lost" not in notes["contact_to_detection_ms"]
    assert blocks(result)[0].broken_contacts == {}
