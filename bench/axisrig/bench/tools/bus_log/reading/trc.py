"""TRC logs of PEAK tools, as python-can reads their frames; channels count from 0 as everywhere."""

from collections.abc import Iterator

import can

from axisrig.bench.tools.bus_log.reading.lines import Lines


def read_trc(lines: Lines) -> Iterator[can.Message]:
    """Yield the frames; lines of other types (states of the bus, error frames) are left out.

    Raises what the reader of python-can raises for a damaged log.
    """
    for message in can.TRCReader(lines):  # type: ignore[arg-type]
        if isinstance(message.channel, int):
            message.channel -= 1
        yield message
