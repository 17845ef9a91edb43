"""The hash that decides whether `--resume` keeps a run: every cell of its row, and its files."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign import resuming
from axisrig.bench.campaign.resuming import depends_sha256
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import parse_check
from axisrig.kernel.errors import UserError


def check(name: str, condition: str) -> Any:
    return parse_check(name, condition, "")


def search(column: str = "plc:V.E.A", text: str = "1 .. 9", condition: str = "<= 1") -> Any:
    return SimpleNamespace(column=column, text=text, checks=(check("duration_s", condition),))


CASE = case_of(
    "a", inputs={"plc:V.E.A": "1", "set:Z.kp": "2"}, checks=(check("duration_s", "<= 1"),),
    title="title", tags=("one", "two"), requirement="R-1", seed=5, notes={"note:n": "x"},
    sampled=(check("duration_s", "<= 9"),), expected=("duration_s",), folder=Path("plans"),
    program=Path("plans/part.nc"), rig=Path("plans/rig.toml"),
)  # fmt: skip


@pytest.fixture(autouse=True)
def files(monkeypatch: pytest.MonkeyPatch) -> dict[Path, str]:
    """The files of the case with their hashes; a test may change them."""
    found = {Path("plans/part.nc"): "p", Path("plans/rig.toml"): "r"}
    monkeypatch.setattr(resuming, "sources_sha256", lambda: "s")
    monkeypatch.setattr(resuming, "files_of_case", lambda _: [*found])
    monkeypatch.setattr(resuming, "content_hash", found.__getitem__)
    return found


@pytest.mark.parametrize(
    "changes",
    [
        {"plan": "q"},
        {"case": "b"},
        {"run": "p-a-2"},
        {"program": Path("plans/other.nc")},
        {"rig": Path("plans/other.toml")},
        {"seed": 6},
        {"title": "another"},
        {"tags": ("one",)},
        {"tags": ("two", "one")},
        {"requirement": "R-2"},
        {"notes": {"note:n": "y"}},
        {"notes": {"note:m": "x"}},
        {"notes": {}},
        {"inputs": {"plc:V.E.A": "1", "set:Z.kp": "3"}},
        {"inputs": {"plc:V.E.A": "1", "set:Z.tn": "2"}},
        {"inputs": {"plc:V.E.A": "1"}},
        {"inputs": {"set:Z.kp": "2", "plc:V.E.A": "1"}},  # columns act in their order
        {"checks": ()},
        {"checks": (check("duration_s", "<= 2"),)},
        {"checks": (check("duration_s", "< 1"),)},
        {"checks": (check("lag_mm_max:Z", "<= 1"),)},
        {"sampled": ()},
        {"sampled": (check("duration_s", "<= 8"),)},
        {"expected": ()},
        {"search": search()},
    ],
    ids=str,
)
def test_every_cell_of_a_row_decides(changes: dict[str, Any]) -> None:
    assert depends_sha256(replace(CASE, **changes)) != depends_sha256(CASE) != ""


@pytest.mark.parametrize(
    "other",
    [search(column="plc:V.E.B"), search(text="1 .. 8"), search(condition="<= 2"), None],
    ids=["column", "range", "condition", "none"],
)
def test_what_a_row_searches_decides(other: Any) -> None:
    found = replace(CASE, search=search())
    assert depends_sha256(replace(CASE, search=other)) != depends_sha256(found)
    assert depends_sha256(replace(CASE, search=search())) == depends_sha256(found)


@pytest.mark.parametrize(
    "changes",
    [
        {"index": 7},
        {"line": 9},
        {"file": Path("rows.csv")},
        {"overridden": frozenset({"plc:V.E.A"})},
        {
            "folder": Path("elsewhere"),
            "program": Path("elsewhere/part.nc"),
            "rig": Path("elsewhere/rig.toml"),
        },
    ],
    ids=" ".join,
)
def test_where_a_row_and_its_files_are_does_not_count(
    changes: dict[str, Any], files: dict[Path, str]
) -> None:
    """Rows above it may come and go, and the folder may be another one."""
    before = depends_sha256(CASE)
    if "folder" in changes:
        files.clear()
        files.update({Path("elsewhere/part.nc"): "p", Path("elsewhere/rig.toml"): "r"})
    assert depends_sha256(replace(CASE, **changes)) == before


def test_the_content_of_each_file_and_the_sources_decide(
    files: dict[Path, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    found = [depends_sha256(CASE)]
    for path in list(files):
        kept, files[path] = files[path], "changed"
        found.append(depends_sha256(CASE))
        files[path] = kept
    files[Path("plans/sub.nc")] = "x"
    found.append(depends_sha256(CASE))
    del files[Path("plans/sub.nc")]
    assert depends_sha256(CASE) == found[0]
    monkeypatch.setattr(resuming, "sources_sha256", lambda: "t")
    found.append(depends_sha256(CASE))
    assert len({*found}) == len(found)


def test_a_row_of_statistics_depends_on_its_runs_and_on_no_file(files: dict[Path, str]) -> None:
    """Each run has its own hash with its files."""
    row = replace(CASE, runs=("p-a-1", "p-a-2"))
    before = depends_sha256(row)
    files[Path("plans/part.nc")] = "changed"
    assert depends_sha256(row) == before
    for runs in (("p-a-1",), ("p-a-2", "p-a-1"), ("p-a-1", "p-a-2", "p-a-3")):
        assert depends_sha256(replace(row, runs=runs)) != before


def test_of_a_run_that_cannot_be_read_nothing_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_case: Case) -> list[Path]:
        raise UserError("cannot be read")

    monkeypatch.setattr(resuming, "files_of_case", refuse)
    assert depends_sha256(CASE) == ""
    assert depends_sha256(replace(CASE, runs=("p-a-1",))) != ""


def test_a_module_of_metrics_counts_by_its_name_unless_it_is_a_file() -> None:
    """The content of a file is among the files of the case, wherever it is."""

    def of(name: str, path: Path | None) -> str:
        module: Any = SimpleNamespace(name=name, path=path)
        return depends_sha256(replace(CASE, module=module))

    assert len({depends_sha256(CASE), of("own.metrics", None), of("own.others", None)}) == 3
    files = {of("own", Path("plans/own.py")), of("other", Path("elsewhere/other.py"))}
    assert files == {depends_sha256(CASE)}
