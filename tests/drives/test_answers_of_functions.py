"""#DRIVE with answers written by hand: which object is asked, and which failure comes up."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.accesses import AccessesByAxis
from axisrig.kernel.drives.canopen.drive_functions import DriveAccess, DriveFunctions
from axisrig.kernel.drives.cia402.objects import SdoError
from axisrig.kernel.drives.functions import DriveFunction
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

LIMIT = DriveFunction(
    "LIMIT", "ACYCLIC", 0x6072, 1, 0x6077, 2, "SGN16", None, 10.0, -1e199, 1e199, None
)
BITS = replace(LIMIT, key="BITS", mask=0x00F0, factor=1.0)
NOT_THERE = 0x06020000


class Drive:
    """Keeps what is asked of it; the test answers, the oldest question first."""

    def __init__(self) -> None:
        self.asked: list[tuple[int, int, bytes | None]] = []
        self._open: list[tuple[int, int, Callable[[Any], None]]] = []

    def read(self, index: int, sub: int, done: Callable[[Any], None]) -> None:
        self.asked.append((index, sub, None))
        self._open.append((index, sub, done))

    def write(self, index: int, sub: int, data: bytes, done: Callable[[Any], None]) -> None:
        self.asked.append((index, sub, data))
        self._open.append((index, sub, done))

    def answer(self, data: bytes = b"") -> None:
        self._open.pop(0)[2](data)

    def refuse(self, code: int | None = NOT_THERE) -> None:
        index, sub, done = self._open.pop(0)
        done(SdoError(index, sub, code))


def bench(*axes: str) -> tuple[DriveFunctions, dict[str, Drive]]:
    drives = {axis: Drive() for axis in axes}
    known: Any = {"LIMIT": LIMIT, "BITS": BITS}
    link: Any = SimpleNamespace()
    accesses: dict[str, Any] = {
        axis: DriveAccess(link, drive, known)  # type: ignore[arg-type]
        for axis, drive in drives.items()
    }
    return DriveFunctions(accesses), drives


def block(number: int) -> Block:
    return Block(number, 10 * number, "")


def write(axis: str, key: str, value: float, number: int = 1) -> canon.DriveWrite:
    return canon.DriveWrite(block(number), axis, key, value, False)


def read(axis: str, key: str, number: int = 1) -> canon.DriveRead:
    return canon.DriveRead(block(number), axis, key)


def test_a_function_is_read_where_its_list_says_and_written_elsewhere() -> None:
    """`rd_ident` is 6077:2, `wr_ident` 6072:1."""
    functions, drives = bench("Z")
    functions.begin(read("Z", "limit"))
    drives["Z"].answer((250).to_bytes(2, "little"))
    functions.begin(write("Z", "limit", -3))
    drives["Z"].answer()
    assert drives["Z"].asked == [
        (0x6077, 2, None),
        (0x6072, 1, (-30).to_bytes(2, "little", signed=True)),
    ]
    assert functions.value("Z", "LIMIT") == 25.0
    assert not functions.is_busy


@pytest.mark.parametrize(
    ("present", "value", "written"), [(0x1234, 0x50, 0x1254), (0xFFFF, 0x00, 0xFF0F), (0, -1, 0xF0)]
)
def test_the_bits_beside_a_mask_are_those_of_the_object_that_is_written(
    present: int, value: int, written: int
) -> None:
    functions, drives = bench("Z")
    functions.begin(write("Z", "BITS", value))
    drives["Z"].answer(present.to_bytes(2, "little"))
    assert drives["Z"].asked == [(0x6072, 1, None), (0x6072, 1, written.to_bytes(2, "little"))]
    assert functions.is_busy
    drives["Z"].answer()
    assert not functions.is_busy


def test_of_two_failures_in_one_cycle_the_first_one_comes_up() -> None:
    functions, drives = bench("X", "Z")
    functions.begin(write("Z", "LIMIT", 1, number=3))
    functions.begin(write("X", "LIMIT", 1, number=4))
    drives["Z"].refuse()
    drives["X"].refuse(None)
    with pytest.raises(Alarm) as caught:
        functions.check()
    alarm = caught.value
    assert (alarm.id, alarm.values["axis"], alarm.place) == (900032, "Z", "line 3, block N30")
    assert alarm.values["object"] == "0x6072:1"
    functions.check()
    assert not functions.is_busy


def test_a_failure_of_a_later_cycle_comes_up_too() -> None:
    functions, drives = bench("Z")
    for number in (1, 2):
        functions.begin(write("Z", "LIMIT", 1, number))
        drives["Z"].refuse()
        with pytest.raises(Alarm, match=f"N{number}0"):
            functions.check()


def test_what_a_mask_keeps_cannot_be_read_so_nothing_is_written() -> None:
    functions, drives = bench("Z")
    functions.begin(write("Z", "BITS", 0x10))
    drives["Z"].refuse()
    assert len(drives["Z"].asked) == 1
    with pytest.raises(Alarm, match="0x6072:1"):
        functions.check()
    assert not functions.is_busy


def test_a_read_that_fails_leaves_the_value_before_and_names_its_own_object() -> None:
    functions, drives = bench("Z")
    functions.begin(read("Z", "LIMIT"))
    drives["Z"].answer(b"\x0a\x00")
    functions.begin(read("Z", "LIMIT"))
    drives["Z"].refuse()
    assert functions.value("Z", "LIMIT") == 1.0
    with pytest.raises(Alarm, match="0x6077:2"):
        functions.check()


def test_a_read_holds_the_program_until_everything_of_its_axis_is_there_and_of_no_other() -> None:
    functions, drives = bench("X", "Z")
    functions.begin(write("X", "LIMIT", 1))
    functions.begin(write("Z", "LIMIT", 1))
    functions.begin(read("Z", "LIMIT"))
    drives["Z"].answer()
    assert functions.is_waiting
    drives["Z"].answer(b"\x00\x00")
    assert (functions.is_waiting, functions.is_busy) == (False, True)
    drives["X"].answer()
    assert not functions.is_busy


class Family:
    """The functions of the drives of one family; keeps the names of its calls."""

    def __init__(self, name: str, calls: list[str], *, waits: bool = False) -> None:
        self.is_waiting = self.is_busy = waits
        self._name, self._calls = name, calls

    def __getattr__(self, word: str) -> Callable[..., str]:
        def call(*_arguments: object) -> str:
            self._calls.append(f"{self._name}.{word}")
            return self._name

        return call


@pytest.mark.parametrize("waiting", ["none", "first", "second"])
def test_of_several_families_each_axis_has_its_own(waiting: str) -> None:
    """X and Y of the first, Z of the second, no function for W; each family gets a call once."""
    calls: list[str] = []
    first, second = (Family(n, calls, waits=n == waiting) for n in ("first", "second"))
    families: Any = {"X": first, "Y": first, "Z": second}
    accesses = AccessesByAxis(families)
    assert (accesses.is_waiting, accesses.is_busy) == ((waiting != "none",) * 2)
    for word in ("start", "check", "reset"):
        getattr(accesses, word)()
        assert calls == [f"first.{word}", f"second.{word}"]
        calls.clear()
    for axis, name in (("Z", "second"), ("X", "first"), ("Y", "first")):
        accesses.begin(read(axis, "LIMIT"))
        assert accesses.value(axis, "LIMIT") == name
        assert calls == [f"{name}.begin", f"{name}.value"]
        calls.clear()
    with pytest.raises(Alarm) as caught:
        accesses.begin(read("W", "LIMIT"))
    assert (caught.value.id, caught.value.values["axis"], calls) == (900110, "W", [])
