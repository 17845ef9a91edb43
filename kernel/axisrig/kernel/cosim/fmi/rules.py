"""Rules of the FMI standard that a model description breaks: `rules.csv`, by what fmpy says.

Source: FMI 2.0.4 section 2.2 and 3.0.2 section 2.4; the patterns are those of fmpy 0.3.32.
"""

import csv
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources

from fmpy.model_description import ModelDescription


@dataclass(frozen=True)
class Rule:
    """A row of `rules.csv`.

    name: for reports. runs: whether the bench can step an FMU that breaks it.
    """

    name: str
    pattern: re.Pattern[str]
    runs: bool
    meaning: str


OTHER = Rule("other", re.compile(""), True, "another rule")


@cache
def rules() -> tuple[Rule, ...]:
    """Return the rules in the order in which they are looked for."""
    text = resources.files(__package__).joinpath("rules.csv").read_text(encoding="utf-8")
    return tuple(
        Rule(row["rule"], re.compile(row["pattern"]), row["runs"] == "yes", row["meaning"])
        for row in csv.DictReader(text.splitlines())
    )


def rule_of(problem: str) -> Rule:
    """Return the rule that a problem, in the words of fmpy, is about."""
    return next((rule for rule in rules() if rule.pattern.search(problem)), OTHER)


def by_rule(problems: Iterable[str]) -> Mapping[Rule, list[str]]:
    """Return the problems of each rule, in the order in which they come."""
    found: dict[Rule, list[str]] = {}
    for problem in problems:
        found.setdefault(rule_of(problem), []).append(problem)
    return found


_PART = (
    r"(?:[A-Za-z_][A-Za-z0-9_]*"
    r"|'(?:[A-Za-z0-9_!#$%&()*+,\-./:;<>=?@\[\]^{}|~ ]|\\['\"?\\abfnrtv])+')"
    r"(?:\[[0-9]+(?:,[0-9]+)*\])?"
)
_PATH = rf"{_PART}(?:\.{_PART})*"
_STRUCTURED = re.compile(rf"{_PATH}|der\({_PATH}(?:,[0-9]+)?\)")
_FLAT = re.compile(r"[^\r\n\t]*")


def bad_names(description: ModelDescription) -> Iterator[str]:
    """Yield a problem for each name that is against the convention of the description.

    fmpy finds the same with a parser that takes a minute for 100 000 names.
    Source: FMI 2.0.4 section 2.2.9, FMI 3.0.2 section 2.4.7.5.1.
    """
    convention = str(description.variableNamingConvention or "flat")
    form = _STRUCTURED if convention == "structured" else _FLAT
    for variable in description.modelVariables:
        if not form.fullmatch(variable.name):
            yield (
                f'"{variable.name}" (line {variable.sourceline}) is not a legal variable name for'
                f' naming convention "{convention}".'
            )
