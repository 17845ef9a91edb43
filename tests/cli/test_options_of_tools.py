"""Commands beside plans: each option gets where it belongs, and how the command ends."""

from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.resuming import GoingOn
from axisrig.bench.campaign.talk import Talk
from axisrig.bench.cli import scenario_command
from axisrig.bench.cli.main import main
from axisrig.bench.tools.probe_feed import Question
from axisrig.kernel.errors import UserError

CAMPAIGN, TOOLS, RESULTS = "axisrig.bench.campaign", "axisrig.bench.tools", "axisrig.results"


def call(*words: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(words)
    return int(ended.value.code or 0)


Spy = Callable[..., dict[str, Any]]


@pytest.fixture
def spy(monkeypatch: pytest.MonkeyPatch) -> Spy:
    """Return `spy(function, answer)`: it takes the place of it and keeps what it was given."""

    def put(function: str, answer: Any = None) -> dict[str, Any]:
        given: dict[str, Any] = {}

        def kept(*words: Any, **named: Any) -> Any:
            given.update(named, words=words)
            return answer

        monkeypatch.setattr(function, kept)
        return given

    return put


@pytest.mark.parametrize(
    ("options", "going_on", "talk", "ends", "info"),
    [
        ("", GoingOn.NO, Talk.SHORT, False, ()),
        ("--resume -q", GoingOn.MISSING, Talk.NONE, False, ()),
        ("--failed -v -x", GoingOn.FAILED, Talk.ALL, True, ()),
        ("--info a=1 --info b=2", GoingOn.NO, Talk.SHORT, False, ("a=1", "b=2")),
    ],
)
def test_a_run_goes_on_and_is_shown_as_it_was_asked_for(
    options: str, going_on: GoingOn, talk: Talk, ends: bool, info: Sequence[str], spy: Spy
) -> None:
    given = spy(f"{CAMPAIGN}.campaign.run_campaign", SimpleNamespace(exit_code=1))
    shown = spy(f"{CAMPAIGN}.campaign.show_campaign")
    assert call("run", "a.csv", *options.split()) == 1
    manner = given["manner"]
    assert (given["going_on"], manner.talk, manner.ends_at_first) == (going_on, talk, ends)
    assert (tuple(manner.info), shown["words"][1]) == (tuple(info), talk)


def test_a_cluster_runs_with_its_scheduler(spy: Spy) -> None:
    given = spy(f"{CAMPAIGN}.campaign.run_campaign", SimpleNamespace(exit_code=0))
    spy(f"{CAMPAIGN}.campaign.show_campaign")
    assert call("run", "a.csv", "--engine", "dask", "--scheduler", "tcp://h:1") == 0
    assert given["select"].scheduler == "tcp://h:1"
    assert call("run", "a.csv", "--scheduler", "tcp://h:1") == 2


@pytest.mark.parametrize(("options", "is_full"), [((), False), (("--full",), True)])
def test_a_report_is_written_and_printed_where_asked(
    options: tuple[str, ...], is_full: bool, spy: Spy, capsys: pytest.CaptureFixture[str]
) -> None:
    recovered = spy(f"{CAMPAIGN}.results.folder.recover")
    built = spy("axisrig.reports.build.build_report", Path("r.html"))
    printed = spy("axisrig.reports.pdf.print_pdf", Path("r.pdf"))
    assert call("report", "out", *options) == 0
    assert (recovered["words"], built["words"]) == ((Path("out"),), (Path("out"),))
    assert (built["is_full"], printed) == (is_full, {})
    assert capsys.readouterr().out == "r.html\n"
    assert call("report", "out", "--pdf") == 0
    assert printed["words"] == (Path("r.html"),)
    assert capsys.readouterr().out == "r.html\nr.pdf\n"


@pytest.mark.parametrize(
    ("options", "given"),
    [
        (("--mf4",), ("results", [], Path("out/export"), "mf4")),
        (("--csv", "p-a", "p-b", "-o", "to"), ("results", ["p-a", "p-b"], Path("to"), "csv")),
    ],
)
def test_series_are_exported_in_one_form(
    options: tuple[str, ...], given: tuple[Any, ...], spy: Spy, capsys: pytest.CaptureFixture[str]
) -> None:
    spy(f"{RESULTS}.loading.load", "results")
    found = spy(f"{RESULTS}.export.export", [Path("one"), Path("two")])
    text = spy(f"{RESULTS}.export.export_diagnosis", [Path("three")])
    assert call("export", "out", *options) == 0
    assert (found["words"], text) == (given, {})
    assert capsys.readouterr().out == "one\ntwo\n"
    assert call("export", "out", "--diagnosis", "p-a") == 0
    assert text["words"] == ("results", ["p-a"], Path("out/export"))
    for none_or_several in ((), ("--mf4", "--csv"), ("--csv", "--diagnosis")):
        assert call("export", "out", *none_or_several) == 2


@pytest.mark.parametrize(("is_worse", "code"), [(False, 0), (True, 1)])
def test_a_comparison_ends_with_1_where_something_got_worse(
    is_worse: bool, code: int, spy: Spy, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    def read(folder: Path) -> Any:
        runs = [SimpleNamespace(altered=folder.name == "b", run="p-a", altered_words="altered")]
        return SimpleNamespace(folder=folder, runs=runs)

    pairs = SimpleNamespace(pairs="pairs", worse=lambda: is_worse)
    compared = spy(f"{RESULTS}.compare.pairs.compare", pairs)
    changed = spy(f"{RESULTS}.compare.changes.changes", "changed")
    words = spy(f"{RESULTS}.compare.words.diff_lines", ["one", "two"])
    page = spy(f"{RESULTS}.compare.page.write_diff")
    # The last one: what is imported for the others has its own
    monkeypatch.setattr(f"{CAMPAIGN}.results.stored.read_results", read)
    assert call("diff", "a", "b") == code
    assert [one.folder for one in compared["words"]] == [Path("a"), Path("b")]
    assert [*changed["words"]] == [*compared["words"], "pairs"]
    assert (words["words"], page) == ((pairs, "changed"), {})
    written = capsys.readouterr()
    assert (written.out, written.err) == ("one\ntwo\n", "b: p-a: altered\n")
    assert call("diff", "a", "b", "-o", "page.html") == code
    assert page["words"][0] == Path("page.html")
    assert page["words"][3] == "changed"
    assert capsys.readouterr().out == "one\ntwo\npage.html\n"


def test_a_trend_follows_a_metric_of_a_case_in_the_order_of_the_folders(
    spy: Spy, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    followed = spy(f"{RESULTS}.compare.trend.trend", "found")
    spy(f"{RESULTS}.compare.words.trend_lines", ["line"])
    page = spy(f"{RESULTS}.compare.page.write_trend", Path("t.html"))
    monkeypatch.setattr(f"{CAMPAIGN}.results.stored.read_results", lambda folder: folder.name)
    assert call("trend", "c", "a", "b", "--metric", "m:Z", "--case", "p-x") == 0
    assert followed["words"] == (["c", "a", "b"], "m:Z", "p-x")
    assert (capsys.readouterr().out, page) == ("line\n", {})
    assert call("trend", "a", "--metric", "m", "-o", "t.html") == 0
    assert (followed["words"], page["words"]) == (
        (["a"], "m", None), (Path("t.html"), "found"),
    )  # fmt: skip


def test_a_bus_log_is_shown_as_far_as_it_was_asked_for(spy: Spy) -> None:
    spy(f"{TOOLS}.bus_log.bus_log.find_log", ([Path("log")], "settings"))
    shown = spy(f"{TOOLS}.bus_log.bus_log.tell_log", ["one"])
    assert call("bus", "out", "p-a") == 0
    paths, settings, plain, _ = shown["words"]
    assert (paths, settings) == ([Path("log")], "settings")
    limits = plain.only, plain.from_ms, plain.to_ms, plain.is_all, dict(plain.segments)
    assert limits == ((), float("-inf"), float("inf"), False, {})
    options = "--only SDO,Z --only 6041, --from 5 --to 7.5 --all --segment 1=can2"
    assert call("bus", "log.blf", *options.split()) == 0
    chosen = shown["words"][2]
    assert chosen.only == ("SDO", "Z", "6041")
    assert (chosen.from_ms, chosen.to_ms, chosen.is_all) == (5.0, 7.5, True)
    assert dict(chosen.segments) == {"1": "can2"}


def test_numbers_of_a_probe_are_those_of_their_options(spy: Spy) -> None:
    asked = spy(f"{TOOLS}.probe_feed.probe_feed_text", "text")
    needed = "--stroke 4 --decel 2.5 --kv 1.5 --cycle 8"
    assert call("probe-feed", *needed.split()) == 0
    assert asked["words"] == (Question(4.0, 8.0, 2.5, 1.5), None)
    more = "--delay 1 --ramp 20 --feed-forward 0.5 --feed 600"
    assert call("probe-feed", *needed.split(), *more.split()) == 0
    assert asked["words"] == (Question(4.0, 8.0, 2.5, 1.5, 1.0, 20.0, 0.5), 600.0)


def test_a_budget_runs_its_case_and_goes_to_each_output(
    spy: Spy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A folder gets it and its report anew, a file is a page."""
    given: list[Any] = []

    def with_inputs(*words: Any) -> Any:
        given.extend(words)
        return SimpleNamespace(cases="cases")

    plan = SimpleNamespace(with_inputs=with_inputs)
    monkeypatch.setattr("axisrig.bench.plan.plan.read_plan", lambda path: plan)
    only = spy("axisrig.bench.plan.select.only", "the case")
    made = spy(f"{TOOLS}.budget.budget.make_budget", "found")
    spy(f"{TOOLS}.budget.words.budget_lines", ["line"])
    page = spy(f"{RESULTS}.budget.page.write_budget", Path("b.html"))
    added = spy(f"{RESULTS}.budget.page.add_budget", Path("added"))
    report = spy("axisrig.reports.build.build_report", Path("r.html"))
    options = f"-k row --axis Z --set plant:z.kv=4 --combinations 9 -j 3 -o b.html -o {tmp_path}"
    assert call("budget", "p.csv", *options.split()) == 0
    assert (given[0][0].column, given[1]) == ("plant:z.kv", "row")
    assert only["words"] == ("cases", "row")
    case, axis, run, combinations = made["words"]
    assert (case, axis, combinations, run.keywords["jobs"]) == ("the case", "Z", 9, 3)
    assert page["words"] == (Path("b.html"), "found")
    assert (added["words"], report["words"]) == ((tmp_path, "found"), (tmp_path,))
    assert capsys.readouterr().out == "line\nb.html\nadded\nr.html\n"


# --- scenarios


@pytest.mark.parametrize(
    ("text", "seconds"), [("90s", 90.0), ("1.5m", 90.0), ("2h", 7200.0), ("0s", 0.0)]
)
def test_a_time_has_its_unit(text: str, seconds: float) -> None:
    assert scenario_command._seconds(text) == seconds


@pytest.mark.parametrize("text", ["90", "m", "-5s", "5d", "5 s"])
def test_what_is_no_time_is_refused(text: str) -> None:
    with pytest.raises(UserError, match="no such time"):
        scenario_command._seconds(text)


Asked = list[tuple[str, int, int]]


@pytest.fixture
def chunks(monkeypatch: pytest.MonkeyPatch) -> Asked:
    """What `run_scenarios` was asked for: machine, first, count."""
    asked: Asked = []

    def run(seed: int, first: int, count: int, jobs: int, machine: str) -> Any:
        assert (seed, jobs) == (7, 2)
        asked.append((machine, first, count))
        return iter([f"{machine}{first}"])

    monkeypatch.setattr(f"{TOOLS}.scenarios.campaign.run_scenarios", run)
    monkeypatch.setattr(scenario_command, "TURN", 10)
    return asked


def rows_named(*names: str) -> Any:
    return [SimpleNamespace(name=name) for name in names]


def test_so_many_scenarios_of_each_machine(chunks: Asked) -> None:
    found: Any = scenario_command._run(rows_named("a", "b"), {"a": 5, "b": 0}, 7, 2, 30, None)
    assert [*found] == ["a5", "b0"]
    assert chunks == [("a", 5, 30), ("b", 0, 30)]


def test_machines_take_turns_until_the_time_is_over(chunks: Asked) -> None:
    """Each turn has work for both processes and goes on behind the last one."""
    over = iter([False] * 3 + [True])
    begins = {"a": 5, "b": 0}
    found: Any = scenario_command._run(rows_named("a", "b"), begins, 7, 2, 30, lambda: next(over))
    assert [*found] == ["a5", "b0", "a25"]
    assert chunks == [("a", 5, 20), ("b", 0, 20), ("a", 25, 20)]


@pytest.mark.parametrize(
    "words", [("--for", "5s", "--count", "3"), ("--log", "x.csv", "--first", "4")]
)
def test_options_of_scenarios_that_exclude_each_other_are_refused(words: tuple[str, ...]) -> None:
    assert call("scenarios", *words) == 2
