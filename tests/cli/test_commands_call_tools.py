"""Commands that hand their words on to a tool: which ones, and what is printed where."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer

from axisrig.bench.cli import (
    data_commands,
    distance_commands,
    list_commands,
    params_command,
    rig_commands,
)
from axisrig.bench.cli.params_command import params
from axisrig.kernel.errors import UserError

TOOLS = "axisrig.bench.tools"
DOCUMENTS = f"{TOOLS}.listings.documents"


@pytest.fixture
def pages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Pages that say their name; what was opened."""
    opened: list[str] = []

    def page(name: str) -> Path:
        path = tmp_path / f"{name}.md"
        path.write_text(f"# {name}\n", encoding="utf-8")
        return path

    monkeypatch.setattr(f"{DOCUMENTS}.page", page)
    monkeypatch.setattr(f"{DOCUMENTS}.listing", lambda: "the list")
    monkeypatch.setattr(f"{DOCUMENTS}.copy_notebook", lambda into: into / "results.ipynb")
    monkeypatch.setattr(typer, "launch", opened.append)
    return opened


def test_documents_are_listed_printed_or_opened(
    pages: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without a name the list, with --open the index; into a pipe a page goes as it is."""
    index, plans = (str(tmp_path / f"{name}.md") for name in ("index", "plans"))
    for words, out, opened in (
        ({}, "the list\n", []), ({"name": "plans"}, "# plans\n", []),
        ({"is_opened": True}, f"{index}\n", [index]),
        ({"name": "plans", "is_opened": True}, f"{plans}\n", [plans]),
        ({"notebook": Path("here")}, f"{Path('here/results.ipynb')}\n", []),
        ({"notebook": Path("here"), "name": "plans"}, f"{Path('here/results.ipynb')}\n", []),
    ):  # fmt: skip
        pages.clear()
        given: Any = {"name": None, "is_opened": False, "notebook": None} | words
        list_commands.docs(**given)
        assert (capsys.readouterr().out, pages) == (out, opened), words


def test_a_rig_from_lists_says_what_was_assumed_beside_its_name(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[Any] = []

    def rig_from(*words: Any) -> list[str]:
        asked.append(words)
        return ["a bus", "a probe"]

    monkeypatch.setattr(f"{TOOLS}.project.rig_from.rig_from", rig_from)
    words = [Path("z.lst"), Path("c.lst")], Path("drive.eds"), Path("own/rig.toml")
    rig_commands.from_lists(words[0], output=words[2], eds=words[1])
    out, err = capsys.readouterr()
    assert (out, asked) == (f"{words[2]}\n", [words])
    assert err == "assumed: a bus\nassumed: a probe\n"


def test_a_rig_is_exported_here_unless_a_file_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[Any] = []

    def export_rig(*words: Any) -> list[str]:
        asked.append(words)
        return ["no bus in it"]

    monkeypatch.setattr(f"{TOOLS}.rig_export.package.export_rig", export_rig)
    monkeypatch.setattr("axisrig.bench.rig.contents.settings_of", lambda *words: words)
    rig = Path("rigs/own.toml")
    rig_commands.export(rig, None, "3.0", ["plant:z.kv=40"])
    rig_commands.export(rig, Path("there.ssp"), "2.0", None)
    assert asked == [
        ((rig, ["plant:z.kv=40"]), Path("own.ssp"), "3.0"), ((rig, []), Path("there.ssp"), "2.0"),
    ]  # fmt: skip
    out, err = capsys.readouterr()
    assert (out, err) == ("own.ssp\nthere.ssp\n", "no bus in it\n" * 2)


def test_readings_are_of_a_rig_with_its_changes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("axisrig.bench.rig.contents.settings_of", lambda *words: words)
    monkeypatch.setattr(f"{TOOLS}.distance.readings.readings_text", str)
    for changes in (["set:Z.kenngr.distc.kp=1"], None):
        distance_commands.readings(Path("z.toml"), changes)
        assert capsys.readouterr().out == f"{(Path('z.toml'), changes or [])}\n"


def test_sources_are_of_the_results_of_a_folder(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # The last one: what is imported for the others has its own
    monkeypatch.setattr("axisrig.results.sources.sources_table", lambda found: f"| {found} |\n")
    monkeypatch.setattr("axisrig.bench.campaign.results.stored.read_results", lambda at: [at])
    data_commands.sources(Path("out"))
    assert capsys.readouterr().out == f"| {[Path('out')]} |\n"


def test_a_plan_is_expanded_with_its_changes_after_its_inputs_were_checked(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    steps: list[Any] = []

    def with_inputs(changes: Any, select: Any) -> str:
        steps.append(([change.column for change in changes], select))
        return "changed"

    plan = SimpleNamespace(with_inputs=with_inputs)
    # The first one: it is imported with what reads plans as it is
    monkeypatch.setattr("axisrig.bench.campaign.checking.check_inputs", steps.append)
    monkeypatch.setattr("axisrig.bench.plan.plan.read_plan", lambda _: plan)
    monkeypatch.setattr("axisrig.bench.plan.plan.selected", lambda of, by: f"{by} of {of}")
    monkeypatch.setattr("axisrig.bench.plan.expanded.expanded_text", lambda of: f"<{of}>")
    list_commands.expand(Path("p.csv"), "a and b", ["plc:V.E.A=1"])
    assert capsys.readouterr().out == "<a and b of changed>"
    assert steps == [(["plc:V.E.A"], "a and b"), "a and b of changed"]


@pytest.fixture
def answers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Each answer of `params` says its words; a file `z.lst`."""
    room = f"{TOOLS}.params"
    for place in ("effective.effective_text", "effective.written_lists", "listing.parameters_text"):
        name = place.partition(".")[2]
        monkeypatch.setattr(f"{room}.{place}", lambda *w, name=name: f"{name} {w}")
    monkeypatch.setattr(f"{room}.effective.difference_text", lambda a, b: (f"{a} {b}", a != b))
    monkeypatch.setattr(f"{room}.known.known_text", lambda path: (f"{path.name}\nline\n", 3))
    monkeypatch.setattr("axisrig.bench.rig.contents.contents_text", lambda path: f"of {path.name}")
    (tmp_path / "z.lst").write_text("", encoding="utf-8")
    return tmp_path / "z.lst"


def asked(capsys: pytest.CaptureFixture[str], *words: str, **more: Any) -> tuple[int, str]:
    given: Any = {"rig": None, "axis": None, "form": "text", "assignments": None} | more
    with pytest.raises(typer.Exit) as ended:
        params(list(words), **given)
    return ended.value.exit_code, capsys.readouterr().out.removesuffix("\n")


def test_params_answers_by_its_words(
    answers: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    rig, sets = Path("z.toml"), ["set:Z.a=1"]
    for found, expected in (
        (asked(capsys, "kp", "max"), (0, f"parameters_text {(['kp', 'max'], 'text')}")),
        (asked(capsys, form="csv"), (0, f"parameters_text {([], 'csv')}")),
        (asked(capsys, str(answers)), (0, "of z.lst")),
        (asked(capsys, "kp", rig=rig, axis="Z", assignments=sets),
         (0, f"effective_text {(rig, 'Z', ['kp'], sets)}")),
        (asked(capsys, "write", "z.toml", axis="Z", assignments=sets),
         (0, f"written_lists {(rig, 'Z', sets)}")),
        (asked(capsys, "diff", "a.lst", "b.lst"), (1, "a.lst b.lst")),
        (asked(capsys, "diff", "a.lst", "a.lst"), (0, "a.lst a.lst")),
        (asked(capsys, "known", str(answers)), (0, "z.lst\nline")),
    ):  # fmt: skip
        assert found == expected
    for count, words in (
        (0, "0 lines are comments now: they act"), (1, "1 line is a comment now: it acts"),
        (3, "3 lines are comments now: they act"),
    ):  # fmt: skip
        monkeypatch.setattr(f"{TOOLS}.params.known.known_text", lambda _, n=count: ("line\n", n))
        params_command._known([str(answers)])
        assert capsys.readouterr().err == f"{words} on nothing here\n"


@pytest.mark.parametrize(
    ("words", "more", "message"),
    [
        (["diff", "a"], {}, "takes two lists"), (["diff", "a", "b", "c"], {}, "takes two lists"),
        (["diff", "a", "b"], {"axis": "Z"}, "takes two lists"),
        (["diff", "a", "b"], {"rig": Path("c")}, "takes two lists"),
        (["diff", "a", "b"], {"assignments": ["set:Z.a=1"]}, "takes two lists"),
        (["diff"], {}, "takes two lists"), (["write", "a", "b"], {}, "takes one rig"),
        (["known"], {}, "takes one list"), (["known", "a", "b"], {}, "takes one list"),
        (["write"], {}, "takes one rig"), (["write", "a"], {"rig": Path("b")}, "takes one rig"),
        (["kp"], {"axis": "Z"}, "belong to --rig"),
        (["kp"], {"assignments": ["set:Z.a=1"]}, "belong to --rig"),
    ],
)  # fmt: skip
def test_params_refuses_words_that_do_not_go_together(
    words: list[str], more: dict[str, Any], message: str, answers: Path
) -> None:
    given = {"rig": None, "axis": None, "assignments": []} | more
    with pytest.raises(UserError, match=message):
        params_command._answer(words, given["rig"], given["axis"], "text", given["assignments"])


def test_series_are_exported_in_the_one_form_that_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Beside the results unless a folder is named; the diagnosis data are a text of their own."""
    results = "axisrig.results"
    monkeypatch.setattr(f"{results}.loading.load", lambda folder: f"of {folder}")
    monkeypatch.setattr(f"{results}.export.export", lambda *words: [words])
    monkeypatch.setattr(f"{results}.export.export_diagnosis", lambda *words: [words])
    out, own = Path("out"), Path("own")
    for words, expected in (
        ({"mf4": True}, ("of out", [], out / "export", "mf4")),
        ({"csv": True, "runs": ["a"], "into": own}, ("of out", ["a"], own, "csv")),
        ({"diagnosis": True, "runs": ["a"]}, ("of out", ["a"], out / "export")),
    ):  # fmt: skip
        given: Any = {"runs": None, "into": None, "mf4": False, "csv": False, "diagnosis": False}
        data_commands.export(out, **(given | words))
        assert capsys.readouterr().out == f"{expected}\n"
    for names in ((), ("mf4", "csv"), ("csv", "diagnosis"), ("mf4", "diagnosis"),
                  ("mf4", "csv", "diagnosis")):  # fmt: skip
        forms = dict.fromkeys(names, True)
        given = {"runs": None, "into": None, "mf4": False, "csv": False, "diagnosis": False}
        with pytest.raises(typer.Exit) as ended:
            data_commands.export(out, **(given | forms))
        assert ended.value.exit_code == 2
        assert "no form, or several, are named" in capsys.readouterr().err
