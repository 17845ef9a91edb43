"""When values act and are seen on EtherCAT, from the phases of frame, SYNC0 and sampling.

All instants are on the grid of the cycle, period T. The NC cycle comes at its offset C, the frame
leaves at F, SYNC0 comes at S, positions are sampled at P (= S where the rig says nothing else).

- What NC cycle k computes leaves with the first frame after k T + C, acts at the first SYNC0 after
  that frame has passed, and is reached one period later, for the drive interpolates.
- What is sampled leaves with the first frame that passes later, and the first NC cycle after its
  return reads it.

With one frame for both ways the two waits for the frame and for SYNC0 make up a whole period, so
that a drive which samples at SYNC0 is one cycle further away than on CAN, wherever the frame is.
"""

from dataclasses import dataclass

from axisrig.kernel.time.clock import TimeNs


@dataclass(frozen=True)
class Phases:
    """The instants of a cycle, ns. passing_ns: from the begin of a frame until a slave acts.

    back_ns: until the frame is back.
    """

    period_ns: TimeNs
    cycle_ns: TimeNs
    frame_ns: TimeNs
    sync_ns: TimeNs
    sample_ns: TimeNs
    passing_ns: TimeNs
    back_ns: TimeNs

    def acts_ns(self) -> TimeNs:
        """Return when the set values of NC cycle 0 act: the SYNC0 after their frame."""
        sent_ns = _next(self.cycle_ns, self.frame_ns, self.period_ns)
        return _next(sent_ns + self.passing_ns, self.sync_ns, self.period_ns)

    def seen_in(self, time_ns: TimeNs) -> int:
        """Return the first NC cycle that reads a sample not older than an instant."""
        sampled_ns = _next(time_ns, self.sample_ns, self.period_ns)
        # The frame that passes a slave after the sample
        sent_ns = _next(sampled_ns - self.passing_ns, self.frame_ns, self.period_ns)
        return -(-(sent_ns + self.back_ns - self.cycle_ns) // self.period_ns)

    @property
    def way(self) -> int:
        """Cycles from an NC cycle to the first one that sees what its set values do.

        The axis moves from the SYNC0 at which they act on and is there at the next one.
        """
        return self.seen_in(self.acts_ns() + 1)

    @property
    def late_cycles(self) -> int:
        """By how many cycles the way is longer than that of CAN, 2."""
        return self.way - 2

    @property
    def fresh_late_cycles(self) -> int:
        """The same of a value that is read as it was at the last SYNC0, by no frame."""
        reached_ns = self.acts_ns() + self.period_ns
        return -(-(reached_ns - self.cycle_ns) // self.period_ns) - 2


def _next(time_ns: TimeNs, phase_ns: TimeNs, period_ns: TimeNs) -> TimeNs:
    """Return the first instant of a grid that is not before an instant."""
    return time_ns + (phase_ns - time_ns) % period_ns
