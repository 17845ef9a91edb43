"""CAN buses of a rig with virtual drives, the control and a node of the PLC, without plants."""

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.drive_node.conftest import FakeAxis, FakeSignal
from tests.machine.made_rigs import above, settings_of

from axisrig.bench.machine.canopen import family
from axisrig.bench.machine.canopen.family import CanBuses
from axisrig.bench.machine.families import Bench
from axisrig.bench.machine.recording.received import Received
from axisrig.bench.record.axes import Telegram
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS, TimeNs
from axisrig.kernel.time.scheduler import new_scheduler

pytestmark = pytest.mark.interpreted  # stand-ins for plants

NODE_RIG = "plc-io-node.toml"
RISE_NS = 30 * MS + 400_000


class Run:
    """Buses whose control sends a SYNC each ms; ended: the alarm of the start of each drive.

    sampled_ns: instants to which the node of the PLC has stepped the plants.
    """

    def __init__(self, opened: ExitStack, rig: str | Path, *changes: str) -> None:
        settings = settings_of(rig, *changes)
        self.clock, self.sampled_ns = new_scheduler(), []
        self.axes = {name: FakeAxis() for name in settings.rig.axis}
        first = next(iter(self.axes.values()))
        signals = {"probe": FakeSignal(first, (RISE_NS,))}
        beside: Any = SimpleNamespace(
            axis=self.axes.__getitem__, probes=lambda _: (None, None), switches=lambda _: {},
            signals=signals,
        )  # fmt: skip
        plant: Any = SimpleNamespace()
        self.buses = CanBuses(Bench(settings, self.clock, plant, beside, opened))
        self.terminal = self.buses.terminal(self._advance)
        self.heard = Received()
        self.buses.listen(self.heard)
        self.ended: dict[str, Alarm | None] = {}
        for name in self.buses.links:
            start = self.buses.start_up(name)
            start.begin(lambda alarm, name=name: self.ended.update({name: alarm}))

    def _advance(self, time_ns: TimeNs) -> None:
        self.sampled_ns.append(time_ns)
        for axis in self.axes.values():
            axis.advance_to(max(time_ns, axis.now_ns))

    def cycles(self, first: int, last: int) -> None:
        """Send the SYNCs of these ms, and let the answers through."""
        for cycle in range(first, last + 1):
            self.clock.run_until(cycle * MS)
            for carrier in self.buses.carriers.values():
                carrier.begin_cycle()
        self.clock.run_until(last * MS + 900_000)


@pytest.fixture
def opened() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def test_the_node_of_the_plc_samples_at_each_sync_and_what_it_sends_is_noted(
    opened: ExitStack,
) -> None:
    """The level of the plant at the SYNC: that of the edge at 30.4 ms in the SYNC of 31 ms."""
    run = Run(opened, NODE_RIG)
    run.cycles(1, 33)
    assert run.ended == {"Z": None}
    terminal = run.terminal
    assert terminal is not None
    assert (terminal.wc_state, terminal.image[1].input) == (0, True)
    noted = {at_ns // MS: data for at_ns, data in run.heard.inputs}
    assert list(noted) == list(range(min(noted), 34))
    assert [cycle for cycle, data in noted.items() if data == b"\1"] == [31, 32, 33]
    # In operation nothing is on the bus before a SYNC: its end, with stuff bits
    sampled = [divmod(at_ns, MS) for at_ns in run.sampled_ns if at_ns > 20 * MS]
    assert [cycle for cycle, _ in sampled] == list(range(20, 34))
    assert all(44_000 <= late_ns <= 55_000 for _, late_ns in sampled)
    assert run.heard.inputs_first_ns == (44 + 3 + 44 + 8) * 1000


@pytest.mark.parametrize("silent_ms", [None, 25])
def test_a_node_that_falls_silent_sends_nothing_from_then_on_and_is_lost(
    opened: ExitStack, silent_ms: int | None
) -> None:
    """`missing_cycles` is 3: the fourth SYNC without its telegram is one too many."""
    changes = () if silent_ms is None else (f"plc:terminal.silent_from_ms={silent_ms}",)
    run = Run(opened, NODE_RIG, *changes)
    assert run.terminal is not None
    run.cycles(1, 24)
    states = []
    for cycle in range(25, 31):
        run.cycles(cycle, cycle)
        states.append(run.terminal.wc_state)
    last = max(at_ns // MS for at_ns, _ in run.heard.inputs)
    assert (last, states) == ((30, 6 * [0]) if silent_ms is None else (24, [0, 0, 0, 1, 1, 1]))


@pytest.mark.parametrize("is_controlled", [True, False])
def test_cyclic_values_of_an_axis_are_noted_where_its_distance_control_is_released(
    opened: ExitStack, is_controlled: bool
) -> None:
    """P-AXIS-00328: 607A and 6064 of each cycle; else the telegrams of the node alone."""
    changes = () if is_controlled else ("set:Z.lr_param.distance_control_on=0",)
    run = Run(opened, "distance-z-2ms.toml", *changes)
    run.cycles(2, 12)
    columns = run.buses.take_columns(np.array([20 * MS]), is_last=True)
    named = {name.split(".")[0] for name in columns}
    assert named == ({"Z"} if is_controlled else set())


def test_the_telegrams_of_an_axis_have_their_own_transmissions_and_fields() -> None:
    """In their order; 255 is sent on change, 1 with each SYNC."""
    mapped = {name: SimpleNamespace(field=name) for name in ("target", "actual", "inputs", "")}

    def telegram(name: str, transmission: int, *fields: str) -> Any:
        objects = [mapped[one] for one in fields]
        return SimpleNamespace(name=name, transmission=transmission, objects=objects)

    part: Any = CanBuses.__new__(CanBuses)
    of = {
        "X": [telegram("RPDO1", 1, "target", ""), telegram("TPDO3", 255, "inputs")],
        "Y": [telegram("TPDO1", 3, "actual")],
    }
    part.links = {
        axis: SimpleNamespace(telegrams={one.name: one for one in found})
        for axis, found in of.items()
    }
    assert part.telegrams("X") == [
        Telegram("RPDO1", 1, ("target", "")), Telegram("TPDO3", 255, ("inputs",))
    ]  # fmt: skip
    assert part.telegrams("Y") == [Telegram("TPDO1", 3, ("actual",))]


@pytest.mark.parametrize("letting", ["", "Y", "XZ", "ZYX"])
def test_drives_that_are_let_go_are_led_to_pre_operational_and_the_others_stay(
    letting: str,
) -> None:
    """NMT command 128 with the number of each drive, on its own bus (CiA 301)."""
    sent: list[tuple[str, int, bytes]] = []

    def network(name: str) -> Any:
        return SimpleNamespace(send_message=lambda can_id, data: sent.append((name, can_id, data)))

    part: Any = CanBuses.__new__(CanBuses)
    part.links = {
        axis: SimpleNamespace(node_id=node, network=network(bus))
        for axis, node, bus in (("X", 5, "one"), ("Y", 5, "two"), ("Z", 7, "one"))
    }
    part.let_go(list(letting))
    of = {"X": ("one", 5), "Y": ("two", 5), "Z": ("one", 7)}
    assert sent == [(of[a][0], 0x000, bytes((128, of[a][1]))) for a in letting]


def test_a_bus_that_is_lost_is_an_alarm_once_and_each_other_one_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """900071 with its name and reason; one that is simulated is never lost."""

    class Outside(SimpleNamespace):
        """A bus at a real interface."""

    monkeypatch.setattr(family, "OutsideSegment", Outside)
    part: Any = CanBuses.__new__(CanBuses)
    part._lost = set()
    part.segments = {
        "one": Outside(lost=""), "two": SimpleNamespace(lost="no"), "three": Outside(lost=""),
    }  # fmt: skip
    found = []
    for name, reason in (("", ""), ("three", "unplugged"), ("one", "silent"), ("", "")):
        if name:
            part.segments[name].lost = reason
        found.append([(alarm.id, alarm.values) for alarm in part.look()])
    assert found == [
        [], [(900071, {"segment": "three", "reason": "unplugged"})],
        [(900071, {"segment": "one", "reason": "silent"})], [],
    ]  # fmt: skip


def test_the_heartbeat_of_the_control_is_on_each_bus_that_carries_a_sync(
    opened: ExitStack, tmp_path: Path
) -> None:
    """CiA 301: 700 and its number, state operational; of three buses with a drive each."""
    cycle = "[cycle]\nperiod_us = 1000\nheartbeat_ms = 5\nmaster_node = 101"
    run = Run(opened, above(tmp_path, "probe-xyz.toml", cycle))
    heard: dict[str, list[bytes]] = {name: [] for name in run.buses.segments}
    for name, segment in run.buses.segments.items():
        segment.port("ear").attach_data(
            lambda can_id, data, _time, name=name: (
                heard[name].append(bytes(data)) if can_id == 0x700 + 101 else None
            )
        )
    run.buses.presence().begin()
    run.clock.run_until(12 * MS)
    assert list(heard) == ["can1", "can2", "can3"]
    for data in heard.values():
        assert len(data) >= 2
        assert set(data[1:]) == {b"\5"}
