"""Words that the kernel's maker publishes and nobody carries out here: `published.csv`.

A program that holds one is read, and ends with alarm 900100 where the machine gets there. A word
with a reason in `passed_over` may be passed over where the rig says so (`[language] pass_over`).
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from axisrig.kernel.nc.text.words import commands, rows

_WORDS = re.compile(r"#[ \t]*([A-Za-z_][A-Za-z0-9_]*(?:[ \t]+[A-Za-z0-9_]+)*)")


@dataclass(frozen=True)
class Published:
    """One row of `published.csv`.

    word: as a program has it, `G25` or `#CACHE LOAD`. passed_over: why it may be passed over,
    empty where it may not: it would change where, when or how fast the axes move.
    """

    word: str
    passed_over: str
    source: str
    meaning: str


@cache
def published() -> Mapping[str, Published]:
    """Give the words by their spelling, in the order of the table."""
    found = {}
    for row in rows("published.csv"):
        word = f"#{row['word']}" if row["kind"] == "#" else row["word"]
        found[word] = Published(word, row["passed_over"], row["source"], row["meaning"])
    return found


@cache
def published_g() -> Mapping[str, Published]:
    """Give those that are G functions."""
    return {word: row for word, row in published().items() if word[0] == "G"}


def published_command(code: str, begin: int, end: int) -> tuple[Published, int] | None:
    """Find the published # command that a block is, and where its `#` is.

    The longest name counts, so that `#CS ADD DEL` is not `#CS ADD`. None where a command of
    `commands.csv` is meant, or none.
    """
    at = code.find("#", begin, end)
    match = _WORDS.match(code, at, end) if at >= 0 else None
    if match is None:
        return None
    words = match[1].upper().split()
    for count in range(len(words), 0, -1):
        name = " ".join(words[:count])
        if name in commands():
            return None
        if (row := published().get(f"#{name}")) is not None:
            return row, at
    return None
