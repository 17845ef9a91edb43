"""What a folder keeps of the calls that made it: runs asked for, missing, earlier, in order."""

import json
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.results.history import History
from axisrig.bench.campaign.results.stored import IN_PLAN, PROBE


def plan(name: str, *runs: str) -> Any:
    return SimpleNamespace(name=name, rows=[SimpleNamespace(run=run, plan=name) for run in runs])


def row(run: str, plan_name: str = "p", **more: str) -> dict[str, str]:
    return {"run": run, "plan": plan_name, **more}


def entry(name: str, sha256: str = "2" * 64) -> dict[str, str]:
    return {"name": name, "path": f"{name}.csv", "sha256": sha256}


def history(
    place: Path,
    plans: Sequence[Any],
    runs: Collection[str],
    old: Mapping[str, Any] | None = None,
    cases: Sequence[Mapping[str, str]] = (),
) -> History:
    """A call over plans in a folder with a manifest; cases: rows that it has."""
    if old is not None:
        whole = {"axisrig": "1", "runs_planned": 0, "finished": True, **old}
        (place / "manifest.json").write_text(json.dumps(whole), encoding="utf-8")
    head = {"plans": [entry(each.name) for each in plans], "started": "now"}
    made = History(place, plans, head, runs)
    made.found({case["run"]: case for case in cases})
    return made


def test_a_first_call_has_what_it_runs(tmp_path: Path) -> None:
    made = history(tmp_path, [plan("p", "a", "b")], ["a", "b"])
    assert made.is_whole
    assert set(made.asked) == {"a", "b"}
    cases = {"a": row("a")}
    found = made.manifest(cases, ["a"])
    assert (found["runs_planned"], found["missing"], found["finished"]) == (2, {"p": ["b"]}, False)
    whole = made.manifest({**cases, "b": row("b")}, ["a", "b"])
    assert (whole["finished"], "missing" in whole, "earlier" in whole) == (True, False, False)
    # Rows of an earlier call do not finish this one
    assert not made.manifest({**cases, "b": row("b")}, ["a"])["finished"]


def test_missing_runs_are_in_the_order_of_their_plans(tmp_path: Path) -> None:
    """Whatever the order is in which the call has them."""
    names = [f"r{number}" for number in (7, 3, 9, 1, 8, 2, 6, 4, 5)]
    ids = {name: [f"{name}-{run}" for run in names] for name in "qp"}
    plans = [plan(name, *ids[name]) for name in "qp"]
    made = history(tmp_path, plans, {*ids["p"], *ids["q"]})
    cases = {"q-r9": row("q-r9", "q"), "p-r7": row("p-r7")}
    missing = made.manifest(cases, ["q-r9", "p-r7"])["missing"]
    assert missing == {name: [run for run in ids[name] if run not in cases] for name in "qp"}
    assert list(missing) == ["q", "p"]


@pytest.mark.parametrize("runs", [["a"], ["c"], ["a", "c"], []])
def test_a_call_asks_for_its_own_runs_and_for_no_others_of_the_plan(
    tmp_path: Path, runs: list[str]
) -> None:
    """What `-k` leaves out is not missing."""
    made = history(tmp_path, [plan("p", "a", "b", "c"), plan("q", "d")], runs)
    assert set(made.asked) == set(runs)
    before = made.manifest({}, [])
    assert (before["runs_planned"], before.get("missing", {})) == (
        len(runs), {"p": runs} if runs else {},
    )  # fmt: skip
    after = made.manifest({run: row(run) for run in runs}, runs)
    assert (after["runs_planned"], after["finished"], "missing" in after) == (
        len(runs), True, False,
    )  # fmt: skip


def test_what_earlier_calls_asked_for_stays_asked_for(tmp_path: Path) -> None:
    """c is missing since then; d is a row that the folder has, its probe was not asked for."""
    old = {"plans": [entry("p")], "missing": {"p": ["c"]}, "started": "then"}
    rows = [row("d"), row("d-s01", **{PROBE: "d"})]
    made = history(tmp_path, [plan("p", "a", "c", "d")], ["a"], old, rows)
    assert set(made.asked) == {"a", "c", "d"}
    found = made.manifest({each["run"]: each for each in [*rows, row("a")]}, ["a"])
    assert (found["missing"], found["runs_planned"], found["finished"]) == ({"p": ["c"]}, 3, False)
    (earlier,) = found["earlier"]
    assert (earlier["started"], earlier["runs"]) == ("then", ["d"])


def test_an_earlier_call_has_its_own_entries_with_the_runs_that_it_still_has(
    tmp_path: Path,
) -> None:
    """Entries about the folder as a whole are in the manifest of the last call alone."""
    old = {"plans": [entry("p")], "command": ["then"], "drive_substituted": {}}
    cases = [row("a"), row("b"), row("c"), row("c-s01", **{PROBE: "c"})]
    made = history(tmp_path, [plan("p", "a", "b", "c")], ["b"], old, cases)
    there = {each["run"]: each for each in cases}
    (before,) = made.manifest(there, [])["earlier"]
    assert before == {
        "axisrig": "1", "command": ["then"], "plans": [entry("p")], "runs": ["a", "b", "c"],
    }  # fmt: skip
    assert made.replaced("b")
    (after,) = made.manifest(there, ["b"])["earlier"]
    assert after["runs"] == ["a", "c"]
    assert made.manifest(there, ["b"])["finished"]
    for run in ("a", "c"):
        assert made.replaced(run)
    assert "earlier" not in made.manifest(there, ["b"])


def test_a_row_that_is_replaced_is_of_its_earlier_call_no_more(tmp_path: Path) -> None:
    """A call without rows is not named any more."""
    old = {"plans": [entry("p")], "earlier": [{"started": "first", "runs": ["a"]}]}
    made = history(tmp_path, [plan("p", "a", "b")], ["a"], old, [row("a"), row("b")])
    before = made.manifest({}, [])["earlier"]
    assert [each["runs"] for each in before] == [["a"], ["b"]]
    assert made.replaced("a")
    assert not made.replaced("a")
    assert not made.replaced("z")
    assert [each["runs"] for each in made.manifest({}, [])["earlier"]] == [["b"]]


def test_plans_of_a_folder_are_those_of_all_calls_with_the_newest_entry_of_each(
    tmp_path: Path,
) -> None:
    old = {"plans": [entry("p", "1" * 64), entry("q", "1" * 64)]}
    called = [plan("q", "a"), plan("r", "b")]
    made = history(tmp_path, called, ["a"], old)
    assert not made.is_whole  # p is not called
    assert history(tmp_path, [plan("p", "c"), plan("q", "a")], ["a"], old).is_whole
    assert [(each["name"], each["sha256"][0]) for each in made.manifest({}, [])["plans"]] == [
        ("p", "1"), ("q", "2"), ("r", "2"),
    ]  # fmt: skip
    assert history(tmp_path, [plan("p", "c"), *called], ["a"]).is_whole


@pytest.mark.parametrize(
    ("run", "plan_name", "mark", "is_in"),
    [
        ("a", "p", "", True),
        ("a", "p", "no", True),  # the plan has it again
        ("gone", "p", "", False),
        ("z", "q", "", True),  # of a plan that is not called its row says it
        ("z", "q", "no", False),
    ],
)
def test_whether_a_plan_has_a_run(
    tmp_path: Path, run: str, plan_name: str, mark: str, is_in: bool
) -> None:
    old = {"plans": [entry("q"), entry("p")]}
    made = history(tmp_path, [plan("p", "a")], ["a"], old)
    assert made.is_in_plan(run, plan_name, mark) is is_in


def test_rows_are_by_plan_and_case_with_probes_behind_their_row_and_lost_ones_last(
    tmp_path: Path,
) -> None:
    old = {"plans": [entry("q"), entry("p")]}
    made = history(tmp_path, [plan("p", "b", "a")], ["b", "a"], old)
    rows = [
        row("a-s02", **{PROBE: "a"}), row("gone"), row("b"), row("a-s01", **{PROBE: "a"}),
        row("z", "q"), row("a"), row("y", "q", **{IN_PLAN: "no"}), row("x", "unknown"),
    ]  # fmt: skip
    order = [each["run"] for each in sorted(rows, key=made.place)]
    assert order == ["z", "b", "a", "a-s01", "a-s02", "x", "gone", "y"]


def test_runs_that_the_plan_has_no_more_are_not_planned(tmp_path: Path) -> None:
    old = {"plans": [entry("p")], "missing": {"p": ["gone", "kept"]}}
    made = history(tmp_path, [plan("p", "a", "kept")], ["a"], old)
    found = made.manifest({"a": row("a")}, ["a"])
    assert (found["runs_planned"], found["missing"]) == (2, {"p": ["kept"]})
    made.note({"spent_s": 3})
    assert made.manifest({}, [])["spent_s"] == 3
