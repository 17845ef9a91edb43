"""Results folders beside each other: hand-written tables, scipy and reckoned distances."""

import math
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from scipy import stats

from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.record.series import TIME
from axisrig.kernel.errors import UserError
from axisrig.results.compare.drawing import overlay
from axisrig.results.compare.page import pictures
from axisrig.results.compare.pairs import Comparison, Frames, compare, welch_p
from axisrig.results.compare.trend import trend

Call = Callable[..., tuple[int, str, str]]
CASES = "plan,case,run,verdict,sim_s,wall_s,seed,alarms,frame_log_sha256,program,rig,plc:V.E.A"
CHECKS = "plan,case,run,check,metric,value,unit,lower,upper,uncertainty,verdict,reference"


def folder(place: Path, *runs: str, checks: tuple[str, ...] = ()) -> Path:
    """runs: case, run, verdict, frames, V.E.A; checks: run, metric, value, limits, u, verdict."""
    place.mkdir()
    rows = [run.split() for run in runs]
    lines = [
        f"p,{c},{r},{v},1,1,1,,{'' if f == '-' else f},a.nc,a.toml,{a}" for c, r, v, f, a in rows
    ]
    (place / "cases.csv").write_text("\n".join([CASES, *lines, ""]), encoding="utf-8")
    lines = []
    for text in checks:
        run, metric, value, lower, upper, u, verdict = text.replace("-,", ",").split(",")
        lines.append(f"p,c,{run},,{metric},{value},um,{lower},{upper},{u},{verdict},p.csv:2")
    (place / "results.csv").write_text("\n".join([CHECKS, *lines, ""]), encoding="utf-8")
    return place


def compared(before: Path, after: Path) -> Comparison:
    return compare(read_results(before), read_results(after))


@pytest.mark.parametrize(
    ("before", "after", "worse"),
    [
        ("pass", "pass", False),
        ("pass", "marginal", True),
        ("marginal", "pass", False),
        ("pass", "inconclusive", True),
        ("marginal", "inconclusive", True),
        ("inconclusive", "marginal", False),
        ("inconclusive", "fail", True),
        ("inconclusive", "aborted", True),
        ("fail", "inconclusive", False),
        ("aborted", "error", True),
        ("fail", "error", True),
        ("error", "fail", False),
    ],
)
def test_a_verdict_that_falls_is_worse(
    tmp_path: Path, before: str, after: str, worse: bool
) -> None:
    a = folder(tmp_path / "a", f"c r {before} h 1")
    b = folder(tmp_path / "b", f"c r {after} h 1")
    found = compared(a, b)
    assert bool(found.worse()) == worse
    assert found.pairs[0].frames is Frames.EQUAL


def test_new_and_lost_runs(tmp_path: Path) -> None:
    a = folder(tmp_path / "a", "c both pass h 1", "c lost pass h 2")
    b = folder(tmp_path / "b", "c both pass k 1", "c good pass h 3", "c bad fail h 4")
    found = compared(a, b)
    assert [run.run for run in found.lost] == ["lost"]
    assert [run.run for run in found.new] == ["good", "bad"]
    assert found.worse() == ["lost: is missing, was pass", "bad: new, fail"]
    assert found.pairs[0].frames is Frames.CHANGED


def test_renamed_runs_are_matched_by_their_inputs(tmp_path: Path) -> None:
    a = folder(tmp_path / "a", "c old pass h 1", "c twin1 pass h 2", "c twin2 pass h 2")
    b = folder(tmp_path / "b", "c new pass h 1", "c twin3 pass h 2")
    found = compared(a, b)
    assert [(pair.name, pair.is_by_inputs) for pair in found.pairs] == [("old -> new", True)]
    assert [run.run for run in found.lost] == ["twin1", "twin2"]  # which of the two is not known
    assert [run.run for run in found.new] == ["twin3"]


@pytest.mark.parametrize(
    ("before", "after", "limits", "u", "nearer", "significant"),
    [
        (0.5, 0.7, (None, 1.0), 0.05, True, True),  # 0.2 nearer, known to 0.1
        (0.5, 0.59, (None, 1.0), 0.05, False, True),  # 0.09 of 0.1; En 0.09 / 0.0707
        (0.5, 0.55, (None, 1.0), 0.05, False, False),  # En 0.05 / 0.0707
        (0.5, 0.2, (None, 1.0), 0.05, False, True),  # away from the limit
        (0.5, 0.2, (0.0, 1.0), 0.05, True, True),  # the other limit is the nearest now
        (0.4, 0.6, (0.0, 1.0), 0.05, False, True),  # as far from either
        (0.5, 0.7, (None, None), 0.05, False, True),  # no limit to be near to
        (0.5, 0.5 + 1e-12, (None, 1.0), 0.0, False, False),  # digits
        (0.5, 0.6, (None, 1.0), 0.0, True, True),  # exact values
    ],
)
def test_a_metric_nearer_to_its_limit_is_worse(
    tmp_path: Path,
    before: float,
    after: float,
    limits: tuple[float | None, float | None],
    u: float,
    nearer: bool,
    significant: bool,
) -> None:
    lower, upper = ("" if limit is None else str(limit) for limit in limits)
    rows = [f"r,m,{value},{lower},{upper},{u},pass" for value in (before, after)]
    a = folder(tmp_path / "a", "c r pass h 1", checks=(rows[0],))
    b = folder(tmp_path / "b", "c r pass h 1", checks=(rows[1],))
    (pair,) = compared(a, b).pairs
    (metric,) = pair.metrics
    assert metric.is_nearer == nearer
    assert metric.is_significant == significant
    assert bool(compared(a, b).worse()) == nearer


def test_a_metric_that_has_to_fail_is_not_nearer_to_its_limit(tmp_path: Path) -> None:
    rows = [f"r,m,{value},,1.0,0.01,fail" for value in (2.0, 3.0)]
    folders = [
        folder(tmp_path / name, "c r pass h 1", checks=(row,))
        for name, row in zip("ab", rows, strict=True)
    ]
    assert compared(*folders).worse() == [
        "r: m is 2 um beyond its limit, it was 1 um beyond its limit"
    ]
    for place in folders:
        table = place / "cases.csv"
        head, row = table.read_text(encoding="utf-8").splitlines()
        table.write_text(f"{head},expected\n{row},fail:other m\n", encoding="utf-8")
    assert compared(*folders).worse() == []
    assert compared(*folders).pairs[0].metrics[0].is_significant


@pytest.mark.parametrize(
    ("name", "values", "gap", "is_drawn"),
    [
        ("Z.set_mm", 100.0, 0.4e-6, False),  # half of a nanometre: the last digit of a report
        ("Z.set_mm", 100.0, 2e-6, True),
        ("Z.cnc_lag_mm", 0.0, 1e-13, False),  # what is left of a difference of equal numbers
        ("Z.own", 100.0, 0.9e-7, False),  # no digits are known of it: 1e-9 of the largest value
        ("Z.own", 100.0, 2e-7, True),
        ("Z.own", 0.0, 1e-13, True),
    ],
)
def test_signals_that_differ_by_rounding_are_not_drawn(
    tmp_path: Path, name: str, values: float, gap: float, *, is_drawn: bool
) -> None:
    pairs = [folder(tmp_path / place, "c r pass h 1") for place in "ab"]
    for place, added in zip(pairs, (0.0, gap), strict=True):
        (place / "traces").mkdir()
        columns = {TIME: np.arange(5) * 1_000_000, name: np.full(5, values)}
        columns[name][2] += added
        pq.write_table(pa.table(columns), place / "traces" / "r.parquet")
    (pair,) = compared(*pairs).pairs
    assert bool(pictures(pair)) == is_drawn


def test_values_that_are_no_numbers_are_compared_by_their_verdicts(tmp_path: Path) -> None:
    a = folder(tmp_path / "a", "c r pass h 1", checks=("r,m,text,,,0,pass",))
    b = folder(tmp_path / "b", "c r fail h 1", checks=("r,m,,,,0,fail",))
    found = compared(a, b)
    assert found.worse() == ["r: pass -> fail"]
    assert found.pairs[0].metrics[0].shift == 0.0


def test_repeats_are_compared_by_welch(tmp_path: Path) -> None:
    generator = np.random.default_rng(5)
    samples = [generator.normal(mean, s, 6) for mean, s in ((1.0, 0.1), (1.3, 0.3))]
    folders = [
        folder(
            tmp_path / name,
            *(f"c r{n} pass {name}{n} 1" for n in range(6)),
            checks=tuple(f"r{n},m,{value!r},,,0,pass" for n, value in enumerate(sample.tolist())),
        )
        for name, sample in zip("ab", samples, strict=True)
    ]
    (shift,) = compared(*folders).shifts
    assert shift.p_value == pytest.approx(stats.ttest_ind(*samples, equal_var=False).pvalue)
    assert shift.means == pytest.approx([sample.mean() for sample in samples])
    assert shift.n == (6, 6)


def test_equal_frames_count_once_and_values_without_spread_are_decided() -> None:
    assert welch_p([1.0, 1.0], [1.0, 1.0]) == 1.0
    assert welch_p([1.0, 1.0], [2.0, 2.0]) == 0.0


def test_equal_frames_are_no_sample(tmp_path: Path) -> None:
    rows = tuple(f"r{n},m,1.0,,,0,pass" for n in range(3))
    runs = [f"c r{n} pass same 1" for n in range(3)]
    a, b = (folder(tmp_path / name, *runs, checks=rows) for name in "ab")
    assert compared(a, b).shifts == []


def test_probes_do_not_count(tmp_path: Path) -> None:
    a, b = (folder(tmp_path / name, "c r pass h 1", "c r-s01 pass h 2") for name in "ab")
    table = b / "cases.csv"
    lines = table.read_text(encoding="utf-8").splitlines()
    marked = [f"{line},{mark}" for line, mark in zip(lines, ("probe", "", "r"), strict=True)]
    table.write_text("\n".join([*marked, ""]).replace("r-s01,pass", "r-s01,fail"), encoding="utf-8")
    assert [run.run for run in compared(a, b).lost] == ["r-s01"]
    assert len(compared(b, b).pairs) == 1


def test_a_trend_has_mean_and_spread_of_each_campaign(tmp_path: Path) -> None:
    values = [[1.0, 3.0], [2.0, 2.5]]
    folders = [
        read_results(
            folder(
                tmp_path / f"w{week}",
                "c r0 pass h 1",
                "c r1 marginal k 1",
                checks=(f"r0,m,{one},,4,0,pass", f"r1,m,{two},,4,0,marginal"),
            )
        )
        for week, (one, two) in enumerate(values)
    ]
    (case,) = trend(folders, "m").cases
    assert (case.case, case.unit, case.limits) == ("p-c", "um", (4.0,))
    assert [(p.n, p.mean) for p in case.points] == [(2, 2.0), (2, 2.25)]
    assert [p.spread for p in case.points] == pytest.approx([math.sqrt(2.0), math.sqrt(0.125)])
    assert {p.verdict.word for p in case.points} == {"marginal"}
    assert trend(folders, "m", "c").cases == trend(folders, "m", "p-c").cases
    with pytest.raises(UserError, match="no folder checks this metric"):
        trend(folders, "mm")
    with pytest.raises(UserError, match="no folder has such values"):
        trend(folders, "m", "other")


@pytest.mark.parametrize(("first", "common"), [("9", ()), ("-", ()), ("4", (4.0,))])
def test_a_trend_has_the_limits_that_all_runs_have(
    tmp_path: Path, first: str, common: tuple[float, ...]
) -> None:
    """Each run has the upper one in one case; a folder without the metric changes nothing."""
    folders = [
        read_results(folder(tmp_path / name, "c r0 pass h 1", checks=checks))
        for name, checks in (
            ("a", (f"r0,m,1.0,,{first},0,pass",)),
            ("b", ("r0,m,1.1,0.5,4,0,pass",)),
            ("c", ("r0,other,1.1,,7,0,pass",)),
        )
    ]
    (case,) = trend(folders, "m").cases
    assert case.limits == common
    (case,) = trend(folders[1::-1], "m").cases
    assert case.limits == common
    (case,) = trend(folders[1:], "m").cases
    assert case.limits == (0.5, 4.0)


@pytest.mark.parametrize("verdict", ["inconclusive", "aborted"])
def test_a_new_run_that_is_no_pass_is_worse(tmp_path: Path, verdict: str) -> None:
    a = folder(tmp_path / "a", "c r0 pass h 1")
    b = folder(tmp_path / "b", "c r0 pass h 1", f"d r1 {verdict} k 2")
    assert compared(a, b).worse()
    c = folder(tmp_path / "c", "c r0 pass h 1", "d r1 marginal k 2")
    assert not compared(a, c).worse()


def test_the_overlay_holds_the_ends_of_the_signals() -> None:
    places = np.arange(5000.0)
    values = np.where(places == 4321.0, 7.0, np.sin(places / 100.0))
    drawn = overlay("a <b>", {"x": (places, values), "y": (places, -values)}, ("0", "1"), [2.0])
    assert ">a &lt;b&gt;</text>" in drawn
    assert [word for word in re.findall(r'text-anchor="end">(-?\d+)<', drawn) if word != "1"] == [
        *("-5", "0", "5"),
    ]
    assert drawn.count("<polyline") == 2
    assert drawn.count("<line") == 1
    tops = [
        float(point.split(",")[1]) for point in drawn.split('points="')[1].split('"')[0].split()
    ]
    assert min(tops) == pytest.approx(18.0 + 0.06 / 1.12 * 116.0, abs=0.06)  # the peak is there
    assert overlay("t", {"x": (places, np.full(5000, np.nan))}, ("", "")) == ""


def test_the_commands_say_what_changed(
    folder_of_results: Path, tmp_path: Path, axisrig: Call
) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    for place in (one, other):
        shutil.copytree(folder_of_results, place)
    page = tmp_path / "diff.html"
    code, out, _ = axisrig("diff", one, other, "-o", page)
    assert code == 0
    assert "2 runs in both (0 matched by equal inputs), 0 new, 0 missing; frames: 2 equal" in out
    assert "No verdict, no frame and no metric differs." in page.read_text(encoding="utf-8")
    # Another recording in the place of one of them
    table = (other / "cases.csv").read_text(encoding="utf-8").replace("slow,pass", "slow,fail")
    (other / "cases.csv").write_text(table, encoding="utf-8")
    shutil.copy(other / "traces" / "touch-fast.parquet", other / "traces" / "touch-slow.parquet")
    code, out, _ = axisrig("diff", one, other, "-o", page)
    assert code == 1
    assert "worse: touch-slow: pass -> fail" in out
    text = page.read_text(encoding="utf-8")
    assert text.count('<svg class="cmp"') == 6
    assert "difference of Z." in text
    code, out, _ = axisrig("trend", one, other, "--metric", "latch_error_um", "-o", page)
    assert code == 0
    assert out.count("touch-slow  latch_error_um um, limits 1") == 1
    assert page.read_text(encoding="utf-8").count('<svg class="cmp dots"') == 2
    assert axisrig("diff", one, tmp_path / "nothing")[0] == 2


def test_a_run_that_got_worse_is_said_once_with_its_reason(tmp_path: Path) -> None:
    """1.066 against a limit of 1: 0.066 beyond it, and nearer than before."""
    rows = [f"r,m,{value},,1.0,0.01,{word}" for value, word in ((0.5, "pass"), (1.066, "fail"))]
    a = folder(tmp_path / "a", "c r pass h 1", checks=(rows[0],))
    b = folder(tmp_path / "b", "c r fail h 1", checks=(rows[1],))
    assert compared(a, b).worse() == [
        "r: pass -> fail: m is 0.066 um beyond its limit, it was 0.5 um inside its limit"
    ]


def test_a_trend_splits_a_case_by_its_swept_values(tmp_path: Path) -> None:
    """Two values of an input that follow each other apart; the mean of both says nothing."""
    head = "plan,case,run,verdict,sim_s,wall_s,seed,alarms,frame_log_sha256,plc:V.E.F,plc:V.E.G"
    places = []
    for name, shift in (("a", 0.0), ("b", 1.0)):
        place = tmp_path / name
        place.mkdir()
        cases = [head, *(f"p,c,r{n},pass,1,1,1,,,{n}00,7" for n in (1, 2))]
        checks = ["plan,case,run,check,metric,value,unit,lower,upper,uncertainty,verdict,reference"]
        checks += [f"p,c,r{n},,m,{n * 10 + shift},um,,{n}9,0,pass,p.csv:2" for n in (1, 2)]
        (place / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
        (place / "results.csv").write_text("\n".join([*checks, ""]), encoding="utf-8")
        places.append(place)
    found = trend([read_results(place) for place in places], "m").cases
    assert [one.case for one in found] == ["p-c at V.E.F 100", "p-c at V.E.F 200"]
    assert [[point.mean for point in one.points] for one in found] == [[10.0, 11.0], [20.0, 21.0]]
    assert [one.limits for one in found] == [(19.0,), (29.0,)]
