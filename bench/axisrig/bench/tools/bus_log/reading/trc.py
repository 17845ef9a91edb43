"""TRC logs of PEAK tools, as python-can reads their frames; channels count from 0 as everywhere."""

from collections.abc import Iterator
from itertools import chain

import can

from axisrig.bench.tools.bus_log.reading.lines import Lines


def read_trc(lines: Lines) -> Iterator[can.Message]:
    """Yield the frames; lines of other types (states of the bus, error frames) are left out.

    Raises what the reader of python-can raises for a damaged log.
    """
    # That reader takes the line behind the head for a frame, also where it is empty or missing
    full = (line for line in lines if line.strip())
    head: list[str] = []
    for line in full:
        head.append(line)
        if not line.lstrip().startswith(";"):
            break
    else:
        return
    whole = (line for line in chain(head, full))  # a generator: the reader closes what it has read
    for message in can.TRCReader(whole):  # type: ignore[arg-type]
        if isinstance(message.channel, int):
            message.channel -= 1
        yield message
