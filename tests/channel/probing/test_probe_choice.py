"""What #MEAS chooses for an axis, and what ends a preparation at the PLC."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import pytest

from axisrig.kernel.channel.probing.choice import ProbeChoice
from axisrig.kernel.channel.probing.ports import PlcPorts
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.measuring.rules import EXTERNAL, EXTERNAL_WITH_DRIVE, MeasuringAxis
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import ProbeSettings
from axisrig.kernel.plc.probing import LatchTask, PlcTask, ProbingUnit

BLOCK = Block(1, 10, "N10")


@dataclass
class FakeLink:
    name: str = "Z"
    probe_input: int = 1
    edge: str = "POS"
    arrival: Arrival = field(default_factory=Arrival)

    def __post_init__(self) -> None:
        self.settings = SimpleNamespace(probe_input=self.probe_input, edge=self.edge)

    def choose_latch(self, probe_input, edge):
        self.probe_input, self.edge = probe_input, edge

    def disarm(self):
        pass


def choice(**settings):
    link = FakeLink()
    axis = MeasuringAxis(**settings)
    return ProbeChoice({"Z": link}, lambda _: axis), link


def say(**settings):
    return ProbeSettings(BLOCK, "Z", **settings)


@pytest.mark.parametrize("source", ["DRIVE", EXTERNAL])
def test_what_a_command_does_not_name_stays(source):
    found, _ = choice(source=source)
    found.choose(say(probe_input=2))
    found.choose(say(edge="NEG"))
    assert found.latch("Z") == (2, "NEG")
    found.choose(say(probe_input=1))
    assert found.latch("Z") == (1, "NEG")


@pytest.mark.parametrize("source", ["DRIVE", EXTERNAL, EXTERNAL_WITH_DRIVE])
def test_the_default_brings_input_edge_and_source_of_the_list_back(source):
    found, link = choice(source=source, probe_input=1)
    found.choose(say(probe_input=2, edge="NEG", source="DRIVE"))
    found.choose_default()
    assert (found.source("Z"), found.latch("Z")) == (source, (1, "POS"))
    assert (link.probe_input, link.edge) == (1, "POS")


def test_probe_0_and_probe_1_are_inputs_of_the_list():
    found, _ = choice(probe_inputs=(2, 1))
    found.choose(say(probe=0))
    assert found.latch("Z")[0] == 2
    found.choose(say(probe=1))
    assert found.latch("Z")[0] == 1


def ports():
    links = {name: FakeLink(name) for name in ("X", "Z")}
    units = {name: SimpleNamespace(probing=ProbingUnit()) for name in links}
    plc = SimpleNamespace(task=PlcTask(), axis=units)
    found = PlcPorts(links, plc, SimpleNamespace(now_ns=0))
    return found, {name: unit.probing for name, unit in units.items()}


def test_a_preparation_that_ends_leaves_a_probe_in_use_on():
    """X is prepared, Z measures: only X is switched off."""
    made, units = ports()
    made.prepare("X", EXTERNAL, 1, "POS")
    made.choose("Z", EXTERNAL, 1, "POS").arm()
    made.forget(["X", "Z"])
    given = {name: [unit.order, *unit.waiting] for name, unit in units.items()}
    assert [order.task for order in given["X"]] == [LatchTask.PREPARE, LatchTask.DISABLE]
    assert [order.task for order in given["Z"]] == [LatchTask.ENABLE]


def test_an_axis_that_nothing_has_used_gets_no_order():
    made, units = ports()
    made.forget(["X", "Z"])
    assert [unit.number for unit in units.values()] == [0, 0]
    assert made.find("Z", EXTERNAL) is None
