"""The entry point of pytest: which tables are plans, and how `-k` chooses their rows."""

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign import pytest_plugin
from axisrig.bench.cli.pytest_plans import (
    _given,
    pytest_collect_file,
    pytest_collection_modifyitems,
)

PLAN = "case,program,rig\na,part.nc,rig.toml\n"


def config_of(*folders: Path, args: tuple[str, ...] = (), is_given: bool = True) -> Any:
    source = pytest.Config.ArgsSource
    return SimpleNamespace(
        getini=lambda _: folders,
        args=list(args),
        args_source=source.ARGS if is_given else source.TESTPATHS,
        pluginmanager=SimpleNamespace(get_plugins=list),
    )


def is_collected(path: Path, config: Any, monkeypatch: pytest.MonkeyPatch) -> bool:
    monkeypatch.setattr(
        pytest_plugin.PlanFile, "from_parent", lambda _parent, path: f"collected {path.name}"
    )
    parent: Any = SimpleNamespace(config=config)
    found: Any = pytest_collect_file(path, parent)
    assert found in (None, f"collected {path.name}")
    return found is not None


@pytest.mark.parametrize(
    ("name", "is_plan"),
    [("p.csv", True), ("P.CSV", True), ("p.txt", False), ("p.nc", False), ("p", False)],
)
def test_tables_of_a_folder_of_plans_are_collected(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, is_plan: bool
) -> None:
    """Not those of a folder in it, and not a table that is no plan."""
    for folder in ("plans", "plans/sub", "other"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / name).write_text(PLAN, encoding="utf-8")
    config = config_of(tmp_path / "plans")
    found = [
        folder
        for folder in ("plans", "plans/sub", "other")
        if is_collected(tmp_path / folder / name, config, monkeypatch)
    ]
    assert found == ["plans"] * is_plan
    (tmp_path / "plans" / name).write_text("some,table\n1,2\n", encoding="utf-8")
    assert not is_collected(tmp_path / "plans" / name, config, monkeypatch)


def test_what_the_command_line_names_is_collected(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file, or one item of it, or a folder; folders of the ini file name no plans."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    for name in ("p.csv", "q.csv", "sub/r.csv"):
        (tmp_path / name).write_text(PLAN, encoding="utf-8")
    names = ("p.csv", "q.csv", "sub/r.csv")

    def found(*args: str, is_given: bool = True) -> list[str]:
        config = config_of(args=args, is_given=is_given)
        return [name for name in names if is_collected(tmp_path / name, config, monkeypatch)]

    assert found("p.csv") == ["p.csv"]
    assert found("p.csv::p-a", "sub") == ["p.csv", "sub/r.csv"]
    assert found(".") == ["p.csv", "q.csv"]
    assert found("p.csv", is_given=False) == []
    assert _given(["p.csv::p-a::x", "p.csv", "sub"]) == {tmp_path / "p.csv", tmp_path / "sub"}


# `-k`


class Row:
    """An item for a row of a plan."""

    def __init__(self, name: str, **of_case: Any) -> None:
        self.case = case_of(name, **of_case)
        self.name = name


@pytest.fixture
def rows(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Rows a, b, c and tests x, y; of tests pytest itself chooses x."""
    plugin = "axisrig.bench.campaign.pytest_plugin"
    monkeypatch.setitem(sys.modules, plugin, SimpleNamespace(RowItem=Row))  # type: ignore[arg-type]
    tests = [SimpleNamespace(name="x"), SimpleNamespace(name="y")]

    def deselect(items: list[Any], _config: Any) -> None:
        items[:] = [item for item in items if item.name == "x"]

    monkeypatch.setattr("_pytest.mark.deselect_by_keyword", deselect)
    dropped: list[str] = []
    hook = SimpleNamespace(
        pytest_deselected=lambda items: dropped.extend(item.name for item in items)
    )
    items = [Row("a"), tests[0], Row("b", tags=("slow",)), tests[1], Row("c")]
    config = SimpleNamespace(option=SimpleNamespace(keyword=""), hook=hook)
    return {"items": items, "config": config, "dropped": dropped}


def chosen(rows: dict[str, Any], keyword: str) -> tuple[list[str], str]:
    """Names of the items that stay, and the expression that others see meanwhile."""
    rows["config"].option.keyword = keyword
    choosing = pytest_collection_modifyitems(rows["config"], rows["items"])
    next(choosing)
    meanwhile = rows["config"].option.keyword
    with pytest.raises(StopIteration):
        choosing.send(None)
    assert rows["config"].option.keyword == keyword
    return [item.name for item in rows["items"]], meanwhile


@pytest.mark.parametrize(
    ("keyword", "left", "dropped"),
    [
        ("a or c", ["a", "x", "c"], ["b"]),
        ("slow", ["x", "b"], ["a", "c"]),
        ("not slow", ["a", "x", "c"], ["b"]),
        ("p-b", ["x", "b"], ["a", "c"]),
        ("a or b or c", ["a", "x", "b", "c"], []),
    ],
)
def test_rows_are_chosen_as_a_run_chooses_them_and_tests_by_pytest(
    rows: dict[str, Any], keyword: str, left: list[str], dropped: list[str]
) -> None:
    """In their order; pytest does not choose among them once more."""
    assert chosen(rows, keyword) == (left, "")
    assert rows["dropped"] == dropped


def test_without_rows_or_an_expression_pytest_chooses_as_ever(rows: dict[str, Any]) -> None:
    assert chosen(rows, "") == (["a", "x", "b", "y", "c"], "")
    rows["items"][:] = [item for item in rows["items"] if not isinstance(item, Row)]
    assert chosen(rows, "x") == (["x", "y"], "x")


def test_an_expression_comes_back_whatever_happens_and_a_wrong_one_is_refused(
    rows: dict[str, Any],
) -> None:
    rows["config"].option.keyword = "a"
    choosing = pytest_collection_modifyitems(rows["config"], rows["items"])
    next(choosing)
    with pytest.raises(RuntimeError, match="another hook"):
        choosing.throw(RuntimeError("another hook"))
    assert rows["config"].option.keyword == "a"
    rows["config"].option.keyword = "a or ("
    with pytest.raises(pytest.UsageError):
        next(pytest_collection_modifyitems(rows["config"], rows["items"]))
