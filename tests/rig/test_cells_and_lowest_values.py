"""Numbers of keys of drives: hexadecimal cells, both ends of a range, whole ns and um."""

from typing import Any

import pytest
from pydantic import ValidationError

from axisrig.bench.drive.cia402.dictionary.profiles import habits, make_profile
from axisrig.bench.rig.conventional.keys import DriveTable as ConventionalTable
from axisrig.bench.rig.encoder_terminal.keys import DriveTable as TerminalTable
from axisrig.bench.rig.habit_keys import number
from axisrig.bench.rig.lightbus.keys import DriveTable as LightbusTable
from axisrig.bench.rig.profidrive.keys import DriveTable as ProfidriveTable
from axisrig.bench.rig.sercos.keys import HABITS
from axisrig.bench.rig.sercos.keys import DriveTable as SercosTable


@pytest.mark.parametrize("read", [number, lambda text: SercosTable.value_of("resolution", text)])
@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("16", 16), ("-3", -3), ("0x10", 16), ("0X1f", 31), ("-0x10", -16), ("0b101", 5),
        ("0o17", 15), ("1.5", 1.5), ("1e3", 1000.0), ("true", True), ("False", False),
        ("word", "word"), ("", ""), ("0xG", "0xG"), ("1 2", "1 2"),
    ],
)  # fmt: skip
def test_a_cell_is_a_number_in_any_form_or_stays_a_text(read: Any, text: str, value: Any) -> None:
    found = read(text)
    assert (found, type(found)) == (value, type(value))


NUMBERS = [key for key in HABITS if habits()[key].low is not None]


TABLES = {
    "sercos": SercosTable, "profidrive": ProfidriveTable, "conventional": ConventionalTable,
    "encoder_terminal": TerminalTable, "lightbus": LightbusTable,
}  # fmt: skip


@pytest.mark.parametrize("name", TABLES)
@pytest.mark.parametrize("key", NUMBERS)
def test_a_key_takes_its_lowest_and_its_highest_value_and_nothing_beyond(
    name: str, key: str
) -> None:
    """As the table of habits has them."""
    family: Any = TABLES[name]
    if key not in family.model_fields:
        return
    habit = habits()[key]
    assert habit.low is not None
    assert habit.high is not None
    kind, step = (int, 1) if habit.type == "whole" else (float, 1e-3)
    for value in (kind(habit.low), kind(habit.high)):
        assert getattr(family.model_validate({"family": name, key: value}), key) == value
    for value in (kind(habit.low) - step, kind(habit.high) + step):
        with pytest.raises(ValidationError):
            family.model_validate({"family": name, key: value})


LENGTHS_AND_TIMES = [
    (key, habit.field)
    for key, habit in habits().items()
    if habit.type == "number" and habit.field.endswith(("_ns", "_um"))
]


@pytest.mark.parametrize(("key", "field"), LENGTHS_AND_TIMES)
def test_a_decimal_is_the_nearest_whole_ns_or_um(key: str, field: str) -> None:
    """0.57 us are 570 ns and 1.001 mm are 1001 um, whatever a binary fraction makes of them."""
    habit = habits()[key]
    low, high = habit.low or 0.0, habit.high or 0.0
    for whole in (1, 7, 29, 57, 570, 1001, 1009, 1143, 4350, 8190, 999_999):
        if low <= whole / 1000 <= high:
            assert getattr(make_profile({key: float(f"{whole}e-3")}), field) == whole
    for text, whole in (("0.0006", 1), ("1.0014", 1001), ("1.0016", 1002)):
        if low <= float(text) <= high:
            assert getattr(make_profile({key: float(text)}), field) == whole
