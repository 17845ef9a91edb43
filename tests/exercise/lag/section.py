"""The section of the topic: from its block of the findings to the page."""

from collections.abc import Mapping
from typing import Any

import pyarrow as pa
from tests.exercise.lag.words import words

from axisrig.reports.parts.topic import Info


def sections(
    info: Info, _trace: pa.Table | None, _run: str, _alarms: Mapping[str, str]
) -> list[dict[str, Any]]:
    """Make what the page prints of each axis."""
    return [{"axis": block["axis"], "words": words(block)} for block in info.get("lag", ())]
