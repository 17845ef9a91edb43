"""The section "Real time" of a run on a real bus: what was late, and what it means."""

from typing import Any

from axisrig.bench.record.bus import RealTime


def real_time(figures: RealTime | None) -> dict[str, Any] | None:
    """Make the section from `real_time` of a recording; None for simulated time."""
    if figures is None or figures.lateness_us is None:
        return None
    late, interval = figures.lateness_us, figures.interval_us
    rows = [
        ("SYNCs sent", f"{figures.cycles}"),
        (
            f"later than {figures.late_us:g} µs",
            f"{figures.late_cycles} ({100 * figures.late_cycles / figures.cycles:.2f} %)",
        ),
        ("lateness: median", _us(late.median_us)),
        ("lateness: 99 % below", _us(late.p99_us)),
        ("lateness: largest", _us(late.most_us)),
    ]
    if interval:
        span = f"{_us(interval.least_us)} to {_us(interval.most_us)}"
        rows.append((f"SYNC interval, asked for {_us(figures.period_us)}", span))
    return {"rows": rows, "histogram": _histogram(figures), "words": _words(figures)}


def _us(value: float) -> str:
    return f"{value:.0f} µs" if value < 10_000 else f"{value / 1000:.1f} ms"


def _histogram(figures: RealTime) -> list[dict[str, str]]:
    """One row per bin: its range, how many SYNCs, their share in per cent."""
    edges, counts = figures.bins_us, figures.histogram
    tops = [f"to {_us(edge)}" for edge in edges[1:]] + ["and more"]
    return [
        {
            "range": f"{_us(low)} {top}",
            "count": str(count),
            "share": f"{100 * count / figures.cycles:.2f}",
        }
        for low, top, count in zip(edges, tops, counts, strict=True)
    ]


def _words(figures: RealTime) -> list[str]:
    """What the figures mean for who reads the measured values."""
    words = [
        "A late SYNC does not move a latch: the drive stores the position when the edge comes,"
        " whatever the bus does. It makes the path uneven and the reaction to the edge longer, by"
        " the lateness at most.",
    ]
    if figures.slips:
        words.append(
            f"This computer missed its plan {figures.slips} times by more than a quarter of the"
            f" period; the plan then moved, {figures.slipped_ms:.1f} ms in all, so that no SYNCs"
            " came in bursts. The program took that much longer."
        )
    if figures.waits:
        words.append(
            f"{figures.waits} cycles waited for the answers of the drives,"
            f" {figures.waited_ms:.1f} ms in all: the interface is slower than the cycle."
            " Times of this run are stretched."
        )
    if figures.send_errors:
        words.append(f"The interface did not take {figures.send_errors} frames.")
    return words
