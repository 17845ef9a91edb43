"""`axisrig bus` for files of EtherCAT lines: chooses what is shown of their frames."""

import heapq
from collections.abc import Iterator, Sequence
from pathlib import Path

from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.ethercat.pcapng import read_pcapng
from axisrig.bench.tools.bus_log.ethercat.words import LineNames
from axisrig.kernel.time.clock import MS


def tell_lines(
    paths: Sequence[Path], settings: Settings | None, selection: Selection
) -> Iterator[str]:
    """Yield a line for each datagram, and for each axis of a process image, that says new things.

    What is the same as the last time, and what each cycle has (times, states), needs `is_all`.
    """
    names, last = LineNames(settings), dict[tuple[str, str], str]()
    wanted = {word.strip().lower() for word in selection.only}
    for time_ns, segment, frame in heapq.merge(*map(read_pcapng, paths)):
        time_ms = time_ns / MS
        if time_ms > selection.to_ms:
            return
        for said in names.describe(segment, frame):
            is_old = said.is_usual or last.get((segment, said.name)) == said.text
            last[segment, said.name] = said.text
            if time_ms < selection.from_ms or (is_old and not selection.is_all):
                continue
            if wanted and not wanted & (said.tags | {said.name.lower()}):
                continue
            yield f"{time_ms:10.3f}  {segment:<6} {said.name:<16} {said.text}".rstrip()
