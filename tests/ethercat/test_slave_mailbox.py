"""Mailbox, SDO, SDO information, emergency: each byte by hand."""

import struct

import pytest
from tests.ethercat.line import OP, PREOP, SAFEOP, Line

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.node import SlaveSettings

NAME = b"axisrig DS402 drive"


@pytest.fixture
def line() -> Line:
    line = Line()
    line.preop()
    return line


def small(size: int = 40) -> Line:
    line = Line(settings=[SlaveSettings(serial=7, mailbox_bytes=size)])
    line.preop(mailbox=size)
    return line


def test_an_expedited_upload(line: Line) -> None:
    # 1000 = 0x00020192, 4 bytes: command 43; service 3 is the answer
    assert line.coe(bytes.fromhex("4000100000000000")) == (3, bytes.fromhex("4300100092010200"))
    assert line.coe(bytes.fromhex("4041600000000000"))[1][:4] == bytes.fromhex("4b416000")
    assert line.coe(bytes.fromhex("4061600000000000"))[1] == bytes.fromhex("4f61600008000000")


def test_a_normal_upload_has_its_size_and_its_bytes(line: Line) -> None:
    head = bytes.fromhex("41081000") + struct.pack("<I", len(NAME))
    assert line.coe(bytes.fromhex("4008100000000000")) == (3, head + NAME)


def test_a_segmented_upload_goes_on_where_the_mailbox_ends() -> None:
    """A mailbox of 32 bytes holds 16 at the begin, and 23 in a segment."""
    line = small(32)
    _, body = line.coe(bytes.fromhex("4008100000000000"), size=32)
    assert body == bytes.fromhex("41081000") + struct.pack("<I", 19) + NAME[:16]
    _, body = line.coe(bytes.fromhex("6000000000000000"), size=32)
    # The last one, 3 bytes: 4 of 7 are not used
    assert body == bytes((0x01 | 4 << 1,)) + NAME[16:] + bytes(4)
    # Complete access of 60E3: 2 + 36 bytes in 16, 22
    _, body = line.coe(bytes.fromhex("50e3600000000000"), size=32)
    assert body[:10] == bytes.fromhex("51e36000") + struct.pack("<I", 38) + b"\x24\x00"
    _, rest = line.coe(bytes.fromhex("6000000000000000"), size=32)
    assert (rest[0], len(rest)) == (0x01, 23)
    methods = body[10:] + rest[1:]
    last = (33, 34, 35, 37, -1, -2, -3, -4)
    assert struct.unpack("36b", methods) == (*range(1, 15), *range(17, 31), *last)


def test_a_toggle_that_does_not_alternate_ends_the_transfer() -> None:
    line = small(32)
    line.coe(bytes.fromhex("4008100000000000"), size=32)
    service, body = line.coe(bytes.fromhex("7000000000000000"), size=32)
    assert (service, body) == (2, bytes.fromhex("80081000") + struct.pack("<I", 0x05030000))
    _, body = line.coe(bytes.fromhex("6000000000000000"), size=32)
    assert body[4:] == struct.pack("<I", 0x05040001)


def test_a_download_that_is_expedited_or_normal(line: Line) -> None:
    assert line.sdo_write(0x6065, 0, 1000, 4) == 0
    assert line.sdo_read(0x6065, 0) == struct.pack("<I", 1000)
    request = bytes.fromhex("21656000") + struct.pack("<II", 4, 2000)
    assert line.coe(request) == (3, bytes.fromhex("6065600000000000"))
    assert line.sdo_read(0x6065, 0) == struct.pack("<I", 2000)
    # Without a size (bit 0 clear) the object has it
    line.coe(bytes.fromhex("22656000") + struct.pack("<I", 3000))
    assert line.sdo_read(0x6065, 0) == struct.pack("<I", 3000)


def test_a_segmented_download() -> None:
    """Complete access of 1600 with 9 entries: 2 + 36 bytes, 16 at once, then 15 and 7."""
    line = small(32)
    entries = [0x60400010, 0x607A0020, 0x60B80010, 0x60FF0020, 0x60710010, 0x60600008,
               0x60B00020, 0x60B10020, 0x60B20010]  # fmt: skip
    data = struct.pack("<H9I", 9, *entries)
    head = bytes.fromhex("31001600") + struct.pack("<I", len(data))
    assert line.coe(head + data[:16], size=32)[1] == bytes.fromhex("7000160000000000")
    assert line.coe(b"\x00" + data[16:31], size=32)[1] == b"\x20" + bytes(7)
    assert line.coe(b"\x11" + data[31:], size=32)[1] == b"\x30" + bytes(7)
    objects = line.drive.objects
    assert [objects.value(0x1600, sub) for sub in range(10)] == [9, *entries]


@pytest.mark.parametrize(
    ("request_hex", "code"),
    [
        ("4000200000000000", 0x06020000),  # no object
        ("4018100500000000", 0x06090011),  # no sub-index
        ("2b4160000f000000", 0x06010002),  # statusword
        ("2365600000000000", 0),
        ("2b65600000000000", 0x06070013),  # too short
        ("2366600000000000", 0x06070012),  # too long
        ("2f606000ff000000", 0x06090030),  # mode -1
        ("5040600000000000", 0x06010004),  # no complete access of a variable
        ("5018100200000000", 0x06090011),
        ("5000200000000000", 0x06020000),
        ("e040600000000000", 0x05040001),
        ("6000000000000000", 0x05040001),  # no transfer
        ("0000000000000000", 0x05040001),
        ("2365600000", 0x06070010),
        ("23656000", 0x06070010),
        ("2365", 0x05040001),
    ],
)
def test_what_is_refused_has_its_code(line: Line, request_hex: str, code: int) -> None:
    service, body = line.coe(bytes.fromhex(request_hex))
    if not code:
        assert (service, body[0]) == (3, 0x60)
        return
    assert (service, body[0]) == (2, 0x80)
    assert int.from_bytes(body[4:8], "little") == code


def test_complete_access_of_a_record(line: Line) -> None:
    # 1018: 4, padding, vendor 0, product 402, revision 0x10000, serial 1
    data = struct.pack("<H4I", 4, 0, 402, 0x10000, 1)
    _, body = line.coe(bytes.fromhex("5018100000000000"))
    assert body == bytes.fromhex("51181000") + struct.pack("<I", 18) + data
    _, body = line.coe(bytes.fromhex("5018100100000000"))
    assert body == bytes.fromhex("51181001") + struct.pack("<I", 16) + data[2:]
    # 60C2: 2, padding, 2 ms
    request = bytes.fromhex("31c26000") + struct.pack("<IHBb", 4, 2, 2, -3)
    assert line.coe(request)[1] == bytes.fromhex("70c2600000000000")
    assert line.drive.servo.interpolation.period_ns() == 2_000_000
    # Two bytes are of the number of members alone
    for head, size, code in (("31c26001", 2, 0), ("31c26001", 4, 0x06070012),
                             ("31c26000", 4, 0), ("31c26000", 6, 0x06070012)):  # fmt: skip
        data = (struct.pack("<H", 2) if head[-1] == "0" else b"") + struct.pack("<Bb", 2, -3)
        request = bytes.fromhex(head) + struct.pack("<I", size) + data.ljust(size, b"\0")
        found = line.coe(request)[1]
        assert (found[0], found[4:] if code else b"") == (
            (0x80, struct.pack("<I", code)) if code else (0x70, b"")
        )
    # Another number of members than there are
    request = bytes.fromhex("31c26000") + struct.pack("<IHBb", 4, 1, 4, -3)
    assert line.coe(request)[1][4:] == struct.pack("<I", 0x06090030)


def test_a_full_mailbox_refuses_a_write_and_an_empty_one_a_read() -> None:
    line = Line(profile=DriveProfile(sdo_answer_ns=1_000_000))
    line.preop()
    assert line.one(1, 0, 0x1080, 128).wkc == 0
    request = struct.pack("<H", 2 << 12) + bytes.fromhex("4000100000000000")
    assert line.send_mail(3, request) == 1
    assert line.read(0x0805, 1) == 0x08
    assert line.send_mail(3, request) == 0
    line.wait(1_100_000)
    assert (line.read(0x0805, 1), line.read(0x080D, 1)) == (0, 0x08)
    assert line.one(1, 0, 0x1080, 64).wkc == 1  # not to its end: it stays full
    assert line.one(1, 0, 0x1080, 128).wkc == 1
    assert line.one(1, 0, 0x1080, 128).wkc == 0
    assert line.read(0x080D, 1) == 0


def test_a_message_that_was_lost_on_its_way_is_repeated(line: Line) -> None:
    line.send_mail(3, struct.pack("<H", 2 << 12) + bytes.fromhex("4000100000000000"))
    line.wait(10_000)
    first = line.one(1, 0, 0x1080, 128)
    for toggled in (3, 1, 3):
        assert line.one(1, 0, 0x1080, 128).wkc == 0
        line.write(0x080E, toggled, 1)
        assert line.read(0x080F, 1) == toggled & 2
        again = line.one(1, 0, 0x1080, 128)
        assert (again.wkc, again.data) == (1, first.data)


def test_a_repeat_does_not_lose_the_next_message(line: Line) -> None:
    line.send_mail(3, struct.pack("<H", 2 << 12) + bytes.fromhex("4000100000000000"))
    line.wait(10_000)
    first = line.one(1, 0, 0x1080, 128).data
    line.send_mail(3, struct.pack("<H", 2 << 12) + bytes.fromhex("4008100000000000"))
    line.wait(10_000)
    line.write(0x080E, 3, 1)
    assert line.one(1, 0, 0x1080, 128).data == first
    assert NAME in line.one(1, 0, 0x1080, 128).data


def test_answers_are_counted_from_1_to_7(line: Line) -> None:
    counters = []
    for _ in range(9):
        line.send_mail(3, struct.pack("<H", 2 << 12) + bytes.fromhex("4000100000000000"))
        line.wait(10_000)
        counters.append(line.one(1, 0, 0x1080, 128).data[5] >> 4)
    assert counters == [1, 2, 3, 4, 5, 6, 7, 1, 2]


@pytest.mark.parametrize("kind", [1, 2, 4, 5, 15], ids=["AoE", "EoE", "FoE", "SoE", "VoE"])
def test_protocols_that_the_slave_does_not_have_are_refused(line: Line, kind: int) -> None:
    line.send_mail(kind, bytes(8))
    assert line.fetch_mail() == (0, struct.pack("<HH", 1, 2))


def test_a_message_with_a_wrong_length_is_refused(line: Line) -> None:
    line.one(2, 0, 0x1000, struct.pack("<HHBB", 200, 0, 0, 0x13).ljust(128, b"\x00"))
    assert line.fetch_mail() == (0, struct.pack("<HH", 1, 8))
    line.one(2, 0, 0x1000, struct.pack("<HHBB", 1, 0, 0, 0x23).ljust(128, b"\x00"))
    assert line.fetch_mail() == (0, struct.pack("<HH", 1, 6))


def test_information_of_the_lists(line: Line) -> None:
    """The list of all objects comes in fragments that say how many follow."""
    _, body = line.coe(struct.pack("<BBHH", 1, 0, 0, 0), service=8)
    assert body[:6] == struct.pack("<BBHH", 2, 0, 0, 0)
    counts = struct.unpack("<5H", body[6:])
    for kind, count in enumerate(counts, 1):
        parts, left = [], 1
        line.send_mail(3, struct.pack("<HBBHH", 8 << 12, 1, 0, 0, kind))
        while left:
            _, body = line.fetch_mail()
            operation, left = body[2], int.from_bytes(body[4:6], "little")
            assert operation == (0x82 if left else 0x02)
            parts.append(body[6:])
        content = b"".join(parts)
        indices = struct.unpack(f"<{len(content) // 2}H", content)
        assert (indices[0], len(indices) - 1) == (kind, count)
        assert list(indices[1:]) == sorted(indices[1:])
    assert counts[0] > 90
    assert counts[4] == counts[3]


def test_information_of_an_object_and_its_entries(line: Line) -> None:
    _, body = line.coe(struct.pack("<BBHH", 3, 0, 0, 0x607D), service=8)
    assert body == struct.pack("<BBHHHBB", 4, 0, 0, 0x607D, 0, 2, 9) + b"Software position limit"
    _, body = line.coe(struct.pack("<BBHH", 3, 0, 0, 0x6040), service=8)
    assert body == struct.pack("<BBHHHBB", 4, 0, 0, 0x6040, 6, 0, 7) + b"Controlword"
    # Controlword: read and written in all states, in an RxPDO
    _, body = line.coe(struct.pack("<BBHHBB", 5, 0, 0, 0x6040, 0, 0), service=8)
    assert body[4:] == struct.pack("<HBBHHH", 0x6040, 0, 0, 6, 16, 0x7F) + b"Controlword"
    _, body = line.coe(struct.pack("<BBHHBB", 5, 0, 0, 0x6041, 0, 0), service=8)
    assert body[4:] == struct.pack("<HBBHHH", 0x6041, 0, 0, 6, 16, 0x87) + b"Statusword"
    # Kept by 1010
    _, body = line.coe(struct.pack("<BBHHBB", 5, 0, 0, 0x607D, 1, 0), service=8)
    assert body[4:14] == struct.pack("<HBBHHH", 0x607D, 1, 0, 4, 32, 0x13F)
    _, body = line.coe(struct.pack("<BBHHBB", 5, 0, 0, 0x1008, 0, 0), service=8)
    assert body[4:14] == struct.pack("<HBBHHH", 0x1008, 0, 0, 9, 8 * len(NAME), 0x07)
    # A gap between two sub-indices has no type and no bits
    _, body = line.coe(struct.pack("<BBHHBB", 5, 0, 0, 0x1C32, 7, 0), service=8)
    assert body[4:] == struct.pack("<HBBHHH", 0x1C32, 7, 0, 0, 0, 0)


@pytest.mark.parametrize(
    ("request_data", "code"),
    [
        (struct.pack("<BBHH", 3, 0, 0, 0x2000), 0x06020000),
        (struct.pack("<BBHHBB", 5, 0, 0, 0x2000, 0, 0), 0x06020000),
        (struct.pack("<BBHHBB", 5, 0, 0, 0x607D, 3, 0), 0x06090011),
        (struct.pack("<BBHH", 1, 0, 0, 6), 0x06010000),
        (struct.pack("<BBHH", 9, 0, 0, 0), 0x05040001),
        (struct.pack("<BBH", 3, 0, 0), 0x06070010),
    ],
)
def test_information_that_there_is_not(line: Line, request_data: bytes, code: int) -> None:
    assert line.coe(request_data, service=8) == (8, struct.pack("<BBHI", 7, 0, 0, code))


def test_an_emergency_comes_before_the_next_answer() -> None:
    line = Line()
    line.op()
    line.enable()
    line.wait(150_000_000)
    line.one(4, 0, 0, 1)
    kind, body = line.fetch_mail()
    # Service 1, fault 8130 of the connection, error register: generic and communication
    assert (kind, body) == (3, struct.pack("<HHB5x", 1 << 12, 0x8130, 0x11))


def test_nothing_is_served_in_init() -> None:
    line = Line()
    managers = struct.pack("<HHBBBBHHBBBB", 0x1000, 128, 0x26, 0, 1, 0, 0x1080, 128, 0x22, 0, 1, 0)
    line.one(2, 0, 0x0800, managers)
    line.send_mail(3, struct.pack("<H", 2 << 12) + bytes.fromhex("4000100000000000"))
    line.wait(1_000_000)
    assert line.one(1, 0, 0x1080, 128).wkc == 0


# Assignment and mapping


def test_an_assignment_changes_by_the_order_of_the_rules(line: Line) -> None:
    assert line.sdo_write(0x1C12, 1, 0x1601, 2) == 0x06010000  # while it counts
    assert line.sdo_write(0x1C12, 0, 0, 1) == 0
    assert line.sdo_write(0x1C12, 1, 0x1A00, 2) == 0x06090030
    assert line.sdo_write(0x1C12, 1, 0x1601, 2) == 0
    assert line.sdo_write(0x1C12, 2, 0x1601, 2) == 0
    assert line.sdo_write(0x1C12, 0, 2, 1) == 0x06040043  # twice the same
    assert line.sdo_write(0x1C12, 2, 0x1600, 2) == 0
    assert line.sdo_write(0x1C12, 0, 3, 1) == 0x06090031
    assert line.sdo_write(0x1C12, 0, 2, 1) == 0
    line.map_image(0, 14, 16)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    # 1601 comes first: 60FF, 6071, then 6040, 607A, 60B8
    assert line.drive.process_data.outputs.fields == (
        "target_velocity", "target_torque", "controlword", "target_position", "probe_function",
    )  # fmt: skip


def test_a_mapping_takes_what_a_pdo_of_its_direction_carries(line: Line) -> None:
    assert line.sdo_write(0x1A00, 0, 0, 1) == 0
    assert line.sdo_write(0x1A00, 1, 0x60400010, 4) == 0x06040041  # an output
    assert line.sdo_write(0x1A00, 1, 0x60410008, 4) == 0x06040041  # half of it
    assert line.sdo_write(0x1A00, 1, 0x20000010, 4) == 0x06020000
    assert line.sdo_write(0x1A00, 1, 0x60640020, 4) == 0
    assert line.sdo_write(0x1A00, 2, 0, 4) == 0
    assert line.sdo_write(0x1A00, 0, 2, 1) == 0x06040041  # the second one is empty
    assert line.sdo_write(0x1A00, 0, 1, 1) == 0
    line.map_image(0, 8, 4)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    assert line.drive.process_data.inputs.fields == ("position_actual",)


def test_several_pdos_are_one_image_in_the_order_of_their_assignment(line: Line) -> None:
    """Outputs: 1601 with a gap of 4 bytes and 6071, then 1600; inputs: 1A01 before 1A00.

    A gap is a dummy entry of CiA 301, here 0007 of 32 bits.
    """
    lists = {
        0x1601: [0x0007_0020, 0x6071_0010], 0x1600: [0x607A_0020, 0x6040_0010],
        0x1A01: [0x6061_0008, 0x60FD_0020], 0x1A00: [0x6064_0020],
        0x1C12: [0x1601, 0x1600], 0x1C13: [0x1A01, 0x1A00],
    }  # fmt: skip
    for index in (0x1C12, 0x1C13):
        assert line.sdo_write(index, 0, 0, 1) == 0
    for index, entries in lists.items():
        size = 2 if index in (0x1C12, 0x1C13) else 4
        assert line.sdo_write(index, 0, 0, 1) == 0
        for sub, entry in enumerate(entries, 1):
            assert line.sdo_write(index, sub, entry, size) == 0
        assert line.sdo_write(index, 0, len(entries), 1) == 0
    outputs, inputs = struct.Struct("<4xhiH"), struct.Struct("<bIi")
    line.map_image(0, outputs.size, inputs.size)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.write(0x120, OP, 2)
    sent = outputs.pack(-250, -70_000, 0x0006) + bytes(inputs.size)
    for _ in range(2):
        (answer,) = line.exchange((12, 0, sent))
    assert line.al() == (OP, 0)
    image = line.drive.servo.image
    assert (image.target_torque, image.controlword) == (-250, 0x0006)
    assert image.target_position == -70_000
    image.position_actual = -123_456
    image.digital_inputs = 0x8000_0001
    assert line.drive.process_data.message(image) == inputs.pack(8, 0x8000_0001, -123_456)
    assert answer.wkc == 3


def test_fixed_pdos_take_what_is_there_and_nothing_else() -> None:
    line = Line(profile=DriveProfile(fixed_pdos=True))
    line.preop()
    there = ((0x1C12, 0, 1, 1), (0x1C12, 1, 0x1600, 2), (0x1C13, 1, 0x1A00, 2))
    for index, sub, value, size in (*there, (0x1600, 1, 0x60400010, 4)):
        assert line.sdo_write(index, sub, value, size) == 0
    for index, size in ((0x1C12, 1), (0x1C13, 1), (0x1600, 1), (0x1A01, 1)):
        assert line.sdo_write(index, 0, 0, size) == 0x06010002
    assert line.sdo_write(0x1C13, 1, 0x1A01, 2) == 0x06010002


def test_mapping_and_timing_stay_outside_preop_but_what_is_there_may_be_written(line: Line) -> None:
    line.map_image()
    line.ask(SAFEOP)
    assert line.sdo_write(0x1C12, 0, 0, 1) == 0x08000022
    assert line.sdo_write(0x1600, 0, 0, 1) == 0x08000022
    assert line.sdo_write(0x1C32, 1, 0, 2) == 0x08000022
    assert [line.sdo_write(0x1C12, 0, 1, 1), line.sdo_write(0x1600, 1, 0x60400010, 4)] == [0, 0]
    assert line.sdo_write(0x1C32, 1, 1, 2) == 0
    assert line.ask(PREOP) == (PREOP, 0)
    assert line.sdo_write(0x1C12, 0, 0, 1) == 0


def test_a_list_that_is_refused_as_a_whole_stays_as_it_was(line: Line) -> None:
    data = struct.pack("<HII", 2, 0x60400010, 0x60410010)
    request = bytes.fromhex("31001600") + struct.pack("<I", len(data)) + data
    assert line.coe(request)[1][4:] == struct.pack("<I", 0x06040041)
    objects = line.drive.objects
    assert [objects.value(0x1600, sub) for sub in range(4)] == [
        3,
        0x60400010,
        0x607A0020,
        0x60B80010,
    ]


def test_a_pdo_does_not_carry_what_the_drive_lacks() -> None:
    line = Line(profile=DriveProfile(lacks="60BA 60D5"))
    line.preop()
    objects = line.drive.objects
    left = [0x60410010, 0x60640020, 0x60B90010, 0x60FD0020]
    assert [objects.value(0x1A00, sub) for sub in range(6)] == [4, *left, 0]
    assert [objects.value(0x1A01, sub) for sub in range(3)] == [1, 0x60D10020, 0]
    assert line.coe(bytes.fromhex("40ba600000000000"))[1][4:] == struct.pack("<I", 0x06020000)
