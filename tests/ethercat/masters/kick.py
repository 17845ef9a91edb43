"""KickCAT as the master of somebody else. Arguments as `soem.py`; the dictionary comes in a file.

Run by the interpreter that has kickcat; it imports nothing of axisrig. Prints one JSON object.
The wheel has no distributed clock and no list of objects.
"""

import json
import statistics
import struct
import sys
import time
from pathlib import Path

import kickcat
from kickcat import Access, State

ARM = 0x0011
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


class Cycle:
    def __init__(self, bus, slave, period_s):
        self.bus, self.slave, self.period_s = bus, slave, period_s
        self.next_s = time.perf_counter()
        self.trips, self.wrong = [], 0
        self.control = self.target = self.probe = 0
        self.word = self.position = self.status = self.latch = 0

    def __call__(self, count=1):
        for _ in range(count):
            sent = struct.pack("<HiH", self.control, self.target, self.probe)
            self.slave.set_output_bytes(sent)
            begin = time.perf_counter()
            try:
                self.bus.process_data()
            except Exception:
                self.wrong += 1
            self.trips.append(time.perf_counter() - begin)
            values = struct.unpack("<HiHiI", bytes(self.slave.input_data))
            self.word, self.position, self.status, self.latch, _ = values
            self.next_s = max(self.next_s + self.period_s, begin)
            time.sleep(max(0.0, self.next_s - time.perf_counter()))

    def enable(self):
        for control in (0x80, 0x06, 0x07, 0x0F):
            self.control = control
            for _ in range(200):
                self.target = self.position
                self(1)
        return self.word & 0x6F == 0x27

    def touch(self, step, most):
        begin = self.position
        self.probe = ARM
        self(10)
        armed = self.status
        self.target = self.position
        for _ in range(most):
            if self.status & 0x02:
                break
            self.target += step
            self(1)
        found = [armed, self.status, self.latch]
        while abs(self.target - begin) > abs(step):
            self.target -= step
            self(1)
        self.probe = 0
        self(20)
        return [*found, self.status]


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
    cycle = Cycle(bus, slave, period_us * 1e-6)
    slave.set_output_bytes(bytes(8))
    bus.request_state(State.OPERATIONAL)
    bus.wait_for_state(State.OPERATIONAL, 5.0, lambda: cycle(1))
    said["op"] = int(bus.get_state(slave).value)
    said["enabled"] = cycle.enable()
    said["touches"] = [cycle.touch(step, 5000) for _ in range(2)]
    cycle(max(0, count - len(cycle.trips)))
    trips = sorted(cycle.trips)
    said["cycles"], said["wrong"] = len(trips), cycle.wrong
    said["median_us"] = statistics.median(trips) * 1e6
    said["p99_us"], said["max_us"] = trips[int(0.99 * len(trips))] * 1e6, trips[-1] * 1e6
    print(json.dumps(said))


main()
