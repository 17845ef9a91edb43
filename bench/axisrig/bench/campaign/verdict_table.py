"""The verdicts and causes of runs, as the command line prints them at the end."""

import sys
from collections import Counter
from collections.abc import Hashable, Iterable, Sequence

from rich.console import Console
from rich.table import Table as RichTable

from axisrig.bench.campaign.progress import duration
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.talk import Talk
from axisrig.bench.plan.checks import CheckResult
from axisrig.bench.plan.expectation import NOT_MET
from axisrig.bench.plan.sentences import result_sentence
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.bus import BusFigures

_COLUMNS = ("verdict", "case", "checks", "what did not pass", "alarms")
_TEXT_MIN = 32
"""Signs that there are at least for what did not pass, beside ids that never break."""


def show_verdicts(results: Sequence[CaseResult], talk: Talk = Talk.SHORT) -> None:
    """Print the verdict table and the causes below it.

    Of more than FEW results only what did not pass is in it, and runs of one case that did not
    pass in the same way are one row, that of the worst one. talk: each one of any number, or none.
    """
    if talk is Talk.NONE:
        return
    groups = [[result] for result in results]
    if talk.of(len(results)) is Talk.SHORT:
        groups = _grouped(result for result in results if result.verdict > Verdict.MARGINAL)
    shown = [(_worst(group), len(group)) for group in groups]
    if shown:
        _print_table(shown, results)
    console = Console(highlight=False, markup=False, emoji=False)
    for result, count in shown:
        head = f"{result.case.run}{_alike(count, 'more runs')}"
        for bus in () if result.facts is None else result.facts.buses:
            if bus.overload:
                console.print(f"{head}: {_overload(bus)}", soft_wrap=True)
        for line in _causes(result):
            console.print(f"{head}: {line}", soft_wrap=True)


def _alike(count: int, of: str) -> str:
    return f" and {count - 1} {of} of its case" if count > 1 else ""


def counts_line(verdicts: Iterable[Verdict], spent_s: float | None = None) -> str:
    """Say how many results have which verdict, and how long it took."""
    counts = Counter(verdicts)
    words = ", ".join(f"{counts[one]} {one.word}" for one in Verdict if counts[one])
    return (words or "nothing ran") + ("" if spent_s is None else f" in {duration(spent_s)}")


def _print_table(shown: Sequence[tuple[CaseResult, int]], results: Sequence[CaseResult]) -> None:
    table = RichTable(title="Verdicts", title_justify="left", show_lines=False)
    for column in _COLUMNS:
        table.add_column(column, overflow="fold", no_wrap=column in ("verdict", "case"))
    longest = 0
    for result, count in shown:
        check = _worst_check(result)
        text = ""
        if check is not None and check.verdict is not Verdict.PASS:
            text = result_sentence(check)
        passed = sum(one.verdict is Verdict.PASS for one in result.checks)
        name = result.case.run + (f" (+ {count - 1})" if count > 1 else "")
        longest = max(longest, len(name))
        table.add_row(
            f"{result.verdict.glyph} {result.verdict.word}",
            name,
            f"{passed}/{len(result.checks)}",
            result.error or text,
            " ".join(str(number) for number in result.alarms),
        )
    good = len(results) - sum(count for _, count in shown)
    if good:
        table.caption = f"{good} more passed; -v shows each one"
        table.caption_justify = "left"
    console = Console(highlight=False, markup=False, emoji=False)  # `:X:` and `[..]` are text
    frame = 3 * len(_COLUMNS) + 1 + len("✖ inconclusive") + 2 * len("checks")
    console.width = max(console.width, longest + frame + _TEXT_MIN)
    console.print(table)


def _grouped(results: Iterable[CaseResult]) -> list[list[CaseResult]]:
    """Put runs of one case together that did not pass in the same way."""
    groups: dict[Hashable, list[CaseResult]] = {}
    for result in results:
        check = _worst_check(result)
        way: Hashable = result.error
        if check is not None and not result.error:
            way = (check.check.metric, _excess(check) >= 0.0, check.value is None)
        key = (result.case.plan, result.case.case, result.verdict, way, tuple(result.alarms))
        groups.setdefault(key, []).append(result)
    return list(groups.values())


def _worst(group: Sequence[CaseResult]) -> CaseResult:
    """Return the result whose worst check is furthest beyond its limit."""

    def size(result: CaseResult) -> float:
        check = _worst_check(result)
        return 0.0 if check is None else abs(_excess(check))

    return max(group, key=size)


def _worst_check(result: CaseResult) -> CheckResult | None:
    return max(result.checks, key=lambda check: check.verdict, default=None)


def _excess(check: CheckResult) -> float:
    """Return by how much a value is above its upper limit, negative: below the lower one."""
    value, condition = check.value, check.check.condition
    if not isinstance(value, int | float):
        return 0.0
    if condition.upper is not None and value > condition.upper:
        return value - condition.upper
    if condition.lower is not None and value < condition.lower:
        return value - condition.lower
    return 0.0


def show_unjudged(left: Sequence[str]) -> None:
    """Say which recordings no row of a plan judges, in one line."""
    if not left:
        return
    named = ", ".join(left[:_NAMED])
    more = f" and {len(left) - _NAMED} more" if len(left) > _NAMED else ""
    print(f"no row of the plan judges {named}{more}", file=sys.stderr)


_NAMED = 3


def _causes(result: CaseResult) -> list[str]:
    """Say why a run did not pass: its error and what was printed until then, or its checks."""
    if result.verdict <= Verdict.MARGINAL:
        return []
    log = () if result.facts is not None else result.log
    if result.error:
        return [result.error, *log]
    failed = [check for check in result.checks if check.verdict > Verdict.MARGINAL]
    causes = [f"{check.verdict.word}: {result_sentence(check)}" for check in failed]
    causes += [
        f"{check.check.metric} {NOT_MET}: {result_sentence(check)}"
        for check in result.checks
        if check.check.metric in result.case.expected and check.verdict is not Verdict.FAIL
    ]
    alarms = () if result.facts is None else result.facts.alarms
    return [*causes, *log, *(alarm.text for alarm in alarms if not alarm.is_further)]


def _overload(bus: BusFigures) -> str:
    """Say what a segment was asked for that it cannot hold, and what came of it."""
    text = f"segment {bus.segment} is overloaded: {bus.overload};"
    text += f" load {bus.load_pct:.1f} %, worst ms {bus.load_1ms_pct:.1f} %"
    if bus.waiting:
        longest = bus.waiting[0]
        text += f", {longest.name} waited {longest.worst_us:.0f} us"
    return text
