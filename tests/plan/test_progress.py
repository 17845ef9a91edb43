"""Progress of a campaign without a terminal: a line every 30 s, by a clock that the test sets."""

import io
from types import SimpleNamespace
from typing import cast

from rich.console import Console

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.campaign.shown import CampaignProgress
from axisrig.bench.plan.verdict import Verdict


def test_a_line_every_thirty_seconds_says_how_far_it_is() -> None:
    now_s, text = [0.0], io.StringIO()
    console = Console(file=text, force_terminal=False, width=200, highlight=False, markup=False)
    with CampaignProgress(300, lambda: now_s[0], console) as progress:
        for number in range(7):
            now_s[0] += 10.0
            verdict = Verdict.FAIL if number == 2 else Verdict.PASS
            case = SimpleNamespace(run=f"r{number}")
            progress.show(cast(CaseResult, SimpleNamespace(verdict=verdict, case=case)))
    lines = text.getvalue().splitlines()
    assert [line for line in lines if "runs/s" in line] == [
        "3/300 runs, 2 pass, 1 fail, 0.1 runs/s, 49 min 30 s left",
        "6/300 runs, 5 pass, 1 fail, 0.1 runs/s, 49 min 00 s left",
    ]
    assert sum(line.split()[-1].startswith("r") for line in lines) == 7
