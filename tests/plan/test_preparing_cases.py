"""Cases are prepared in this process or in others; every mistake of them is named."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import preparing, runner
from axisrig.bench.campaign.processes import Died
from axisrig.bench.campaign.runner import prepare_all
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.plan.plan import read_plan
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program


def case_of(run: str, rig: str = "r.toml", line: int = 2, **more: Any) -> Case:
    return Case("p", run, f"p-{run}", 0, Path("a.nc"), Path(rig), {}, (), "", (), "", 1, 0,
                Path("p.csv"), line, {}, **more)  # fmt: skip


class Prepared:
    """Where cases are prepared (`built`) or only read, here or apart."""

    def __init__(self, patch: pytest.MonkeyPatch, first: list[int], few: int = 20) -> None:
        self.here: list[str] = []
        self.apart: list[list[str]] = []
        self.options: dict[str, Any] = {}
        self.wrong: dict[str, UserError] = {}
        self.dead: set[str] = set()
        patch.setattr(runner, "prepare", self._look("built"))
        patch.setattr(runner, "read_case", self._look("read"))
        patch.setattr(runner, "look_at", lambda case, _: [f"looked at {case.case}"])
        patch.setattr(runner, "built_first", lambda cases: [n for n in first if n < len(cases)])
        patch.setattr(runner, "run_apart", self._run_apart)
        patch.setattr(runner, "CellWarnings", Warnings)
        patch.setattr(runner, "FEW", few)
        patch.setattr(runner, "CHUNK", 2)

    def _look(self, how: str) -> Any:
        def look(case: Case) -> None:
            self.here.append(f"{how} {case.case}")
            if case.case in self.wrong:
                raise self.wrong[case.case]

        return look

    def _run_apart(self, function: Any, tasks: Any, **options: Any) -> Any:
        self.options = options
        for look, cases in tasks:
            own, self.here = self.here, []
            if any(case.case in self.dead for case in cases):
                found = Died("crashed")
            else:
                found = function(look, cases)
            self.apart.append(self.here)
            self.here = own
            yield found


class Warnings:
    """Keeps what was looked at."""

    def __init__(self, beside: Any) -> None:
        self._lines = [f"beside {case.case}" for case in beside]

    def add(self, looked: list[str]) -> None:
        self._lines += looked

    def lines(self) -> list[str]:
        return self._lines


CASES = [case_of("a"), case_of("b"), case_of("c", "other.toml"), case_of("d"), case_of("e")]


def prepared(**given: Any) -> list[str]:
    return prepare_all(CASES, **{"apart": (), "call_limit_s": 5.0, **given})


def test_in_one_process_all_is_prepared_here(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Prepared(monkeypatch, [0, 2], few=0)
    lines = prepared(beside=[case_of("x")])
    assert found.here == ["built a", "built c", "read b", "read d", "read e"]
    assert found.apart == []
    assert lines[0] == "beside x"
    assert sorted(lines[1:]) == [f"looked at {name}" for name in "abcde"]


def test_several_processes_get_what_is_not_the_first_of_its_rig(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = Prepared(monkeypatch, [0, 1, 2], few=2)
    prepared(jobs=3)
    assert found.here == ["built a", "built c"]
    assert found.apart == [["built b"], ["read d", "read e"]]
    assert (found.options["jobs"], found.options["call_limit_s"]) == (3, 5.0)
    few = Prepared(monkeypatch, [0, 1, 2], few=3)
    prepared(jobs=3)
    assert few.here == ["built a", "built b", "built c"]
    pieces = Prepared(monkeypatch, [0])
    prepared(jobs=2)
    assert pieces.apart == [["read b", "read c"], ["read d", "read e"]]


def test_a_foreign_rig_is_built_apart_and_what_dies_there_dies_again_later(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = Prepared(monkeypatch, [0, 2])
    found.dead = {"c"}
    lines = prepared(apart={Path("other.toml")})
    assert found.here == ["built a", "read b", "read d", "read e"]
    assert found.apart == [[]]
    assert "looked at c" not in lines
    found.dead = set()
    assert "looked at c" in prepared(apart={Path("other.toml")})


def test_every_mistake_is_named_wherever_it_was_found(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Prepared(monkeypatch, [0, 2], few=0)
    found.wrong = {name: UserError(f"odd {name}", file=Path("p.csv"), line=line)
                   for name, line in (("e", 2), ("a", 4), ("c", 3))}  # fmt: skip
    for jobs in (1, 3):
        with pytest.raises(UserError) as caught:
            prepared(jobs=jobs, apart={Path("other.toml")})
        error = caught.value
        assert [one.message for one in (error, *error.further)] == ["odd e", "odd c", "odd a"]
    assert prepare_all([], apart=(), call_limit_s=5.0) == []


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ('N20 #MSG ["%d", 1]\nN30 G4 1', ["check:msg:N30"]),
        ('N20 #MSG SAVE ["%d", 1]\nN30 #MSG ["%d", 2]', []),
        ("N30 G4 1", ["check:msg:N20", "check:msg:N30"]),  # a program that prints nothing
    ],
)
def test_a_check_of_a_block_or_an_axis_that_is_not_there_is_refused(
    text: str, wrong: list[str], tmp_path: Path
) -> None:
    """Also one that only statistics over several runs ask for."""
    program = tmp_path / "a.nc"
    program.write_text(f"{text}\nN99 M30\n", encoding="utf-8")
    own = [parse_check(name, "> 1", "") for name in ("msg:N20", "latch_mm:Z", "duration_s")]
    sampled: Any = [parse_check(name, "> 1", "") for name in ("msg:N30", "lag_mm_max:Q")]
    case = case_of("a")
    case = replace(case, checks=tuple(own), sampled=tuple(sampled))
    programs = [read_program(program, ("X", "Z"))]
    found = [str(error) for error in preparing._wrong_metrics(case, ("X", "Z"), programs)]
    for column in (*wrong, "check:lag_mm_max:Q"):
        assert any(column in one for one in found), column
    assert len(found) == len(wrong) + 1
    assert "the rig has no such axis" in found[-1]
    assert all("the program has no #MSG in such a block" in one for one in found[:-1])


MAIN, LAST = "N10 G4 1\n", "N99 M30\n"
CALLED = {"sub.nc": 'N40 #MSG ["%d", 4]\nN45 L deep\nM29\n', "deep.nc": 'N50 #MSG ["%d", 5]\nM29\n'}


@pytest.mark.parametrize(
    ("text", "printing"),
    [
        # docs/plc.md: any block N30 that has printed
        (f'%MAIN\n{MAIN}N30 #MSG ["%d", 1]\n{LAST}', ["N30"]),
        (f'%L SUB\nN30 #MSG ["%d", 1]\nM29\n%MAIN\nN10 LL SUB\n{LAST}', ["N30"]),
        (
            f'%L A\nN20 #MSG ["%d", 1]\nM29\n%L B\nN30 #MSG ["%d", 1]\nM29\n%MAIN\n'
            f'N10 LL A\nN15 LL B\n{LAST}',
            ["N20", "N30"],
        ),
        (f"%MAIN\nN10 L sub\n{LAST}", ["N40", "N50"]),
        (f"%L SUB\nN5 L deep.nc\nM29\n%MAIN\nN10 LL SUB\n{LAST}", ["N50"]),
        (f'%MAIN\nN10 L sub\nN30 #MSG ["%d", 1]\n{LAST}', ["N30", "N40", "N50"]),
        # In their order in the program, each once
        (f'%MAIN\nN50 #MSG ["%d", 1]\nN30 #MSG ["%d", 1]\n{LAST}', ["N50", "N30"]),
        (f'%MAIN\nN20 #MSG ["%d", 1]\nN20 #MSG ["%d", 1]\n{LAST}', ["N20"]),
        # A block without a number is none that a check names
        (f'%MAIN\n#MSG ["%d", 1]\n{LAST}', []),
    ],
)  # fmt: skip
def test_a_block_of_a_subprogram_prints_too(text: str, printing: list[str], tmp_path: Path) -> None:
    """Local, global, and what a global one calls; other blocks are refused with those there are."""
    for name, content in {"a.nc": text, **CALLED}.items():
        (tmp_path / name).write_text(content, encoding="utf-8")
    programs = [read_program(tmp_path / "a.nc", ("Z",))]
    for number in ("N10", "N20", "N30", "N40", "N50", "NNone"):
        check: Any = replace(parse_check("msg:N20", "> 1", ""), block=(number, 1))
        case = replace(case_of("a"), checks=(check,))
        errors = [*preparing._wrong_metrics(case, ("Z",), programs)]
        assert [error.value for error in errors] == ([] if number in printing else [number])
        for error in errors:
            assert str(error.allowed) == (", ".join(printing) or "none")


def test_blocks_of_every_program_of_a_run_print(tmp_path: Path) -> None:
    """That of the row, and those that the PLC side starts with what they call."""
    texts = {
        "a.nc": f"%A\n{MAIN}{LAST}",
        "b.nc": f'%B\nN20 #MSG ["%d", 1]\n{LAST}',
        "c.nc": f"%C\nN10 L sub\n{LAST}",
    }
    for name, content in {**texts, **CALLED}.items():
        (tmp_path / name).write_text(content, encoding="utf-8")
    programs = [read_program(tmp_path / name, ("Z",)) for name in texts]
    checks = [parse_check(f"msg:{number}", "> 1", "") for number in ("N20", "N40", "N50", "N60")]
    case = replace(case_of("a"), checks=tuple(checks))
    errors = [*preparing._wrong_metrics(case, ("Z",), programs)]
    assert [error.value for error in errors] == ["N60"]


SEARCHING = "case,program,rig,search:plant:z.x_mm,check:lag_mm_max:Z\ns,a.nc,r.toml,{},<= 1\n"


def searching(folder: Path, text: str) -> Case:
    for name in ("a.nc", "r.toml"):
        (folder / name).touch()
    (folder / "p.csv").write_text(SEARCHING.format(text), encoding="utf-8")
    (case,) = read_plan(folder / "p.csv").cases
    return case


@pytest.mark.parametrize(
    ("text", "ends"), [("300 .. 900 to 10", ["300", "900"]), ("5 .. -0.5 to 0.5", ["5.0", "-0.5"])]
)
@pytest.mark.parametrize("bad", ["none", "first", "last"])
@pytest.mark.parametrize("look", [preparing.read_case, preparing.prepare])
def test_a_search_is_looked_at_with_the_values_of_both_its_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, look: Any, text: str, ends: list[str], bad: str
) -> None:
    """A mistake at one end alone is found too; the case is made with the first value."""
    case = searching(tmp_path, text)
    wrong = {"none": "", "first": ends[0], "last": ends[1]}[bad]
    probes: list[tuple[str, str]] = []

    def settings_of(probe: Case) -> Any:
        value = probe.inputs["plant:z.x_mm"]
        probes.append((probe.run, value))
        if value == wrong:
            raise UserError(f"{value} is too much")
        rig = SimpleNamespace(axis=("Z",))
        return SimpleNamespace(rig=rig, value=value)

    monkeypatch.setattr(preparing, "settings_of", settings_of)
    monkeypatch.setattr(preparing, "_program", lambda *_: "program")
    monkeypatch.setattr(preparing, "programs_of", lambda *_: {})
    monkeypatch.setattr(preparing, "_wrong_metrics", lambda *_: [])
    monkeypatch.setattr(preparing, "_wrong_variables", lambda *_: [])
    monkeypatch.setattr(preparing, "rig_files", lambda _: [])
    monkeypatch.setattr(preparing, "is_paced", lambda _: True)
    monkeypatch.setattr(preparing, "check_plant", lambda _: None)
    if wrong:
        with pytest.raises(UserError, match=f"^{wrong} is too much"):
            look(case)
        return
    assert look(case).settings.value == ends[0]
    assert probes == [("p-s-s01", ends[0]), ("p-s-s02", ends[1])]


def test_mistakes_of_the_first_plan_come_before_those_of_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By file and line behind it, whatever the names are."""
    found = Prepared(monkeypatch, [0, 1, 2])
    cases = [replace(case_of(name), file=Path(f"{name}.csv")) for name in ("m", "a", "z")]
    found.wrong = {
        name: UserError(f"odd {name}", file=Path(f"{name}.csv"), line=2) for name in "maz"
    }
    with pytest.raises(UserError) as caught:
        prepare_all(cases, apart=(), call_limit_s=5.0)
    messages = [one.message for one in (caught.value, *caught.value.further)]
    assert messages == ["odd m", "odd a", "odd z"]


def test_a_rig_is_read_again_when_one_of_its_files_has_changed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Many rows have the same, so it is read once for each content of all its files."""
    rig, base = tmp_path / "rig.toml", tmp_path / "base.toml"
    for path in (rig, base):
        path.write_text("one", encoding="utf-8")
    reads: list[Path] = []

    def read_rig(path: Path) -> tuple[str, list[Path]]:
        reads.append(path)
        return f"rig {len(reads)}", [rig, base]

    monkeypatch.setattr(preparing, "read_rig", read_rig)
    monkeypatch.setattr(preparing, "_rigs", {})
    monkeypatch.setattr(preparing, "read_settings", lambda table, files, _: (table, files))
    case = case_of("a", rig=str(rig))
    assert [preparing.settings_of(case) for _ in range(2)] == [("rig 1", [rig, base])] * 2  # type: ignore[comparison-overlap]
    for number, path in enumerate((base, rig), start=2):
        path.write_text("other", encoding="utf-8")
        assert preparing.settings_of(case) == (f"rig {number}", [rig, base])  # type: ignore[comparison-overlap]
    path.unlink()
    assert preparing.settings_of(case)[0] == "rig 4"  # type: ignore[index]


@pytest.mark.parametrize(
    ("cell", "value"), [("100 at=never", "never"), ("100 at=M50 of=2", "of"), ("abc", "abc")]
)
def test_a_mistake_in_a_cell_names_the_part_that_is_wrong(cell: str, value: str) -> None:
    rig = str(Path(__file__).parents[2] / "testplans" / "rigs" / "distance-z.toml")
    case = replace(case_of("a", rig), inputs={"plc:Z.torque_limit": cell})
    with pytest.raises(UserError) as caught:
        preparing.settings_of(case)
    assert str(caught.value.value) == value
    assert "plc:Z.torque_limit" in caught.value.message


@pytest.mark.parametrize("is_real", [True, False])
@pytest.mark.interpreted
def test_a_machine_on_a_real_bus_is_not_built_before_its_run_and_its_plant_is_looked_at(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, is_real: bool
) -> None:
    """Nothing is sent before the run; a case that was not built is looked at again."""
    done: list[object] = []
    made = preparing.Prepared("settings", "program")  # type: ignore[arg-type]

    def machine(*parts: object) -> Any:
        done.append(parts)
        return SimpleNamespace(close=lambda: done.append("closed"))

    preparing.forget()
    monkeypatch.setattr(preparing, "rig_files", lambda _: [])
    monkeypatch.setattr(preparing, "read_case", lambda _: made)
    monkeypatch.setattr(preparing, "is_paced", lambda _: is_real)
    monkeypatch.setattr(preparing, "check_plant", done.append)
    monkeypatch.setattr(preparing, "Machine", machine)
    monkeypatch.setattr(preparing, "_keep", lambda *_: done.append("kept"))
    assert preparing.prepare(case_of("a")) is made
    assert done == (["settings"] if is_real else [("settings", "program"), "closed", "kept"])
