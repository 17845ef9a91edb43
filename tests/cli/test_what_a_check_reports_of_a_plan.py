"""What `axisrig check PLAN` reports: machines that are built, warnings, notes, all mistakes."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import checking
from axisrig.bench.campaign.cell_warnings import CellWarnings, Looked
from axisrig.bench.campaign.checking import check_file, check_files, check_inputs, rigs_of
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.rig.plc.words import VARIABLE
from axisrig.kernel.errors import UserError


class Looking:
    """Stands in for the machines of rows: which were built, and what is found in them."""

    def __init__(self, patch: pytest.MonkeyPatch, first: list[int] | None = None) -> None:
        self.built: list[str] = []
        self.read: list[str] = []
        self.wrong: dict[str, UserError] = {}
        self.texts: dict[str, list[str]] = {}

        def found(warnings: CellWarnings, case: Case, prepared: Case) -> None:
            assert case is prepared
            for number, text in enumerate(self.texts.get(case.case, [])):
                warnings.add([Looked(None, f"{case.case}{number}", text, is_unused=False)])

        patch.setattr(checking, "prepare", self._look(self.built))
        patch.setattr(checking, "read_case", self._look(self.read))
        patch.setattr(checking.CellWarnings, "look", found)
        if first is not None:
            patch.setattr(checking, "built_first", lambda cases: first)

    def _look(self, into: list[str]) -> Any:
        def look(case: Case) -> Case:
            into.append(case.case)
            if case.case in self.wrong:
                raise self.wrong[case.case]
            return case

        return look


def plan(folder: Path, *names: str, column: str = "check:alarms", cell: str = "none") -> Plan:
    for name in ("part.nc", "r.toml"):
        (folder / name).touch()
    rows = "".join(f"{name},part.nc,r.toml,{cell}\n" for name in names)
    (folder / "p.csv").write_text(f"case,program,rig,{column}\n{rows}", encoding="utf-8")
    return read_plan(folder / "p.csv")


def test_machines_of_some_rows_are_built_and_the_others_are_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looking, rows = Looking(monkeypatch, first=[0, 2]), plan(tmp_path, *"abcd")
    lines = check_file(rows.path, plan=rows).splitlines()
    assert (looking.built, looking.read) == (["a", "c"], ["b", "d"])
    assert lines[0] == f"{rows.path}: 4 runs"
    assert [line.strip() for line in lines[1:5]] == ["p-a", "p-b", "p-c", "p-d"]
    assert lines[5:] == [
        "note: the machine of 2 rows was built, of the other 2 as they run",
    ]
    whole = Looking(monkeypatch, first=[0, 1, 2, 3])
    assert "note: " not in check_file(rows.path, plan=rows)
    assert (whole.built, whole.read) == (["a", "b", "c", "d"], [])


def test_warnings_come_before_notes_in_the_order_of_the_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looking = Looking(monkeypatch)
    looking.texts = {"a": ["first", "second"], "b": ["third"]}
    rows = plan(tmp_path, "a", "b", column="note:is", cell="")
    lines = check_file(rows.path, plan=rows).splitlines()
    assert lines[3:] == [
        *("warning: first", "warning: second", "warning: third"),
        *(f"note: {rows.path}:{line}: case {name!r} has no check: it passes unless an alarm comes"
          " up" for line, name in ((2, "a"), (3, "b"))),
    ]  # fmt: skip


@pytest.mark.parametrize("texts", [["one"], ["one", "two"], []])
def test_with_strict_every_warning_rejects(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, texts: list[str]
) -> None:
    """A row without a check is a note and rejects nothing."""
    looking = Looking(monkeypatch)
    looking.texts = {"a": texts}
    rows = plan(tmp_path, "a", column="note:is", cell="")
    assert check_file(rows.path, plan=rows).count("warning: ") == len(texts)
    if not texts:
        assert "note: " in check_file(rows.path, plan=rows, is_strict=True)
        return
    with pytest.raises(UserError) as caught:
        check_file(rows.path, plan=rows, is_strict=True)
    assert [one.message for one in (caught.value, *caught.value.further)] == texts


def test_what_is_wrong_with_rows_comes_together_by_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether a row was read or built; nothing is described then."""
    looking, rows = Looking(monkeypatch, first=[2]), plan(tmp_path, *"abc")
    looking.texts = {"b": ["a warning"]}
    other = tmp_path / "a.toml"
    looking.wrong = {
        "a": UserError("rig", file=other, line=1),
        "b": UserError("later", file=rows.path, line=9),
        "c": UserError("sooner", file=rows.path, line=4),
    }
    with pytest.raises(UserError) as caught:
        check_file(rows.path, plan=rows)
    found = [one.message for one in (caught.value, *caught.value.further)]
    assert found == ["sooner", "later", "rig"]


@pytest.mark.parametrize(
    ("file", "value", "hint", "shown"),
    [
        ("part.nc", f"{VARIABLE}FEED", None, "p.csv:3 runs it (case 'b')"),
        ("part.nc", f"{VARIABLE}FEED", "set it", "set it; p.csv:3 runs it (case 'b')"),
        ("part.nc", "G999", "set it", "set it"),  # no variable: the place in the program is enough
        ("r.toml", f"{VARIABLE}FEED", "set it", "set it"),
        ("part.nc", None, None, None),
    ],
)
def test_a_variable_that_no_column_gives_is_named_with_the_row_that_runs_the_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, file: str, value: str | None,
    hint: str | None, shown: str | None,
) -> None:  # fmt: skip
    looking, rows = Looking(monkeypatch), plan(tmp_path, "a", "b")
    error = UserError("nobody sets it", file=tmp_path / file, line=7, value=value, hint=hint)
    looking.wrong = {"b": error}
    with pytest.raises(UserError, match="nobody sets it") as caught:
        check_file(rows.path, plan=rows)
    assert (caught.value.hint, caught.value.line) == (shown, 7)


def test_mistakes_of_the_first_file_come_first_whatever_its_name_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def do(_what: Any, path: Path, *_: Any, **__: Any) -> str:
        raise UserError(f"of {path.name}", file=path)

    monkeypatch.setattr(checking, "do_apart", do)
    files = [tmp_path / f"{name}.toml" for name in "zam"]
    with pytest.raises(UserError) as caught:
        check_files(files, [], (False, None), pytest.fail)
    found = [one.message for one in (caught.value, *caught.value.further)]
    assert found == ["of z.toml", "of a.toml", "of m.toml"]


@pytest.mark.parametrize("name", ["r.toml", "R.TOML", "r.Toml"])
def test_a_rig_is_one_in_whatever_letters_its_ending_is(name: str) -> None:
    assert rigs_of(Path(name), None) == [Path(name)]


def test_a_refusal_of_a_file_names_its_ending_and_that_of_a_folder_none(tmp_path: Path) -> None:
    (tmp_path / "plans.v2").mkdir()
    (tmp_path / "a.txt").touch()
    with pytest.raises(UserError, match="a folder, no file to check") as of_folder:
        check_file(tmp_path / "plans.v2")
    with pytest.raises(UserError, match="not a file to check") as of_file:
        check_file(tmp_path / "a.txt")
    assert (of_folder.value.value, of_file.value.value) == (None, ".txt")
    assert of_folder.value.allowed == of_file.value.allowed
    assert of_file.value.allowed == ".csv, .xlsx, .ods, .parquet, .toml, .lst, .lis"


def test_inputs_that_rigs_refuse_come_together(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same row with another rig is looked at by itself."""
    asked: list[str] = []

    def settings_of(case: Case) -> None:
        asked.append(case.run)
        raise UserError(f"no {case.case}", file=case.file, line=case.line)

    monkeypatch.setattr(checking, "settings_of", settings_of)
    rows = plan(tmp_path, "b", "a")
    with pytest.raises(UserError) as caught:
        check_inputs(rows)
    assert [one.message for one in (caught.value, *caught.value.further)] == ["no b", "no a"]
    assert asked == ["p-b", "p-a"]
    monkeypatch.setattr(checking, "settings_of", lambda case: asked.append(case.run))
    asked.clear()
    whole = SimpleNamespace(path=rows.path, cases=rows.cases * 2)
    check_inputs(whole)  # type: ignore[arg-type]
    assert asked == ["p-b", "p-a"]
