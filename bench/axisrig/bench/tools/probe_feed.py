"""`axisrig probe-feed`: how fast a probe may measure, and where its way goes."""

import math
from dataclasses import dataclass, fields

from axisrig.bench.oracles.latch.stopping import Braking, largest_speed_mm_s, stopping_path
from axisrig.kernel.errors import UserError

_MM_MIN_PER_MM_S = 60.0
_KV_PER_S = 1000.0 / 60.0  # of 1 (m/min)/mm
_OPTIONS = {
    "stroke_mm": "--stroke",
    "cycle_ms": "--cycle",
    "decel_m_s2": "--decel",
    "kv_m_min_mm": "--kv",
    "delay_ms": "--delay",
    "ramp_ms": "--ramp",
    "feed_forward": "--feed-forward",
}


@dataclass(frozen=True)
class Question:
    """What the command line says, in its units."""

    stroke_mm: float
    cycle_ms: float
    decel_m_s2: float
    kv_m_min_mm: float
    delay_ms: float = 0.0
    ramp_ms: float = 0.0
    feed_forward: float = 0.0

    def __post_init__(self) -> None:
        """Raise UserError for a number that no machine has."""
        for name in ("stroke_mm", "decel_m_s2", "kv_m_min_mm"):
            _demand(self, name, "above 0", getattr(self, name) > 0)
        for name in ("cycle_ms", "delay_ms", "ramp_ms"):
            _demand(self, name, "0 or more", getattr(self, name) >= 0)
        _demand(self, "feed_forward", "0 to 1", 0 <= self.feed_forward <= 1)

    def braking(self, cycles: float) -> Braking:
        """Return what stops the axis when the control reacts after a number of cycles."""
        return Braking(
            deceleration_mm_s2=self.decel_m_s2 * 1e3,
            kv_per_s=self.kv_m_min_mm * _KV_PER_S,
            reaction_s=(self.delay_ms + cycles * self.cycle_ms) / 1e3,
            ramp_s=self.ramp_ms / 1e3,
            feed_forward=self.feed_forward,
        )


def _demand(question: Question, name: str, allowed: str, holds: bool) -> None:
    value = getattr(question, name)
    if not (holds and math.isfinite(value)):
        raise UserError(f"{_OPTIONS[name]}: no machine has that", value=value, allowed=allowed)


def probe_feed_text(question: Question, feed_mm_min: float | None = None) -> str:
    """Return the largest feeds for a reaction of one cycle and of two, with the shares of the path.

    feed_mm_min: show the path of this feed in place of the largest one. Raises UserError.
    """
    if feed_mm_min is not None and not (feed_mm_min > 0 and math.isfinite(feed_mm_min)):
        raise UserError("--feed: no feed", value=feed_mm_min, allowed="above 0, mm/min")
    columns = [
        f"{'reaction ms':>12}{'feed mm/min':>14}{'reaction':>10}{'braking':>10}{'ramp':>10}"
        f"{'lag':>10}{'path mm':>10}"
    ]
    largest = []
    for cycles in (1, 2):
        braking = question.braking(cycles)
        largest.append(largest_speed_mm_s(braking, question.stroke_mm) * _MM_MIN_PER_MM_S)
        feed = largest[-1] if feed_mm_min is None else feed_mm_min
        path = stopping_path(braking, feed / _MM_MIN_PER_MM_S)
        shares = [getattr(path, field.name) for field in fields(path)]
        columns.append(
            f"{braking.reaction_s * 1e3:>12.4g}{feed:>14.1f}"
            + "".join(f"{share:>10.4f}" for share in (*shares, path.whole_mm))
        )
    return "\n".join(
        [
            *columns,
            "",
            f"A control that looks once in a cycle of {question.cycle_ms:g} ms brakes one to two"
            " cycles after the edge, delays not counted.",
            f"Within a stroke of {question.stroke_mm:g} mm: at most {largest[1]:.1f} mm/min for"
            f" every edge, {largest[0]:.1f} mm/min if it always took one cycle.",
        ]
    )
