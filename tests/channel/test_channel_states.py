"""A channel changes its state along the edges of `channel_states.csv` only, and along every one."""

import csv
from collections.abc import Callable
from importlib import resources
from typing import Any

import pytest
from tests.channel.conftest import ChannelBench
from tests.channel.test_channel_reset import Side, dwell, reset, start

from axisrig.bench.tools.scenarios.states import channel_edges
from axisrig.kernel.channel import Channel
from axisrig.kernel.drives.canopen.startup_steps import StartUpSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS, Phase

Make = Callable[..., ChannelBench]
SEEN_ONLY = {("STOPPING", "RESETTING")}
"""Who looks at the end of a cycle sees no ERROR that a reset ends in the next one."""


@pytest.fixture
def edges(monkeypatch: pytest.MonkeyPatch) -> set[tuple[str, str]]:
    """Every change of a state, also within a cycle."""
    found: set[tuple[str, str]] = set()
    kept: dict[int, Any] = {}

    def change(channel: Channel, state: Any) -> None:
        before = kept.get(id(channel))
        if before is not None and before is not state:
            found.add((before.name, state.name))
        kept[id(channel)] = state

    monkeypatch.setattr(Channel, "state", property(lambda c: kept[id(c)], change), raising=False)
    return found


def alarm() -> Alarm:
    return Alarm(900036, axis="Z", lag_mm="2", limit_mm="1")


@pytest.mark.long
@pytest.mark.interpreted
def test_a_channel_goes_along_every_edge_of_its_table_and_along_no_other(
    edges: set[tuple[str, str]], channel_bench: Make, words: Any
) -> None:
    def made(acts: dict[int, Any] | None = None) -> ChannelBench:
        bench = channel_bench(words.axis("Z"))
        if acts is not None:
            Side(bench, words, {turn: act(bench) for turn, act in acts.items()})
        return bench

    def fail(bench: ChannelBench) -> Callable[[], None]:
        return lambda: bench.channel.plc.report(alarm())

    def again(bench: ChannelBench) -> Callable[[], None]:
        return start(bench, dwell(1, 5), words.end())

    long, short = words.move(1, 3000.0, Z=9.0), [dwell(1, 5), words.end()]
    resets = {50: reset, 200: again, 300: reset, 350: fail, 400: reset}
    made(resets).run([long, words.end()])
    made({30: fail}).run([long, words.end()])
    made({30: reset, 31: fail}).run([long, words.end()])
    made().run(short)
    stopped = made()
    stopped.scheduler.call_at(200 * MS, Phase.APPLICATION, lambda: stopped.channel.stop(alarm()))
    stopped.run([dwell(1, 5000), words.end()])
    refused = StartUpSettings(writes=[(0x6098, 0, 99)])
    channel_bench(words.axis("Z"), start_up=refused).run(short)
    for state in ("STARTING", "POWERING"):
        early = made()
        early.prepare(short)
        while early.channel.state.name != state:
            early.scheduler.run_until(early.scheduler.now_ns + MS // 4)
        early.channel.stop(alarm())
        early.finish()
    assert edges == channel_edges() - SEEN_ONLY


def test_every_edge_says_where_it_comes_from() -> None:
    text = resources.files("axisrig.bench.tools.scenarios").joinpath("channel_states.csv")
    for row in csv.DictReader(text.read_text("utf-8").splitlines()):
        assert row["source"]
        assert row["inferred"] in ("", "yes")
