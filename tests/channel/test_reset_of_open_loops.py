"""Where a reset leads axes from: one that was led without its actual position, where it stands."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.path.settings import CycleTiming
from axisrig.kernel.channel.reset import Reset
from axisrig.kernel.drives.power import Power, PowerOrder


class Link:
    """A drive at 7 mm whose set position the path has at 5."""

    place_mm, is_placed, is_in_fault, acknowledges_faults = 7.0, True, False, False
    settings = SimpleNamespace(fault_reset=False)

    def __init__(self, name: str, power: Power, runs_open: bool) -> None:
        self.name, self.power, self.runs_open = name, power, runs_open

    def close_loop(self) -> None:
        self.runs_open = False

    def find_place(self) -> None:
        pass

    def order(self, _order: Any) -> None:
        pass

    def forget_fault(self) -> None:
        pass


@pytest.mark.parametrize("power", [Power.OPERATING, Power.OFF])
@pytest.mark.parametrize("runs_open", [False, True])
def test_an_axis_whose_loop_was_open_or_whose_drive_was_off_stays_where_it_is(
    power: Power, runs_open: bool
) -> None:
    """Its neighbour follows its set position all the time and keeps it."""
    links: Any = [Link("Y", Power.OPERATING, False), Link("Z", power, runs_open)]
    put: dict[str, float] = {}
    path: Any = SimpleNamespace(put=put.__setitem__)
    reactions: Any = SimpleNamespace(reset=lambda: None)
    reset = Reset(links, CycleTiming(), path, reactions, (), (), lambda: True)
    reset.begin()
    assert reset.go_on() is (power is Power.OPERATING)
    is_left = runs_open or power is not Power.OPERATING
    assert put == ({"Z": 7.0} if is_left else {})
    assert not links[1].runs_open


def test_drives_are_switched_on_while_one_of_them_leaves_its_homing() -> None:
    """Every cycle of the reset counts for both, and it is over when both are."""
    link: Any = Link("Z", Power.OPERATING, False)
    ordered: list[Any] = []
    link.order = ordered.append
    path: Any = SimpleNamespace(put=lambda *_any: None)
    reactions: Any = SimpleNamespace(reset=lambda: ordered.append("reset"))
    answers = [False, False, True]
    called: list[str] = []
    ends = [lambda: called.append("end 1"), lambda: called.append("end 2")]
    leaves = [lambda: called.append("leave")]
    reset = Reset([link], CycleTiming(), path, reactions, ends, leaves, lambda: answers.pop(0))
    reset.begin()
    assert called == ["end 1", "end 2"]
    assert [reset.go_on() for _ in range(3)] == [False, False, True]
    assert ordered == ["reset", PowerOrder.SWITCH_ON] * 3
    assert called[2:] == ["leave"] * 3
