"""Which rows of statistics a call writes: what the folder has counts only where it still fits."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import statistics
from axisrig.bench.campaign.results.stored import DEPENDS, StoredRun
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.statistics import CaseStatistics
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.plan.verdict import Verdict

TEXT = """\
case,program,rig,repeats,plc:V.E.FEED,set:Z.edge,check:latch_error_um,check:mean(latch_error_um)
a,a.nc,r.toml,2,600,,-1 .. 1,<= 1
b,a.nc,r.toml,2,900,NEG,-1 .. 1,<= 1
"""


@pytest.fixture
def plan(tmp_path: Path) -> Plan:
    for name in ("a.nc", "r.toml"):
        (tmp_path / name).touch()
    (tmp_path / "p.csv").write_text(TEXT, encoding="utf-8")
    return read_plan(tmp_path / "p.csv")


def stored(case: Case, **other: str) -> StoredRun:
    """A run of the folder with the seed and the inputs of a case, some of them changed."""
    cells = {"run": case.run, "verdict": "pass", "seed": str(case.seed), DEPENDS: "old"}
    return StoredRun({**cells, **case.inputs, **other}, [], None, None)


def asked_samples(patch: pytest.MonkeyPatch) -> list[Any]:
    """The samples that statistics are asked for from now on; each has the value 1."""
    asked: list[Any] = []

    def judged(check: Any, samples: Any) -> Any:
        asked.extend(samples)
        return judge(check, 1.0)

    patch.setattr(statistics, "judge_statistic", judged)
    return asked


def rows_of(
    plan: Plan,
    called: list[Case],
    there: list[StoredRun],
    hashes: Mapping[str, str],
    *,
    is_fresh: bool = False,
) -> CaseStatistics:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(statistics, "is_results_folder", lambda _: True)
        patch.setattr(statistics, "read_results", lambda _: SimpleNamespace(runs=there))
        return CaseStatistics([plan], called, Path(), hashes, is_fresh=is_fresh)


@pytest.mark.parametrize(
    ("other", "is_due"),
    [
        ({}, True),
        ({"seed": "1"}, False),
        ({"plc:V.E.FEED": "601"}, False),
        ({"plc:V.E.FEED": ""}, False),
        ({DEPENDS: "new"}, True),  # nobody has asked whether it fits: its inputs say so
    ],
)
def test_a_run_that_this_call_leaves_out_counts_with_its_seed_and_its_inputs(
    plan: Plan, other: dict[str, str], is_due: bool
) -> None:
    first, second, *_ = plan.cases
    hashes = {first.run: "now", **{row.run: "h" for row in plan.statistics}}
    found = rows_of(plan, [first], [stored(second, **other)], hashes)
    assert [row.run for row in found.due] == ["p-a"] * is_due
    assert rows_of(plan, [first], [stored(second, **other)], hashes, is_fresh=True).due == []


@pytest.mark.parametrize(("depends", "is_due"), [("old", True), ("new", False)])
def test_a_run_that_this_call_has_looked_at_counts_with_its_hash(
    plan: Plan, depends: str, is_due: bool
) -> None:
    """With the same inputs: a file that it depends on may be another one."""
    first, second, *_ = plan.cases
    hashes = {first.run: "now", second.run: depends, **{row.run: "h" for row in plan.statistics}}
    found = rows_of(plan, [first], [stored(second)], hashes)
    assert [row.run for row in found.due] == ["p-a"] * is_due


def test_a_row_is_written_again_where_one_of_its_runs_is_new(plan: Plan) -> None:
    """The folder has the row as it is asked for, and its other run."""
    first, second, *_ = plan.cases
    of_a, _ = plan.statistics
    hashes = {first.run: "now", second.run: "old", **{row.run: "h" for row in plan.statistics}}
    there = [stored(second), stored(of_a, **{DEPENDS: "h"})]
    for called in ([first], [second], [first, second]):
        own = [*there, stored(first, **{DEPENDS: "now"})]
        assert [row.run for row in rows_of(plan, called, own, hashes).due] == ["p-a"]
    assert rows_of(plan, [], own, hashes).due == []


@pytest.mark.parametrize(("depends", "is_due"), [("h", False), ("other", True), (None, True)])
def test_a_row_is_written_again_where_it_is_missing_or_asks_for_something_else(
    plan: Plan, depends: str | None, is_due: bool
) -> None:
    """No run is new; the one that stays counts for the code of the call."""
    of_a, of_b = plan.statistics
    there = [stored(case) for case in plan.cases]
    for row, own in ((of_a, depends), (of_b, "h")):
        if own is not None:
            there.append(stored(row, verdict="fail", **{DEPENDS: own}))
    asked_for = {case.run: "old" for case in plan.cases}
    found = rows_of(plan, [], there, {**asked_for, of_a.run: "h", of_b.run: "h"})
    assert [row.run for row in found.due] == ["p-a"] * is_due
    assert found.staying == [Verdict.FAIL] * (2 - is_due)
    assert len(list(found.kept())) == is_due


def test_each_row_comes_with_the_last_of_its_own_runs(plan: Plan) -> None:
    found = rows_of(plan, list(plan.cases), [], {row.run: "h" for row in plan.statistics})
    assert list(found.kept()) == []
    a1, a2, b1, b2 = (CaseResult(case, Verdict.PASS, []) for case in plan.cases)
    came = [[row.case.run for row in found.after(result)] for result in (a1, b2, b1, a2)]
    assert came == [[], [], ["p-b"], ["p-a"]]


def test_a_row_of_statistics_has_the_inputs_that_all_its_runs_share(tmp_path: Path) -> None:
    """The second of two has another one: the row has none; also where only the last ones have."""
    for name in ("a.nc", "r.toml"):
        (tmp_path / name).touch()
    head = "case,program,rig,plc:V.E.FEED,plc:V.E.WAY,check:mean(latch_error_um)"
    rows = ("two,a.nc,r.toml,[600 | 900],5,<= 1", "three,a.nc,r.toml,[600 | 300 | 900],5,<= 1",
            "four,a.nc,r.toml,[600 | 900],[5 | 6],<= 1")  # fmt: skip
    (tmp_path / "p.csv").write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    plan = read_plan(tmp_path / "p.csv")
    assert [len(row.runs) for row in plan.statistics] == [2, 3, 4]
    assert [dict(row.inputs) for row in plan.statistics] == [{"plc:V.E.WAY": "5"}] * 2 + [{}]


@pytest.mark.parametrize(
    ("altered", "facts", "trace", "counts"),
    [
        ((), "facts", "t.parquet", True),
        (("trace",), "facts", "t.parquet", False),
        ((), None, "t.parquet", False),
        ((), "facts", None, False),
    ],
)
@pytest.mark.interpreted
def test_a_stored_run_counts_by_what_it_has_written_and_nothing_else(
    plan: Plan, monkeypatch: pytest.MonkeyPatch, altered: tuple[str, ...], facts: str | None,
    trace: str | None, counts: bool,
) -> None:  # fmt: skip
    """A file that was written to since is no recording; the verdict stays that of the run."""
    monkeypatch.setattr(statistics, "Series", lambda path: f"series of {path}")
    monkeypatch.setattr(statistics, "Observed", lambda *what: what)
    monkeypatch.setattr(statistics, "sampled", lambda *what, module: {"of": (*what, module)})
    case = replace(plan.cases[0], module="own")  # type: ignore[arg-type]
    run: Any = SimpleNamespace(
        altered=altered, judged_facts=facts, trace=trace, verdict=Verdict.MARGINAL
    )
    found = statistics._of_stored(run, case)
    assert (found.case, found.verdict, found.checks) == (case, Verdict.MARGINAL, [])
    seen = {"of": (("facts", "series of t.parquet"), case.sampled, "own")}
    assert (found.samples, found.facts) == ((seen, "facts") if counts else ({}, None))


@pytest.mark.parametrize(
    ("verdict", "has_values", "words"),
    [
        (Verdict.ERROR, True, "is in error"),
        (Verdict.ERROR, False, "is in error"),
        (Verdict.ABORTED, True, "is aborted"),
        (Verdict.FAIL, False, "has no recording"),
        (Verdict.FAIL, True, ""),
        (Verdict.INCONCLUSIVE, True, ""),
    ],
)
def test_a_run_without_a_verdict_or_a_recording_gives_a_statistic_its_reason(
    plan: Plan, monkeypatch: pytest.MonkeyPatch, verdict: Verdict, has_values: bool, words: str
) -> None:
    """A run that failed has its value all the same."""
    asked = asked_samples(monkeypatch)
    first, second, *_ = plan.cases
    of_a, _ = plan.statistics
    samples = {of_a.checks[0].metric: [5.0]} if has_values else {}
    result = CaseResult(first, verdict, [], samples=samples)  # type: ignore[arg-type]
    assert statistics.judged_row(of_a, [first, second], {first.run: result}).case is of_a
    one, lacking = asked
    assert (one.run, one.missing, one.readings) == (
        first.run, words, (5.0,) if has_values else (),
    )  # fmt: skip
    assert one.inputs == {"plc:V.E.FEED": "600"}
    assert (lacking.run, bool(lacking.missing), lacking.readings) == (second.run, True, ())


def test_a_run_that_nobody_has_is_missing_in_its_statistic(plan: Plan) -> None:
    """Neither this call has run it nor has the folder; the row is judged all the same."""
    first, *_ = plan.cases
    of_a, _ = plan.statistics
    hashes = {row.run: "now" for row in plan.rows}
    found = rows_of(plan, [], [], hashes).judged(of_a)
    assert found.verdict is Verdict.INCONCLUSIVE
    assert f"{first.run} is missing" in found.checks[0].note


@pytest.mark.parametrize(
    ("chosen", "counts"), [((0,), True), ((1,), True), ((0, 1), True), ((), False)]
)
def test_a_row_that_stays_counts_where_one_of_its_runs_is_asked_for(
    plan: Plan, chosen: tuple[int, ...], counts: bool
) -> None:
    """By `-k`; the other row is that of the folder too, and none of its runs is asked for."""
    of_a, of_b = plan.statistics
    there = [stored(case, **{DEPENDS: "h"}) for case in plan.cases]
    there += [stored(of_a, verdict="fail", **{DEPENDS: "h"}), stored(of_b, **{DEPENDS: "h"})]
    hashes = {plan.cases[number].run: "h" for number in chosen}
    found = rows_of(plan, [], there, {**hashes, of_a.run: "h", of_b.run: "h"})
    assert (found.due, found.staying) == ([], [Verdict.FAIL] * counts)


def test_a_row_has_the_values_of_each_of_its_runs_in_their_order(
    plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of this call as they have come, the others as the folder has them."""
    asked: list[Any] = []

    def judged(check: Any, samples: Any) -> Any:
        asked.append([(sample.run, sample.readings, sample.missing) for sample in samples])
        return judge(check, 1.0)

    metric = plan.statistics[0].checks[0].metric
    of_folder: Any = CaseResult(plan.cases[2], Verdict.PASS, [])
    of_folder.samples[metric] = [3.0]
    monkeypatch.setattr(statistics, "judge_statistic", judged)
    monkeypatch.setattr(statistics, "_of_stored", lambda _stored, _case: of_folder)
    a1, a2, b1, b2 = plan.cases
    hashes = {b1.run: "old", **{row.run: "h" for row in plan.statistics}}
    found = rows_of(plan, [a1, a2, b2], [stored(b1)], hashes)
    for case, value in ((a2, 2.0), (b2, 4.0), (a1, 1.0)):
        samples: Any = {metric: [value]}
        list(found.after(CaseResult(case, Verdict.PASS, [], samples=samples)))
    assert asked == [
        [(b1.run, (3.0,), ""), (b2.run, (4.0,), "")],
        [(a1.run, (1.0,), ""), (a2.run, (2.0,), "")],
    ]


@pytest.mark.parametrize("place", [0, 1])
def test_a_row_waits_for_the_only_run_that_is_still_to_come(plan: Plan, place: int) -> None:
    """The folder has the other one; the row is judged once, with both."""
    called, kept = plan.cases[place], plan.cases[1 - place]
    hashes = {kept.run: "old", **{row.run: "h" for row in plan.statistics}}
    found = rows_of(plan, [called], [stored(kept)], hashes)
    assert list(found.kept()) == []
    result = CaseResult(called, Verdict.PASS, [])
    assert [row.case.run for row in found.after(result)] == ["p-a"]


def test_a_row_counts_its_own_runs_of_the_call_alone(plan: Plan) -> None:
    """The folder has one of the second row; that it comes again counts for none."""
    a1, a2, b1, b2 = plan.cases
    hashes = {b2.run: "old", **{row.run: "h" for row in plan.statistics}}
    found = rows_of(plan, [a1, a2, b1], [stored(b2)], hashes)
    assert list(found.kept()) == []
    came = [
        [row.case.run for row in found.after(CaseResult(case, Verdict.PASS, []))]
        for case in (a1, b2, b1, a2)
    ]
    assert came == [[], [], ["p-b"], ["p-a"]]


@pytest.mark.parametrize("values", [(0.5, 5.0), (5.0, 0.5), (5.0, 5.0), (0.5, 0.5)])
def test_a_row_has_the_worst_verdict_of_all_its_statistics(
    plan: Plan, monkeypatch: pytest.MonkeyPatch, values: tuple[float, float]
) -> None:
    """Each is asked to be 1 at most."""
    of_a, _ = plan.statistics
    row = replace(of_a, checks=of_a.checks * 2)
    given = iter(values)
    monkeypatch.setattr(statistics, "judge_statistic", lambda check, _: judge(check, next(given)))
    found = statistics.judged_row(row, list(plan.cases[:2]), {})
    each = [Verdict.PASS if value <= 1 else Verdict.FAIL for value in values]
    assert [check.verdict for check in found.checks] == each
    assert found.verdict is max(each)


def test_each_run_gives_a_statistic_the_hash_of_its_own_frames(
    plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By it two runs that are the same count once."""
    asked = asked_samples(monkeypatch)
    first, second, *_ = plan.cases
    of_a, _ = plan.statistics
    results: Any = {
        case.run: CaseResult(
            case,
            Verdict.PASS,
            [],
            facts=SimpleNamespace(frame_log_sha256=frames),  # type: ignore[arg-type]
        )
        for case, frames in ((first, "f1"), (second, "f2"))
    }
    statistics.judged_row(of_a, [first, second], results)
    assert [(sample.run, sample.frames) for sample in asked] == [
        (first.run, "f1"), (second.run, "f2"),
    ]  # fmt: skip
