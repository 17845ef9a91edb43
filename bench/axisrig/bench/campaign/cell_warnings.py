"""Cells of a plan that can be run and are hardly meant: a default that no row uses, no unit."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from axisrig.bench.campaign.preparing import Prepared
from axisrig.bench.campaign.used_variables import is_variable, used_variables
from axisrig.bench.plan.assignment import Assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.table import Place
from axisrig.bench.rig.settings import Bare, Settings
from axisrig.kernel.errors import UserError, together


@dataclass(frozen=True)
class Looked:
    """What was seen of one cell of a row.

    place: None on the command line; a default is one cell of many rows. text: what is to be said,
    empty for a variable that is used. is_unused: that nothing uses it, unless another row does.
    """

    place: Place | None
    column: str
    text: str
    is_unused: bool


def look_at(case: Case, prepared: Prepared) -> list[Looked]:
    """Look at the inputs of a case that was read or prepared."""
    settings = prepared.settings
    found = [Looked(None, text, text, is_unused=False) for text in rig_warnings(settings)]
    used = None
    for item in case.assignments():
        place = None if item.column in case.overridden else case.places.get(item.column)
        if item.column in settings.bare:
            text = bare_warning(settings.bare, item)
            found.append(Looked(place, item.column, text, is_unused=False))
        if is_variable(item):
            used = used or used_variables(settings, case.program, prepared.program)
            is_used = used.has(item.column)
            text = "" if is_used else str(used.error(item, case.program))
            found.append(Looked(place, item.column, text, is_unused=not is_used))
    return found


class CellWarnings:
    """Collects what is to be said of the cells of plans, case by case.

    beside: cases of the same plans that nobody looks at, as they are not chosen or have run before.
    A default that is theirs too may be used by them.
    """

    def __init__(self, beside: Iterable[Case] = ()) -> None:
        self._used: set[tuple[Place | None, str]] = {
            (place, column) for case in beside for column, place in case.places.items()
        }
        self._said: dict[tuple[Place | None, str, bool], str] = {}

    def add(self, looked: Sequence[Looked]) -> None:
        """Take what was seen of a case."""
        for one in looked:
            if one.text:
                self._said.setdefault((one.place, one.column, one.is_unused), one.text)
            else:
                self._used.add((one.place, one.column))

    def look(self, case: Case, prepared: Prepared) -> None:
        """Look at the inputs of a case."""
        self.add(look_at(case, prepared))

    def lines(self) -> list[str]:
        """Return the warnings, those of one cell once.

        Raises UserError for a `--set` that no row uses.
        """
        return list(self._lines())

    def _lines(self) -> Iterator[str]:
        for (place, column, is_unused), text in self._said.items():
            if is_unused and (place, column) in self._used:
                continue
            if is_unused and place is None:
                raise UserError(f"--set {text}")
            where = "" if place is None else f"{place.at}: "
            yield where + text


def refuse_warnings(warnings: Sequence[str]) -> None:
    """Raise UserError with all warnings (`--strict`)."""
    if warnings:
        raise together([UserError(text) for text in warnings])


def rig_warnings(settings: Settings) -> list[str]:
    """Say of which start values of a rig the unit is not named although there are several."""
    return [
        f"{settings.files[0]}: start value {column.partition(':')[2]} names no unit and counts in"
        f" {unit}; with a unit: {' or '.join(name.rpartition('.')[2] for name in columns)}"
        for column, (unit, columns) in settings.bare_in_rig.items()
    ]


def bare_warning(bare: Bare, item: Assignment) -> str:
    """Say in which unit a value counts whose column names none."""
    unit, columns = bare[item.column]
    named = " or ".join(columns)
    return f"{item.column} names no unit, so {item.value} counts in {unit}; with a unit: {named}"
