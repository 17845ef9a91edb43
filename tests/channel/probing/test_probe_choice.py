"""What #MEAS chooses for an axis, and what ends a preparation at the PLC."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import pytest

from axisrig.kernel.channel.probing.choice import ProbeChoice
from axisrig.kernel.channel.probing.ports import PlcPorts
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.measuring.rules import (
    EXTERNAL,
    EXTERNAL_WITH_DRIVE,
    PLC,
    PLC_FIRST_EVENT,
    MeasuringAxis,
)
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import ProbeSettings
from axisrig.kernel.parameters.drive_types import DRIVE_TYPES
from axisrig.kernel.plc.probing import AxisWrites, LatchTask, PlcTask, ProbingUnit

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


def test_the_input_of_external_hardware_is_that_of_the_list_and_may_be_any_number():
    """Up to 255 (FCT-C4 8.2.2). The drive keeps its own, which counts when it is the source."""
    found, link = choice(source=EXTERNAL, probe_input=7)
    assert found.latch("Z") == (7, "POS")
    found.choose(say(probe_input=200))
    assert (found.latch("Z"), link.probe_input) == ((200, "POS"), 1)
    found.choose(say(source="DRIVE"))
    assert (found.latch("Z"), link.probe_input) == ((1, "POS"), 1)


@pytest.mark.parametrize("source", ["PLC", "PLC_FIRST_EVENT", "PLC_TIMESTAMP", "FIXED_STOP"])
def test_a_source_without_inputs_takes_both_numbers_that_a_drive_may_have(source):
    """#MEAS [INPUT=2 SIGNAL=..] of a program may come before the SIGNAL that uses the input."""
    found, _ = choice(source=source)
    found.choose(say(probe_input=2))
    assert found.latch("Z")[0] == 2
    with pytest.raises(Alarm, match="900227"):
        found.choose(say(probe_input=3))


@pytest.mark.provokes(70390, 7, axis="Z", drive_type="SERCOS", source="DRIVE", wrong=2, corrected=1)
def test_the_input_of_a_sercos_drive_stays():
    found, _ = choice(drive=DRIVE_TYPES[2])
    with pytest.raises(Alarm):
        found.choose(say(probe_input=2))


SOURCES = ("DRIVE", "DRIVE_TYPE_DEFAULT", EXTERNAL_WITH_DRIVE, EXTERNAL)


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_an_input_that_takes_parameters_of_the_drive_is_not_chosen(number, source):
    """TF5200 diagnosis 260985995: SERCOS; drives with one input have no other (900227)."""
    drive, of_drive = DRIVE_TYPES[number], source != EXTERNAL
    found, link = choice(source=source, drive=drive)
    found.choose(say(probe_input=1))
    has_two = number in (2, 3, 8) or source in (EXTERNAL, EXTERNAL_WITH_DRIVE)
    expected = 900227 if not has_two else 70390 if number == 2 and of_drive else None
    if expected is None:
        found.choose(say(probe_input=2))
        assert found.latch("Z")[0] == 2
        return
    with pytest.raises(Alarm) as caught:
        found.choose(say(probe_input=2))
    assert caught.value.id == expected
    assert (found.latch("Z")[0], link.probe_input) == (1, 1)


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_an_edge_that_the_drive_does_not_latch_is_not_chosen(number, source):
    """FCT-C4 6.3: an encoder terminal latches at rising edges only."""
    found, _ = choice(source=source, drive=DRIVE_TYPES[number])
    found.choose(say(edge="POS"))
    if number == 6 and source != EXTERNAL:
        with pytest.raises(Alarm) as caught:
            found.choose(say(edge="NEG"))
        assert (caught.value.id, caught.value.values["allowed"]) == (900227, "POS")
    else:
        found.choose(say(edge="NEG"))
        assert found.latch("Z")[1] == "NEG"


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


@pytest.mark.parametrize("source", [PLC, PLC_FIRST_EVENT])
@pytest.mark.parametrize("first", ["X", "Z"])
def test_the_first_event_latches_every_axis_that_waits_and_a_plain_signal_its_own(source, first):
    """FCT-C4 8.2.2: the edge of one; the other has a signal of its own, Y does not measure."""
    links = {name: FakeLink(name) for name in "XYZ"}
    for link in links.values():
        link.has_actual, link.actual_mm = True, 3.0
    units = {name: SimpleNamespace(probing=ProbingUnit()) for name in links}
    task = PlcTask(cycle_ns=1, watchdog_ns=10, acknowledge_ns=10)
    made = PlcPorts(links, SimpleNamespace(task=task, axis=units), SimpleNamespace(now_ns=0))
    found = {name: made.choose(name, source, 1, "POS") for name in links}
    found["X"].arm()
    found["Z"].arm()
    for level in (False, True):
        for name, unit in units.items():
            unit.probing.take(AxisWrites(level and name == first), 0)
        made.look()
    has_latched = {name: port.has_latched for name, port in found.items()}
    others = dict.fromkeys("XZ", source == PLC_FIRST_EVENT)
    assert has_latched == {"Y": False, **others, first: True}
