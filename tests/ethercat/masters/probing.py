"""What a master does in OP, whichever it is: lead the drive, touch twice, report.

Imports nothing of axisrig, and no master: the interpreter of a master runs it.
"""

import statistics
import struct
import time

ARM = 0x0011  # probe 1, its first positive edge
OUTPUTS = struct.Struct("<HiH")  # 6040 controlword, 607A target position, 60B8 probe function
INPUTS = struct.Struct("<HiHiI")  # 6041, 6064, 60B9 probe status, 60BA latch, 60FD inputs


class Cycle:
    """Exchanges process data at its time, and counts.

    exchange: sends the outputs; returns the inputs, and whether the working counter was right.
    """

    def __init__(self, exchange, period_s):
        self.exchange, self.period_s = exchange, period_s
        self.next_s = time.perf_counter()
        self.trips_s, self.wrong = [], 0
        self.control = self.target = self.probe = 0
        self.word = self.position = self.status = self.latch = 0

    def __call__(self, count=1):
        for _ in range(count):
            begin_s = time.perf_counter()
            received, is_right = self.exchange(OUTPUTS.pack(self.control, self.target, self.probe))
            self.trips_s.append(time.perf_counter() - begin_s)
            self.wrong += not is_right
            self.word, self.position, self.status, self.latch, _ = INPUTS.unpack(received)
            self.next_s = max(self.next_s + self.period_s, begin_s)
            time.sleep(max(0.0, self.next_s - time.perf_counter()))

    def enable(self):
        """Lead the drive to operation enabled; whether it is there."""
        for control in (0x80, 0x06, 0x07, 0x0F):
            self.control = control
            for _ in range(200):
                self.target = self.position
                self(1)
        return self.word & 0x6F == 0x27

    def touch(self, step, most):
        """Arm, go until the edge is stored, disarm, go back.

        step: increments per cycle. most: cycles. Returns the probe status armed, stored and
        disarmed, with the latched position before the last.
        """
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


def probed(cycle, count, step):
    """Touch twice and go on until `count` cycles are over; what came of it, in names and values."""
    enabled = cycle.enable()
    touches = [cycle.touch(step, 5000) for _ in range(2)]
    cycle(max(0, count - len(cycle.trips_s)))
    trips_us = sorted(1e6 * trip_s for trip_s in cycle.trips_s)
    return {
        "enabled": enabled,
        "touches": touches,
        "cycles": len(trips_us),
        "wrong": cycle.wrong,
        "median_us": statistics.median(trips_us),
        "p99_us": trips_us[int(0.99 * len(trips_us))],
        "max_us": trips_us[-1],
    }
