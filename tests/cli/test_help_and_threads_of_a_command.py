"""What the help of arguments shows, and what a thread beside a command leaves as it was."""

import http.client
import sys
from pathlib import Path
from threading import Event, active_count
from typing import Annotated, Any

import pytest
import typer
from tests.cli.test_states_of_a_live_view import Scripted
from typer.testing import CliRunner

from axisrig.bench.cli.beside import ticking
from axisrig.bench.cli.beside.server import HOST, serving
from axisrig.bench.cli.start import Whole


def test_an_argument_has_its_name_alone_and_an_option_its_type_in_words() -> None:
    app = typer.Typer(cls=Whole, rich_markup_mode=None)

    def one(
        folder: Annotated[Path, typer.Argument(help="A folder.")],
        count: Annotated[int, typer.Argument(min=1, help="How many.")],
        runs: Annotated[list[str], typer.Argument(metavar="RUN", help="Runs.")],
        to: Annotated[Path | None, typer.Option("--to", help="Where.")] = None,
        most: Annotated[int, typer.Option("--most", min=1, max=9, help="Most.")] = 3,
        times: Annotated[list[float] | None, typer.Option("--time", help="When.")] = None,
        words: Annotated[str, typer.Option("--word", metavar="KEY", help="Which.")] = "",
    ) -> None:
        """Do one thing."""

    app.command()(one)
    app.command("two")(lambda: None)
    shown = CliRunner().invoke(app, ["one", "--help"]).output
    columns = [line.strip().partition("  ")[0] for line in shown.splitlines()]
    for name in ("folder", "count", "RUN", "--to PATH", "--most N", "--time NUMBER", "--word KEY"):
        assert name in columns


class Ticks:
    """Counts its ticks; the first may fail."""

    def __init__(self, error: Exception | None = None) -> None:
        self.error, self.held, self.done = error, list[bool](), Event()

    def tick(self) -> None:
        self.held.append(ticking._FORKS.locked())
        if len(self.held) > 1 or self.error is None:
            self.done.set()
        else:
            raise self.error


@pytest.mark.parametrize("error", [None, BrokenPipeError(), OSError("no space")])
@pytest.mark.parametrize("fails", [True, False])
def test_what_ticks_leaves_the_process_as_it_was(
    error: Exception | None, fails: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While a line is written nothing forks; a reader that has gone does not end the ticks."""
    monkeypatch.setattr(ticking, "TICK_S", 1e-4)
    before = sys.getswitchinterval(), active_count()
    progress: Any = Ticks(error)
    try:
        with ticking.ticking(progress):
            assert sys.getswitchinterval() == pytest.approx(ticking.SWITCH_S)
            assert progress.done.wait(10)
            if fails:
                raise RuntimeError
    except RuntimeError:
        assert fails
    assert (sys.getswitchinterval(), active_count()) == before
    assert set(progress.held) == {True}
    assert not ticking._FORKS.locked()


def test_a_page_is_for_the_names_of_this_machine_alone() -> None:
    """Another name that leads to 127.0.0.1 (DNS rebinding), or another port, is answered by 403."""
    with serving(Scripted()) as address:
        port = int(address.rstrip("/").rpartition(":")[2])
        answers = {}
        for host in (f"{HOST}:{port}", f"localhost:{port}", HOST, "localhost", f"evil.test:{port}",
                     f"localhost:{port + 1}"):  # fmt: skip
            line = http.client.HTTPConnection(HOST, port, timeout=10)
            line.request("GET", "/", headers={"Host": host})
            answers[host] = line.getresponse().status
            line.close()
    assert list(answers.values()) == [200, 200, 403, 403, 403, 403]
