"""Modes of CiA 402 in the process image of a drive on EtherCAT: what they do is the same as on CAN.

The axis follows its demand exactly, and a force moves its mass without friction. What a mode does
in its own tests on CAN is not done again here; the set values come with the frames alone.
"""

import math
import struct
from itertools import pairwise

import pytest
from tests.ethercat.line import OP, SAFEOP, Line
from tests.ethercat.sync_signals import start_sync

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.time.clock import MS

PP, PV, HM, CSP, CSV, CST = 1, 3, 6, 8, 9, 10
PER_M = float(DriveProfile().units_per_mm) * 1000
REACHED, BIT_12 = 1 << 10, 1 << 12
ENABLED = 0x0F


class Led(Line):
    """A drive with 1600 and 1601 and SYNC0 of 1 ms, in operation enabled in one mode."""

    def __init__(self, mode: int, **objects: float) -> None:
        super().__init__()
        self.preop()
        for sub, value in ((0, 0), (1, 0x1600), (2, 0x1601), (0, 2)):
            assert self.sdo_write(0x1C12, sub, value, 2 if sub else 1) == 0
        assert self.sdo_write(0x6060, 0, mode, 1) == 0
        for name, wanted in objects.items():
            index, _, size = name.removeprefix("o").partition("_")
            assert self.sdo_write(int(index, 16), 0, round(wanted), int(size)) == 0
        self.map_image(0, 14, 16)
        start_sync(self, MS)
        assert self.ask(SAFEOP) == (SAFEOP, 0)
        self.wait(10 * MS)
        self.send()
        self.write(0x0120, OP, 2)
        pulses = self.drive.sync.pulses
        self.clock.run_while(lambda: self.drive.sync.pulses == pulses, 100 * MS)
        self.wait(MS // 2)
        self._next_ns = self.clock.now_ns
        for control in (0x06, 0x07, ENABLED, ENABLED):
            self.step(control)
        assert self.step(ENABLED)[0] & 0x6F == 0x27

    def send(
        self, control: int = 0, target: int = 0, velocity: int = 0, torque: int = 0
    ) -> tuple[int, int]:
        """One frame; statusword and position."""
        sent = struct.pack("<HiHih", control, target, 0, velocity, torque) + bytes(16)
        answer = self.exchange((12, 0, sent))[0]
        assert answer.wkc == 3
        status, position = struct.unpack_from("<Hi", answer.data, 14)
        return status, position

    def step(self, control: int, **values: int) -> tuple[int, int]:
        """The same at the next instant of the grid, half a period off SYNC0."""
        self._next_ns += MS
        self.clock.run_until(self._next_ns)
        return self.send(control, **values)

    def steps(self, count: int, control: int, **values: int) -> list[tuple[int, int]]:
        return [self.step(control, **values) for _ in range(count)]


def changes(seen: list[tuple[int, int]]) -> list[int]:
    places = [position for _, position in seen]
    return [after - before for before, after in pairwise(places)]


@pytest.mark.parametrize("way", [pytest.param(0.01, marks=pytest.mark.long), -0.004])
def test_a_set_point_of_the_image_is_reached_on_its_profile(way: float) -> None:
    """v = 0.1 m/s, a = d = 5 m/s2: way/v + v/a, and no cycle before."""
    v, a = 0.1, 5.0
    line = Led(PP, o6081_4=v * PER_M, o6083_4=a * PER_M, o6084_4=a * PER_M)
    target = round(way * PER_M)
    takes_ms = (abs(way) / v + v / a) * 1e3
    seen = line.steps(math.ceil(takes_ms) + 10, 0x1F, target=target)
    assert seen[2][0] & BIT_12  # the set-point is acknowledged
    first = next(n for n, (status, _) in enumerate(seen) if n > 3 and status & REACHED)
    # A value acts at the SYNC0 after its frame, and what is sampled leaves with the next frame
    assert takes_ms <= first <= takes_ms + 4
    assert seen[-1][1] == target
    top = max(map(abs, changes(seen)))
    assert top == pytest.approx(v * PER_M * 1e-3, abs=2)


@pytest.mark.long
def test_a_velocity_over_its_ramp() -> None:
    """Of each cycle: a T2 more until v T, then v T."""
    v, a = 0.05, 5.0
    line = Led(PV, o6083_4=a * PER_M, o6084_4=a * PER_M)
    seen = changes(line.steps(40, ENABLED, velocity=round(v * PER_M)))
    assert seen[-1] == pytest.approx(v * PER_M * 1e-3, abs=1)
    ramp = [step for step in seen if abs(step) > 2 and step < 0.95 * v * PER_M * 1e-3]
    gains = [after - before for before, after in pairwise(ramp)]
    assert len(ramp) == pytest.approx(v / a * 1e3, abs=2)
    assert gains == pytest.approx([a * PER_M * 1e-6] * len(gains), abs=3)


def test_a_cyclic_velocity_is_reached_one_cycle_later() -> None:
    line = Led(CSV)
    v = 0.08
    seen = changes(line.steps(20, ENABLED, velocity=round(v * PER_M)))
    assert seen[6:] == pytest.approx([v * PER_M * 1e-3] * len(seen[6:]), abs=1)
    assert seen[0] == 0
    back = changes(line.steps(20, ENABLED, velocity=round(-v * PER_M)))
    assert back[6:] == pytest.approx([-v * PER_M * 1e-3] * len(back[6:]), abs=1)


@pytest.mark.parametrize("share", [50, -20])
def test_a_cyclic_torque_accelerates_the_mass(share: int) -> None:
    """F = 2 pi T / lead, a = F / m: in each cycle a T2 more."""
    line = Led(CST)
    (rated,) = struct.unpack("<I", line.sdo_read(0x6076, 0))
    lead_m = 0.01  # feed of a revolution, where the profile says nothing else
    a = 2 * math.pi * rated * 1e-3 * share / 1000 / lead_m / line.axes[0].mass_kg
    seen = changes(line.steps(20, ENABLED, torque=share))
    gains = [after - before for before, after in pairwise(seen)][4:]
    assert gains == pytest.approx([a * PER_M * 1e-6] * len(gains), abs=2.1)


def test_homing_by_the_image() -> None:
    """Method 37: the place at rest is home, and has the position that the offset gives it."""
    line = Led(HM, o6098_1=37, o607C_4=-5000)
    seen = line.steps(30, 0x1F)
    assert seen[-1][0] & 0x3400 == BIT_12 | REACHED
    assert seen[-1][1] == 5000
