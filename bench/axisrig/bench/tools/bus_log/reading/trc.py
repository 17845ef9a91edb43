"""TRC logs of PEAK tools, as python-can reads their frames; channels count from 0 as everywhere."""

from collections.abc import Iterator

import can

from axisrig.bench.tools.bus_log.reading.lines import Lines


def read_trc(lines: Lines) -> Iterator[can.Message]:
    """Yield the frames; lines of other types (states of the bus, error frames) are left out.

    Raises what the reader of python-can raises for a damaged log.
    """
    # That reader takes the line behind the head for a frame, also an empty one or the last of all
    full = (line for line in lines if line.strip())
    head: list[str] = []
    for line in full:
        head.append(line)
        if not line.lstrip().startswith(";"):
            break
    else:
        return
    whole = (line for part in (head, full) for line in part)
    for message in can.TRCReader(whole):  # type: ignore[arg-type]
        if isinstance(message.channel, int):
            message.channel -= 1
        yield message
