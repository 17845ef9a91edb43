"""Words that a call was made with, the row that is named beside an error, and what keeps a case."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign import preparing
from axisrig.bench.campaign.checking import _by_row
from axisrig.bench.campaign.preparing import Prepared, forget, recall
from axisrig.bench.campaign.sharing import _values
from axisrig.bench.campaign.used_variables import Used
from axisrig.bench.plan.statistic_checks import parse_any_check
from axisrig.bench.plan.table import Place
from axisrig.kernel.errors import UserError


@pytest.mark.parametrize(
    ("words", "values"),
    [
        ("run a.csv", []),
        ("run --set A=1", ["A=1"]),
        ("run --set=A=1", ["A=1"]),
        ("run --set=A=1=2", ["A=1=2"]),
        ("run --set A=1 a.csv --set B=x=y", ["A=1", "B=x=y"]),
        ("run --set=A=1 --settle=B=2 --info=C=3", ["A=1"]),
    ],
)
def test_a_value_begins_after_the_first_sign_of_equality(words: str, values: list[str]) -> None:
    assert _values(words.split(), "--set") == values


CASE = case_of("a", program=Path("part.nc"), file=Path("plans/p.csv"), line=7)
ROW = "p.csv:7 runs it (case 'a')"


@pytest.mark.parametrize(
    ("file", "value", "hint", "shown"),
    [
        ("part.nc", "V.E.FEED", None, ROW),
        ("part.nc", "V.E.FEED", "did you mean V.E.FED?", f"did you mean V.E.FED?; {ROW}"),
        ("sub.nc", "V.E.FEED", "did you mean V.E.FED?", "did you mean V.E.FED?"),  # not its own
        ("part.nc", "G200", "no such word", "no such word"),
        ("part.nc", None, None, None),
        (None, "V.E.FEED", None, None),
    ],
)
def test_the_row_is_named_beside_a_variable_of_its_own_program(
    file: str | None, value: str | None, hint: str | None, shown: str | None
) -> None:
    with pytest.raises(UserError) as caught, _by_row(CASE):
        raise UserError(
            "no value", file=None if file is None else Path(file), value=value, hint=hint
        )
    assert caught.value.hint == shown
    with _by_row(CASE):
        pass


def test_a_case_with_other_statistics_is_another_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its metrics are looked at when it is prepared."""
    forget()
    program, rig = tmp_path / "part.nc", tmp_path / "rig.toml"
    for path in (program, rig):
        path.write_text("first", encoding="utf-8")
    mean, spread = (
        parse_any_check(f"{name}(latch_error_um)", "<= 1", "p.csv:2") for name in ("mean", "spread")
    )
    sampled: Any = (mean,)
    case = case_of("a", rig, program=program, sampled=sampled)
    settings: Any = SimpleNamespace(is_checked=False)
    parsed: Any = SimpleNamespace(blocks=[], subprograms={})
    prepared = Prepared(settings, parsed)
    monkeypatch.setattr(preparing, "started_files", lambda _: [])
    files = [program, rig]
    preparing._keep(case, prepared, files, preparing._content(files))
    assert recall(case) is prepared
    for others in ((), (spread,), (mean, spread)):
        assert recall(replace(case, sampled=others)) is None  # type: ignore[arg-type]
    assert recall(replace(case, title="another")) is prepared  # what no machine is made of
    forget()


@pytest.mark.parametrize("overridden", [True, False])
@pytest.mark.parametrize("line", [2, 9])
def test_a_cell_of_the_row_itself_is_wrong_where_nothing_uses_its_variable(
    monkeypatch: pytest.MonkeyPatch, overridden: bool, line: int
) -> None:
    """Not one of a default above it, nor one that the command line has replaced."""
    monkeypatch.setattr(
        preparing, "used_variables", lambda *_: Used(frozenset({"STEP"}), all_may=False)
    )
    feed, step = "plc:V.E.FEED", "plc:V.E.STEP"
    case = case_of(
        "a", inputs={feed: "1", step: "2"},
        places={name: Place(Path("p.csv"), line, 4, name) for name in (feed, step)},
        overridden=frozenset({feed} if overridden else ()),
    )  # fmt: skip
    found = list(preparing._wrong_variables(case, None, None))  # type: ignore[arg-type]
    assert [error.value for error in found] == (["1"] if line == 2 and not overridden else [])
