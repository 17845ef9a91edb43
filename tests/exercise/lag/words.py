"""The topic in words."""

from tests.exercise.lag.findings import LagFindings

LEGEND = "The plot of the lag has a line at its largest amount."


def words(found: LagFindings) -> str:
    """Say where an axis lags most."""
    return f"{found.axis} lags most at {found.time_ns / 1e6:g} ms: {found.mm:.4g} mm"
