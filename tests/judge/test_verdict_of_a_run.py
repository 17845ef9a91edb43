"""The verdict of a run from its checks, and from whether the operator has stopped it."""

from collections.abc import Sequence

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.run_findings import STOPPED, of_facts
from axisrig.bench.judge.topics import judged, observe
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.bus import RealTime

MS = 1_000_000
PASS, FAIL = ("duration_s", "0.004 .. 0.006"), ("duration_s", "<= 0.004")
UNRECORDED = ("velocity_mm_s_max:Z", "<= 1")  # its signal was not recorded


@pytest.mark.parametrize(
    ("checks", "alone", "stopped"),
    [
        ([PASS], Verdict.PASS, Verdict.ABORTED),
        ([PASS, FAIL], Verdict.FAIL, Verdict.ABORTED),
        ([FAIL, PASS], Verdict.FAIL, Verdict.ABORTED),
        ([PASS, UNRECORDED], Verdict.ERROR, Verdict.ERROR),
        ([UNRECORDED, FAIL], Verdict.ERROR, Verdict.ERROR),
    ],
)
def test_a_stopped_run_is_aborted_whatever_its_checks_say_unless_one_is_in_error(
    checks: Sequence[tuple[str, str]], alone: Verdict, stopped: Verdict
) -> None:
    series = kept(pa.table({"time_ns": np.arange(6) * MS}))
    axes = {"Z": AxisRecord("can1", 1, 10_000.0)}
    asked = [parse_check(name, condition, "here") for name, condition in checks]
    for is_stopped, verdict in ((False, alone), (True, stopped)):
        found, results = judged(Observed(facts(is_stopped=is_stopped, axes=axes), series), asked)
        assert found is verdict
        assert len(results) == len(checks)


REAL = RealTime(1000.0, 100.0, 1, 0, None, None, (), (), 0, 0.0, 0, 0.0, 0)
OF_THE_WIRE = "a bus is real: what happens on its wire is not seen here"


@pytest.mark.parametrize(
    ("metric", "outside", "real_time", "verdict", "words"),
    [
        ("contact_mm:Z", "Z", None, Verdict.INCONCLUSIVE, "the drive of axis Z is real"),
        ("contact_mm", "XZ", None, Verdict.INCONCLUSIVE, "the drive of axis X Z is real"),
        ("lag_mm_max:Z", "X", None, Verdict.ERROR, "lag"),  # of no plant: its signal is missing
        ("contact_mm:Z", "X", None, Verdict.FAIL, ""),  # its own drive is simulated
        ("contact_mm:Y", "XZ", None, Verdict.FAIL, "the rig has no axis Y"),
        ("latch_mm:Z", "Z", REAL, Verdict.FAIL, ""),  # the channel publishes it
        ("error_frames", "", REAL, Verdict.INCONCLUSIVE, OF_THE_WIRE),
        ("bus_load_pct", "", REAL, Verdict.INCONCLUSIVE, OF_THE_WIRE),
        ("queueing_us_max:X", "Z", REAL, Verdict.INCONCLUSIVE, OF_THE_WIRE),
        ("contact_deg:Z", "", None, Verdict.FAIL, "ask contact_mm"),
        ("contact_deg:Z", "Z", None, Verdict.INCONCLUSIVE, "the drive of axis Z is real"),
        ("duration_s", "XZ", REAL, Verdict.PASS, ""),
    ],
)
def test_what_cannot_be_seen_at_real_parts_is_inconclusive_and_what_is_missing_fails(
    metric: str, outside: str, real_time: RealTime | None, verdict: Verdict, words: str
) -> None:
    series = kept(pa.table({"time_ns": np.arange(6) * MS}))
    axes = {
        name: AxisRecord("can1", node, 10_000.0, is_outside=name in outside)
        for node, name in enumerate("XZ", 1)
    }
    observed = Observed(facts(axes=axes, real_time=real_time), series)
    check = parse_check(metric, "> -1", "here")
    found, (result,) = judged(observed, [check])
    assert (found, result.verdict) == (verdict, verdict)
    assert words in result.note
    assert (result.value is None) is (verdict is not Verdict.PASS)
    if verdict is not Verdict.ERROR:
        assert observe(observed, check).is_hidden is (verdict is Verdict.INCONCLUSIVE)


def test_a_hidden_check_leaves_the_run_inconclusive_unless_another_one_fails() -> None:
    series = kept(pa.table({"time_ns": np.arange(6) * MS}))
    axes = {"Z": AxisRecord("can1", 1, 10_000.0, is_outside=True)}
    hidden = ("contact_mm:Z", "> -1")
    for asked, verdict in (
        ([hidden, PASS], Verdict.INCONCLUSIVE),
        ([PASS, hidden], Verdict.INCONCLUSIVE),
        ([hidden, FAIL], Verdict.FAIL),
        ([PASS], Verdict.PASS),
    ):
        checks = [parse_check(name, condition, "here") for name, condition in asked]
        assert judged(Observed(facts(axes=axes), series), checks)[0] is verdict


def test_a_run_that_was_stopped_is_called_so_whatever_it_left_undone() -> None:
    for of, words in (
        ({}, None),
        ({"unfinished": "a plant fell"}, "a plant fell"),
        ({"is_stopped": True}, STOPPED),
        ({"is_stopped": True, "unfinished": "a plant fell"}, STOPPED),
    ):
        assert of_facts(facts(**of)).error == words  # type: ignore[arg-type]
