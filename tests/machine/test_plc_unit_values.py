"""Values of the unit of distance control between PLC and CNC: nearest units, each state, two axes.

Lengths on the HLI are whole numbers of 0.1 um (FCT-M3 10).
"""

from collections.abc import Sequence
from typing import Any

import pytest

from axisrig.bench.machine.plc import hli
from axisrig.bench.machine.plc.hli import Hli
from axisrig.bench.machine.plc.task_units import TaskUnits
from axisrig.kernel.distance import DistanceCommand, DistanceState, Source
from axisrig.kernel.errors import UserError
from axisrig.kernel.plc.unit import AxisUnit


class Both:
    """The units of axes at the PLC and at the CNC, which takes what is enabled at once."""

    def __init__(self, axes: Sequence[str] = "Z") -> None:
        self.axes, self.notes = {name: AxisUnit() for name in axes}, list[str]()
        self.between = TaskUnits(self.axes, self.notes.append, has_columns=False)
        self.plc = {
            name: axis.lr_mc_control.distance_control for name, axis in Hli(axes).ax.items()
        }
        self.taken: list[tuple[str, Any, Any, Any]] = []

    def turn(self) -> None:
        """One cycle of the PLC and one of the CNC, and what the PLC then reads."""
        for name, unit in self.plc.items():
            self.between.take(name, self.between.written(name, unit))
            axis = self.axes[name].distance
            if axis.command_semaphor_rw and axis.enable_w:
                axis.command_semaphor_rw = False
                wanted = axis.command_w
                self.taken.append((name, wanted.transition, wanted.set_pos_mm, wanted.set_dist_mm))
            self.between.read(name, unit, self.between.shown(name))

    def order(self, name: str = "Z", **elements: int | None) -> None:
        unit = self.plc[name]
        for element in ("transition", "set_pos", "set_dist"):
            setattr(unit.command_w, element, elements.get(element))
        unit.enable_w = unit.command_semaphor_rw = True


FIELDS = {"surface_mm": "surface", "distance_mm": "distance", "actual_offset_mm": "actual_offset"}


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize(
    ("mm", "units"),
    [
        (0.29997, 3000), (0.30003, 3000), (-0.29997, -3000), (-0.30003, -3000),
        (0.00006, 1), (0.00004, 0), (-0.00006, -1), (-0.00004, 0),
        (0.0003, 3),  # 2.9999999999999996 as a float
        (30.0, 300_000), (-250.00019, -2_500_002), (0.0, 0),
    ],
)  # fmt: skip
def test_a_length_is_shown_in_the_nearest_unit(field: str, mm: float, units: int) -> None:
    """Each one by itself; the other two stay at 0."""
    both = Both()
    setattr(both.axes["Z"].distance.state_r, field, mm)
    both.turn()
    state = both.plc["Z"].state_r
    found = {name: getattr(state, name) for name in FIELDS.values()}
    assert found == {**dict.fromkeys(FIELDS.values(), 0), FIELDS[field]: units}
    assert {type(value) for value in found.values()} == {int}


def test_a_value_that_is_not_known_any_more_is_0_again() -> None:
    both = Both()
    state = both.axes["Z"].distance.state_r
    for mm, units in ((1.5, 15_000), (None, 0), (-1.5, -15_000)):
        state.surface_mm = state.distance_mm = mm
        both.turn()
        assert (both.plc["Z"].state_r.surface, both.plc["Z"].state_r.distance) == (units, units)


# FCT-M3 8; TF5200 distance control 290206347: numbers of states and transitions on the HLI
STATES = {"INACTIVE": 0, "ACTIVE": 1, "FREEZE": 2, "TURNING_OFF": 3, "ACTIVE_CONST_DIST": 4,
          "ERROR": 5}  # fmt: skip
TRANSITIONS = {"OFF": 0, "ON": 1, "FREEZE": 2, "ON_CONST_DIST": 3}


def test_every_state_and_source_has_its_number() -> None:
    assert {state.name for state in DistanceState} == {*STATES}
    both = Both()
    for name, number in STATES.items():
        for source, of_source in ((Source.PLC, 1), (Source.NC, 0)):
            both.axes["Z"].distance.state_r.state = DistanceState[name]
            both.axes["Z"].distance.state_r.source = source
            both.turn()
            state = both.plc["Z"].state_r
            assert (state.state, state.source) == (number, of_source)
        assert getattr(hli, f"HLI_DIST_CTRL_STATE_{name}") == number


def test_every_transition_gets_over_and_is_noted() -> None:
    assert {command.name for command in DistanceCommand} == {*TRANSITIONS}
    both = Both()
    for name, number in TRANSITIONS.items():
        both.order(transition=number)
        both.turn()
        assert both.taken.pop() == ("Z", DistanceCommand[name], None, None)
        assert both.notes.pop() == f"Z.distance_control = {name}"
        assert getattr(hli, f"HLI_DIST_CTRL_{name}") == number


@pytest.mark.parametrize(
    ("elements", "mm"),
    [
        ({"set_pos": 0}, (0.0, None)),
        ({"set_dist": 0}, (None, 0.0)),
        ({"set_pos": -1, "set_dist": 1}, (-1e-4, 1e-4)),
        ({"set_pos": 2**31 - 1}, (214_748.3647, None)),
        ({"set_pos": -(2**31)}, (-214_748.3648, None)),
        ({"set_dist": 2**31 - 1}, (None, 214_748.3647)),
    ],
)
def test_a_set_value_alone_is_no_transition_and_0_is_a_value(
    elements: dict[str, int], mm: tuple[float | None, float | None]
) -> None:
    both = Both()
    both.order(**elements)
    both.turn()
    assert both.taken == [("Z", None, *mm)]
    assert both.notes == []


@pytest.mark.parametrize(
    ("element", "value", "words"),
    [
        ("transition", -1, "allowed: 0 .. 3"),
        ("transition", 4, "allowed: 0 .. 3"),
        ("set_pos", 2**31, "allowed: -2147483648 .. 2147483647"),
        ("set_dist", -(2**31) - 1, "allowed: -2147483648 .. 2147483647"),
        ("set_dist", True, "allowed: a whole number"),
        ("transition", 1.0, "allowed: a whole number"),
    ],
)
def test_what_is_no_number_of_an_element_is_refused_and_changes_nothing(
    element: str, value: object, words: str
) -> None:
    command = Both().plc["Z"].command_w
    setattr(command, element, 2)
    with pytest.raises(UserError, match=f"distance_control.command_w.{element} ") as caught:
        setattr(command, element, value)
    assert words in str(caught.value)
    assert getattr(command, element) == 2


@pytest.mark.parametrize(
    ("part", "element"), [("command_w", "set_dist"), ("state_r", "actual_offset")]
)
def test_a_part_of_the_unit_cannot_be_replaced(part: str, element: str) -> None:
    unit = Both().plc["Z"]
    with pytest.raises(UserError, match="has been replaced") as caught:
        setattr(unit, part, None)
    assert str(caught.value.hint).endswith(f"distance_control.{part}.{element}")


def test_each_axis_has_its_own_commands_and_shows_its_own_state() -> None:
    """X commands twice while Z waits for its enable; each semaphore is free by itself."""
    both = Both("XZ")
    both.axes["X"].distance.state_r.surface_mm = 1.0
    both.axes["Z"].distance.state_r.surface_mm = 2.0
    both.order("Z", set_pos=7)
    both.plc["Z"].enable_w = False
    for count in (1, 2):
        both.order("X", set_dist=count)
        both.turn()
        semaphores = [both.plc[name].command_semaphor_rw for name in "XZ"]
        assert semaphores == [False, True]
    both.plc["Z"].enable_w = True
    both.turn()
    assert both.taken == [("X", None, None, 1e-4), ("X", None, None, 2e-4), ("Z", None, 7e-4, None)]
    assert [both.plc[name].state_r.surface for name in "XZ"] == [10_000, 20_000]
    assert not both.plc["Z"].command_semaphor_rw


def test_without_columns_the_program_gives_enable_and_takes_it_back() -> None:
    both, seen = Both(), []
    for is_on in (True, False, True):
        both.plc["Z"].enable_w = is_on
        both.turn()
        seen.append(both.axes["Z"].distance.enable_w)
    assert seen == [True, False, True]
