"""SYNC signals of a slave, as a master sets them up."""

import struct

from tests.ethercat.line import Line

from axisrig.kernel.time.clock import MS

APRD, APWR = 1, 2


def start_sync(line: Line, cycle_ns: int, after_ns: int = 5 * MS, activation: int = 3) -> int:
    """Let SYNC0 begin; return the system time of the first one."""
    now = line.one(APRD, 0, 0x0910, 8).number
    first = (now + after_ns) // cycle_ns * cycle_ns + cycle_ns // 4
    line.one(APWR, 0, 0x0990, struct.pack("<Q", first))
    line.write(0x09A0, cycle_ns, 4)
    line.write(0x0980, activation << 8, 2)
    return first
