"""What is wrong with a SERCOS drive in a cycle, and what is reported once in a program."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.sercos.test_drive_by_hand import C1D, FOLLOWS, OPERATES, Bench

from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.drives.sercos.watch import SercosWatch
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.ethercat.tables import AlState

INIT, SAFEOP, ERROR = AlState.INIT, AlState.SAFEOP, 0x10


class Watched(Bench):
    """A drive on a line whose slave shows `shown`; warned: IDs."""

    def __init__(self) -> None:
        super().__init__(jump_mm=1.0)
        self.shown: int | None = None
        self.warned: list[int] = []
        self.watching: list[str | None] = []
        self.drive.warn = lambda alarm: self.warned.append(alarm.id)
        carrier: Any = SimpleNamespace(
            watch=self.watching.append, watch_no_more=lambda: self.watching.append(None),
            fallen=self._fallen, slaves={"Z": self},
        )  # fmt: skip
        self.watch = SercosWatch(self.drive, carrier)
        self.watch.begin()

    @property
    def status(self) -> int | None:
        return self.shown

    def _fallen(self, axis: str) -> Alarm | None:
        if self.shown is None:
            return None
        return Alarm(900732, axis=axis, position=1, state="?", code="0")

    def looks(self, *shown: int | None) -> list[int | None]:
        found = []
        for self.shown in shown:
            alarm = self.watch.communication()
            found.append(alarm and alarm.id)
        return found


@pytest.mark.parametrize("phase_0", [INIT, INIT | ERROR])
def test_phase_0_is_a_warning_once_in_each_program(phase_0: int) -> None:
    watched = Watched()
    for number in (1, 2):
        assert watched.looks(None, SAFEOP, SAFEOP | ERROR) == [None, 900732, 900732]
        assert watched.warned == [140029] * (number - 1)
        assert watched.looks(phase_0, phase_0, None, phase_0) == [900732, 900732, None, 900732]
        assert watched.warned == [140029] * number
        watched.watch.end()
        watched.watch.begin()
    assert watched.watching == ["Z", None, "Z", None, "Z"]


def test_a_jump_is_one_while_the_drive_operates_and_reported_once() -> None:
    watched = Watched()
    for place, is_jump in ((0, False), (500, False), (5000, True), (5100, False)):
        watched.cycle(OPERATES | FOLLOWS, place)
        assert watched.looks(None, None) == [900029 if is_jump else None, None]
    watched.cycle(0x8000, 9000)
    assert watched.looks(None) == [None]


@pytest.mark.parametrize(
    ("status", "alarm_id", "state"),
    [
        (OPERATES | FOLLOWS, None, None), (0x8000, 900027, "POWER_READY"),
        (0x4000, 900027, "LOGIC_READY"), (0, 900027, "NOT_READY"), (C1D, 900005, None),
    ],
)  # fmt: skip
def test_a_drive_that_leaves_operation_is_an_alarm_unless_it_is_to_stop(
    status: int, alarm_id: int | None, state: str | None
) -> None:
    watched = Watched()
    watched.drive.order(PowerOrder.SWITCH_ON)
    watched.cycle(OPERATES | FOLLOWS)
    watched.cycle(status)
    found = watched.watch.condition()
    assert (found and found.id) == alarm_id
    if found is not None:
        assert found.values["statusword"] == f"0x{status:04X}"
        assert found.values.get("state") == state
    watched.drive.order(PowerOrder.STOP)
    assert watched.watch.condition() is None
