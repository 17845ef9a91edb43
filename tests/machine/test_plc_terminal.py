"""The terminal of a PLC against edges that a test places by hand."""

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.plc.terminal import Terminal
from axisrig.bench.machine.wiring.plc import StampFault
from axisrig.bench.rig.reading.plc_task import PlcTaskTable, TerminalTable

US, MS = 1_000, 1_000_000


@dataclass
class Signal:
    """A signal with all its edges from the begin on; the terminal may only use past ones."""

    edges: list[tuple[int, bool]] = field(default_factory=list)
    level: bool = False


def _terminal(
    signal: Signal, task: dict[str, Any] | None = None, seed: int = 0, **keys: Any
) -> tuple[Terminal, list[int]]:
    advanced: list[int] = []
    table = TerminalTable(input_1="p", **keys)
    plc = PlcTaskTable(period_us=1000, program="p.py", **(task or {}))
    clock: Any = SimpleNamespace(now_ns=0)
    trouble = StampFault(clock)
    return Terminal(plc, table, {"p": signal}, advanced.append, seed, trouble), advanced


def test_level_and_stamp_come_with_the_exchange_after_the_filter() -> None:
    """Edge at 1.9 ms, filter 200 us: in the image of 3 ms, stamped 2.1 ms."""
    terminal, advanced = _terminal(Signal([(1_900_000, True)]), filter_us=200.0)
    terminal.exchange_until(2 * MS)
    assert not terminal.image[1].input
    terminal.exchange_until(3 * MS + 5)
    assert (terminal.image[1].input, terminal.image[1].latch_pos_ns) == (True, 2_100_000)
    assert advanced == [0, MS, 2 * MS, 3 * MS]


def test_a_pulse_shorter_than_the_filter_changes_nothing() -> None:
    signal = Signal([(MS, True), (MS + 100 * US, False), (3 * MS, True)])
    terminal, _ = _terminal(signal, filter_us=200.0)
    terminal.exchange_until(3 * MS)
    assert terminal.image[1].latch_pos_ns == terminal.image[1].latch_neg_ns == 0
    terminal.exchange_until(4 * MS)
    assert terminal.image[1].latch_pos_ns == 3_200_000


@pytest.mark.parametrize(
    ("which", "stamps_ns"), [("first", (2_100_000, 2_300_000)), ("last", (2_700_000, 2_800_000))]
)
def test_which_edge_of_a_cycle_keeps_its_stamp(which: str, stamps_ns: tuple[int, int]) -> None:
    """In each direction; the next cycle has its own, and keeps the others."""
    edges = [(2_100_000, True), (2_300_000, False), (2_700_000, True), (2_800_000, False)]
    terminal, _ = _terminal(Signal([*edges, (3_500_000, True)]), stamp_edge=which)
    terminal.exchange_until(3 * MS)
    assert (terminal.image[1].latch_pos_ns, terminal.image[1].latch_neg_ns) == stamps_ns
    assert not terminal.image[1].input
    terminal.exchange_until(4 * MS)
    assert (terminal.image[1].latch_pos_ns, terminal.image[1].latch_neg_ns) == (
        3_500_000,
        stamps_ns[1],
    )
    assert terminal.image[1].input


def test_a_stamp_counts_in_the_clock_of_the_terminal_and_64_bits() -> None:
    """Past the wrap of 32 bits: 5 s, 100 ppm fast and 2^40 ns ahead, in steps of 1 us."""
    terminal, _ = _terminal(
        Signal([(5_000_000_777, True)]),
        {"clock_offset_ns": 2**40, "clock_drift_ppm": 100.0},
        stamp_resolution_ns=1000,
    )
    terminal.exchange_until(5_001 * MS)
    expected_ns = 5_000_000_777 + 2**40 + 500_000
    assert terminal.image[1].latch_pos_ns == expected_ns // 1000 * 1000


def test_jitter_is_drawn_with_the_seed_and_never_early() -> None:
    def stamps(seed: int) -> list[int]:
        edges = [(n * MS + 1, n % 2 == 1) for n in range(1, 41)]
        terminal, _ = _terminal(Signal(edges), seed=seed, stamp_jitter_ns=500)
        found = []
        for n in range(1, 42):
            terminal.exchange_until(n * MS)
            found.append(terminal.image[1].latch_pos_ns % MS)
        return found

    assert stamps(1) == stamps(1) != stamps(2)
    assert 0 <= min(stamps(1)) <= max(stamps(1)) <= 501


def test_each_channel_draws_a_jitter_of_its_own() -> None:
    """The same edges at both inputs, 20 of them; the second one draws what it does alone."""
    edges = [(at * MS + 1, at % 2 == 1) for at in range(1, 21)]
    plc = PlcTaskTable(period_us=1000, program="p.py")
    clock: Any = SimpleNamespace(now_ns=0)
    stamps: dict[str, list[list[int]]] = {}
    for wired in ("12", "1", "2"):
        keys: dict[str, Any] = {f"input_{number}": f"p{number}" for number in wired}
        table = TerminalTable(stamp_jitter_ns=1000, **keys)
        signals = {name: Signal(edges) for name in keys.values()}
        made = Terminal(plc, table, signals, lambda _: None, 5, StampFault(clock))
        found = []
        for at in range(1, 21):
            made.exchange_until(at * MS + MS)
            found.append([max(image.latch_pos_ns, image.latch_neg_ns) - at * MS - 1
                          for image in made.image.values()])  # fmt: skip
        assert all(0 <= late <= 1000 for row in found for late in row)
        stamps[wired] = found
    assert [row[0] for row in stamps["12"]] == [late for (late,) in stamps["1"]]
    assert [row[1] for row in stamps["12"]] == [late for (late,) in stamps["2"]]
    assert sum(first == second for first, second in stamps["12"]) < 5


def test_a_lost_terminal_keeps_its_image_and_says_so() -> None:
    terminal, _ = _terminal(Signal([(2_500_000, True)]), silent_from_ms=2.5)
    terminal.exchange_until(2 * MS)
    assert terminal.wc_state == 0
    terminal.exchange_until(5 * MS)
    assert (terminal.wc_state, terminal.image[1].input) == (1, False)


@pytest.mark.parametrize(("silent_ms", "exchanged"), [(2.0, 2), (2.001, 3), (3.0, 3)])
def test_nothing_is_exchanged_from_the_very_instant_on(silent_ms: float, exchanged: int) -> None:
    """`silent_from_ms`: from this time of the run on nothing is exchanged; 0, 1, 2, 3 ms."""
    terminal, advanced = _terminal(Signal(), silent_from_ms=silent_ms)
    terminal.exchange_until(3 * MS)
    assert advanced == [number * MS for number in range(exchanged)]
    assert terminal.wc_state == 1


def test_own_cycle_and_offset() -> None:
    terminal, advanced = _terminal(Signal(), cycle_us=5000, offset_us=7000)
    terminal.exchange_until(13 * MS)
    assert advanced == [2 * MS, 7 * MS, 12 * MS]
