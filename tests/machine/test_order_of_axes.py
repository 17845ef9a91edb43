"""Axes in the order of the rig, whatever carries them: Z on EtherCAT, X on CAN, Y on EtherCAT."""

from collections.abc import Iterator

import pytest
from tests.machine.made_rigs import RIGS, above, settings_of

from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.machine import Machine
from axisrig.kernel.nc.text.parser import read_program

RIG = """
[segment.can1]
bitrate = 1_000_000
[axis.X]
list = "LISTS/axis-x.lst"
segment = "can1"
node = 4
drive = "servo"
plant = "x"
[axis.Y]
list = "LISTS/axis-y.lst"
segment = "ec1"
drive = "servo"
plant = "y"
[plant.x]
fmu = "AxisRig.Drives.ServoAxis"
[plant.y]
fmu = "AxisRig.Drives.ServoAxis"
"""
AXES = ["Z", "X", "Y"]
NODES = [0, 4, 0]
SEGMENTS = ["ec1", "can1", "ec1"]


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Machine]:
    folder = tmp_path_factory.mktemp("order")
    program = folder / "nothing.nc"
    program.write_text("%nothing\nN10 M30\n", encoding="utf-8")
    text = RIG.replace("LISTS", (RIGS / "lists").as_posix())
    settings = settings_of(above(folder, "probe-z-ethercat.toml", text))
    made = Machine(settings, read_program(program, tuple(AXES)))
    try:
        yield made
    finally:
        made.close()


def test_links_and_drives_of_all_carriers_are_in_the_order_of_the_rig(machine: Machine) -> None:
    assert [*machine.settings.rig.axis] == AXES
    assert [*machine.links] == [*machine.drives] == [*machine.part_of] == AXES
    assert [link.name for link in machine.channel.links] == AXES
    assert [*machine.channel.plc.axis] == AXES


def test_each_axis_has_its_own_link_and_drive(machine: Machine) -> None:
    """Those of its part, which is the one that carries its segment."""
    for name, part in machine.part_of.items():
        assert machine.links[name] is part.links[name]
        assert machine.drives[name] is part.drives[name]
        assert machine.links[name].name == name
    assert machine.part_of["Z"] is machine.part_of["Y"]
    assert machine.part_of["Z"] is not machine.part_of["X"]


def test_facts_of_axes_are_in_the_order_of_the_rig(machine: Machine) -> None:
    axes = facts_of(machine).axes
    assert [*axes] == AXES
    assert [axis.segment for axis in axes.values()] == SEGMENTS
    assert [axis.node for axis in axes.values()] == NODES


def test_columns_of_the_trace_are_in_the_order_of_the_rig(machine: Machine) -> None:
    names = machine.recorder.table().column_names
    of_axes = [name.partition(".")[0] for name in names if name.endswith(".set_mm")]
    assert of_axes == AXES
