"""The cycle of an EtherCAT line on paper: how long its frame is, and when it is where.

A frame has 8 bytes of preamble, at least 60 from the destination address on, 4 of FCS and 12 of gap
(IEEE 802.3): 84 bytes, 6.72 us at 100 Mbit/s for the shortest. A slave acts when the whole frame
has passed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from axisrig.bench.bus.ethercat.frame import time_on_wire_ns
from axisrig.bench.rig.ethercat.members import (
    TERMINAL_BYTES,
    axes_on,
    ec_segments,
    segment_of,
    slaves_on,
    terminal_on,
    watches_clocks,
)
from axisrig.bench.rig.ethercat.on_line import axis_pdos
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.ethercat.image import bytes_of
from axisrig.kernel.profiles.ethercat.layouts import (
    DATAGRAM,
    DATAGRAM_DATA_MAX,
    FIRST_DATAGRAM,
    FRAME_MAX,
    FRAME_MIN,
    WORKING_COUNTER,
    received_after_ns,
)
from axisrig.kernel.time.clock import US, TimeNs

OVERHEAD = DATAGRAM.size + WORKING_COUNTER.size
MAILBOX_BYTES = 128
"""Of our own drive, each way."""


@dataclass(frozen=True)
class CycleArithmetic:
    """One cycle of a line. parts: of its frame, with their bytes. image_bytes: of its LRW.

    there_ns: from the begin of the frame at the master until it is in the last slave. back_ns:
    until it is back. mailbox_ns: of a mailbox frame for each slave, one at a time.
    """

    parts: Sequence[tuple[str, int]]
    image_bytes: int
    period_ns: TimeNs
    offset_ns: TimeNs
    frame_ns: TimeNs
    there_ns: TimeNs
    back_ns: TimeNs
    mailbox_ns: TimeNs

    @property
    def frame_bytes(self) -> int:
        """Length of the cyclic frame, without FCS."""
        return max(sum(size for _, size in self.parts), FRAME_MIN)

    @property
    def wire_ns(self) -> TimeNs:
        """Time that the frame has the wire."""
        return time_on_wire_ns(self.frame_bytes)

    @property
    def fits_frame(self) -> bool:
        """Whether one frame carries it."""
        return self.image_bytes <= DATAGRAM_DATA_MAX and self.frame_bytes <= FRAME_MAX

    @property
    def is_before_cycle(self) -> bool:
        """Whether the frame leaves before the NC cycle, which then finds its inputs."""
        return self.frame_ns < self.offset_ns

    @property
    def is_back_in_time(self) -> bool:
        """Whether the NC cycle, or the next frame, comes after the frame is back."""
        limit_ns = self.offset_ns if self.is_before_cycle else self.period_ns + self.offset_ns
        return self.frame_ns + self.back_ns <= limit_ns

    @property
    def fits(self) -> bool:
        """Whether the cycle holds, with room for one mailbox frame."""
        busy_ns = max(self.wire_ns, self.back_ns) + self.mailbox_ns
        return self.fits_frame and self.is_back_in_time and busy_ns <= self.period_ns

    def table(self) -> str:
        """Show the arithmetic."""
        parts = "\n".join(f"  {name:<32}{size:>6} bytes" for name, size in self.parts)
        length = sum(size for _, size in self.parts)
        limit = "NC cycle" if self.is_before_cycle else "next NC cycle"
        limit_ns = self.offset_ns if self.is_before_cycle else self.period_ns + self.offset_ns
        return (
            f"{parts}\n"
            f"  frame {length} bytes, at least {FRAME_MIN}, of {FRAME_MAX}; with 8 preamble, 4 FCS"
            f" and 12 gap {self.wire_ns / US:.2f} us at 100 Mbit/s\n"
            f"  leaves at {self.frame_ns / US:g} us, is in the last slave at"
            f" {(self.frame_ns + self.there_ns) / US:.2f} us and back at"
            f" {(self.frame_ns + self.back_ns) / US:.2f} us ({limit} at {limit_ns / US:g} us)\n"
            f"  with one mailbox frame of {self.mailbox_ns / US:.2f} us"
            f" {(max(self.wire_ns, self.back_ns) + self.mailbox_ns) / US:.2f} of"
            f" {self.period_ns / US:g} us"
        )


@once
def schedule_of(settings: Settings, segment: str) -> CycleArithmetic:
    """Return the cycle of a line."""
    table, cycle = segment_of(settings, segment), settings.rig.cycle
    axes = axes_on(settings, segment)
    parts = [("Ethernet and EtherCAT head", FIRST_DATAGRAM)]
    if table.dc and table.drift_compensation and axes:
        parts += [("time to the reference (FPWR)", OVERHEAD + 4)]
        parts += [("time to the others (FRMW)", OVERHEAD + 4)]
    image = 0
    for axis in axes:
        outputs, inputs = axis_pdos(settings, axis)
        image += bytes_of([outputs]) + bytes_of([inputs]) + 1
    if terminal_on(settings, segment) is not None:
        image += TERMINAL_BYTES
    count = len(slaves_on(settings, segment))
    parts += [(f"process image of {count} (LRW)", OVERHEAD + image)]
    parts += [("states (BRD)", OVERHEAD + 2)]
    if table.dc and table.drift_compensation and axes and watches_clocks(settings):
        parts += [("differences of clocks (BRD)", OVERHEAD + 4)]
    length = max(sum(size for _, size in parts), FRAME_MIN)
    there_ns, round_ns = line_delays(settings, segment)
    mailbox = FIRST_DATAGRAM + OVERHEAD + MAILBOX_BYTES
    return CycleArithmetic(
        parts,
        image,
        cycle.period_us * US,
        cycle.cycle_offset_us * US,
        table.frame_ns,
        there_ns + received_after_ns(length),
        round_ns + received_after_ns(length),
        time_on_wire_ns(mailbox),
    )


def line_delays(settings: Settings, segment: str) -> tuple[TimeNs, TimeNs]:
    """Return the delay from the master to the last slave, and to the master again, ns.

    A frame passes each wire twice; each slave but the last one on both ways, the last one once.
    """
    table, names = segment_of(settings, segment), slaves_on(settings, segment)
    wires = [round(table.of("wire_ns", name)) for name in names]
    slaves = [round(table.of("slave_ns", name)) for name in names]
    there_ns = sum(wires) + sum(slaves[:-1])
    return there_ns, 2 * sum(wires) + 2 * sum(slaves[:-1]) + sum(slaves[-1:])


def overloads(settings: Settings) -> dict[str, str]:
    """Return the lines whose cycle does not fit, with what is too long in one line."""
    found = {}
    for name in ec_segments(settings):
        schedule = schedule_of(settings, name)
        if not schedule.fits:
            found[name] = (
                f"frame {schedule.frame_bytes} bytes, back at"
                f" {(schedule.frame_ns + schedule.back_ns) / US:.1f} us"
            )
    return found
