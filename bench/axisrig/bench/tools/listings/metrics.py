"""Lists what a check column of a plan may ask for."""

from textwrap import fill

from axisrig.bench.plan.checks import known_metrics
from axisrig.bench.plan.statistic_checks import known_statistics

_JUDGED = {
    "": "",
    "last": ". Of several runs: the last{}",
    "every": ". Of several runs: the worst{}",
}


def metrics_table() -> str:
    """Describe every metric: how a check asks for it, its unit, its meaning."""
    lines = [
        "A column check:<metric> of a plan asks for a metric; its cells are conditions:",
        "`<= 0.5`, `99.9 .. 100.1`, `100 +- 0.001`, `== 50059`.",
        "Of several measurement runs in a program one is judged: the last, with :AXIS the",
        "last in which that axis takes part; where it says so, the worst of all.",
        "",
    ]
    for metric in known_metrics().values():
        form = {"axis": f"{metric.name}[:AXIS]", "block": f"{metric.name}:N<number>[.<k>]"}.get(
            metric.scope, metric.name
        )
        lines.append(f"{form}  {metric.unit}".rstrip())
        judged = _JUDGED[metric.judged].format(" of the axis" if metric.scope == "axis" else "")
        text = metric.meaning + judged
        lines.append(fill(text, 78, initial_indent="    ", subsequent_indent="    "))
    return "\n".join([*lines, "", *_statistics()])


def _statistics() -> list[str]:
    """Describe the statistics of a metric: form, formula, uncertainty, source."""
    lines = [
        "A column check:<statistic>(<metric>) asks for a statistic of a metric over all",
        "runs of a case and all measurement runs of their programs; `; last` at the end",
        "takes the last one of each. u is the largest uncertainty of a single value.",
        "",
    ]
    for row in known_statistics().values():
        unit = {"metric": "[unit of the metric]", "": ""}.get(row.unit, f"[{row.unit}]")
        lines.append(f"{row.form}  {unit}".rstrip())
        text = f"{row.meaning}. {row.formula}; uncertainty {row.uncertainty}. {row.source}"
        lines.append(fill(text, 78, initial_indent="    ", subsequent_indent="    "))
    return lines
