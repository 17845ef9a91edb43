"""KickCAT as the master of somebody else. Arguments as `soem.py`, then a file of the dictionary.

Run by the interpreter that has kickcat; it imports nothing of axisrig. Prints one JSON object.
The wheel has no distributed clock and no list of objects.
"""

import json
import struct
import sys
import time
from pathlib import Path

import kickcat
from kickcat import Access, State
from probing import Cycle, probed

said = {}


def read(bus, slave, index, sub):
    """Read a value; a frame that comes back too late is asked for again, and counted."""
    for left in (2, 1, 0):
        try:
            return bus.read_sdo(slave, index, sub, Access.PARTIAL, 256, 1.0)
        except RuntimeError as error:
            if not left or "checking mailboxes" not in str(error):
                raise
            said["again"] += 1


def read_and_write(bus, slave, objects):
    said["objects"], said["read"], said["written"], said["again"] = len(objects), 0, 0, 0
    said["refused"] = []
    for index, sub, may_write in objects:
        try:
            value = read(bus, slave, index, sub)
            said["read"] += 1
            if may_write:
                message = slave.mailbox.write_sdo(index, sub, False, value, 1.0)
                end_s = time.perf_counter() + 1
                while message.status() == 1 and time.perf_counter() < end_s:
                    bus.process_mailboxes()
                if message.status():
                    said["refused"].append(f"{index:04X}:{sub} {message.status():#x}")
                said["written"] += not message.status()
        except Exception as error:
            said["refused"].append(f"{index:04X}:{sub} {error}")


def main():
    interface, period_us, count, step = sys.argv[1], *map(int, sys.argv[2:5])
    objects = json.loads(Path(sys.argv[6]).read_text())
    link = kickcat.create_link(interface, "")
    link.set_timeout(0.05)  # it waits so long after each broadcast, whether it is back or not
    bus = kickcat.Bus(link)
    bus.init(1.0)
    said["slaves"] = len(bus.slaves())
    slave = bus.slaves()[0]
    read_and_write(bus, slave, objects)
    for sub, value in ((1, struct.pack("B", period_us // 100)), (2, struct.pack("b", -4))):
        message = slave.mailbox.write_sdo(0x60C2, sub, False, value, 1.0)
        while message.status() == 1:
            bus.process_mailboxes()
    bus.create_mapping(4096)
    said["image"] = slave.input_size + slave.output_size
    bus.request_state(State.SAFE_OP)
    bus.wait_for_state(State.SAFE_OP, 5.0)

    def exchange(sent):
        slave.set_output_bytes(sent)
        try:
            bus.process_data()
        except Exception:  # of a working counter
            return bytes(slave.input_data), False
        return bytes(slave.input_data), True

    cycle = Cycle(exchange, period_us * 1e-6)
    slave.set_output_bytes(bytes(8))
    bus.request_state(State.OPERATIONAL)
    bus.wait_for_state(State.OPERATIONAL, 5.0, lambda: cycle(1))
    said["op"] = int(bus.get_state(slave).value)
    said.update(probed(cycle, count, step))
    print(json.dumps(said))


main()
