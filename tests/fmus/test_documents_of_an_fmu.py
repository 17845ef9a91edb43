"""What an FMU says to people and tools beside its description: pages, licence, icon, terminals."""

import csv
import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from functools import cache
from typing import Any

import pytest
from tests.fmus.test_variables_of_models import shown
from tests.fmus.test_words_of_models import texts

from axisrig.fmus.reading.target import TARGET
from axisrig.fmus.writing import archive
from axisrig.fmus.writing.archive import TERMINALS_FILE, other_files
from axisrig.fmus.writing.description import templates
from axisrig.fmus.writing.variables import Variable

PART = """package Lib
  model Base "what all have"
    annotation(Documentation(info = "<html><p>All of <b>them</b>.</p></html>"));
  end Base;
  model Part "a <part>"
    extends Base;
    annotation(Documentation(info = "<html><p>This one.</p></html>"));
  end Part;
  model Silent end Silent;
end Lib;
"""
HEAD = {"description": "a <part>", "version": "1.2"}
OWN = HEAD | {"author": "axisrig", "copyright": "Copyright the authors", "license": "Apache-2.0"}
ROWS = list(csv.DictReader(TERMINALS_FILE.read_text(encoding="utf-8").splitlines()))
TERMINALS = list(dict.fromkeys(row["terminal"] for row in ROWS))
SUFFIXES = ("", "_1", "_2", "_z", "_a")


KEPT = cache(templates)


@pytest.fixture(autouse=True)
def quickly(monkeypatch: pytest.MonkeyPatch) -> None:
    """To draw an icon and to read a template take longer than all else."""
    monkeypatch.setattr(archive, "draw", lambda _, model: f"icon of {model}".encode())
    monkeypatch.setattr(archive, "templates", KEPT)


def documents(*variables: Variable, head: Any = HEAD, fmi: str = "3.0") -> dict[str, bytes]:
    found, _ = texts(PART)
    return other_files("Lib.Part", found, variables, head, fmi)


def text_of(*variables: Variable, head: Any = HEAD) -> str:
    return documents(*variables, head=head)["documentation/index.html"].decode()


# Files


def test_fmi_2_has_the_icon_at_its_top_and_fmi_3_beside_the_terminals() -> None:
    """FMI 2.0.4, section 2.3: model.png; FMI 3.0.2, section 2.5.1: terminalsAndIcons."""
    both = {"documentation/index.html", "documentation/licenses/license.txt",
            "documentation/licenses/Apache-2.0.txt"}  # fmt: skip
    second, third = documents(fmi="2.0"), documents()
    assert set(second) == {*both, "model.png"}
    own = {"terminalsAndIcons/icon.png", "terminalsAndIcons/terminalsAndIcons.xml"}
    assert set(third) == {*both, *own}
    assert second["model.png"] == third["terminalsAndIcons/icon.png"] == b"icon of Lib.Part"
    assert all(second[name] == third[name] for name in both)
    licence = third["documentation/licenses/Apache-2.0.txt"]
    assert licence == (TARGET / "Apache-2.0.txt").read_bytes()
    assert b"Apache License" in licence


def test_the_licence_of_a_model_is_that_of_its_author() -> None:
    """The runtime is axisrig's in both."""
    name = "documentation/licenses/license.txt"
    own, other = (documents(head=head)[name].decode() for head in (OWN, HEAD))
    assert "its documentation: Copyright the authors." in own
    assert "its licence is its author's to say" not in own
    assert "its licence is its author's to say" in other
    assert "its documentation:" not in other
    stranger = documents(head=HEAD | {"author": "somebody"})[name].decode()
    assert "its licence is its author's to say" in stranger
    for text in (own, other):
        assert "The files runtime.h and *.inc of the folder sources" in text
        assert "BSD-2-Clause" in text


# The page


def test_a_page_has_the_words_of_the_model_and_of_its_base_classes() -> None:
    page = text_of()
    assert "<title>Lib.Part</title>" in page
    assert "<p>a &lt;part&gt;</p>" in page
    heads = re.findall(r"<h2>(.*)</h2>", page)
    assert heads == ["Lib.Part", "Lib.Base"]
    titles = re.findall(r"<p><em>(.*)</em></p>", page)
    assert titles == ["a &lt;part&gt;", "what all have"]
    # The documentation is HTML already
    assert page.index("<p>This one.</p>") < page.index("<p>All of <b>them</b>.</p>")


@pytest.mark.parametrize("name", ["version", "license"])
def test_a_page_says_of_version_and_licence_what_there_is(name: str) -> None:
    words = {"version": "Version 1.2", "license": "licence Apache-2.0 ("}
    assert words[name] in text_of(head=OWN)
    without = {key: value for key, value in OWN.items() if key != name}
    assert words[name] not in text_of(head=without)


CAUSALITIES = {
    "input": "Inputs", "output": "Outputs", "parameter": "Parameters",
    "calculatedParameter": "Parameters that follow from others",
}  # fmt: skip


@pytest.mark.parametrize("causality", [*CAUSALITIES, "local"])
def test_a_variable_is_in_the_table_of_its_causality_alone(causality: str) -> None:
    """Locals are in none; a table without rows is left out."""
    page = text_of(shown(name="the.name", causality=causality))
    tables = [head for head in re.findall(r"<h2>(.*)</h2>", page) if not head.startswith("Lib")]
    title = CAUSALITIES.get(causality)
    assert tables == ([] if title is None else [title])
    assert page.count("<td>the.name</td>") == len(tables)


def test_tables_and_their_rows_are_in_order_with_all_that_is_known() -> None:
    made = [
        shown(name=f"{causality}{number}", causality=causality)
        for number in (2, 1)
        for causality in ("calculatedParameter", "output", "parameter", "input")
    ]
    page = text_of(*made)
    names = re.findall(r"<td>(\w+\d)</td>", page)
    assert names == [f"{causality}{number}" for causality in CAUSALITIES for number in (2, 1)]
    one = shown(name="x", unit="mm", start=(0.5, 2.0), minimum=0.0, maximum=9.5,
                description="of < all")  # fmt: skip
    cells = ["x", "mm", "0.5 2", "0 .. 9.5", "of &lt; all"]
    assert "".join(f"<td>{cell}</td>" for cell in cells) in text_of(one)
    assert "<td>x</td><td></td><td></td><td></td><td></td>" in text_of(shown(name="x"))


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.123456789012345, "0.123456789012345"), (125.123456, "125.123456"), (1e-9, "1e-09"),
     (0.1 + 0.2, "0.3"), (-2500000.25, "-2500000.25")],
)  # fmt: skip
def test_numbers_of_a_page_have_fifteen_digits(value: float, text: str) -> None:
    """As many as a double has for sure: what is read there can be set again."""
    one = shown(name="x", start=(value,), minimum=value, maximum=value)
    assert f"<td>{text}</td><td>{text} .. {text}</td>" in text_of(one)
    assert f"<td></td><td>{text} .. </td>" in text_of(shown(name="x", minimum=value))
    assert f"<td></td><td> .. {text}</td>" in text_of(shown(name="x", maximum=value))


def test_words_of_a_page_are_those_of_the_type() -> None:
    """The first literal of an enumeration has the number 1; it has no range of numbers."""
    kinds = {"type": "Enumeration", "enumeration": "Lib.E", "literals": ("off", "on", "auto"),
             "minimum": 1.0, "maximum": 3.0}  # fmt: skip
    for start, text in (((1.0,), "off"), ((2.0,), "on"), ((3.0, 1.0), "auto off")):
        assert f"<td>{text}</td><td></td>" in text_of(shown(name="x", start=start, **kinds))
    for start, text in (((1.0,), "true"), ((0.0,), "false"), ((0.0, 1.0), "false true")):
        assert f"<td>{text}</td><td></td>" in text_of(shown(name="x", type="Boolean", start=start))


# Terminals


def members_of(terminal: str) -> list[dict[str, str]]:
    return [row for row in ROWS if row["terminal"] == terminal]


def made_for(terminal: str, suffix: str, causalities: Sequence[str]) -> list[Variable]:
    """The variables of a terminal, of these causalities by turns."""
    return [
        shown(name=row["variable"] + suffix, causality=causalities[n % len(causalities)])
        for n, row in enumerate(members_of(terminal))
    ]


def terminals(*variables: Variable) -> list[tuple[str, str, str, list[tuple[str, str]]]]:
    """Name, rule, description and members of each, a member with its variable."""
    data = documents(*variables)["terminalsAndIcons/terminalsAndIcons.xml"]
    root = ET.fromstring(data)
    assert root.get("fmiVersion") == "3.0"
    found = root.findall("Terminals/Terminal")
    assert (root.find("Terminals") is not None) is bool(found)
    for member in root.iter("TerminalMemberVariable"):
        assert member.get("variableKind") == "signal"
    return [
        (one.attrib["name"], one.attrib["matchingRule"], one.attrib["description"],
         [(each.attrib["memberName"], each.attrib["variableName"]) for each in one])
        for one in found
    ]  # fmt: skip


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("terminal", TERMINALS)
def test_a_terminal_is_there_where_all_its_variables_are(terminal: str, suffix: str) -> None:
    """Under the name of the table, with the suffix of a model with two of a kind."""
    rows = members_of(terminal)
    members = [(row["member"], row["variable"] + suffix) for row in rows]
    alike = [] if suffix else [["input"], ["output"]]
    for causalities in (*alike, ["output", "input"]):
        made = made_for(terminal, suffix, causalities)
        found = {one[0]: one for one in terminals(*made)}
        expected = (terminal + suffix, rows[0]["rule"], rows[0]["description"], members)
        assert found == {terminal + suffix: expected}


@pytest.mark.parametrize("terminal", TERMINALS)
def test_a_terminal_that_lacks_a_variable_is_none(terminal: str) -> None:
    """Or has one that is neither input nor output, or of another suffix."""
    made = made_for(terminal, "", ["input"])
    for number in range(len(made)):
        assert terminals(*made[:number], *made[number + 1 :]) == []
    *rest, last = made
    for name, causality in (
        (last.name, "local"), (last.name, "parameter"), (f"{last.name}_1", "input"),
    ):  # fmt: skip
        assert terminals(*rest, shown(name=name, causality=causality)) == []


def test_terminals_are_in_the_order_of_the_table_each_with_its_suffixes() -> None:
    made = [
        one
        for suffix in ("_2", "_1")
        for terminal in reversed(TERMINALS)
        for one in made_for(terminal, suffix, ["input"])
    ]
    names = [name for name, *_ in terminals(*made)]
    assert names == [f"{terminal}{suffix}" for terminal in TERMINALS for suffix in ("_1", "_2")]


@pytest.mark.parametrize("terminal", TERMINALS)
def test_rows_of_a_terminal_have_one_rule_and_different_members(terminal: str) -> None:
    """FMI 3.0.2, section 2.4.9: rules are plug, bus and sequence; a member name is there once."""
    rows = members_of(terminal)
    assert {row["rule"] for row in rows} <= {"plug", "bus", "sequence"}
    assert len({row["rule"] for row in rows}) == 1
    assert rows[0]["description"]
    for name in ("member", "variable"):
        assert len({row[name] for row in rows}) == len(rows)
