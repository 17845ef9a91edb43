"""The map of a campaign: for each plan its metrics down and its runs across, by verdict.

The page draws it (`map.js`), so that ten thousand cells are as many characters here and no elements
there. A run has a character for itself and one for each metric of its plan: place of the verdict in
`Verdict`, `-` where the run has no such check.
"""

import json
from collections.abc import Mapping
from importlib import resources
from typing import Any

from markupsafe import Markup

from axisrig.bench.campaign.results.stored import StoredRun
from axisrig.bench.plan.verdict import Verdict

METRICS_MAX = 30
"""So many metrics of a plan are drawn; the others are counted, those with the best verdicts."""
NO_CHECK = "-"


def map_style() -> Markup:
    """Return the rules of the section, for the element `style` of a page."""
    return Markup(resources.files(__package__).joinpath("style.css").read_text(encoding="utf-8"))


class CampaignMap:
    """Collects the verdicts of the runs of a results folder, in their order."""

    def __init__(self) -> None:
        self._plans: dict[str, list[tuple[str, int, Mapping[str, int]]]] = {}

    def add(self, run: StoredRun) -> None:
        """Take a run; of a metric with several checks the worst verdict counts."""
        verdicts: dict[str, int] = {}
        for row in run.checks:
            verdict = int(row.outcome)
            verdicts[row.metric] = max(verdict, verdicts.get(row.metric, 0))
        plan = self._plans.setdefault(run.case["plan"], [])
        plan.append((run.run, int(run.verdict), verdicts))

    def data(self) -> Markup:
        """Return what the page draws, as JSON that can be inside an element `script`.

        `verdicts`: word and sign, in their order. `plans`: name, metrics, how many metrics are
        `left_out`, `runs`: id and cells.
        """
        content = {
            "verdicts": [[verdict.word, verdict.glyph] for verdict in Verdict],
            "plans": [self._plan(name) for name in self._plans],
        }
        text = json.dumps(content, ensure_ascii=False, separators=(",", ":"))
        return Markup(text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e"))

    def _plan(self, name: str) -> dict[str, Any]:
        runs = self._plans[name]
        worst: dict[str, int] = {}
        for _, _, verdicts in runs:
            for metric, verdict in verdicts.items():
                worst[metric] = max(verdict, worst.get(metric, 0))
        kept = sorted(worst, key=lambda metric: -worst[metric])[:METRICS_MAX]
        metrics = [metric for metric in worst if metric in kept]
        return {
            "name": name,
            "metrics": metrics,
            "left_out": len(worst) - len(metrics),
            "runs": [
                [run, "".join([str(verdict), *(str(found.get(m, NO_CHECK)) for m in metrics)])]
                for run, verdict, found in runs
            ],
        }
