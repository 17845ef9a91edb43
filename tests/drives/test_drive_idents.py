"""Idents of SERCOS drives on objects of CANopen drives: units, what is off, the way back."""

import math

import pytest

from axisrig.kernel.drives.canopen.idents import drive_idents
from axisrig.kernel.errors import Alarm

PER_MM = 104857.6  # 20 bits on a lead of 10 mm
WINDOW, TORQUE = "S-0-0159", "S-0-0092"
U32 = 4


def _bytes(raw: int) -> bytes:
    return raw.to_bytes(U32, "little")


def test_the_torque_limit_counts_alike_on_both_sides() -> None:
    """FCT-C4 7.3.1 has VAL=100 for what 7.3.2 has as 10 times 10: 100 per mille of the torque."""
    torque = drive_idents(PER_MM)[TORQUE]
    assert (torque.index, torque.sub, torque.length_bytes) == (0x6072, 0, 2)
    assert torque.raw(100.0, "X") == 100
    assert torque.value((1000).to_bytes(2, "little")) == 1000.0


def test_the_window_counts_tenths_of_a_micrometre() -> None:
    """10 mm are one revolution: 2**20 position units."""
    window = drive_idents(PER_MM)[WINDOW]
    assert (window.index, window.sub, window.length_bytes) == (0x6065, 0, 4)
    assert window.raw(100000.0, "X") == 1 << 20
    assert math.isclose(window.value(_bytes(1 << 20)), 100000.0, rel_tol=1e-15)


def test_off_is_0_in_sercos_and_the_largest_number_in_ds402() -> None:
    window = drive_idents(PER_MM)[WINDOW]
    assert window.raw(0.0, "X") == 0xFFFFFFFF
    assert window.value(_bytes(0xFFFFFFFF)) == 0.0


@pytest.mark.parametrize("per_mm", [1.0, 1000.0, 10000.0, PER_MM, 3276800.0 / 7])
@pytest.mark.parametrize(
    "raw", [1, 2, 3, 1048575, 0x7FFFFFFF, 0x80000001, 0xFFFFFFFD, 0xFFFFFFFE, 0xFFFFFFFF]
)
@pytest.mark.parametrize("decimals", [0, 4, 9])
def test_what_is_read_and_written_back_is_the_same_to_the_last_increment(
    per_mm: float, raw: int, decimals: int
) -> None:
    """As a program does it: the parameter holds the value in units of DEC digits."""
    window = drive_idents(per_mm)[WINDOW]
    parameter = window.value(_bytes(raw)) / 10.0**decimals
    assert window.raw(parameter * 10.0**decimals, "X") == raw


def test_a_window_above_0_never_becomes_the_tightest_one() -> None:
    """0.1 um are less than half a position unit of 1 um."""
    assert drive_idents(1000.0)[WINDOW].raw(1.0, "X") == 1


@pytest.mark.parametrize("value", [-1.0, (0xFFFFFFFF + 0.0) * 10000 / PER_MM, 1e12])
def test_a_window_that_the_object_cannot_hold_is_no_way_to_switch_it_off(value: float) -> None:
    with pytest.raises(Alarm) as caught:
        drive_idents(PER_MM)[WINDOW].raw(value, "X")
    assert (caught.value.id, caught.value.values["key"]) == (900112, WINDOW)
    shown = float(str(caught.value.values["value"]))  # as the object would have it
    assert math.isclose(shown, value * PER_MM / 10000, rel_tol=1e-14)
    assert caught.value.values["data_type"] == "UNS32"


@pytest.mark.parametrize("per_mm", [1.0, 1000.0, 10000.0, PER_MM])
def test_a_window_of_0_in_the_drive_has_no_value_in_sercos(per_mm: float) -> None:
    """0 of 6065 is the tightest window, which 0 of S-0-0159 is not; every other one has a value."""
    window = drive_idents(per_mm)[WINDOW]
    for raw, can_tell in ((0, False), (1, True), (2, True), (0xFFFFFFFF, True)):
        assert window.can_tell(_bytes(raw)) is can_tell
    torque = drive_idents(per_mm)[TORQUE]
    assert torque.can_tell(bytes(2))
