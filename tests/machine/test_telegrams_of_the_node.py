"""Which telegrams of a node with digital inputs its PLC believes."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.machine.canopen.io_terminal import IoTerminal
from axisrig.bench.oracles.sources.telegrams import counting
from axisrig.bench.rig.canopen.io_node import NodeTelegrams, terminal_telegrams
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.reading.plc_task import TerminalTable
from axisrig.bench.rig.settings import read_settings
from axisrig.kernel.time.clock import MS, US, TimeNs
from axisrig.kernel.time.scheduler import new_scheduler

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "plc-io-node.toml"
NODE, LATEST_NS = 20, 600 * US
FIRST_NS = (44 + 3 + 44 + 8) * US
"""SYNC, intermission and answer without a stuff bit, at 1 Mbit/s."""


class Signal:
    """A probe with the level that a test gives it from 10 ms on."""

    def __init__(self, level: bool) -> None:
        self.level, self.edges = not level, ((10 * MS, level),)


class Plc:
    """A node with its PLC, and a port of somebody else; level: of its input from 10 ms on."""

    def __init__(self, level: bool) -> None:
        self.scheduler = new_scheduler()
        segment = self.segment = Segment("can1", 1_000_000, self.scheduler)
        self.level = level
        self.master = SimNetwork(segment.port("cnc")).connect()
        self.other = SimNetwork(segment.port("other")).connect()
        self.terminal = IoTerminal(
            TerminalTable(segment="can1", node=NODE, input_1="probe"),
            {"probe": Signal(level)},
            self.scheduler,
            node_port=SimNetwork(segment.port("io")).connect(),
            master=self.master,
            advance=lambda _: None,
            telegrams=NodeTelegrams("can1", 0x180 + NODE, MS, FIRST_NS, LATEST_NS),
        )
        for time_ms in range(5, 10):
            self.sync(time_ms)
        self.read()

    def sync(self, time_ms: int, foreign_us: float | None = None) -> None:
        """Send a SYNC, and the other level than that of the input so long after it."""
        self.scheduler.run_until(time_ms * MS)
        self.master.send_message(0x80, b"")
        if foreign_us is not None:
            self.foreign(time_ms, foreign_us, level=not self.level)
        self.scheduler.run_until(time_ms * MS + 900 * US)

    def foreign(self, time_ms: int, after_us: float, *, level: bool) -> None:
        self.scheduler.run_until(time_ms * MS + round(after_us * US))
        self.other.send_message(0x180 + NODE, bytes((level,)))

    def read(self) -> tuple[int, bool]:
        """Return what a cycle of the PLC sees: working counter state and level."""
        self.terminal.exchange_until(self.scheduler.now_ns)
        return self.terminal.wc_state, self.terminal.image[1].input


@pytest.fixture(params=[True, False], ids=["rising", "falling"])
def plc(request: pytest.FixtureRequest) -> Iterator[Plc]:
    made = Plc(request.param)
    with made.segment:
        yield made


@pytest.mark.parametrize("foreign_us", [0, 30, 200, 400], ids=str)
def test_of_two_that_differ_none_counts(plc: Plc, foreign_us: float) -> None:
    """Whoever comes first: the level stays that of before, until one comes alone."""
    plc.sync(11, foreign_us)
    assert plc.read() == (0, not plc.level)
    plc.sync(12)
    assert plc.read() == (0, plc.level)


def test_two_alike_count_as_one(plc: Plc) -> None:
    plc.sync(11)
    plc.sync(12)
    plc.foreign(13, 300, level=plc.level)
    plc.scheduler.run_until(13_900 * US)
    assert plc.read() == (0, plc.level)


def test_what_the_plc_has_read_of_two_that_differ_is_called_back(plc: Plc) -> None:
    """Its next cycle sees that inputs are not to be trusted, the one after that does again."""
    plc.scheduler.run_until(11 * MS)
    plc.master.send_message(0x80, b"")
    plc.scheduler.run_until(11 * MS + 250 * US)
    assert plc.read() == (0, plc.level)
    plc.foreign(11, 300, level=not plc.level)
    plc.sync(12)
    assert plc.read() == (1, plc.level)
    plc.sync(13)
    assert plc.read() == (0, plc.level)


def test_when_two_that_differ_come_again_and_again_the_node_counts_as_lost(plc: Plc) -> None:
    """missing_cycles 3: the fourth period without one."""
    for time_ms in range(10, 13):
        plc.sync(time_ms, 200)
        assert plc.read()[0] == 0
    plc.sync(13, 200)
    assert plc.read() == (1, not plc.level)


def test_what_comes_after_the_nc_cycle_answers_no_sync(plc: Plc) -> None:
    plc.sync(11)
    plc.sync(12)
    plc.foreign(12, 905, level=not plc.level)
    plc.scheduler.run_until(12_990 * US)
    assert plc.read() == (0, plc.level)


@pytest.mark.parametrize(("after_us", "counts"), [(400, True), (620, False), (905, False)])
def test_a_telegram_alone_counts_up_to_the_nc_cycle(
    plc: Plc, after_us: float, counts: bool
) -> None:
    """No SYNC is sent: nothing else comes in that period. A frame takes some 60 us."""
    plc.sync(11)
    plc.foreign(12, after_us, level=not plc.level)
    plc.scheduler.run_until(12_990 * US)
    assert plc.read() == (0, plc.level is not counts)


def test_what_ends_before_an_answer_can_is_none(plc: Plc) -> None:
    """Requested with the SYNC, which goes first, it ends after it and itself at the earliest."""
    plc.sync(11)
    plc.foreign(12, 10, level=not plc.level)  # no SYNC is sent
    plc.scheduler.run_until(12 * MS + FIRST_NS)
    assert plc.read() == (0, plc.level)


@pytest.mark.parametrize(("counter", "more"), [(0, 0), (10, 8)])
def test_when_an_answer_can_end_follows_from_the_frames(
    tmp_path: Path, counter: int, more: int
) -> None:
    """At 500 kbit/s a bit takes twice as long; a SYNC with its counter has a byte more."""
    file = tmp_path / "rig.toml"
    slow = "[segment.can1]\nbitrate = 500_000\n[cycle]\nperiod_us = 4000\ncycle_offset_us = 2000\n"
    file.write_text(f'base = "{RIG.as_posix()}"\n{slow}sync_counter = {counter}\n')
    found = terminal_telegrams(read_settings(*read_rig(file), []))
    first_ns, last_ns = 2 * (FIRST_NS + more * US), 2000 * US
    assert found == NodeTelegrams("can1", 0x180 + NODE, 4 * MS, first_ns, last_ns)


Case = tuple[list[tuple[TimeNs, bytes]], list[int]]
CASES: dict[str, Case] = {
    "one for each SYNC": ([(200_000, b"\0"), (1_200_000, b"\1")], [0, 1]),
    "two alike": ([(200_000, b"\1"), (300_000, b"\1")], [0, 1]),
    "two that differ": ([(200_000, b"\0"), (300_000, b"\1"), (1_200_000, b"\1")], [2]),
    "three of which two are alike": ([(200_000, b"\1"), (300_000, b"\0"), (400_000, b"\1")], []),
    "before and after the time of an answer": ([(98_999, b"\0"), (600_001, b"\0")], []),
    "at its ends": ([(99_000, b"\0"), (600_000, b"\0")], [0, 1]),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_what_the_judge_counts(case: str) -> None:
    telegrams, wanted = CASES[case]
    assert counting(telegrams, MS, FIRST_NS, LATEST_NS) == [telegrams[n] for n in wanted]
