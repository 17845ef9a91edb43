"""The rows of results that are over several runs of a case, and the runs without their checks."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import groupby

from axisrig.bench.plan.assignment import number
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import Check
from axisrig.bench.plan.statistic_checks import RUN, TOUCH, StatisticCheck
from axisrig.kernel.errors import UserError


def split_statistics(cases: Iterable[Case]) -> tuple[tuple[Case, ...], tuple[Case, ...]]:
    """Return the runs of a plan, and one case for each row of results that is over several runs.

    The statistics of a case with several runs leave the checks of these and become `sampled` there.
    Raises UserError, with the cell, for limits that are missing and columns that cannot serve.
    """
    runs: list[Case] = []
    statistics: list[Case] = []
    for _, group in groupby(cases, key=lambda case: (case.case, case.file, case.line)):
        members = list(group)
        if members[0].search is not None:
            runs += [_of_probes(case) for case in members]
            continue
        if any(isinstance(check, StatisticCheck) for case in members for check in case.checks):
            members, of_case = _split(members)
            statistics += of_case
        runs += members
    names = {case.run.casefold() for case in runs}
    for row in statistics:
        if row.run.casefold() in names:
            raise row.error("the row of its statistics has the id of a run", "case", value=row.run)
        names.add(row.run.casefold())
    return tuple(runs), tuple(statistics)


def _split(members: Sequence[Case]) -> tuple[list[Case], list[Case]]:
    members = [_with_own(case) for case in members]
    first = members[0]
    if any(_conditions(case) != _conditions(first) for case in members):
        column = next(c.metric for case in members for c in case.checks if _is_of_case(c))
        raise first.error(
            "the runs of a case have one condition for a statistic",
            f"check:{column}",
            hint="with `each` as its last argument it is of each run by itself",
        )
    for check in first.checks:
        if isinstance(check, StatisticCheck) and not check.is_each:
            _check_columns(members, check)
    found = {check.metric: _with_limits(first, check) for check in first.checks}
    if len(members) == 1:
        return [replace(first, checks=tuple(found.values()))], []
    sampled = tuple(
        check for check in found.values() if isinstance(check, StatisticCheck) and not check.is_each
    )
    asked = {check.metric for check in sampled}
    runs = [
        replace(
            case,
            checks=tuple(check for check in case.checks if check.metric not in asked),
            expected=tuple(name for name in case.expected if name not in asked),
            sampled=sampled,
        )
        for case in members
    ]
    if not sampled:
        return runs, []
    common = {
        column: value
        for column, value in first.inputs.items()
        if all(case.inputs.get(column) == value for case in members)
    }
    whole = replace(
        first,
        run=f"{first.plan}-{first.case}",
        inputs=common,
        checks=sampled,
        expected=tuple(name for name in first.expected if name in asked),
        repeat=0,
        runs=tuple(case.run for case in members),
    )
    return runs, [whole]


def _of_probes(case: Case) -> Case:
    """Give the statistics that each probe of a search has over its own values their limits."""
    assert case.search is not None
    probe = replace(case, checks=case.search.checks, search=None)
    (probe,), _ = _split([probe])
    return replace(case, search=replace(case.search, checks=probe.checks))


def _is_of_case(check: Check) -> bool:
    """Whether it is a statistic over all runs of a case."""
    return isinstance(check, StatisticCheck) and not check.is_each


def _with_own(case: Case) -> Case:
    """Check the statistics that a run has by itself, and give them their limits."""
    checks = []
    for check in case.checks:
        if isinstance(check, StatisticCheck) and check.is_each:
            _check_columns([case], check)
            check = _with_limits(case, check)  # noqa: PLW2901
        checks.append(check)
    return replace(case, checks=tuple(checks))


def _conditions(case: Case) -> list[tuple[str, str]]:
    return [(c.metric, c.condition.text) for c in case.checks if _is_of_case(c)]


def _with_limits(case: Case, check: Check) -> Check:
    """Give cp and cpk the limits that the row checks for the metric itself."""
    if not isinstance(check, StatisticCheck) or "[limits]" not in check.statistic.arguments:
        return check
    limits = check.limits
    if limits is None:
        metric = check.metric_check.metric
        conditions = [c.condition for c in case.checks if c.metric == metric]
        if not conditions or conditions[0].kind != "range":
            raise case.error(
                f"the row has no limits for {metric}",
                f"check:{check.metric}",
                hint=f"fill its cell in check:{metric}, or write"
                f" {check.statistic.name}({metric}; -0.5 .. 0.5)",
            )
        limits = (conditions[0].lower, conditions[0].upper)
    is_open = None in limits
    if (is_open and check.statistic.name == "cp") or limits[0] == limits[1]:
        raise case.error(
            f"{check.statistic.name} needs two different limits", f"check:{check.metric}"
        )
    return replace(check, limits=limits)


def _check_columns(members: Sequence[Case], check: StatisticCheck) -> None:
    """Refuse columns that the runs do not set, that are no numbers, or that have one value."""
    header = f"check:{check.metric}"
    for column in check.columns:
        if column == TOUCH:
            continue
        if column == RUN:
            values = {case.run for case in members}
        else:
            for case in members:
                if column not in case.inputs:
                    raise case.error("the run does not set the column", header, value=column)
                if "column" in check.statistic.arguments:
                    try:
                        number(column, case.inputs[column])
                    except UserError as error:
                        raise case.error(
                            "the statistic needs numbers", column, value=error.value
                        ) from None
            values = {case.inputs[column] for case in members}
        if len(values) < 2:
            raise members[0].error(
                f"all runs of the case have one value of {column}",
                header,
                hint="give the cell several values, as [300 | 600 | 1200]",
            )
