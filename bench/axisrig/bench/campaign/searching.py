"""A row that searches the value at which it begins to fail: its probes one after the other."""

from collections.abc import Callable

from axisrig.bench.campaign.results.writer import CaseResult, no_values
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.expectation import met
from axisrig.bench.plan.probes import probe_of
from axisrig.bench.plan.searching import GOOD, bisect
from axisrig.bench.plan.verdict import Verdict, worst


def run_search(case: Case, run_probe: Callable[[Case], CaseResult]) -> CaseResult:
    """Search for the case; the result has its probes.

    run_probe: runs, or judges again, one probe. A probe that is aborted or in error ends the search
    with its verdict: it says nothing about the value.
    """
    assert case.search is not None
    steps = bisect(case.search)
    value = next(steps)
    probes: list[CaseResult] = []
    tried: dict[str, str] = {}
    while True:
        probe = run_probe(probe_of(case, len(probes) + 1, value))
        probes.append(probe)
        tried[value] = f"{probe.verdict.word} in {probe.case.run}"
        if probe.verdict >= Verdict.ABORTED:
            reason = f"the probe {probe.case.run} with {case.search.column} = {value}"
            reason += f": {probe.error or probe.verdict.word}"
            result = no_values(case, probe.verdict, reason)
            break
        try:
            value = steps.send(probe.verdict <= Verdict.MARGINAL)
        except StopIteration as end:
            found = end.value
            values = {name: found.good if name == GOOD else found.bad for name in _names(case)}
            checks = [
                judge(
                    check,
                    None if (text := values[check.name]) is None else float(text),
                    note=found.reason if text is None else tried[text],
                )
                for check in case.checks
            ]
            verdict, checks = met(case.expected, worst(item.verdict for item in checks), checks)
            result = CaseResult(case, verdict, checks)
            break
    result.probes = tuple(probes)
    return result


def _names(case: Case) -> list[str]:
    return [check.name for check in case.checks]
