"""Elements of the HLI: their types and ranges, and which line of a program is to blame."""

from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.machine.plc.distance_elements import DistanceCommandElements, DistanceControlUnit
from axisrig.bench.machine.plc.elements import Named, UnknownNameError
from axisrig.bench.machine.plc.hli import BoolUnit, ExtLatchUnit, Hli, Inputs, Sgn64Unit, Variables
from axisrig.bench.machine.plc.program import PlcProgram
from axisrig.kernel.errors import UserError

# A structure, an element that a program sets, good values, bad ones
ELEMENTS: list[tuple[type, str, tuple[Any, ...], tuple[Any, ...]]] = [
    (BoolUnit, "enable_w", (True, False), (0, 1, None, "on", 1.0)),
    (BoolUnit, "command_w", (True, False), (0, 1, None)),
    (Sgn64Unit, "enable_w", (True, False), (0, 1)),
    (Sgn64Unit, "command_w", (0, -(2**63), 2**63 - 1), (True, 1.0, -(2**63) - 1, 2**63, None)),
    (ExtLatchUnit, "please_rw", (True, False), (1, None)),
    (ExtLatchUnit, "done_w", (True, False), (0, None)),
    # OFF, ON, FREEZE, ON_CONST_DIST; None: no transition, or the value stays
    (DistanceCommandElements, "transition", (None, 0, 1, 2, 3), (-1, 4, True, 1.0)),
    (DistanceCommandElements, "set_pos", (None, -(2**31), 2**31 - 1), (2**31, -(2**31) - 1, 0.5)),
    (DistanceCommandElements, "set_dist", (None, -(2**31), 2**31 - 1), (2**31, False, "7")),
    (DistanceControlUnit, "enable_w", (True, False), (1, None)),
    (DistanceControlUnit, "command_semaphor_rw", (True, False), (1, None)),
]


@pytest.mark.parametrize(("kind", "element", "good", "bad"), ELEMENTS)
def test_an_element_takes_its_type_and_range_alone(
    kind: type, element: str, good: tuple[Any, ...], bad: tuple[Any, ...]
) -> None:
    holder = kind()
    for value in good:
        setattr(holder, element, value)
        assert getattr(holder, element) is value
    for value in bad:
        with pytest.raises(UserError) as refused:
            setattr(holder, element, value)
        assert refused.value.value is value
        assert getattr(holder, element) is good[-1]


def test_a_variable_is_a_finite_number_and_no_flag() -> None:
    values = Variables({})
    for value in (0, -3, 2.5, 1e300):
        values["A"] = value
        assert values["A"] == value
    for bad in (True, False, None, "1", float("nan"), float("inf"), 1j):
        with pytest.raises(UserError, match=r"V\.E\.A has a wrong type"):
            values["A"] = bad  # type: ignore[assignment]
    assert dict(values) == {"A": 1e300}


def test_a_part_of_the_distance_control_unit_is_of_its_own_kind() -> None:
    """A part of another unit does not fit, a new one of its own kind does."""
    unit, other = DistanceControlUnit("unit"), DistanceControlUnit("other")
    for part, wrong in (("command_w", unit.state_r), ("state_r", unit.command_w),
                        ("command_w", other), ("state_r", BoolUnit())):  # fmt: skip
        before = getattr(unit, part)
        with pytest.raises(UserError, match=f"unit.{part} has been replaced") as refused:
            setattr(unit, part, wrong)
        assert refused.value.value is wrong
        assert getattr(unit, part) is before
    unit.command_w, unit.state_r = other.command_w, other.state_r
    assert (unit.command_w, unit.state_r) == (other.command_w, other.state_r)


@pytest.mark.parametrize("kind", [BoolUnit, Sgn64Unit, ExtLatchUnit, DistanceControlUnit])
@pytest.mark.parametrize("element", ["commandw", "__doc__", "__slots__", "__init__"])
def test_what_is_no_element_cannot_be_set_and_none_can_be_deleted(kind: type, element: str) -> None:
    unit = kind()
    with pytest.raises(AttributeError) as refused:
        setattr(unit, element, True)
    assert (refused.value.name, refused.value.obj) == (element, unit)
    with pytest.raises(UserError, match="enable_w of the HLI cannot be deleted") as deleted:
        delattr(unit, "enable_w")
    assert deleted.value.hint == "set it to False or 0"


@pytest.mark.parametrize(
    ("use", "value", "where", "allowed"),
    [
        ("hli.ch.override.zzz", "zzz", "ch.override",
         "allowed, enable_w, command_w, request_r, state_r"),
        ("hli.ch.feedhold.zzz", "zzz", "ch.feedhold", "enable_w, command_w, request_r, state_r"),
        ("hli.ch.feedhold.comand_w", "comand_w", "ch.feedhold", "command_w"),
        ("hli.zzz", "zzz", "hli", "ax, ch, ve"),
        ("hli.ax['Z'].zzz", "zzz", "hli.ax[..]", "lr_mc_control, lr_state"),
        ("inputs.zzz", "zzz", "inputs", "time_ns, cycle, channel, wc_state"),
    ],
)  # fmt: skip
def test_an_unknown_element_has_the_nearest_one_or_all_that_there_are(
    tmp_path: Path, use: str, value: str, where: str, allowed: str
) -> None:
    path = tmp_path / "plc.py"
    path.write_text(f"class Program:\n    def cycle(self, inputs, hli):\n        {use}\n", "utf-8")
    with pytest.raises(UserError) as refused:
        PlcProgram(path).cycle(Inputs(0, 0, {}), Hli(["X", "Z"]))
    assert refused.value.message == f"the PLC program asks for an unknown element of {where}"
    assert (refused.value.value, refused.value.allowed) == (value, allowed)
    assert ("did you mean" in str(refused.value)) == (allowed == "command_w")


@pytest.mark.parametrize(
    ("use", "hint"), [("hli.ax.Z", 'hli.ax["Z"]'), ("hli.ve.F", 'hli.ve["F"]')]
)
def test_what_is_asked_for_with_a_dot_is_written_with_brackets(
    tmp_path: Path, use: str, hint: str
) -> None:
    path = tmp_path / "plc.py"
    path.write_text(f"class Program:\n    def cycle(self, inputs, hli):\n        {use}\n", "utf-8")
    with pytest.raises(UserError) as refused:
        PlcProgram(path).cycle(Inputs(0, 0, {}), Hli(["X", "Z"]))
    assert refused.value.hint == f"write {hint}"
    assert hint.partition("[")[0] in refused.value.message


def test_overrides_have_the_highest_of_their_own() -> None:
    """200 % of the path, 100 % of an axis, in 0.1 %; other units have 64 bits."""
    hli = Hli(["X", "Z"])
    for unit, highest in (
        (hli.ch.override, 2000), (hli.ax["X"].lr_mc_control.override, 1000),
        (hli.ax["Z"].lr_mc_control.override, 1000),
        (hli.ax["Z"].lr_mc_control.timestamp, 2**63 - 1),
    ):  # fmt: skip
        unit.command_w = highest
        with pytest.raises(UserError, match="is out of its range"):
            unit.command_w = highest + 1
        assert unit.command_w == highest
    labels = [hli.ax[name].lr_mc_control.distance_control.command_w.label for name in "XZ"]
    unit = "lr_mc_control.distance_control.command_w"
    assert labels == [f"ax[X].{unit}", f"ax[Z].{unit}"]


PROGRAM = """import json

def outside(text):
    return json.loads(text)  # 4

class Program:
    def helper(self, hli, what):
        if what == "element":
            hli.ch.override.command_w = 3000  # 9
        if what == "name":
            hli.ax["Q"]  # 11
        outside("[1" if what == "library" else "1")

    def cycle(self, inputs, hli):
        if inputs.cycle == 1:
            self.helper(hli, "{what}")  # 16
        if inputs.cycle == 2:
            raise KeyError("later")  # 18
"""


@pytest.mark.parametrize(
    ("what", "line", "words"),
    [("element", 9, "override.command_w is out of its range"), ("name", 11, "unknown axis"),
     ("library", 4, "JSONDecodeError"), ("nothing", 18, "KeyError: 'later'")],
)  # fmt: skip
def test_the_innermost_line_of_the_program_is_to_blame(
    tmp_path: Path, what: str, line: int, words: str
) -> None:
    """Not that of a library below it, nor that of the cycle which has called it."""
    path = tmp_path / "plc.py"
    path.write_text(PROGRAM.replace("{what}", what), encoding="utf-8")
    program, hli = PlcProgram(path), Hli(["X"])
    program.cycle(Inputs(0, 0, Named("channel", {})), hli)
    number = 2 if what == "nothing" else 1
    with pytest.raises(UserError, match=words) as blamed:
        program.cycle(Inputs(0, number, Named("channel", {})), hli)
    assert (blamed.value.file, blamed.value.line) == (str(path), line)


@pytest.mark.parametrize("names", [(10, 9, 2), ("Z", "X", "A"), ()])
def test_of_a_name_that_there_is_not_those_that_there_are_stand_in_their_order(
    names: tuple[Any, ...],
) -> None:
    """As they are: numbers stay numbers. It is a KeyError, and asking for one is no error."""
    things = Named("channel", dict.fromkeys(names, 1))
    with pytest.raises(KeyError) as missing:
        things["Q"]
    error = missing.value
    assert isinstance(error, UnknownNameError)
    assert (error.what, error.name, error.known) == ("channel", "Q", [*names])
    assert error.args == ("Q",)
    assert (things.get("Q"), "Q" in things) == (None, False)
