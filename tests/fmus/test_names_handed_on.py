"""A value keeps its name on its way through the library, so that none is taken for its neighbour.

A model that hands `a = b` to a part, both being its own names, or shows `a = part.b` where the part
has an `a` too, has most likely mixed up two of a kind: force and stop force, rising and falling.
Names that say more are the same ones: `mass = effective_mass`, `stop_force = stop.force`; the
output of a block is `y`. And a part `stop_2` is given what ends in `_2`, where both are there.
"""

import re
from functools import cache
from pathlib import Path

import pytest

from axisrig.fmus.build import LIBRARY

FILES = sorted(path for path in LIBRARY.rglob("*.mo") if path.stem != "package")
OTHERS = {
    ("TiltedSensor", "corner = bandwidth"): "`corner` of the model is a place in a list",
    ("TiltingSlide", "mass = effective_mass_z"): "the slide bears more than its own mass",
}
"""What has another name on purpose."""
NAME = r"(?<![\w.])[a-z]\w*(?![\w.])"


@cache
def code(file: Path) -> str:
    """A class without comments and texts."""
    text = re.sub(r'"(?:[^"\\]|\\.)*"', '""', file.read_text(encoding="utf-8"))
    return re.sub(r"//.*", "", text)


@cache
def members(name: str) -> frozenset[str]:
    """The variables and parts of a class, inherited ones included."""
    found: set[str] = set()
    for file in FILES:
        if file.stem == name:
            text = code(file)
            found |= set(re.findall(r"[A-Z]\w+(?:\[[^]]*\])?\s+([a-z]\w*)", text))
            for base in re.findall(r"extends\s+(?:\w+\.)*(\w+)", text):
                found |= members(base) if base != name else set()
    return frozenset(found)


def renamed(file: Path) -> list[str]:
    """Where a class gives a name of its own, or of a part, to what has another name."""
    text, own = code(file), members(file.stem)
    found = [
        f"{name} = {value}"
        for name, value in re.findall(rf"(?<=[(,])\s*({NAME})\s*=\s*({NAME})\s*(?=[,)])", text)
        if not value.endswith(name) and {name, value} <= own
    ]
    parts = {part: kind for kind, part in re.findall(r"([A-Z]\w+)\s+([a-z]\w*)\s*[(;\"]", text)}
    for name, part, value in re.findall(rf"({NAME})\s*=\s*([a-z]\w*)\.(\w+)\s*;", text):
        is_same = value.endswith(name) or value == "y" or name == f"{part}_{value}"
        if not is_same and name in members(parts.get(part, "")):
            found.append(f"{name} = {part}.{value}")
    return found


@pytest.mark.parametrize("file", FILES, ids=lambda path: f"{path.parent.name}.{path.stem}")
def test_a_value_keeps_its_name_where_both_have_one_of_it(file: Path) -> None:
    assert [text for text in renamed(file) if (file.stem, text) not in OTHERS] == []


def test_what_has_another_name_on_purpose_is_there() -> None:
    found = {(file.stem, text) for file in FILES for text in renamed(file)}
    assert found == set(OTHERS)


def crossed(text: str, own: frozenset[str]) -> list[str]:
    """Where one of a pair of parts has to do with a variable of the other one.

    text: of a class; own: its variables.
    """
    found = []

    def look(part: str, value: str) -> None:
        base, _, suffix = value.rpartition("_")
        wanted = part.rpartition("_")[2]
        if len(suffix) == len(wanted) == 1 and suffix != wanted and f"{base}_{wanted}" in own:
            found.append(f"{part}: {value}")

    for part, given in re.findall(r"[A-Z]\w+\s+([a-z]\w*_\w+)\(((?:[^()]|\([^()]*\))*)\)", text):
        for value in re.findall(NAME, given):
            look(part, value)
    for name, part in re.findall(rf"({NAME})\s*=\s*([a-z]\w*_\w+)\.\w+\s*;", text):
        look(part, name)
    for part, value in re.findall(rf"([a-z]\w*_\w+)\.\w+\s*=\s*({NAME})\s*;", text):
        look(part, value)
    return found


@pytest.mark.parametrize("file", FILES, ids=lambda path: f"{path.parent.name}.{path.stem}")
def test_each_of_two_parts_has_to_do_with_its_own_variables(file: Path) -> None:
    assert crossed(code(file), members(file.stem)) == []


@pytest.mark.parametrize(
    ("right", "found"),
    [("stop_1(speed = speed_1)", "stop_1: speed_2"), ("force_1 = stop_1.force;", "stop_1: force_2"),
     ("stop_1.place = place_1;", "stop_1: place_2")],
)  # fmt: skip
def test_a_variable_of_the_other_part_is_found(right: str, found: str) -> None:
    """Given to a part, taken from it, and in an equation of it."""
    own = frozenset(f"{name}_{n}" for name in ("speed", "force", "place") for n in "12")
    name = found.removeprefix("stop_1: ")
    wrong = right.replace(f"{name[:-1]}1", name)
    prefix = "Stop " if "(" in right else ""
    assert crossed(prefix + right, own) == []
    assert crossed(prefix + wrong, own) == [found]
