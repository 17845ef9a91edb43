"""Parts of `run --live` by themselves: what is sent when, what is drawn how, what is open when."""

import io
import json
import re
import socket
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from rich.console import Console
from tests.live_states import AXIS, DISTANCE, LINE, REAL_TIME, SEGMENT, state

from axisrig.bench.cli.beside import server, showing, terminal, ticking
from axisrig.bench.cli.beside.feed import Feed as LiveFeed
from axisrig.bench.cli.beside.feed import Look
from axisrig.bench.cli.beside.server import PAUSES_MAX
from axisrig.bench.cli.beside.terminal import OLD_S, drawing

# What is sent


class Feed:
    """Looks with these numbers, one for each pause; then the end."""

    def __init__(self, *numbers: int) -> None:
        self._numbers = list(numbers)
        self.pauses = 0

    @property
    def has_ended(self) -> bool:
        return self.pauses == len(self._numbers)

    def look(self) -> Any:
        number = self._numbers[min(self.pauses, len(self._numbers) - 1)]
        return SimpleNamespace(number=number, as_json=lambda: f"{number}")

    def pause(self) -> None:
        self.pauses += 1


class Ending:
    """Has no state before it is ended."""

    def __init__(self) -> None:
        self._end = threading.Event()

    @property
    def has_ended(self) -> bool:
        return self._end.is_set()

    def look(self) -> Any:
        return SimpleNamespace(number=0, as_json=lambda: "{}")

    def pause(self) -> None:
        self._end.wait(0.01)

    def end(self) -> None:
        self._end.set()


def sent(*numbers: int) -> list[tuple[str, str]]:
    found: list[tuple[str, str]] = []
    handler: Any = SimpleNamespace(
        server=SimpleNamespace(feed=Feed(*numbers), followers=[]),
        _begin=lambda kind: found.append(("begin", kind)),
        _send=lambda event, data: found.append((event, data)),
    )
    server._Handler._send_states(handler)
    assert len(handler.server.followers) == 1
    return found


def test_a_look_is_sent_with_each_new_state_and_the_end_is_the_last() -> None:
    assert sent(0, 0, 1, 1, 3) == [
        ("begin", "text/event-stream"), ("look", "0"), ("look", "1"), ("look", "3"), ("end", "3"),
    ]  # fmt: skip


@pytest.mark.parametrize(("pauses", "looks"), [(0, 1), (1, 2), (PAUSES_MAX, 2),
                                               (PAUSES_MAX + 1, 3)])  # fmt: skip
def test_without_a_new_state_a_look_is_sent_after_so_many_pauses(pauses: int, looks: int) -> None:
    """The first one at once; the campaign may have gone on meanwhile."""
    numbers = [4] * (PAUSES_MAX + pauses)
    assert [event for event, _ in sent(*numbers)].count("look") == looks


def test_an_event_has_the_form_of_its_chapter_and_an_answer_its_headers() -> None:
    written = io.BytesIO()
    headers: dict[str, str] = {}
    handler: Any = SimpleNamespace(
        wfile=written, send_response=lambda code: headers.update(code=str(int(code))),
        send_header=headers.__setitem__, end_headers=lambda: headers.update(end=""),
    )  # fmt: skip
    server._Handler._send(handler, "look", '{"a": 1}')
    assert written.getvalue() == b'event: look\ndata: {"a": 1}\n\n'
    server._Handler._begin(handler, "text/html", 5)
    assert (headers["code"], headers["Content-Type"], headers["Content-Length"]) == (
        "200", "text/html", "5",
    )  # fmt: skip
    assert headers["Cache-Control"] == "no-store"
    assert headers["X-Content-Type-Options"] == "nosniff"
    headers.clear()
    server._Handler._begin(handler, "text/event-stream")
    assert "Content-Length" not in headers


def test_a_look_is_one_line_of_json() -> None:
    for text, shown in (("", None), ('{"run": "p-a"}', {"run": "p-a"})):
        line = Look(3, None, text, 0.5, 2.5, {"done": 1}).as_json()
        assert "\n" not in line
        assert json.loads(line) == {
            "state": shown, "age_s": 0.5, "factor": 2.5, "progress": {"done": 1},
        }  # fmt: skip


def test_the_factor_is_known_from_the_second_state_on() -> None:
    """0.3 s in 0.1 s; the states of another run begin anew."""
    now_s, states = [100.0], [b""]
    inlet: Any = SimpleNamespace(take=lambda: states[0] or None, ask=lambda: None)
    feed = LiveFeed(inlet, lambda: now_s[0], dict)
    found = []
    for run, time_ms in (("a", 0), ("a", 300), ("a", 400), ("b", 0), ("b", 900), ("b", 100)):
        feed.look()
        now_s[0] += 0.1
        states[0] = json.dumps({"run": run, "time_ns": time_ms * 1_000_000}).encode()
        found.append(feed.look().factor)
        states[0] = b""
        feed.look()
    # The last one goes back in time, as a run that begins again
    assert found == [None, pytest.approx(3.0), pytest.approx(2.0), None, pytest.approx(9.0), None]


# What is drawn


def look(age_s: float = 0.0, factor: float | None = None, **changes: Any) -> Look:
    return Look(1, state(**changes), "", age_s, factor, {})


def drawn(shown: Look) -> list[str]:
    text = io.StringIO()
    Console(file=text, width=150, force_terminal=False).print(drawing(shown))
    return text.getvalue().splitlines()


def test_a_state_is_old_when_it_has_not_come_for_long() -> None:
    for age_s, is_old in ((OLD_S, False), (OLD_S + 0.01, True)):
        for is_held in (False, True):
            shown = drawn(look(age_s, is_held=is_held))
            assert any("no new state" in line for line in shown) is is_old


def test_what_is_not_known_is_left_out() -> None:
    lines = drawn(look(block=None, waits_for="the start", is_held=True, messages=list("abc")))
    assert lines[1] == "2.000 s simulated; channel running, feedhold"
    assert lines[2] == "the start"
    assert lines[-2:] == ["b", "c"]  # the last two
    assert not any("real time" in line or "distance control" in line for line in lines)
    assert "12.3 times real time" in drawn(look(factor=12.345))[1]


@pytest.mark.parametrize(
    ("word", "style"),
    [("fault", "red"), ("quick stop active", "red"), ("error", "red"),
     ("fault reaction active", "red"), ("operation enabled", "green"), ("active", "green"),
     ("active const dist", "green"), ("switched on", ""), ("inactive", "")],
)  # fmt: skip
def test_a_state_has_the_colour_of_what_it_means(word: str, style: str) -> None:
    found = terminal._word(word)
    assert (found.plain, found.style) == (word, style)


def test_states_have_their_colours_where_they_are_drawn() -> None:
    """Of drives, of distance controls, and the texts of alarms; messages have none."""
    good = {**AXIS, "axis": "X"}
    bad = {**AXIS, "axis": "Z", "drive": "fault"}
    controls = [{**DISTANCE, "state": word} for word in ("active const dist", "error", "inactive")]
    text = io.StringIO()
    console = Console(file=text, width=150, force_terminal=True, color_system="standard")
    shown = look(axes=[good, bad], distance=controls, alarms=["alarm 50052"], messages=["hello"])
    console.print(drawing(shown))
    words = ("operation enabled", "fault", "active const dist", "error", "alarm 50052", "inactive")
    colours = {
        word: re.findall(rf"\x1b\[([0-9;]*)m *{word}", text.getvalue())
        for word in (*words, "hello")
    }
    assert colours == {
        "operation enabled": ["32"], "fault": ["31"], "active const dist": ["32"],
        "error": ["2", "31"],  # the head of a column, and the state
        "alarm 50052": ["1;31"], "inactive": [], "hello": [],
    }  # fmt: skip


def test_numbers_are_right_and_words_left() -> None:
    first = {**AXIS, "axis": "Z", "actual": 1.5, "drive": "fault", "latch": None}
    second = {**AXIS, "axis": "LONG", "actual": -1000.25, "measuring": None}
    lines = drawn(look(axes=[first, second], distance=[DISTANCE]))
    head = next(n for n, line in enumerate(lines) if line.startswith("axis "))
    top, one, two = lines[head : head + 3]
    end = top.index("actual") + len("actual")
    assert one[:end].endswith(" 1.5000")
    assert two[:end].endswith("-1000.2500")
    assert (one[0], two[:4]) == ("Z", "LONG")
    assert one.index("fault") == two.index("operation enabled") == top.index("drive")
    assert one.rstrip().endswith("none")
    assert " no " in two
    assert terminal._number(-0.00001) == "0.0000"  # no minus of nothing


def test_probes_and_buses_have_a_line_each() -> None:
    probes = [{"probe": "a", "level": True}, {"probe": "b", "level": False}]
    buses = [{**SEGMENT, "segment": "x", "lost": None}, {**SEGMENT, "segment": "y", "lost": "out"},
             {**SEGMENT, "segment": "z", "line": LINE}]  # fmt: skip
    found = [text.plain for text in terminal._probes_and_buses({"probes": probes, "bus": buses})]
    assert found == [
        "probe a on", "probe b off",
        "bus x 41.2 %, 12345 frames, 3 error frames",
        "bus y 41.2 %, 12345 frames, 3 error frames, lost",
        "bus z 41.2 %, 12345 frames, 3 error frames, working counter 6, wrong in 2;"
        " X OP, Z SAFEOP, 0x001B, x",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("late", "looked_at", "worst_us", "words"),
    [
        (0, 500, 12.4, "0 of the last 500 SYNCs late, 12 us at most"),
        (0, 1, 0.0, "0 of the last 1 SYNCs late, 0 us at most"),
        (7, 500, 812.6, "7 of the last 500 SYNCs late, 813 us at most"),
        (500, 500, 2e6, "500 of the last 500 SYNCs late, 2000000 us at most"),
    ],
)
def test_how_real_time_is_kept_is_shown_as_long_as_there_is_any(
    late: int, looked_at: int, worst_us: float, words: str
) -> None:
    """The worst delay is of interest while none is too late; it comes before the axes."""
    kept = {**REAL_TIME, "late": late, "looked_at": looked_at, "worst_us": worst_us}
    lines = drawn(look(real_time=kept))
    assert lines[3] == f"real time: {words}"
    assert lines[4].startswith("axis ")
    assert [line for line in lines if line != lines[3]] == drawn(look(real_time=None))


# What is open


@pytest.mark.parametrize("on_page", [True, False])
@pytest.mark.parametrize("in_terminal", [True, False])
def test_what_is_shown_is_open_as_long_as_the_campaign(
    on_page: bool, in_terminal: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    news: list[str] = []

    def opening(name: str, value: Any = None) -> Any:
        @contextmanager
        def open_(*_: object) -> Any:
            news.append(f"+{name}")
            yield value
            news.append(f"-{name}")

        return open_

    beneath: list[Any] = []
    progress: Any = SimpleNamespace(as_data=dict, show_beneath=beneath.append)
    monkeypatch.setattr(showing, "session_folder", lambda: tmp_path)
    monkeypatch.setattr(showing, "ticking", opening("ticking"))
    monkeypatch.setattr(showing, "serving", opening("page", "http://127.0.0.1:1/"))
    monkeypatch.setattr(sys, "stderr", SimpleNamespace(isatty=lambda: True))
    printed: list[str] = []
    watch = showing.showing(lambda: 0.0, printed.append, on_page=on_page, in_terminal=in_terminal)
    assert watch.live == tmp_path / "live"
    with watch.beside(progress):
        news.append("run")
        assert bool(beneath) is in_terminal
        drawn_now = [draw() for draw in beneath]
    page = ["+page", "run", "-page"] if on_page else ["run"]
    assert news == ["+ticking", *page, "-ticking"]
    assert printed == (["live: http://127.0.0.1:1/"] if on_page else [])
    if in_terminal:
        assert beneath[-1] is None  # it goes with the campaign
        assert [text.plain for text in drawn_now] == ["waiting for a run"]


def test_threads_beside_take_little_time_and_all_is_as_before_then(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before_s = sys.getswitchinterval()
    ticks: list[float] = []
    progress: Any = SimpleNamespace(tick=lambda: ticks.append(sys.getswitchinterval()))
    monkeypatch.setattr(ticking, "TICK_S", 0.001)

    def run() -> None:
        with ticking.ticking(progress):
            while len(ticks) < 2:
                time.sleep(0.001)
            raise ValueError("odd")

    with pytest.raises(ValueError, match="odd"):
        run()
    assert sys.getswitchinterval() == before_s
    assert ticks[0] == pytest.approx(ticking.SWITCH_S)
    count = len(ticks)

    def gone() -> None:
        raise OSError("the reader has gone")

    ticking._tick(SimpleNamespace(tick=gone))  # type: ignore[arg-type]
    assert len(ticks) == count


def test_what_ticks_is_over_with_its_block(monkeypatch: pytest.MonkeyPatch) -> None:
    """A tick that takes its time ends before the block does."""
    monkeypatch.setattr(ticking, "TICK_S", 0.001)
    begun, ended = threading.Event(), list[int]()

    def tick() -> None:
        begun.set()
        time.sleep(0.02)
        ended.append(1)

    progress: Any = SimpleNamespace(tick=tick)
    with ticking.ticking(progress):
        assert begun.wait(10.0)
        count = len(ended)
    assert len(ended) > count
    assert not any(thread.name == "progress" for thread in threading.enumerate())


@pytest.mark.long
def test_a_server_gives_back_its_port_and_its_threads() -> None:
    """Whatever ends the campaign; a reader that looks on hears of the end."""
    feed: Any = Ending()
    ports: list[int] = []

    def serving_threads() -> int:
        return sum(thread.name == "live page" for thread in threading.enumerate())

    def campaign() -> None:
        with server.serving(feed) as address:
            ports.append(int(address.removeprefix("http://127.0.0.1:").removesuffix("/")))
            with socket.create_connection(("127.0.0.1", ports[0])) as reader:
                host = f"Host: 127.0.0.1:{ports[0]}"
                reader.sendall(f"GET /states HTTP/1.1\r\n{host}\r\n\r\n".encode())
                assert reader.recv(15) == b"HTTP/1.0 200 OK"
                assert not feed.has_ended
                assert serving_threads() > 0
            raise ValueError("odd")

    with pytest.raises(ValueError, match="odd"):
        campaign()
    assert feed.has_ended
    assert serving_threads() == 0
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", ports[0]))
