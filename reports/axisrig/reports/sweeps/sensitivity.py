"""Sensitivity over a sweep: which input moves which metric how much, with confidence bounds.

A plane through all runs of a case (`statistics.estimates.effects`) gives what each input changes
over its swept range while the others are held. Normalised: as a share of the largest less the
smallest value of the metric.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape

from markupsafe import Markup

from axisrig.bench.plan.check_row import finite
from axisrig.bench.statistics.estimates import Effect, Estimate, effects
from axisrig.kernel.errors import UserError
from axisrig.reports.parts.axes import Scale
from axisrig.reports.sweeps.section import PICTURES_MAX, Sweep

WIDTH, ROW = 420, 30
_LEFT, _RIGHT, _TOP = 8.0, 8.0, 4.0
_POOR, _NOTHING = 0.7, 1e-9


@dataclass(frozen=True)
class Sensitivity:
    """What the inputs of a sweep change, in the order of its columns.

    width: largest less smallest value of the metric.
    """

    sweep: Sweep
    effects: tuple[Effect, ...]
    width: float


def sensitivities(found: Sequence[Sweep]) -> tuple[list[Sensitivity], list[str]]:
    """Return the sensitivity of each metric over two inputs and more, and notes on what has none.

    An input whose values are not all numbers is one of words.
    """
    made, notes = [], []
    for sweep in found:
        if len(sweep.columns) < 2:
            continue
        values = [sample.value for sample in sweep.samples]
        settings = [_setting([s.at[place] for s in sweep.samples])
                    for place in range(len(sweep.columns))]  # fmt: skip
        try:
            changes = effects(values, settings)
        except UserError as error:
            notes.append(f"{sweep.case}: {sweep.metric} has no sensitivity: {error}")
        else:
            made.append(Sensitivity(sweep, changes, max(values) - min(values)))
    return made, notes


def _setting(texts: Sequence[str]) -> Sequence[float] | Sequence[str]:
    values = [finite(text) for text in texts]
    known = [value for value in values if value is not None]
    return known if len(known) == len(texts) else texts


def sensitivity_section(found: Sequence[Sweep]) -> Markup:
    """Write the section: a table for each case, tornado pictures; empty without such a sweep."""
    made, notes = sensitivities(found)
    if not made and not notes:
        return Markup("")
    ranked = sorted(made, key=lambda one: -one.sweep.worst)
    tables = [
        _table([one for one in made if one.sweep.case == case])
        for case in dict.fromkeys(one.sweep.case for one in made)
    ]
    pictures = [tornado(one) for one in ranked[:PICTURES_MAX]]
    if len(ranked) > PICTURES_MAX:
        notes.append(f"{len(ranked) - PICTURES_MAX} more metrics are in the tables only")
    said = "".join(f'<p class="note">{escape(note)}.</p>' for note in dict.fromkeys(notes))
    return Markup(
        '<section class="sweeps" aria-labelledby="sensitivity_title">'
        '<h2 id="sensitivity_title">Sensitivity</h2>'
        '<p class="note">What each input changes over its swept range while the others are held:'
        " least squares over all runs of the case, with bounds of 95 %. The tables have it as a"
        " share of the largest less the smallest value of the metric, bold where the bounds leave"
        " out that nothing changes. Explained: the share of the variance that all inputs together"
        " take up.</p>"
        f"{''.join(tables)}{''.join(pictures)}{said}</section>"
    )


def _table(made: Sequence[Sensitivity]) -> str:
    """Metrics down, inputs across; a change that may be none is pale."""
    columns = made[0].sweep.columns
    head = "".join(f'<th scope="col">{escape(column)}</th>' for column in columns)
    rows = []
    for one in made:
        cells = "".join(_cell(effect, one.width) for effect in one.effects)
        fit = f"{100 * one.effects[0].r_squared:.0f} %"
        name = escape(one.sweep.metric)
        rows.append(f'<tr><th scope="row">{name}</th>{cells}<td>{fit}</td></tr>')
    case = escape(made[0].sweep.case)
    return (
        f'<div class="wide"><table class="grid"><caption><b>{case}</b></caption>'
        f'<thead><tr><th scope="col">Metric</th>{head}<th scope="col">explained</th></tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )


def _cell(effect: Effect, width: float) -> str:
    change = effect.change
    shares = [100 * value / width for value in (change.value, change.lower, change.upper)]
    sign = "\u25b2" if change.value > 0 else "\u25bc"
    share, lower, upper = map(_per_cent, shares)
    bounds = f'<span class="note">{lower} to {upper}</span>'
    if not _is_sure(effect):
        return f'<td class="soft">{share} % {bounds}</td>'
    return f"<td><b>{sign} {share} %</b> {bounds}</td>"


def _per_cent(value: float) -> str:
    """A whole number with its sign, below ten with a decimal."""
    text = f"{value:+.0f}" if abs(value) >= 9.95 else f"{value:+.1f}"
    return "0" if float(text) == 0.0 else text


def _is_sure(effect: Effect) -> bool:
    """Whether the bounds leave out that nothing changes."""
    return effect.change.lower > 0.0 or effect.change.upper < 0.0


def tornado(one: Sensitivity) -> str:
    """Draw a bar for each input from no change to its change, the longest first, with bounds."""
    sweep = one.sweep
    order = sorted(
        zip(sweep.columns, one.effects, strict=True), key=lambda pair: -abs(pair[1].change.value)
    )
    ends = [0.0]
    for _, effect in order:
        ends += [effect.change.value, effect.change.lower, effect.change.upper]
    x = Scale(min(ends), max(ends), _LEFT + 4, WIDTH - _RIGHT - 4).at
    height = _TOP + ROW * len(order) + 4
    title = escape(f"sensitivity of {sweep.metric}", quote=True)
    bars = "".join(
        _bar(column, effect, sweep.unit, x, _TOP + ROW * at)
        for at, (column, effect) in enumerate(order)
    )
    words = f"{sweep.metric}, {sweep.unit}" if sweep.unit else sweep.metric
    r_squared = one.effects[0].r_squared
    poor = ": look at the sweep, it is no plane" if r_squared < _POOR else ""
    return (
        f"<figure><figcaption><b>{escape(sweep.case)}</b>: {escape(words)}"
        f' <span class="soft">explained: {100 * r_squared:.0f} %{poor}</span></figcaption>'
        f'<svg class="sw" viewBox="0 0 {WIDTH} {height:g}" role="img" aria-label="{title}">{bars}'
        "</svg></figure>"
    )


def _bar(column: str, effect: Effect, unit: str, x: Callable[[float], float], top: float) -> str:
    change = effect.change
    left, right = sorted((x(0.0), x(change.value)))
    low, high = (f"{v:.6g}" if isinstance(v, float) else v for v in (effect.low, effect.high))
    value, lower, upper = _rounded(change)
    said = f"{column} {low} to {high}: {value}"
    bounds = f"{lower} to {upper}"
    words = f"{said} ({bounds}){f' {unit}' if unit else ''}"
    kind = "sw-sure" if _is_sure(effect) else "sw-unsure"
    middle = top + 21
    return (
        f'<text x="{_LEFT:g}" y="{top + 10:g}">{escape(words)}</text>'
        f'<rect class="{kind}" x="{left:.1f}" y="{top + 15:g}" width="{max(right - left, 1):.1f}"'
        f' height="12"><title>{escape(words)}</title></rect>'
        f'<path class="sw-bound" d="M{x(change.lower):.1f},{middle - 4:g}v8m0,-4'
        f'H{x(change.upper):.1f}m0,-4v8"/>'
        f'<line class="sw-zero" x1="{x(0.0):.1f}" x2="{x(0.0):.1f}" y1="{top + 13:g}"'
        f' y2="{top + ROW - 1:g}"/>'
    )


def _rounded(change: Estimate) -> list[str]:
    """Value and bounds with three digits; what is nothing beside the largest of them is 0."""
    values = (change.value, change.lower, change.upper)
    least = _NOTHING * max(abs(value) for value in values)
    return [f"{value:+.3g}" if abs(value) > least else "0" for value in values]
