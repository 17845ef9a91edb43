"""Entries of a mapping, values that a profile refuses, and words of an EDS, without a bus."""

from configparser import ConfigParser
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest
from canopen.objectdictionary import ObjectDictionary, ODVariable, datatypes
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.canopen.node import Document
from axisrig.bench.drive.cia402.dictionary.eds import eds_text, object_dictionary
from axisrig.bench.drive.cia402.dictionary.foreign import foreign_table
from axisrig.bench.drive.cia402.dictionary.mapping import check_entry
from axisrig.bench.drive.cia402.dictionary.objects import DATA_TYPES
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.errors import UserError

NOT_MAPPABLE, NO_OBJECT = 0x0604_0041, 0x0602_0000
CARRIED = {0x6040: ("U16", "rx"), 0x6041: ("U16", "tx"), 0x6060: ("I8", "rx tx"),
           0x6502: ("U32", "")}  # fmt: skip


class Store:
    """Objects with their type and the PDOs that may carry them."""

    def row(self, index: int, _sub: int) -> Any:
        if index not in CARRIED:
            raise SdoAbortedError(NO_OBJECT)
        kind, pdo = CARRIED[index]
        return SimpleNamespace(data_type=DATA_TYPES[kind], pdo=pdo)


def answer(entry: int, direction: str) -> int:
    """The abort code of an entry, 0 where it is taken."""
    store: Any = Store()
    try:
        check_entry(entry, direction, store)
    except SdoAbortedError as error:
        return int(error.code)
    return 0


@pytest.mark.parametrize(
    ("entry", "rx", "tx"),
    [
        # CiA 301, 7.4.8: dummies are types 0001 to 0007, of RPDOs alone; 0001 is no whole byte
        *((code << 16 | bits, 0, NOT_MAPPABLE)
          for code, bits in ((2, 8), (3, 16), (4, 32), (5, 8), (6, 16), (7, 32))),
        (0x0001_0001, NOT_MAPPABLE, NOT_MAPPABLE), (0x0001_0008, NOT_MAPPABLE, NOT_MAPPABLE),
        (0x0005_0010, NOT_MAPPABLE, NOT_MAPPABLE), (0x0007_0120, NOT_MAPPABLE, NOT_MAPPABLE),
        (0x0000_0008, NO_OBJECT, NO_OBJECT), (0x0008_0020, NO_OBJECT, NO_OBJECT),
        (0x6040_0010, 0, NOT_MAPPABLE), (0x6041_0010, NOT_MAPPABLE, 0), (0x6060_0008, 0, 0),
        (0x6502_0020, NOT_MAPPABLE, NOT_MAPPABLE),
        (0x6040_0008, NOT_MAPPABLE, NOT_MAPPABLE), (0x6041_0020, NOT_MAPPABLE, NOT_MAPPABLE),
    ],
)  # fmt: skip
def test_an_entry_is_refused_with_its_reason(entry: int, rx: int, tx: int) -> None:
    assert (answer(entry, "rx"), answer(entry, "tx")) == (rx, tx)


# --- profiles


def refusal(**words: Any) -> tuple[str, Any, str]:
    """Name, value and what is allowed of a refused profile."""
    with pytest.raises(UserError) as caught:
        DriveProfile(**words)
    text = str(caught.value)
    return text, caught.value.value, caught.value.allowed


@pytest.mark.parametrize(
    "name",
    ["encoder_increments", "lead_um", "position_factor", "grid_ns", "tick_ns",
     "rated_torque_mnm", "rated_current_ma"],
)  # fmt: skip
def test_what_a_drive_divides_by_is_above_0(name: str) -> None:
    for value in (0, -1):
        text, found, allowed = refusal(**{name: value})
        assert f"drive profile: {name} cannot have this value" in text
        assert (found, allowed) == (value, "a value above 0")
    assert getattr(DriveProfile(**{name: 1}), name) == 1


@pytest.mark.parametrize("name", ["dead_time_ns", "sdo_answer_ns", "first_heartbeat_ns"])
def test_a_time_of_a_drive_may_be_0_and_not_below(name: str) -> None:
    text, found, allowed = refusal(**{name: -1})
    assert name in text
    assert (found, allowed) == (-1, "0 or more")
    assert getattr(DriveProfile(**{name: 0}), name) == 0


@pytest.mark.parametrize(("kind", "low", "high"), [("I16", -0x8000, 0x7FFF), ("U16", 0, 0xFFFF)])
@pytest.mark.parametrize("name", ["source_1", "source_2", "trigger_sources"])
def test_a_source_is_a_number_that_60d0_can_hold(kind: Any, low: int, high: int, name: str) -> None:
    """The least and the greatest are taken; of several values each one counts."""
    others = {"trigger_sources": f"{low} 1 {high}"} if name != "trigger_sources" else {}

    def value(number: int) -> Any:
        return f"1 {number} 2" if name == "trigger_sources" else number

    for number in (low, high):
        profile = DriveProfile(source_type=kind, **others, **{name: value(number)})
        assert getattr(profile, name) == value(number)
        assert number in profile.source_values
    for number in (low - 1, high + 1):
        text, found, allowed = refusal(source_type=kind, **others, **{name: value(number)})
        assert name in text
        assert (found, allowed) == (value(number), f"{low} to {high}")


def test_a_revolution_is_whole_position_units() -> None:
    text, found, allowed = refusal(encoder_increments=1001, position_factor=Fraction(1, 2))
    assert "position_factor" in text
    assert (found, allowed) == (Fraction(1, 2), "whole position units per revolution")
    whole = DriveProfile(encoder_increments=1000, position_factor=Fraction(3, 2))
    assert whole.units_per_revolution == 1500


# --- an EDS


def test_an_eds_says_what_its_device_can_do_beside_its_objects() -> None:
    """CiA 306-1, 4.5: of a slave that boots by itself and has LSS, with PDOs of whole bytes."""
    text = eds_text(DriveProfile(), "as-named.eds")
    assert text.endswith("\n")
    eds = ConfigParser()
    eds.optionxform = str  # type: ignore[assignment, method-assign]
    eds.read_string(text)
    device = dict(eds["DeviceInfo"])
    assert {key: device[key] for key in (
        "SimpleBootUpMaster", "SimpleBootUpSlave", "Granularity", "DynamicChannelsSupported",
        "GroupMessaging", "LSS_Supported",
    )} == {
        "SimpleBootUpMaster": "0", "SimpleBootUpSlave": "1", "Granularity": "8",
        "DynamicChannelsSupported": "0", "GroupMessaging": "0", "LSS_Supported": "1",
    }  # fmt: skip
    rates = {key.removeprefix("BaudRate_"): value for key, value in device.items() if "Rate" in key}
    assert rates == dict.fromkeys(("10", "20", "50", "125", "250", "500", "800", "1000"), "1")
    info = eds["FileInfo"]
    assert (info["FileVersion"], info["FileRevision"], info["EDSVersion"]) == ("1", "0", "4.0")
    for what in ("Creation", "Modification"):
        assert (info[f"{what}Time"], info[f"{what}Date"]) == ("12:00AM", "01-01-2026")
    assert dict(eds["DummyUsage"]) == {
        f"Dummy{code:04d}": str(int(code > 1)) for code in range(1, 8)
    }  # fmt: skip
    assert dict(eds["Comments"]) == {"Lines": "0"}


@pytest.mark.parametrize(
    ("index", "access", "pdo"),
    [
        *((0x1017, access, "") for access in ("rw", "rwr", "rww")),
        (0x2000, "rw", "rx tx"), (0x2000, "rwr", "tx"), (0x2000, "rww", "rx"),
        (0x6065, "rwr", "tx"), (0x6065, "rww", "rx"),
    ],
)  # fmt: skip
def test_an_object_that_the_model_keeps_beside_its_image_is_in_no_pdo(
    index: int, access: str, pdo: str
) -> None:
    """CiA 306-1: `rwr` may be in a TPDO, `rww` in an RPDO. 1017 is of the communication."""
    od: Any = ObjectDictionary()
    one: Any = ODVariable("own", index)
    one.data_type, one.access_type, one.pdo_mappable = datatypes.UNSIGNED32, access, True
    od.add_object(one)
    row = foreign_table(DriveProfile(), od).rows[index, 0]
    assert (row.pdo, row.access) == (pdo, "rw")


@pytest.mark.parametrize("text", [b"", b"[FileInfo]\r\nFileName=maker.eds\r\n"])
def test_a_drive_with_the_eds_of_its_maker_hands_that_out(drive_bench: Any, text: bytes) -> None:
    """1021, as it is, byte for byte; one without it hands out the EDS of its profile."""
    profile = DriveProfile(lacks="60FD")
    document = Document(object_dictionary(3, profile), text)
    with_it = drive_bench(profile=profile, document=document).node.slave.objects
    assert with_it.upload(0x1021, 0) == text
    without = drive_bench(profile=profile).node.slave.objects
    assert without.upload(0x1021, 0) == eds_text(profile).encode()
