"""The tables of the language: which words and variables exist, and which of them act yet."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources


@dataclass(frozen=True)
class Word:
    """One row of `words.csv`.

    word: as written, without leading zeros or `#`. kind: G, M, address, command, function or sign.
    group: words of one group exclude each other in a block; empty for none. acts: whether the
    interpreter carries it out; a word that does not act is known to the manuals only.
    """

    word: str
    kind: str
    group: str
    acts: bool
    source: str
    meaning: str


@dataclass(frozen=True)
class VariableName:
    """One row of `variables.csv`; `<axis>` and `<name>` in the name stand for any.

    waits: what reading it waits for: nothing, `machine` (all before it is executed) or `cycle`
    (and the next cycle). written: whether a program can give it a value.
    """

    name: str
    acts: bool
    waits: str
    written: bool
    unit: str
    source: str
    meaning: str

    def matches(self, variable: str) -> bool:
        """Whether `variable` (upper case) is one of this row; the part in <> may be anything."""
        stem, open_end, _ = self.name.partition("<")
        if not open_end:
            return variable == stem
        rest = variable.removeprefix(stem)
        if rest == variable or not rest:
            return False
        return "." not in rest if self.name.endswith("<axis>") else True


def _rows(table: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(table).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


@cache
def words(kind: str) -> Mapping[str, Word]:
    """Give the words of one kind, keyed by the word."""
    return {
        row["word"]: Word(**{**row, "acts": row["acts"] == "yes"})  # type: ignore[arg-type]
        for row in _rows("words.csv")
        if row["kind"] == kind
    }


@cache
def variables() -> tuple[VariableName, ...]:
    """Give the variables in the order of the table."""
    return tuple(
        VariableName(
            **{**row, "acts": row["acts"] == "yes", "written": row["written"] == "yes"}  # type: ignore[arg-type]
        )
        for row in _rows("variables.csv")
    )
