"""What the manifest says of the calls that a results folder comes from, call by call."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign.results.history import History, refuse_other_plans
from axisrig.bench.campaign.results.stored import PROBE
from axisrig.bench.files import sha256_of
from axisrig.kernel.errors import UserError

HEAD = {"command": ["now"]}


def plan_of(name: str, *cases: str, path: str = "") -> Any:
    rows = [replace(case_of(one), plan=name, run=f"{name}-{one}") for one in cases]
    return SimpleNamespace(name=name, path=Path(path or f"{name}.csv"), rows=rows)


def entry(name: str, path: str = "", sha256: str = "0" * 64) -> dict[str, Any]:
    return {"name": name, "path": path or f"{name}.csv", "sha256": sha256, "runs": 1}


def written(place: Path, **manifest: Any) -> Path:
    (place / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    return place


def row(run: str, plan: str = "p", **more: str) -> dict[str, str]:
    return {"run": run, "plan": plan, **more}


def rows(*runs: str) -> dict[str, Mapping[str, str]]:
    return {run: row(run, run[0]) for run in runs}


def history(
    folder: Path, plans: Sequence[Any], runs: Sequence[str], entries: Sequence[Any] = ()
) -> History:
    """entries: of the plans, as the call puts them into its manifest."""
    head = {**HEAD, "plans": list(entries)} if entries else HEAD
    return History(folder, plans, head, {*runs})


# The first call


def test_missing_runs_are_in_the_order_of_their_plans(tmp_path: Path) -> None:
    """Whatever the order is in which they are asked for."""
    names = [f"r{number}" for number in (7, 3, 9, 1, 8, 2, 6, 4, 5)]
    plans = [plan_of("q", *names), plan_of("p", *names)]
    ids = [f"{plan}-{name}" for plan in "qp" for name in names]
    of_call = history(tmp_path, plans, ids)
    missing = of_call.manifest(rows("q-r9", "p-r7"), ["q-r9", "p-r7"])["missing"]
    assert missing == {
        "q": [run for run in ids[:9] if run != "q-r9"],
        "p": [run for run in ids[9:] if run != "p-r7"],
    }
    assert list(missing) == ["q", "p"]


# A later one


def test_an_earlier_call_stays_with_the_runs_that_it_still_has(tmp_path: Path) -> None:
    """Its own entries stay, what is said of the folder as a whole does not."""
    before = {"command": ["then"], "plans": [entry("p")], "runs_planned": 3, "finished": True,
              "drive_substituted": {}}  # fmt: skip
    plan = plan_of("p", "a", "b", "c")
    later = history(written(tmp_path, **before), [plan], ["p-b"], [entry("p")])
    there = rows("p-a", "p-b", "p-c") | {"p-c-s01": row("p-c-s01", **{PROBE: "p-c"})}
    later.found(there)
    assert later.asked == {"p-a": "p", "p-b": "p", "p-c": "p"}
    whole = later.manifest(there, [])
    assert whole["earlier"] == [
        {"command": ["then"], "plans": [entry("p")], "runs": ["p-a", "p-b", "p-c"]}
    ]
    assert [later.replaced(run) for run in ("p-b", "p-b", "p-x")] == [True, False, False]
    assert later.manifest(there, ["p-b"])["earlier"][0]["runs"] == ["p-a", "p-c"]
    assert later.manifest(there, ["p-b"])["finished"] is True
    for run in ("p-a", "p-c"):
        later.replaced(run)
    assert "earlier" not in later.manifest(there, ["p-b"])


def test_plans_of_the_folder_stay_in_their_order_with_those_of_the_call(tmp_path: Path) -> None:
    before = {"plans": [entry("p", sha256="1" * 64), entry("q", sha256="1" * 64)]}
    new = [entry("q", sha256="2" * 64), entry("r", sha256="2" * 64)]
    plans = [plan_of("q", "a"), plan_of("r", "a")]
    later = history(written(tmp_path, **before), plans, ["q-a"], new)
    assert later.is_whole is False
    assert [(one["name"], one["sha256"][0]) for one in later.manifest({}, [])["plans"]] == [
        ("p", "1"), ("q", "2"), ("r", "2"),
    ]  # fmt: skip
    both = history(tmp_path, [plan_of("p", "a"), *plans], ["q-a"])
    assert both.is_whole is True


# Whose folder it is


@pytest.mark.parametrize(
    ("there", "called", "is_refused"),
    [
        ("p", "p", False),
        ("p q", "p", False),  # a part of it
        ("p", "p q", False),  # all of it, and more
        ("p q", "p r", True),  # q is left out, and r is new
        ("p", "r", True),
        ("", "r", False),
    ],
)
def test_results_of_other_plans_are_no_place_for_these(
    tmp_path: Path, there: str, called: str, is_refused: bool
) -> None:
    folder = written(tmp_path, plans=[entry(name) for name in there.split()])
    plans = [plan_of(name, "a") for name in called.split()]
    if is_refused:
        with pytest.raises(UserError, match="results of another plan"):
            refuse_other_plans(folder, plans)
    else:
        refuse_other_plans(folder, plans)


def test_a_plan_of_the_same_name_is_the_same_by_its_place_or_its_bytes(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    for name, text in (("p.csv", "one"), ("sub/p.csv", "other"), ("copy.csv", "one")):
        (tmp_path / name).write_text(text, encoding="utf-8")
    here = tmp_path / "p.csv"
    folder = written(tmp_path, plans=[entry("p", str(here), sha256_of(here))])
    refuse_other_plans(folder, [plan_of("p", path=str(tmp_path / "copy.csv"))])
    refuse_other_plans(folder, [plan_of("p", path=str(tmp_path / "sub" / ".." / "p.csv"))])
    with pytest.raises(UserError, match="results of another plan"):
        refuse_other_plans(folder, [plan_of("p", path=str(tmp_path / "sub/p.csv"))])
    here.write_text("changed", encoding="utf-8")  # it is where it was
    refuse_other_plans(folder, [plan_of("p", path=str(here))])
