"""SOEM (pysoem) as the master of a drive and of a stamping terminal behind it on one line.

Arguments as those of `soem.py`; the last one is not used. Prints one JSON object.
"""

import struct
import sys

import pysoem
from probing import probed
from soem_cycle import cycle_with, end, lead_to_op

LATCHES, SIZE = 0x09AE, 34
said = {"stamps": []}


def main():
    interface, period_us, count, step = sys.argv[1], *map(int, sys.argv[2:5])
    master = pysoem.Master()
    master.open(interface)
    said["slaves"] = master.config_init()
    drive, terminal = master.slaves
    said["products"] = [slave.id for slave in master.slaves]
    drive.sdo_write(0x60C2, 1, struct.pack("B", period_us // 100))
    drive.sdo_write(0x60C2, 2, struct.pack("b", -4))
    master.config_map()
    said["has_clock"] = bool(master.config_dc())
    drive.dc_sync(True, period_us * 1000, 0)
    terminal._fpwr(0x09A8, bytes((3, 3)))
    said["safeop"] = master.state_check(pysoem.SAFEOP_STATE, 5_000_000)

    cycle = cycle_with(master, drive, period_us)
    lead_to_op(master, cycle)
    said["states"] = [slave.state for slave in master.slaves]
    touch = cycle.touch

    def touched(*arguments):
        found = touch(*arguments)
        _, _, up_ns, *_ = struct.unpack("<BB4Q", terminal._fprd(LATCHES, SIZE, 100_000))
        said["stamps"].append(up_ns)
        return found

    cycle.touch = touched
    said.update(probed(cycle, count, step))
    end(master, said)


main()
