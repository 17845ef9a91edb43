"""#IDENT on a CANopen drive, and #DRIVE through an RPDO, with answers written by hand."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from tests.drives.test_answers_of_functions import LIMIT, Drive, block

from axisrig.kernel.drives.canopen.drive_functions import DriveAccess, DriveFunctions
from axisrig.kernel.drives.interface import DriveAccesses
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon

TORQUE, WINDOW = "S-0-0092", "S-0-0159"
LENGTHS = {TORQUE: 2, WINDOW: 4}
"""6072 has 16 bits and 6065 has 32."""
OFF = b"\xff\xff\xff\xff"


class Link:
    """The objects of an RPDO, and micrometres as position units."""

    def __init__(self, per_mm: float = 1000.0) -> None:
        self.settings = SimpleNamespace(increments_per_mm=per_mm)
        self.objects: dict[tuple[int, int], int] = {}
        self.written: list[tuple[int, int, int]] = []

    def get_object(self, index: int, sub: int) -> int:
        return self.objects.get((index, sub), 0)

    def set_object(self, index: int, sub: int, value: int) -> None:
        self.objects[index, sub] = value
        self.written.append((index, sub, value))


class Axes:
    """Axes Y and Z; Y counts twice as fine as Z."""

    def __init__(self, **functions: Any) -> None:
        self.drives = {"Y": Drive(), "Z": Drive()}
        self.links = {"Y": Link(2000.0), "Z": Link()}
        known: Any = functions
        accesses: dict[str, Any] = {
            axis: DriveAccess(link, self.drives[axis], known)  # type: ignore[arg-type]
            for axis, link in self.links.items()
        }
        self.functions = DriveFunctions(accesses)


def reads(axis: str, ident: str, length: int | None, number: int = 1) -> canon.DriveRead:
    return canon.DriveRead(block(number), axis, ident, length)


def writes(axis: str, ident: str, value: float, length: int | None) -> canon.DriveWrite:
    return canon.DriveWrite(block(1), axis, ident, value, True, length)


# Idents


@pytest.mark.parametrize("ident", LENGTHS)
@pytest.mark.parametrize("length", [1, 2, 3, 4, 8])
@pytest.mark.parametrize("is_written", [False, True])
def test_an_ident_is_asked_for_with_its_own_length_only(
    ident: str, length: int, is_written: bool
) -> None:
    axes = Axes()
    made = writes("Z", ident, 5.0, length) if is_written else reads("Z", ident, length)
    if length == LENGTHS[ident]:
        axes.functions.begin(made)
        assert len(axes.drives["Z"].asked) == 1
        assert axes.functions.is_waiting
        return
    with pytest.raises(Alarm) as caught:
        axes.functions.begin(made)
    assert caught.value.id == 900256
    assert caught.value.values == {
        "keyword": "TYP", "value": f"{length}", "allowed": f"{LENGTHS[ident]} for {ident}",
    }  # fmt: skip
    assert axes.drives["Z"].asked == []
    assert not axes.functions.is_waiting
    assert not axes.functions.is_busy


def test_a_window_counts_the_position_units_of_its_own_axis() -> None:
    """30 000 times 0.1 um are 3 mm: 6000 and 3000 increments."""
    axes = Axes()
    for axis, increments in (("Y", 6000), ("Z", 3000)):
        axes.functions.begin(writes(axis, WINDOW, 30_000.0, 4))
        data = increments.to_bytes(4, "little")
        assert axes.drives[axis].asked == [(0x6065, 0, data)]
        axes.drives[axis].answer()
        axes.functions.begin(reads(axis, WINDOW, 4))
        axes.drives[axis].answer(data)
        assert axes.functions.value(axis, WINDOW) == 30_000.0
    assert not axes.functions.is_busy


@pytest.mark.parametrize("is_written", [False, True])
def test_an_ident_without_an_object_names_those_that_have_one(is_written: bool) -> None:
    for ident in ("S-0-0104", "S-0-0160", "P-0-0092"):
        axes = Axes()
        made = writes("Z", ident, 5.0, 2) if is_written else reads("Z", ident, 2)
        with pytest.raises(Alarm) as caught:
            axes.functions.begin(made)
        known = f"{TORQUE}, {WINDOW}"
        assert (caught.value.id, caught.value.values) == (
            900255, {"axis": "Z", "ident": ident, "known": known},
        )  # fmt: skip


def test_an_axis_of_another_family_has_neither_functions_nor_idents() -> None:
    axes = Axes(LIMIT=LIMIT)
    for key, length in (("LIMIT", None), (TORQUE, 2)):
        with pytest.raises(Alarm) as caught:
            axes.functions.begin(reads("W", key, length))
        assert (caught.value.id, caught.value.values) == (
            900110, {"axis": "W", "key": key, "known": "none"},
        )  # fmt: skip


@pytest.mark.parametrize(("axis", "key"), [("Z", "LIMIT"), ("W", "TORQUE")])
def test_drives_without_any_function_are_named_with_what_was_asked_for(axis: str, key: str) -> None:
    none = DriveAccesses()
    with pytest.raises(Alarm) as caught:
        none.begin(reads(axis, key, None))
    assert (caught.value.id, caught.value.values) == (
        900110, {"axis": axis, "key": key, "known": "none"},
    )  # fmt: skip
    assert (none.is_waiting, none.is_busy) == (False, False)


def test_a_name_of_a_function_is_no_ident_and_the_other_way_round() -> None:
    axes = Axes(LIMIT=LIMIT, BITS=replace(LIMIT, key="BITS"))
    with pytest.raises(Alarm) as caught:
        axes.functions.begin(reads("Z", TORQUE, None))
    assert (caught.value.id, caught.value.values["known"]) == (900110, "LIMIT, BITS")
    with pytest.raises(Alarm) as caught:
        axes.functions.begin(reads("Z", "LIMIT", 2))
    assert caught.value.id == 900255


def test_a_window_that_is_off_is_0_and_one_of_0_is_an_alarm_of_its_block() -> None:
    axes = Axes()
    axes.functions.begin(reads("Z", WINDOW, 4, number=3))
    axes.drives["Z"].answer(OFF)
    axes.functions.check()
    assert axes.functions.value("Z", WINDOW) == 0.0
    axes.functions.begin(reads("Z", WINDOW, 4, number=4))
    axes.drives["Z"].answer(bytes(4))
    with pytest.raises(Alarm) as caught:
        axes.functions.check()
    assert (caught.value.id, caught.value.place) == (900257, "line 4, block N40")
    assert caught.value.values == {
        "axis": "Z", "value": 0, "object": "0x6065:0", "ident": WINDOW, "off": 0,
    }  # fmt: skip
    axes.functions.check()  # once


def test_a_torque_limit_of_0_is_a_value_like_any_other() -> None:
    axes = Axes()
    axes.functions.begin(writes("Z", TORQUE, 0.0, 2))
    assert axes.drives["Z"].asked == [(0x6072, 0, bytes(2))]
    axes.drives["Z"].answer()
    axes.functions.begin(reads("Z", TORQUE, 2))
    axes.drives["Z"].answer(bytes(2))
    axes.functions.check()
    assert axes.functions.value("Z", TORQUE) == 0.0


def test_of_a_refusal_and_a_window_that_no_ident_can_show_the_first_one_comes_up() -> None:
    for first, alarm_id in (("refuse", 900032), ("window", 900257)):
        axes = Axes()
        axes.functions.begin(reads("Z", WINDOW, 4))
        axes.functions.begin(reads("Y", WINDOW, 4))
        order = ("Y", "Z") if first == "refuse" else ("Z", "Y")
        for axis in order:
            if axis == "Y":
                axes.drives["Y"].refuse()
            else:
                axes.drives["Z"].answer(bytes(4))
        with pytest.raises(Alarm) as caught:
            axes.functions.check()
        assert caught.value.id == alarm_id


def test_a_refusal_names_the_ident_and_its_object() -> None:
    for ident, name in ((TORQUE, "0x6072:0"), (WINDOW, "0x6065:0")):
        axes = Axes()
        axes.functions.begin(writes("Y", ident, 7.0, LENGTHS[ident]))
        axes.drives["Y"].refuse()
        with pytest.raises(Alarm) as caught:
            axes.functions.check()
        alarm = caught.value
        assert alarm.id == 900032
        assert {key: alarm.values[key] for key in ("axis", "key", "object")} == {
            "axis": "Y", "key": ident, "object": name,
        }  # fmt: skip


# Functions in an RPDO

CYCLIC = replace(LIMIT, communication="CYCLIC", index=0x60B2, sub=0)


def test_a_cyclic_value_is_put_into_the_rpdo_and_acts_with_the_next_sync() -> None:
    """LIMIT counts tenths: -3 are -30."""
    axes = Axes(LIMIT=CYCLIC)
    axes.functions.begin(writes("Z", "LIMIT", -3.0, None))
    assert axes.links["Z"].written == [(0x60B2, 0, -30)]
    assert axes.links["Y"].written == []
    assert axes.drives["Z"].asked == []
    assert axes.functions.is_waiting
    axes.functions.check()
    assert not axes.functions.is_waiting
    assert not axes.functions.is_busy
    axes.functions.check()
    axes.functions.begin(writes("Z", "LIMIT", 3.0, None))
    assert axes.functions.is_busy  # the second one counts like the first


def test_two_cyclic_values_of_a_cycle_are_both_sent_with_it() -> None:
    axes = Axes(LIMIT=CYCLIC, BITS=replace(CYCLIC, key="BITS", index=0x60B1, factor=1.0))
    axes.functions.begin(writes("Z", "LIMIT", 1.0, None))
    axes.functions.begin(writes("Z", "BITS", 2.0, None))
    axes.functions.begin(writes("Y", "BITS", 3.0, None))
    assert axes.links["Z"].objects == {(0x60B2, 0): 10, (0x60B1, 0): 2}
    assert axes.links["Y"].objects == {(0x60B1, 0): 3}
    axes.functions.check()
    assert not axes.functions.is_busy


@pytest.mark.parametrize(
    ("present", "value", "written"),
    [(0x1234, 0x50, 0x1254), (-1, 0x00, -241), (0, 0xF0, 0xF0), (0x0FFF, 0x10, 0x0F1F)],
)
def test_a_mask_keeps_the_other_bits_of_a_cyclic_object(
    present: int, value: int, written: int
) -> None:
    """-1 is 0xFFFF; 0xFF0F is -241."""
    axes = Axes(BITS=replace(CYCLIC, key="BITS", mask=0x00F0, factor=1.0))
    axes.links["Z"].objects[0x60B2, 0] = present
    axes.functions.begin(writes("Z", "BITS", float(value), None))
    assert axes.links["Z"].written == [(0x60B2, 0, written)]


def test_a_cyclic_function_is_read_beside_the_cycle() -> None:
    axes = Axes(LIMIT=CYCLIC)
    axes.functions.begin(reads("Z", "LIMIT", None))
    assert axes.drives["Z"].asked == [(0x6077, 2, None)]
    axes.drives["Z"].answer((250).to_bytes(2, "little"))
    assert axes.functions.value("Z", "LIMIT") == 25.0


def test_only_cyclic_functions_have_a_value_from_the_start_on() -> None:
    """P-AXIS-00400; 0 is a value, and no value leaves what the drive has."""
    axes = Axes(
        A=replace(CYCLIC, key="A", startup=7),
        B=replace(CYCLIC, key="B", index=0x60B1, startup=0),
        C=replace(CYCLIC, key="C", index=0x60B0, startup=None),
        D=replace(LIMIT, key="D", startup=5),
        E=replace(LIMIT, key="E", communication="IGNORE", startup=5),
    )
    axes.functions.start()
    for link in axes.links.values():
        assert link.written == [(0x60B2, 0, 7), (0x60B1, 0, 0)]


@pytest.mark.parametrize("communication", ["CYCLIC", "ACYCLIC", "IGNORE"])
@pytest.mark.parametrize(
    ("value", "alarm_id"), [(0.5, 900111), (3277.0, 900112), (-3277.0, 900112)]
)
def test_what_cannot_be_a_value_is_an_alarm_whatever_the_way(
    communication: str, value: float, alarm_id: int
) -> None:
    """Tenths of SGN16: -3276 to 3276."""
    axes = Axes(LIMIT=replace(LIMIT, communication=communication))
    with pytest.raises(Alarm) as caught:
        axes.functions.begin(writes("Z", "LIMIT", value, None))
    alarm = caught.value
    assert (alarm.id, alarm.values["axis"], alarm.values["key"]) == (alarm_id, "Z", "LIMIT")
    assert axes.links["Z"].written == []
    assert axes.drives["Z"].asked == []
    assert not axes.functions.is_busy


def test_a_function_that_is_ignored_sends_nothing_and_holds_nothing() -> None:
    axes = Axes(LIMIT=replace(LIMIT, communication="IGNORE"))
    axes.functions.begin(writes("Z", "LIMIT", 3276.0, None))
    assert axes.links["Z"].written == []
    assert axes.drives["Z"].asked == []
    assert not axes.functions.is_waiting
    assert not axes.functions.is_busy
