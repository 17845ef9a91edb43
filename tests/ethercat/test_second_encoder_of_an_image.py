"""What the inputs of a drive on EtherCAT bring besides its state: second encoder, inputs."""

import struct
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.cia402.words import latch_object
from axisrig.kernel.drives.ethercat.image_data import ImageData
from axisrig.kernel.drives.ethercat.link import EthercatLink
from axisrig.kernel.drives.ethercat.settings import Pdo, SlaveSettings
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.drives.position_loop import LoopSettings
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import Alarm

INPUTS = (
    MappedObject(0x6041, 0, 16, False, "statusword"),
    MappedObject(0x6064, 0, 32, True, "actual"),
    MappedObject(0x60E4, 1, 32, True, "second"),
    MappedObject(0x60FD, 0, 32, False, "inputs"),
)
OUTPUTS = (
    MappedObject(0x6040, 0, 16, False, "controlword"),
    MappedObject(0x607A, 0, 32, True, "target"),
    MappedObject(0x60FF, 0, 32, True, "speed"),
)
OPERATION_ENABLED = 0x1237


class One:
    """A drive whose frames the test brings."""

    def __init__(self, **settings: Any) -> None:
        made = SlaveSettings(
            "Z", 1000.0, node_id=1, inputs=[Pdo(0x1A00, INPUTS)], outputs=[Pdo(0x1600, OUTPUTS)],
            **settings,
        )  # fmt: skip
        self.data = ImageData(made, latch_object(made.probe_input, made.edge))
        mailbox: Any = SimpleNamespace(write=self._write)
        self.written: list[tuple[int, int, bytes]] = []
        self.link = EthercatLink(made, self.data, mailbox)
        self.link.begin()

    def _write(self, index: int, sub: int, data: bytes, _done: Any) -> None:
        self.written.append((index, sub, data))

    def cycle(self, second: int = 0, inputs: int = 0, actual: int = 0) -> None:
        self.data.forget()
        self.data.arrived(struct.pack("<HiiI", OPERATION_ENABLED, actual, second, inputs))
        self.link.take()

    def miss(self) -> None:
        self.data.forget()
        self.link.take()


def test_a_second_encoder_is_as_old_as_the_cycles_since_it_has_come() -> None:
    one = One()
    assert one.link.second_increments is None
    one.miss()
    assert (one.link.second_increments, one.link.second_age_cycles) == (None, 1)
    for second in (4711, -5, 1 << 30):
        one.cycle(second)
        assert (one.link.second_increments, one.link.second_age_cycles) == (second, 0)
        for age in (1, 2):
            one.miss()
            assert (one.link.second_increments, one.link.second_age_cycles) == (second, age)


@pytest.mark.parametrize(("probe_input", "bit"), [(1, 1 << 16), (2, 1 << 17)])
@pytest.mark.parametrize("edge", ["POS", "NEG"])
def test_a_probe_is_actuated_by_its_own_input_and_the_level_of_its_edge(
    probe_input: int, bit: int, edge: str
) -> None:
    """Bits 16 and 17 of 60FD; what came last counts where a frame stays out."""
    one = One(probe_input=probe_input, edge=edge)
    assert (one.link.digital_inputs, one.link.is_actuated) == (None, None)
    for inputs, level in ((bit, True), (0x3_0007 & ~bit, False), (bit, True), (0, False)):
        one.cycle(inputs=inputs)
        assert one.link.digital_inputs == inputs
        assert one.link.is_actuated is (level is (edge == "POS"))
        one.miss()
        assert one.link.digital_inputs == inputs


def test_nothing_is_confirmed_before_anything_was_latched() -> None:
    one = One()
    one.cycle()
    one.link.arm()
    one.cycle()
    assert one.link.latched_mm is None
    assert not one.link.is_confirmed()
    assert (one.link.unproved_latches, one.link.doubt_mm) == (0, None)


@pytest.mark.parametrize("has_loop", [True, False])
def test_who_hears_no_frames_any_more_gets_its_words_by_sdo_once_it_should_stand(
    has_loop: bool,
) -> None:
    """Three frames may be missing; 60FF is written where the CNC closes the position loop."""
    loop = LoopSettings(20.0, 0.001) if has_loop else None
    one = One(loop=loop)
    one.link.order(PowerOrder.SWITCH_ON)
    one.cycle()
    one.link.send(0.0)
    for _ in range(3):
        one.miss()
        one.link.send(0.0)
    assert one.written == []
    with pytest.raises(Alarm) as caught:
        one.miss()
    assert (caught.value.id, caught.value.values["cycles"]) == (900730, 4)
    one.link.send(1.0)  # it moves yet
    assert one.written == []
    for _ in range(3):
        one.link.send(1.0)
    word = one.link.controlword.to_bytes(2, "little")
    speed = one.data.outputs[6:10]
    assert one.written == ([(0x6040, 0, word), (0x60FF, 0, speed)] if has_loop else [])
    with pytest.raises(Alarm):
        one.miss()
    one.link.send(1.0)
    assert len(one.written) == (2 if has_loop else 0)
