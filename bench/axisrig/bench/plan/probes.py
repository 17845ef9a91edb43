"""The probes of a case that searches, and what the case itself keeps."""

from collections.abc import Collection
from dataclasses import replace

from axisrig.bench.plan.assignment import parse_column
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.composition import Mistakes
from axisrig.bench.plan.searching import BAD, GOOD, HEAD, PROBES_MAX, Search, check_of_search


def with_search(case: Case, search: Search) -> Case:
    """Make the case of a row that searches of one with all checks of the row.

    The row itself keeps the checks of `search_good` and `search_bad`; of one that it does not have,
    it asks for a value in the range.
    """
    reference = case.checks[0].reference
    own = {check.name: check for check in case.checks if check.name in (GOOD, BAD)}
    low, high = sorted((search.first, search.last))
    text = f"{search.value(low)} .. {search.value(high)}"
    unit = parse_column(search.column, "0").unit
    checks = [own.get(name) or check_of_search(name, text, reference) for name in (GOOD, BAD)]
    checks = [replace(check, defined=replace(check.definition, unit=unit)) for check in checks]
    probed = tuple(check for check in case.checks if check.name not in (GOOD, BAD))
    return replace(case, checks=tuple(checks), search=replace(search, checks=probed))


def refuse_ids_of_probes(cases: Collection[Case], mistakes: Mistakes) -> None:
    """Keep a mistake for each case that has the id of a probe."""
    searching = [case.run.casefold() for case in cases if case.search is not None]
    taken = {probe_id(run, n + 1) for run in searching for n in range(PROBES_MAX)}
    for case in cases:
        if case.run.casefold() in taken:
            mistakes.add(case.error("a probe has this id", "case", value=case.run))


def probe_id(run: str, number: int) -> str:
    """Return the id of a probe. number: from 1."""
    return f"{run}-s{number:02}"


def probe_of(case: Case, number: int, value: str) -> Case:
    """Return the run that tries a value; its seed is that of the row."""
    search = case.search
    assert search is not None
    return replace(
        case,
        run=probe_id(case.run, number),
        inputs={**case.inputs, search.column: value},
        places={**case.places, search.column: case.places[HEAD + search.column]},
        checks=search.checks,
        expected=(),
        search=None,
        probe_of=case.run,
    )
