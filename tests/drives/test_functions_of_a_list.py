"""Drive functions value by value: types, factors and masks of a list, and values in an RPDO."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from tests.drives.test_answers_of_functions import LIMIT, Drive, block, read, write
from tests.drives.test_drive_functions import PRINTED, _read

from axisrig.kernel.drives.canopen.drive_functions import DriveAccess, DriveFunctions
from axisrig.kernel.drives.canopen.idents import drive_idents
from axisrig.kernel.drives.functions import DriveFunction, type_range
from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc import canon

CYCLIC = replace(LIMIT, key="CYCLIC", communication="CYCLIC", mask=None, factor=1.0)
BITS = replace(CYCLIC, key="BITS", mask=0x00F0)
IGNORE = replace(LIMIT, key="IGNORE", communication="IGNORE")


# One value


@pytest.mark.parametrize(
    ("data_type", "low", "high"),
    [
        ("UNS08", 0, 255), ("UNS16", 0, 65535), ("UNS32", 0, 4294967295),
        ("SGN08", -128, 127), ("SGN16", -32768, 32767), ("SGN32", -2147483648, 2147483647),
    ],
)  # fmt: skip
def test_a_value_fits_its_type_to_the_last_one(data_type: str, low: int, high: int) -> None:
    """And comes back as it was sent."""
    function = replace(LIMIT, data_type=data_type, factor=1.0)
    assert type_range(data_type) == function.range == (low, high)
    for value in (low, high):
        data = function.encode(function.raw(value, "Z"))
        assert len(data) == int(data_type[3:]) // 8
        assert function.value(data) == value
    for value in (low - 1, high + 1):
        with pytest.raises(Alarm) as caught:
            function.raw(value, "Z")
        assert (caught.value.id, caught.value.values["data_type"]) == (900112, data_type)


@pytest.mark.parametrize(
    ("factor", "value", "raw"), [(0.3, 5, 2), (0.3, 9, 3), (-2.5, 3, -8), (1.0, -7, -7)]
)
def test_a_scaled_value_is_the_nearest_whole_one(factor: float, value: int, raw: int) -> None:
    """0.3 x 5 = 1.5 and 0.3 x 9 = 2.7; -2.5 x 3 = -7.5, halves to the even one."""
    assert replace(LIMIT, factor=factor).raw(value, "Z") == raw


@pytest.mark.parametrize(
    ("mask", "data", "value"),
    [(None, b"\xff\xff", -1.0), (0x0F00, b"\x34\x12", 512.0), (0x8000, b"\xff\xff", 32768.0)],
)
def test_a_program_reads_the_bits_of_the_mask(mask: int | None, data: bytes, value: float) -> None:
    assert replace(LIMIT, mask=mask, factor=1.0).value(data) == value
    assert replace(LIMIT, mask=mask, factor=4.0).value(data) == value / 4.0


# The list


def test_places_of_a_list_may_be_free_and_a_factor_counts_with_linear_only(tmp_path: Any) -> None:
    text = PRINTED.replace("function[1]", "function[9]").replace("function[0]", "function[3]")
    text = text.replace("scaling_factor 1.0", "scaling_factor 7.0")
    text += "antr.function[9].rd_ident 6077_02\nantr.function[9].startup_value 0x10\n"
    functions, _ = _read(tmp_path, text)
    assert list(functions) == ["MON_WINDOW", "TORQUE_LIMIT"]
    window, torque = functions.values()
    assert (window.factor, torque.factor) == (1.0, 10.0)
    assert (window.read_index, window.read_sub, window.startup) == (0x6065, 0, None)
    assert (torque.index, torque.read_index, torque.read_sub, torque.startup) == (
        0x6072, 0x6077, 2, 16,
    )  # fmt: skip


@pytest.mark.parametrize("first", ["limit", "LIMIT", "Limit"])
@pytest.mark.parametrize("second", ["limit", "LIMIT", "lImIt"])
def test_two_functions_have_two_names_whatever_their_letters(
    tmp_path: Any, first: str, second: str
) -> None:
    """A program has both in capitals; the name that is shown is the one of the list."""
    text = PRINTED.replace("MON_WINDOW", first)
    with pytest.raises(UserError, match="two drive functions have one name") as caught:
        _read(tmp_path, text.replace("TORQUE_LIMIT", second))
    assert str(caught.value.value).endswith(second)
    functions, _ = _read(tmp_path, text.replace("TORQUE_LIMIT", f"{second}_2"))
    assert [(key, one.key) for key, one in functions.items()] == [
        ("LIMIT", first), ("LIMIT_2", f"{second}_2")
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("place", "is_read"), [(0, True), (1, True), (8, True), (9, True), (10, False)]
)
def test_a_list_has_ten_functions(tmp_path: Any, place: int, is_read: bool) -> None:
    text = PRINTED.replace("function[1]", f"function[{place}]")
    if place == 0:
        text = "\n".join(text.splitlines()[8:])
    if not is_read:
        with pytest.raises(UserError):
            _read(tmp_path, text)
        return
    assert "TORQUE_LIMIT" in _read(tmp_path, text)[0]


@pytest.mark.parametrize(
    ("low", "high", "kept", "warned"),
    [
        # UNS16 by a factor of 10: 0 to 6553.5
        ("2", "300", (2.0, 300.0), []),
        ("0", "6553.5", (0.0, 6553.5), []),
        ("-0.1", "6553.6", (0.0, 6553.5), [70384, 70383]),
        ("-1", "5", (0.0, 5.0), [70384]),
        ("5", "7000", (5.0, 6553.5), [70383]),
        ("300", "2", (2.0, 300.0), [70385]),
        ("7000", "-1", (0.0, 6553.5), [70385, 70384, 70383]),
    ],
)
def test_limits_are_corrected_to_what_the_type_can_hold(
    tmp_path: Any, low: str, high: str, kept: tuple[float, float], warned: list[int]
) -> None:
    """Swapped ones first (P-AXIS-00408, 00409)."""
    text = PRINTED + f"antr.function[1].min_limit {low}\nantr.function[1].max_limit {high}\n"
    functions, warnings = _read(tmp_path, text)
    torque = functions["TORQUE_LIMIT"]
    assert (torque.low, torque.high) == kept
    assert [warning.id for warning in warnings] == warned
    assert {warning.values["key"] for warning in warnings} <= {"TORQUE_LIMIT"}


def test_a_negative_factor_turns_the_limits_of_the_type_around(tmp_path: Any) -> None:
    """SGN16 by -2: -16383.5 to 16384."""
    text = PRINTED.replace("scaling_factor 10.0", "scaling_factor -2.0").replace("UNS16", "SGN16")
    text += "antr.function[1].min_limit -20000\nantr.function[1].max_limit 20000\n"
    functions, warnings = _read(tmp_path, text)
    torque = functions["TORQUE_LIMIT"]
    assert (torque.low, torque.high) == (-16383.5, 16384.0)
    assert [warning.values["corrected"] for warning in warnings] == ["-16383.5", "16384"]
    assert torque.raw(3, "Z") == -6


@pytest.mark.parametrize(("mask", "value"), [("NOT_USED", None), ("0x00F0", 0xF0), ("15", 15)])
def test_a_mask_is_written_in_any_base(tmp_path: Any, mask: str, value: int | None) -> None:
    functions, _ = _read(tmp_path, PRINTED.replace("NOT_USED", mask))
    assert [function.mask for function in functions.values()] == [value, value]


# In an RPDO


class Link:
    """What an RPDO carries, by object."""

    def __init__(self) -> None:
        self.objects = {(0x6072, 1): 0x1234}
        self.settings = SimpleNamespace(increments_per_mm=1000.0)

    def get_object(self, index: int, sub: int) -> int:
        return self.objects[index, sub]

    def set_object(self, index: int, sub: int, value: int) -> None:
        self.objects[index, sub] = value


def cyclic(*functions: DriveFunction) -> tuple[DriveFunctions, Link, Drive]:
    link, drive = Link(), Drive()
    known = {function.key: function for function in functions}
    made: Any = DriveAccess(link, drive, known)  # type: ignore[arg-type]
    return DriveFunctions({"Z": made}), link, drive


@pytest.mark.parametrize(("key", "value"), [("CYCLIC", -3), ("BITS", 0x1254)])
def test_a_cyclic_value_is_taken_with_the_next_cycle(key: str, value: int) -> None:
    """Beside the mask the RPDO carries on what it did; SDO has nothing to do with it."""
    functions, link, drive = cyclic(CYCLIC, BITS)
    for _ in range(2):
        functions.begin(write("Z", key, -3 if key == "CYCLIC" else 0x50))
        assert (link.objects[0x6072, 1], functions.is_busy, drive.asked) == (value, True, [])
        functions.check()
        assert not functions.is_busy
        functions.check()
        assert not functions.is_busy


def test_two_cyclic_values_of_one_cycle_are_both_taken_with_the_next() -> None:
    functions, link, _ = cyclic(CYCLIC, BITS)
    functions.begin(write("Z", "CYCLIC", 0x1200))
    functions.begin(write("Z", "BITS", 0x50))
    assert link.objects[0x6072, 1] == 0x1250
    functions.begin(canon.DriveWait(block(3), "Z"))
    assert functions.is_waiting
    for _ in range(3):
        functions.check()
        assert (functions.is_waiting, functions.is_busy) == (False, False)
    functions.begin(write("Z", "BITS", 0x60))
    assert functions.is_busy
    functions.check()
    assert not functions.is_busy


def test_only_cyclic_values_have_one_from_the_start_on() -> None:
    acyclic = replace(LIMIT, key="A", index=0x6080, startup=5)
    cyclic_one = replace(CYCLIC, key="B", startup=-9)
    functions, link, drive = cyclic(acyclic, cyclic_one, replace(CYCLIC, key="C", sub=2))
    functions.start()
    assert (link.objects, drive.asked) == ({(0x6072, 1): -9}, [])


def test_a_value_that_is_ignored_has_to_be_one_all_the_same() -> None:
    functions, link, drive = cyclic(IGNORE)
    functions.begin(write("Z", "IGNORE", 5))
    assert (functions.is_busy, drive.asked, link.objects[0x6072, 1]) == (False, [], 0x1234)
    for value, alarm_id in ((0.5, 900111), (1e6, 900112)):
        with pytest.raises(Alarm) as caught:
            functions.begin(write("Z", "IGNORE", value))
        assert caught.value.id == alarm_id


# Who waits


def test_a_write_with_wait_holds_the_program_and_a_reset_lets_it_go() -> None:
    functions, _, drive = cyclic(LIMIT)
    functions.begin(write("Z", "LIMIT", 1))
    assert not functions.is_waiting
    functions.begin(replace(write("Z", "LIMIT", 2), waits=True))
    assert functions.is_waiting
    functions.reset()
    assert (functions.is_waiting, functions.is_busy) == (False, True)
    for _ in range(2):
        drive.answer()
    assert not functions.is_busy


@pytest.mark.parametrize("axis", ["Z", "Y"])
def test_a_function_that_is_unknown_is_named_with_those_that_are(axis: str) -> None:
    functions, _, _ = cyclic(LIMIT, CYCLIC)
    with pytest.raises(Alarm) as caught:
        functions.begin(write(axis, "other", 1))
    known = "LIMIT, CYCLIC" if axis == "Z" else "none"
    assert caught.value.id == 900110
    assert (caught.value.values["key"], caught.value.values["known"]) == ("other", known)


def test_functions_are_named_as_the_list_writes_them(tmp_path: Any) -> None:
    """Programs may write a key in any letters, messages have those of the list."""
    found, _ = _read(tmp_path, PRINTED.replace("TORQUE_LIMIT", "Torque_Limit"))
    made: Any = DriveAccess(Link(), Drive(), found)  # type: ignore[arg-type]
    functions = DriveFunctions({"Z": made})
    with pytest.raises(Alarm) as caught:
        functions.begin(write("Z", "other", 1))
    known = str(caught.value.values["known"]).split(", ")
    assert "Torque_Limit" in known
    assert [name.upper() for name in known] == list(found)


def test_a_window_without_a_value_of_the_ident_does_not_hide_a_failure_of_before() -> None:
    """6065 is 0: the tightest window, which S-0-0159 has no number for (0 is off there)."""
    functions, _, drive = cyclic(LIMIT)
    functions.begin(write("Z", "LIMIT", 1))
    drive.refuse()
    functions.begin(canon.DriveRead(block(2), "Z", "S-0-0159", 4))
    drive.answer(bytes(4))
    assert functions.value("Z", "S-0-0159") == 0.0
    with pytest.raises(Alarm) as caught:
        functions.check()
    assert caught.value.id == 900032
    functions.begin(canon.DriveRead(block(2), "Z", "S-0-0159", 4))
    drive.answer(bytes(4))
    with pytest.raises(Alarm) as caught:
        functions.check()
    assert caught.value.id == 900257


def test_the_torque_limit_may_be_0_and_the_largest_number() -> None:
    """S-0-0092 has no value that is off, so that its object takes all of 16 bits."""
    torque = drive_idents(1000.0)["S-0-0092"]
    assert [torque.raw(value, "Z") for value in (0, 0.4, 65535)] == [0, 0, 65535]
    assert [torque.raw(value, "Z") for value in (-0.4, 65535.4)] == [0, 65535]  # nearest to one
    assert torque.can_tell(bytes(2))
    for value in (-0.6, 65535.6, 65536):
        with pytest.raises(Alarm) as caught:
            torque.raw(value, "Z")
        assert (caught.value.id, caught.value.values["value"]) == (900112, f"{value:g}")


def test_a_read_takes_the_ident_that_was_asked_for() -> None:
    functions, _, drive = cyclic(LIMIT)
    functions.begin(read("Z", "LIMIT"))
    functions.begin(canon.DriveRead(block(2), "Z", "S-0-0092", 2))
    drive.answer(b"\x0a\x00")
    drive.answer(b"\x14\x00")
    assert (functions.value("Z", "limit"), functions.value("Z", "S-0-0092")) == (1.0, 20.0)
