"""#DRIVE values that a PROFIdrive drive does not get, or gets at the limit of its list."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from tests.drives.test_answers_of_functions import Drive, block, read, write

from axisrig.kernel.drives.canopen.drive_functions import DriveAccess, DriveFunctions
from axisrig.kernel.drives.function_accesses import FunctionAccesses
from axisrig.kernel.drives.functions import DriveFunction
from axisrig.kernel.drives.profidrive.parameter_channel import ParameterWay, ProfidriveAccesses
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon

TORQUE = DriveFunction(
    "TORQUE", "ACYCLIC", 1230, 0, 1230, 0, "UNS16", None, 10.0, -1e199, 1e199, None
)
KNOWN = {
    "TORQUE": TORQUE,
    "IGNORED": replace(TORQUE, key="IGNORED", communication="IGNORE"),
    "LIMITED": replace(TORQUE, key="LIMITED", communication="IGNORE", low=0.0, high=100.0),
}


def profidrive() -> tuple[FunctionAccesses, Drive]:
    drive = Drive()
    ways: Any = {"Z": ParameterWay(drive, KNOWN)}  # type: ignore[arg-type]
    return ProfidriveAccesses(ways), drive


def canopen() -> tuple[FunctionAccesses, Drive]:
    drive = Drive()
    made: Any = DriveAccess(SimpleNamespace(), drive, KNOWN)  # type: ignore[arg-type]
    return DriveFunctions({"Z": made}), drive


either = pytest.mark.parametrize("make", [profidrive, canopen])


@either
@pytest.mark.parametrize("key", ["TORQUE", "IGNORED"])
@pytest.mark.parametrize(
    ("value", "alarm", "shown"),
    [(0.5, 900111, "0.5"), (-0.25, 900111, "-0.25"), (-1, 900112, "-10"), (6554, 900112, "65540")],
)
def test_a_value_that_cannot_be_is_an_alarm_whether_the_drive_gets_it_or_not(
    make: Any, key: str, value: float, alarm: int, shown: str
) -> None:
    """P-AXIS-00397 IGNORE keeps it from the drive; 6553 times 10 is the last one of 16 bits."""
    functions, drive = make()
    with pytest.raises(Alarm) as caught:
        functions.begin(write("Z", key, value))
    assert caught.value.id == alarm
    assert {name: caught.value.values[name] for name in ("axis", "key", "value")} == {
        "axis": "Z", "key": key, "value": shown,
    }  # fmt: skip
    assert drive.asked == []
    assert not functions.is_busy
    functions.check()


@either
@pytest.mark.parametrize("value", [0, 7, 6553])
@pytest.mark.parametrize("waits", [False, True])
def test_a_function_that_is_ignored_asks_the_drive_for_nothing(
    make: Any, value: int, waits: bool
) -> None:
    """And a program that waits for it goes on at once."""
    functions, drive = make()
    functions.begin(canon.DriveWrite(block(1), "Z", "IGNORED", value, waits))
    assert drive.asked == []
    assert (functions.is_busy, functions.is_waiting) == (False, False)


@either
@pytest.mark.parametrize("value", [-5, 101, 99999])
def test_a_value_beyond_the_limits_of_the_list_is_moved_there_before_it_is_judged(
    make: Any, value: int
) -> None:
    """P-AXIS-00408, 00409: without a message."""
    functions, drive = make()
    functions.begin(write("Z", "LIMITED", value))
    functions.check()
    assert drive.asked == []


@either
def test_what_is_ignored_is_read_all_the_same(make: Any) -> None:
    """IGNORE is about writing."""
    functions, drive = make()
    functions.begin(read("Z", "IGNORED"))
    assert functions.is_waiting
    assert drive.asked == [(1230, 0, None)]
    drive.answer((250).to_bytes(2, "little"))
    assert not functions.is_waiting
    assert functions.value("Z", "ignored") == 25.0


@pytest.mark.parametrize("key", ["TORQUE", "torque", "Torque"])
def test_a_value_goes_to_its_parameter_scaled_and_with_its_length(key: str) -> None:
    functions, drive = profidrive()
    functions.begin(write("Z", key, 6553))
    assert drive.asked == [(1230, 0, (65530).to_bytes(2, "little"))]
    assert functions.is_busy
    drive.answer()
    assert not functions.is_busy


def test_a_key_that_the_list_does_not_have_names_those_that_it_has() -> None:
    functions, drive = profidrive()
    for command in (write("Z", "FORCE", 1), read("Z", "FORCE")):
        with pytest.raises(Alarm) as caught:
            functions.begin(command)
        assert caught.value.id == 900110
        assert caught.value.values["known"] == "TORQUE, IGNORED, LIMITED"
    assert drive.asked == []


@pytest.mark.parametrize("waits", [False, True])
def test_an_ident_is_none_of_a_profidrive_drive_to_write_or_to_read(waits: bool) -> None:
    functions, drive = profidrive()
    for command in (
        canon.DriveWrite(block(1), "Z", "S-0-0092", 1, waits, 2),
        canon.DriveRead(block(1), "Z", "S-0-0092", 2),
    ):
        with pytest.raises(Alarm) as caught:
            functions.begin(command)
        assert (caught.value.id, caught.value.values["ident"]) == (900255, "S-0-0092")
    assert drive.asked == []
    assert not functions.is_waiting


def test_a_mask_leaves_the_other_bits_as_they_are_in_every_family() -> None:
    """The parameter is read before it is written."""
    drive = Drive()
    bits = replace(TORQUE, key="BITS", mask=0x00F0, factor=1.0)
    functions = ProfidriveAccesses({"Z": ParameterWay(drive, {"BITS": bits})})  # type: ignore[arg-type]
    functions.begin(write("Z", "BITS", 0x50))
    drive.answer(b"\x34\x12")
    assert drive.asked == [(1230, 0, None), (1230, 0, b"\x54\x12")]
    assert functions.is_busy
    drive.answer()
    assert not functions.is_busy
