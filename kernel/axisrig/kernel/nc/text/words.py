"""The tables of the language: words, variables, commands, errata; and which of them act."""

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib import resources


@dataclass(frozen=True)
class Word:
    """One row of `words.csv`.

    word: as written, without leading zeros. kind: G, M, address, function, control or sign.
    group: words of one group exclude each other in a block, empty for none; for a function the
    number of its operands, `2-9` for two to nine. acts: whether the kernel carries it out.
    """

    word: str
    kind: str
    group: str
    acts: bool
    source: str
    meaning: str


@dataclass(frozen=True)
class VariableName:
    """One row of `variables.csv`.

    name: `<axis>` means an axis of the rig, `<name>` for any name, `[]` for an index.
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

    def match(self, variable: str) -> tuple[bool, str | None]:
        """Return whether a name (upper case) is one of this row, and the axis that it names."""
        found = _pattern(self.name).fullmatch(variable)
        if found is None:
            return False, None
        return True, found.groupdict().get("axis")


@cache
def _pattern(name: str) -> re.Pattern[str]:
    text = re.escape(name.upper())
    text = text.replace("<AXIS>", r"(?P<axis>[^.\[\]]+)").replace("<NAME>", r"[^\[\]].*")
    return re.compile(text)


@dataclass(frozen=True)
class Keyword:
    """One row of `commands.csv`: a keyword, or the command itself where `keyword` is empty.

    kind: what follows the keyword: expression, name (one of `allowed` if there are any),
    ident (a name spelled as in its list), axis, variable, text, list, or flag for nothing. In the
    row of the command: the same for its values without keyword, none for no values; `group` if
    each bracket is a group of its own. required: yes, no, or a name that several keywords share
    of which one must be there. allowed: names; a range `0..1` of a constant; the least and most
    number of values `1-6` in the row of the command.
    """

    command: str
    keyword: str
    kind: str
    required: str
    allowed: str
    acts: bool
    source: str
    meaning: str


def rows(table: str) -> list[dict[str, str]]:
    """Read one of the tables beside this module."""
    text = resources.files(__package__).joinpath(table).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


@cache
def words(kind: str) -> Mapping[str, Word]:
    """Give the words of one kind, keyed by the word."""
    return {
        row["word"]: Word(**{**row, "acts": row["acts"] == "yes"})  # type: ignore[arg-type]
        for row in rows("words.csv")
        if row["kind"] == kind
    }


@cache
def variables() -> tuple[VariableName, ...]:
    """Give the variables in the order of the table."""
    return tuple(
        VariableName(
            **{**row, "acts": row["acts"] == "yes", "written": row["written"] == "yes"}  # type: ignore[arg-type]
        )
        for row in rows("variables.csv")
    )


@cache
def commands() -> Mapping[str, Mapping[str, Keyword]]:
    """Give every command with its keywords; the empty keyword is the command itself."""
    found: dict[str, dict[str, Keyword]] = {}
    for row in rows("commands.csv"):
        entry = Keyword(**{**row, "acts": row["acts"] == "yes"})  # type: ignore[arg-type]
        found.setdefault(entry.command, {})[entry.keyword] = entry
    return found


def forms() -> tuple[tuple[str, str], ...]:
    """Give the forms of blocks and words: how they are written, what they mean."""
    return tuple((row["form"], row["meaning"]) for row in rows("forms.csv"))


@cache
def examples() -> Mapping[str, tuple[str, str]]:
    """Give for a word, `$` and `#` words as written: lines of a program, and the page about it."""
    found = {}
    for row in rows("examples.csv"):
        for name in row["words"].split("|"):
            found[name] = (row["example"].replace("\\n", "\n"), row["page"])
    return found


def not_acting() -> tuple[str, ...]:
    """Give every word that is read and ends with alarm 900100 when the machine gets there."""
    kinds = ("G", "M", "address", "function", "control", "sign")
    found = [w.word for kind in kinds for w in words(kind).values() if not w.acts]
    for name, table in commands().items():
        shown = name if name.startswith(("<", "L ")) else f"#{name}"
        if not table[""].acts:
            found.append(shown)
        else:
            found += [f"{shown} [{word}]" for word, row in table.items() if word and not row.acts]
    return (*found, *(row.name for row in variables() if not row.acts))


@lru_cache(maxsize=4096)
def find_variable(name: str) -> tuple[VariableName | None, str | None]:
    """Give the row of a variable (upper case) and the axis it names; the exact row wins."""
    best: tuple[VariableName | None, str | None] = (None, None)
    for row in variables():
        fits, axis = row.match(name)
        if fits and "<name>" not in row.name:
            return row, axis
        if fits and best[0] is None:
            best = row, axis
    return best


@cache
def spelled_variables(axes: tuple[str, ...]) -> tuple[str, ...]:
    """Give the names of all variables as a program with these axes spells them."""
    names = [row.name for row in variables()]
    return tuple(
        dict.fromkeys(name.replace("<axis>", axis) for name in names for axis in (axes or ("X",)))
    )
