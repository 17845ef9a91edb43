"""What a start-up writes of one PDO: identifier, mapping, type and times, in the order of CiA 301.

1400 and 1800 are the communication parameters of RPDO1 and TPDO1, 1600 and 1A00 their mappings.
Sub-index 1 is the COB-ID (bit 31: switched off), 2 the type, 3 the inhibit time, 5 the event timer.
"""

from copy import copy, deepcopy
from fractions import Fraction
from typing import Final

import pytest
from canopen.objectdictionary import ObjectDictionary

from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.drives.canopen.mapping import Telegram
from axisrig.kernel.drives.canopen.startup_steps import (
    BusSettings,
    Scaling,
    StartUpSettings,
    Write,
    start_up_steps,
)
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.errors import UserError

NODE: Final = 3
OFF: Final = 1 << 31
TORQUE = MappedObject(0x6072, 0, 16, False, "")
TARGET = MappedObject(0x607A, 0, 32, True, "target")
STATUS = MappedObject(0x6041, 0, 16, False, "statusword")
INPUTS = MappedObject(0x60FD, 0, 32, False, "inputs")
ENTRIES = {TORQUE: 0x60720010, TARGET: 0x607A0020, STATUS: 0x60410010, INPUTS: 0x60FD0020}
"""Index, sub-index and bits (CiA 301, mapping entry)."""
CYCLIC, OTHERS = (1, 2, 240), (0, 241, 254, 255)
"""Transmission types that come with a SYNC, and those that do not (CiA 301)."""

Places = dict[tuple[int, int], int | str | None]


def dictionary(changes: Places | None = None) -> ObjectDictionary:
    """That of our own drive. changes: of a variable its access or its default; None: it is gone."""
    od = copy(object_dictionary(NODE, DriveProfile()))
    pdos = {index: deepcopy(od[index]) for index in (0x1400, 0x1600)}  # others share the dictionary
    od.indices = {**od.indices, **pdos}
    for (index, sub), change in (changes or {}).items():
        found = od[index][sub]
        if change is None:
            del od[index].subindices[sub]
        elif isinstance(change, str):
            found.access_type = change
        else:
            found.default = change
    return od


def writes(
    telegram: Telegram, timeout_ms: int = 0, od: ObjectDictionary | None = None
) -> list[tuple[int, int, int]]:
    """What is written of this PDO."""
    index = telegram.communication_index
    steps = start_up_steps(
        StartUpSettings(rpdo_timeout_ms=timeout_ms, scaling_check=False),
        BusSettings(), {telegram.name: telegram}, NODE, Scaling(1, 1), od or dictionary(),  # type: ignore[arg-type]
    )  # fmt: skip
    return [
        (step.index, step.sub, int.from_bytes(step.data, "little"))
        for step in steps
        if isinstance(step, Write) and step.index in (index, index + 0x200)
    ]


def cob_id(name: str) -> int:
    """Of the pre-defined connection set: TPDOs from 180 on, RPDOs from 200 on, 100 apart."""
    return (0x200 if name[0] == "R" else 0x180) + 0x100 * (int(name[4]) - 1) + NODE


@pytest.mark.parametrize(
    ("name", "objects"),
    [
        ("RPDO1", (TORQUE, TARGET)), ("RPDO2", (TARGET,)), ("RPDO4", (TARGET, TORQUE)),
        ("TPDO1", (STATUS, INPUTS)), ("TPDO3", (INPUTS,)), ("TPDO4", (INPUTS, STATUS)),
    ],
)  # fmt: skip
def test_a_pdo_is_off_while_it_is_mapped(name: str, objects: tuple[MappedObject, ...]) -> None:
    at = (0x1400 if name[0] == "R" else 0x1800) + int(name[4]) - 1
    of_objects = [(at + 0x200, n, ENTRIES[mapped]) for n, mapped in enumerate(objects, 1)]
    assert writes(Telegram(name, 1, 0, objects)) == [
        (at, 1, cob_id(name) | OFF),
        (at + 0x200, 0, 0),
        *of_objects,
        (at + 0x200, 0, len(objects)),
        (at, 2, 1),
        (at, 1, cob_id(name)),
    ]


@pytest.mark.parametrize("name", ["RPDO1", "TPDO1"])
def test_an_identifier_of_its_own_stands_in_both_places(name: str) -> None:
    objects = (TARGET,) if name[0] == "R" else (INPUTS,)
    found = writes(Telegram(name, 1, 0, objects, identifier=0x3C5))
    assert [value for _, sub, value in (found[0], found[-1])] == [0x3C5 | OFF, 0x3C5]


@pytest.mark.parametrize("number", [*CYCLIC, *OTHERS])
@pytest.mark.parametrize("name", ["RPDO1", "TPDO1"])
def test_the_type_is_written_as_the_table_has_it(name: str, number: int) -> None:
    objects = (TARGET,) if name[0] == "R" else (INPUTS,)
    at = 0x1400 if name[0] == "R" else 0x1800
    found = writes(Telegram(name, number, 0, objects))
    assert [value for index, sub, value in found if (index, sub) == (at, 2)] == [number]


@pytest.mark.parametrize(
    ("default", "is_off_as"),
    [
        (0x1C1, 0x1C1), (0x1C1 | OFF, 0x1C1), (1 << 30 | 0x183, 1 << 30 | 0x183),
        (0x203, 0x203), (None, 0x283), (0, 0x283),
    ],
)  # fmt: skip
@pytest.mark.parametrize("access", ["rw", "ro"])
def test_a_tpdo_that_nobody_uses_is_off_with_the_identifier_that_it_has(
    default: int | None, is_off_as: int, access: str
) -> None:
    """Of its file; where that says none, the one of the pre-defined connection set.

    One that cannot be written is not: `axisrig check` names it.
    """
    od = dictionary()
    od.indices[0x1801] = deepcopy(od[0x1801])
    od[0x1801][1].default, od[0x1801][1].access_type = default, access
    steps = start_up_steps(
        StartUpSettings(scaling_check=False), BusSettings(),
        {"TPDO1": Telegram("TPDO1", 1, 0, (STATUS,))}, NODE, Scaling(1, Fraction(1)), od,
    )  # fmt: skip
    found = [step for step in steps if isinstance(step, Write) and step.index == 0x1801]
    assert [(each.sub, int.from_bytes(each.data, "little")) for each in found] == [
        (1, is_off_as | OFF)
    ] * (access == "rw")


# Times


@pytest.mark.parametrize("number", [*CYCLIC, *OTHERS])
@pytest.mark.parametrize("name", ["RPDO1", "RPDO3", "TPDO1", "TPDO3"])
@pytest.mark.parametrize("timeout_ms", [0, 1, 50])
def test_only_an_rpdo_of_every_sync_has_the_deadline(
    name: str, number: int, timeout_ms: int
) -> None:
    """In 14xx:5 it is a watch; in 18xx:5 it would be a timer by which the drive sends."""
    objects = (TARGET,) if name[0] == "R" else (INPUTS,)
    found = writes(Telegram(name, number, 0, objects), timeout_ms)
    is_watched = name[0] == "R" and number in CYCLIC and timeout_ms > 0
    at = (0x1400 if name[0] == "R" else 0x1800) + int(name[4]) - 1
    times = [write for write in found if write[0] == at and write[1] in (3, 5)]
    assert times == ([(at, 5, timeout_ms)] if is_watched else [])


@pytest.mark.parametrize("access", ["ro", "const", None])
def test_a_drive_that_takes_no_deadline_gets_none(access: str | None) -> None:
    """And everything else all the same."""
    telegram = Telegram("RPDO1", 1, 0, (TARGET,))
    found = writes(telegram, 50, dictionary({(0x1400, 5): access}))
    assert found == writes(telegram, 0)
    assert (0x1400, 5, 50) in writes(telegram, 50)


@pytest.mark.parametrize("inhibit_100us", [0, 1, 250])
@pytest.mark.parametrize("event_ms", [0, 1, 500])
@pytest.mark.parametrize("timeout_ms", [0, 50])
def test_a_tpdo_keeps_its_own_times(inhibit_100us: int, event_ms: int, timeout_ms: int) -> None:
    """After the type and before it is switched on; 0 is written nowhere."""
    found = writes(Telegram("TPDO3", 254, inhibit_100us, (INPUTS,), event_ms=event_ms), timeout_ms)
    times = [(0x1802, 3, inhibit_100us), (0x1802, 5, event_ms)]
    assert found[-1] == (0x1802, 1, cob_id("TPDO3"))
    begin = found.index((0x1802, 2, 254)) + 1
    assert found[begin:-1] == [time for time in times if time[2]]


# What a drive has fixed


def fixed(index: int, values: list[int]) -> Places:
    """A mapping of these values that cannot be written."""
    places: Places = {}
    for sub, value in enumerate(values):
        places[index, sub] = value
    return places


def read_only(od: ObjectDictionary, *places: tuple[int, int]) -> ObjectDictionary:
    for index, sub in places:
        od[index][sub].access_type = "ro"
    return od


@pytest.mark.parametrize("remote", [0, 1 << 30])
@pytest.mark.parametrize("identifier", [0, 0x3C5])
def test_an_identifier_that_is_fixed_is_not_written(remote: int, identifier: int) -> None:
    """Where it is the one that is wanted; bit 30 is the drive's own affair. Nothing is off then."""
    wanted = identifier or cob_id("RPDO1")
    od = read_only(dictionary({(0x1400, 1): wanted | remote}), (0x1400, 1))
    found = writes(Telegram("RPDO1", 1, 0, (TARGET,), identifier=identifier), 0, od)
    assert [write for write in found if write[:2] == (0x1400, 1)] == []
    assert found == [(0x1600, 0, 0), (0x1600, 1, 0x607A0020), (0x1600, 0, 1), (0x1400, 2, 1)]


@pytest.mark.parametrize("other", [0x204, 0x203 | OFF, 0x283])
def test_another_identifier_that_is_fixed_is_refused_with_both(other: int) -> None:
    od = read_only(dictionary({(0x1400, 1): other}), (0x1400, 1))
    with pytest.raises(UserError, match="RPDO1 has an identifier that the drive does not") as error:
        writes(Telegram("RPDO1", 1, 0, (TARGET,)), 0, od)
    assert (error.value.value, error.value.allowed) == ("0x203", f"0x{other:X}")
    assert "0x1400:1 is ro" in error.value.message


@pytest.mark.parametrize("differs", [None, 0, 1, 2])
def test_a_mapping_that_is_fixed_is_left_alone_if_it_is_the_one(differs: int | None) -> None:
    """Number and each entry; where one differs it is written, and the drive has to refuse it."""
    values = [2, ENTRIES[TARGET], ENTRIES[TORQUE]]
    if differs is not None:
        values[differs] = 1 if differs == 0 else 0x60FF0020
    od = dictionary(fixed(0x1600, values))
    telegram = Telegram("RPDO1", 1, 0, (TARGET, TORQUE))
    read_only(od, *((0x1600, sub) for sub in range(3)))
    if differs is None:
        found = writes(telegram, 0, od)
        assert found == [(0x1400, 1, 0x203 | OFF), (0x1400, 2, 1), (0x1400, 1, 0x203)]
    else:
        with pytest.raises(UserError, match="does not let the object be written"):
            writes(telegram, 0, od)


@pytest.mark.parametrize("number", [1, 240])
def test_a_type_that_is_fixed_is_left_alone_if_it_is_the_one(number: int) -> None:
    telegram = Telegram("RPDO1", number, 0, (TARGET,))
    od = read_only(dictionary({(0x1400, 2): number}), (0x1400, 2))
    assert [write for write in writes(telegram, 0, od) if write[:2] == (0x1400, 2)] == []
    other = read_only(dictionary({(0x1400, 2): 255}), (0x1400, 2))
    with pytest.raises(UserError, match="does not let the object be written"):
        writes(telegram, 0, other)


def test_what_is_as_wanted_and_can_be_written_is_written() -> None:
    """A default is no proof: the drive may have stored something else."""
    od = dictionary({(0x1400, 1): 0x203, (0x1400, 2): 1, (0x1600, 0): 1})
    telegram = Telegram("RPDO1", 1, 0, (TARGET,))
    assert writes(telegram, 0, od) == writes(telegram)


def test_limits_of_an_eds_do_not_count_on_the_way() -> None:
    """A COB-ID with bit 31, and a mapping of 0 entries, are those of CiA 301."""
    od = dictionary()
    od[0x1400][1].min, od[0x1400][1].max = 1, 0x7FF
    od[0x1600][0].min, od[0x1600][0].max = 1, 8
    telegram = Telegram("RPDO1", 1, 0, (TARGET,))
    assert writes(telegram, 0, od) == writes(telegram)
