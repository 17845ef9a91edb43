"""Does the cycle fit on the segment? Worst case of SYNC, TPDOs and RPDOs, before anything runs.

SYNC is requested at 0, the TPDOs when it is delivered, the RPDOs at `cycle_offset_ns`. Every frame
has its most stuff bits. An event frame (EMCY, event-driven TPDO, heartbeat, SDO) may come at the
worst moment once per cycle: one with a lower priority is on the wire just when it hurts, one with
a higher priority goes first. Source of the argument: Davis et al. 2007 (see
`axisrig.bench.bus.can.frame.worst_case_bits`), sections 3 and 4, for frames with offsets.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from axisrig.bench.bus.can.frame import IFS_BITS, STANDARD_ID_MAX, arbitration_key, worst_case_bits
from axisrig.kernel.profiles.canopen.identifiers import SYNC_ID
from axisrig.kernel.time.clock import US, S, TimeNs


@dataclass(frozen=True)
class PlannedFrame:
    """A data frame of the cycle: who it is, identifier (above 0x7FF extended), 0..8 bytes."""

    name: str
    can_id: int
    data_bytes: int

    @property
    def key(self) -> int:
        """Arbitration field as a number; the smaller one wins."""
        return arbitration_key(self.can_id, self.can_id > STANDARD_ID_MAX, False)

    @property
    def bits(self) -> int:
        """Most bits it can take, with the intermission."""
        return worst_case_bits(self.data_bytes, self.can_id > STANDARD_ID_MAX)


SYNC = PlannedFrame("SYNC", SYNC_ID, 0)


@dataclass(frozen=True)
class CycleArithmetic:
    """Worst case of one cycle on one segment.

    last_tpdo_ns, last_rpdo_ns: latest delivery (end of frame) after the start of the cycle.
    rpdo_limit_ns: when that must be; the intermission then ends with the cycle.
    busy_ns: sum of the cyclic frames with their intermissions. event_ns: of the event frames.
    frames: (request, frame) in the order of the table.
    """

    bitrate: int
    cycle_ns: TimeNs
    cycle_offset_ns: TimeNs
    last_tpdo_ns: TimeNs
    last_rpdo_ns: TimeNs
    rpdo_limit_ns: TimeNs
    busy_ns: TimeNs
    event_ns: TimeNs
    frames: tuple[tuple[str, PlannedFrame], ...] = field(repr=False)

    @property
    def tpdos_in_time(self) -> bool:
        """Whether the NC cycle finds all TPDOs of its SYNC."""
        return self.last_tpdo_ns <= self.cycle_offset_ns

    @property
    def rpdos_in_time(self) -> bool:
        """Whether all RPDOs are there and the bus is free when the next SYNC is requested."""
        return self.last_rpdo_ns <= self.rpdo_limit_ns

    @property
    def fits(self) -> bool:
        """Whether the cycle holds in the worst case.

        Event frames need not fit into the cycle of their request: what is left over blocks the
        next cycle as one frame, which every cycle reckons with.
        """
        return self.tpdos_in_time and self.rpdos_in_time and self.busy_ns <= self.cycle_ns

    def table(self) -> str:
        """Show the arithmetic: every frame with its bits and time, then the three results."""
        lines = [
            f"{'request':<10}{'frame':<20}{'id':>10}{'bytes':>7}{'bits':>6}{'us':>9}{'sum us':>10}"
        ]
        bits = 0
        for request, frame in self.frames:
            bits += frame.bits
            lines.append(
                f"{request:<10}{frame.name:<20}{frame.can_id:>#10x}{frame.data_bytes:>7}"
                f"{frame.bits:>6}{frame.bits * S / US / self.bitrate:>9.1f}"
                f"{bits * S / US / self.bitrate:>10.1f}"
            )
        results = [
            ("last TPDO delivered", self.last_tpdo_ns, self.cycle_offset_ns, "NC cycle"),
            ("last RPDO delivered", self.last_rpdo_ns, self.rpdo_limit_ns, "next SYNC"),
            ("cyclic frames", self.busy_ns, self.cycle_ns, "cycle"),
        ]
        for what, time_ns, limit_ns, name in results:
            verdict = "in time" if time_ns <= limit_ns else f"{(time_ns - limit_ns) / US:.1f} over"
            lines.append(
                f"{what:<20}{time_ns / US:>8.1f} of {limit_ns / US:.1f} us ({name}): {verdict}"
            )
        return "\n".join(lines)


def cycle_arithmetic(
    bitrate: int,
    cycle_ns: TimeNs,
    cycle_offset_ns: TimeNs,
    tpdos: Sequence[PlannedFrame],
    rpdos: Sequence[PlannedFrame],
    events: Sequence[PlannedFrame] = (),
    sync: PlannedFrame = SYNC,
) -> CycleArithmetic:
    """Compute the worst case of a cycle; without PDOs their time is that of their request."""
    bits_at_offset = cycle_offset_ns * bitrate / S
    tpdo_bits = _last_tpdo_bits(bits_at_offset, sync, tpdos, rpdos, events)
    rpdo_bits = _last_rpdo_bits(bits_at_offset, tpdo_bits, sync, tpdos, rpdos, events)
    requests = (("0", [sync]), ("SYNC", tpdos), ("offset", rpdos), ("event", events))
    return CycleArithmetic(
        bitrate=bitrate,
        cycle_ns=cycle_ns,
        cycle_offset_ns=cycle_offset_ns,
        last_tpdo_ns=_delivery_ns(tpdo_bits, bitrate),
        last_rpdo_ns=_delivery_ns(rpdo_bits, bitrate) if rpdos else cycle_offset_ns,
        rpdo_limit_ns=cycle_ns - _duration_ns(IFS_BITS, bitrate),
        busy_ns=_duration_ns(_total([sync, *tpdos, *rpdos]), bitrate),
        event_ns=_duration_ns(_total(events), bitrate),
        frames=tuple(
            (request, frame)
            for request, frames in requests
            for frame in sorted(frames, key=lambda frame: frame.key)
        ),
    )


def _last_tpdo_bits(
    bits_at_offset: float,
    sync: PlannedFrame,
    tpdos: Sequence[PlannedFrame],
    rpdos: Sequence[PlannedFrame],
    events: Sequence[PlannedFrame],
) -> float:
    """End of the last TPDO in bit times after the request of SYNC, intermission included.

    SYNC and TPDOs follow each other without a gap, so at most one frame of lower priority, begun
    just before SYNC was requested, is in the way.
    """
    last = max([sync, *tpdos], key=lambda frame: frame.key)
    bits = _longest(_after(events, last)) + _total([sync, *tpdos, *_before(events, last)])
    if bits - last.bits >= bits_at_offset:
        bits += _total(_before(rpdos, last))
    return bits


def _last_rpdo_bits(
    bits_at_offset: float,
    tpdo_bits: float,
    sync: PlannedFrame,
    tpdos: Sequence[PlannedFrame],
    rpdos: Sequence[PlannedFrame],
    events: Sequence[PlannedFrame],
) -> float:
    """End of the last RPDO in bit times after the request of SYNC, intermission included.

    Either the bus has been busy with what goes first ever since SYNC, or that ended before the
    offset and only one frame of lower priority may have slipped in. The later end counts. Where
    that may be a TPDO, the TPDOs are late already, and the result is on the safe side.
    """
    if not rpdos:
        return bits_at_offset
    last = max(rpdos, key=lambda frame: frame.key)
    urgent = _total(_before(events, last)) + _total(rpdos)
    late_tpdos = _after(tpdos, last) if tpdo_bits > bits_at_offset else []
    slipped_in = _longest([*_after(events, last), *late_tpdos])
    since_sync = _longest(_after(events, last)) + _total([sync, *_before(tpdos, last)])
    return urgent + max(since_sync, bits_at_offset + slipped_in)


def _before(frames: Iterable[PlannedFrame], other: PlannedFrame) -> list[PlannedFrame]:
    """Frames that win against `other`."""
    return [frame for frame in frames if frame.key < other.key]


def _after(frames: Iterable[PlannedFrame], other: PlannedFrame) -> list[PlannedFrame]:
    """Frames that lose against `other`."""
    return [frame for frame in frames if frame.key > other.key]


def _total(frames: Iterable[PlannedFrame]) -> int:
    return sum(frame.bits for frame in frames)


def _longest(frames: Iterable[PlannedFrame]) -> int:
    return max((frame.bits for frame in frames), default=0)


def _duration_ns(bits: float, bitrate: int) -> TimeNs:
    """Bit times in ns, rounded up: a limit must not be met by rounding."""
    return -int(-bits * S // bitrate)


def _delivery_ns(bits: float, bitrate: int) -> TimeNs:
    """Give the end of frame that belongs to an end of the intermission."""
    return _duration_ns(bits - IFS_BITS, bitrate)
