"""Choices of one axis leave those of others, and a new run those before it."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.probing.test_probe_choice import FakeLink
from tests.channel.test_simulated_probes_by_hand import HERE_MM, STRAIGHT, bench, run

from axisrig.kernel.channel.probing.choice import ProbeChoice
from axisrig.kernel.channel.probing.ports import PlcPorts
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.rules import EXTERNAL, PLC, MeasuringAxis
from axisrig.kernel.measuring.simulated import CYCLES
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import ProbeSettings
from axisrig.kernel.plc.probing import LatchTask, ProbingUnit

BLOCK = Block(1, 10, "N10")
AXES = ("X", "Y", "Z")


def _choice(**more: Any) -> tuple[ProbeChoice, dict[str, Any]]:
    links: dict[str, Any] = {name: FakeLink(name) for name in AXES}
    return ProbeChoice(links, lambda _: MeasuringAxis(**more)), links


def test_each_axis_has_the_source_the_input_and_the_edge_that_were_chosen_for_it() -> None:
    found, links = _choice()
    found.choose(ProbeSettings(BLOCK, "X", source=PLC))
    found.choose(ProbeSettings(BLOCK, "Y", probe_input=2, edge="NEG"))
    found.choose(ProbeSettings(BLOCK, "Z", source=EXTERNAL))
    assert [found.source(axis) for axis in AXES] == [PLC, "DRIVE", EXTERNAL]
    assert [found.needs_plc(axis) for axis in AXES] == [True, False, True]
    assert [found.latch(axis) for axis in AXES] == [(1, "POS"), (2, "NEG"), (1, "POS")]
    assert (links["Y"].probe_input, links["X"].probe_input) == (2, 1)
    found.choose_default()
    assert [found.source(axis) for axis in AXES] == ["DRIVE"] * 3
    assert [found.latch(axis) for axis in AXES] == [(1, "POS")] * 3
    assert [link.probe_input for link in links.values()] == [1] * 3


@pytest.mark.parametrize(("probe", "number"), [(0, 1), (1, 2)])
def test_a_probe_is_the_input_that_the_list_gives_it(probe: int, number: int) -> None:
    """P-AXIS-00583: INPUT=PROBE0 and PROBE1."""
    found, links = _choice(probe_inputs=(1, 2))
    found.choose(ProbeSettings(BLOCK, "Y", probe=probe))
    assert found.latch("Y") == (number, "POS")
    assert [links[axis].probe_input for axis in AXES] == [1, number, 1]
    assert found.latch("X") == (1, "POS")


def _ports(task: Any) -> tuple[PlcPorts, dict[str, ProbingUnit]]:
    units = {name: ProbingUnit() for name in AXES}
    plc: Any = SimpleNamespace(
        task=task, axis={name: SimpleNamespace(probing=unit) for name, unit in units.items()}
    )
    clock: Any = SimpleNamespace(now_ns=0)
    links: Any = {name: FakeLink(name) for name in AXES}
    return PlcPorts(links, plc, clock), units


@pytest.mark.parametrize("edge", ["POS", "NEG"])
def test_the_hardware_of_a_probe_gets_input_and_edge_of_its_own_axis(edge: str) -> None:
    ports, units = _ports(SimpleNamespace())
    ports.prepare("Z", EXTERNAL, 7, edge)
    ports.prepare("X", EXTERNAL, 200, "POS")
    orders = {axis: units[axis].order for axis in AXES}
    assert [orders[axis].task for axis in AXES] == [
        LatchTask.PREPARE, LatchTask.NONE, LatchTask.PREPARE,
    ]  # fmt: skip
    assert (orders["Z"].probe_input, orders["Z"].edge) == (7, edge)
    assert (orders["X"].probe_input, orders["X"].edge) == (200, "POS")
    ports.forget(("X",))
    assert [len(units[axis].waiting) for axis in AXES] == [1, 0, 0]


@pytest.mark.parametrize("source", [PLC, EXTERNAL])
def test_a_rig_without_a_task_has_none_for_any_axis(source: str) -> None:
    ports, _ = _ports(None)
    with pytest.raises(Alarm) as caught:
        ports.choose("Y", source, 1, "POS")
    assert (caught.value.id, caught.value.values) == (900400, {"axis": "Y", "source": source})
    assert ports.find("Y", source) is None


def test_probes_of_a_run_that_is_over_latch_nothing_in_the_next_one() -> None:
    """X signals in the third cycle of its run, which ends before; Z in the second of the next."""
    lists = {"X": (CYCLES, 3, 0, 0, 0), "Y": (0, 0, 0, 0, 0), "Z": (CYCLES, 2, 0, 0, 0)}
    probes, _, _ = bench(lists, STRAIGHT)
    first = probes.make(run("X"))
    first["X"].arm()
    probes.look()
    second = probes.make(run("Z"))
    second["Z"].arm()
    for _ in range(4):
        probes.look()
    assert first["X"].latched_mm is None
    assert second["Z"].latched_mm == HERE_MM["Z"] + 100.0  # as the axis shows it
