"""What counts as a line of code."""

import pytest
from tests.tools.code_lines import counts, lines_of

MODULE = '''"""What it is.

Two paragraphs.
"""

import os
from sys import (
    argv,
    path,
)

# a comment
LIMIT = 3  # with a comment behind
"""Of what."""


def last(
    values: list[int],
) -> int:
    """Return the last one."""

    return values[
        -1
    ]
'''


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("", 0),
        ("# a comment\n\n", 0),
        ('"""Words."""\n', 0),
        ("import os\nX = 1\n", 1),
        (MODULE, 7),
    ],
)
def test_docstrings_comments_blank_and_import_lines_are_none(text: str, count: int) -> None:
    assert lines_of(text) == count


@pytest.mark.long
def test_a_module_counts_once_with_the_first_name_that_finds_it() -> None:
    """`machine/ethercat/sercos_slave.py` has both names in its path."""
    one, other = counts(["sercos", "ethercat"]), counts(["ethercat", "sercos"])
    assert sum(one.values()) == sum(other.values())
    assert one["ethercat"] < other["ethercat"]
    assert counts(["no such name"]) == {"no such name": 0}
