"""Mapping table of a rig, cell by cell: event timers, and the limits of each number (CiA 301)."""

from pathlib import Path

import pytest

from axisrig.kernel.drives.canopen.mapping import Telegram, telegrams
from axisrig.kernel.errors import UserError

COLUMNS = (
    "pdo", "transmission", "inhibit_100us", "index", "sub", "bits", "signed", "field", "cob_id",
    "event_ms",
)  # fmt: skip
NEEDED = (
    "RPDO1,1,0,0x607A,0,32,yes,target,,", "RPDO1,1,0,0x6040,0,16,no,controlword,,",
    "TPDO1,1,0,0x6064,0,32,yes,actual,,", "TPDO1,1,0,0x6041,0,16,no,statusword,,",
)  # fmt: skip
LINE = 2 + len(NEEDED)  # of the row under test
RPDO = {"pdo": "RPDO2", "index": "0x6072", "field": ""}
TPDO = {"pdo": "TPDO3", "index": "0x60FD", "bits": "32", "field": "inputs"}


def read(folder: Path, **cells: str) -> Telegram:
    """Read a table with one more row; return its telegram."""
    row = {
        "transmission": "1", "inhibit_100us": "0", "sub": "0", "bits": "16", "signed": "no",
        "cob_id": "", "event_ms": "", **cells,
    }  # fmt: skip
    lines = [",".join(COLUMNS), *NEEDED, ",".join(row[name] for name in COLUMNS)]
    path = folder / "map.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return telegrams(0x60BA, str(path))[row["pdo"]]


def refused(folder: Path, **cells: str) -> UserError:
    with pytest.raises(UserError) as caught:
        read(folder, **cells)
    assert caught.value.file == str(folder / "map.csv")
    return caught.value


@pytest.mark.parametrize("transmission", ["254", "255"])
@pytest.mark.parametrize("event_ms", ["1", "20", "65535"])
def test_an_event_driven_telegram_of_the_drive_has_an_event_timer(
    tmp_path: Path, transmission: str, event_ms: str
) -> None:
    found = read(tmp_path, **TPDO, transmission=transmission, event_ms=event_ms)
    assert (found.transmission, found.event_ms) == (int(transmission), int(event_ms))
    assert found.promised_ns(1_000_000) == int(event_ms) * 1_000_000


@pytest.mark.parametrize("transmission", ["0", "1", "240", "252", "253", "254", "255"])
@pytest.mark.parametrize("row", [RPDO, TPDO], ids=["to the drive", "from the drive"])
def test_an_event_timer_is_of_event_driven_telegrams_of_the_drive_alone(
    tmp_path: Path, row: dict[str, str], transmission: str
) -> None:
    """CiA 301, sub-index 5: the control promises no time for what a drive receives."""
    if row is TPDO and transmission in ("254", "255"):
        assert read(tmp_path, **row, transmission=transmission, event_ms="20").event_ms == 20
        return
    error = refused(tmp_path, **row, transmission=transmission, event_ms="20")
    assert error.message == "event_ms of the mapping table cannot be that"
    assert (error.line, error.value) == (LINE, "20")
    assert error.allowed == "0, or a TPDO of type 254 or 255: its event timer, ms"


@pytest.mark.parametrize("event_ms", ["", "0", "0x0"])
@pytest.mark.parametrize("transmission", ["1", "255"])
@pytest.mark.parametrize("row", [RPDO, TPDO], ids=["to the drive", "from the drive"])
def test_any_telegram_may_be_without_an_event_timer(
    tmp_path: Path, row: dict[str, str], transmission: str, event_ms: str
) -> None:
    assert read(tmp_path, **row, transmission=transmission, event_ms=event_ms).event_ms == 0


@pytest.mark.parametrize(
    ("column", "low", "high"),
    [("transmission", 0, 255), ("inhibit_100us", 0, 65535), ("sub", 0, 255), ("bits", 1, 64),
     ("event_ms", 0, 65535)],
)  # fmt: skip
def test_a_number_has_the_limits_of_its_object(
    tmp_path: Path, column: str, low: int, high: int
) -> None:
    """UNSIGNED8, UNSIGNED16, and the 64 bits of a PDO."""
    row = TPDO if column == "event_ms" else RPDO
    base = {"transmission": "254"} if column == "event_ms" else {}
    for value in (low, high):
        read(tmp_path, **{**row, **base, column: str(value)})
        read(tmp_path, **{**row, **base, column: hex(value)})
    for text in (str(low - 1), str(high + 1), "two", "1.0"):
        error = refused(tmp_path, **{**row, **base, column: text})
        assert error.message == f"{column} of the mapping table cannot be that"
        assert (error.line, error.value, error.allowed) == (LINE, text, f"{low} .. {high}")


@pytest.mark.parametrize(
    "pdo", ["RPDO0", "RPDO513", "XPDO1", "RPDO", "RPDO01", "rpdo1", "RPDO1000"]
)
def test_a_telegram_is_one_of_512_of_each_direction(tmp_path: Path, pdo: str) -> None:
    error = refused(tmp_path, **{**RPDO, "pdo": pdo}, cob_id="0x1C1")
    assert error.message == "pdo of the mapping table cannot be that"
    assert (error.line, error.value) == (LINE, pdo)
    assert error.allowed == "RPDO1 to RPDO512, TPDO1 to TPDO512"


@pytest.mark.parametrize(
    ("row", "number", "index"),
    [(RPDO, 2, 0x1401), (RPDO, 512, 0x15FF), (TPDO, 2, 0x1801), (TPDO, 512, 0x19FF)],
)
def test_the_last_telegram_has_the_last_communication_parameter(
    tmp_path: Path, row: dict[str, str], number: int, index: int
) -> None:
    """CiA 301: 1400 to 15FF and 1800 to 19FF."""
    found = read(tmp_path, **{**row, "pdo": f"{row['pdo'][:4]}{number}"}, cob_id="0x1C1")
    assert (found.communication_index, found.cob_id(5)) == (index, 0x1C1)


@pytest.mark.parametrize("pdo", ["RPDO4", "RPDO5", "TPDO4", "TPDO5"])
def test_from_the_fifth_telegram_on_it_needs_an_identifier(tmp_path: Path, pdo: str) -> None:
    """The pre-defined connection set has four of each direction: 200h, 300h, .. and 180h, .."""
    row = RPDO if pdo.startswith("R") else TPDO
    if pdo.endswith("4"):
        found = read(tmp_path, **{**row, "pdo": pdo})
        assert found.cob_id(5) == (0x505 if pdo.startswith("R") else 0x485)
        return
    error = refused(tmp_path, **{**row, "pdo": pdo})
    assert error.message == "cob_id of the mapping table cannot be that"
    assert error.line == LINE
    assert error.allowed is not None
    assert error.allowed.endswith(f"the pre-defined set has none for {pdo}")


@pytest.mark.parametrize("cob_id", ["0x000", "0x080", "0x601", "0x581", "0x701", "0x7E5", "0x101"])
def test_identifiers_that_are_restricted_are_no_telegrams(tmp_path: Path, cob_id: str) -> None:
    """CiA 301, restricted CAN-IDs: NMT, SYNC, SDO, error control, LSS; 0 leaves the usual one."""
    if not int(cob_id, 0):
        assert read(tmp_path, **RPDO, cob_id=cob_id).cob_id(5) == 0x305
        return
    error = refused(tmp_path, **RPDO, cob_id=cob_id)
    assert error.message == "cob_id of the mapping table cannot be that"
    assert (error.line, error.value) == (LINE, cob_id)


@pytest.mark.parametrize(
    ("field", "row", "allowed"),
    [("inputs", RPDO, "a TPDO for inputs"), ("probe_function", TPDO, "an RPDO for probe_function")],
)
def test_a_field_has_its_direction(
    tmp_path: Path, field: str, row: dict[str, str], allowed: str
) -> None:
    error = refused(tmp_path, **{**row, "field": field})
    assert error.message == "pdo of the mapping table cannot be that"
    assert (error.value, error.allowed) == (row["pdo"], allowed)


SECOND = {"pdo": "TPDO4", "index": "0x60E4", "sub": "1", "field": "second"}


@pytest.mark.parametrize(
    ("transmission", "is_taken"),
    [("0", False), ("1", True), ("240", True), ("241", False), ("253", False), ("254", True),
     ("255", True)],
)  # fmt: skip
def test_the_second_encoder_comes_by_itself(
    tmp_path: Path, transmission: str, is_taken: bool
) -> None:
    row = {**SECOND, "bits": "32", "signed": "yes", "transmission": transmission}
    if is_taken:
        assert read(tmp_path, **row).transmission == int(transmission)
        return
    error = refused(tmp_path, **row)
    assert error.message == "TPDO4 carries second and must come by itself"
    assert (error.line, error.allowed) == (LINE, "1 .. 240, 254, 255")


@pytest.mark.parametrize(("bits", "signed"), [("32", "no"), ("16", "yes"), ("64", "yes")])
def test_the_second_encoder_is_a_signed_position_of_32_bits(
    tmp_path: Path, bits: str, signed: str
) -> None:
    error = refused(tmp_path, **SECOND, bits=bits, signed=signed)
    assert error.message == "the field second is a signed position of 32 bits"
    assert (error.line, error.value) == (LINE, f"{bits} bits, signed {signed}")
