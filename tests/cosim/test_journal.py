"""What is noted of calls into FMUs where somebody watches."""

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus import ensure_built
from axisrig.kernel.cosim.fmi import journal
from axisrig.kernel.cosim.fmi.fmu import FmuSlave, load_fmu
from axisrig.kernel.time.clock import MS


@pytest.fixture
def note(tmp_path: Path) -> Iterator[Path]:
    path = tmp_path / "first"
    journal.create(path)
    journal.begin(path)
    yield path
    journal._OPEN.clear()


def last(path: Path) -> journal.LastCall:
    call = journal.last_call(path)
    assert call is not None
    return call


def axis() -> FmuSlave:
    return load_fmu(ensure_built("AxisRig.Drives.ServoAxis"), "z")


def test_an_instance_that_is_kept_goes_on_in_the_notes_of_the_next_task(note: Path) -> None:
    slave = axis()
    slave.initialize(0)
    before = last(note)
    other = note.with_name("second")
    journal.create(other)
    journal.begin(other)
    assert journal.last_call(other) is None
    slave.step_to(MS)
    call = last(other)
    assert (call.number, call.function, call.instance) == (1, "fmi3DoStep", "z")
    assert not call.is_inside
    assert last(note) == before
    third = note.with_name("third")
    journal.create(third)
    journal.begin(third)
    slave.step_to(2 * MS)  # the same function again: its names are in the new file too
    again = last(third)
    assert (again.number, again.function, again.instance) == (1, "fmi3DoStep", "z")
    assert again.file == call.file
    slave.close()


@pytest.mark.parametrize(("is_own", "function"), [(False, "fmi3GetFloat64"), (True, "fmi3DoStep")])
def test_of_an_own_fmu_gets_and_sets_are_not_noted(note: Path, is_own: bool, function: str) -> None:
    slave = axis()
    slave.is_own = is_own
    slave.initialize(0)
    slave.step_to(MS)
    slave.get("position")
    assert last(note).function == function
    slave.close()


@pytest.mark.usefixtures("note")
@pytest.mark.parametrize("is_own", [False, True])
@pytest.mark.parametrize(
    ("name", "comes_back"),
    [("fmi2GetReal", True), ("fmi3SetFloat64", True), ("fmi3DoStep", False),
     ("fmi2DoStep", False), ("fmi3EnterInitializationMode", False), ("load", False)],
)  # fmt: skip
def test_what_may_never_come_back_is_noted_of_an_own_fmu_too(
    name: str, comes_back: bool, is_own: bool
) -> None:
    """A step of a model may hang, whoever has built it; its gets and sets do not."""
    slave: Any = SimpleNamespace(is_own=is_own, path=Path("a.fmu"), name="z", time_ns=0)
    assert (FmuSlave._watched(slave, name, len) is len) is (is_own and comes_back)


class Slave:
    time_ns = 3 * MS


def test_a_call_is_inside_until_it_comes_back_whatever_its_names_are(note: Path) -> None:
    """Names are cut to whole letters at 250, 150 and 70 bytes, and a NUL in them is none."""
    seen: list[journal.LastCall] = []

    def call(*values: int) -> int:
        seen.append(last(note))
        return sum(values)

    names = ("\u00e4" * 300, "z\0" + "i" * 200, "f" * 100)
    watched = journal.watched(call, *names, Slave())
    assert watched(1, 2) == 3
    after = last(note)
    assert (seen[0].is_inside, after.is_inside) == (True, False)
    for found in (seen[0], after):
        assert (found.number, found.time_ns) == (1, 3 * MS)
        assert found.file == "\u00e4" * 125
        assert (found.instance, found.function) == ("z?" + "i" * 148, "f" * 70)


def test_a_call_that_fails_has_come_back_too(note: Path) -> None:
    def call() -> None:
        raise OSError("gone")

    for number in (1, 2):
        with pytest.raises(OSError, match="gone"):
            journal.watched(call, "plc.fmu", "", "fmi2DoStep", Slave())()
        found = last(note)
        assert (found.number, found.is_inside) == (number, False)
    assert found.what == "the PLC program plc.fmu"
    assert str(found) == "fmi2DoStep at t = 3.000000 ms of the PLC program (plc.fmu)"


def test_who_is_not_watched_calls_at_once_and_has_no_notes(tmp_path: Path) -> None:
    assert not journal.is_open()
    assert journal.watched(len, "a.fmu", "a", "f", Slave()) is len
    assert journal.last_call(tmp_path / "missing") is None
    for content in (b"", bytes(23), bytes(504)):  # cut, and never called
        (tmp_path / "note").write_bytes(content)
        assert journal.last_call(tmp_path / "note") is None
