"""Comparison and trend in lines for the terminal."""

from collections import Counter
from collections.abc import Iterator, Sequence

from axisrig.results.compare.pairs import Comparison, Frames, MetricPair
from axisrig.results.compare.trend import Trend

_SHOWN_MAX = 40
_LEVEL = 0.05


def diff_lines(
    comparison: Comparison, changed: Sequence[tuple[str, Sequence[str]]] = ()
) -> Iterator[str]:
    """Say what changed, then what came of it, the worse first; the last line counts.

    changed: what the campaigns were made from that differs (`changes`).
    """
    for what, keys in changed:
        yield f"changed: {what}"
        yield from (f"  {key}" for key in keys)
    worse = comparison.worse()
    yield from _first("worse", worse)
    better = [pair for pair in comparison.pairs if pair.after.verdict < pair.before.verdict]
    yield from _first(
        "better",
        [f"{one.name}: {one.before.verdict.word} -> {one.after.verdict.word}" for one in better],
    )
    shifted = [m for pair in comparison.pairs for m in pair.metrics if m.is_significant]
    shifted.sort(key=lambda metric: -metric.en)
    yield from _first("shifted", [_shift_words(metric) for metric in shifted])
    for shift in comparison.shifts:
        if shift.p_value < _LEVEL:
            yield (
                f"case: {shift.case}: mean of {shift.metric} {shift.means[0]:.7g} ->"
                f" {shift.means[1]:.7g}{_after_space(shift.unit)} (n {shift.n[0]} and"
                f" {shift.n[1]}, p {shift.p_value:.2g})"
            )
    by_inputs = [pair.name for pair in comparison.pairs if pair.is_by_inputs]
    yield from _first("matched by equal inputs", by_inputs)
    yield from _first("new", [f"{run.run} ({run.verdict.word})" for run in comparison.new])
    frames = Counter(pair.frames for pair in comparison.pairs)
    counts = ", ".join(f"{frames[kind]} {kind.value}" for kind in Frames if frames[kind])
    yield (
        f"{len(comparison.pairs)} runs in both ({len(by_inputs)} matched by"
        f" equal inputs), {len(comparison.new)} new, {len(comparison.lost)} missing;"
        f" frames: {counts or 'none'}; {len(worse)} worse"
    )


def _first(kind: str, found: Sequence[str]) -> Iterator[str]:
    """Write the first lines of a kind, and how many more there are."""
    yield from (f"{kind}: {line}" for line in found[:_SHOWN_MAX])
    if len(found) > _SHOWN_MAX:
        yield f"{kind}: {len(found) - _SHOWN_MAX} more"


def _shift_words(metric: MetricPair) -> str:
    return (
        f"{metric.run}: {metric.metric} {metric.before:.7g} -> {metric.after:.7g}"
        f"{_after_space(metric.unit)} (En {metric.en:.3g})"
    )


def _after_space(unit: str) -> str:
    return f" {unit}" if unit else ""


def trend_lines(trend: Trend) -> Iterator[str]:
    """Write a line for each case in each folder, and one with the limits."""
    for case in trend.cases:
        limits = " .. ".join(f"{limit:g}" for limit in case.limits)
        yield f"{case.case}  {trend.metric} {case.unit}".rstrip() + (
            f", limits {limits}" if limits else ""
        )
        for point in case.points:
            spread = "" if point.n < 2 else f"  s {point.spread:.3g}"
            yield (
                f"  {trend.folders[point.place]:<30} {point.mean:>14.7g}{spread}"
                f"  n {point.n}  {point.verdict.word}"
            )
