"""Limit and home switches that are wired to a SERCOS drive, and others that follow its states."""

import struct

import pytest
from tests.drive_node.conftest import FakeAxis, FakeSignal
from tests.sercos.test_sercos_faults_by_hand import ENABLE, ON, RUN, Hand

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.sercos.node import SercosDrive
from axisrig.bench.drive.sercos.profiles import make_profile
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

BITS = {"negative": 0b001, "positive": 0b010, "home": 0b100}
"""Of the digital inputs, as 60FD has them (CiA 402-2)."""


class Wired(Hand):
    """A drive with switches: their edges, ns; a switch begins off. states: those it has taken."""

    def __init__(self, edges_ns: dict[str, tuple[int, ...]], profile: str = "one_probe") -> None:
        self.clock = new_scheduler()
        self.states: list[State] = []
        axis = FakeAxis(0.0)
        self.drive = SercosDrive(
            "Z", self.clock, axis, (None, None),
            make_profile(profile, DriveProfile(), "rotary", 1 << 20),
            switches={name: FakeSignal(axis, edges) for name, edges in edges_ns.items()},
            entered=self.states.append,
        )  # fmt: skip
        self.start()

    def inputs(self, until_ms: int) -> int:
        while self.clock.now_ns < until_ms * MS:
            self.cycle(0)
        return self.drive.servo.image.digital_inputs & 0b111


@pytest.mark.parametrize("profile", ["one_probe", "two_probes"])
@pytest.mark.parametrize("name", BITS)
def test_a_switch_is_its_own_bit_while_it_is_on(name: str, profile: str) -> None:
    """On from 3 to 8 ms."""
    one = Wired({name: (3 * MS, 8 * MS)}, profile)
    assert [one.inputs(ms) for ms in (2, 5, 7, 10, 12)] == [0, BITS[name], BITS[name], 0, 0]


def test_each_switch_has_its_own_edges() -> None:
    one = Wired({"negative": (3 * MS,), "positive": (6 * MS,), "home": (9 * MS, 12 * MS)})
    assert [one.inputs(ms) for ms in (2, 5, 8, 11, 14)] == [0, 0b001, 0b011, 0b111, 0b011]


def test_a_drive_without_switches_has_none_on() -> None:
    assert Wired({}).inputs(5) == 0


@pytest.mark.parametrize("on", [(), ("negative",), ("positive",), ("home",), tuple(BITS)])
def test_the_home_switch_is_the_ident_of_that_name(on: tuple[str, ...]) -> None:
    """S-0-0400 is 1 while the home switch is on, whatever the limit switches are."""
    one = Wired(dict.fromkeys(on, (3 * MS, 8 * MS)))
    found = []
    for ms in (2, 6, 11):
        one.inputs(ms)
        found.append(one.number("S-0-0400"))
    assert found == [0, int("home" in on), 0]


@pytest.mark.parametrize("name", ["negative", "positive"])
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_limit_switch_stops_the_way_to_it_and_no_other(name: str, sign: int) -> None:
    """From 100 ms on, that is after 9 mm at 0.1 mm in a millisecond; the others go 19.9 mm."""
    one = Wired({name: (100 * MS,)})
    per_mm = float(one.drive.profile.units_per_mm)
    one.cycle(ON | ENABLE | RUN, 10)
    assert one.drive.state is State.OPERATION_ENABLED
    for n in range(1, 200):
        one.clock.run_until(one.clock.now_ns + MS)
        servo = one.drive.servo
        servo.begin(one.clock.now_ns)
        set_units = sign * round(0.1 * n * per_mm)
        word = ON | ENABLE | RUN
        one.drive.telegrams.take(servo.image, struct.pack("<Hi", word, set_units))
        servo.cycle(one.clock.now_ns)
    gone_mm = one.drive.servo.image.position_actual / per_mm * sign
    is_met = (name == "positive") is (sign > 0)
    assert 8.0 < gone_mm < 12.0 if is_met else gone_mm == pytest.approx(19.9, abs=0.11)
    assert one.drive.servo.image.digital_inputs & 0b111 == BITS[name]


def test_who_follows_the_states_hears_each_of_them_once() -> None:
    one = Wired({})
    one.states.clear()
    one.cycle(ON | ENABLE | RUN, 10)
    assert one.states == [State.READY_TO_SWITCH_ON, State.SWITCHED_ON, State.OPERATION_ENABLED]
    one.states.clear()
    one.cycle(0, 10)
    assert one.states == [State.SWITCH_ON_DISABLED]
