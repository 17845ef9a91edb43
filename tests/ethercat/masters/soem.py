"""SOEM (pysoem) as the master of somebody else. Arguments: interface, cycle in us, cycles, places.

Run by the interpreter that has pysoem; it imports nothing of axisrig. Prints one JSON object.
places: JSON of targets, see `touch`.
"""

import json
import statistics
import struct
import sys
import time

import pysoem

SKIPPED = (0x1010, 0x1011, 0x6040, 0x6060)
ARM = 0x0011  # probe 1, its first positive edge
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


class Cycle:
    """Exchanges process data at its time, and counts."""

    def __init__(self, master, slave, period_s):
        self.master, self.slave, self.period_s = master, slave, period_s
        self.next_s = time.perf_counter()
        self.trips, self.wrong = [], 0
        self.control, self.target, self.probe = 0, 0, 0
        self.word = self.position = self.status = self.latch = 0

    def __call__(self, count=1):
        for _ in range(count):
            self.slave.output = struct.pack("<HiH", self.control, self.target, self.probe)
            begin = time.perf_counter()
            self.master.send_processdata()
            counter = self.master.receive_processdata(100_000)
            self.trips.append(time.perf_counter() - begin)
            self.wrong += counter != self.master.expected_wkc
            values = struct.unpack("<HiHiI", self.slave.input)
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
        """Arm, go until the edge is stored, disarm, go back; the latched position."""
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
    cycle = Cycle(master, slave, period_us * 1e-6)
    cycle(1)
    master.state = pysoem.OP_STATE
    master.write_state()
    end_s = time.perf_counter() + 5
    while master.state_check(pysoem.OP_STATE, 1000) != pysoem.OP_STATE:
        cycle(1)
        if time.perf_counter() > end_s:
            break
    master.read_state()
    said["op"], said["al"] = slave.state, slave.al_status
    said["enabled"] = cycle.enable()
    said["touches"] = [cycle.touch(step, 5000) for _ in range(2)]
    cycle(max(0, count - len(cycle.trips)))
    trips = sorted(cycle.trips)
    said["cycles"], said["wrong"] = len(trips), cycle.wrong
    said["median_us"] = statistics.median(trips) * 1e6
    said["p99_us"], said["max_us"] = trips[int(0.99 * len(trips))] * 1e6, trips[-1] * 1e6
    master.state = pysoem.INIT_STATE
    master.write_state()
    master.close()
    print(json.dumps(said))


main()
