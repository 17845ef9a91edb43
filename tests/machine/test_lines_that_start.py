"""An EtherCAT line of a rig with virtual slaves and its master, started without plants.

What goes over the wire is read from its frames: a datagram is command, index, address, length and
more (ETG.1000.4), FRMW is 14, and a cyclic frame has an index of 0x80 and more.
"""

import struct
from types import SimpleNamespace
from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis, FakeSignal
from tests.machine.made_rigs import settings_of

from axisrig.bench.bus.journal import Entry, Journal
from axisrig.bench.machine.ethercat.line import Line
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, TimeNs
from axisrig.kernel.time.scheduler import new_scheduler

pytestmark = pytest.mark.interpreted  # stand-ins for plants

TERMINAL_RIG, AXES_RIG = "plc-timestamp-line.toml", "probe-xyz-ethercat.toml"
FPWR, FRMW = 5, 14
ACTIVATION = 0x981
RISE_NS, FALL_NS = 60 * MS, 63 * MS


def datagrams(frame: bytes) -> list[tuple[int, int, bytes]]:
    """Command, register and data of each datagram."""
    at, found, more = 16, [], 1
    while more:
        command, _, _, register, word = struct.unpack_from("<BBHHH", frame, at)
        size, more = word & 0x7FF, word & 0x8000
        found.append((command, register, frame[at + 10 : at + 10 + size]))
        at += 12 + size
    return found


class Run:
    """A line that is started from 0 on; ended: the alarm of each drive, None: it is in operation.

    states: of the drives, as they enter them.
    """

    def __init__(self, rig: str, *changes: str) -> None:
        settings = settings_of(rig, *changes)
        self.clock, journal = new_scheduler(), Journal(1)
        axes = {name: FakeAxis() for name in settings.rig.axis}
        task, signals = settings.rig.plc_task, {}
        if task is not None and task.terminal is not None:
            signal = FakeSignal(next(iter(axes.values())), (RISE_NS, FALL_NS))
            signals = dict.fromkeys(task.terminal.inputs.values(), signal)
        beside: Any = SimpleNamespace(
            axis=axes.__getitem__, probes=lambda _: (None, None), switches=lambda _: {},
            signals=signals,
        )  # fmt: skip

        def advance(time_ns: TimeNs) -> None:
            for axis in axes.values():
                axis.advance_to(max(time_ns, axis.now_ns))

        self.states: list[tuple[str, State]] = []
        self.entries: list[Entry] = []
        journal.add(self.entries.extend)
        self.line = Line(
            settings, "ec1", self.clock, journal, beside, advance, 0,
            lambda *entered: self.states.append(entered),
        )  # fmt: skip
        self.ended: dict[str, Alarm | None] = {}
        for number, name in enumerate(self.line.axes):
            self.line.start.begin(number, lambda alarm, name=name: self.ended.update({name: alarm}))
        self.clock.run_while(lambda: len(self.ended) < len(self.line.axes), 1000 * MS)

    def commands(self, *, is_cyclic: bool) -> list[int]:
        """Commands of all datagrams of such frames."""
        frames = [frame for _, _, frame, _ in self.entries if (frame[17] >= 0x80) is is_cyclic]
        assert frames
        return [command for frame in frames for command, _, _ in datagrams(frame)]

    def apart_ns(self) -> int:
        """How far the clock of the terminal is ahead of that of the drive now."""
        (drive,), terminal = self.line.nodes.values(), self.line.slaves["terminal"]
        now_ns = self.clock.now_ns
        return terminal.time.system_ns(now_ns) - drive.time.system_ns(now_ns)


OF_CLOCKS: dict[str, tuple[bool, bool]] = {
    "dc=true": (True, True),
    "drift_compensation=false": (False, True),
    "dc=false": (False, False),
}
"""Whether the time is handed on, and whether SYNC0 runs."""


@pytest.mark.parametrize("key", OF_CLOCKS)
def test_the_time_is_handed_on_where_drift_is_compensated_in_the_start_and_in_each_cycle(
    key: str,
) -> None:
    hands_on, has_sync = OF_CLOCKS[key]
    run = Run("probe-z-ethercat.toml", f"bus:ec1.{key}")
    run.clock.run_until(run.clock.now_ns + 5 * MS)
    assert run.ended == {"Z": None}
    cycles = run.line.master.frames
    assert cycles > 5
    assert run.commands(is_cyclic=True).count(FRMW) == (cycles if hands_on else 0)
    assert (FRMW in run.commands(is_cyclic=False)) is hands_on
    written = [each for _, _, frame, _ in run.entries for each in datagrams(frame)]
    assert ((FPWR, ACTIVATION, b"\3") in written) is has_sync
    assert run.line.nodes["Z"].states.state == 8
    assert run.states[-1] == ("Z", State.SWITCH_ON_DISABLED)


@pytest.mark.parametrize("ppm", [100, -40])
def test_a_clock_that_gets_no_time_drifts_away_from_the_first_and_one_that_does_follows(
    ppm: int,
) -> None:
    drift = f"bus:ec1.drift_ppm=terminal={ppm}"
    free = Run(TERMINAL_RIG, drift, "bus:ec1.drift_compensation=false")
    assert free.ended == {"Z": None}
    before_ns = free.apart_ns()
    free.clock.run_until(free.clock.now_ns + 20 * MS)
    assert free.apart_ns() - before_ns == pytest.approx(ppm * 20, abs=1)  # ppm of 1e6 ns and 1 ns
    led = Run(TERMINAL_RIG, drift)
    limit_ns = led.line.master.line.clock_limit_ns
    for _ in range(3):
        led.clock.run_until(led.clock.now_ns + 5 * MS)
        assert abs(led.apart_ns()) <= limit_ns


@pytest.mark.parametrize(
    ("is_compensated", "delays_ns"), [("true", [0, 12_700, 12_700 + 720]), ("false", [0, 0, 0])]
)
def test_each_clock_is_later_by_the_wires_and_slaves_before_it(
    is_compensated: str, delays_ns: list[int]
) -> None:
    """Half of the way there and back is measured, or no delay is written.

    From X to Y: X takes 500 ns on the way there, Y 900 ns on the way back, and the wire 12 us each
    way. From Y to Z: 900, 40 and twice 250 ns.
    """
    run = Run(
        AXES_RIG, "bus:ec1.wire_ns=X=700 Y=12000 Z=250", "bus:ec1.slave_ns=X=500 Y=900 Z=40",
        f"bus:ec1.delay_compensation={is_compensated}",
    )  # fmt: skip
    assert run.ended == dict.fromkeys("XYZ")
    found = [run.line.nodes[name].time.delay for name in "XYZ"]
    assert found == pytest.approx(delays_ns, abs=2)  # measured by clocks that show whole ns


def test_the_terminal_is_the_last_slave_and_brings_levels_and_stamps() -> None:
    run = Run(TERMINAL_RIG)
    assert run.ended == {"Z": None}
    assert list(run.line.slaves) == ["Z", "terminal"]
    terminal = run.line.terminal
    assert terminal is not None
    limit_ns = run.line.master.line.clock_limit_ns
    found = {}
    for at_ns in (RISE_NS - MS, RISE_NS + 2 * MS, FALL_NS + 2 * MS):
        run.clock.run_until(at_ns)
        found[at_ns] = terminal.image[1]
        assert terminal.wc_state == 0
    before, high, low = found.values()
    assert (before.input, high.input, low.input) == (False, True, False)
    assert (before.latch_pos_ns, before.latch_neg_ns, high.latch_neg_ns) == (0, 0, 0)
    assert high.latch_pos_ns == low.latch_pos_ns == pytest.approx(RISE_NS, abs=limit_ns)
    assert low.latch_neg_ns == pytest.approx(FALL_NS, abs=limit_ns)


def test_a_terminal_without_power_is_lost_once_its_cycles_are_over() -> None:
    """`missing_cycles` of its rig and one more, of the period of the rig."""
    run = Run(TERMINAL_RIG, "plc:terminal.missing_cycles=2")
    terminal = run.line.terminal
    assert terminal is not None
    period_ns = run.line.master.line.period_ns
    run.clock.run_until(40 * period_ns + period_ns // 2)
    assert terminal.wc_state == 0
    terminal.slave.power_off()
    states = []
    for cycles in range(1, 6):
        run.clock.run_until((40 + cycles) * period_ns + period_ns // 2)
        states.append(terminal.wc_state)
    assert states == [0, 0, 1, 1, 1]  # the third without its inputs is one too many
