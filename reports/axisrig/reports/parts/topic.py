"""What a topic gives to the report: sections of a run, and what it adds to the plots."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pyarrow as pa

from axisrig.bench.judge.run_findings import RunFindings


@dataclass(frozen=True)
class Plots:
    """What a topic adds to the plots of a run.

    axes: that it is about, the one to show first in front. limits: lines of the plots. windows:
    stretches worth a button. spans: begin and end in ns of stretches whose events have a window
    here. more: further entries of the description, by the names that `page.js` knows.
    """

    axes: Sequence[str] = ()
    limits: Sequence[Mapping[str, Any]] = ()
    windows: Sequence[Mapping[str, Any]] = ()
    spans: Sequence[tuple[int, int]] = ()
    more: Mapping[str, Any] = field(default_factory=dict)


def _unchanged(trace: pa.Table, _info: RunFindings) -> pa.Table:
    return trace


def _nothing(_trace: pa.Table, _info: RunFindings) -> Plots:
    return Plots()


@dataclass(frozen=True)
class ReportTopic:
    """One topic. name: of its folder. package: holds its `section.html`.

    sections: what the macro `sections` of that file prints, of a run's findings, its signals as
    recorded, its ID and what each alarm says (by the words of its event). with_signals: the signals
    with those that it adds. plots: of these signals. legend: how to read its plots, a sentence.
    """

    name: str
    package: str
    sections: Callable[[RunFindings, pa.Table | None, str, Mapping[str, str]], list[dict[str, Any]]]
    with_signals: Callable[[pa.Table, RunFindings], pa.Table] = _unchanged
    plots: Callable[[pa.Table, RunFindings], Plots] = _nothing
    legend: str = ""
