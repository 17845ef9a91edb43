"""Pairs of runs and metrics of two results folders, at their edges and in both directions."""

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.plan.verdict import Verdict
from axisrig.results.compare.pairs import Comparison, MetricPair, compare, welch_p
from axisrig.results.compare.words import diff_lines

CASES = ("plan", "case", "run", "verdict", "sim_s", "wall_s", "seed", "alarms",
         "frame_log_sha256")  # fmt: skip
CHECKS = ("plan", "case", "run", "check", "metric", "value", "unit", "lower", "upper",
          "uncertainty", "verdict", "reference")  # fmt: skip


def folder(
    place: Path, runs: Sequence[Mapping[str, Any]], checks: Sequence[Mapping[str, Any]] = ()
) -> Path:
    """Rows as far as they differ from a run of case c that passes."""
    place.mkdir(parents=True)
    plain = dict.fromkeys(CASES, "") | {"plan": "p", "case": "c", "verdict": "pass"}
    columns = dict.fromkeys([*CASES, *(name for run in runs for name in run)])
    usual = dict.fromkeys(CHECKS, "") | {
        "plan": "p", "case": "c", "run": "r", "metric": "m", "unit": "um", "verdict": "pass",
        "uncertainty": "0.0",
    }  # fmt: skip
    for name, rows, header, least in (
        ("cases", runs, columns, plain), ("results", checks, CHECKS, usual),
    ):  # fmt: skip
        with (place / f"{name}.csv").open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, [*header])
            writer.writeheader()
            writer.writerows({**dict.fromkeys(header, ""), **least, **row} for row in rows)
    return place


def compared(tmp_path: Path, *sides: Mapping[str, Any]) -> Comparison:
    """sides: runs and checks of the folder before and of the one after."""
    found = [folder(tmp_path / str(n), **side) for n, side in enumerate(sides)]
    return compare(*(read_results(place) for place in found))


def runs_of_a_case(values: Sequence[float], count: int | None = None) -> dict[str, Any]:
    """Runs of one case with frames of their own; count: of runs, the last ones without a value."""
    numbers = range(len(values) if count is None else count)
    return {
        "runs": [{"run": f"r{n}", "frame_log_sha256": f"h{n}"} for n in numbers],
        "checks": [{"run": f"r{n}", "value": str(value)} for n, value in enumerate(values)],
    }


def pair(**changes: Any) -> MetricPair:
    known: dict[str, Any] = {
        "run": "r", "metric": "m", "unit": "um", "before": 1.0, "after": 2.0, "before_u": 0.0,
        "after_u": 0.0, "margins": (1.0, 0.5), "verdicts": (Verdict.PASS, Verdict.PASS),
    }  # fmt: skip
    return MetricPair(**{**known, **changes})


@pytest.mark.parametrize(
    ("before", "after", "shift"),
    [
        (1.0, 3.0, 2.0),
        (3.0, 1.0, -2.0),
        (None, 3.0, 0.0),
        (3.0, None, 0.0),
        (None, None, 0.0),
        (1e6, 1e6 + 5e-4, 0.0),  # 5e-10 of it: the digits of another platform
        (1e6, 1e6 + 5e-3, 5e-3),
        (-1e6, -1e6 - 5e-4, 0.0),
        (1e-6, 1e-6 + 1e-14, 1e-14),
        (0.0, 1e-12, 1e-12),
    ],
)
def test_a_shift_is_more_than_rounding(
    before: float | None, after: float | None, shift: float
) -> None:
    found = pair(before=before, after=after)
    assert found.shift == pytest.approx(shift, rel=1e-6)
    assert (found.en == 0.0) is (shift == 0.0)
    assert found.is_significant is (shift != 0.0)


@pytest.mark.parametrize(
    ("before_u", "after_u", "en", "is_significant"),
    [
        (0.0, 0.0, math.inf, True),
        (0.6, 0.8, 1.0, False),  # En 1 is no more than both values are known
        (0.3, 0.4, 2.0, True),
        (0.8, 0.0, 1.25, True),
        (0.0, 2.0, 0.5, False),
    ],
)
def test_a_shift_counts_by_both_uncertainties(
    before_u: float, after_u: float, en: float, is_significant: bool
) -> None:
    for ends in ((1.0, 2.0), (2.0, 1.0)):
        found = pair(before=ends[0], after=ends[1], before_u=before_u, after_u=after_u)
        assert found.en == pytest.approx(en)
        assert found.is_significant is is_significant


@pytest.mark.parametrize(
    ("changes", "is_nearer"),
    [
        ({}, True),
        ({"before_u": 0.25, "after_u": 0.125}, True),
        ({"before_u": 0.25, "after_u": 0.25}, False),  # by no more than both together
        ({"before_u": 0.5}, False),
        ({"after_u": 0.5}, False),
        ({"margins": (0.5, 1.0)}, False),
        ({"margins": (None, 0.5)}, False),
        ({"margins": (1.0, None)}, False),
        ({"before": None}, False),
        ({"after": 1.0}, False),  # another limit, the same value
        ({"has_to_fail": True}, False),
    ],
)
def test_a_value_is_nearer_by_more_than_is_known(changes: dict[str, Any], is_nearer: bool) -> None:
    assert pair(**changes).is_nearer is is_nearer


@pytest.mark.parametrize(
    ("cells", "margin"),
    [
        ({"lower": "1", "upper": "10"}, 2.0),
        ({"lower": "1", "upper": "4"}, 1.0),
        ({"lower": "1"}, 2.0),
        ({"upper": "1"}, -2.0),
        ({"check": "<= 5"}, 2.0),  # of a tool that writes no limits
        ({"check": ">= 1"}, 2.0),
        ({"check": "== TRUE"}, None),
        ({"check": "<= 5", "lower": "0"}, 3.0),
        ({}, None),
        *(({side: "9", "value": ""}, None) for side in ("upper", "lower")),
        ({"upper": "9", "value": "FREE"}, None),
        ({"upper": "9", "value": "nan"}, None),
        ({"upper": "nan"}, None),
    ],
)
def test_a_margin_is_to_the_nearest_limit(
    tmp_path: Path, cells: Mapping[str, str], margin: float | None
) -> None:
    """Of a value of 3; the other folder has one without limits."""
    one = {"runs": [{"run": "r"}], "checks": [{"value": "3", **cells}]}
    other = {"runs": [{"run": "r"}], "checks": [{"value": "3"}]}
    for sides, place in (((one, other), 0), ((other, one), 1)):
        (found,) = compared(tmp_path / f"of {place}", *sides).pairs
        (metric,) = found.metrics
        assert metric.margins[place] == margin
        assert metric.margins[1 - place] is None


def test_each_cell_comes_from_its_own_folder(tmp_path: Path) -> None:
    """Values, uncertainties and verdicts differ; one uncertainty is not known."""
    before = {"value": "1", "uncertainty": "0.25", "verdict": "pass", "unit": "mm"}
    after = {"value": "2", "uncertainty": "", "verdict": "fail"}
    found = compared(
        tmp_path,
        {"runs": [{"run": "r"}], "checks": [before, {"metric": "only before", "value": "1"}]},
        {"runs": [{"run": "r"}], "checks": [{"metric": "only after", "value": "1"}, after]},
    )
    (metric,) = found.pairs[0].metrics
    assert metric == pair(
        before=1.0, after=2.0, before_u=0.25, after_u=0.0, margins=(None, None),
        verdicts=(Verdict.PASS, Verdict.FAIL),
    )  # fmt: skip


@pytest.mark.parametrize("side", [0, 1])
def test_a_check_that_has_to_fail_in_one_of_both_keeps_no_margin(tmp_path: Path, side: int) -> None:
    sides: list[dict[str, Any]] = [
        {"runs": [{"run": "r"}], "checks": [{"value": value, "upper": "9"}]} for value in "12"
    ]
    assert len(compared(tmp_path / "a", *sides).worse()) == 1
    sides[side]["runs"] = [{"run": "r", "expected": "fail:m"}]
    assert compared(tmp_path / "b", *sides).worse() == []


# Runs that have another id


def matched(
    tmp_path: Path,
    before: Sequence[Mapping[str, Any]],
    after: Sequence[Mapping[str, Any]],
    metrics: Sequence[Sequence[str]] = ((), ()),
) -> list[str]:
    sides = [
        {
            "runs": runs,
            "checks": [{"run": run["run"], "metric": name} for run in runs for name in of],
        }
        for runs, of in zip((before, after), metrics, strict=True)
    ]
    return [one.name for one in compared(tmp_path, *sides).pairs]


SAME = {"program": "a.nc", "rig": "a.toml", "plc:V.E.A": "1"}


@pytest.mark.parametrize(
    ("before", "after", "is_same"),
    [
        (SAME, SAME, True),
        (SAME, {**SAME, "plc:V.E.A": "2"}, False),
        (SAME, {**SAME, "program": "b.nc"}, False),
        (SAME, {**SAME, "rig": "b.toml"}, False),
        (SAME, {**SAME, "note:who": "me", "title": "other"}, True),
        ({**SAME, "plc:V.E.B": ""}, SAME, True),
        ({"plc:V.E.A": "1"}, {"plc:V.E.A": "1"}, True),  # a table without files
        ({"program": "a.nc"}, {"program": "a.nc"}, True),
        ({"title": "one"}, {"title": "one"}, False),  # it says nothing of what was run
        ({"search:plc:V.E.A": "1 .. 2 to 1"}, {"search:plc:V.E.A": "1 .. 2 to 1"}, True),
        ({"search:plc:V.E.A": "1 .. 2 to 1"}, {"search:plc:V.E.A": "1 .. 3 to 1"}, False),
        ({"plc:V.E.A": "1", "plc:V.E.B": "2"}, {"plc:V.E.B": "2", "plc:V.E.A": "1"}, True),
        ({**SAME, "runs": "4"}, SAME, False),  # what several runs say is none of them
        ({**SAME, "runs": "4"}, {**SAME, "runs": "5"}, True),
    ],
)
def test_runs_belong_together_by_what_was_run(
    tmp_path: Path, before: Mapping[str, str], after: Mapping[str, str], is_same: bool
) -> None:
    found = matched(tmp_path, [{"run": "old", **before}], [{"run": "new", **after}])
    assert found == (["old -> new"] if is_same else [])


def test_as_many_equal_runs_belong_together_in_their_order(tmp_path: Path) -> None:
    old, new = ([{"run": f"{name}{n}", **SAME} for n in (1, 2)] for name in ("old", "new"))
    assert matched(tmp_path, old, new) == ["old1 -> new1", "old2 -> new2"]


def test_other_checks_are_another_row_and_their_order_is_none(tmp_path: Path) -> None:
    old, new = [{"run": "old", **SAME}], [{"run": "new", **SAME}]
    for n, (metrics, is_same) in enumerate(
        (((("a", "b"), ("b", "a")), True), ((("a",), ("b",)), False), ((("a",), ()), False))
    ):
        assert bool(matched(tmp_path / f"of {n}", old, new, metrics)) is is_same


# Cases with several runs


def test_shifts_are_of_cases_with_several_runs_in_both_the_surest_first(tmp_path: Path) -> None:
    def side(by: float, extra: str) -> dict[str, Any]:
        runs = [{"run": f"r{n}", "frame_log_sha256": f"h{n}"} for n in range(4)]
        runs += [{"run": "twin", "frame_log_sha256": "h0"}, {"run": "p-c", "runs": "4"}]
        checks = [
            {"run": f"r{n}", "metric": name, "value": str(1.0 + n + shift)}
            for n in range(4)
            for name, shift in (("still", 0.0), ("moved", by))
        ]
        checks += [
            {"run": run, "metric": metric, "value": value}
            for run, metric, value in (
                ("twin", "moved", "99"), ("p-c", "moved", "99"), ("r0", "alone", "1"),
                ("r1", "odd", "inf"), ("r2", "odd", "1"), ("r0", extra, "1"), ("r1", extra, "1"),
            )
        ]  # fmt: skip
        return {"runs": runs, "checks": checks}

    found = compared(tmp_path, side(0.0, "before"), side(5.0, "after")).shifts
    assert [(one.case, one.metric, one.unit, one.n) for one in found] == [
        ("p-c", "moved", "um", (4, 4)),
        ("p-c", "still", "um", (4, 4)),
    ]
    assert found[0].means == (2.5, 7.5)
    assert found[1].p_value == pytest.approx(1.0)
    # t = 5/sqrt(2 * (5/3)/4) with 6 degrees of freedom
    assert found[0].p_value == pytest.approx(0.00154, abs=1e-5)


@pytest.mark.parametrize(("frames", "count"), [("", 3), ("h", 1)])
def test_runs_count_once_if_their_frames_are_known_to_be_equal(
    tmp_path: Path, frames: str, count: int
) -> None:
    """Of a real bus, and of other tools, no frames are known: none of these runs is a twin."""
    runs = [{"run": f"r{n}", "frame_log_sha256": frames} for n in range(3)]
    runs.append({"run": "x", "frame_log_sha256": "other"})
    checks = [{"run": run["run"], "value": str(n)} for n, run in enumerate(runs)]
    side = {"runs": runs, "checks": checks}
    (shift,) = compared(tmp_path / "one", side, side).shifts
    assert shift.n == (count + 1, count + 1)
    # Of another case, and of a case with this name in another plan, they are runs of their own
    others = [{**run, "run": f"{key}{n}", key: value} for n, run in enumerate(runs)
              for key, value in (("case", "d"), ("plan", "q"))]  # fmt: skip
    checks = [{"run": run["run"], "value": str(n)} for n, run in enumerate([*runs, *others])]
    side = {"runs": [*runs, *others], "checks": checks}
    found = compared(tmp_path / "more", side, side).shifts
    assert sorted((one.case, one.n) for one in found) == [
        (case, (count + 1, count + 1)) for case in ("p-c", "p-d", "q-c")
    ]


@pytest.mark.filterwarnings("ignore:Precision loss")
def test_only_values_without_any_spread_are_decided_at_once() -> None:
    assert welch_p([1.0, 1.0], [1.0 + 1e-12, 1.0 + 1e-12]) == 1.0
    assert welch_p([1.0, 1.0], [1.1, 1.1]) == 0.0
    assert 0.0 < welch_p([1.0, 1.0], [1.0, 2.0]) < 1.0
    assert 0.0 < welch_p([1.0, 2.0], [1.0, 1.0]) < 1.0


def test_lines_say_each_kind_the_worse_and_the_surest_first_and_cut_long_lists(
    tmp_path: Path,
) -> None:
    """50 values shift by 1, 2, 3 ... um in the order of a shuffled plan, known to 1 um each."""
    order = [7 * n % 50 + 1 for n in range(50)]
    uncertain = {"uncertainty": "1"}

    def checks(scale: int) -> list[dict[str, str]]:
        return [{"metric": f"m{n}", "value": str(scale * n), **uncertain} for n in order]

    runs = [{"run": "r"}, {"run": "falls"}, {"run": "rises", "verdict": "fail"}]
    after = [{"run": "r"}, {"run": "falls", "verdict": "fail"}, {"run": "rises"}, {"run": "new"}]
    found = compared(
        tmp_path, {"runs": runs, "checks": checks(0)}, {"runs": after, "checks": checks(1)}
    )
    *lines, last = diff_lines(found, [("r.toml", ["a 1 -> 2"])])
    kinds = list(dict.fromkeys(line.partition(":")[0].strip() for line in lines))
    assert kinds == ["changed", "a 1 -> 2", "worse", "better", "shifted", "new"]
    shifted = [line for line in lines if line.startswith("shifted: r: m")]
    # En of a shift of n um by two uncertainties of 1 um: n/sqrt 2
    sure = [n for n in range(50, 0, -1) if n / math.sqrt(2.0) > 1.0]
    assert shifted == [
        f"shifted: r: m{n} 0 -> {n} um (En {n / math.sqrt(2.0):.3g})" for n in sure[:40]
    ]
    assert f"shifted: {len(sure) - 40} more" in lines
    assert "better: rises: fail -> pass" in " ".join(lines)
    assert last.startswith("3 runs in both (0 matched by equal inputs), 1 new, 0 missing;")


@pytest.mark.parametrize(("before", "after"), [((1.0, 2.0), (4.0, 6.0, 8.0)),
                                               ((4.0, 6.0, 8.0), (1.0, 2.0))])  # fmt: skip
def test_a_shift_has_the_number_and_the_mean_of_each_folder(
    tmp_path: Path, before: Sequence[float], after: Sequence[float]
) -> None:
    (shift,) = compared(tmp_path, runs_of_a_case(before), runs_of_a_case(after)).shifts
    assert shift.n == (len(before), len(after))
    assert shift.means == (sum(before) / len(before), sum(after) / len(after))


@pytest.mark.parametrize(
    ("after", "words"),
    [
        (1.0, "m is 1 um beyond its limit"),
        (1.0 + 1e-12, "m is 1 um beyond its limit"),  # the digits of another platform
        (1.5, "m is 1.5 um beyond its limit, it was 1 um beyond its limit"),
    ],
)
def test_a_value_that_stays_has_no_earlier_one_in_the_words(
    tmp_path: Path, after: float, words: str
) -> None:
    """The limit is 0; the check failed in both, and its verdict fell to an error of the run."""
    sides = [
        {
            "runs": [{"run": "r", "verdict": verdict}],
            "checks": [{"value": repr(value), "upper": "0", "verdict": of_check}],
        }
        for value, verdict, of_check in (
            (1.0, "inconclusive", "inconclusive"),
            (after, "fail", "fail"),
        )
    ]
    (line,) = compared(tmp_path, *sides).worse()
    assert line == f"r: inconclusive -> fail: {words}"


@pytest.mark.parametrize(
    ("before", "after", "pairs"), [(1, 1, 1), (2, 2, 2), (2, 3, 0), (3, 2, 0), (1, 2, 0)]
)
def test_runs_with_the_same_inputs_belong_together_where_there_are_as_many(
    tmp_path: Path, before: int, after: int, pairs: int
) -> None:
    """In their order; of other numbers nobody knows which is which."""
    sides = [
        {"runs": [{"run": f"{name}{n}", "plc:V.E.FEED": "600"} for n in range(count)]}
        for name, count in (("a", before), ("b", after))
    ]
    found = compared(tmp_path, *sides)
    assert [one.name for one in found.pairs] == [f"a{n} -> b{n}" for n in range(pairs)]
    assert all(one.is_by_inputs for one in found.pairs)
    assert (len(found.lost), len(found.new)) == (before - pairs, after - pairs)
