"""The section of the topic: from its findings to the page."""

from collections.abc import Mapping
from typing import Any

import pyarrow as pa
from tests.exercise.lag.findings import LagFindings
from tests.exercise.lag.words import words

from axisrig.bench.judge.run_findings import RunFindings


def sections(
    info: RunFindings, _trace: pa.Table | None, _run: str, _alarms: Mapping[str, str]
) -> list[dict[str, Any]]:
    """Make what the page prints of each axis."""
    return [{"axis": found.axis, "words": words(found)} for found in info.of(LagFindings)]
