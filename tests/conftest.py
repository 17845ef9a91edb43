"""Tests say which alarms they provoke; class, values and reaction are checked here for all.

    @pytest.mark.provokes(50059, 4, axis="Z")

says: in this test alarm 50059 comes up, it is of class 4, its value `axis` is Z. Further values
are optional, every value has to be there. Where the alarm reaches a channel, the channel must end
the program for a class above 1, and go on for class 1. Several marks may stand over one test: all
of them come up; over one that is parametrized by `alarm_id`, the one of each row. The end of a
test run lists the IDs that something raises (`raised` of `errors.csv`) and no test provokes,
and the words of the language that do not act yet.

What the stages `--stage quick` and `--stage rest` run: `stages.py`; `conftest.py` of the checkout
has the option, for `pytest testplans/` too.

A segment that a test opens is closed at its end: the names of open segments are of the process, so
one that stays open would refuse its name to any later test, or to none, by the order of tests.

Tests with random inputs (hypothesis) draw the same ones in every run; other ones with
`--hypothesis-profile random`.
"""

import re
from collections.abc import Generator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from tests import both_writers

from axisrig.bench.bus.can import registry
from axisrig.bench.campaign.results.build_info import is_compiled
from axisrig.kernel.channel.reactions import Reactions
from axisrig.kernel.errors import Alarm, catalogue
from axisrig.kernel.nc.text.words import not_acting

settings.register_profile("same", derandomize=True, deadline=None)
settings.register_profile("random", derandomize=False, deadline=None)
settings.load_profile("same")  # here: what `@settings` does not name is that of the import

_OF_FIXTURES = pytest.StashKey[set[str]]()
"""The segments that are open when the test itself begins: those of its fixtures."""

_MARK = re.compile(r"mark\.provokes\(\s*(\d+)")


@dataclass
class _Seen:
    """What came up during a test; ended: what a channel has decided."""

    alarms: list[Alarm] = field(default_factory=list)
    ended: list[tuple[Alarm, bool]] = field(default_factory=list)


def not_yet_provoked() -> list[int]:
    """The IDs that something raises and that no test says it provokes."""
    files = Path(__file__).parent.rglob("test_*.py")
    provoked = {int(i) for path in files for i in _MARK.findall(path.read_text(encoding="utf-8"))}
    return [i for i, entry in catalogue().items() if entry.is_raised and i not in provoked]


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(both_writers)
    config.addinivalue_line(
        "markers", "provokes(alarm_id, reaction_class, **values): the alarm comes up in this test"
    )
    config.addinivalue_line(
        "markers",
        "interpreted: replaces methods or passes stand-ins, which compiled classes refuse",
    )


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item: pytest.Item) -> Generator[None, object, object]:
    if item.get_closest_marker("interpreted") and is_compiled():
        pytest.skip("replaces what compiled classes have, or passes stand-ins to them")
    result = yield
    item.stash[_OF_FIXTURES] = set(registry.names())
    return result


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(
    item: pytest.Item, nextitem: pytest.Item | None
) -> Generator[None, object, object]:
    result = yield
    is_last = nextitem is None or nextitem.path != item.path
    kept = set[str]() if is_last else item.stash.get(_OF_FIXTURES, set(registry.names()))
    left = {name: registry.find(name) for name in registry.names() if name not in kept}
    for segment in left.values():
        segment.close()  # type: ignore[union-attr]
    assert not left, f"close() the segments that stay open: {', '.join(left)}"
    return result


@pytest.fixture(scope="session")
def unprovoked() -> list[int]:
    return not_yet_provoked()


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(terminalreporter: Any) -> None:
    ids = " ".join(map(str, not_yet_provoked()))
    terminalreporter.write_line(f"alarm IDs not yet provoked: {ids or 'none'}")
    words = ", ".join(not_acting())
    terminalreporter.write_line(f"NC words known and not acting yet: {words or 'none'}")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    marks = list(item.iter_markers("provokes"))
    if not marks:
        return (yield)
    with pytest.MonkeyPatch.context() as patch:
        seen = _watch(patch)
        result = yield
    rows = getattr(item, "callspec", None)
    if rows is not None and "alarm_id" in rows.params:
        marks = _of_row(item, marks, rows.params["alarm_id"])
    for mark in marks:
        _check(seen, *mark.args, **mark.kwargs)
    return result


def _watch(patch: pytest.MonkeyPatch) -> _Seen:
    seen = _Seen()
    make, come_up = Alarm.__init__, Reactions.come_up

    def made(alarm: Alarm, *args: Any, **values: Any) -> None:
        make(alarm, *args, **values)
        seen.alarms.append(alarm)

    def came_up(reactions: Reactions, alarm: Alarm) -> bool:
        ends = come_up(reactions, alarm)
        seen.ended.append((alarm, ends))
        return ends

    patch.setattr(Alarm, "__init__", made)
    patch.setattr(Reactions, "come_up", came_up)
    return seen


def _of_row(item: pytest.Item, marks: list[pytest.Mark], alarm_id: int) -> list[pytest.Mark]:
    """The mark of this row of a parametrized test; every mark must have a row."""
    rows = set()
    for table in item.iter_markers("parametrize"):
        names = table.args[0]
        names = names.replace(",", " ").split() if isinstance(names, str) else list(names)
        if "alarm_id" in names:
            values = [getattr(row, "values", row) for row in table.args[1]]
            place = names.index("alarm_id")
            rows |= {row[place] if isinstance(row, list | tuple) else row for row in values}
    assert {mark.args[0] for mark in marks} <= rows, "a mark without a row"
    return [mark for mark in marks if mark.args[0] == alarm_id]


def _check(seen: _Seen, alarm_id: int, reaction_class: int, **values: object) -> None:
    mine = [alarm for alarm in seen.alarms if alarm.id == alarm_id]
    assert mine, f"{alarm_id} has not come up, but {[alarm.id for alarm in seen.alarms]}"
    assert mine[0].entry.reaction_class == reaction_class
    for alarm in mine:
        assert [n for n, value in alarm.values.items() if value is None or value == ""] == []
        assert str(alarm).startswith(f"ID {alarm_id} class {reaction_class}: ")
    expected = {name: str(value) for name, value in values.items()}
    found = [{n: str(alarm.values.get(n)) for n in expected} for alarm in mine]
    assert expected in found
    assert {ends for alarm, ends in seen.ended if alarm.id == alarm_id} <= {reaction_class > 1}
