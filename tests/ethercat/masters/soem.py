"""SOEM (pysoem) as the master of somebody else.

Arguments: interface, cycle in us, cycles, step of the target in increments per cycle, `dc` for a
distributed clock. Run by the interpreter that has pysoem; it imports nothing of axisrig. Prints one
JSON object.
"""

import struct
import sys

import pysoem
from probing import probed
from soem_cycle import cycle_with, end, lead_to_op

SKIPPED = (0x1010, 0x1011, 0x6040, 0x6060)
said = {}


def again(ask):
    """Ask; a frame that is back too late on a busy computer is asked for again, and counted."""
    for _ in range(4):
        try:
            return ask()
        except (pysoem.SdoInfoError, pysoem.MailboxError, pysoem.WkcError, pysoem.PacketError):
            said["again"] += 1
    return ask()


def read_and_write(slave):
    """Read each entry of the dictionary and write what was read where access says so."""
    said["again"] = 0
    objects = again(lambda: slave.od)
    said["objects"], said["read"], said["written"], said["refused"] = len(objects), 0, 0, []
    for described in objects:
        # pysoem gives a variable no entries: it is its own
        entries = again(lambda described=described: described.entries)
        for sub, entry in enumerate(entries or [described]):
            bits = again(lambda entry=entry: entry.bit_length)
            if not bits:
                continue
            try:
                value = again(lambda d=described, sub=sub: slave.sdo_read(d.index, sub))
                said["read"] += 1
                if entry.obj_access & 0x38 and described.index not in SKIPPED:
                    slave.sdo_write(described.index, sub, value)
                    said["written"] += 1
            except Exception as error:
                said["refused"].append(f"{described.index:04X}:{sub} {error}")


def main():
    interface, period_us, count, step = sys.argv[1], *map(int, sys.argv[2:5])
    has_clock = sys.argv[5] == "dc"
    master = pysoem.Master()
    master.open(interface)
    said["slaves"] = master.config_init()
    slave = master.slaves[0]
    said["identity"] = [slave.name, slave.man, slave.id, slave.rev]
    said["eeprom"] = b"".join(slave.eeprom_read(n) for n in range(0, 1024, 2)).hex()
    read_and_write(slave)
    slave.sdo_write(0x60C2, 1, struct.pack("B", period_us // 100))
    slave.sdo_write(0x60C2, 2, struct.pack("b", -4))
    said["image"] = master.config_map()
    said["has_clock"] = bool(master.config_dc())
    if has_clock:
        slave.dc_sync(True, period_us * 1000, 0)
    said["safeop"] = master.state_check(pysoem.SAFEOP_STATE, 5_000_000)

    cycle = cycle_with(master, slave, period_us)
    lead_to_op(master, cycle)
    said["op"], said["al"] = slave.state, slave.al_status
    said.update(probed(cycle, count, step))
    end(master, said)


main()
