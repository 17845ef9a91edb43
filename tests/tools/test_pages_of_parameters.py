"""What `axisrig params` writes of one parameter and of a topic."""

from dataclasses import replace

import pytest

from axisrig.bench.rig.parameter_words import every_parameter, warning
from axisrig.bench.tools.params.listing import explained, page, parameters_text
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import UNITS
from axisrig.kernel.parameters.table import TOPICS

ROWS = [*every_parameter()]

FACTS = ("type", "range", "limits", "default", "while unset", "warning", "older names", "acts",
         "list", "source")  # fmt: skip

# One parameter


def test_each_parameter_has_a_line_for_each_fact_and_none_for_what_it_lacks() -> None:
    for row in ROWS:
        lines = explained(row).splitlines()
        assert row.path in lines[0]
        facts_of = [line for line in lines if line[2:14].rstrip() in FACTS]
        assert all(line[14] == " " and line[15:].strip() for line in facts_of)
        there = [line[2:14].rstrip() for line in facts_of]
        assert there == [name for name in FACTS if name in there]
        assert ("older names" in there) is bool(row.old_paths)
        assert ("warning" in there) is bool(warning(row))
        assert ("while unset" in there) is bool(row.fallback)
        assert set(there) >= {"type", "default", "list", "source"}


def test_only_a_unit_that_is_another_one_of_a_rotary_axis_is_written_twice() -> None:
    kinds = set()
    for row in ROWS:
        unit = UNITS.get(row.unit)
        (line,) = (each for each in explained(row).splitlines() if each.startswith("  type  "))
        is_other = unit is not None and unit.rotary != unit.name
        assert ("(rotary axis: " in line) is is_other
        assert (" are 1 " in line) is (unit is not None and unit.divisor > 1)
        kinds.add((unit is not None, is_other))
    assert kinds == {(False, False), (True, False), (True, True)}


# Pages


@pytest.mark.parametrize("topic", list(TOPICS))
def test_a_page_has_the_topics_of_its_rows_alone(topic: str) -> None:
    rows = [row for row in ROWS if row.topic == topic]
    assert rows
    heads = [line for line in page(rows).splitlines() if line.startswith("## ")]
    assert heads == [f"## {TOPICS[topic]}", "## Units", "## Damaged names of the printed lists"]
    lines = page(rows).splitlines()
    for row in rows:
        assert sum(line.startswith(f"| `{row.path}`") for line in lines) == 1


def test_a_bar_in_a_cell_divides_no_column() -> None:
    row = replace(ROWS[0], meaning="one | or the other", source="a|b")
    (line,) = (each for each in page([row]).splitlines() if each.startswith(f"| `{row.path}`"))
    assert line.endswith("| one \\| or the other | a\\|b |")
    assert line.replace("\\|", "").count("|") == 8


@pytest.mark.parametrize("form", ["csv", "markdown"])
def test_a_table_of_one_word_is_a_table(form: str) -> None:
    """Only the text explains the one parameter that a number means."""
    text = parameters_text([ROWS[0].number], form)
    assert text != explained(ROWS[0])
    assert ROWS[0].path in text
    assert parameters_text([ROWS[0].number], "text") == explained(ROWS[0])


def test_words_that_fit_nothing_are_named_as_a_whole() -> None:
    with pytest.raises(UserError, match="no parameter fits") as caught:
        parameters_text(["nothing", "of", "that"], "text")
    assert caught.value.value == "nothing of that"
