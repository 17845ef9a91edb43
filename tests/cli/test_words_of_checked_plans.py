"""`axisrig check`: how many runs a case has, rows without checks, which file is what."""

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign import checking
from axisrig.bench.campaign.checking import check_file, check_files, check_inputs, plan_of, rigs_of
from axisrig.bench.campaign.talk import FEW
from axisrig.bench.plan.case import Case
from axisrig.kernel.errors import UserError


def runs(name: str, *swept: dict[str, str], repeats: int = 1, **more: Any) -> list[Case]:
    """Runs of a case: each of its swept values, so often."""
    return [
        case_of(f"{name}-{number}-{repeat}", case=name, swept=values, repeat=repeat, **more)
        for number, values in enumerate(swept or ({},))
        for repeat in range(repeats)
    ]


def many(number: int) -> list[dict[str, str]]:
    return [{"plc:V.E.A": str(n)} for n in range(number)]


PAIRS = [{"plc:V.E.A": str(a), "set:Z.b": str(b)} for a in range(6) for b in range(7)]


@pytest.mark.parametrize(
    ("cases", "line"),
    [
        (runs("a", *many(40)), "a: 40 runs"),
        (runs("a", *PAIRS), "a: 6 x 7 runs"),
        (runs("a", *PAIRS[:-1]), "a: 41 runs"),  # one of the pairs is not chosen
        (runs("a", *many(10), repeats=5), "a: 10 x 5 runs"),
        (runs("a", repeats=33), "a: 33 runs"),
        (runs("a", *[{"plc:V.E.A": "1", **values} for values in many(35)]), "a: 35 runs"),
        (runs("a", *many(31), title="the title"), "a: 31 runs  the title"),
    ],
)
def test_a_case_of_many_runs_says_of_how_many_values_they_are(cases: list[Case], line: str) -> None:
    assert checking._described(cases, is_verbose=False) == [line]


def test_of_few_runs_or_where_asked_each_has_a_line() -> None:
    few, more = runs("a", *many(FEW)), runs("a", *many(FEW + 1))
    for cases, is_verbose in ((few, False), (few, True), (more, True)):
        found = checking._described(cases, is_verbose=is_verbose)
        assert found == [case.run for case in cases]
    assert checking._described(more, is_verbose=False) == [f"a: {FEW + 1} runs"]


def test_cases_are_in_their_order_and_one_of_a_single_run_is_named_by_it() -> None:
    search: Any = SimpleNamespace(column="plant:p.x_mm", probes_max=9)
    alone = case_of("s", search=search, title="found")
    mixed = [*runs("b", *many(30)), alone, *runs("a", *many(2))]
    assert checking._described([*mixed, *runs("b", {"plc:V.E.A": "31"})], is_verbose=False) == [
        "b: 31 runs",
        "p-s  found  searches plant:p.x_mm, at most 9 probes",
        "a: 2 runs",
    ]


def test_rows_that_ask_for_nothing_are_named_once() -> None:
    """Statistics of a row, and a search, ask for something too."""
    search: Any = SimpleNamespace(checks=())
    place: Any = object()
    cases = [
        case_of("a", line=2, places={"plc:V.E.A": place}),
        case_of("a", line=2, places={}),
        case_of("b", line=3, places={"check:alarms": place}),
        case_of("c", line=4, places={}, sampled=("mean",)),
        case_of("d", line=5, places={}, search=search),
        case_of("e", line=6, places={}),
        case_of("e", line=6, places={}, file=Path("more.csv")),
    ]
    assert [line.partition(" ")[0] for line in checking._without_checks(cases)] == [
        "p.csv:2:", "p.csv:6:", "more.csv:6:",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("select", "head", "rows"),
    [
        (None, "5 runs and 2 rows of statistics", ["p-a", "p-b"]),
        ("p-a-001", "1 run", []),
        ("p-a", "2 runs and 1 row of statistics", ["p-a"]),
        ("not p-a-002", "4 runs and 1 row of statistics", ["p-b"]),
        ("c", "1 run", []),
    ],
)
def test_statistics_of_a_choice_are_those_that_it_can_have(
    place: Path, monkeypatch: pytest.MonkeyPatch, select: str | None, head: str, rows: list[str]
) -> None:
    """Rows of statistics of which every run is chosen."""
    text = "case,program,rig,repeats,check:mean(latch_error_um)\n"
    text += "".join(f"{name},part.nc,rig.toml,{n},{c}\n" for name, n, c in
                    (("a", "2", "<= 1"), ("b", "2", "<= 2"), ("c", "", "")))  # fmt: skip
    (place / "p.csv").write_text(text, encoding="utf-8")
    prepared: Any = SimpleNamespace()
    monkeypatch.setattr(checking, "prepare", lambda _: prepared)
    monkeypatch.setattr(checking.CellWarnings, "look", lambda *_: None)
    shown: list[str] = []
    check_files([Path("p.csv")], [], (False, None), shown.append, select=select)
    lines = shown[0].splitlines()
    assert lines[0] == f"p.csv: {head}"
    found = [line.split()[0] for line in lines if "statistics over 2 runs: mean(" in line]
    assert found == rows


# Which file is what


def test_a_plan_is_read_as_one_and_loads_its_rigs_once_each(place: Path) -> None:
    (place / "other.toml").write_text(
        (place / "rig.toml").read_text(encoding="utf-8"), encoding="utf-8"
    )
    rows = "a,part.nc,rig.toml\nb,part.nc,other.toml\nc,part.nc,rig.toml\n"
    (place / "p.csv").write_text(f"case,program,rig\n{rows}", encoding="utf-8")
    plan = plan_of(Path("p.csv"))
    assert plan is not None
    assert [rig.name for rig in rigs_of(Path("p.csv"), plan)] == ["other.toml", "rig.toml"]
    for name, rigs in (("rig.toml", ["rig.toml"]), ("part.nc", []), ("lists/channel.lst", [])):
        assert plan_of(Path(name)) is None
        assert [rig.name for rig in rigs_of(Path(name), None)] == rigs
    (place / "dir.csv").mkdir()
    assert plan_of(Path("dir.csv")) is None


@pytest.mark.parametrize(
    ("name", "words"),
    [("part.nc", "no plan, rig or list.*axisrig nc --check"), ("lists", "a folder, no file"),
     ("dir.csv", "a folder, no file"), ("part.txt", "not a file to check; found '.txt'")],
)  # fmt: skip
def test_what_is_nothing_to_check_is_refused(place: Path, name: str, words: str) -> None:
    (place / "dir.csv").mkdir()
    (place / "part.txt").touch()
    with pytest.raises(UserError, match=re.compile(words, re.DOTALL)):
        check_file(Path(name))


def test_each_file_is_checked_also_after_one_that_is_rejected(
    monkeypatch: pytest.MonkeyPatch, place: Path
) -> None:
    """All that is wrong comes at the end; the others are described meanwhile."""
    asked: list[Any] = []

    def do(what: Any, place: Path, *_: Any, rigs: list[Path], **named: Any) -> str:
        asked.append((place.name, what.keywords["is_strict"], [rig.name for rig in rigs],
                      named["limits"], named["file"].name))  # fmt: skip
        if place.name == "bad.toml":
            raise UserError("first", file=place)
        return f"good {place.name}"

    monkeypatch.setattr(checking, "do_apart", do)
    shown: list[str] = []
    files = [Path("bad.toml"), Path("lists/channel.lst"), Path("rig.toml")]
    with pytest.raises(UserError, match="first"):
        check_files(files, [], (True, 3.0), shown.append, is_strict=True)
    assert shown == ["good channel.lst", "good rig.toml"]
    assert asked == [
        ("bad.toml", True, ["bad.toml"], (True, 3.0), "bad.toml"),
        ("channel.lst", True, [], (True, 3.0), "channel.lst"),
        ("rig.toml", True, ["rig.toml"], (True, 3.0), "rig.toml"),
    ]


@pytest.mark.parametrize(
    ("select", "shown", "wrong"),
    [
        (None, ["p.csv", "q.csv", "rig.toml"], []),
        ("first", ["p.csv", "rig.toml"], []),
        ("first or second", ["p.csv", "q.csv", "rig.toml"], []),
        ("second", ["q.csv", "rig.toml"], []),
        ("third", ["rig.toml"], ["no case fits; found 'third'"]),
        ("(", ["rig.toml"], ["-k '(' cannot be read"]),
    ],
)
def test_of_several_plans_those_without_a_chosen_case_are_passed_over(
    monkeypatch: pytest.MonkeyPatch, place: Path, select: str | None, shown: list[str],
    wrong: list[str],
) -> None:  # fmt: skip
    """As `axisrig run -k` does; where no plan has one that is a mistake, once."""
    for name, case in (("p", "first"), ("q", "second")):
        (place / f"{name}.csv").write_text(
            f"case,program,rig\n{case},part.nc,rig.toml\n", encoding="utf-8"
        )
    asked: list[str] = []

    def do(_what: Any, path: Path, *_: Any, **named: Any) -> str:
        assert named["file"] == path
        return path.name

    monkeypatch.setattr(checking, "do_apart", do)
    files = [Path(name) for name in ("p.csv", "q.csv", "rig.toml")]
    if not wrong:
        check_files(files, [], (False, None), asked.append, select=select)
    else:
        with pytest.raises(UserError) as caught:
            check_files(files, [], (False, None), asked.append, select=select)
        found = [str(error) for error in (caught.value, *caught.value.further)]
        assert len(found) == len(wrong)
        assert all(words in text for words, text in zip(wrong, found, strict=True))
    assert asked == shown


def test_inputs_are_looked_at_once_for_each_row_and_each_value_of_a_list(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of 2 x 3 pairs those that bring a value nobody has looked at; repeats bring none."""
    asked: list[str] = []
    monkeypatch.setattr(checking, "settings_of", lambda case: asked.append(case.run))
    pairs = [{"plc:V.E.A": a, "plc:V.E.B": b} for a in "12" for b in "345"]
    cases = [*runs("a", *pairs, repeats=2), *runs("b", line=3), *runs("b", line=3, repeats=2)]
    plan: Any = SimpleNamespace(cases=cases, path=Path("p.csv"))
    check_inputs(plan)
    assert asked == ["p-a-0-0", "p-a-1-0", "p-a-2-0", "p-a-3-0", "p-b-0-0"]
    other: Any = SimpleNamespace(
        cases=[*runs("a"), *runs("a", rig=Path("foreign.toml"))], path=Path("p.csv")
    )
    asked.clear()
    check_inputs(other)
    assert len(asked) == 2
    # Rows of included tables have the lines of their own files
    tables: Any = SimpleNamespace(
        cases=[*runs("a"), *runs("b", file=Path("rows.csv"))], path=Path("p.csv")
    )
    asked.clear()
    check_inputs(tables)
    assert asked == ["p-a-0-0", "p-b-0-0"]
