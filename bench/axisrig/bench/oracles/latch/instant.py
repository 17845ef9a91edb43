"""The instant whose position belongs to an edge, by the data sheet of a drive or a terminal.

    edge -> delay of the input, filter -> compensation -> where a drive samples, the sample before

Source: docs/touch-probe.md (delay, filter, compensation, samples), docs/measuring-sources.md
(stamps).
"""

from dataclasses import dataclass

from axisrig.bench.oracles.sources.chain import Stamps
from axisrig.kernel.time.clock import TimeNs


@dataclass(frozen=True)
class LatchTimes:
    """How far the instant of a latch is from its edge.

    delay_ns: of the input, its filter with it. compensation_ns: what the drive takes off again.
    sample_ns: period of the samples of a drive that stores the one before; 0: it interpolates.
    jitter_ns: the edge may come so much later still, which the instant leaves out. stamps: of a
    terminal, None for a drive.
    """

    delay_ns: TimeNs = 0
    compensation_ns: TimeNs = 0
    sample_ns: TimeNs = 0
    jitter_ns: TimeNs = 0
    stamps: Stamps | None = None

    def instant_ns(self, edge_ns: TimeNs) -> TimeNs:
        """Return the instant that counts for an edge without jitter, from 0 on."""
        at_ns = edge_ns + self.delay_ns - self.compensation_ns
        if self.stamps is not None:
            at_ns = self.stamps.believed_ns(at_ns)
        if self.sample_ns:
            at_ns -= at_ns % self.sample_ns
        return max(at_ns, 0)
