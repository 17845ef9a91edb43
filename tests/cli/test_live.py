"""`run --live`: what is asked of a run and how often, the server, the terminal, and whole calls."""

import io
import json
import os
import signal
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest
from cli_plan import write_plan
from rich.console import Console
from tests.live_states import AXIS, DISTANCE, REAL_TIME, SEGMENT, as_sent, state

from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.resuming import stored_arguments
from axisrig.bench.cli.beside import ticking
from axisrig.bench.cli.beside.feed import IDLE_S, PERIOD_S, Feed, Look
from axisrig.bench.cli.beside.server import serving
from axisrig.bench.cli.beside.showing import showing
from axisrig.bench.cli.beside.terminal import drawing
from axisrig.bench.machine.live.pipe import Inlet, Outlet
from axisrig.kernel.errors import UserError

PROGRESS = {"state": "0/1 runs", "count": 1, "done": 0, "verdicts": [], "ended": []}


class Watched:
    """A feed whose clock the test sets, and the end of the run."""

    def __init__(self, folder: Path) -> None:
        self.now_s = 100.0
        self.inlet = Inlet(folder / "pipe")
        self.outlet = Outlet(folder / "pipe")
        self.feed = Feed(self.inlet, lambda: self.now_s, lambda: PROGRESS)
        self.answers = 0

    def run_for(self, seconds: float, sim_ns: int, **changes: Any) -> Look:
        """Look a thousand times a second while a run that begins at `sim_ns` goes at 3 times real
        time.
        """
        begin_s = self.now_s
        look = self.feed.look()
        while self.now_s < begin_s + seconds:
            self.now_s += 1e-3
            look = self.feed.look()
            if self.outlet.is_asked:
                self.answers += 1
                time_ns = sim_ns + round(3e9 * (self.now_s - begin_s))
                self.outlet.put(as_sent(time_ns=time_ns, **changes))
        return look


@pytest.fixture
def watched(tmp_path: Path) -> Iterator[Watched]:
    watched = Watched(tmp_path)
    with closing(watched.inlet):
        yield watched


def test_nobody_looks_and_nothing_is_asked(watched: Watched) -> None:
    assert not watched.outlet.is_asked
    assert watched.feed.look().state is None
    assert watched.outlet.is_asked


def test_twenty_states_a_second_are_asked_for_however_many_look(watched: Watched) -> None:
    look = watched.run_for(10.0, 0)
    assert 190 <= watched.answers <= 10.0 / PERIOD_S + 1
    assert look.factor == pytest.approx(3.0, rel=0.01)
    assert look.age_s <= 2 * PERIOD_S
    assert json.loads(look.as_json())["state"] == look.state
    assert "\n" not in look.as_json()


def test_the_factor_begins_anew_with_each_run(watched: Watched) -> None:
    watched.run_for(3.0, 50_000_000_000)
    look = watched.run_for(2 * PERIOD_S + 0.01, 0, run="plan-b")
    assert look.state is not None
    assert look.state["run"] == "plan-b"
    assert look.factor is None or look.factor == pytest.approx(3.0, rel=0.1)


def test_what_nobody_has_read_for_long_is_not_shown(watched: Watched) -> None:
    watched.run_for(1.0, 0)
    number = watched.feed.look().number
    watched.now_s += 1.0
    watched.outlet.put(as_sent(waits_for="something long ago"))
    watched.now_s += IDLE_S
    look = watched.feed.look()
    assert (look.number, look.factor) == (number, None)
    assert look.age_s > IDLE_S
    assert watched.outlet.is_asked


# The server


@contextmanager
def _served(watched: Watched) -> Iterator[str]:
    with serving(watched.feed) as address:
        yield address


def _get(address: str, **headers: str) -> tuple[int, Any, str]:
    request = urllib.request.Request(address, headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=10) as answer:
            return answer.status, answer.headers, answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, error.read().decode()


@pytest.mark.long
def test_the_page_comes_from_here_and_needs_nothing_else(watched: Watched) -> None:
    with _served(watched) as address:
        assert address.startswith("http://127.0.0.1:")
        code, headers, text = _get(address)
        assert code == 200
        assert headers["Content-Type"] == "text/html; charset=utf-8"
        assert "default-src 'none'" in headers["Content-Security-Policy"]
        for sign in ("src=", "url(", "@import", "/* style */", "/* script */", "http:", "https:"):
            assert sign not in text.replace("http://www.w3.org/2000/svg", ""), sign
        assert _get(f"{address}other")[0] == 404


@pytest.mark.long
def test_a_page_of_others_by_another_name_gets_nothing(watched: Watched) -> None:
    """A name that somebody lets point to 127.0.0.1 (DNS rebinding)."""
    with _served(watched) as address:
        port = address.split(":")[2].strip("/")
        assert _get(f"{address}states", Host=f"evil.example:{port}")[0] == 403
        assert _get(address, Host=f"localhost:{port}")[0] == 200


def _events(lines: Any) -> Iterator[tuple[str, dict[str, Any]]]:
    name = ""
    for line in lines:
        kind, _, rest = line.decode().rstrip("\n").partition(": ")
        if kind == "event":
            name = rest
        elif kind == "data":
            yield name, json.loads(rest)


def test_states_come_as_events_and_the_end_is_the_last(watched: Watched) -> None:
    with (
        _served(watched) as address,
        urllib.request.urlopen(f"{address}states", timeout=10) as answer,
    ):
        assert answer.headers["Content-Type"] == "text/event-stream"
        events = _events(answer)
        assert next(events) == ("look", {**_rest(watched), "state": None})
        while not watched.outlet.is_asked:
            time.sleep(0.001)
        watched.outlet.put(as_sent(waits_for="the test"))
        watched.now_s += 2 * PERIOD_S
        name, look = next(events)
        assert (name, look["state"]["waits_for"]) == ("look", "the test")
        watched.feed.end()
        assert [name for name, _ in events] == ["end"]
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(address, timeout=2)


def _rest(watched: Watched) -> dict[str, Any]:
    look = watched.feed.look()
    return {"age_s": look.age_s, "factor": None, "progress": PROGRESS}


@pytest.mark.long
def test_a_reader_that_takes_nothing_keeps_nobody_from_ending(watched: Watched) -> None:
    with _served(watched) as address:
        answer = urllib.request.urlopen(f"{address}states", timeout=10)
        answer.read(10)
        began = time.monotonic()
    assert time.monotonic() - began < 5.0
    answer.close()


# The terminal


def _drawn(look: Look) -> str:
    text = io.StringIO()
    console = Console(file=text, width=150, force_terminal=False)
    console.print(drawing(look))
    return text.getvalue()


def _look(**changes: Any) -> Look:
    return Look(1, state(**changes), "", changes.pop("age_s", 0.0), 9.5, PROGRESS)


def test_the_terminal_shows_what_the_page_does() -> None:
    text = _drawn(_look(distance=[DISTANCE], real_time=REAL_TIME, alarms=["50052: [bold]x[/]"]))
    for part in (
        *("plan-a  one touch", "2.000 s simulated, 9.5 times real time; channel running"),
        "programs/p.nc line 4, block N20: N20 G100 Z80 F600  waits for the end of its move",
        *("99.7503", "99.5000", "-0.2503", "operation enabled", "armed", "moving", "100.0001"),
        *("active const dist", "0.1250", "-1.5000", "probe probe on"),
        "bus can1 41.2 %, 12345 frames, 3 error frames",
        "real time: 7 of the last 500 SYNCs late, 812 us at most",
        "50052: [bold]x[/]",  # text of others stays a text
    ):
        assert part in text, part


def test_the_terminal_says_what_is_missing() -> None:
    assert _drawn(Look(0, None, "", 9.0, None, PROGRESS)).strip() == "waiting for a run"
    axis = {**AXIS, "actual": None, "latch": None, "measuring": None}
    bus = {**SEGMENT, "lost": "cable out"}
    look = Look(1, state(axes=[axis], bus=[bus], block=None), "", 7.0, None, PROGRESS)
    text = _drawn(look)
    assert "no new state for 7 s" in text
    assert "3 error frames, lost" in text
    assert "none" in text


def test_a_terminal_that_is_none_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with pytest.raises(UserError, match="--live-terminal needs a terminal"):
        showing(time.monotonic, print, on_page=False, in_terminal=True)


# Progress, from a thread


class _Progress:
    """Counts its ticks; a tick may be made long."""

    def __init__(self) -> None:
        self.ticks = 0
        self.goes_on = threading.Event()
        self.is_inside = threading.Event()

    def tick(self) -> None:
        self.ticks += 1
        self.is_inside.set()
        self.goes_on.wait(10)


@pytest.mark.long
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_no_process_is_forked_while_a_line_is_written(monkeypatch: pytest.MonkeyPatch) -> None:
    """A child that is forked in the middle of it would wait for its locks for ever."""
    monkeypatch.setattr(ticking, "TICK_S", 0.001)
    progress = _Progress()
    interval_s = sys.getswitchinterval()
    with ticking.ticking(progress):  # type: ignore[arg-type]
        assert sys.getswitchinterval() == pytest.approx(ticking.SWITCH_S)
        assert progress.is_inside.wait(10)
        forked: list[int] = []

        def fork() -> None:
            child = os.fork()
            if child == 0:
                os._exit(0)
            forked.append(child)

        forking = threading.Thread(target=fork)
        forking.start()
        forking.join(0.2)
        assert forked == []
        progress.goes_on.set()
        forking.join(10)
        assert len(forked) == 1
        os.waitpid(forked[0], 0)
    assert sys.getswitchinterval() == interval_s
    ticks = progress.ticks
    time.sleep(0.01)
    assert progress.ticks == ticks  # its thread has ended


# Whole calls

Rejected = Callable[..., str]


@pytest.mark.parametrize(
    "words",
    [("-j", "2"), ("--engine", "dask", "--scheduler", "tcp://127.0.0.1:1")],
    ids=["two processes", "a cluster"],
)
def test_several_runs_at_a_time_are_refused(
    place: Path, rejected: Rejected, words: tuple[str, ...]
) -> None:
    plan = write_plan(place, "a,part.nc,rig.toml,3000,== 1,")
    message = rejected("run", plan, "--live", *words)
    assert message.startswith("a live view shows one run at a time, on this machine")
    assert "--live" in message
    assert not (place / "out").exists()


@contextmanager
def _started(place: Path, *words: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A campaign with a page, in a process of its own, and the address of the page."""
    process = subprocess.Popen(
        [sys.executable, "-m", "axisrig.bench.cli", "run", *words, "--live"],
        cwd=place,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509
    )
    try:
        assert process.stderr is not None
        assert process.stderr.readline().startswith("reading ")
        line = process.stderr.readline()
        assert line.startswith("live: http://127.0.0.1:"), line
        yield process, line.split()[1]
    finally:
        process.kill()
        process.wait()


posix = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
SLOW = "slow,part.nc,rig.toml,1,== 1,"
# 6 mm at 1 mm/min: six simulated minutes


@pytest.mark.long
@posix
@pytest.mark.parametrize("apart", [(), ("--isolate",), ("--timeout", "600")], ids=" ".join)
def test_states_of_a_run_are_seen_and_ctrl_c_ends_it(place: Path, apart: tuple[str, ...]) -> None:
    plan = write_plan(place, SLOW)
    with _started(place, plan, "-o", "out", *apart) as (process, address):
        seen: list[dict[str, Any]] = []
        with urllib.request.urlopen(f"{address}states", timeout=30) as answer:
            for name, look in _events(answer):
                if name == "end":
                    break
                if look["state"]:
                    seen.append(look["state"])
                if len(seen) == 20:
                    process.send_signal(signal.SIGINT)
            assert name == "end"
        _, err = process.communicate(timeout=30)
    assert process.returncode == 4
    assert "Traceback" not in err
    assert "interrupted: 0 of 1 runs" in err
    times = [one["time_ns"] for one in seen]
    assert times == sorted(set(times))
    assert {one["run"] for one in seen} == {"plan-slow"}
    assert seen[-1]["block_text"].startswith("N20 G100")
    assert seen[-1]["bus"][0]["frames"] > 0


@pytest.mark.long
@posix
def test_a_campaign_that_is_looked_at_leaves_the_same_files(place: Path) -> None:
    plan = write_plan(place, *(f"f{feed},part.nc,rig.toml,{feed},== 1," for feed in (60, 120)))
    command = [sys.executable, "-m", "axisrig.bench.cli", "run", plan, "-o"]
    subprocess.run([*command, "plain"], cwd=place, check=True, capture_output=True)
    with _started(place, plan, "-o", "looked-at") as (process, address):
        with urllib.request.urlopen(f"{address}states", timeout=30) as answer:
            looks = [look for _, look in _events(answer)]
        process.communicate(timeout=60)
        assert process.returncode == 0
    assert len([look for look in looks if look["state"]]) > 3
    assert looks[-1]["progress"]["done"] == 2
    subprocess.run([*command, "not-looked-at", "--live"], cwd=place, check=True)
    for other in ("looked-at", "not-looked-at"):
        for path in sorted((place / "plain").rglob("*")):
            name = path.relative_to(place / "plain")
            if path.suffix not in (".blf", ".parquet", ".json") or path.name == "manifest.json":
                continue
            assert (place / other / name).read_bytes() == path.read_bytes(), name
        cases = [_without_times(place / folder / "cases.csv") for folder in ("plain", other)]
        assert cases[0] == cases[1]
        results = [(place / folder / "results.csv").read_bytes() for folder in ("plain", other)]
        assert results[0] == results[1]


def _without_times(path: Path) -> list[list[str]]:
    head, *rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
    places = (head.index("wall_s"), head.index("timestamp"))
    return [[c for n, c in enumerate(row) if n not in places] for row in (head, *rows)]


def test_going_on_has_a_live_view_when_this_call_asks_for_one(tmp_path: Path) -> None:
    """Of the words of a stored command those of one call go."""
    words = ["axisrig", "run", "plan.csv", "--live", "--fresh", "--isolate", "--live-terminal"]
    (tmp_path / "manifest.json").write_text(json.dumps({"command": words}), encoding="utf-8")
    assert stored_arguments(tmp_path, (), ()) == ["plan.csv", "--isolate"]


def test_probes_of_a_search_are_shown_too(tmp_path: Path) -> None:
    files = RunFiles(probes=[RunFiles(), RunFiles()]).with_live(tmp_path)
    assert [files.live, *(probe.live for probe in files.probes)] == [tmp_path] * 3
    assert RunFiles().with_live(None) == RunFiles(probes=[])
