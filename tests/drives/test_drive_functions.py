"""Drive functions as an axis list declares them: identifiers, scaling, limits, masks."""

from pathlib import Path

import pytest

from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.drives.canopen.dictionary import check_functions
from axisrig.kernel.drives.canopen.mapping import telegrams
from axisrig.kernel.drives.functions import DriveFunction, read_functions
from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.parameters import read_list

# FCT-C4 section 7.3.2, read as meant: MON WINDOW = MON_WINDOW, 6065 00 = 6065_00
PRINTED = """
antr.function[0].id             MON_WINDOW
antr.function[0].wr_ident[0]    6065_00
antr.function[0].commu          ACYCLIC
antr.function[0].data_type      UNS32
antr.function[0].mask           NOT_USED
antr.function[0].scaling_type   UNSCALED
antr.function[0].scaling_factor 1.0
antr.function[0].min_limit      0.0
antr.function[0].max_limit      4294967295
antr.function[1].id             TORQUE_LIMIT
antr.function[1].wr_ident[0]    6072_00
antr.function[1].commu          ACYCLIC
antr.function[1].data_type      UNS16
antr.function[1].mask           NOT_USED
antr.function[1].scaling_type   LINEAR
antr.function[1].scaling_factor 10.0
"""


def _read(tmp_path: Path, text: str) -> tuple[dict[str, DriveFunction], list[Alarm]]:
    path = tmp_path / "axis.lst"
    path.write_text(text, encoding="utf-8")
    return read_functions("Z", read_list(path, "axis"))


def test_the_printed_list_declares_both_functions(tmp_path: Path) -> None:
    functions, warnings = _read(tmp_path, PRINTED)
    assert warnings == []
    window, torque = functions["MON_WINDOW"], functions["TORQUE_LIMIT"]
    assert (window.index, window.sub, window.data_type) == (0x6065, 0, "UNS32")
    assert (torque.index, torque.sub, torque.data_type) == (0x6072, 0, "UNS16")
    assert window.encode(window.raw(4294967295, "Z")) == b"\xff\xff\xff\xff"
    assert window.encode(window.raw(1048575, "Z")) == b"\xff\xff\x0f\x00"
    assert torque.encode(torque.raw(10, "Z")) == b"\x64\x00"  # 100 per mille
    assert torque.encode(torque.raw(5000, "Z")) == b"\x50\xc3"  # 50000
    assert torque.value(b"\x64\x00") == 10.0


def test_a_value_beyond_a_limit_is_moved_to_it_without_a_message(tmp_path: Path) -> None:
    """TF5200 225959307; the limits are those of VAL, before the scaling."""
    text = PRINTED + "antr.function[1].min_limit 2\nantr.function[1].max_limit 300\n"
    functions, warnings = _read(tmp_path, text)
    torque = functions["TORQUE_LIMIT"]
    assert [torque.raw(value, "Z") for value in (0, 2, 150, 300, 5000)] == [
        20,
        20,
        1500,
        3000,
        3000,
    ]
    assert warnings == []


@pytest.mark.parametrize(
    ("lines", "alarm_id", "values"),
    [
        ("max_limit 7000", 70383, {"high": "7000", "corrected": "6553.5"}),
        ("min_limit -1", 70384, {"low": "-1", "corrected": "0"}),
        ("min_limit 300;max_limit 2", 70385, {"low": "300", "high": "2"}),
    ],
)
@pytest.mark.provokes(70383, 1, high=7000, corrected=6553.5)
@pytest.mark.provokes(70384, 1, low=-1, corrected=0)
@pytest.mark.provokes(70385, 1, low=300, high=2)
def test_limits_that_cannot_be_are_corrected_with_a_warning(
    tmp_path: Path, lines: str, alarm_id: int, values: dict[str, str]
) -> None:
    added = "".join(f"antr.function[1].{line}\n" for line in lines.split(";"))
    _, (warning,) = _read(tmp_path, PRINTED + added)
    assert (warning.id, warning.ends_program) == (alarm_id, False)
    assert {name: warning.values[name] for name in values} == values


@pytest.mark.parametrize(
    ("data_type", "lines", "found"),
    [
        ("UNS16", "min_limit -7000;max_limit 1", [(70384, "-6553.5"), (70383, "0")]),
        ("UNS16", "min_limit -6553.5;max_limit 0", []),
        ("SGN16", "min_limit -3276.8;max_limit 3276.9", [(70384, "-3276.7"), (70383, "3276.8")]),
        ("SGN16", "min_limit -3276.7;max_limit 3276.8", []),
    ],
)
def test_a_negative_factor_turns_the_limits_of_the_data_type_round(
    tmp_path: Path, data_type: str, lines: str, found: list[tuple[int, str]]
) -> None:
    """VAL times -10 has to fit: 0 to 65535, and -32768 to 32767."""
    text = PRINTED.replace("10.0", "-10.0").replace("UNS16", data_type)
    added = "".join(f"antr.function[1].{line}\n" for line in lines.split(";"))
    functions, warnings = _read(tmp_path, text + added)
    assert [(each.id, each.values["corrected"]) for each in warnings] == found
    torque = functions["TORQUE_LIMIT"]
    assert torque.raw(-300, "Z") == 3000
    assert torque.value(torque.encode(3000)) == -300.0


def test_swapped_limits_act_in_their_right_order(tmp_path: Path) -> None:
    text = PRINTED + "antr.function[1].min_limit 300\nantr.function[1].max_limit 2\n"
    functions, _ = _read(tmp_path, text)
    torque = functions["TORQUE_LIMIT"]
    assert [torque.raw(value, "Z") for value in (0, 150, 5000)] == [20, 1500, 3000]


def test_900111_and_900112(tmp_path: Path) -> None:
    functions, _ = _read(tmp_path, PRINTED)
    with pytest.raises(Alarm) as caught:
        functions["TORQUE_LIMIT"].raw(0.5, "Z")
    assert caught.value.id == 900111
    with pytest.raises(Alarm) as caught:
        functions["TORQUE_LIMIT"].raw(-1, "Z")
    assert caught.value.id == 900112


@pytest.mark.parametrize(
    ("old", "new", "message", "shown"),
    [
        ("6072_00", "S-0-0092", "no object of a CANopen drive",
         ("S-0-0092", "index and sub-index as in 6072_00")),
        ("TORQUE_LIMIT", "mon_window", "two drive functions have one name",
         ("antr.function[..].id mon_window", None)),
        ("10.0", "0", "must not be 0", (0.0, None)),
        ("NOT_USED", "some", "no whole number", ("some", None)),
        ("LINEAR", "TORQUE_DRIVE_SIDE", "does not act yet",
         ("TORQUE_DRIVE_SIDE", "UNSCALED, LINEAR")),
        ("antr.function[1].commu", "antr.function[1].rd_ident 6072\nantr.function[1].commu",
         r"function\[1\].rd_ident is no object of a CANopen drive",
         ("6072", "index and sub-index as in 6072_00")),
        ("antr.function[1].commu", "antr.function[1].startup_value 1.5\nantr.function[1].commu",
         r"function\[1\].startup_value is no whole number", ("1.5", None)),
    ],
)  # fmt: skip
def test_a_list_that_cannot_be_is_refused(
    tmp_path: Path, old: str, new: str, message: str, shown: tuple[object, str | None]
) -> None:
    with pytest.raises(UserError, match=message) as caught:
        _read(tmp_path, PRINTED.replace(old, new))
    assert caught.value.message.startswith("axis Z: ")
    assert (caught.value.value, caught.value.allowed) == shown


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("6072_00", "5FFF_00", "no such object"),
        ("6072_00", "6041_00", "does not let it be written"),
        ("UNS16", "UNS32", "another data type"),
        ("ACYCLIC", "CYCLIC", "no RPDO carries its object freely"),
    ],
)
def test_a_function_that_the_drive_does_not_have_is_refused(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    functions, _ = _read(tmp_path, PRINTED.replace(old, new))
    od = object_dictionary(3, DriveProfile())
    with pytest.raises(UserError, match=message):
        check_functions("Z", functions, od, telegrams(0x60BA))


READ = (0x6072, 0)


@pytest.mark.parametrize(
    ("place", "read", "data_type", "communication", "words"),
    [
        ((0x5FFF, 2), READ, "UNS16", "ACYCLIC",
         ("the drive has no such object", "0x5FFF:2", None, None)),
        (READ, (0x5FFF, 3), "UNS16", "ACYCLIC",
         ("the drive has no such object to read", "0x5FFF:3", None, None)),
        ((0x6041, 0), READ, "UNS16", "ACYCLIC",
         ("the drive does not let it be written", "0x6041:0 Statusword", None, None)),
        (READ, READ, "UNS32", "ACYCLIC",
         ("0x6072:0 Max torque has another data type", "UNS32", "16 bits unsigned", None)),
        (READ, READ, "SGN16", "ACYCLIC",
         ("0x6072:0 Max torque has another data type", "SGN16", "16 bits unsigned", None)),
        (READ, READ, "UNS16", "CYCLIC",
         ("no RPDO carries its object freely", "0x6072:0",
          "objects of RPDOs without a field in the mapping table",
          "map it in the table of pdo_map, or use ACYCLIC")),
        # Carried, and led by the control itself
        ((0x6040, 0), (0x6040, 0), "UNS16", "CYCLIC",
         ("no RPDO carries its object freely", "0x6040:0",
          "objects of RPDOs without a field in the mapping table",
          "map it in the table of pdo_map, or use ACYCLIC")),
    ],
)  # fmt: skip
def test_the_refusal_of_a_function_names_axis_object_and_what_is_allowed(
    place: tuple[int, int], read: tuple[int, int], data_type: str, communication: str,
    words: tuple[str, str, str | None, str | None],
) -> None:  # fmt: skip
    """Objects and types of CiA 402: 6040 and 6041 UNSIGNED16, 6072 UNSIGNED16."""
    function = DriveFunction(
        "KEY", communication, *place, *read, data_type, None, 1.0, 0.0, 1.0, None
    )
    od = object_dictionary(3, DriveProfile())
    with pytest.raises(UserError) as caught:
        check_functions("Z2", {"KEY": function}, od, telegrams(0x60BA))
    error = caught.value
    assert error.message.startswith("drive function KEY of axis Z2")
    assert error.message.endswith(words[0])
    assert (error.value, error.allowed, error.hint) == words[1:]


def test_a_function_that_nothing_communicates_needs_no_rpdo() -> None:
    od = object_dictionary(3, DriveProfile())
    for communication in ("ACYCLIC", "IGNORE"):
        function = DriveFunction(
            "KEY", communication, *READ, *READ, "UNS16", None, 1.0, 0.0, 1.0, None
        )
        check_functions("Z", {"KEY": function}, od, {})


@pytest.mark.parametrize(
    ("mask", "data_type", "raw", "present", "merged"),
    [
        (0x0F, "UNS08", 0xFF, 0xA0, 0xAF),
        (0x8000, "SGN16", -32768, 0x0001, -32767),
        (0x00FF, "SGN16", 0x12, -1, -238),  # 0xFF12
    ],
)
def test_only_the_bits_of_the_mask_change(
    mask: int, data_type: str, raw: int, present: int, merged: int
) -> None:
    function = DriveFunction(
        "BITS", "ACYCLIC", 0x6072, 0, 0x6072, 0, data_type, mask, 1.0, -1e199, 1e199, None
    )
    assert function.merged(raw, function.encode(present)) == merged
