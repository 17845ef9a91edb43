"""Which SyncManagers fit the process data and the mailbox of a drive."""

from itertools import pairwise
from struct import Struct
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.description import describe
from axisrig.bench.drive.ethercat.fitting import Fitting


class Fit:
    """A drive with SyncManagers as its EEPROM has them, and the bytes of its process data."""

    def __init__(self, outputs: int, inputs: int) -> None:
        self.description = describe(DriveProfile())
        self.managers = [
            SimpleNamespace(start=m.start, length=m.length, control=m.control, is_enabled=True)
            for m in self.description.managers
        ]
        self.managers[2].length, self.managers[3].length = outputs, inputs
        for number, size in ((2, outputs), (3, inputs)):
            self.managers[number].is_enabled = size > 0

        def layout(size: int) -> Any:
            return SimpleNamespace(codec=Struct(f"{size}s"))

        managers: Any = self.managers
        data: Any = SimpleNamespace(outputs=layout(outputs), inputs=layout(inputs))
        self.made = Fitting(self.description, managers, data)


@pytest.mark.parametrize(("outputs", "inputs"), [(8, 12), (0, 12), (8, 0), (0, 0)])
def test_what_carries_something_is_on_and_what_carries_nothing_off(
    outputs: int, inputs: int
) -> None:
    fit = Fit(outputs, inputs)
    assert fit.made.wrong() is None
    for number, name, size in ((2, "INVALID_OUTPUTS", outputs), (3, "INVALID_INPUTS", inputs)):
        manager = fit.managers[number]
        manager.is_enabled = not manager.is_enabled
        assert fit.made.wrong() == name
        manager.is_enabled = not manager.is_enabled
        if size:
            for key, change in (("length", 1), ("length", -1), ("control", 0x04), ("control", 2)):
                before = getattr(manager, key)
                setattr(manager, key, before + change if key == "length" else before ^ change)
                assert fit.made.wrong() == name
                setattr(manager, key, before)
            manager.start += 0x100  # it may be anywhere
            manager.control ^= 0x20  # the interrupt is of the slave alone
        assert fit.made.wrong() is None


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize(
    ("key", "change"), [("start", 2), ("length", 1), ("control", 0x04), ("is_enabled", 1)]
)
def test_both_mailboxes_are_as_the_eeprom_has_them(number: int, key: str, change: int) -> None:
    fit = Fit(8, 12)
    assert fit.made.has_mailbox()
    manager = fit.managers[number]
    setattr(manager, key, getattr(manager, key) ^ change)
    assert not fit.made.has_mailbox()
    assert fit.made.wrong() is None


@pytest.mark.parametrize("size", [32, 128, 200, 1024])
def test_the_mailboxes_lie_one_behind_the_other_before_the_process_data(size: int) -> None:
    managers = describe(DriveProfile(), mailbox_bytes=size).managers
    assert [(m.start, m.length, m.kind) for m in managers[:2]] == [
        (0x1000, size, 1), (0x1000 + size, size, 2)
    ]  # fmt: skip
    ends = [(m.start, m.start + m.length) for m in managers]
    assert all(end <= begin for (_, end), (begin, _) in pairwise(ends))
