"""Words that several parts of a page share: units, numbers of runs, metrics with their units."""


def shown_unit(name: str) -> str:
    """Return a unit of the result files as a reader writes it."""
    return name.replace("um", "µm").replace("pct", "%")


def counted_of(count: int, of: int, what: str = "run") -> str:
    """Say how many of how many: `154 of 600 runs`, `all 3 runs`."""
    if count == of:
        return f"all {of} {what}s" if of != 1 else f"the one {what}"
    return f"{count} of {of} {what}s"


def metric_words(metric: str, unit: str) -> str:
    """Return a metric with its unit."""
    return f"{metric}, {shown_unit(unit)}" if unit else metric
