"""The section of sweeps: metrics of a case over the one or two inputs that its runs differ in."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from importlib import resources
from itertools import pairwise

from markupsafe import Markup

from axisrig.bench.campaign.results.stored import StoredResults, StoredRun
from axisrig.bench.plan.assignment import INPUT_KINDS, parse_column
from axisrig.bench.plan.verdict import Verdict

PICTURES_MAX, CELLS_MAX, RUNS_MIN = 12, 400, 3
WIDTH, HEIGHT = 420, 180
_LEFT, _RIGHT, _TOP, _BOTTOM = 8.0, 8.0, 18.0, 18.0
_ROOM = 0.06


@dataclass(frozen=True)
class Sample:
    """A metric in one run. at: values of the swept columns. u: its uncertainty."""

    run: str
    at: tuple[str, ...]
    value: float
    u: float
    limits: tuple[float | None, float | None]
    verdict: Verdict


@dataclass(frozen=True)
class Sweep:
    """A metric of a case over its swept columns, one or two."""

    case: str
    metric: str
    unit: str
    columns: tuple[str, ...]
    samples: tuple[Sample, ...]

    @property
    def worst(self) -> Verdict:
        """The worst verdict of the metric."""
        return max(sample.verdict for sample in self.samples)


def sweeps_style() -> Markup:
    """Return the rules of the section, for the element `style` of a page."""
    return Markup(resources.files(__package__).joinpath("style.css").read_text(encoding="utf-8"))


def sweeps_section(results: StoredResults) -> Markup:
    """Write the section of a results folder, empty where no case has runs that differ in inputs."""
    found, notes = sweeps(results)
    found.sort(key=lambda sweep: -sweep.worst)
    blocks = [_block(sweep) for sweep in found[:PICTURES_MAX]]
    if len(found) > PICTURES_MAX:
        notes.append(f"{len(found) - PICTURES_MAX} more metrics over swept inputs are not drawn")
    if not blocks and not notes:
        return Markup("")
    said = "".join(f'<p class="note">{escape(note)}.</p>' for note in notes)
    return Markup(
        '<section class="sweeps" aria-labelledby="sweeps_title"><h2 id="sweeps_title">Sweeps</h2>'
        f"{''.join(blocks)}{said}</section>"
    )


def sweeps(results: StoredResults) -> tuple[list[Sweep], list[str]]:
    """Return what can be drawn, and notes on what cannot: cases that sweep more than two inputs."""
    cases: dict[tuple[str, str], list[StoredRun]] = {}
    for run in results.planned:
        if not run.is_statistic:
            cases.setdefault((run.case["plan"], run.case["case"]), []).append(run)
    found, notes = [], []
    for (plan, case), runs in cases.items():
        columns = _swept(runs)
        if not case or len(runs) < RUNS_MIN or not columns:
            continue
        name = f"{plan}-{case}"
        if len(columns) > 2:
            notes.append(f"{name} sweeps {len(columns)} inputs: {', '.join(columns)}")
        elif len(columns) == 2 and len(runs) > CELLS_MAX:
            notes.append(f"{name} has {len(runs)} runs, a grid has {CELLS_MAX} at most")
        else:
            found += _of_case(name, runs, columns)
    return found, notes


def _swept(runs: Sequence[StoredRun]) -> tuple[str, ...]:
    columns = [c for c in runs[0].case if ":" in c and c.partition(":")[0] in INPUT_KINDS]
    return tuple(c for c in columns if len({run.case.get(c, "") for run in runs}) > 1)


def _of_case(name: str, runs: Sequence[StoredRun], columns: tuple[str, ...]) -> list[Sweep]:
    samples: dict[str, list[Sample]] = {}
    units: dict[str, str] = {}
    for run in runs:
        at = tuple(run.case.get(column, "") for column in columns)
        for row in run.checks:
            value = _number(row["value"])
            if value is None or row["metric"] == "alarms":
                continue
            units[row["metric"]] = row["unit"]
            samples.setdefault(row["metric"], []).append(
                Sample(
                    run.run,
                    at,
                    value,
                    _number(row["uncertainty"]) or 0.0,
                    (_number(row["lower"]), _number(row["upper"])),
                    Verdict.of(row["verdict"]),
                )
            )
    return [
        Sweep(name, metric, units[metric], columns, tuple(of_metric))
        for metric, of_metric in samples.items()
        if len({sample.at for sample in of_metric}) > 1
        and len({sample.value for sample in of_metric}) > 1
    ]


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _block(sweep: Sweep) -> str:
    words = f"{sweep.metric}, {sweep.unit}" if sweep.unit else sweep.metric
    over = " and ".join(_with_unit(column) for column in sweep.columns)
    body = drawing(sweep) if len(sweep.columns) == 1 else _grid(sweep)
    return (
        f"<figure><figcaption><b>{escape(sweep.case)}</b>: {escape(words)} over {escape(over)}"
        f"</figcaption>{body}</figure>"
    )


def _with_unit(column: str) -> str:
    unit = parse_column(column, "0").unit.replace("_", "/")
    return f"{column} in {unit}" if unit else column


# ---- one input


def drawing(sweep: Sweep) -> str:
    """Draw a metric over one input: values with uncertainty and verdict, limits that go with them.

    An input that is no number has its values side by side, in their order.
    """
    texts = list(dict.fromkeys(sample.at[0] for sample in sweep.samples))
    numbers = {text: _number(text) for text in texts}
    is_number = all(number is not None for number in numbers.values())
    places = {
        text: (numbers[text] or 0.0) if is_number else float(at) for at, text in enumerate(texts)
    }
    samples = sorted(sweep.samples, key=lambda sample: places[sample.at[0]])
    ends = [s.value + sign * s.u for s in samples for sign in (-1, 1)]
    ends += [limit for s in samples for limit in s.limits if limit is not None]
    low, high = min(ends), max(ends)
    room = _ROOM * (high - low) or max(abs(high) * 1e-3, 1e-9)
    low, high = low - room, high + room
    first, last = min(places.values()), max(places.values())

    def x(text: str) -> float:
        share = (places[text] - first) / (last - first)
        return _LEFT + 10 + share * (WIDTH - _LEFT - _RIGHT - 20)

    def y(value: float) -> float:
        return _TOP + (high - value) / (high - low) * (HEIGHT - _TOP - _BOTTOM)

    title = escape(f"{sweep.metric} over {sweep.columns[0]}", quote=True)
    parts = [
        f'<svg class="sw" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{title}">',
        f'<text x="{_LEFT:g}" y="12">{min(ends):.6g} to {max(ends):.6g}'
        f"{escape(f' {sweep.unit}' if sweep.unit else '')}</text>",
        f'<rect class="sw-field" x="{_LEFT:g}" y="{_TOP:g}" width="{WIDTH - _LEFT - _RIGHT:g}"'
        f' height="{HEIGHT - _TOP - _BOTTOM:g}"/>',
    ]
    for side in (0, 1):
        for one, other in pairwise(samples):
            heights = (one.limits[side], other.limits[side])
            if heights[0] is not None and heights[1] is not None:
                parts.append(
                    f'<line class="sw-limit" x1="{x(one.at[0]):.1f}" y1="{y(heights[0]):.1f}"'
                    f' x2="{x(other.at[0]):.1f}" y2="{y(heights[1]):.1f}"/>'
                )
    parts += [_dot(sample, x(sample.at[0]), y) for sample in samples]
    foot = HEIGHT - 4
    parts += [
        f'<text x="{_LEFT:g}" y="{foot}">{escape(samples[0].at[0] or "empty")}</text>',
        f'<text x="{WIDTH - _RIGHT:g}" y="{foot}" text-anchor="end">'
        f"{escape(samples[-1].at[0] or 'empty')}</text>",
        "</svg>",
    ]
    return "".join(parts)


def _dot(sample: Sample, x: float, y: object) -> str:
    assert callable(y)
    verdict, height = sample.verdict, y(sample.value)
    bar = ""
    if sample.u:
        bar = (
            f'<line class="sw-u" x1="{x:.1f}" x2="{x:.1f}" y1="{y(sample.value - sample.u):.1f}"'
            f' y2="{y(sample.value + sample.u):.1f}"/>'
        )
    title = f"{sample.run}: {sample.value:.7g} at {sample.at[0]}, {verdict.word}"
    if verdict <= Verdict.MARGINAL:
        sign = f'<circle cx="{x:.1f}" cy="{height:.1f}" r="3.2"/>'
    else:  # colour is never the only carrier
        sign = f'<path d="M{x - 4:.1f},{height - 4:.1f}l8,8m0,-8l-8,8"/>'
    return f'{bar}<g class="sw-{verdict.word}"><title>{escape(title)}</title>{sign}</g>'


# ---- two inputs


def _grid(sweep: Sweep) -> str:
    """Write a table: first input down, second across; each cell with sign, word and value."""
    columns: list[Mapping[str, None]] = [
        dict.fromkeys(sample.at[place] for sample in sweep.samples) for place in (0, 1)
    ]
    cells: dict[tuple[str, ...], Sample] = {}
    for sample in sweep.samples:  # of several runs, the worst
        known = cells.get(sample.at)
        if known is None or sample.verdict > known.verdict:
            cells[sample.at] = sample
    head = "".join(f'<th scope="col">{escape(text or "empty")}</th>' for text in columns[1])
    rows = []
    for one in columns[0]:
        row = "".join(_cell(cells.get((one, other))) for other in columns[1])
        rows.append(f'<tr><th scope="row">{escape(one or "empty")}</th>{row}</tr>')
    corner = escape(f"{sweep.columns[0]} down, {sweep.columns[1]} across")
    return (
        f'<div class="wide"><table class="grid"><caption class="note">{corner}</caption>'
        f'<thead><tr><th scope="col"><span class="away">{corner}</span></th>{head}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )


def _cell(sample: Sample | None) -> str:
    if sample is None:
        return "<td></td>"
    verdict = sample.verdict
    return (
        f'<td class="word v-{verdict.word}"><a href="#{escape(sample.run, quote=True)}">'
        f'<span aria-hidden="true">{verdict.glyph}</span>'
        f'<span class="away">{verdict.word}</span> {sample.value:.5g}</a></td>'
    )
