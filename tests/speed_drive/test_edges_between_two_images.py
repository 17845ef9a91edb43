"""Edges of drives that only take a speed: between sample and image, both, and their values."""

import pytest
from tests.drive_node.conftest import FakeAxis, FakeSignal
from tests.speed_drive.ends import FAMILIES

from axisrig.bench.drive.speed_drive.node import SpeedDriveNode
from axisrig.kernel.profiles.conventional import words as of_card
from axisrig.kernel.profiles.encoder_terminal import words as of_terminal
from axisrig.kernel.profiles.lightbus import words as of_lightbus
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

V_M_S = 0.04
BOTH = of_card.ENABLE["POS"] | of_card.ENABLE["NEG"]


class Probed:
    """A drive whose axis goes 40 mm/s, with these edges of its probe."""

    def __init__(self, family: str, *edges_ns: int, starts_high: bool = False) -> None:
        made = FAMILIES[family]
        self.clock, axis = new_scheduler(), FakeAxis(motion=lambda time_s: V_M_S * time_s)
        self.per_ms = V_M_S * float(made.table.per_mm)
        self.to_drive, self.from_drive = made.images
        self.node = SpeedDriveNode(
            "Z", self.clock, axis, (FakeSignal(axis, edges_ns, starts_high), None),
            made.table.make(), made.images, made.unit(),
        )  # fmt: skip
        self.delay_ns = made.table.make().drive.input_delay_ns
        self.clock.run_until(0)

    def cycle(self, after_ns: int = 0, **values: int) -> dict[str, int]:
        """Sample each millisecond; the image is taken `after_ns` later."""
        self.clock.run_until(self.clock.now_ns // MS * MS + MS)
        self.node.sample()
        data = self.node.exchange(self.to_drive.packed(values))
        self.clock.run_until(self.clock.now_ns + after_ns)
        self.node.cycle()
        return self.from_drive.values_of(data)

    def place(self, edge_ns: int) -> int:
        return round((edge_ns + self.delay_ns) * 1e-6 * self.per_ms)


def test_an_edge_between_the_sample_and_the_image_is_stored_before_its_bits_act() -> None:
    """The image takes the enable bit away: the value is there for a cycle, and stays."""
    edge_ns = 5 * MS + 200 * US
    one = Probed("conventional", edge_ns)
    for _ in range(4):
        one.cycle(ENABLE=BOTH)
    one.cycle(after_ns=500 * US, ENABLE=0)
    found = one.cycle(ENABLE=0)
    assert found["STATUS"] & of_card.ENABLE["POS"]
    assert found["LATCH_P"] == one.place(edge_ns)
    found = one.cycle(ENABLE=0)
    assert found["STATUS"] & BOTH == 0
    assert found["LATCH_P"] == one.place(edge_ns)


def test_an_edge_behind_that_image_is_none() -> None:
    one = Probed("conventional", 5 * MS + 700 * US)
    for _ in range(4):
        one.cycle(ENABLE=BOTH)
    one.cycle(after_ns=500 * US, ENABLE=0)
    for _ in range(2):
        found = one.cycle(ENABLE=0)
        assert (found["STATUS"] & BOTH, found["LATCH_P"]) == (0, 0)


@pytest.mark.parametrize("enable", [1, 2, 3])
def test_a_card_stores_each_edge_that_is_enabled_for_itself(enable: int) -> None:
    """Up, down, and both once more: the first of each counts."""
    edges_ns = tuple(round(ms * MS) for ms in (4.3, 6.6, 8.2, 9.4))
    one = Probed("conventional", *edges_ns)
    for _ in range(12):
        found = one.cycle(ENABLE=enable)
    assert found["STATUS"] & BOTH == enable
    assert found["LATCH_P"] == (one.place(edges_ns[0]) if enable & of_card.ENABLE["POS"] else 0)
    assert found["LATCH_N"] == (one.place(edges_ns[1]) if enable & of_card.ENABLE["NEG"] else 0)
    for _ in range(3):
        found = one.cycle(ENABLE=0)
    assert found["STATUS"] & BOTH == 0  # the values are those of the last measurement still
    assert found["LATCH_P"] == (one.place(edges_ns[0]) if enable & of_card.ENABLE["POS"] else 0)


def test_a_card_stores_both_edges_of_a_signal_that_begins_high() -> None:
    """Down first, then up: both were enabled from the begin."""
    edges_ns = tuple(round(ms * MS) for ms in (4.3, 6.6))
    one = Probed("conventional", *edges_ns, starts_high=True)
    for number in range(9):
        found = one.cycle(ENABLE=BOTH)
        if number == 5:
            assert found["STATUS"] & BOTH == of_card.ENABLE["NEG"]
    assert (found["LATCH_N"], found["LATCH_P"]) == tuple(map(one.place, edges_ns))


@pytest.mark.parametrize("read", [0, 1, 2, 3])
def test_a_lightbus_drive_shows_each_value_that_it_is_asked_for(read: int) -> None:
    """SHOWN has the same bits as READ; what was not asked for is stored still."""
    unit = FAMILIES["lightbus"].unit()
    places = {True: 3 << 20, False: 5 << 20}
    for edge, place in places.items():
        unit.pulse(edge, place)
    unit.command({"READ": read}, 0)
    found = unit.inputs(0, level=False)
    assert found["SHOWN"] == read
    stored = 0
    for edge, name in ((True, "POS"), (False, "NEG")):
        lead_um = FAMILIES["lightbus"].table.make().drive.lead_um
        is_shown = bool(read & of_lightbus.READ[name])
        shown_um = (places[edge] >> 20) * lead_um if is_shown else None
        assert found.get(of_lightbus.VALUE[name]) == shown_um
        stored |= 0 if is_shown else of_lightbus.LATCHED[name]
    assert found["DRVSTAT"] == stored


def test_a_counter_that_was_set_before_power_is_not_reported_as_set_afterwards() -> None:
    """CNT_SET stays at 1 all the time: acknowledged before, no edge afterwards."""
    unit = FAMILIES["encoder_terminal"].unit()
    unit.reset(0)
    on = {"CONTROL": of_terminal.CNT_SET, "SET": 1234}
    unit.command({}, 0)
    unit.command(on, 0)
    assert unit.inputs(0, level=False)["STATUS"] & of_terminal.CNTSET_ACC
    unit.reset(10)
    for _ in range(2):
        found = unit.inputs(10, level=False)
        assert (found["STATUS"] & of_terminal.CNTSET_ACC, found["COUNTER"]) == (0, 0)
        unit.command(on, 10)
    unit.command({}, 10)
    unit.command(on, 10)
    found = unit.inputs(10, level=False)
    assert (found["STATUS"] & of_terminal.CNTSET_ACC != 0, found["COUNTER"]) == (True, 1234)
