"""Which states a live view has: the last one at its end, how old each is, and how fast a run goes.

A script is what happens in the pauses of a reader, one action for each; after the last one the feed
has ended.
"""

import http.client
import json
from collections.abc import Callable, Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.cli.beside import server
from axisrig.bench.cli.beside.feed import IDLE_S, PERIOD_S, Feed, Look
from axisrig.bench.cli.beside.server import HOST, PAUSES_MAX, serving

STEP_S = 2 * PERIOD_S


class Pipe:
    """The end of a reader; counts how often it asks."""

    def __init__(self) -> None:
        self.state: bytes | None = None
        self.asked = 0

    def ask(self) -> None:
        self.asked += 1

    def take(self) -> bytes | None:
        state, self.state = self.state, None
        return state


class Scripted(Feed):
    """A feed with a clock, a pipe and a count of runs that the script changes."""

    def __init__(self, *script: Callable[["Scripted"], None]) -> None:
        self.now_s, self.done, self.pipe = 100.0, 0, Pipe()
        self._script = list(script)
        inlet: Any = self.pipe
        super().__init__(inlet, lambda: self.now_s, lambda: {"done": self.done})

    def put(self, time_ms: float, run: str = "a") -> None:
        self.pipe.state = json.dumps({"run": run, "time_ns": round(time_ms * 1e6)}).encode()

    def look_after(self, seconds: float) -> Look:
        self.now_s += seconds
        return self.look()

    def pause(self) -> bool:
        self.now_s += STEP_S
        self._script.pop(0)(self)
        if not self._script:
            self.end()
        return self.has_ended


def sent(*feeds: Scripted) -> list[list[tuple[str, dict[str, Any]]]]:
    """The events of one reader after the other."""
    found: list[list[tuple[str, dict[str, Any]]]] = []
    for feed in feeds:
        events: list[tuple[str, dict[str, Any]]] = []
        handler: Any = SimpleNamespace(
            server=SimpleNamespace(feed=feed, followers=[]),
            _begin=lambda kind: None,
            _send=lambda event, data, events=events: events.append((event, json.loads(data))),
        )
        server._Handler._send_states(handler)
        found.append(events)
    return found


def nothing(_feed: Scripted) -> None:
    """Nothing happens in this pause."""


def state(time_ms: float, run: str = "a") -> Callable[[Scripted], None]:
    return lambda feed: feed.put(time_ms, run)


def runs_done(count: int) -> Callable[[Scripted], None]:
    return lambda feed: setattr(feed, "done", count)


# Its end


@pytest.mark.parametrize("before", [0, 1, 3])
def test_the_end_has_the_state_and_the_runs_of_the_last_pause(before: int) -> None:
    """The last run ends while the reader waits; no look comes after that, only the end."""

    def last(feed: Scripted) -> None:
        feed.put(900.0, "z")
        feed.done = 7

    steps = [state(10.0 * number) for number in range(before)]
    (events,) = sent(Scripted(*steps, last))
    name, end = events[-1]
    assert name == "end"
    assert end["state"] == {"run": "z", "time_ns": 900_000_000}
    assert end["progress"] == {"done": 7}
    assert end["age_s"] == 0.0
    assert [each for each, _ in events[:-1]] == ["look"] * (before + 1)
    assert all(look["progress"] == {"done": 0} for _, look in events[:-1])


def test_who_comes_after_the_end_gets_how_it_ended_and_no_more() -> None:
    feed = Scripted()
    feed.end()
    feed.done = 3
    (events,) = sent(feed)
    assert [(name, look["state"], look["progress"]) for name, look in events] == [
        ("end", None, {"done": 3})
    ]


def test_runs_that_end_without_a_state_are_on_the_page_after_some_pauses() -> None:
    """The look that is sent again has the runs of now; its state stays and grows older."""
    script = [state(5.0), runs_done(2), *[nothing] * (2 * PAUSES_MAX)]
    (events,) = sent(Scripted(*script))
    looks = [look for name, look in events if name == "look"]
    assert [look["progress"]["done"] for look in looks] == [0, 0, 2, 2]
    assert [look["state"] is None for look in looks] == [True, False, False, False]
    assert [look["age_s"] for look in looks[1:]] == pytest.approx(
        [0.0, PAUSES_MAX * STEP_S, 2 * PAUSES_MAX * STEP_S]
    )


def test_a_new_state_begins_the_count_of_pauses_anew() -> None:
    half = PAUSES_MAX // 2
    script = [*[nothing] * half, state(5.0), *[nothing] * (PAUSES_MAX + 1)]
    (events,) = sent(Scripted(*script))
    looks = [look for name, look in events if name == "look"]
    assert [look["state"] is None for look in looks] == [True, False, False]
    assert [look["age_s"] for look in looks[1:]] == pytest.approx([0.0, PAUSES_MAX * STEP_S])


# What is asked for


def test_a_state_is_asked_for_when_its_time_has_come_and_not_before() -> None:
    feed = Scripted()
    feed.look()
    assert feed.pipe.asked == 1
    feed.put(1.0)
    assert feed.look_after(PERIOD_S - 0.01).state is None
    assert feed.pipe.asked == 1
    shown = feed.look_after(0.01 + 1e-9)
    assert shown.state == {"run": "a", "time_ns": 1_000_000}
    assert (shown.number, shown.text) == (1, '{"run": "a", "time_ns": 1000000}')
    assert feed.pipe.asked == 2


def test_all_who_look_get_the_same_state_of_one_question() -> None:
    feed = Scripted()
    feed.look()
    feed.put(1.0)
    looks = [feed.look_after(STEP_S), feed.look(), feed.look_after(0.01)]
    assert [look.number for look in looks] == [1, 1, 1]
    assert [look.age_s for look in looks] == pytest.approx([0.0, 0.0, 0.01])
    assert feed.pipe.asked == 2


@pytest.mark.parametrize(("pause_s", "is_shown"), [(IDLE_S - 0.01, True), (IDLE_S + 0.01, False)])
def test_a_state_that_waited_for_long_is_not_shown_but_the_next_one_is(
    pause_s: float, is_shown: bool
) -> None:
    feed = Scripted()
    feed.look()
    feed.put(1.0)
    shown = feed.look_after(pause_s)
    assert (shown.state is not None) is is_shown
    feed.put(2.0)
    assert feed.look_after(STEP_S).state == {"run": "a", "time_ns": 2_000_000}


# How fast a run goes


def factors(*states: tuple[float, str] | None, step_s: float = 0.5) -> list[float | None]:
    """Of looks so far apart, each with a state of time and run, or without a new one."""
    feed = Scripted()
    feed.look()
    found = []
    for each in states:
        if each is not None:
            feed.put(*each)
        found.append(feed.look_after(step_s).factor)
    return found


def close(*numbers: float | None) -> list[Any]:
    return [None if number is None else pytest.approx(number) for number in numbers]


def test_another_run_begins_anew_wherever_its_time_is() -> None:
    """It may be farther than the one before, as a run that was read late."""
    found = factors((0, "a"), (500, "a"), (9000, "b"), (10000, "b"))
    assert found == close(None, 1.0, None, 2.0)


def test_a_run_that_stands_goes_at_less_and_less_and_then_at_nothing() -> None:
    """1 s of the run in the first 0.5 s, and none after that; 2 s are looked at."""
    found = factors(*[(time_ms, "a") for time_ms in (0, 1000, 1000, 1000, 1000, 1000, 1000)])
    assert found == close(None, 2.0, 1.0, 2 / 3, 0.5, 0.0, 0.0)


def test_the_factor_is_that_of_the_last_two_seconds() -> None:
    """0.5 s of wall time are 2 s of the run at first, then 0.1 s."""
    times_ms = [0, 2000, 4000, 4100, 4200, 4300, 4400]
    found = factors(*[(time_ms, "a") for time_ms in times_ms])
    assert found == close(None, 4.0, 4.0, 4.1 / 1.5, 4.2 / 2, 2.3 / 2, 0.4 / 2)


def test_looks_without_a_new_state_leave_the_factor() -> None:
    assert factors((0, "a"), (500, "a"), None, None) == close(None, 1.0, 1.0, 1.0)


def test_after_nobody_has_looked_the_factor_is_not_known_until_two_states_have_come() -> None:
    feed = Scripted()
    feed.look()
    for time_ms in (0.0, 500.0):
        feed.put(time_ms)
        shown = feed.look_after(0.5)
    assert shown.factor == pytest.approx(1.0)
    feed.put(600.0)
    assert feed.look_after(IDLE_S + 0.5).factor is None
    for time_ms, factor in ((5000.0, None), (6000.0, 2.0)):
        feed.put(time_ms)
        assert feed.look_after(0.5).factor == (None if factor is None else pytest.approx(factor))


# Who is answered


def answers(feed: Feed, requests: Sequence[tuple[str, str, Mapping[str, str]]]) -> list[Any]:
    """Status and headers of each request; `{port}` is that of the server."""
    found = []
    with serving(feed) as address:
        port = int(address.split(":")[2].strip("/"))
        for method, path, headers in requests:
            talk = http.client.HTTPConnection(HOST, port, timeout=10)
            talk.putrequest(method, path, skip_host=True)
            for name, value in headers.items():
                talk.putheader(name, value.format(port=port))
            talk.endheaders()
            answer = talk.getresponse()
            found.append((answer.status, dict(answer.getheaders())))
            talk.close()
    return found


@pytest.mark.long
def test_only_a_page_from_here_is_answered() -> None:
    hosts = {
        "127.0.0.1:{port}": 200, "localhost:{port}": 200, "localhost": 403, "127.0.0.1:1": 403,
        "127.0.0.1.evil.example:{port}": 403, "": 403,
    }  # fmt: skip
    feed = Scripted()
    requests = [("GET", "/", {"Host": host}) for host in hosts] + [("GET", "/", {})]
    found = [status for status, _ in answers(feed, requests)]
    assert found == [*hosts.values(), 403]
    assert feed.pipe.asked == 0


@pytest.mark.long
def test_nothing_but_the_page_and_its_states_can_be_had() -> None:
    host = {"Host": "127.0.0.1:{port}"}
    wanted = {
        ("GET", "/"): (200, "text/html; charset=utf-8"), ("GET", "/page.js"): (404, None),
        ("GET", "/states/"): (404, None), ("POST", "/"): (501, None), ("HEAD", "/"): (501, None),
    }  # fmt: skip
    found = answers(Scripted(), [(method, path, host) for method, path in wanted])
    for (status, headers), (expected, kind) in zip(found, wanted.values(), strict=True):
        assert status == expected
        if kind:
            assert headers["Content-Type"] == kind
            assert headers["Cache-Control"] == "no-store"
            assert "connect-src 'self'" in headers["Content-Security-Policy"]
            assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
