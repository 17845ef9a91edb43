"""What the start-up of the control leaves in 1C12, 1C13 and the mappings of a drive in PREOP.

The drive is the virtual one with the order of ETG.1000.6: an assignment changes while its
sub-index 0 is 0, and a mapping while no assignment has its PDO.
"""

from typing import Any

import pytest
from tests.ethercat.line import Line

from axisrig.kernel.drives.cia402.objects import SdoError
from axisrig.kernel.drives.ethercat.coe_start import CoeSteps
from axisrig.kernel.drives.ethercat.settings import Pdo, SlaveSettings
from axisrig.kernel.drives.ethercat.steps import ReadObject, WriteObject
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.errors import Alarm

CONTROL, TARGET, PROBE = 0x60400010, 0x607A0020, 0x60B80010
STATUS, PLACE = 0x60410010, 0x60640020
SPEED, TORQUE = 0x60FF0020, 0x60710010


def pdo(index: int, *entries: int) -> Pdo:
    objects = [MappedObject(e >> 16, e >> 8 & 0xFF, e & 0xFF, False, "") for e in entries]
    return Pdo(index, tuple(objects))


INPUTS = (pdo(0x1A00, STATUS, PLACE),)


class Started:
    """A drive in PREOP with lists of its own, and what a start-up makes of them."""

    def __init__(self, *, outputs: list[int], inputs: list[int]) -> None:
        self.line = Line()
        self.line.preop()
        self.writes = 0
        for index, entries in ((0x1C12, outputs), (0x1C13, inputs)):
            self.line.sdo_write(index, 0, 0, 1)
            for sub, entry in enumerate(entries, 1):
                assert self.line.sdo_write(index, sub, entry, 2) == 0
            assert self.line.sdo_write(index, 0, len(entries), 1) == 0

    def run(
        self,
        *outputs: Pdo,
        objects: Alarm | None = None,
        lacks: tuple[int, int] | None = None,
    ) -> None:
        settings = SlaveSettings(axis="Z", node_id=1, increments_per_mm=1.0, lag_delay_cycles=0,
                                 outputs=outputs, inputs=INPUTS)  # fmt: skip
        start_up: Any = type("Objects", (), {"begin": lambda _, ended: ended(objects)})()
        access: Any = None
        steps = CoeSteps(settings, access, start_up).in_preop()
        answer: Any = None
        while True:
            try:
                step = steps.send(answer)
            except StopIteration:
                return
            if isinstance(step, ReadObject):
                answer = (
                    SdoError(step.index, step.sub, 0x06090011)
                    if (step.index, step.sub) == lacks
                    else self.line.sdo_read(step.index, step.sub)
                )
            else:
                assert isinstance(step, WriteObject)
                self.writes += 1
                if step.index not in (0x1C12, 0x1C13):  # a mapping: nothing has it meanwhile
                    of = 0x1C12 if step.index < 0x1A00 else 0x1C13
                    assert self.line.sdo_read(of, 0) == b"\0"
                value, size = int.from_bytes(step.data, "little"), len(step.data)
                code = self.line.sdo_write(step.index, step.sub, value, size)
                answer = SdoError(step.index, step.sub, code) if code else b""

    def listed(self, index: int) -> list[int]:
        return [
            int.from_bytes(self.line.sdo_read(index, sub), "little")
            for sub in range(1, self.line.sdo_read(index, 0)[0] + 1)
        ]


@pytest.mark.parametrize(
    "there", [[0x1601], [0x1600, 0x1601], []], ids=["another", "one more", "none"]
)
def test_the_drive_has_the_pdos_of_the_rig_and_no_other(there: list[int]) -> None:
    """Also where as many are assigned, and where those of the rig are mapped as wanted."""
    started = Started(outputs=there, inputs=[0x1A00])
    started.run(pdo(0x1600, CONTROL, TARGET, PROBE))
    assert started.listed(0x1C12) == [0x1600]
    assert started.listed(0x1600) == [CONTROL, TARGET, PROBE]
    assert started.listed(0x1C13) == [0x1A00]
    assert started.listed(0x1A00) == [STATUS, PLACE]


def test_two_pdos_come_in_the_order_of_the_rig() -> None:
    started = Started(outputs=[0x1600, 0x1601], inputs=[0x1A00])
    started.run(pdo(0x1601, TORQUE, SPEED), pdo(0x1600, CONTROL, TARGET, PROBE))
    assert started.listed(0x1C12) == [0x1601, 0x1600]
    assert started.listed(0x1601) == [TORQUE, SPEED]
    assert started.listed(0x1600) == [CONTROL, TARGET, PROBE]


def test_two_pdos_that_carry_something_else_are_both_written() -> None:
    started = Started(outputs=[0x1600, 0x1601], inputs=[0x1A00])
    for first, second in (([CONTROL], [TARGET, SPEED]), ([CONTROL, TORQUE], [SPEED])):
        started.run(pdo(0x1600, *first), pdo(0x1601, *second))
        assert (started.listed(0x1600), started.listed(0x1601)) == (first, second)
        assert started.listed(0x1C12) == [0x1600, 0x1601]


def test_nothing_is_written_to_a_drive_that_has_it_all() -> None:
    """A drive with fixed PDOs would refuse it."""
    started = Started(outputs=[0x1600], inputs=[0x1A00])
    started.run(pdo(0x1600, CONTROL, TARGET, PROBE))
    before = started.writes
    assert before > 0  # the mapping of 1A00 is another at first
    started.run(pdo(0x1600, CONTROL, TARGET, PROBE))
    assert started.writes == before


def test_a_list_counts_by_its_own_bits_whatever_is_behind_them() -> None:
    """An answer without its size has four bytes (CiA 301): an assignment takes two of them."""
    listed = {(0x1C12, 0): 1, (0x1C12, 1): 0x1600, (0x1C13, 0): 1, (0x1C13, 1): 0x1A00,
              (0x1600, 0): 2, (0x1600, 1): CONTROL, (0x1600, 2): TARGET,
              (0x1A00, 0): 2, (0x1A00, 1): STATUS, (0x1A00, 2): PLACE}  # fmt: skip
    settings = SlaveSettings(axis="Z", node_id=1, increments_per_mm=1.0, lag_delay_cycles=0,
                             outputs=[pdo(0x1600, CONTROL, TARGET)], inputs=INPUTS)  # fmt: skip
    start_up: Any = type("Objects", (), {"begin": lambda _, ended: ended(None)})()
    access: Any = None
    steps, answer, asked = CoeSteps(settings, access, start_up).in_preop(), None, 0
    while True:
        try:
            step = steps.send(answer)
        except StopIteration:
            break
        assert isinstance(step, ReadObject), step  # it has it all: nothing is written
        value, asked = listed[step.index, step.sub], asked + 1
        is_assigned = step.index in (0x1C12, 0x1C13) and step.sub > 0
        answer = (value | 0xBEEF_0000 if is_assigned else value).to_bytes(4, "little")
    assert asked == len(listed)


def test_what_the_drive_refuses_is_named_with_its_value() -> None:
    started = Started(outputs=[0x1600], inputs=[0x1A00])
    with pytest.raises(Alarm) as raised:
        started.run(pdo(0x1600, CONTROL, STATUS))
    assert (raised.value.id, raised.value.values["axis"]) == (900011, "Z")
    assert raised.value.values["step"] == "PDOs: 0x1600:2 = 0x60410010"


@pytest.mark.parametrize(
    ("lacks", "name"),
    [((0x1C12, 0), "0x1C12:0"), ((0x1600, 2), "0x1600:2"), ((0x1C13, 1), "0x1C13:1")],
)
def test_what_cannot_be_read_is_named_and_nothing_is_written(
    lacks: tuple[int, int], name: str
) -> None:
    started = Started(outputs=[0x1600], inputs=[0x1A00])
    with pytest.raises(Alarm) as raised:
        started.run(pdo(0x1600, CONTROL, TARGET, PROBE), objects=None, lacks=lacks)
    values = raised.value.values
    assert (raised.value.id, values["axis"], values["node"]) == (900011, "Z", 1)
    assert values["step"] == f"the reading of {name}"
    assert values["answer"] == str(SdoError(*lacks, 0x06090011))
    assert started.writes == 0


def test_after_an_object_that_is_refused_no_pdo_is_written() -> None:
    started = Started(outputs=[0x1601], inputs=[0x1A00])
    refused = Alarm(900011, axis="Z", node=1, step="6060", answer="no")
    with pytest.raises(Alarm) as raised:
        started.run(pdo(0x1600, CONTROL, TARGET), objects=refused)
    assert raised.value is refused
    assert started.writes == 0
