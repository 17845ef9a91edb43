"""What a drive of CiA 402 says of its faults: emergencies, 603F, 1003, and what becomes of it."""

from typing import Any

import pytest
from tests.drives.test_link_by_hand import OPERATION_ENABLED, Wire, _link

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.watch import LinkWatch, WatchSettings
from axisrig.kernel.drives.cia402.active_fault import ActiveFault
from axisrig.kernel.drives.cia402.objects import Done, SdoError
from axisrig.kernel.drives.cia402.watch import EMERGENCY_CYCLES
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.scheduler import new_scheduler

CODE, HISTORY = (0x603F, 0), (0x1003, 1)
SWITCHED_ON, QUICK_STOP, REACTING, FAULT = 0x1233, 0x1217, 0x121F, 0x0218
EMERGENCY_ID = 0x083
WARNING, STOP, NONE = b"\x20\x81", b"\x11\x86", b"\x00\x00"
"""By `emergency_codes.csv` 8120 (error passive) warns, 8611 (following error) stops, 0 is none."""


class Objects:
    """Keeps questions until they are answered: bytes, or None for an object that is missing."""

    def __init__(self) -> None:
        self.asked: dict[tuple[int, int], Done] = {}

    def read(self, index: int, sub: int, done: Done) -> None:
        self.asked[index, sub] = done

    def answer(self, place: tuple[int, int], data: str | None) -> None:
        done = self.asked.pop(place)
        done(SdoError(*place, 0x06020000) if data is None else bytes.fromhex(data))


# Asking


@pytest.mark.parametrize(
    ("code", "history", "words"),
    [
        ("1086", "00000000", "none, but 0x603F:0 says 0x8610, positioning"),
        ("0000", "11860000", "none, but 0x1003:1 says 0x8611, following error"),
        (
            "1043", "1043 EFBE",  # the upper word is the manufacturer's
            "none, but 0x603F:0 and 0x1003:1 say 0x4310, excess temperature of the drive",
        ),
        (
            "1043", "0573 0000",
            "none, but 0x603F:0 says 0x4310, excess temperature of the drive and 0x1003:1 says"
            " 0x7305, incremental encoder 1",
        ),
        ("0000", "00000000", "none"),
        (None, "0573 0000", "none, but 0x1003:1 says 0x7305, incremental encoder 1"),
        ("0573", None, "none, but 0x603F:0 says 0x7305, incremental encoder 1"),
        (None, None, "none"),
    ],
)  # fmt: skip
def test_a_fault_that_nobody_has_heard_of_is_in_603f_and_in_the_history(
    code: str | None, history: str | None, words: str
) -> None:
    objects: Any = Objects()
    fault = ActiveFault(objects)
    assert not fault.is_open
    fault.ask()
    assert list(objects.asked) == [CODE, HISTORY]
    for place, data in ((CODE, code), (HISTORY, history)):
        assert fault.is_open
        objects.answer(place, data)
    assert not fault.is_open
    assert str(fault) == words


def test_a_drive_that_cannot_be_asked_says_nothing() -> None:
    fault = ActiveFault(None)
    fault.ask()
    assert (fault.is_open, str(fault)) == (False, "none")


def asked_link() -> tuple[AxisLink, Wire, Any]:
    link, wire = _link()
    objects: Any = Objects()
    link.sdo = objects
    return link, wire, objects


def test_the_alarm_of_a_fault_names_what_was_asked_until_it_is_forgotten() -> None:
    link, _, objects = asked_link()

    def found() -> object:
        return link.fault().values["emcy"]

    assert (found(), link.is_asked) == ("none", False)
    link.ask_for_fault()
    assert link.is_asked
    objects.answer(CODE, "0573")
    assert link.is_asked
    objects.answer(HISTORY, None)
    assert not link.is_asked
    assert found() == "none, but 0x603F:0 says 0x7305, incremental encoder 1"
    link.acknowledges_faults = True
    link.forget_fault()
    assert (found(), link.is_asked, link.acknowledges_faults) == ("none", False, False)


# Emergencies


def emergency(wire: Wire, code: bytes, register: int = 0x21) -> None:
    wire._bring(EMERGENCY_ID, code + bytes((register,)) + b"\1\2\3\4\5")


def test_an_emergency_counts_until_it_is_forgotten_and_one_of_no_error_never() -> None:
    link, wire = _link()
    emergency(wire, NONE)
    assert not link.has_reported
    emergency(wire, STOP)
    emergency(wire, NONE)  # an error that has gone takes nothing back
    assert link.has_reported
    alarm = link.fault()
    assert alarm.id == 900005
    assert alarm.values["emcy"] == "0x8611, following error, error register 0x21"
    link.forget_fault()
    assert not link.has_reported


def test_what_a_drive_reports_by_itself_counts_before_what_it_is_asked() -> None:
    link, wire, objects = asked_link()
    link.ask_for_fault()
    objects.answer(CODE, "0573")
    emergency(wire, STOP, 0x01)
    assert link.fault().values["emcy"] == "0x8611, following error, error register 0x01"


def test_emergencies_of_the_start_up_do_not_count() -> None:
    link, wire = _link()
    emergency(wire, STOP)
    link.begin()
    assert not link.has_reported


# The watch


class Watched:
    """A drive that was in operation, and its watch; each look is one cycle."""

    def __init__(self) -> None:
        self.link, self.wire = _link(lag_limit_mm=1.0)
        self.link.order(PowerOrder.SWITCH_ON)
        self.watch = LinkWatch(self.link, new_scheduler(), WatchSettings())
        assert self.look(OPERATION_ENABLED) is None

    def look(self, word: int, place: int = 0) -> Alarm | None:
        self.wire.status(word, place)
        self.wire.latch()
        self.link.take()
        self.link.send(0.0)
        return self.watch.condition()


def ids(*alarms: Alarm | None) -> list[int | None]:
    return [alarm and alarm.id for alarm in alarms]


@pytest.mark.parametrize(
    ("word", "alarm_id", "state"),
    [
        (SWITCHED_ON, 900027, "SWITCHED_ON"), (QUICK_STOP, 900027, "QUICK_STOP_ACTIVE"),
        (FAULT, 900005, None),
    ],
)  # fmt: skip
def test_a_drive_that_leaves_operation_is_an_alarm_unless_it_was_stopped(
    word: int, alarm_id: int, state: str | None
) -> None:
    drive = Watched()
    found = drive.look(word)
    assert found is not None
    assert (found.id, found.values["statusword"]) == (alarm_id, f"0x{word:04X}")
    assert found.values.get("state") == state
    drive.link.order(PowerOrder.STOP)
    assert drive.look(word) is None


def test_the_lag_is_watched_in_operation_alone() -> None:
    drive = Watched()
    assert ids(drive.look(OPERATION_ENABLED, 1001), drive.look(SWITCHED_ON, 1001)) == [
        900036, 900027,
    ]  # fmt: skip


@pytest.mark.parametrize(("code", "alarm_id"), [(WARNING, 900035), (STOP, 900025)])
@pytest.mark.parametrize("word", [OPERATION_ENABLED, SWITCHED_ON])
def test_an_emergency_is_an_alarm_of_its_own_where_no_fault_explains_it(
    code: bytes, alarm_id: int, word: int
) -> None:
    """Two cycles are waited for the status word; then it is reported, once; the next one too."""
    drive = Watched()
    for _ in range(2):
        emergency(drive.wire, code)
        found = [drive.look(word) for _ in range(EMERGENCY_CYCLES)]
        assert ids(*found) == [None] * (EMERGENCY_CYCLES - 1) + [alarm_id]
        assert not drive.link.has_reported
        assert drive.look(OPERATION_ENABLED) is None


@pytest.mark.parametrize("word", [REACTING, FAULT])
def test_the_fault_that_explains_an_emergency_is_the_alarm(word: int) -> None:
    drive = Watched()
    emergency(drive.wire, STOP)
    assert drive.look(OPERATION_ENABLED) is None
    found = drive.look(word)
    assert found is not None
    assert (found.id, str(found.values["emcy"])[:6]) == (900005, "0x8611")
