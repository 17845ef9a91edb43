"""What is shown while a command takes its time, and what many runs leave on a terminal."""

import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import pytest
import typer
from cli_plan import HEADER

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.talk import Talk
from axisrig.bench.campaign.verdict_table import counts_line, show_unjudged, show_verdicts
from axisrig.bench.cli.beside.waiting import Waiting
from axisrig.bench.cli.main import app
from axisrig.bench.cli.start import plain_signs
from axisrig.bench.machine import fmu_files
from axisrig.bench.plan.checks import CheckResult, parse_check
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.tools.fmu import library
from axisrig.bench.tools.listings import doctor
from axisrig.fmus.watching import building, heard
from axisrig.kernel.errors import UserError

Call = Callable[..., tuple[int, str, str]]

CPU_MAX_S = 0.5
# Ends the process with the first thing that it prints, and says how much CPU time that took
_FIRST = """
import os, sys, time
class First:
    encoding = "utf-8"
    def write(self, text):
        os.write(1, f"{time.process_time()} {text}".encode())
        os._exit(0)
    def flush(self): pass
    def isatty(self): return False
sys.stdout = sys.stderr = First()
from axisrig.bench.cli.main import main
main()
"""
COMMANDS = {
    "run": ("run", "p.csv"),
    "check": ("check", "p.csv"),
    "judge": ("judge", "out", "--plan", "p.csv"),
    "demo": ("demo",),
    "replay": ("replay", "out", "p-a"),
    "report": ("report", "out"),
    "merge": ("merge", "a", "b", "-o", "c"),
    "diff": ("diff", "a", "b"),
    "trend": ("trend", "a", "b", "--metric", "latch_error_um"),
    "budget": ("budget", "p.csv", "-k", "a"),
    "tune": ("tune", "distance", "--rig", "r.toml"),
    "scenarios": ("scenarios", "--count", "1"),
    "doctor": ("doctor",),
    "fmu build": ("fmu", "build"),
    "fmu check": ("fmu", "check", "m.fmu"),
    "fmu show": ("fmu", "show", "m.fmu"),
    "nc": ("nc", "p.nc", "--rig", "r.toml"),
    "nc --check": ("nc", "--check", "p.nc"),
    "plan expand": ("plan", "expand", "p.csv"),
    "rig from": ("rig", "from", "z.lst", "-o", "r.toml"),
    "rig export": ("rig", "export", "r.toml"),
    "drive": ("drive", "r.toml"),
    "bus": ("bus", "can.log"),
    "export": ("export", "out", "--csv"),
    "query": ("query", "out", "select 1"),
    "sources": ("sources", "out"),
    "perf": ("perf",),
    "distance readings": ("distance", "readings", "r.toml"),
    "params of a rig": ("params", "--rig", "r.toml"),
}


@pytest.mark.long(but=1)
@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_a_command_that_takes_long_shows_at_once_what_it_does(
    tmp_path: Path, words: tuple[str, ...]
) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _FIRST, *words],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    spent_s, _, text = done.stdout.partition(" ")
    assert not text.startswith("error"), text
    assert text.strip()
    assert float(spent_s) < CPU_MAX_S, text


def test_in_a_pipe_a_line_comes_at_the_begin_and_every_thirty_seconds(
    capsys: pytest.CaptureFixture[str],
) -> None:
    now_s = 0.0
    line = Waiting("checking 3 runs", lambda: now_s, is_terminal=False)
    with heard(line.inside):
        for second in range(1, 71):
            now_s = float(second)
            if second == 40:
                with building("AxisRig.Drives.ServoAxis"):
                    for _ in range(22):
                        now_s += 1.0
                        line.tick()
                line.say("writing the report")
            line.tick()
    line.end()
    now_s += 100.0
    line.tick()
    assert capsys.readouterr().err.splitlines() == [
        "checking 3 runs",
        "checking 3 runs, 30 s",
        "building AxisRig.Drives.ServoAxis, 60 s",
    ]


def test_all_who_listen_hear_a_build_and_its_end_also_of_one_that_fails() -> None:
    first, second = list[str](), list[str]()
    with heard(first.append):
        with heard(second.append), building("A"):
            pass
        with pytest.raises(ValueError, match="odd"), building("B"):
            _ = int("odd")
    assert (first, second) == (["building A", "", "building B", ""], ["building A", ""])
    with building("C"):
        pass
    assert len(first) == 4  # its block has ended


def test_a_line_that_gave_way_to_others_begins_anew(capsys: pytest.CaptureFixture[str]) -> None:
    """Silent while the lines of a campaign are there; then its own seconds and its own 30 s."""
    now_s = 0.0
    line = Waiting("running", lambda: now_s, is_terminal=False)
    given: list[str] = []

    @contextmanager
    def others(progress: str) -> Iterator[None]:
        given.append(progress)
        yield

    with line.beside(others, "campaign"):
        now_s = 100.0
        line.tick()
    line.say("writing the report")
    for second in (101, 129, 130, 131):
        now_s = float(second)
        line.tick()
    assert given == ["campaign"]
    assert capsys.readouterr().err.splitlines() == ["running", "writing the report, 30 s"]


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("✔ pass, ✖ fail", "+ pass, x fail"),
        ("? inconclusive", "? inconclusive"),
        ("■ aborted ≤ 2 µm", "# aborted <= 2 um"),
        ("Fühler", "F_hler"),
        ("≤≥ ±5 µm ✔✖ äß", "<=>= +-5 um +x __"),
    ],
)
def test_signs_that_a_console_lacks_have_a_form_of_their_own(text: str, plain: str) -> None:
    assert text.encode("ascii", errors=plain_signs()).decode() == plain
    assert text.encode("utf-8", errors=plain_signs()).decode() == text
    signs = [verdict.glyph.encode("ascii", errors=plain_signs()) for verdict in Verdict]
    assert len(set(signs)) == len(Verdict)


def _results(tmp_path: Path, count: int, name: str = "feeds") -> list[CaseResult]:
    """Results of a sweep of which those from 1000 on are beyond the limit, ever further."""
    (tmp_path / "a.nc").write_text("M30\n", encoding="utf-8")
    (tmp_path / "r.toml").write_text("", encoding="utf-8")
    text = f"case,program,rig,plc:V.E.FEED\n{name},a.nc,r.toml,100 .. {count}00 step 100\n"
    (tmp_path / "p.csv").write_text(text, encoding="utf-8")
    check = parse_check("latch_error_um", "-2 .. 2", "")
    results = []
    for number, case in enumerate(read_plan(tmp_path / "p.csv").cases, start=1):
        value = -1.0 if number < 10 else -2.0 - number / 100
        verdict = Verdict.PASS if number < 10 else Verdict.FAIL
        results.append(CaseResult(case, verdict, [CheckResult(check, value, 0.0, verdict, "")]))
    return results


def test_of_many_runs_those_that_fail_alike_are_one_row_with_the_worst(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    show_verdicts(_results(tmp_path, 30))
    out = capsys.readouterr().out
    assert "p-feeds-3000 (+ 20)" in out
    words = "latch_error_um is 0.3 um below its lower limit -2.0 um"
    assert words in " ".join(out.split())
    assert "p-feeds-2900" not in out
    assert "9 more passed; -v shows each one" in map(str.strip, out.splitlines())
    causes = [line for line in out.splitlines() if line.startswith("p-feeds")]
    assert causes == [f"p-feeds-3000 and 20 more runs of its case: fail: {words}"]
    assert len(out.splitlines()) < 12


def test_of_few_runs_and_with_v_each_one_is_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    results = _results(tmp_path, 30)
    for shown, talk in ((results[:12], Talk.SHORT), (results, Talk.ALL)):
        show_verdicts(shown, talk)
        out = capsys.readouterr().out
        assert all(f"{result.case.run} " in out for result in shown)
        assert "more" not in out


@pytest.mark.parametrize(("count", "options", "is_each"),
                         [(30, (), False), (30, ("-v",), True), (30, ("--verbose",), True),
                          (20, (), True), (20, ("-v",), True), (21, (), False)])  # fmt: skip
def test_a_judged_folder_shows_each_of_few_runs_and_with_v_each_of_many(
    count: int, options: tuple[str, ...], is_each: bool, tmp_path: Path, axisrig: Call,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Twenty are few. Without -v nine of many passed, and one row stands for all others."""
    results = _results(tmp_path, count)
    done = SimpleNamespace(results=results, left=(), report=Path("r.html"), exit_code=1)
    monkeypatch.setattr("axisrig.bench.campaign.rejudge.rejudge", lambda *_, **__: done)
    code, out, err = axisrig("judge", "out", "--plan", "p.csv", *options)
    rows = [run for result in results if f" {(run := result.case.run)} " in out]
    assert len(rows) == (count if is_each else 1)
    assert ("9 more passed; -v shows each one" in out) is not is_each
    assert out.splitlines()[-1] == "r.html"
    assert err.partition(" in ")[0].endswith(f"9 pass, {count - 9} fail")
    assert code == 1


def test_ids_of_runs_never_break(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    results = _results(tmp_path, 12, name="a_rather_long_name_of_a_case_that_says_what_it_is_about")
    show_verdicts(results)
    out = capsys.readouterr().out
    for result in results:
        assert f" {result.case.run} " in out


def test_counts_and_duration_in_one_line() -> None:
    verdicts = [Verdict.FAIL, *[Verdict.PASS] * 451, *[Verdict.FAIL] * 153]
    assert counts_line(verdicts, 653.2) == "451 pass, 154 fail in 10 min 53 s"
    assert counts_line([]) == "nothing ran"


def test_recordings_without_a_row_are_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    show_unjudged([])
    assert capsys.readouterr().err == ""
    show_unjudged([f"p-{number}" for number in range(617)])
    assert capsys.readouterr().err == "no row of the plan judges p-0, p-1, p-2 and 614 more\n"


def test_check_names_each_case_of_many_runs_once(place: Path, axisrig: Call) -> None:
    row = "a,part.nc,rig.toml,100 .. 1500 step 100,== 1,"
    head = f"{HEADER},plant:z.kv,repeats"
    rows = [f"{row},[30 | 40],", "b,part.nc,rig.toml,100,== 1,,,3", "c,part.nc,rig.toml,1,== 1,,,"]
    (place / "many.csv").write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    code, out, err = axisrig("check", "many.csv")
    assert (code, err) == (0, "")
    assert out.splitlines()[:4] == [
        "many.csv: 34 runs", "  a: 15 x 2 runs", "  b: 3 runs", "  many-c",
    ]  # fmt: skip
    code, out, _ = axisrig("check", "many.csv", "-v")
    assert out.count("many-a-") == 30


@pytest.mark.long
def test_doctor_builds_nothing_unless_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    built: list[str] = []

    def ensure_built(model: str) -> Path:
        built.append(model)
        return Path(f"{model}.fmu")

    monkeypatch.setattr(doctor, "ensure_built", ensure_built)
    monkeypatch.setattr(doctor, "is_ours", lambda path: "Probe" in str(path))
    lines = list(doctor.examine())
    assert built == []
    assert any("TouchProbe: " in line and line.startswith("ok ") for line in lines)
    assert any("not built; that is done where a run needs it" in line for line in lines)
    assert any("axisrig doctor --build builds them now" in line for line in lines)
    lines = list(doctor.examine(is_building=True))
    assert built == list(doctor.MODELS)
    assert not any("not built" in line for line in lines)


def test_fmu_build_takes_the_file_of_a_model(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = tmp_path / "MyAxis.mo"
    model.write_text("model MyAxis end MyAxis;", encoding="utf-8")
    monkeypatch.setattr(fmu_files, "own_fmu", lambda path: path.with_suffix(".fmu"))
    (built,) = library.build_models(str(model))
    assert built == ("MyAxis", "3.0", tmp_path / "MyAxis.fmu")
    with pytest.raises(UserError, match=r"FMI 3\.0 for this platform"):
        list(library.build_models(str(model), ["2.0"]))
    with pytest.raises(UserError, match=r"no such model; near it: MyAxis\.mo"):
        list(library.build_models(str(tmp_path / "MyAxes.mo")))


@pytest.mark.long
def test_a_run_ends_at_its_first_failure_where_asked(place: Path, axisrig: Call) -> None:
    rows = [f"r{n},part.nc,rig.toml,3000,== {0 if n == 1 else 1}," for n in range(4)]
    (place / "four.csv").write_text("\n".join([HEADER, *rows, ""]), encoding="utf-8")
    code, out, err = axisrig("run", "four.csv", "-o", "out", "-j", "1", "-x")
    assert code == 1
    assert out.splitlines()[-1] == "out/report.html"
    assert "interrupted" not in err
    assert err.splitlines()[-1].startswith("1 pass, 1 fail in ")
    code, out, err = axisrig("run", "four.csv", "-o", "out", "-q", "-k", "r0 or r1")
    assert (code, out) == (1, "out/report.html\n")
    assert err.splitlines()[-1].startswith("1 pass, 1 fail in ")
    assert "four-r1" not in err


@pytest.mark.long
def test_an_expression_chooses_cases_for_check_expand_and_judge(place: Path, axisrig: Call) -> None:
    rows = [f"r{n},part.nc,rig.toml,3000,== 1," for n in range(3)]
    (place / "plans").mkdir()
    rows = [row.replace("part.nc,rig.toml", "../part.nc,../rig.toml") for row in rows]
    table = "\n".join([HEADER, *rows, ""])
    (place / "plans" / "three.csv").write_text(table, encoding="utf-8")
    code, out, _ = axisrig("check", "plans", "-k", "r1 or r2")
    assert (code, out.splitlines()[0]) == (0, "plans/three.csv: 2 runs")
    code, out, _ = axisrig("plan", "expand", "plans/three.csv", "-k", "r2")
    assert (code, len(out.splitlines())) == (0, 2)
    assert axisrig("run", "plans", "-o", "out", "-q")[0] == 0
    code, out, err = axisrig("judge", "out", "--plan", "plans/three.csv", "-k", "r0")
    assert code == 0
    assert err.splitlines()[-1].startswith("1 pass in ")
    for words in (("check", "plans"), ("plan", "expand", "plans/three.csv")):
        code, _, err = axisrig(*words, "-k", "nothing")
        assert code == 2
        assert "no case fits" in err


@pytest.mark.parametrize("words", [("run",), ("fmu", "build"), ("judge",), ("scenarios",)])
def test_help_has_no_types_of_python(axisrig: Call, words: tuple[str, ...]) -> None:
    code, out, _ = axisrig(*words, "--help")
    assert code == 0
    assert not re.search(r"<(?!n>-<plan>)(?!plan>)|list\[|int range|float", out), out
    assert "--out PATH" in out or words in [("judge",), ("scenarios",)]


def test_each_option_has_one_name() -> None:
    """What writes somewhere is `-o`, `--out` in every command."""
    found: dict[str, set[tuple[str, ...]]] = {}

    def walk(command: Any) -> None:
        for option in command.params:
            for name in option.opts:
                found.setdefault(name, set()).add(tuple(sorted(option.opts)))
        for inside in getattr(command, "commands", {}).values():
            walk(inside)

    walk(typer.main.get_command(app))
    assert found["--out"] == {("--out", "-o")}
    assert "--output" not in found
    assert found["-k"] == {("-k",)}
    assert found["--jobs"] == {("--jobs", "-j")}


class Bar:
    """Stands for a bar of rich; what was done to it, by each."""

    made: ClassVar[list["Bar"]] = []

    def __init__(self, *columns: object, **options: object) -> None:
        self.options, self.news, self.task_ids = options, [], [3]
        Bar.made.append(self)

    def add_task(self, words: str) -> None:
        self.news.append(f"task {words}")

    def start(self) -> None:
        self.news.append("start")

    def update(self, task: int, *, description: str, refresh: bool) -> None:
        assert (task, refresh) == (3, True)
        self.news.append(description)

    def stop(self) -> None:
        self.news.append("stop")


def test_on_a_terminal_a_line_moves_and_gives_way(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One bar until its end, another one after what came beside, whose time begins anew."""
    monkeypatch.setattr("rich.progress.Progress", Bar)
    Bar.made.clear()
    now_s = [100.0]
    line = Waiting("reading", lambda: now_s[0], is_terminal=True)
    line.tick()
    now_s[0] += 2.4
    line.inside("building an FMU")
    line.tick()
    line.inside("")
    line.say("running")
    line.tick()

    @contextmanager
    def campaign(progress: str) -> Iterator[None]:
        Bar.made[0].news.append(f"+{progress}")
        line.tick()  # another line is at the bottom now
        yield
        Bar.made[0].news.append(f"-{progress}")

    with line.beside(campaign, "campaign"):
        now_s[0] += 60.0
    now_s[0] += 1.0
    line.tick()
    line.end()
    line.tick()
    assert [bar.news for bar in Bar.made] == [
        ["task reading, 0 s", "start", "reading, 0 s", "building an FMU, 2 s", "running, 2 s",
         "stop", "+campaign", "-campaign"],
        ["task running, 1 s", "start", "running, 1 s", "stop"],
    ]  # fmt: skip
    for bar in Bar.made:
        assert (bar.options["transient"], bar.options["auto_refresh"]) == (True, False)
    assert capsys.readouterr().err == ""
