"""A conventional drive at a card of the control: latches for both edges, own power; both ends."""

from dataclasses import replace

import pytest
from tests.speed_drive.ends import MILLISECOND, SETTINGS, Ends

from axisrig.bench.drive.conventional.unit import CounterCard
from axisrig.kernel.drives.conventional.link import ConventionalDrive
from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.profiles.conventional import words


def test_each_edge_has_a_latch_of_its_own() -> None:
    card = CounterCard()
    card.command({"ENABLE": words.ENABLE["NEG"]}, 0)
    assert card.edges() == (False,)
    card.pulse(False, -5)
    assert card.edges() == ()
    assert card.inputs(-9, level=False) == {
        "STATUS": words.ENABLE["NEG"], "COUNTER": -9, "LATCH_P": 0, "LATCH_N": -5,
    }  # fmt: skip


def test_a_second_pulse_changes_nothing() -> None:
    card = CounterCard()
    card.command({"ENABLE": words.ENABLE["POS"]}, 0)
    card.pulse(True, 3)
    card.pulse(True, 9)
    assert card.inputs(0, level=True)["LATCH_P"] == 3
    assert card.inputs(0, level=True)["STATUS"] == words.ENABLE["POS"] | words.LEVEL


def test_the_card_counts_on_while_the_drive_has_no_power() -> None:
    """0.1 mm/s for 1 s without power: 41 increments of 2.44 um that are not lost."""
    ends = Ends("conventional", lambda time_s: 0.05 + 1e-4 * time_s, [], MILLISECOND)
    for _ in range(20):
        ends.cycle()
    assert ends.link.state_name == "OPERATION"
    ends.node.power_off()
    for _ in range(1000):
        ends.cycle()
    assert (ends.link.state_name, ends.link.has_actual) == ("NOT_READY", True)
    assert ends.link.actual_mm == pytest.approx(50.0 + 0.1 * 1.019, abs=10 / 4096)


@pytest.mark.parametrize(
    ("edge", "level", "is_actuated"), [("POS", True, True), ("NEG", True, False)]
)
def test_the_level_of_the_input_is_known(edge: str, level: bool, is_actuated: bool) -> None:
    ends = Ends(
        "conventional", lambda _time_s: 0.05, [MILLISECOND.period_ns], MILLISECOND, edge=edge
    )
    for _ in range(10):
        ends.cycle()
    assert ends.link.is_actuated is is_actuated


@pytest.mark.parametrize(("edge", "other"), [("POS", "NEG"), ("NEG", "POS")])
def test_the_value_of_an_edge_counts_with_its_own_valid_bit(edge: str, other: str) -> None:
    """That of the other edge, and its bit, say nothing; the value has to come twice."""
    port = ImagePort()
    link = ConventionalDrive(replace(SETTINGS, echo_cycles=1), port)
    link.choose_latch(1, edge)
    found = []
    for status, value in (
        (0, 0), (0, 0), (words.ENABLE[other], 4096), (words.ENABLE[edge], 819),
        (words.ENABLE[edge] | words.ENABLE[other], 819),
    ):  # fmt: skip
        image = {"STATUS": status, words.VALUE[edge]: value, words.VALUE[other]: -value}
        port.receive(words.FROM_CARD.packed(image))
        link.take()
        link.send(0.0)
        if link.is_clear:
            link.arm()
            link.send(0.0)
        assert port.outputs is not None
        enabled = words.TO_CARD.values_of(port.outputs)["ENABLE"]
        assert enabled == (words.ENABLE[edge] if link.is_probing else 0)
        found.append((link.has_latched, link.latched_mm))
    assert found == [(False, None)] * 3 + [(True, None), (True, 819 / 409.6)]
