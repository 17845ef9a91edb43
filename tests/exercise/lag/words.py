"""The topic in words."""

from collections.abc import Mapping
from typing import Any

LEGEND = "The plot of the lag has a line at its largest amount."


def words(block: Mapping[str, Any]) -> str:
    """Say where an axis lags most."""
    return f"{block['axis']} lags most at {block['time_ns'] / 1e6:g} ms: {block['mm']:.4g} mm"
