"""A case that was checked is kept by its process, for as long as its files stay what they are."""

import shutil
from pathlib import Path

import pytest

from axisrig.bench.campaign import preparing, runner
from axisrig.bench.campaign.preparing import Prepared, prepare, recall
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import prepare_all, run_case
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.kernel.errors import UserError

TESTPLANS = Path(__file__).parents[2] / "testplans"
PLAN = """\
case,program,rig,plc:V.E.FEED,check:latch_error_um,check:alarms
one,probe.nc,rigs/probe-z.toml,600,<= 1,none
two,probe.nc,rigs/probe-z.toml,900,<= 1,none
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copytree(TESTPLANS / "rigs", tmp_path / "rigs")
    shutil.copy(TESTPLANS / "programs" / "probe-z.nc", tmp_path / "probe.nc")
    (tmp_path / "plan.csv").write_text(PLAN, encoding="utf-8")
    preparing.forget()
    return tmp_path


def cases(folder: Path) -> tuple[Case, ...]:
    return read_plan(folder / "plan.csv").cases


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


def test_a_prepared_case_is_recalled_and_no_other(folder: Path) -> None:
    one, two = cases(folder)
    assert recall(one) is None
    prepare(one)
    assert recall(one) is not None
    assert recall(two) is None


@pytest.mark.long
def test_a_run_of_a_kept_case_is_equal_to_one_that_reads_everything(folder: Path) -> None:
    read = [run_case(case, RunFiles()) for case in cases(folder)]
    for case in cases(folder):
        prepare(case)
    for _ in range(2):
        kept = [run_case(case, RunFiles()) for case in cases(folder)]
        assert [run.frame_log_sha256 for run in kept] == [run.frame_log_sha256 for run in read]
        assert [run.facts for run in kept] == [run.facts for run in read]
    assert all(recall(case) is not None for case in cases(folder))


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("rigs/probe-z.toml", "period_us = 1000", "period_us = 2000"),
        ("probe.nc", "M30", "G4 0.1\nM30"),
        ("rigs/lists/axis-z-fine.lst", "\n", "\n# another line\n"),
    ],
)
def test_a_file_with_another_content_is_read_again(
    folder: Path, name: str, old: str, new: str
) -> None:
    (one, _) = cases(folder)
    prepare(one)
    edit(folder / name, old, new)
    assert recall(one) is None
    prepare(one)
    edit(folder / name, new, old)
    assert recall(one) is None


def test_a_mistake_that_is_written_afterwards_is_found(folder: Path) -> None:
    (one, _) = cases(folder)
    prepare(one)
    edit(folder / "probe.nc", "M30", "G777")
    with pytest.raises(UserError, match="G777"):
        prepare(one)
    (folder / "probe.nc").unlink()
    with pytest.raises(UserError, match="cannot be read"):
        prepare(one)


def test_another_cell_or_line_is_another_case(folder: Path) -> None:
    prepare(cases(folder)[0])
    edit(folder / "plan.csv", "600,<= 1", "700,<= 1")
    assert recall(cases(folder)[0]) is None
    edit(folder / "plan.csv", "700,<= 1", "600,<= 2")
    assert recall(cases(folder)[0]) is None
    edit(folder / "plan.csv", "600,<= 2", "600,<= 1")
    assert recall(cases(folder)[0]) is not None
    edit(folder / "plan.csv", "\none,", "\n\none,")
    assert recall(cases(folder)[0]) is None


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("one,probe.nc,", "one,[probe.nc | other.nc],"),
        ("one,probe.nc,rigs/probe-z.toml", "one,probe.nc,[rigs/probe-z.toml | rigs/other.toml]"),
        ("600,<= 1,", "[600 | 700],<= 1,"),
    ],
)
def test_runs_of_one_row_are_cases_of_their_own(folder: Path, old: str, new: str) -> None:
    """They have the same place in the plan; program, rig or input is another one."""
    shutil.copy(folder / "probe.nc", folder / "other.nc")
    edit(folder / "other.nc", "M30", "G4 0.1\nM30")
    shutil.copy(folder / "rigs" / "probe-z.toml", folder / "rigs" / "other.toml")
    edit(folder / "plan.csv", old, new)
    first, second, _ = cases(folder)
    prepared = prepare(first)
    assert recall(first) is prepared
    assert recall(second) is None
    assert prepare(second) is not prepared


def test_a_check_of_the_row_and_an_input_of_the_command_line_make_another_case(
    folder: Path,
) -> None:
    """Both are looked at when a case is prepared."""
    (one, _) = cases(folder)
    prepare(one)
    plan = read_plan(folder / "plan.csv")
    given = plan.with_inputs([parse_assignment("plc:V.E.FEED=600")]).cases[0]
    assert given.inputs == one.inputs
    assert recall(given) is None
    edit(folder / "plan.csv", "check:latch_error_um", "check:latch_error_um:Q")
    with pytest.raises(UserError, match="the rig has no such axis"):
        prepare(cases(folder)[0])


def test_a_program_that_calls_others_is_read_every_time(folder: Path) -> None:
    (folder / "sub.nc").write_text("%sub\nN10 G4 0.1\nM17\n", encoding="utf-8")
    edit(folder / "probe.nc", "M30", "L sub\nM30")
    (one, _) = cases(folder)
    prepare(one)
    assert recall(one) is None


def test_only_so_many_cases_are_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(preparing, "KEPT_MAX", 1)
    one, two = cases(folder)
    for case in (one, two):
        prepare(case)
    assert recall(one) is None
    assert recall(two) is not None


@pytest.mark.long
@pytest.mark.parametrize("jobs", [1, 2])
def test_every_case_that_cannot_be_prepared_is_reported(
    folder: Path, jobs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(folder / "rigs" / "probe-z.toml", folder / "rigs" / "other.toml")
    rows = PLAN.splitlines()
    rows += [rows[1].replace("one,", "three,").replace("600", "nothing")]
    rows += [rows[1].replace("one,", "four,").replace("600", "nowhere").replace("probe-z", "other")]
    (folder / "plan.csv").write_text("\n".join(rows), encoding="utf-8")
    monkeypatch.setattr(runner, "FEW", 0)
    with pytest.raises(UserError, match="nothing") as caught:
        prepare_all(cases(folder), apart=(), call_limit_s=60.0, jobs=jobs)
    assert [error.value for error in caught.value.further] == ["nowhere"]
    lines = [error.line for error in (caught.value, *caught.value.further)]
    assert lines == [len(rows) - 1, len(rows)]


def test_several_processes_prepare_every_case(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "plan.csv").write_text(PLAN + PLAN.splitlines()[2].replace("two", "three"), "utf-8")
    here: list[str] = []
    prepare = runner.prepare

    def prepared(case: Case) -> Prepared:
        here.append(case.case)
        return prepare(case)

    monkeypatch.setattr(runner, "prepare", prepared)
    found: list[tuple[object, list[Case]]] = []

    def noted(_function: object, tasks: list[tuple[object, list[Case]]], **_: object):  # type: ignore[no-untyped-def]
        found.extend(tasks)
        yield from ([] for _ in tasks)

    monkeypatch.setattr(runner, "run_apart", noted)
    monkeypatch.setattr(runner, "FEW", 0)
    prepare_all(cases(folder), apart=(), call_limit_s=60.0, jobs=2)
    assert here == ["one"]
    assert [[case.case for case in some] for _, some in found] == [["two"], ["three"]]
