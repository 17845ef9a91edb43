"""Contacts of a probe close on each other: several in one cycle, one while it is pressed."""

import pytest
from tests.rig.test_deflection import Bench

from axisrig.kernel.cosim.plant.probe import Contact

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


@pytest.mark.parametrize("count", [2, 3])
def test_contacts_of_one_cycle_are_one_deflection_from_the_last_of_them(count: int) -> None:
    """A tip that bounces. Cycles without a contact add none."""
    bench = Bench(stroke_mm=0.3)
    bench.approach()
    for number in range(count - 1):
        place = {"x": 0.0, "z": 0.05 - 0.01 * number}
        bench.probe.contacts.append(Contact(bench.plant.now_ns + number, place))
    bench.cycle(0.0, -0.1, contact_mm=(0.0, 0.02))
    assert bench.ways_mm == pytest.approx([0.12])
    bench.cycle(0.0, -0.2)
    bench.cycle(0.0, -0.25)
    assert bench.ways_mm == pytest.approx([0.27])
    bench.cycle(0.0, 0.5)
    bench.approach()
    bench.cycle(0.0, -0.1, contact_mm=(0.0, 0.0))
    assert bench.ways_mm == pytest.approx([0.27, 0.1])


def test_a_contact_of_a_pressed_probe_has_the_direction_of_its_own_cycle() -> None:
    """Down by z onto the table, then along x against a wall; the way down is not in it."""
    bench = Bench()
    bench.approach()
    bench.cycle(0.0, -0.1, contact_mm=(0.0, 0.0))
    bench.cycle(0.5, -0.1)
    bench.cycle(1.0, -0.1, contact_mm=(0.8, -0.1))
    assert bench.ways_mm == pytest.approx([0.1, 0.2])
    bench.cycle(1.3, -0.4)
    assert bench.ways_mm == pytest.approx([0.1, 0.5])
    assert [each.axis for each, _ in bench.log.of("tip")] == ["Z", "X"]


def test_an_axis_that_rests_at_its_contact_has_driven_the_probe_nowhere() -> None:
    """The contact is at the very place where the block ends: 0 mm past it are none."""
    bench = Bench(wiring={"Z": ("tip", None)})
    bench.approach()
    bench.cycle(0.0, 0.0, contact_mm=(0.0, 0.0))
    bench.cycle(0.0, 0.0)
    assert [(each.mm, words) for each, words in bench.log.of("tip")] == [(0.0, "")]
    bench.cycle(0.0, -0.001)
    ((found, words),) = bench.log.of("tip")
    assert found.mm == pytest.approx(0.001)
    assert words.startswith("tip: driven 0.0010 mm past its contact by axis Z in ")
