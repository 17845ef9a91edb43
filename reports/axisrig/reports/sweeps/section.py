"""The section of sweeps: metrics of a case over the inputs that its runs differ in.

One input is a picture, two are a grid, more have a picture for each, with the others as points.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from importlib import resources

from markupsafe import Markup

from axisrig.bench.campaign.results.stored import StoredResults, StoredRun
from axisrig.bench.plan.assignment import INPUT_KINDS, parse_column
from axisrig.bench.plan.check_row import finite
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.sweeps.drawing import DOTS_MAX, Sample, drawing

PICTURES_MAX, CELLS_MAX, RUNS_MIN = 12, 400, 3
_IN_ALL = 48
"""Pictures of single inputs that the section has at most, of all metrics together."""


@dataclass(frozen=True)
class Sweep:
    """A metric of a case over its swept columns."""

    case: str
    metric: str
    unit: str
    columns: tuple[str, ...]
    samples: tuple[Sample, ...]

    @property
    def worst(self) -> Verdict:
        """The worst verdict of the metric."""
        return max(sample.verdict for sample in self.samples)

    @property
    def is_grid(self) -> bool:
        """Whether it is drawn as a grid."""
        return len(self.columns) == 2 and len(self.samples) <= CELLS_MAX

    @property
    def pictures(self) -> int:
        """How many pictures it takes."""
        return 1 if self.is_grid else len(self.columns)


def sweeps_style() -> Markup:
    """Return the rules of the section, for the element `style` of a page."""
    return Markup(resources.files(__package__).joinpath("style.css").read_text(encoding="utf-8"))


def sweeps_section(results: StoredResults, found: Sequence[Sweep] | None = None) -> Markup:
    """Write the section of a results folder, empty where no case has runs that differ in inputs.

    found: its sweeps, where they are known.
    """
    ranked = sorted(sweeps(results) if found is None else found, key=lambda sweep: -sweep.worst)
    drawn, pictures = 0, 0
    for sweep in ranked[:PICTURES_MAX]:
        pictures += sweep.pictures
        if drawn and pictures > _IN_ALL:
            break
        drawn += 1
    if not ranked:
        return Markup("")
    blocks = "".join(_block(sweep) for sweep in ranked[:drawn])
    if drawn < len(ranked):
        more = f"{len(ranked) - drawn} more metrics over swept inputs are not drawn"
        blocks += f'<p class="note">{more}.</p>'
    return Markup(
        '<section class="sweeps" aria-labelledby="sweeps_title"><h2 id="sweeps_title">Sweeps</h2>'
        f"{blocks}</section>"
    )


def sweeps(results: StoredResults) -> list[Sweep]:
    """Return each metric of each case whose runs differ in inputs, three runs at least."""
    cases: dict[tuple[str, str], list[StoredRun]] = {}
    for run in results.planned:
        if not run.is_statistic:
            cases.setdefault((run.case["plan"], run.case["case"]), []).append(run)
    found = []
    for (plan, case), runs in cases.items():
        columns = swept_columns(runs)
        if case and len(runs) >= RUNS_MIN and columns:
            found += _of_case(f"{plan}-{case}", runs, columns)
    return found


def swept_columns(runs: Sequence[StoredRun]) -> tuple[str, ...]:
    """Return the input columns in which runs of a case differ."""
    columns = [c for c in runs[0].case if ":" in c and c.partition(":")[0] in INPUT_KINDS]
    return tuple(c for c in columns if len({run.case.get(c, "") for run in runs}) > 1)


def _of_case(name: str, runs: Sequence[StoredRun], columns: tuple[str, ...]) -> list[Sweep]:
    samples: dict[str, list[Sample]] = {}
    units: dict[str, str] = {}
    for run in runs:
        at = tuple(run.case.get(column, "") for column in columns)
        for metric, unit, sample in samples_of(run, at):
            units[metric] = unit
            samples.setdefault(metric, []).append(sample)
    return [
        Sweep(name, metric, units[metric], columns, tuple(of_metric))
        for metric, of_metric in samples.items()
        if len({sample.at for sample in of_metric}) > 1
        and len({sample.value for sample in of_metric}) > 1
    ]


def samples_of(run: StoredRun, at: tuple[str, ...]) -> list[tuple[str, str, Sample]]:
    """Return each metric of a run that is a number: its name, its unit, and the sample."""
    found = []
    for row in run.checks:
        value = row.number
        if value is None or row.metric == "alarms":
            continue
        u = finite(row.uncertainty) or 0.0
        sample = Sample(run.run, at, value, u, row.limits, row.outcome)
        found.append((row.metric, row.unit, sample))
    return found


def _block(sweep: Sweep) -> str:
    words = f"{sweep.metric}, {sweep.unit}" if sweep.unit else sweep.metric
    head = f"<b>{escape(sweep.case)}</b>: {escape(words)} over "
    if sweep.is_grid:
        over = " and ".join(with_unit(column) for column in sweep.columns)
        return f"<figure><figcaption>{head}{escape(over)}</figcaption>{_grid(sweep)}</figure>"
    several = len(sweep.columns) > 1
    samples = _with_common_limits(sweep.samples) if several else sweep.samples
    count = len(samples)
    said = f", {DOTS_MAX} of {count} runs drawn" if count > DOTS_MAX else ""
    figures = []
    for place, column in enumerate(sweep.columns):
        title = f"{sweep.metric} over {column}"
        picture = drawing(samples, title, sweep.unit, place)
        caption = f"{head}{escape(with_unit(column) + said)}"
        if several and place:
            caption = f"over {escape(with_unit(column))}"
        figures.append(f"<figure><figcaption>{caption}</figcaption>{picture}</figure>")
    row = "".join(figures)
    return f'<div class="sw-row">{row}</div>' if several else row


def _with_common_limits(samples: Sequence[Sample]) -> list[Sample]:
    """Keep the limits that all samples have: others go with inputs that the picture hides."""
    common = [known.pop() if len(known := {s.limits[side] for s in samples}) == 1 else None
              for side in (0, 1)]  # fmt: skip
    return [replace(sample, limits=(common[0], common[1])) for sample in samples]


def with_unit(column: str) -> str:
    """Return the name of an input column with its unit."""
    unit = parse_column(column, "0").unit.replace("_", "/")
    return f"{column} in {unit}" if unit else column


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
