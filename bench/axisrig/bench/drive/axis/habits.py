"""How the inputs, the encoder and the latch of a drive behave, whatever its words are."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Final, Literal

from axisrig.kernel.time.clock import US, TimeNs

LATCH_MODES: Final = ("interpolated", "linear", "sampled")


@dataclass(frozen=True)
class AxisHabits:
    """What differs from drive to drive at its axis; the defaults are a usual servo on a ball screw.

    encoder_increments: increments per motor revolution (20 bit).
    lead_um: travel of the load per motor revolution.
    input_delay_ns: time from an edge at the terminal to the latch after the input circuit.
    input_jitter_ns: largest further delay, drawn for each edge.
    input_filter_ns: how long a level must stay to count; the latch waits for it, and a shorter
        pulse gives neither latch nor level.
    min_pulse_ns: a shorter pulse gives neither, but the latch does not wait for it.
    latch_mode: "interpolated" = the position at the latch instant; "linear" = on the line between
        the encoder samples before and after it, `grid_ns` apart; "sampled" = the sample before.
    """

    encoder_increments: int = 1 << 20
    lead_um: int = 10_000
    input_delay_ns: TimeNs = 4 * US
    input_jitter_ns: TimeNs = 0
    input_filter_ns: TimeNs = 0
    min_pulse_ns: TimeNs = 0
    delay_compensation_ns: TimeNs = 0
    latch_mode: Literal["interpolated", "linear", "sampled"] = "interpolated"
    grid_ns: TimeNs = 62_500
    latch_bits: int = 64
    index_angle_deg: float = 0.0

    @property
    def increments_per_mm(self) -> Fraction:
        """Encoder increments per millimetre of the load, exact."""
        return Fraction(self.encoder_increments * 1000, self.lead_um)

    @property
    def latch_window_ns(self) -> tuple[TimeNs, TimeNs]:
        """How long before and after an edge the positions may be that its latch is made of."""
        delay_ns = self.input_delay_ns + self.input_filter_ns
        grid_ns = 0 if self.latch_mode == "interpolated" else self.grid_ns
        ahead_ns = self.grid_ns if self.latch_mode == "linear" else 0
        before_ns = grid_ns + self.delay_compensation_ns - delay_ns
        return max(0, before_ns), delay_ns + self.input_jitter_ns + ahead_ns
