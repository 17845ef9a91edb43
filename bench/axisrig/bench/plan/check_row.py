"""A check of a run with what it found, as `results.csv` has it: read here, and nowhere else."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation

from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import CheckResult, value_text
from axisrig.bench.plan.expectation import EXPECTED, NOT_MET
from axisrig.bench.plan.verdict import Verdict


@dataclass(frozen=True)
class CheckRow:
    """One row. asked: the condition (column `check`). verdict: its word. note: why there is no
    value, or what the uncertainty is made of.

    All but the metric may be empty, as results of other tools have it. Numbers are as written.
    """

    metric: str
    asked: str = ""
    value: str = ""
    unit: str = ""
    lower: str = ""
    upper: str = ""
    uncertainty: str = ""
    verdict: str = ""
    note: str = ""
    reference: str = ""
    run: str = ""

    @classmethod
    def read(cls, cells: Mapping[str, str]) -> "CheckRow":
        """Read a row by the names of its columns; one that is missing is empty."""
        texts = {name: (cells.get(name) or "").strip() for name in cls.__match_args__}
        return cls(**{**texts, "asked": (cells.get("check") or "").strip()})

    @classmethod
    def of(cls, result: CheckResult) -> "CheckRow":
        """Return a check that has just been judged as it will be stored."""
        check, condition = result.check, result.check.condition
        return cls(
            check.metric,
            condition.text,
            value_text(result.value),
            check.unit,
            value_text(condition.lower),
            value_text(condition.upper),
            repr(float(result.uncertainty)),
            result.verdict.word,
            result.note,
            check.reference,
        )

    @property
    def cells(self) -> dict[str, str]:
        """The cells by the names of their columns, without the run."""
        texts = {name: getattr(self, name) for name in self.__match_args__}
        return {{"asked": "check"}.get(n, n): text for n, text in texts.items() if n != "run"}

    @property
    def outcome(self) -> Verdict:
        """The verdict. Raises KeyError for a word that is none."""
        return Verdict.of(self.verdict)

    @property
    def number(self) -> float | None:
        """The value where it is a finite number."""
        return finite(self.value)

    @property
    def limits(self) -> tuple[float | None, float | None]:
        """The lower and the upper limit, None without one."""
        return finite(self.lower), finite(self.upper)

    @property
    def has_missed(self) -> bool:
        """Whether it had to fail and did not."""
        return self.note.startswith(NOT_MET)

    @property
    def had_to_fail(self) -> bool:
        """Whether it had to fail, as it did or not."""
        return self.note.startswith(EXPECTED)


def stored_cells(case: Case, result: CheckResult) -> dict[str, str]:
    """Return the row of a check that has just been judged, with the run that it is of."""
    run = {"plan": case.plan, "case": case.case, "run": case.run}
    return run | CheckRow.of(result).cells


def finite(text: str) -> float | None:
    """Return the finite number that a text is, None for any other."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def known(text: str) -> float | None:
    """Return the number that a text is, infinite ones too; None for any other, or NaN."""
    try:
        value = float(text)
    except ValueError:
        return None
    return None if math.isnan(value) else value


def decimal(text: str) -> Decimal | None:
    """Return a finite number as written, so that differences are those that a reader reckons."""
    if not re.match(r"[+-]?[\d.]", text):
        return None
    try:
        number = Decimal(text)
    except InvalidOperation:
        return None
    return number if number.is_finite() and math.isfinite(float(number)) else None
