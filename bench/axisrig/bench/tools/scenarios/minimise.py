"""The smallest scenario that shows a finding: fewer faults, shorter windows.

A finding stays when the result is the same and the same invariants do not hold; of an exception its
type, of a hang nothing else. What is tried is in a fixed order, so the same finding gives the same
scenario.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace

from axisrig.bench.rig.reading.faults import fault_kinds, read_time
from axisrig.bench.tools.scenarios.campaign import run_scenario
from axisrig.bench.tools.scenarios.oracle import Judgement, Result
from axisrig.bench.tools.scenarios.scenario import Scenario
from axisrig.kernel.time.clock import MS, US, TimeNs

Fault = tuple[str, str]
"""Kind and cell of one fault."""
Run = Callable[[Scenario], Judgement]
LONGEST_NS = 1024 * MS
"""A fault without an end gets a window of this length first."""


def minimised(
    scenario: Scenario, judgement: Judgement, run: Run = run_scenario
) -> tuple[Scenario, Judgement]:
    """Return the smallest scenario that still shows the finding, with its judgement."""
    best = scenario, judgement
    is_smaller = True
    while is_smaller:
        is_smaller = False
        for smaller in _smaller(best[0]):
            found = run(smaller)
            if is_same(judgement, found):
                best, is_smaller = (smaller, found), True
                break
    return best


def is_same(first: Judgement, second: Judgement) -> bool:
    """Whether two judgements show the same finding."""
    if (first.result, first.broken) != (second.result, second.broken):
        return False
    kinds = [each.note.partition(":")[0] for each in (first, second)]
    return first.result is not Result.EXCEPTION or kinds[0] == kinds[1]


def faults_of(scenario: Scenario) -> list[Fault]:
    """Return the faults of a scenario, each with its kind."""
    found: list[Fault] = []
    for text in scenario.faults:
        column, _, cell = text.partition("=")
        found += [(column.partition(":")[2], part.strip()) for part in cell.split(";")]
    return found


def _with(scenario: Scenario, faults: list[Fault]) -> Scenario:
    """Return a scenario with these faults in place of its own."""
    others = [text for text in scenario.assignments if not text.startswith("fault:")]
    kinds = dict.fromkeys(kind for kind, _ in faults)
    cells = [f"fault:{k}={'; '.join(cell for kind, cell in faults if kind == k)}" for k in kinds]
    return replace(scenario, assignments=(*others, *cells))


def _smaller(scenario: Scenario) -> Iterator[Scenario]:
    """Yield scenarios that are a step smaller: without a fault, or with half a window."""
    faults = faults_of(scenario)
    for place in range(len(faults)):
        yield _with(scenario, [*faults[:place], *faults[place + 1 :]])
    for place, (kind, cell) in enumerate(faults):
        shorter = _shorter(kind, cell)
        if shorter:
            yield _with(scenario, [*faults[:place], (kind, shorter), *faults[place + 1 :]])


def _shorter(kind: str, cell: str) -> str:
    """Return a fault with a window of half its length; empty where it has none to shorten."""
    if "for" not in fault_kinds()[kind].keys:
        return ""
    words = cell.split()
    window = next((word for word in words if word.startswith("for=")), "")
    if not window:
        return f"{cell} for={_time(LONGEST_NS)}"
    half_ns = read_time(window.removeprefix("for=")) // 2
    if half_ns < US:
        return ""
    return " ".join(f"for={_time(half_ns)}" if word == window else word for word in words)


def _time(time_ns: TimeNs) -> str:
    """Write a time in whole microseconds."""
    return f"{time_ns // US}us"
