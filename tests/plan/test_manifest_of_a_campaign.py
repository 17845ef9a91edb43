"""What a manifest says of its plans and their files: runs, hashes, versions, and kept texts."""

import hashlib
import os
import platform
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign.results.manifest import (
    TEXT_MAX,
    build_manifest,
    file_hashes,
    file_texts,
)
from axisrig.bench.plan.plan import Plan, read_plan, selected

PlanWriter = Callable[..., Path]
HEAD = "case,program,rig,repeats,plc:V.E.A,check:latch_error_um,check:mean(latch_error_um)"
ROW = "probe.nc,machine.toml"


def made(*plans: Plan, **more: Any) -> dict[str, Any]:
    given = {"command": ["axisrig"], "started": "", "output": "out", **more}
    return build_manifest(plans, **given)


def runs_of(*plans: Plan) -> list[object]:
    return [entry["runs"] for entry in made(*plans)["plans"]]


@pytest.mark.parametrize(
    ("rows", "runs"),
    [
        ([f"a,{ROW},1,7,<= 1,"], 1),
        ([f"a,{ROW},3,7,<= 1,"], 3),  # a repeat is a run
        ([f"a,{ROW},1,[1 | 2],<= 1,"], 2),  # a value of a list too
        ([f"a,{ROW},3,[1 | 2],<= 1,"], 6),
        # What is over several runs is a row of results and no run
        ([f"a,{ROW},3,7,<= 1,<= 1"], 3),
        ([f"a,{ROW},3,7,<= 1,<= 1", f"b,{ROW},1,7,<= 1,", f"c,{ROW},2,7,<= 1,<= 1"], 6),
    ],
)
def test_a_plan_has_as_many_runs_as_are_carried_out(
    write_plan: PlanWriter, rows: list[str], runs: int
) -> None:
    plan = read_plan(write_plan("\n".join([HEAD, *rows, ""])))
    assert runs_of(plan) == [runs]


def test_what_is_chosen_counts_alone(write_plan: PlanWriter) -> None:
    rows = f"a,{ROW},3,7,<= 1,<= 1\nb,{ROW},2,7,<= 1,<= 1\n"
    plan = read_plan(write_plan(f"{HEAD}\n{rows}"))
    assert runs_of(selected(plan, "b")) == [2]
    assert runs_of(plan, selected(plan, "a")) == [5, 3]


def test_each_plan_has_its_own_name_path_hash_and_runs(write_plan: PlanWriter) -> None:
    """And the files of all of them are hashed."""
    first = write_plan(f"{HEAD}\na,{ROW},2,7,<= 1,\n", "first.csv")
    second = write_plan(f"{HEAD}\na,other.nc,machine.toml,1,7,<= 1,\n", "second.csv")
    (second.parent / "other.nc").write_text("N20 M30\n", encoding="utf-8")
    found = made(read_plan(first), read_plan(second))
    assert found["plans"] == [
        {
            "name": path.stem,
            "path": str(path),
            "sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
            "runs": runs,
        }
        for path, runs in ((first, 2), (second, 1))
    ]
    assert {"probe.nc", "other.nc", "machine.toml"} <= {*found["files"]}


def test_command_and_further_entries_are_kept_whole() -> None:
    command = ["axisrig", "test", "a.csv", "-k", "x y"]
    found = made(command=command, extra={"fmus": {"a.fmu": "f0"}, "jobs": 3})
    assert (found["command"], found["fmus"], found["jobs"]) == (command, {"a.fmu": "f0"}, 3)
    assert "fmus" not in made()


def test_versions_are_those_of_what_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of its own package; a package that is not installed has none."""
    versions = {"axisrig": "9.1", "numpy": "2.0", "fmpy": "0.3"}

    def version(name: str) -> str:
        if name not in versions:
            raise metadata.PackageNotFoundError(name)
        return versions[name]

    monkeypatch.setattr(metadata, "version", version)
    found = made()
    assert found["axisrig"] == "9.1"
    assert found["packages"].pop("numpy") == "2.0"
    assert found["packages"].pop("fmpy") == "0.3"
    assert {*found["packages"].values()} == {None}
    assert found["python"] == platform.python_version()
    assert (found["platform"], found["machine"]) == (platform.platform(), platform.machine())


@pytest.mark.skipif(os.name != "posix", reason="makes a link")
def test_a_folder_behind_a_link_has_the_same_names(tmp_path: Path) -> None:
    """Rigs are read with their links followed, plans as they are named."""
    for name, text in (("z.lst", "z"), ("r.toml", '[axis.Z]\nlist = "z.lst"\n'), ("a.nc", "M30\n")):
        (tmp_path / "deep/er").mkdir(parents=True, exist_ok=True)
        (tmp_path / "deep/er" / name).write_text(text, encoding="utf-8")
    (tmp_path / "link").symlink_to(tmp_path / "deep/er")
    for folder in (tmp_path / "deep/er", tmp_path / "link"):
        paths = {"folder": folder, "rig": folder / "r.toml", "file": folder / "p.csv"}
        found = file_hashes([case_of("a", program=folder / "a.nc", **paths)])
        assert list(found) == ["a.nc", "r.toml", "z.lst"]


def texts(folder: Path, name: str, content: bytes) -> dict[str, str]:
    """The kept texts of a case with a program of this content."""
    (folder / "r.toml").write_text("[info]\n", encoding="utf-8")
    (folder / "part.nc").write_text("M30\n", encoding="utf-8")
    (folder / name).parent.mkdir(exist_ok=True)
    (folder / name).write_bytes(content)
    paths = {"folder": folder, "rig": folder / "r.toml", "file": folder / "p.csv"}
    module: Any = type("Module", (), {"path": folder / name})
    cases = [case_of("a", program=folder / "part.nc", module=module, **paths)]
    assert name in file_hashes(cases)
    return file_texts(cases)


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"x = 1\n", "x = 1\n"),
        ("a \u00b5m".encode(), "a \u00b5m"),
        ("\ufeffa".encode(), "a"),  # the mark of its bytes is no part of a text
        (b"", ""),
        (b"x" * TEXT_MAX, "x" * TEXT_MAX),
        (b"x" * (TEXT_MAX + 1), None),
        (b"\xb5m in another code", None),
    ],
    ids=["text", "micro", "mark", "empty", "longest", "too long", "no UTF-8"],
)
def test_what_is_text_and_not_long_is_kept_with_the_results(
    tmp_path: Path, content: bytes, text: str | None
) -> None:
    found = texts(tmp_path, "own.py", content)
    assert found.pop("own.py", None) == text
    assert found == {"part.nc": "M30\n", "r.toml": "[info]\n"}


@pytest.mark.parametrize("ending", ["fmu", "xlsx", "ods", "parquet"])
def test_archives_and_tables_are_hashed_and_not_kept(tmp_path: Path, ending: str) -> None:
    """Even where their bytes could be read as a text."""
    assert {*texts(tmp_path, f"own.{ending}", b"text")} == {"part.nc", "r.toml"}


def test_texts_of_up_to_200_000_bytes_are_kept() -> None:
    assert TEXT_MAX == 200_000
