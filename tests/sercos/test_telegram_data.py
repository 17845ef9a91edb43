"""The cyclic values of a SERCOS drive with telegrams written by hand."""

import struct

import pytest

from axisrig.kernel.drives.cia402.cyclic_data import TAKEN
from axisrig.kernel.drives.ethercat.settings import Pdo, SlaveSettings
from axisrig.kernel.drives.ethercat.slave_data import Silent
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.drives.sercos.data import TelegramData

POSITIVE, NEGATIVE, OTHER = 130, 131, 132
AT = (
    MappedObject(135, 0, 16, False, "statusword"),
    MappedObject(51, 0, 32, True, "actual"),
    MappedObject(POSITIVE, 0, 32, True, ""),
    MappedObject(NEGATIVE, 0, 32, True, ""),
)
MDT = (
    MappedObject(134, 0, 16, False, "controlword"),
    MappedObject(47, 0, 32, True, "target"),
)


def data() -> TelegramData:
    settings = SlaveSettings(
        "Z", 1000.0, node_id=1, inputs=[Pdo(0, AT)], outputs=[Pdo(0, MDT)]
    )  # fmt: skip
    made = TelegramData(settings, POSITIVE)
    made.begin()
    return made


def telegram(place: int) -> bytes:
    return struct.pack("<Hiii", 0xC000, place, 1300, -1310)


def taken(made: TelegramData) -> dict[str, int]:
    found = zip(TAKEN, made.take(), strict=True)
    return {name: value for name, value in found if value is not None}


def test_a_telegram_that_stays_out_disturbs_its_own_cycle_only() -> None:
    """There, out, out, there, out: what is missing is counted in a row."""
    made, found = data(), []
    for place in (7, None, None, -8, None):
        made.forget()
        if place is not None:
            made.arrived(telegram(place))
        actual = taken(made).get("actual")
        found.append((actual, made.missing[0], made.is_disturbed))
    assert found == [
        (7, 0, False),
        (None, 1, True),
        (None, 2, True),
        (-8, 0, False),
        (None, 1, True),
    ]


def test_a_telegram_is_taken_once() -> None:
    made = data()
    made.arrived(telegram(7))
    assert taken(made) == {"statusword": 0xC000, "actual": 7, "latch": 1300}
    assert taken(made) == {}


def test_the_measured_value_is_that_of_the_edge_in_use() -> None:
    """There and back; an ident that the AT does not have changes nothing."""
    made = data()
    for ident, latch in ((NEGATIVE, -1310), (POSITIVE, 1300), (NEGATIVE, -1310)):
        assert made.choose_latch(ident, 0)
        made.arrived(telegram(0))
        assert taken(made)["latch"] == latch
        assert not made.choose_latch(OTHER, 0)
        made.arrived(telegram(0))
        assert taken(made)["latch"] == latch
    assert [made.carries(ident) for ident in (POSITIVE, NEGATIVE, OTHER)] == [True, True, False]


@pytest.mark.parametrize(("refused", "alarm_id"), [(True, 900731), (False, 900730)])
def test_why_it_is_missing_is_that_of_the_last_frame(refused: bool, alarm_id: int) -> None:
    made = data()
    for cause in (not refused, refused):
        made.forget()
        if cause:
            made.refused(1, 3)
        assert taken(made) == {}
    alarm = made.missing_alarm("Z", 0)
    assert (alarm.id, alarm.values["cycles"]) == (alarm_id, 2)
    if refused:
        assert (alarm.values["counter"], alarm.values["expected"]) == (1, 3)


def test_why_inputs_are_missing_is_that_of_the_last_cycle() -> None:
    """No frame; a counter that nobody can explain; a slave that is known to be silent, until
    inputs come again or the exchange begins anew.
    """
    made, found = data(), []
    silent = Silent("Y", 2, 1, 3)
    for event in ("none", "refused", "silent", "none", "refused", "inputs", "refused", "begin"):
        made.forget()
        if event == "silent":
            made.silent = silent
        if event in ("silent", "refused"):
            made.refused(4, 6)
        if event == "inputs":
            made.arrived(telegram(0))
        if event == "begin":
            made.begin()
            found.append((0, made.missing[0]))
            continue
        made.take()
        if made.is_disturbed:
            alarm = made.missing_alarm("Z", 0)
            found.append((alarm.id, *alarm.values.values()))
    assert found == [
        (900730, "Z", 1), (900731, "Z", 2, 4, 6), (900733, "Y", 2, 3, 1, 3), (900730, "Z", 4),
        (900733, "Y", 2, 5, 1, 3), (900731, "Z", 1, 4, 6), (0, 0),
    ]  # fmt: skip


def test_with_begin_nothing_is_missing_and_nothing_has_come() -> None:
    """What stayed out or came while the slaves were started is not of the exchange."""
    made = data()
    for frames in ((None, None, None), (7,), (None, 7, None)):
        for place in frames:
            made.forget()
            if place is not None:
                made.arrived(telegram(place))
            else:
                made.take()
        made.begin()
        assert (made.missing[0], made.is_disturbed) == (0, False)
        assert taken(made) == {}
        assert made.missing_alarm("Z", 0).values["cycles"] == 1
        made.begin()
