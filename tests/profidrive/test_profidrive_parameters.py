"""Parameters of a PROFIdrive drive: bytes as SINAMICS 6SL3097-4AB10 p. 613 has them, and #DRIVE."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.profidrive.test_profidrive_machine import ids, settings_of

from axisrig.bench.drive.profidrive.parameters import DriveParameters
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.profidrive.keys import DriveTable
from axisrig.bench.rig.profidrive.members import drive_of
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.drives.functions import AccessError
from axisrig.kernel.drives.profidrive.parameter_channel import ParameterChannel
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.profiles.profidrive.parameters import Request, negative, positive

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
STOP = RIGS / "fixed-stop-z-profidrive.toml"
READ_1230 = "07 01 00 01  10 01 04CE 0000"
WRITE_1230 = "08 02 00 01  10 01 04CE 0000  42 01 016A"


@pytest.fixture
def drive() -> DriveParameters:
    return DriveParameters(drive_of(settings_of(), "Z").make())


def answer(drive: DriveParameters, request: str) -> str:
    return drive.answer(bytes.fromhex(request)).hex(" ").upper()


def test_a_value_is_read_with_its_format(drive: DriveParameters) -> None:
    assert answer(drive, READ_1230) == "07 01 00 01 42 01 03 E8"
    assert answer(drive, "01 01 00 01  10 00 0370 0000") == "01 01 00 01 43 01 00 00 40 00"


@pytest.mark.parametrize(("xist1", "absolute"), [(11, 11), (11, 13), (11, 9), (8, 0)])
def test_fine_bits_are_those_that_the_rig_gives(xist1: int, absolute: int) -> None:
    """P1042 and P1043 each have their own."""
    keys = {"family": "profidrive", "p1042": xist1, "p1043": absolute}
    values = DriveParameters(DriveTable.model_validate(keys).make()).values
    assert (values[1042], values[1043]) == (xist1, absolute)


def test_a_value_is_written(drive: DriveParameters) -> None:
    assert answer(drive, WRITE_1230) == "08 02 00 01"
    assert drive.values[1230] == 362  # 0x16A


@pytest.mark.parametrize(
    ("data", "value"),
    [("00", "41 01 00 00"), ("0000", "42 01 0000"), ("00000000", "43 01 00000000")],
)
def test_a_0_is_written_as_any_other_value(data: str, value: str) -> None:
    """Identifier 0x02; only a request without a value reads (0x01)."""
    head = "10 01 04CE 0003"
    request = Request(9, 1230, 3, bytes.fromhex(data))
    assert request.pack() == bytes.fromhex(f"09 02 00 01 {head} {value}")
    assert Request(9, 1230, 3).pack() == bytes.fromhex(f"09 01 00 01 {head}")


@pytest.mark.parametrize(("axis", "count"), [(0, 1), (3, 2), (255, 39)])
@pytest.mark.parametrize("kind", [1, 2])
def test_a_response_has_reference_axis_and_number_of_its_request(
    axis: int, count: int, kind: int
) -> None:
    """A refusal has bit 7 of the identifier besides."""
    head = bytes((200, kind, axis, count))
    request = head + bytes.fromhex("10 01 04CE 0000")
    assert positive(request) == head
    assert positive(request, b"\x05") == head + bytes.fromhex("41 01 05 00")
    refused = bytes((200, kind | 0x80, axis, count))
    assert negative(request, "READ_ONLY") == refused + bytes.fromhex("44 01 0001")


@pytest.mark.parametrize(
    ("request_bytes", "code"),
    [
        ("01 01 00 01  10 01 0001 0000", 0x00),
        ("01 02 00 01  10 01 0370 0000  43 01 00000001", 0x01),
        ("01 02 00 01  10 01 04CE 0000  42 01 2329", 0x02),
        ("01 02 00 01  10 01 04CE 0000  42 01 0031", 0x02),
        ("01 01 00 01  10 01 04CE 0001", 0x04),
        ("01 02 00 01  10 01 04CE 0000  43 01 00000064", 0x05),
        ("01 02 00 01  10 01 04CE 0000  41 01 64 00", 0x05),
        ("01 01 00 01  20 01 04CE 0000", 0x16),
        ("01 01 00 01  10 02 04CE 0000", 0x16),
        ("01 01 00 02  10 01 04CE 0000", 0x16),
        ("01 02 00 01  10 01 04CE 0000  50 01 0064", 0x17),
        ("01 02 00 01  10 01 04CE 0000  42 02 0064", 0x18),
        ("01 02 00 01  10 01 04CE 0000  42 01", 0x18),
        ("01 02 00 01  10 01 04CE 0000", 0x18),
    ],
)
def test_what_is_refused_has_its_error_value(
    drive: DriveParameters, request_bytes: str, code: int
) -> None:
    before = dict(drive.values)
    found = drive.answer(bytes.fromhex(request_bytes))
    assert found[1] == bytes.fromhex(request_bytes)[1] | 0x80
    assert found[4:].hex() == f"4401{code:04x}"
    assert drive.values == before


def test_what_is_no_request_has_no_response(drive: DriveParameters) -> None:
    assert drive.answer(b"\x01\x01\x00") == b""


# The control's end


class Far:
    """The far end of a channel: keeps requests, answers when it is asked to."""

    def __init__(self) -> None:
        self.requests: list[bytes] = []
        self._done: list[Callable[[bytes], None]] = []
        self.channel = ParameterChannel(self._send)
        self.found: list[bytes | AccessError] = []

    def _send(self, request: bytes, done: Callable[[bytes], None]) -> None:
        self.requests.append(request)
        self._done.append(done)

    def answer(self, response: str) -> str | bytes:
        self._done.pop(0)(bytes.fromhex(response))
        last = self.found[-1]
        return f"{last.target}: {last}" if isinstance(last, AccessError) else last


@pytest.fixture
def far() -> Far:
    return Far()


def test_requests_are_those_of_the_profile_and_run_in_turn(far: Far) -> None:
    far.channel.read(1230, 0, far.found.append)
    far.channel.write(1230, 0, b"\x6a\x01", far.found.append)
    assert [each.hex(" ") for each in far.requests] == ["01 01 00 01 10 01 04 ce 00 00"]
    assert far.answer("01 01 00 01 42 01 03 E8") == b"\xe8\x03"
    assert far.requests[1].hex(" ") == "02 02 00 01 10 01 04 ce 00 00 42 01 01 6a"
    assert far.answer("02 02 00 01") == b""


def test_references_run_from_1_to_255_and_begin_anew(far: Far) -> None:
    for number in range(600):
        reference = number % 255 + 1
        far.channel.read(1230, 0, far.found.append)
        assert far.requests[-1][0] == reference
        assert far.answer(f"{reference:02X} 01 00 01 42 01 03 E8") == b"\xe8\x03"


@pytest.mark.parametrize("waiting", [0, 1, 2])
def test_what_an_answer_asks_for_comes_behind_what_waits_and_once(far: Far, waiting: int) -> None:
    def ask_next(found: bytes | AccessError) -> None:
        far.found.append(found)
        far.channel.read(5000, 0, far.found.append)

    far.channel.read(1000, 0, ask_next)
    for number in range(waiting):
        far.channel.read(2000 + number, 0, far.found.append)
    for reference in range(1, waiting + 3):
        assert len(far.requests) == reference  # one at a time
        far.answer(f"{reference:02X} 01 00 01 42 01 00 {reference:02X}")
    numbers = [int.from_bytes(each[6:8], "big") for each in far.requests]
    assert numbers == [1000, *range(2000, 2000 + waiting), 5000]
    assert far.found == [bytes((reference, 0)) for reference in range(1, waiting + 3)]


@pytest.mark.parametrize(
    ("response", "words"),
    [
        ("", "no answer"),
        ("02 01 00 01 42 01 03 E8", "no answer"),
        ("01 02 00 01", "no answer"),
        ("01 81 00 01 44 01 00 00", "error 0x00, there is no such parameter"),
        ("01 81 00 01 44 01 00 7B", "error 0x7B, one of the manufacturer"),
    ],
)
def test_what_is_no_value_is_an_error(far: Far, response: str, words: str) -> None:
    """Silence, a response to another request, a refusal."""
    far.channel.read(1230, 0, far.found.append)
    assert far.answer(response) == f"P1230: {words}"


# In a machine


@pytest.fixture
def run(tmp_path: Path) -> Callable[..., Machine]:
    def make(program: str, *changes: str) -> Machine:
        (tmp_path / "own.nc").write_text(program, encoding="utf-8")
        assigned = [(parse_assignment(text), as_written) for text in changes]
        settings = read_settings(*read_rig(STOP), assigned)
        check_rig(settings)
        machine = Machine(settings, read_program(tmp_path / "own.nc", ("Z",)))
        try:
            machine.run()
        finally:
            machine.close()
        return machine

    return make


WRITE = "%w\nN10 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL={} WAIT]\nN20 M30\n"


@pytest.mark.provokes(900032, 4, axis="Z", key="TORQUE_LIMIT", object="P1230")
def test_900032_for_a_value_beyond_the_limits_of_the_drive(run: Callable[..., Machine]) -> None:
    machine = run(WRITE.format(9001))
    assert ids(machine) == [900032]
    (alarm,) = machine.channel.alarms
    assert "error 0x02" in str(alarm)


@pytest.mark.provokes(900255, 2, axis="Z", ident="S-0-0092")
@pytest.mark.long
def test_900255_for_an_ident(run: Callable[..., Machine]) -> None:
    program = "%i\nN10 #IDENT WR [AX=Z ID=S-0-0092 VAL=100 TYP=2 DEC=0 SERC]\nN20 M30\n"
    assert ids(run(program)) == [900255]


@pytest.mark.long
def test_a_request_takes_its_time(run: Callable[..., Machine]) -> None:
    """A write that is waited for lasts request_us, up to two cycles of the program's own."""
    lasts_ms = []
    for wait_us in (5_000, 45_000):
        machine = run(WRITE.format(500), f"bus:bus.request_us={wait_us}")
        assert ids(machine) == []
        assert machine.installed[0].ends["Z"].node.parameters.values[1230] == 500  # type: ignore[attr-defined]
        lasts_ms.append(machine.scheduler.now_ns / 1e6)
    assert 39 <= lasts_ms[1] - lasts_ms[0] <= 41


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("set:Z.antr.function[0].wr_ident[0]=1231", "no such parameter"),
        ("set:Z.antr.function[0].wr_ident[0]=6072_0A", "no parameter of a PROFIdrive drive"),
        ("set:Z.antr.function[0].data_type=UNS32", "another data type"),
        ("set:Z.antr.function[0].commu=CYCLIC", "no word of the telegram"),
    ],
)
def test_a_function_that_the_drive_does_not_have_is_refused(change: str, words: str) -> None:
    assigned = [(parse_assignment(change), as_written)]
    with pytest.raises(UserError, match=words):
        check_rig(read_settings(*read_rig(STOP), assigned))


# What the drive does with them


@pytest.mark.parametrize(
    ("p0881", "momred", "limit"),
    [
        (100, 0, 1000),
        (100, 8192, 500),
        (100, 16384, 0),
        (25, 65535, 0),  # 1 - 0.25 * 65535/16384 = 0.00002
        (25, 16384, 750),
        (1000, 1638, 0),  # 1 - 10 * 1638/16384 = 0.0002: 0.2 of 0.1 %
        (0, 65535, 1000),
    ],
)
def test_momred_reduces_the_torque_limit(
    drive: DriveParameters, p0881: int, momred: int, limit: int
) -> None:
    """k = max(0, 1 - P0881/100 % MomRed/16384): SIMODRIVE 611 universal p. 224."""
    drive.values[881] = p0881
    assert drive.torque_limit(momred) == limit


@pytest.fixture
def node(tmp_path: Path) -> Iterator[Any]:
    """The drive of a machine that has not run."""
    (tmp_path / "own.nc").write_text("%n\nN10 M30\n", encoding="utf-8")
    machine = Machine(settings_of(), read_program(tmp_path / "own.nc", ("Z",)))
    yield machine.installed[0].ends["Z"].node  # type: ignore[attr-defined]
    machine.close()


def test_the_input_of_the_probe_is_p0660(node: Any) -> None:
    """A function that waits gets the input with 80 and loses it with another value."""
    node.encoder.command(1 | 1 << 4 | 1 << 7)
    assert node.encoder.function() != 0
    node.parameters.answer(bytes.fromhex("01 02 00 01 10 01 0294 0000 42 01 0000"))
    assert node.encoder.function() == 0


def test_p0925_is_how_many_signs_are_borne(node: Any) -> None:
    node.parameters.answer(bytes.fromhex("01 02 00 01 10 01 039D 0000 42 01 0003"))
    lost = []
    for _ in range(5):
        node.life.take(7)
        lost.append(node.life.is_lost)
    assert lost == [False, False, False, False, True]
