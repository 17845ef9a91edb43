"""Which identifier a fault of frames acts on: of the rig's own mapping, of the set of CiA 301."""

import random
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.machine.faults.acts import Injected
from axisrig.bench.machine.faults.frames import OnCan
from axisrig.bench.machine.faults.injection import ON_CAN
from axisrig.bench.rig.reading.faults import read_faults
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import read_settings
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
OWN = """pdo,transmission,inhibit_100us,index,sub,bits,signed,field,note,cob_id
RPDO1,1,0,0x6040,0,16,no,controlword,,0x2A0
RPDO1,1,0,0x607A,0,32,yes,target,,
RPDO1,1,0,0x60B8,0,16,no,probe_function,,
TPDO1,1,0,0x6041,0,16,no,statusword,,
TPDO1,1,0,0x6064,0,32,yes,actual,,
TPDO1,1,0,0x60B9,0,16,no,probe_status,,
TPDO2,1,0,0x60BA,0,32,yes,latch,,0x1F5
"""


@pytest.fixture(scope="module")
def on_can(tmp_path_factory: pytest.TempPathFactory) -> OnCan:
    """X of node 1 on can1 with a mapping of its own, Y, 2, on can2 and Z, 3, on can3; a terminal of
    node 20 on can1."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "own.csv").write_text(OWN, "utf-8")
    (folder / "plc.py").write_text("", "utf-8")
    (folder / "rig.toml").write_text(
        f'base = "{(RIGS / "probe-xyz.toml").as_posix()}"\n'
        '[drive.other]\npdo_map = "own.csv"\n[axis.X]\ndrive = "other"\n'
        '[plc]\nperiod_us = 2000\nprogram = "plc.py"\n'
        '[plc.terminal]\nsegment = "can1"\nnode = 20\n',
        "utf-8",
    )
    settings = read_settings(*read_rig(folder / "rig.toml"), [])
    segments: Any = {name: SimpleNamespace() for name in settings.segment}
    clock: Any = SimpleNamespace()
    return OnCan(settings, clock, segments, {})


@pytest.mark.parametrize(
    ("kind", "target", "can_id"),
    [
        ("drop", "X.TPDO1", 0x181), ("drop", "X.TPDO2", 0x1F5), ("drop", "X.RPDO1", 0x2A0),
        ("drop", "Y.TPDO2", 0x282), ("drop", "Z.RPDO1", 0x203),
        ("drop", "X.TPDO4", 0x481),  # not mapped: the one that it would have
        ("drop", "Y.SDO", 0x582), ("drop", "Z.EMCY", 0x083), ("delay", "Y.HEARTBEAT", 0x702),
        ("drop", "can1.SYNC", 0x080), ("drop", "can1.NMT", 0x000),
        ("drop", "terminal.TPDO1", 0x194), ("drop", "terminal.SDO", 0x594),
        ("drop", "terminal.HEARTBEAT", 0x714),
        ("sync_loss", "Y", 0x080), ("sync_jitter", "can1", 0x080), ("slow_sdo", "Z", 0x583),
        ("heartbeat_loss", "X", 0x701),
    ],
)  # fmt: skip
def test_a_fault_acts_on_the_identifier_that_its_telegram_has(
    on_can: OnCan, kind: str, target: str, can_id: int
) -> None:
    """Bases of the pre-defined connection set (CiA 301 table 39) and the node."""
    keys = {"delay": "by=1ms", "sync_jitter": "jitter=1ms", "slow_sdo": "by=1ms"}.get(kind, "")
    (fault,) = read_faults(kind, f"{target} {keys}".strip(), on_can.settings.rig)
    assert on_can.cob_id(fault) == can_id
    segment = {"Y": "can2", "Z": "can3"}.get(target[0], "can1")
    assert on_can.segment(fault) is on_can.segments[segment]


@pytest.mark.interpreted
@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
@pytest.mark.parametrize("kind", ["cable_off", "bus_off"])
def test_the_controller_that_goes_is_that_of_the_named_drive_on_its_segment(
    on_can: OnCan, kind: str, axis: str
) -> None:
    """Ports of other drives and of the control stay; after it the port is there again."""
    clock = new_scheduler()
    with Segment("can1", 1_000_000, clock) as one, Segment("can2", 1_000_000, clock) as two:
        segments = {"can1": one, "can2": two, "can3": two}
        ports = {
            (name, port): segment.port(port)
            for name, segment in (("can1", one), ("can2", two))
            for port in ("cnc", "Z", "X", "Y")
        }
        (fault,) = read_faults(kind, f"{axis} for=3ms", on_can.settings.rig)
        on: OnCan = replace(on_can, clock=clock, segments=segments)
        act = ON_CAN[kind](on, fault, random.Random(1), Injected(kind, axis))
        gone = ("can1" if axis == "X" else "can2", axis)
        assert [key for key, port in ports.items() if not port.takes_part] == []
        act.begin()
        clock.run_until(2 * MS)
        assert [key for key, port in ports.items() if not port.takes_part] == [gone]
        act.end()
        clock.run_until(3 * MS)
        assert [key for key, port in ports.items() if not port.takes_part] == []
        assert (ports[gone].tec, ports[gone].rec) == (0, 0)


@pytest.mark.interpreted
@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
def test_without_a_time_a_controller_that_is_bus_off_recovers_as_its_bus_lets_it(
    on_can: OnCan, axis: str
) -> None:
    """128 times 11 recessive bits at 1 Mbit/s, 1.408 ms; not where the bus has no recovery."""
    for recovers in (True, False):
        clock = new_scheduler()
        with Segment("can1", 1_000_000, clock, automatic_recovery=recovers) as segment:
            port, other = segment.port(axis), segment.port("cnc")
            segments = dict.fromkeys(on_can.settings.segment, segment)
            (fault,) = read_faults("bus_off", axis, on_can.settings.rig)
            on: OnCan = replace(on_can, clock=clock, segments=segments)
            ON_CAN["bus_off"](on, fault, random.Random(1), Injected("bus_off", axis)).begin()
            clock.run_until(1_407_999)
            assert (port.takes_part, other.takes_part) == (False, True)
            clock.run_until(1_408_000)
            assert port.takes_part is recovers
