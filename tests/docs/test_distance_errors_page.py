"""The page about errors of distance control has every ID, and names cases that there are."""

import csv
import re
from pathlib import Path

from axisrig.kernel.errors import catalogue

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "distance-errors.md").read_text("utf-8")
SECTIONS = dict(part.split("\n", 1) for part in PAGE.split("\n## ")[1:])
BELONGING = {i: entry for i, entry in catalogue().items() if entry.area == "distance control"}


def ids_of(text: str) -> list[int]:
    return [int(i) for i in re.findall(r"(?<![-\w])(\d{5,6})\b", text)]


def rows(section: str) -> list[list[str]]:
    found = [line.strip("| ").split(" | ") for line in section.splitlines() if line[:1] == "|"]
    return [row for row in found if row[0][:1].isdigit()]


def test_every_id_stands_in_one_of_the_tables() -> None:
    provoked = {i for row in rows(SECTIONS["Provoked"]) for i in ids_of(" ".join(row[:2]))}
    others = {i for row in rows(SECTIONS["Not provoked"]) for i in ids_of(row[0])}
    assert not provoked & others
    assert provoked | others == BELONGING.keys()
    assert provoked == {i for i, entry in BELONGING.items() if entry.is_raised}


def test_newer_twins_and_classes_are_those_of_the_catalogue() -> None:
    for number, newer, reaction_class, *_ in (r for r in rows(SECTIONS["Provoked"]) if len(r) == 5):
        entry = BELONGING[int(number)]
        assert newer == str(entry.newer_id or "-"), number
        assert reaction_class == str(entry.reaction_class), number


def test_cases_exist_and_check_the_id_that_they_are_named_for() -> None:
    with (ROOT / "testplans" / "distance_errors.csv").open(encoding="utf-8", newline="") as file:
        plan = {row["case"]: row["check:alarms"] for row in csv.DictReader(file)}
    named = re.findall(r"`(id-[\w-]+)`", PAGE)
    assert sorted(named) == sorted(plan)
    for case, condition in plan.items():
        assert condition == f"== {case.split('-')[1]}"
