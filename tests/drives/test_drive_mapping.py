"""What the kernel writes into a drive at start-up, and that the drive then does it."""

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.kernel.drives.canopen.mapping import Telegram, telegrams
from axisrig.kernel.drives.canopen.startup_steps import StartUpSettings
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
NODE = 3
OPERATIONAL = 5


# Mapping table against CiA 301 and CiA 402, written out by hand


@pytest.mark.parametrize(
    ("name", "cob_id", "entries", "form"),
    [
        ("RPDO1", 0x203, [0x60400010, 0x607A0020, 0x60B80010], "<HiH"),
        ("TPDO1", 0x183, [0x60410010, 0x60640020, 0x60B90010], "<HiH"),
        ("TPDO2", 0x283, [0x60BA0020], "<i"),
        ("TPDO3", 0x383, [0x60FD0020], "<I"),
    ],
)
def test_telegrams_carry_what_the_design_says(
    name: str, cob_id: int, entries: list[int], form: str
) -> None:
    telegram = telegrams(0x60BA)[name]
    assert telegram.cob_id(NODE) == cob_id
    assert [mapped.entry for mapped in telegram.objects] == entries
    assert telegram.codec.format == form
    assert telegram.length == struct.calcsize(form)


def test_only_the_latch_object_in_use_is_sent() -> None:
    for latch in (0x60BA, 0x60BB, 0x60BC, 0x60BD):
        (mapped,) = telegrams(latch)["TPDO2"].objects
        assert (mapped.index, mapped.bits, mapped.signed) == (latch, 32, True)


def test_cyclic_telegrams_go_with_every_sync_and_inputs_on_change() -> None:
    types = {name: telegram.transmission for name, telegram in telegrams(0x60BA).items()}
    assert types == {"RPDO1": 1, "TPDO1": 1, "TPDO2": 1, "TPDO3": 254}
    assert [t.name for t in telegrams(0x60BA).values() if not t.is_cyclic] == ["TPDO3"]
    assert telegrams(0x60BA)["TPDO3"].inhibit_100us == 10  # 1 ms


# Written over SDO


@pytest.mark.parametrize(
    ("probe_input", "edge", "latch"),
    [(1, "POS", 0x60BA), (1, "NEG", 0x60BB), (2, "POS", 0x60BC), (2, "NEG", 0x60BD)],
)
def test_the_drive_holds_the_mapping_after_start_up(
    link_bench: Make, probe_input: int, edge: str, latch: int
) -> None:
    bench = link_bench(probe_input=probe_input, edge=edge)
    bench.commission()
    read = bench.read
    assert [read(0x1A01, sub) for sub in range(2)] == [1, latch << 16 | 0x20]
    assert [read(0x1600, sub) for sub in range(4)] == [3, 0x60400010, 0x607A0020, 0x60B80010]
    assert [read(0x1A00, sub) for sub in range(4)] == [3, 0x60410010, 0x60640020, 0x60B90010]
    assert [read(0x1A02, sub) for sub in range(2)] == [1, 0x60FD0020]
    assert [read(index, 1) for index in (0x1400, 0x1800, 0x1801, 0x1802)] == [
        0x203, 0x183, 0x283, 0x383,
    ]  # fmt: skip
    assert [read(index, 2) for index in (0x1400, 0x1800, 0x1801, 0x1802)] == [1, 1, 1, 254]
    assert read(0x1802, 3) == 10
    assert bench.remote.sdo[0x1006].raw == 1000
    assert bench.remote.sdo[0x6060].raw == 8  # cyclic synchronous position


def test_what_is_mapped_is_what_comes_over_the_bus(link_bench: Make) -> None:
    bench = link_bench(start_mm=12.5, level=True)
    bench.commission()
    bench.cycle(12.5)
    (first,) = bench.frames(0x183)
    statusword, actual, probe_status = struct.unpack("<HiH", first)
    assert actual == 1_310_720  # 12.5 mm * 104857.6 increments/mm
    assert statusword & 0x4F == 0x40  # switch on disabled
    assert probe_status == 0
    assert bench.frames(0x283) == [bytes(4)]
    assert bench.frames(0x383) == [struct.pack("<I", 1 << 16)]  # probe input 1 is high
    assert bench.link.actual_mm == 12.5


def test_set_position_and_words_go_out_as_mapped(link_bench: Make) -> None:
    bench = link_bench(start_mm=-2.0)
    bench.commission()
    bench.link.order(PowerOrder.SWITCH_ON)
    bench.link.arm()
    bench.cycle(-2.0)
    (sent,) = bench.frames(0x203)
    controlword, target, function = struct.unpack("<HiH", sent)
    assert controlword & 0x87 == 0x06  # shutdown: the first step from switch on disabled
    assert target == -209_715  # -2 mm * 104857.6 = -209715.2
    assert function == 0x0011  # enable probe 1, positive edge
    bench.cycle(-2.0)
    assert struct.unpack("<HiH", bench.frames(0x183)[-1])[2] == 0x0001  # acknowledged


def _downloads(heard: list[tuple[int, int, bytes]]) -> list[tuple[int, int, int]]:
    """(index, sub, value) of every expedited SDO download, CiA 301 7.2.4.3.3."""
    found = []
    for _, can_id, data in heard:
        if can_id == 0x600 + NODE and data[0] & 0xE2 == 0x22:
            index, sub = struct.unpack_from("<HB", data, 1)
            found.append((index, sub, int.from_bytes(data[4 : 8 - (data[0] >> 2 & 3)], "little")))
    return found


def test_a_mapping_is_changed_in_the_order_of_the_standard(link_bench: Make) -> None:
    """CiA 301 7.5.2.36: disable, empty the mapping, entries, their number, type, enable."""
    bench = link_bench()
    bench.commission()
    writes = [w for w in _downloads(bench.heard) if w[0] in (0x1800, 0x1A00)]
    assert writes == [
        (0x1800, 1, 0x80000183),
        (0x1A00, 0, 0),
        (0x1A00, 1, 0x60410010),
        (0x1A00, 2, 0x60640020),
        (0x1A00, 3, 0x60B90010),
        (0x1A00, 0, 3),
        (0x1800, 2, 1),
        (0x1800, 1, 0x183),
    ]


def test_operational_comes_last_and_only_then_pdos_flow(link_bench: Make) -> None:
    bench = link_bench()
    bench.commission()
    ids = [can_id for _, can_id, _ in bench.heard]
    last_answer = max(n for n, can_id in enumerate(ids) if can_id == 0x580 + NODE)
    reset, start = [n for n, can_id in enumerate(ids) if can_id == 0x000]
    assert bench.heard[reset][2] == bytes([130, NODE])  # reset communication
    assert reset < ids.index(0x600 + NODE)
    assert last_answer < start
    assert bench.heard[start][2] == bytes([1, NODE])
    assert all(can_id not in (0x183, 0x283, 0x383) for can_id in ids[:start])


def _without(*names: str) -> dict[str, Telegram]:
    return {name: found for name, found in telegrams(0x60BA).items() if name not in names}


@pytest.mark.parametrize("left_out", [(), ("TPDO2",), ("TPDO3",), ("TPDO2", "TPDO3")])
def test_only_the_tpdos_of_the_table_are_sent(link_bench: Make, left_out: tuple[str, ...]) -> None:
    """TPDO1 to TPDO3 of the drive are valid at power on, one that was left on by a master too."""
    bench = link_bench()
    mapped = _without(*left_out)
    bench.scheduler.run_until(2 * MS)
    sdo = bench.remote.sdo
    sdo[0x1A03][1].raw, sdo[0x1A03][0].raw = 0x60640020, 1
    sdo[0x1803][2].raw, sdo[0x1803][1].raw = 1, 0x483
    ended = bench.start_up(StartUpSettings(boot="none"), telegrams=mapped)
    bench.scheduler.run_while(lambda: not ended, None)
    assert ended == [None]
    bench.network.send_message(0x80, b"")
    bench.scheduler.run_until(bench.scheduler.now_ns + 2 * MS)
    heard = {can_id for _, can_id, _ in bench.heard}
    sent = {0x183: "TPDO1", 0x283: "TPDO2", 0x383: "TPDO3", 0x483: "TPDO4"}
    assert {name for can_id, name in sent.items() if can_id in heard} == {
        name for name in mapped if name.startswith("T")
    }


TABLE = """\
pdo,transmission,inhibit_100us,index,sub,bits,signed,field
RPDO1,1,0,0x6040,0,16,no,controlword
RPDO1,1,0,0x607A,0,32,yes,target
TPDO1,1,0,0x6041,0,16,no,statusword
TPDO1,1,0,0x6064,0,32,yes,actual
RPDO2,1,0,0x60B8,0,16,no,probe_function
RPDO2,1,0,0x6072,0,16,no,
"""


@pytest.mark.parametrize(
    ("row", "line", "named"),
    [
        ("RPDO2,1,0,0x607A,0,32,yes,", 3, "0x607A:0"),
        ("RPDO3,1,0,0x6040,0,16,no,", 2, "0x6040:0"),
        ("RPDO1,1,0,0x60B8,0,16,no,", 6, "0x60B8:0"),
        ("RPDO1,1,0,24754,0x0,16,no,", None, ""),  # an index is hexadecimal
        ("RPDO1,1,0,6072,0,16,no,", 7, "0x6072:0"),
        ("RPDO2,1,0,0x6072,0,16,no,", 7, "0x6072:0"),  # in one PDO too
        ("RPDO4,1,0,0x6072,1,16,no,", None, ""),  # another sub-index
        ("TPDO2,1,0,0x607A,0,32,yes,", None, ""),  # a drive may send what it was sent
        ("TPDO2,1,0,0x6064,0,32,yes,", None, ""),
    ],
)
def test_a_value_in_two_places_of_the_rpdos_is_refused_with_both_lines(
    tmp_path: Path, row: str, line: int | None, named: str
) -> None:
    table = tmp_path / "map.csv"
    table.write_text(f"{TABLE}{row}\n", encoding="utf-8")
    if line is None:
        telegrams(0x60BA, str(table))
        return
    with pytest.raises(UserError) as caught:
        telegrams(0x60BA, str(table))
    assert (caught.value.file, caught.value.line, caught.value.value) == (str(table), 8, named)
    assert f"line {line}" in caught.value.message


BOTH = (
    "pdo,transmission,inhibit_100us,index,sub,bits,signed,field\n"
    "RPDO1,1,0,0x6040,0,16,no,controlword\nRPDO1,1,0,0x607A,0,32,yes,{target}\n"
    "RPDO2,1,0,0x60FF,0,32,yes,{speed}\n"
    "TPDO1,1,0,0x6041,0,16,no,statusword\nTPDO1,1,0,0x6064,0,32,yes,actual\n"
)


@pytest.mark.parametrize("counter", [False, True])
@pytest.mark.parametrize("inputs", [False, True])
@pytest.mark.parametrize("second", [False, True])
@pytest.mark.parametrize("speed", [False, True])
@pytest.mark.parametrize("probe", [False, True])
def test_the_kernels_own_telegrams_have_what_is_asked_for(
    counter: bool, inputs: bool, second: bool, speed: bool, probe: bool
) -> None:
    """A drive without a touch probe has no counter of its latches either."""
    found = telegrams(
        0x60BC, counter=counter, inputs=inputs, second=second, speed=speed, probe=probe
    )
    fields = {o.field: o.index for telegram in found.values() for o in telegram.objects}
    wanted = {"controlword": 0x6040, "statusword": 0x6041, "actual": 0x6064}
    wanted |= {"speed": 0x60FF} if speed else {"target": 0x607A}
    wanted |= {"inputs": 0x60FD} if inputs else {}
    wanted |= {"second": 0x60E4} if second else {}
    if probe:
        wanted |= {"probe_function": 0x60B8, "probe_status": 0x60B9, "latch": 0x60BC}
        wanted |= {"latch_count": 0x60D7} if counter else {}
    assert fields == wanted


@pytest.mark.parametrize(("written", "sub"), [("10", 10), ("0x10", 16), ("0", 0), ("0xff", 255)])
def test_a_sub_index_is_decimal_unless_it_says_otherwise(
    tmp_path: Path, written: str, sub: int
) -> None:
    """An index is hexadecimal with or without 0x; bits and times are as a sub-index."""
    table = tmp_path / "map.csv"
    text = BOTH.format(target="target", speed="") + f"RPDO3,254,0x10,2000,{written},0x8,no,\n"
    table.write_text(text, encoding="utf-8")
    found = telegrams(0x60BA, str(table))["RPDO3"]
    (mapped,) = found.objects
    assert (mapped.index, mapped.sub, mapped.bits) == (0x2000, sub, 8)
    assert found.inhibit_100us == 16


@pytest.mark.parametrize("speed", [False, True])
@pytest.mark.parametrize("fields", [("target", "speed"), ("target", ""), ("", "speed")])
def test_of_set_position_and_set_speed_the_mode_of_the_drive_takes_one(
    tmp_path: Path, fields: tuple[str, str], speed: bool
) -> None:
    """In a table of a rig as in the kernel's own; one that has one of both keeps what it has."""
    table = tmp_path / "map.csv"
    table.write_text(BOTH.format(target=fields[0], speed=fields[1]), encoding="utf-8")
    own, given = telegrams(0x60BA, speed=speed), telegrams(0x60BA, str(table), speed=speed)
    wanted = [0x60FF] if speed else [0x607A]
    targets = [
        [o.index for pdo in each.values() for o in pdo.objects if o.index in (0x607A, 0x60FF)]
        for each in (own, given)
    ]
    assert targets == [wanted, wanted if all(fields) else [0x607A, 0x60FF]]


def test_entries_that_fill_a_place_may_repeat(tmp_path: Path) -> None:
    """CiA 301: 0005 (U8) and others as entries of an RPDO are data that nobody reads."""
    table = tmp_path / "map.csv"
    table.write_text(TABLE + "RPDO1,1,0,0x0005,0,8,no,\n" * 2, encoding="utf-8")
    assert [mapped.index for mapped in telegrams(0x60BA, str(table))["RPDO1"].objects] == [
        0x6040, 0x607A, 5, 5,
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("transmission", "event_ms", "promised_ms"),
    [(1, 0, 2), (5, 0, 10), (240, 0, 480), (254, 70, 70), (255, 70, 70), (255, 0, None)],
)
def test_what_a_telegram_promises(
    transmission: int, event_ms: int, promised_ms: int | None
) -> None:
    """CiA 301: type n comes with every n-th SYNC, here of 2 ms, 254 and 255 by the event timer."""
    second = (MappedObject(0x60E4, 1, 32, True, "second"),)
    promised_ns = Telegram("TPDO4", transmission, 0, second, event_ms).promised_ns(2 * MS)
    assert promised_ns == (None if promised_ms is None else promised_ms * MS)


HEAD = "pdo,transmission,inhibit_100us,index,sub,bits,signed,field,cob_id\n"
NEEDED = (
    "RPDO1,1,0,0x6040,0,16,no,controlword,\nRPDO1,1,0,0x607A,0,32,yes,target,\n"
    "TPDO1,1,0,0x6041,0,16,no,statusword,0x1C7\nTPDO1,1,0,0x6064,0,32,yes,actual,0x1C7\n"
)
OF_EACH_FIELD = {
    "controlword": "RPDO1,{},0,0x6040,0,16,no,controlword",
    "target": "RPDO2,{},0,0x607A,0,32,yes,target",
    "statusword": "TPDO1,{},0,0x6041,0,16,no,statusword",
    "actual": "TPDO2,{},0,0x6064,0,32,yes,actual",
    "latch": "TPDO3,{},0,latch,0,32,yes,latch",
    "inputs": "TPDO4,{},0,0x60FD,0,32,no,inputs",
    "second": "TPDO5,{},0,0x60E4,1,32,yes,second,0x1C7",
}


@pytest.mark.parametrize(
    ("field", "allowed"),
    [
        *((field, {1}) for field in list(OF_EACH_FIELD)[:5]),
        ("inputs", {0, 1, 2, 240, 254, 255}),
        ("second", {1, 2, 240, 254, 255}),
    ],
)
def test_what_the_control_works_with_must_come_with_every_sync(
    tmp_path: Path, field: str, allowed: set[int]
) -> None:
    """Type 2 comes with every second one only; inputs and second encoder may come later."""
    for transmission in (0, 1, 2, 240, 254, 255):
        table = tmp_path / f"map{transmission}.csv"
        rows = [
            row.format(transmission if name == field else 1) for name, row in OF_EACH_FIELD.items()
        ]
        table.write_text("\n".join([HEAD.strip(), *rows]), encoding="utf-8")
        if transmission in allowed:
            assert len(telegrams(0x60BA, str(table))) == len(OF_EACH_FIELD)
            continue
        with pytest.raises(UserError, match=f"carries {field} and must come") as caught:
            telegrams(0x60BA, str(table))
        assert caught.value.value == transmission
        assert caught.value.line == list(OF_EACH_FIELD).index(field) + 2


def test_a_table_that_has_changed_is_read_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also under the same relative name in another folder; the same content is read once."""
    rows = [row.format(1) for row in OF_EACH_FIELD.values()]
    texts = ["\n".join([HEAD.strip(), *rows[:count]]) for count in (5, 6, 5)]
    table = tmp_path / "map.csv"
    found = []
    for text in texts:
        table.write_text(text, encoding="utf-8")
        found.append(telegrams(0x60BA, str(table)))
        assert telegrams(0x60BA, str(table)) is found[-1]
    assert [len(each) for each in found] == [5, 6, 5]
    for text, count in zip(texts[:2], (5, 6), strict=True):
        folder = tmp_path / f"of{count}"
        folder.mkdir()
        (folder / "map.csv").write_text(text, encoding="utf-8")
        monkeypatch.chdir(folder)
        assert len(telegrams(0x60BA, "map.csv")) == count
    table.write_text(f"{HEAD}{rows[0]}", encoding="utf-8")
    with pytest.raises(UserError, match="lacks a field"):
        telegrams(0x60BA, str(table))


# PDO 5 and up, identifiers of their own


def test_pdos_with_identifiers_of_their_own(tmp_path: Path) -> None:
    """RPDO1 has that of the pre-defined connection set, TPDO64 has none there (CiA 301)."""
    table = tmp_path / "map.csv"
    table.write_text(f"{HEAD}{NEEDED}TPDO64,1,0,0x60B9,0,16,no,probe_status,0x1D7\n")
    found = telegrams(0x60BA, str(table))
    assert {name: t.cob_id(NODE) for name, t in found.items()} == {
        "RPDO1": 0x203, "TPDO1": 0x1C7, "TPDO64": 0x1D7,
    }  # fmt: skip
    assert found["TPDO64"].communication_index == 0x183F


@pytest.mark.parametrize(
    ("pdo", "identifier", "message"),
    [
        ("TPDO5", "", "cob_id of the mapping table"),
        ("TPDO5", "0x80", "cob_id of the mapping table"),  # SYNC
        ("TPDO5", "0x583", "cob_id of the mapping table"),  # SDO
        ("TPDO5", "0x800", "cob_id of the mapping table"),
        ("TPDO5", "x", "cob_id of the mapping table"),
        ("TPDO0", "0x1D7", "pdo of the mapping table"),
        ("TPDO513", "0x1D7", "pdo of the mapping table"),
    ],
)
def test_a_pdo_that_cannot_be_is_refused_with_its_line(
    tmp_path: Path, pdo: str, identifier: str, message: str
) -> None:
    table = tmp_path / "map.csv"
    table.write_text(f"{HEAD}{NEEDED}{pdo},1,0,0x60B9,0,16,no,probe_status,{identifier}\n")
    with pytest.raises(UserError, match=message) as error:
        telegrams(0x60BA, str(table))
    assert error.value.line == 6
