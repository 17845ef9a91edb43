"""Commands without a reader, a library, a terminal, a main thread or signs beyond ASCII."""

import codecs
import sys
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
import typer

from axisrig.bench.cli import list_commands, perf_command
from axisrig.bench.cli.guard import needs_progress
from axisrig.bench.cli.options import EXIT_BROKEN_PIPE, rejecting
from axisrig.bench.cli.start import plain_signs

Call = Callable[..., tuple[int, str, str]]


def test_a_reader_that_has_gone_ends_a_command_without_a_message(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """What Python still writes at its end goes nowhere: it would raise the same error again."""

    def command() -> None:
        raise BrokenPipeError

    path = tmp_path / "out.txt"
    with path.open("w", encoding="utf-8") as out:
        monkeypatch.setattr(sys, "stdout", out)
        with pytest.raises(typer.Exit) as caught:
            rejecting(command)()
        out.write("the rest of what was buffered")
        out.flush()
        monkeypatch.undo()
    assert caught.value.exit_code == EXIT_BROKEN_PIPE
    assert path.read_text(encoding="utf-8") == ""
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("found", "line"),
    [
        ("1.2.3", "axisrig 1.2.3"),
        (None, "axisrig, run from its sources without being installed"),
    ],
)
def test_the_version_is_that_of_what_is_installed(
    found: str | None, line: str, axisrig: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    def version(name: str) -> str:
        assert name == "axisrig"
        if found is None:
            raise metadata.PackageNotFoundError(name)
        return found

    monkeypatch.setattr(metadata, "version", version)
    assert axisrig("--version") == (0, f"{line}\n", "")


def test_without_its_drawing_library_a_tuning_says_how_to_get_it(
    rejected: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before anything is measured."""
    monkeypatch.setitem(sys.modules, "axisrig.bench.tools.tune.picture", None)
    monkeypatch.setattr("axisrig.bench.tools.tune.measure.choose", pytest.fail)
    message = rejected("tune", "distance", "--rig", "rig.toml")
    assert message.startswith("matplotlib is not installed")
    assert "pip install 'axisrig[tune]' brings it" in message


def test_cpu_time_is_that_of_this_process_and_of_its_children(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """2.5 s here, 1.25 s and 0.5 s of the children; Windows does not count those."""

    class Resource:
        RUSAGE_CHILDREN = -1

        def getrusage(self, who: int) -> Any:
            assert who == -1
            return type("Used", (), {"ru_utime": 1.25, "ru_stime": 0.5})

    monkeypatch.setattr("time.process_time_ns", lambda: 2_500_000_000)
    monkeypatch.setattr(perf_command, "resource", Resource())
    assert perf_command.cpu_ns() == 4_250_000_000
    monkeypatch.setattr(perf_command, "resource", None)
    assert perf_command.cpu_ns() == 2_500_000_000


def test_outside_of_the_main_thread_nothing_is_watched() -> None:
    """Signals come to the main thread alone; what is inside goes on and its errors come out."""
    done: list[str] = []

    class Standing:
        place = (0, 0)

    def read() -> None:
        with needs_progress(Standing(), Path("a.blf"), cpu_s=0.001):
            done.append("read")
        try:
            with needs_progress(Standing(), Path("a.blf"), cpu_s=0.001):
                raise ValueError("damaged")
        except ValueError as error:
            done.append(str(error))

    thread = Thread(target=read)
    thread.start()
    thread.join()
    assert done == ["read", "damaged"]


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("✔ ✖ 5 µm ≤ 3° ± 2", "+ x 5 um <= 3deg +- 2"),
        ("1 × 2 · 3 ≠ 4 → 5²", "1 x 2 * 3 != 4 -> 52"),
        ("– − … ■ ≥", "- - ... # >="),
        ("Ω x", "_ x"),  # one that no command prints
    ],
)
def test_signs_that_are_not_in_ascii_have_others_there(text: str, shown: str) -> None:
    assert text.encode("ascii", errors=plain_signs()).decode("ascii") == shown


def test_bytes_that_are_no_text_are_refused_and_not_replaced() -> None:
    with pytest.raises(UnicodeDecodeError):
        b"\xff".decode("utf-8", errors=plain_signs())
    error = UnicodeDecodeError("utf-8", b"\xff", 0, 1, "why")
    with pytest.raises(UnicodeDecodeError) as caught:
        codecs.lookup_error(plain_signs())(error)
    assert caught.value is error


class Terminal:
    """Standard output: a terminal or a pipe."""

    def __init__(self, is_terminal: bool) -> None:
        self.text, self._is_terminal = "", is_terminal

    def write(self, text: str) -> int:
        self.text += text
        return len(text)

    def flush(self) -> None: ...

    def isatty(self) -> bool:
        return self._is_terminal


@pytest.mark.parametrize("is_terminal", [True, False])
def test_a_page_is_drawn_on_a_terminal_and_copied_into_a_pipe(
    is_terminal: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = tmp_path / "page.md"
    page.write_text("# Head\n\nsome *words*\n", encoding="utf-8")
    monkeypatch.setattr("axisrig.bench.tools.listings.documents.page", lambda name: page)
    monkeypatch.setattr("pydoc.pager", lambda text: sys.stdout.write(f"<{text}>"))
    monkeypatch.setenv("TERM", "xterm")
    out = Terminal(is_terminal)
    monkeypatch.setattr(sys, "stdout", out)
    list_commands.docs("page", False, None)
    monkeypatch.undo()
    if not is_terminal:
        assert out.text == "# Head\n\nsome *words*\n"
        return
    assert (out.text[0], out.text[-1]) == ("<", ">")  # through the pager, once
    assert "Head" in out.text
    assert "*words*" not in out.text
    assert "words" in out.text


def test_a_page_that_is_opened_is_named_and_not_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without a name it is the first page; the list comes without name and option alone."""
    asked: list[str] = []
    opened: list[str] = []

    def page(name: str) -> Path:
        asked.append(name)
        return tmp_path / f"{name}.md"

    documents = "axisrig.bench.tools.listings.documents"
    monkeypatch.setattr(f"{documents}.page", page)
    monkeypatch.setattr(f"{documents}.listing", lambda: "all pages")
    monkeypatch.setattr(f"{documents}.copy_notebook", lambda path: f"copied to {path}")
    monkeypatch.setattr(typer, "launch", opened.append)
    list_commands.docs("glossary", True, None)
    list_commands.docs(None, True, None)
    list_commands.docs(None, False, None)
    list_commands.docs("glossary", True, Path("own.ipynb"))
    paths = [str(tmp_path / name) for name in ("glossary.md", "index.md")]
    assert (asked, opened) == (["glossary", "index"], paths)
    lines = capsys.readouterr().out.splitlines()
    assert lines == [*paths, "all pages", "copied to own.ipynb"]
