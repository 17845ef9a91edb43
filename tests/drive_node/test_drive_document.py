"""docs/drive.md says what the tables of the drive say."""

import csv
import re
from pathlib import Path

from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.bench.drive.cia402.functions.states import OPTIONS
from axisrig.bench.drive.cia402.modes import MODES

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "drive.md").read_text("utf-8")


def rows(first_cell: str) -> list[list[str]]:
    """The rows of the table whose head begins with these cells."""
    lines = TEXT.splitlines()
    start = next(n for n, line in enumerate(lines) if line.startswith(f"| {first_cell} |"))
    found = []
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        found.append([cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]])
    return found


def test_transitions_are_those_of_the_table() -> None:
    answer = {
        (int(number), source, target) for number, source, target, _, _ in rows("number | from")
    }
    folder = ROOT / "kernel" / "axisrig" / "kernel" / "profiles" / "cia402"
    with (folder / "ds402_transitions.csv").open(encoding="utf-8") as file:
        ours = {
            (
                int(row["number"]),
                {"": "-", "*": "any"}.get(row["from"], row["from"].lower().replace("_", " ")),
                row["to"].lower().replace("_", " "),
            )
            for row in csv.DictReader(file)
        }
    assert answer == ours


def test_option_codes_are_those_of_the_table() -> None:
    answer = [tuple(row) for row in rows("object | code")]
    assert answer == [
        (f"{index:X}", str(code), *(e.name.lower().replace("_", " ") for e in option))
        for (index, code), option in OPTIONS.items()
    ]


def test_modes_are_those_of_the_drive() -> None:
    answer = {
        (int(number), control, monitored == "yes")
        for number, _, _, control, monitored in rows("6060")
    }
    ours = {(m.number, m.needs.name.lower(), m.follows_position) for m in MODES}
    assert answer == ours


def test_objects_that_are_said_to_be_missing_are_missing() -> None:
    missing = [int(index, 16) for row in rows("object | reason") for index in row[0].split(", ")]
    assert not {index for index, _ in variables()} & set(missing)
    named = {int(word, 16) for word in re.findall(r"\b(60[0-9A-F]{2})\b", TEXT)} - {0x60B8}
    assert named - set(missing) <= {index for index, _ in variables()}
