"""The second encoder, 60E4:1, from the drive to the kernel."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.drives.canopen.mapping import telegrams
from axisrig.kernel.errors import Alarm, UserError

ENTRY = 0x60E40120
TABLE = """pdo,transmission,inhibit_100us,index,sub,bits,signed,field
RPDO1,1,0,0x6040,0,16,no,controlword
RPDO1,1,0,0x607A,0,32,yes,target
TPDO1,1,0,0x6041,0,16,no,statusword
TPDO1,1,0,0x6064,0,32,yes,actual
{second}
"""


class Wire:
    """A network that is fed by hand."""

    def __init__(self) -> None:
        self.heard: dict[int, Callable[[int, bytearray, float], None]] = {}

    def subscribe(self, can_id: int, callback: Callable[[int, bytearray, float], None]) -> None:
        self.heard[can_id] = callback

    def send_message(self, can_id: int, data: bytes) -> None:
        pass

    def feed(self, can_id: int, data: bytes) -> None:
        self.heard[can_id](can_id, bytearray(data), 0.0)


def linked(table: str | None = None, **settings: Any) -> tuple[AxisLink, Wire]:
    wire = Wire()
    link = AxisLink(LinkSettings("Z", 1000.0, node_id=3, pdo_map=table, **settings), wire)
    link.begin()
    return link, wire


@pytest.fixture
def own_table(tmp_path: Path) -> Callable[[str], str]:
    def write(second: str) -> str:
        path = tmp_path / "map.csv"
        path.write_text(TABLE.format(second=second))
        return str(path)

    return write


def answer(wire: Wire, position: int = 0) -> None:
    wire.feed(0x183, (0x0027).to_bytes(2, "little") + position.to_bytes(4, "little", signed=True))


def second(wire: Wire, value: int, can_id: int = 0x483) -> None:
    wire.feed(can_id, value.to_bytes(4, "little", signed=True))


def test_the_kernels_own_mapping_has_it_when_it_is_wanted() -> None:
    assert "TPDO4" not in telegrams(0x60BA)
    telegram = telegrams(0x60BA, second=True)["TPDO4"]
    assert [mapped.entry for mapped in telegram.objects] == [ENTRY]
    assert telegram.transmission == 1
    assert linked(has_second=True)[0].has_second
    assert not linked()[0].has_second


def test_it_is_of_the_sync_that_the_actual_position_is_of(own_table: Callable[[str], str]) -> None:
    link, wire = linked(own_table("TPDO2,1,0,0x60E4,1,32,yes,second"))
    assert link.second_increments is None
    for cycle in range(5):
        link.begin_cycle()
        answer(wire, 100 * cycle)
        second(wire, -7 * cycle, 0x283)
        link.take()
        assert (link.actual_increments, link.second_increments) == (100 * cycle, -7 * cycle)


def test_the_last_one_counts_while_its_telegram_stays_out(
    own_table: Callable[[str], str],
) -> None:
    link, wire = linked(own_table("TPDO2,1,0,0x60E4,1,32,yes,second"))
    for cycle, sent in enumerate((3, 4, None, 6)):
        link.begin_cycle()
        answer(wire)
        if sent is not None:
            second(wire, sent, 0x283)
        link.take()
        assert link.second_increments == (3, 4, 4, 6)[cycle]


@pytest.mark.provokes(900006, 7, axis="Z", pdo="TPDO2")
def test_every_third_sync_is_enough_when_the_table_says_so(
    own_table: Callable[[str], str],
) -> None:
    link, wire = linked(own_table("TPDO2,3,0,0x60E4,1,32,yes,second"), missing_cycles=2)
    for cycle in range(12):
        link.begin_cycle()
        answer(wire)
        if cycle % 3 == 0:
            second(wire, cycle, 0x283)
        link.take()
        assert link.second_increments == cycle - cycle % 3  # the last one counts until the next
        assert link.second_age_cycles == cycle % 3
    for _ in range(6):  # it came in cycle 9: two telegrams in a row may be missing
        link.begin_cycle()
        answer(wire)
        link.take()
    answer(wire)
    with pytest.raises(Alarm, match="900006"):
        link.take()  # the third one is due 9 cycles behind it


@pytest.mark.parametrize("transmission", [254, 255])
def test_sent_on_change_it_stays_until_it_changes(
    own_table: Callable[[str], str], transmission: int
) -> None:
    link, wire = linked(own_table(f"TPDO2,{transmission},0,0x60E4,1,32,yes,second"))
    second(wire, 5, 0x283)
    for cycle in range(20):
        link.begin_cycle()
        answer(wire)
        link.take()
        assert (link.second_increments, link.second_age_cycles) == (5, cycle)
    second(wire, 6, 0x283)
    assert link.second_increments == 6


@pytest.mark.provokes(900028, 7, axis="Z", pdo="TPDO2", length=2, expected=4)
def test_another_length_is_refused(own_table: Callable[[str], str]) -> None:
    link, wire = linked(own_table("TPDO2,255,0,0x60E4,1,32,yes,second"))
    wire.feed(0x283, b"\0\0")
    answer(wire)
    with pytest.raises(Alarm, match="TPDO2"):
        link.take()


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("RPDO2,1,0,0x60E4,1,32,yes,second", "a TPDO for second"),
        ("TPDO2,0,0,0x60E4,1,32,yes,second", "must come by itself"),
        ("TPDO2,252,0,0x60E4,1,32,yes,second", "must come by itself"),
        ("TPDO2,1,0,0x60E4,1,32,no,second", "signed position"),
        ("TPDO2,1,0,0x60E4,1,16,yes,second", "signed position"),
    ],
)
def test_a_table_that_cannot_bring_it_is_refused(
    own_table: Callable[[str], str], row: str, words: str
) -> None:
    table = own_table(row)
    with pytest.raises(UserError, match=words) as refused:
        telegrams(0x60BA, table)
    assert refused.value.line == 6


@pytest.mark.parametrize(
    ("second", "promised_ns"),
    [
        ("", None),
        ("TPDO2,1,0,0x60E4,1,32,yes,second", 2_000_000),
        ("TPDO2,5,0,0x60E4,1,32,yes,second", 10_000_000),  # with each 5th SYNC
        ("TPDO2,254,0,0x60E4,1,32,yes,second", None),  # when the drive wants
    ],
)
def test_the_table_says_how_often_a_second_position_comes(
    own_table: Callable[[str], str], second: str, promised_ns: int | None
) -> None:
    link, _ = linked(own_table(second))
    assert link.has_second is bool(second)
    assert link.second_period_ns(2_000_000) == promised_ns
