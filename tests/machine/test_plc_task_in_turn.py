"""A PLC task whose cycles and those of the CNC come in turns other than one to one."""

import random
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.cnc_beside_task import Cnc

from axisrig.bench.machine.plc.hli import Hli, Inputs
from axisrig.bench.machine.plc.terminal import ChannelInput
from axisrig.kernel.time.clock import MS, US

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


def test_what_several_cycles_of_the_plc_have_written_counts_each_variable_of_each(
    tmp_path: Path,
) -> None:
    """Five cycles of the PLC in one of the CNC: of one variable the last value counts."""
    cnc = Cnc(tmp_path, period_us=200)
    cnc.plc.values.update(dict.fromkeys("ABC", 0.0))

    def script(inputs: Inputs, hli: Hli) -> None:
        hli.ve["AABBB"[inputs.cycle % 5]] = float(inputs.cycle)

    cnc.runner.start()
    found = []
    for now_ms in (0.599, 0.7, 1.599, 1.7):
        cnc.run(now_ms, script)
        found.append(dict(cnc.plc.values))
    none, first = {"A": 0.0, "B": 0.0, "C": 0.0}, {"A": 1.0, "B": 2.0, "C": 0.0}
    # The cycle at the instant of the NC cycle itself counts in the one after it
    assert found == [none, first, first, {"A": 6.0, "B": 7.0, "C": 0.0}]


def test_of_several_cycles_of_the_plc_the_last_one_commands(tmp_path: Path) -> None:
    """At 0, 200, 400 us of each ms; feedhold in the first and second of them alone, then always."""
    cnc = Cnc(tmp_path, period_us=200)
    cnc.runner.start()

    def script(inputs: Inputs, hli: Hli) -> None:
        hli.ch.feedhold.enable_w = hli.ch.override.enable_w = True
        hli.ch.feedhold.command_w = inputs.cycle in (0, 1) or inputs.cycle > 5
        hli.ch.override.command_w = inputs.cycle

    overrides = []
    for now_ms in (1, 2, 3):
        cnc.run(now_ms, script)
        overrides.append(cnc.overrides()[0])
    assert cnc.held == ["", "P", "P"]
    assert overrides == [2, 7, 12]


@pytest.mark.parametrize("cycle", [0, 1, 2])
@pytest.mark.parametrize("name", ["reset", "start"])
def test_a_reset_and_a_start_act_in_whatever_cycle_they_come_also_the_first(
    tmp_path: Path, name: str, cycle: int
) -> None:
    """And once, as long as they stay."""
    cnc = Cnc(tmp_path)
    cnc.runner.start()
    acted: list[int] = []

    def script(inputs: Inputs, hli: Hli) -> None:
        unit = getattr(hli.ch, name)
        unit.enable_w, unit.command_w = True, inputs.cycle >= cycle

    for number in range(4):
        cnc.run(2 * number + 1, script)
        acted.append(cnc.plc.wants_reset if name == "reset" else cnc.starts)
        cnc.plc.wants_reset, cnc.starts = False, 0
    assert acted == [number == cycle for number in range(4)]


def test_a_late_cycle_at_the_instant_of_the_cnc_sees_the_one_before(tmp_path: Path) -> None:
    """By 600 us: the NC cycle of each of these instants is called before it, and does not count."""
    cnc = Cnc(tmp_path)
    cnc.fault.begin_late(600 * US, 0, random.Random(1))
    cnc.columns = lambda: setattr(cnc.links[0], "actual_mm", cnc.clock.now_ns // MS + 1.0)
    read: list[int] = []

    def script(_inputs: Inputs, hli: Hli) -> None:
        read.append(hli.ax["X"].lr_state.position_r)

    cnc.runner.start()
    cnc.run(7.0, script)
    assert cnc.cycles == [(0.6, 0), (2.6, 1), (4.6, 2), (6.6, 3)]
    assert read == [0, 20_000, 40_000, 60_000]


def test_how_far_clocks_are_off_is_asked_in_each_cycle(tmp_path: Path) -> None:
    cnc = Cnc(tmp_path)
    task: Any = cnc.plc.task
    cnc.runner.start()
    for number, off_ns in enumerate((90, 40, 200), 1):
        cnc.carriers["Z"].off_ns = off_ns
        cnc.run(number)
        assert task.clocks_off_ns == {"X": 0, "Z": off_ns}
        assert task.sync_ns == {"X": (number - 1) * MS, "Z": (number - 1) * MS - 125 * US}


def test_inputs_are_those_of_the_terminal_when_the_cycle_begins(tmp_path: Path) -> None:
    """With its working counter state; a program that asks for another channel learns which are."""
    exchanged: list[int] = []

    def exchange_until(now_ns: int) -> None:
        exchanged.append(now_ns)
        terminal.wc_state = int(now_ns == 2 * MS)
        terminal.image = {1: ChannelInput(input=now_ns >= 4 * MS, latch_pos_ns=now_ns)}

    terminal = SimpleNamespace(image={}, wc_state=0, exchange_until=exchange_until)
    cnc = Cnc(tmp_path, terminal=terminal)
    seen: list[tuple[int, bool, int]] = []

    def script(inputs: Inputs, _hli: Hli) -> None:
        assert inputs.time_ns == exchanged[-1]
        channel = inputs.channel[1]
        seen.append((inputs.wc_state, channel.input, channel.latch_pos_ns))
        with pytest.raises(KeyError):
            inputs.channel[2]

    cnc.runner.start()
    cnc.run(5.0, script)
    assert seen == [(0, False, 0), (1, False, 2 * MS), (0, True, 4 * MS)]


def test_every_observer_sees_each_cycle_after_the_program(tmp_path: Path) -> None:
    cnc = Cnc(tmp_path)
    log: list[tuple[str, int, bool]] = []

    def script(inputs: Inputs, hli: Hli) -> None:
        log.append(("program", inputs.cycle, hli.ch.reset.command_w))
        hli.ch.reset.command_w = not hli.ch.reset.command_w

    for name in ("first", "second"):
        cnc.runner.observers.append(
            lambda inputs, hli, name=name: log.append((name, inputs.cycle, hli.ch.reset.command_w))  # type: ignore[misc]
        )
    cnc.runner.start()
    cnc.run(3.0, script)
    assert log == [
        ("program", 0, False), ("first", 0, True), ("second", 0, True),
        ("program", 1, True), ("first", 1, False), ("second", 1, False),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("watchdog", "period_us", "watchdog_ns"), [(1, 500, 1_500 * US), (3, 2000, 7 * MS)]
)
def test_the_watchdog_waits_for_cycles_of_the_plc_and_one_of_the_cnc(
    tmp_path: Path, watchdog: int, period_us: int, watchdog_ns: int
) -> None:
    cnc = Cnc(tmp_path, period_us=period_us, watchdog_cycles=watchdog)
    assert cnc.plc.task is not None
    assert cnc.plc.task.watchdog_ns == watchdog_ns
