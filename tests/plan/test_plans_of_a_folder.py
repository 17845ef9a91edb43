"""Which plans may write into a results folder that has results already."""

import json
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.results.history import refuse_other_plans
from axisrig.bench.files import sha256_of
from axisrig.kernel.errors import UserError


def plan_of(path: Path) -> Any:
    return SimpleNamespace(name="p", path=path)


def entry(name: str, path: str = "", sha256: str = "0" * 64) -> dict[str, str]:
    return {"name": name, "path": path or f"{name}.csv", "sha256": sha256}


def folder_with(place: Path, *plans: Mapping[str, str]) -> Path:
    (place / "manifest.json").write_text(json.dumps({"plans": plans}), encoding="utf-8")
    return place


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
    folder = folder_with(tmp_path, *(entry(name) for name in there.split()))
    plans: Any = [SimpleNamespace(name=n, path=Path(f"{n}.csv")) for n in called.split()]
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
    folder = folder_with(tmp_path, entry("p", str(here), sha256_of(here)))
    refuse_other_plans(folder, [plan_of(tmp_path / "copy.csv")])
    refuse_other_plans(folder, [plan_of(tmp_path / "sub" / ".." / "p.csv")])
    with pytest.raises(UserError, match="results of another plan"):
        refuse_other_plans(folder, [plan_of(tmp_path / "sub" / "p.csv")])
    here.write_text("changed", encoding="utf-8")  # it is where it was
    refuse_other_plans(folder, [plan_of(here)])


def test_a_plan_that_was_changed_is_the_same_in_its_place_however_it_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its bytes have changed; its path is relative or absolute, or goes through another folder."""
    (tmp_path / "sub").mkdir()
    here = tmp_path / "p.csv"
    here.write_text("then", encoding="utf-8")
    digits = sha256_of(here)
    here.write_text("now", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    for then, now in (
        ("p.csv", here), (str(here), Path("p.csv")), ("sub/../p.csv", here),
        (str(here), tmp_path / "sub" / ".." / "p.csv"),
    ):  # fmt: skip
        refuse_other_plans(folder_with(tmp_path, entry("p", then, digits)), [plan_of(now)])
    (tmp_path / "sub" / "p.csv").write_text("now", encoding="utf-8")
    with pytest.raises(UserError, match="results of another plan"):
        refuse_other_plans(folder_with(tmp_path, entry("p", "sub/p.csv", digits)), [plan_of(here)])


def test_a_refusal_names_the_plan_that_is_none_of_the_folder_and_those_that_are(
    tmp_path: Path,
) -> None:
    for name in "pqr":
        (tmp_path / f"{name}.csv").write_text(name, encoding="utf-8")
    paths = [tmp_path / f"{name}.csv" for name in "pqr"]
    there = [entry(path.stem, str(path), sha256_of(path)) for path in paths[:2]]
    called: Any = [SimpleNamespace(name=path.stem, path=path) for path in (paths[0], paths[2])]
    with pytest.raises(UserError) as caught:
        refuse_other_plans(folder_with(tmp_path, *there), called)
    assert (caught.value.file, caught.value.value) == (str(tmp_path), str(paths[2]))
    assert caught.value.allowed == f"{paths[0]}, {paths[1]}"
    assert caught.value.hint == "name another folder with -o, or clear this one with --fresh"
