"""`axisrig bus` for files of EtherCAT lines: chooses what is shown of their frames."""

import heapq
from collections.abc import Iterator, Sequence
from pathlib import Path

from axisrig.bench.rig.ethercat.members import ec_segments
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.bus_log.choice.channels import Channels
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.ethercat.words import LineNames
from axisrig.bench.tools.bus_log.reading.pcapng import read_packets
from axisrig.bench.tools.bus_log.reading.progress import Progress
from axisrig.kernel.time.clock import MS


def tell_lines(
    paths: Sequence[Path],
    settings: Settings | None,
    selection: Selection,
    progress: Progress | None = None,
) -> Iterator[str]:
    """Yield a line for each datagram, and for each axis of a process image, that says new things.

    progress: counts what was read. What is the same as the last time, and what each cycle has
    (times, states), needs `is_all`.
    """
    progress = progress or Progress()
    names, last = LineNames(settings), dict[tuple[str, str], str]()
    wanted = {word.strip().lower() for word in selection.only}
    channels = Channels(
        ec_segments(settings) if settings is not None else [],
        selection.segments,
        lambda: {packet.interface for path in paths for packet in read_packets(path)},
    )
    for time_ns, interface, _, frame in heapq.merge(*map(read_packets, paths)):
        progress.frames += 1
        time_ms = time_ns / MS
        segment = channels.segment(interface)
        yield from channels.notes()
        for described in names.describe(segment, frame):
            is_old = described.is_usual or last.get((segment, described.name)) == described.text
            last[segment, described.name] = described.text
            is_inside = selection.from_ms <= time_ms <= selection.to_ms
            if not is_inside or (is_old and not selection.is_all):
                continue
            if wanted and not wanted & (described.tags | {described.name.lower()}):
                continue
            yield f"{time_ms:10.3f}  {segment:<6} {described.name:<16} {described.text}".rstrip()
