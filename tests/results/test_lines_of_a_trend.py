"""A metric over folders: which runs are followed together, and its lines for the terminal."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.results.stored import RUNS, StoredResults, StoredRun
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.verdict import Verdict
from axisrig.results.compare.trend import Trend, trend
from axisrig.results.compare.words import trend_lines

INPUTS = ("plc:V.E.A", "set:Z.b")


def run(name: str, value: str, verdict: str = "pass", metric: str = "m", case: str = "c",
        at: tuple[str, str] = ("1", "x"), limits: tuple[str, str] = ("", "9"), unit: str = "um",
        **cells: str) -> StoredRun:  # fmt: skip
    row = {"run": name, "plan": "p", "case": case, "verdict": verdict, **cells}
    made = StoredRun(row | dict(zip(INPUTS, at, strict=True)), [], None, None)
    made.__dict__["checks"] = [
        CheckRow(metric, value=value, unit=unit, lower=limits[0], upper=limits[1], verdict=verdict)
    ]
    return made


def folder(name: str, *runs: StoredRun, **manifest: str) -> StoredResults:
    return StoredResults(Path(name), runs, manifest)


def cases(found: Trend) -> dict[str, list[tuple[int, int, float]]]:
    return {one.case: [(p.place, p.n, p.mean) for p in one.points] for one in found.cases}


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize(
    ("words", "worst"),
    [
        (("pass", "fail", "marginal"), "fail"),
        (("error", "pass", "pass"), "error"),
        (("marginal", "inconclusive", "pass"), "inconclusive"),
        (("pass", "pass", "pass"), "pass"),
    ],
)
def test_a_point_has_the_worst_verdict_of_its_runs(
    words: tuple[str, ...], worst: str, turn: int
) -> None:
    """Whichever ran last; each folder for itself."""
    runs = [run(f"r{n}", "1", word) for n, word in enumerate(words)]
    (case,) = trend([folder("a", *runs[::turn]), folder("b", run("s", "1"))], "m").cases
    assert [point.verdict for point in case.points] == [Verdict.of(worst), Verdict.PASS]


def test_runs_whose_inputs_differ_are_followed_apart() -> None:
    """In any of the folders; by the values of these inputs, an empty one is named."""
    first = folder("a", run("r1", "1", at=("1", "x")), run("r2", "2", at=("2", "x")))
    second = folder("b", run("r1", "3", at=("1", "x")), run("r2", "5", at=("1", "x")))
    assert cases(trend([first, second], "m")) == {
        "p-c at V.E.A 1": [(0, 1, 1.0), (1, 2, 4.0)], "p-c at V.E.A 2": [(0, 1, 2.0)],
    }  # fmt: skip
    third = folder("c", run("r1", "7", at=("1", "")), run("r2", "9", at=("1", "x")))
    assert cases(trend([first, third], "m")) == {
        "p-c at V.E.A 1, Z.b x": [(0, 1, 1.0), (1, 1, 9.0)],
        "p-c at V.E.A 2, Z.b x": [(0, 1, 2.0)],
        "p-c at V.E.A 1, Z.b empty": [(1, 1, 7.0)],
    }  # fmt: skip
    assert cases(trend([second], "m")) == {"p-c": [(0, 2, 4.0)]}


def test_a_row_about_several_runs_is_followed_by_its_case() -> None:
    """It has none of the inputs that its runs differ in."""
    runs = [run(f"r{n}", f"{n}", at=(f"{n}", "x")) for n in range(3)]
    about = run("p-c", "1", metric="mean(m)", at=("", ""), **{RUNS: "3"})
    assert cases(trend([folder("a", *runs, about)], "mean(m)")) == {"p-c": [(0, 1, 1.0)]}
    alone = [run(f"r{n}", f"{n}", case="", at=("1", "x")) for n in range(2)]
    assert cases(trend([folder("a", *alone)], "m")) == {"r0": [(0, 1, 0.0)], "r1": [(0, 1, 1.0)]}


@pytest.mark.parametrize(
    ("limits", "found"),
    [
        ((("-1", "9"), ("-1", "9")), (-1.0, 9.0)),
        ((("0", "9"), ("0", "8")), (0.0,)),
        ((("", "9"), ("-1", "9")), (9.0,)),
        ((("", "0"), ("", "0")), (0.0,)),
        ((("-1", "9"), ("0", "8")), ()),
    ],
)
def test_limits_of_a_trend_are_those_of_all_runs_in_all_folders(
    limits: tuple[tuple[str, str], tuple[str, str]], found: tuple[float, ...]
) -> None:
    folders = [folder(name, run("r", "1", limits=each))
               for name, each in zip("ab", limits, strict=True)]  # fmt: skip
    (case,) = trend(folders, "m").cases
    assert case.limits == found


def test_probes_and_lost_runs_are_not_followed() -> None:
    runs = [run("a", "1"), run("b", "5", probe="a"), run("c", "7", in_plan="no")]
    assert cases(trend([folder("a", *runs)], "m")) == {"p-c": [(0, 1, 1.0)]}


def test_a_line_for_each_folder_and_one_with_the_limits() -> None:
    """A single value has no spread; s of 1 and 3 is the root of 2."""
    first = folder("out/one", run("r1", "1"), run("r2", "3", "fail"), started="monday")
    second = folder("out/two", run("r1", "1234.56789"), run("r2", "", "error"))
    found = trend([first, second], "m")
    assert list(trend_lines(found)) == [
        "p-c  m um, limits 9",
        f"  {'out/one':<30} {'2':>14}  s 1.41  n 2  fail",
        f"  {'out/two':<30} {'1234.568':>14}  n 1  pass",
    ]
    assert found.starts == ("monday", "")
    bare: Any = [SimpleNamespace(case="p-c", unit="", limits=(), points=())]
    assert list(trend_lines(Trend("m", (), (), tuple(bare)))) == ["p-c  m"]
    both = trend([folder("x", run("r", "1", limits=("-1", "9")))], "m")
    assert next(iter(trend_lines(both))) == "p-c  m um, limits -1 .. 9"


def test_a_row_about_several_runs_sweeps_no_input() -> None:
    """Its cells are empty: the runs of its case are all alike, and are followed together."""
    runs = [run("r1", "1"), run("r2", "3")]
    about = run("p-c", "2", metric="mean(m)", at=("", ""), runs="2")
    for rows in ([*runs, about], [about, *runs]):
        assert cases(trend([folder("a", *rows)], "m")) == {"p-c": [(0, 2, 2.0)]}
        assert cases(trend([folder("a", *rows)], "mean(m)")) == {"p-c": [(0, 1, 2.0)]}


def test_a_row_about_several_runs_has_the_name_of_its_case_where_inputs_are_swept() -> None:
    runs = [run("r1", "1", at=("1", "x")), run("r2", "3", at=("2", "x"))]
    about = run("p-c", "2", metric="mean(m)", at=("", ""), runs="2")
    assert cases(trend([folder("a", *runs, about)], "mean(m)")) == {"p-c": [(0, 1, 2.0)]}
    assert cases(trend([folder("a", *runs, about)], "m")) == {
        "p-c at V.E.A 1": [(0, 1, 1.0)], "p-c at V.E.A 2": [(0, 1, 3.0)],
    }  # fmt: skip


@pytest.mark.parametrize("other", range(4))
def test_one_run_of_many_with_another_input_is_followed_apart(other: int) -> None:
    """Whichever it is of its folder, and whichever input differs."""
    for place, name in enumerate(("V.E.A", "Z.b")):
        usual, changed = ("1", "x"), ("2", "x") if place == 0 else ("1", "y")
        runs = [run(f"r{n}", "1", at=changed if n == other else usual) for n in range(4)]
        assert cases(trend([folder("a", *runs)], "m")) == {
            f"p-c at {name} {usual[place]}": [(0, 3, 1.0)],
            f"p-c at {name} {changed[place]}": [(0, 1, 1.0)],
        }
