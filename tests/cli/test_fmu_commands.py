"""`axisrig fmu`: what it asks of the tools, what it prints where, and its exit codes."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer

from axisrig.bench.cli import fmu_commands
from axisrig.bench.cli.options import CALL_LIMIT_S

TOOLS = "axisrig.bench.tools.fmu"


def checked(path: Path, limit_s: float, *, is_strict: bool) -> Any:
    """Good is what is named so; its data have what was asked."""
    is_good = path.name.startswith("good")
    data = {"file": path.name, "limit_s": limit_s, "is_strict": is_strict}
    return SimpleNamespace(
        path=path, is_good=is_good, verdict="ok" if is_good else "FAIL", findings=[path.name],
        as_data=lambda: data,
    )  # fmt: skip


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, list[str]]]:
    """Titles of the tables of findings, and their rows."""
    found: list[tuple[str, list[str]]] = []
    monkeypatch.setattr(f"{TOOLS}.place.find_fmu", Path)
    monkeypatch.setattr(f"{TOOLS}.check.check_fmu", checked)
    monkeypatch.setattr(
        f"{TOOLS}.findings.show_findings", lambda rows, title: found.append((title, rows))
    )
    return found


@pytest.mark.parametrize(
    ("files", "code"),
    [("good", 0), ("bad", 1), ("good good2", 0), ("bad good", 1), ("good bad", 1),
     ("good bad good2", 1)],
)  # fmt: skip
def test_the_exit_code_is_1_if_any_of_the_fmus_has_failed(
    files: str, code: int, shown: list[tuple[str, list[str]]], capsys: pytest.CaptureFixture[str]
) -> None:
    names = files.split()
    with pytest.raises(typer.Exit) as ended:
        fmu_commands.check_fmus(names, None, as_json=False, is_strict=False)
    assert ended.value.exit_code == code
    words = {True: "ok", False: "FAIL"}
    assert shown == [(f"{name}: {words[name.startswith('good')]}", [name]) for name in names]
    assert capsys.readouterr().out == ""


def test_all_answers_are_one_object_and_each_trial_has_the_options(
    shown: list[tuple[str, list[str]]], capsys: pytest.CaptureFixture[str]
) -> None:
    for limit_s, is_strict in ((None, False), (2.5, True)):
        with pytest.raises(typer.Exit) as ended:
            fmu_commands.check_fmus(["bad", "good"], limit_s, as_json=True, is_strict=is_strict)
        assert ended.value.exit_code == 1
        assert json.loads(capsys.readouterr().out) == {
            "fmus": [
                {"file": name, "limit_s": limit_s or CALL_LIMIT_S, "is_strict": is_strict}
                for name in ("bad", "good")
            ]
        }
    assert shown == []


def test_an_fmu_is_shown_with_its_local_variables_where_asked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found: list[Any] = []
    monkeypatch.setattr(f"{TOOLS}.place.find_fmu", lambda text: Path(f"{text}.fmu"))
    monkeypatch.setattr(f"{TOOLS}.show.read_fmu", lambda path: f"read {path}")
    monkeypatch.setattr(
        f"{TOOLS}.show.show_fmu", lambda read, *, is_all: found.append((read, is_all))
    )
    for is_all in (False, True):
        fmu_commands.show("a", is_all=is_all)
    assert found == [("read a.fmu", False), ("read a.fmu", True)]


def test_models_are_built_into_the_cache_or_into_a_release(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """FMI 3.0 for this platform without options; a path for each."""
    asked: list[Any] = []

    def build(*words: Any) -> list[Any]:
        asked.append(words)
        return [SimpleNamespace(model=name, path=Path(f"{name}.fmu")) for name in ("a", "b")]

    def release(*words: Any) -> list[Path]:
        asked.append(words)
        return [Path("out/a.fmu"), Path("out/SHA256SUMS")]

    monkeypatch.setattr(f"{TOOLS}.library.build_models", build)
    monkeypatch.setattr(f"{TOOLS}.release.release_models", release)
    into, versions, targets = Path("out"), ["2.0", "3.0"], ["x86_64-windows"]
    cached, released = "a.fmu\nb.fmu\n", f"{into / 'a.fmu'}\n{into / 'SHA256SUMS'}\n"
    for words, ask, out in (
        ((None, False, None, None, None, None), (None, ("3.0",), (), None), cached),
        ((None, True, None, None, None, None), (None, ("3.0",), (), None), cached),
        (("a", False, versions, targets, "zig", None), ("a", versions, targets, "zig"), cached),
        ((None, False, None, None, None, into), (into, None, ("3.0",), (), None), released),
        (("a", False, versions, targets, "cc", into), (into, "a", versions, targets, "cc"),
         released),
    ):  # fmt: skip
        fmu_commands.build(*words)
        assert (asked.pop(), capsys.readouterr().out) == (ask, out)
        assert asked == []
    with pytest.raises(typer.Exit) as refused:
        fmu_commands.build("a", True, None, None, None, None)
    assert (refused.value.exit_code, asked) == (2, [])
    assert "--all is every model" in capsys.readouterr().err
    fmu_commands.build_library()
    assert asked == [(None,)]
    assert capsys.readouterr() == ("", "a: a.fmu\nb: b.fmu\n")
