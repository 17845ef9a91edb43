"""The PDOs of a drive as they arrive: which count for a SYNC, which are missing, and why."""

import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from tests.drives.test_link_by_hand import Wire

from axisrig.kernel.drives.canopen.mapping import telegrams
from axisrig.kernel.drives.canopen.process_data import ProcessData
from axisrig.kernel.drives.canopen.sparse import SparseData
from axisrig.kernel.drives.cia402.cyclic_data import TAKEN
from axisrig.kernel.errors import Alarm

OPERATION_ENABLED, SWITCHED_ON = 0x1237, 0x1233
NO_STATE = 0x0001
"""Bit 0 alone is no pattern of the state machine of CiA 402."""
STAYED_OUT, CONTRADICTED, WRONG_STATE = 900006, 900080, 900081
COLUMNS = "pdo,transmission,inhibit_100us,index,sub,bits,signed,field\n"
SENT = "RPDO1,1,0,0x6040,0,16,no,controlword\nRPDO1,1,0,0x607A,0,32,yes,target\n"


class Pdos:
    """Status and position in TPDO1, latch and counter in TPDO2."""

    def __init__(self, table: Path | None = None, text: str = "") -> None:
        if table is not None:
            table.write_text(COLUMNS + SENT + text, encoding="utf-8")
        found = telegrams(0x60BA, str(table) if table else None, counter=True, inputs=False)
        self.wire = Wire()
        network: Any = self.wire
        self.data = ProcessData(found, 3, network)
        self.data.begin()

    def first(self, word: int = OPERATION_ENABLED, place: int = 0, probe: int = 0) -> None:
        self.wire._bring(0x183, struct.pack("<HiH", word, place, probe))

    def second(self, latch: int = 0, count: int = 0) -> None:
        self.wire._bring(0x283, struct.pack("<iH", latch, count))

    def take(self) -> dict[str, int | None]:
        return dict(zip(TAKEN, self.data.take(), strict=True))

    def alarms(self) -> list[tuple[int, Any, Any]]:
        """ID, PDO and cycles of what is missing."""
        found = [
            self.data.missing_alarm("Z", slot)
            for slot, missing in enumerate(self.data.missing)
            if missing
        ]
        return [(each.id, each.values["pdo"], each.values["cycles"]) for each in found]


def known(values: dict[str, int | None]) -> dict[str, int]:
    return {field: value for field, value in values.items() if value is not None}


ALL = {
    "statusword": OPERATION_ENABLED, "actual": -7, "probe_status": 1, "latch": 11, "latch_count": 2,
}  # fmt: skip


def test_what_came_is_taken_once() -> None:
    pdos = Pdos()
    pdos.first(place=-7, probe=1)
    pdos.second(11, 2)
    assert known(pdos.take()) == ALL
    assert not pdos.data.is_disturbed
    assert known(pdos.take()) == {}
    assert pdos.data.is_disturbed
    assert pdos.alarms() == [(STAYED_OUT, "TPDO1", 1), (STAYED_OUT, "TPDO2", 1)]


@pytest.mark.parametrize("missing", [0, 1])
def test_what_is_missing_is_counted_for_each_telegram_by_itself(missing: int) -> None:
    """Two cycles without the one, one without the other, and all there."""
    pdos = Pdos()
    names = ("TPDO1", "TPDO2")
    brings = (lambda: pdos.first(place=-7, probe=1), lambda: pdos.second(11, 2))
    parts = (
        {"statusword", "actual", "probe_status"}, {"latch", "latch_count"},
    )  # fmt: skip
    for cycles in (1, 2):
        brings[1 - missing]()
        assert set(known(pdos.take())) == parts[1 - missing]
        assert pdos.alarms() == [(STAYED_OUT, names[missing], cycles)]
    brings[missing]()
    pdos.take()
    assert pdos.alarms() == [(STAYED_OUT, names[1 - missing], 1)]
    for bring in brings:
        bring()
    assert known(pdos.take()) == ALL
    assert (pdos.alarms(), pdos.data.is_disturbed) == ([], False)


@pytest.mark.parametrize("twice", [0, 1])
@pytest.mark.parametrize("is_same", [True, False])
def test_a_telegram_that_came_twice_counts_if_both_say_the_same(twice: int, is_same: bool) -> None:
    """Which of two that differ is late nobody knows; one of before `begin_cycle` is none."""
    pdos = Pdos()
    for number in range(2):
        value = 5 if is_same else 5 + number
        if number == 0 or twice == 0:
            pdos.first(place=value)
        if number == 0 or twice == 1:
            pdos.second(value)
    found = pdos.take()
    field, name = (("actual", "TPDO1"), ("latch", "TPDO2"))[twice]
    assert found[field] == (5 if is_same else None)
    assert pdos.alarms() == ([] if is_same else [(CONTRADICTED, name, 1)])
    for number in range(2):  # what contradicted itself is forgotten with its cycle
        pdos.first(place=8)
        pdos.second(8)
        if not number:
            pdos.data.begin_cycle()
    assert pdos.take()[field] == 8
    assert pdos.alarms() == []


def test_a_status_word_that_fits_no_state_counts_as_missing_each_time() -> None:
    pdos = Pdos()
    words = (OPERATION_ENABLED, NO_STATE, NO_STATE, OPERATION_ENABLED, SWITCHED_ON, NO_STATE)
    results = []
    for word in words:
        pdos.first(word)
        pdos.second(3)
        found = pdos.take()
        assert found["latch"] == 3
        results.append((found["statusword"], pdos.alarms()))
    assert results == [
        (OPERATION_ENABLED, []), (None, [(WRONG_STATE, "TPDO1", 1)]),
        (None, [(WRONG_STATE, "TPDO1", 2)]), (OPERATION_ENABLED, []), (SWITCHED_ON, []),
        (None, [(WRONG_STATE, "TPDO1", 1)]),
    ]  # fmt: skip


@pytest.mark.parametrize(("first", "second"), [(2, 5), (5, 2), (0, 3), (3, 0)])
def test_an_alarm_has_the_cycles_of_its_own_telegram(first: int, second: int) -> None:
    pdos = Pdos()
    for left in range(max(first, second), 0, -1):
        if left > first:
            pdos.first()
        if left > second:
            pdos.second(1, 2)
        pdos.take()
    found = {"TPDO1": first, "TPDO2": second}
    assert pdos.alarms() == [(STAYED_OUT, name, cycles) for name, cycles in found.items() if cycles]


def test_a_status_word_is_looked_at_wherever_it_is_in_its_telegram(tmp_path: Path) -> None:
    """Behind the position: 0x0001 in its low word is a place, and no state."""
    text = "TPDO1,1,0,0x6064,0,32,yes,actual\nTPDO1,1,0,0x6041,0,16,no,statusword\n"
    pdos = Pdos(tmp_path / "map.csv", text)
    for place, word, is_good in (
        (NO_STATE, OPERATION_ENABLED, True), (OPERATION_ENABLED, NO_STATE, False),
        (0, SWITCHED_ON, True), (-1, NO_STATE, False),
    ):  # fmt: skip
        pdos.wire._bring(0x183, struct.pack("<iH", place, word))
        found = known(pdos.take())
        assert found == ({"actual": place, "statusword": word} if is_good else {})
        assert [each[0] for each in pdos.alarms()] == ([] if is_good else [WRONG_STATE])


def test_the_cause_is_that_of_the_last_cycle() -> None:
    pdos = Pdos()
    pdos.first(NO_STATE)
    pdos.take()
    pdos.first(place=1)
    pdos.first(place=2)
    pdos.take()
    assert pdos.alarms()[0] == (CONTRADICTED, "TPDO1", 2)
    pdos.take()
    assert pdos.alarms()[0] == (STAYED_OUT, "TPDO1", 3)


def test_with_begin_nothing_is_missing_and_nothing_was_wrong() -> None:
    pdos = Pdos()
    pdos.take()
    pdos.wire._bring(0x183, b"\0")
    pdos.first()
    assert pdos.data.wrong_length == ("TPDO1", 1, 8)
    pdos.data.begin()
    assert (pdos.data.wrong_length, pdos.data.is_disturbed, pdos.alarms()) == (None, False, [])
    assert known(pdos.take()) == {}  # what came before does not count


# Which latch


RECEIVED = "TPDO{a},1,0,0x6041,0,16,no,statusword\nTPDO{a},1,0,0x6064,0,32,yes,actual\n"


@pytest.mark.parametrize(("of_latch", "of_count"), [(1, 2), (2, 1), (2, 2)])
@pytest.mark.parametrize("is_turned", [False, True])
def test_a_counter_proves_a_latch_of_its_own_telegram_alone(
    tmp_path: Path, of_latch: int, of_count: int, is_turned: bool
) -> None:
    """In whatever order the table has them."""
    rows = [f"TPDO{of_latch},1,0,latch,0,32,yes,latch\n"]
    rows.append(f"TPDO{of_count},1,0,counter,0,16,no,latch_count\n")
    if is_turned and of_latch != of_count:
        rows.reverse()
    pdos = Pdos(tmp_path / "map.csv", RECEIVED.format(a=3) + "".join(rows))
    pdos.wire._bring(0x383, struct.pack("<Hi", OPERATION_ENABLED, 0))
    if of_latch == of_count:
        pdos.wire._bring(0x283, struct.pack("<iH", 11, 2))
    else:
        for number, data in ((of_latch, struct.pack("<i", 11)), (of_count, b"\2\0")):
            pdos.wire._bring(0x83 + 0x100 * number, data)
    found = pdos.take()
    assert found["latch"] == 11
    assert found["latch_count"] == (2 if of_latch == of_count else None)


def test_a_latch_that_no_telegram_carries_changes_nothing() -> None:
    pdos = Pdos()
    assert not pdos.data.choose_latch(0x60BB, 0x60D6)
    pdos.first()
    pdos.second(11, 2)
    assert (known(pdos.take())["latch"], pdos.data.choose_latch(0x60BA, 0x60D5)) == (11, True)


# What is sent


def test_values_go_out_in_the_telegram_that_carries_them(tmp_path: Path) -> None:
    """Two RPDOs; an object without a field is found by its index and sub-index."""
    text = RECEIVED.format(a=1) + "RPDO2,1,0,0x6072,0,16,no,\nRPDO2,1,0,0x6072,1,8,yes,\n"
    pdos = Pdos(tmp_path / "map.csv", text)
    for place, value in (
        (pdos.data.sent_place("target"), -5), (pdos.data.sent_object(0x6072, 1), -1),
        (pdos.data.sent_object(0x6072, 0), 0xFFFF),
    ):  # fmt: skip
        assert place is not None
        place[0][place[1]] = value
    pdos.data.send()
    assert pdos.wire.sent == {
        0x203: struct.pack("<Hi", 0, -5), 0x303: struct.pack("<Hb", 0xFFFF, -1),
    }  # fmt: skip
    assert pdos.data.sent_place("probe_function") is None
    assert pdos.data.sent_object(0x6072, 2) is None
    assert pdos.data.sent_object(0x6064, 0) is None  # it comes, and is not sent


# What comes less often


class Sparse:
    """TPDO3 with every second SYNC, TPDO4 with every third, TPDO2 on change."""

    def __init__(self, table: Path) -> None:
        text = RECEIVED.format(a=1) + "TPDO3,2,0,0x60E4,1,32,yes,second\n"
        text += "TPDO4,3,0,0x2000,0,8,no,\n"
        table.write_text(COLUMNS + SENT + text + "TPDO2,254,0,0x60FD,0,32,no,inputs\n")
        self.wire, self.wrong = Wire(), list[tuple[str, int, int]]()
        network: Any = self.wire
        found = telegrams(0x60BA, str(table))
        self.data = SparseData(found.values(), 3, network, self.wrong.append)

    def second(self, value: int) -> None:
        self.wire._bring(0x383, struct.pack("<i", value))

    def steps(self, cycles: int, missing_max: int = 1) -> list[tuple[int, Any, Any]]:
        """Alarms of some cycles: ID, PDO and how often it has stayed out."""
        found = []
        for _ in range(cycles):
            try:
                self.data.step("Z", missing_max)
            except Alarm as alarm:
                found.append((alarm.id, alarm.values["pdo"], alarm.values["cycles"]))
        return found


@pytest.fixture
def sparse(tmp_path: Path) -> Sparse:
    return Sparse(tmp_path / "map.csv")


def test_a_telegram_of_every_nth_sync_may_stay_out_so_many_times_n(sparse: Sparse) -> None:
    """TPDO3 may once be missing, at 2 cycles, and is twice at 4; TPDO4 is twice at 6."""
    assert sparse.data.is_watched
    assert sparse.steps(4) == [(STAYED_OUT, "TPDO3", 2)]
    sparse.data.begin()
    for _ in range(2):
        sparse.second(1)
        assert sparse.steps(2) == []
    assert sparse.steps(2) == [(STAYED_OUT, "TPDO4", 2)]
    sparse.wire._bring(0x483, b"\0")
    sparse.second(1)
    assert sparse.steps(3) == []


@pytest.mark.parametrize("missing_max", [0, 1, 3])
@pytest.mark.parametrize(("can_id", "name", "period"), [(0x383, "TPDO3", 2), (0x483, "TPDO4", 3)])
def test_each_telegram_is_counted_by_its_own_period(
    sparse: Sparse, can_id: int, name: str, period: int, missing_max: int
) -> None:
    """The other one comes in every cycle; what has come once has not come for ever."""
    frames = {0x383: bytes(4), 0x483: bytes(1)}
    limit = period * (missing_max + 1)
    for _ in range(2):
        found = []
        for cycle in range(limit + 2):
            for other, data in frames.items():
                if other != can_id or not cycle:
                    sparse.wire._bring(other, data)
            found += sparse.steps(1, missing_max)
            assert len(found) == max(0, cycle - limit + 1), cycle
        assert found == [(STAYED_OUT, name, missing_max + 1)] * 2
        sparse.data.begin()
        assert sparse.steps(1, missing_max) == []


def test_a_value_stays_until_the_next_one_and_is_news_once(sparse: Sparse) -> None:
    assert sparse.data.values == {}
    for value in (5, -5):
        sparse.second(value)
        assert (sparse.data.values, sparse.data.news) == ({"second": value}, {"second"})
        sparse.data.news.clear()
        sparse.steps(1)
        assert (sparse.data.values, sparse.data.news) == ({"second": value}, set())
    sparse.wire._bring(0x283, b"\1\0\0\x80")
    assert sparse.data.values == {"second": -5, "inputs": 0x80000001}


def test_a_value_that_is_not_the_first_of_its_telegram(tmp_path: Path) -> None:
    """Two objects without a field before it and one behind it."""
    table = tmp_path / "places.csv"
    places = "".join(
        f"TPDO3,2,0,0x{index:04X},0,{bits},no,{field}\n"
        for index, bits, field in ((0x2000, 8, ""), (0x2001, 16, ""), (0x60FD, 32, "inputs"),
                                   (0x2002, 8, ""))
    )  # fmt: skip
    table.write_text(COLUMNS + SENT + RECEIVED.format(a=1) + places)
    wire = Wire()
    network: Any = wire
    data = SparseData(telegrams(0x60BA, str(table)).values(), 3, network, lambda _found: None)
    wire._bring(0x383, struct.pack("<BHIB", 1, 2, 0x30001, 4))
    assert (data.values, data.news) == ({"inputs": 0x30001}, {"inputs"})


def test_all_fields_of_a_telegram_are_news_together(tmp_path: Path) -> None:
    table = tmp_path / "map.csv"
    places = "TPDO3,2,0,0x60FD,0,32,no,inputs\nTPDO3,2,0,0x60E4,1,32,yes,second\n"
    table.write_text(COLUMNS + SENT + RECEIVED.format(a=1) + places)
    wire = Wire()
    network: Any = wire
    data = SparseData(telegrams(0x60BA, str(table)).values(), 3, network, lambda _found: None)
    for inputs, second in ((5, -6), (0, 0)):
        wire._bring(0x383, struct.pack("<Ii", inputs, second))
        assert data.values == {"inputs": inputs, "second": second}
        assert data.news == {"inputs", "second"}
        data.news.clear()


def test_a_telegram_of_another_length_has_not_come(sparse: Sparse) -> None:
    for _ in range(3):
        sparse.wire._bring(0x383, b"\1\2\3")
        assert sparse.steps(1) == []
    sparse.wire._bring(0x383, b"\1\2\3")
    assert sparse.steps(1) == [(STAYED_OUT, "TPDO3", 2)]
    assert (sparse.wrong, sparse.data.values) == ([("TPDO3", 3, 4)] * 4, {})


def listens(transmissions: Sequence[tuple[int, str]], table: Path) -> list[int]:
    text = RECEIVED.format(a=1)
    for number, (transmission, row) in enumerate(transmissions, 2):
        text += f"TPDO{number},{transmission},0,{row}\n"
    table.write_text(COLUMNS + SENT + text, encoding="utf-8")
    wire: Any = Wire()
    SparseData(telegrams(0x60BA, str(table)).values(), 3, wire, print)
    return sorted(wire.listeners)


def test_what_is_heard_is_what_has_a_field_or_a_time(tmp_path: Path) -> None:
    """Those of type 1 are of `ProcessData`; on change without a field they say nothing to it."""
    own, inputs, free = "0x60E4,1,32,yes,second", "0x60FD,0,32,no,inputs", "0x2000,0,8,no,"
    rows = [(2, own), (255, inputs), (254, free)]
    assert listens(rows, tmp_path / "a.csv") == [0x283, 0x383]
    assert listens([(240, free), (1, own)], tmp_path / "b.csv") == [0x283]
    # Type 0: after a SYNC where it has changed (CiA 301)
    assert listens([(0, inputs), (0, free)], tmp_path / "c.csv") == [0x283]
