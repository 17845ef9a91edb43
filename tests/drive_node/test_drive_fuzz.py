"""Whatever a master writes, in whatever order: the drive never breaks and never lies about power.

Words, targets, parameters and modes come over SDO and, where a PDO may carry them, past every check
of the SDO server; the axis follows, is stuck or runs away.
"""

import math
import random
from collections.abc import Callable
from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.servo import Servo
from axisrig.kernel.drives.cia402.words import state_of
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

PER_M = 104_857_600
Make = Callable[..., Any]
POWER = {State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE, State.FAULT_REACTION_ACTIVE}
WORDS = [0x00, 0x02, 0x06, 0x07, 0x0F, 0x1F, 0x3F, 0x5F, 0x7F, 0x10F, 0x11F, 0x80, 0x8F]
ROWS = [r for k, r in variables().items() if k[0] >= 0x6000 and r.access == "rw" and r.value]
BY_NAME = {row.value: row for row in ROWS}
FROM_PDO = [row.value for row in ROWS if row.pdo == "rx"]
BITS = {"U8": (8, False), "I8": (8, True), "U16": (16, False), "I16": (16, True),
        "U32": (32, False), "I32": (32, True)}  # fmt: skip
MOTIONS = [None, lambda t: 0.0, lambda t: 3.0 * t, lambda t: 0.1 * math.sin(50 * t)]


def values(row: Any, checked: bool) -> st.SearchStrategy[int]:
    bits, signed = BITS[row.type]
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    if checked:
        if row.allowed.ranges is not None:
            return st.sampled_from(sorted(v for r in row.allowed.ranges for v in r))
        low = max(low, row.low) if row.low is not None else low
        high = min(high, row.high) if row.high is not None else high
    edges = [v for v in (low, high, low + 1, 0, 1, 1000) if low <= v <= high]
    return st.one_of(st.sampled_from(edges), st.integers(low, high))


def write(name: str, checked: bool) -> st.SearchStrategy[tuple[str, str, int]]:
    kind = "sdo" if checked else "pdo"
    return values(BY_NAME[name], checked).map(lambda value: (kind, name, value))


STEPS = st.lists(
    st.one_of(
        st.sampled_from(WORDS).map(lambda word: ("word", "", word)),
        st.sampled_from([1, 3, 6, 8, 9, 10]).map(lambda mode: ("mode", "", mode)),
        st.sampled_from(list(BY_NAME)).flatmap(lambda name: write(name, True)),
        st.sampled_from(FROM_PDO).flatmap(lambda name: write(name, False)),
        st.integers(1, 5).map(lambda count: ("syncs", "", count)),
        st.sampled_from([100, 250, 3000]).map(lambda time_us: ("wait", "", time_us)),
        st.sampled_from([0x2310, 0x8130]).map(lambda code: ("fault", "", code)),
        st.just(("lost", "", 0)),
    ),
    min_size=5,
    max_size=40,
)


class Bare:
    """A servo without a bus, and the checks of an SDO server in front of it."""

    def __init__(self, axis: Any) -> None:
        self.clock, self.axis = new_scheduler(), axis
        self.emergencies: list[int] = []
        self.servo = Servo(
            axis,
            (None, None),
            DriveProfile(),
            lambda code, _register, _info: self.emergencies.append(code),
            self.clock,
            lambda: None,
        )
        self.servo.reset(0)

    def sync(self) -> None:
        self.clock.run_until(self.clock.now_ns + 1 * MS)
        self.servo.begin(self.clock.now_ns)
        self.servo.cycle(self.clock.now_ns)

    def do(self, step: tuple[str, str, int]) -> None:
        kind, name, value = step
        servo, now_ns = self.servo, self.clock.now_ns
        if kind == "word":
            servo.image.controlword = value
            self.sync()
        elif kind == "mode":
            servo.image.mode = value
            self.sync()
        elif kind == "pdo":
            setattr(servo.image, name, value)
            self.sync()
        elif kind == "sdo" and servo.refuses(BY_NAME[name].index, value) is None:
            if name == "probe_function" and not servo.touch_probe.supports(value):
                return
            servo.begin(now_ns)
            setattr(servo.image, name, value)
            servo.update()
            servo.react(now_ns)
        elif kind == "syncs":
            for _ in range(value):
                self.sync()
        elif kind == "wait":
            self.clock.run_until(now_ns + value * US)
        elif kind == "fault":
            servo.fault(value, 0x01, now_ns)
        elif kind == "lost":
            servo.connection_lost(now_ns)

    def check(self) -> None:
        servo = self.servo
        servo.refresh(self.clock.now_ns)
        assert state_of(servo.image.statusword) is servo.state
        has_power = self.axis.commands[-1].enabled
        assert not has_power or servo.state in POWER
        assert has_power or servo.state is not State.OPERATION_ENABLED
        last = self.axis.commands[-1]
        numbers = (last.position_m, last.velocity_m_s, last.acceleration_m_s2, last.force_n)
        assert all(math.isfinite(number) for number in numbers)


@pytest.mark.parametrize("kinds", [frozenset(ControlKind), frozenset({ControlKind.POSITION})])
@settings(max_examples=60, suppress_health_check=list(HealthCheck))
@given(steps=STEPS, motion=st.sampled_from(MOTIONS))
@pytest.mark.long
def test_no_order_of_writes_breaks_the_drive(
    fake_axis: Any, kinds: frozenset[ControlKind], steps: list[Any], motion: Any
) -> None:
    axis = fake_axis(motion=motion)
    axis.kinds = kinds
    bare = Bare(axis)
    for word in (0x06, 0x07, 0x0F):
        bare.do(("word", "", word))
    for step in steps:
        bare.do(step)
        bare.check()
    # However it ended: disable voltage takes the power away, a fault with a reset before
    bare.do(("sdo", "fault_option", 0))
    for word in (0x00, 0x00, 0x80, 0x00):
        bare.do(("word", "", word))
        bare.clock.run_until(bare.clock.now_ns + 3000 * MS)
    bare.check()
    image = bare.servo.image
    slowest = min(image.profile_deceleration, image.quick_stop_deceleration, image.max_deceleration)
    if bare.servo.state is State.FAULT_REACTION_ACTIVE and slowest < PER_M:
        return  # it brakes as slowly as it was told to, and takes no command meanwhile
    assert not axis.commands[-1].enabled
    for word in (0x80, 0x00, 0x06, 0x07):
        bare.do(("word", "", word))
    assert bare.servo.state is State.SWITCHED_ON


@pytest.mark.long
def test_the_same_over_the_bus_in_one_long_run(drive_bench: Make) -> None:
    """A seeded walk through SDO with every object and any value: aborts are answers, no errors."""
    rng = random.Random(402)
    bench = drive_bench()
    bench.operational()
    sdo = bench.remote.sdo
    aborted = 0
    for _ in range(600):
        row = rng.choice(ROWS)
        bits, _ = BITS[row.type]
        value = rng.getrandbits(bits) if rng.random() < 0.5 else rng.choice([0, 1, 2, 8, 15])
        value &= (1 << bits) - 1
        try:
            sdo.download(row.index, row.sub or 0, value.to_bytes(bits // 8, "little"))
        except SdoAbortedError:
            aborted += 1
        bench.set_values(rng.choice(WORDS), rng.getrandbits(31))
        bench.sync_at_ms(bench.scheduler.now_ns // MS + 1)
        status = int.from_bytes(bench.frames(0x183)[-1][:2], "little")
        assert state_of(status) is not None
    assert 0 < aborted < 600


@pytest.mark.parametrize("mode", [1, 3, 6, 8])
def test_an_acceleration_of_0_in_a_pdo_breaks_nothing(fake_axis: Any, mode: int) -> None:
    """SDO refuses it (low limit 1); a PDO brings it past that check: it counts as 1 unit/s2."""
    bare = Bare(fake_axis())
    bare.servo.image.mode = mode
    for word in (0x06, 0x07, 0x0F):
        bare.do(("word", "", word))
    bare.do(("pdo", "target_velocity", PER_M))
    bare.do(("pdo", "target_position", PER_M))
    for word in (0x1F, 0x0F):
        bare.do(("word", "", word))
    for name in ("profile_acceleration", "profile_deceleration", "homing_acceleration",
                 "homing_speed_switch", "homing_speed_zero"):  # fmt: skip
        bare.do(("pdo", name, 0))
    for word in (0x3F, 0x10F, 0x0F, 0x1F, 0x07, 0x00):
        bare.do(("word", "", word))
        bare.check()
