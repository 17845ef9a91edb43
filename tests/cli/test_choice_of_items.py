"""`-k` of pytest over rows and items of others, and which tables pytest takes for plans."""

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import pytest_plugin
from axisrig.bench.cli import pytest_plans
from axisrig.bench.plan.plan import read_plan

PLAN = Path(__file__).parents[2] / "testplans" / "latch_accuracy.csv"
NAME = "axisrig.bench.campaign.pytest_plugin"


class Row:
    """Item of a row."""

    def __init__(self, case: Any) -> None:
        self.case = case


class Hook:
    """Keeps what was deselected."""

    def __init__(self) -> None:
        self.dropped: list[Any] = []

    def pytest_deselected(self, items: list[Any]) -> None:
        self.dropped += items


@pytest.fixture
def rows(monkeypatch: pytest.MonkeyPatch) -> dict[str, Row]:
    plugin: Any = SimpleNamespace(RowItem=Row)
    monkeypatch.setitem(sys.modules, NAME, plugin)
    return {case.case: Row(case) for case in read_plan(PLAN).cases}


def config_of(keyword: str) -> Any:
    return SimpleNamespace(option=SimpleNamespace(keyword=keyword), hook=Hook())


def begin(config: Any, items: list[Any]) -> Any:
    """Begin the choice; what is inside of it is still to come."""
    choice = pytest_plans.pytest_collection_modifyitems(config, items)
    next(choice)
    return choice


def test_rows_are_chosen_by_their_names_and_others_see_no_keyword(rows: dict[str, Row]) -> None:
    """pytest would look for it in the names of items; afterwards it is there again."""
    names = list(rows)
    items: list[Any] = list(rows.values())
    config = config_of(names[1])
    choice = begin(config, items)
    assert items == [rows[names[1]]]
    assert config.hook.dropped == [row for name, row in rows.items() if name != names[1]]
    assert config.option.keyword == ""
    with pytest.raises(StopIteration):
        choice.send(None)
    assert config.option.keyword == names[1]


def test_the_keyword_is_there_again_where_a_plugin_fails(rows: dict[str, Row]) -> None:
    keyword, items = next(iter(rows)), list(rows.values())
    config = config_of(keyword)
    choice = begin(config, items)
    with pytest.raises(ValueError, match="odd"):
        choice.throw(ValueError("odd"))
    assert config.option.keyword == keyword


def test_where_all_rows_stay_nothing_is_deselected(rows: dict[str, Row]) -> None:
    items: list[Any] = list(rows.values())
    config = config_of("not zebra")
    begin(config, items)
    assert (items, config.hook.dropped) == (list(rows.values()), [])


@pytest.mark.parametrize("keyword", ["", "f60"])
def test_without_rows_or_a_keyword_pytest_does_its_own(rows: dict[str, Row], keyword: str) -> None:
    others: list[Any] = ["an item"] if keyword else list(rows.values())
    config = config_of(keyword)
    items = list(others)
    begin(config, items)
    assert (items, config.option.keyword, config.hook.dropped) == (others, keyword, [])


def test_before_a_plan_is_there_nothing_of_plans_is_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, NAME)
    items: list[Any] = ["an item"]
    begin(config_of("f60"), items)
    assert items == ["an item"]
    assert NAME not in sys.modules
    pytest_plans.pytest_terminal_summary(None, config_of(""))  # nothing to report


def test_words_that_make_no_choice_are_a_wrong_call_of_pytest(rows: dict[str, Row]) -> None:
    config = config_of("f60 and (")
    with pytest.raises(pytest.UsageError, match="f60 and \\("):
        begin(config, list(rows.values()))


# Which tables are plans


ARGS, TESTPATHS = pytest.Config.ArgsSource.ARGS, pytest.Config.ArgsSource.TESTPATHS


def asked(
    folder: Path, path: str, *arguments: str, ini: tuple[str, ...] = (), source: Any = ARGS
) -> bool:
    config: Any = SimpleNamespace(
        args=[str(folder / argument) for argument in arguments],
        args_source=source,
        getini=lambda name: [folder / one for one in ini] if name == "axisrig_plans" else None,
        pluginmanager="plugins",
    )
    return pytest_plans._is_asked_for(folder / path, config)


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        (("plans",), True),
        (("plans/p.csv",), True),
        (("plans/p.csv::p-f60",), True),
        (("plans/p.csv::p-f60::again",), True),
        (("plans/q.csv",), False),  # another table of the folder
        ((".",), False),  # not of its subfolders
        (("plans/p.csv/deep",), False),
        (("other", "plans"), True),
        ((), False),
    ],
)
def test_a_table_is_asked_for_by_itself_or_its_folder(
    tmp_path: Path, arguments: tuple[str, ...], found: bool
) -> None:
    assert asked(tmp_path, "plans/p.csv", *arguments) is found
    colon = tmp_path / "of:mine"  # as a drive of Windows has it
    assert asked(colon, "plans/p.csv", *arguments) is found


def test_what_the_command_line_does_not_give_counts_as_the_ini_file_says(tmp_path: Path) -> None:
    """`testpaths` of a project are no plans by that."""
    assert not asked(tmp_path, "plans/p.csv", "plans", source=TESTPATHS)
    assert asked(tmp_path, "plans/p.csv", source=TESTPATHS, ini=("plans",))
    assert asked(tmp_path, "plans/p.csv", "other", ini=("more", "plans"))
    assert not asked(tmp_path, "plans/more/p.csv", "other", ini=("plans",))


@pytest.mark.parametrize("has", [True, False])
def test_beside_a_conftest_that_one_decides(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, has: bool
) -> None:
    given: list[Any] = []

    def decides(*words: Any) -> bool:
        given.append(words)
        return has

    monkeypatch.setattr(pytest_plugin, "has_conftest", decides)
    assert not asked(tmp_path, "plans/p.csv")
    assert given == []  # there is none
    (tmp_path / "plans").mkdir()
    (tmp_path / "plans" / "conftest.py").write_text("", encoding="utf-8")
    assert asked(tmp_path, "plans/p.csv") is has
    assert given == [("plugins", tmp_path / "plans")]


@pytest.mark.parametrize(
    ("name", "is_table"),
    [("p.csv", True), ("P.CSV", True), ("p.xlsx", True), ("p.ods", True), ("p.parquet", True),
     ("p.tsv", False), ("p.py", False), ("csv", False)],
)  # fmt: skip
def test_tables_are_known_by_the_end_of_their_names(
    monkeypatch: pytest.MonkeyPatch, name: str, is_table: bool
) -> None:
    made: list[Any] = []

    def maker(parent: Any, path: Path) -> str:
        made.append((parent, path))
        return "plan"

    monkeypatch.setattr(pytest_plans, "_is_asked_for", lambda *_: True)
    monkeypatch.setattr(pytest_plugin, "is_plan", lambda path: path.stem != "list")
    monkeypatch.setattr(pytest_plugin, "PlanFile", SimpleNamespace(from_parent=maker))
    parent: Any = SimpleNamespace(config=None)
    found: Any = pytest_plans.pytest_collect_file(Path(name), parent)
    assert (found, made) == (("plan", [(parent, Path(name))]) if is_table else (None, []))
    assert pytest_plans.pytest_collect_file(Path("list.csv"), parent) is None
