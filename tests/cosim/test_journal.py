"""What is noted of calls into FMUs where somebody watches."""

from collections.abc import Iterator
from pathlib import Path

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
