"""What a write over the service channel does at its instant, with no telegram behind it."""

import struct
from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis
from tests.sercos.test_sercos_faults_by_hand import FOLLOW, SHORT, Hand

from axisrig.bench.drive.sercos.node import SercosDrive
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.profiles.sercos.service import Operation, ident_number, pack_list
from axisrig.kernel.time.clock import MS, US

MODE, TORQUE, SELECT, COMMAND, ENABLE = (
    "S-0-0032", "S-0-0092", "S-0-0169", "S-0-0170", "S-0-0405",
)  # fmt: skip
EDGE_NS = 10 * MS + 400 * US
V_M_S = 0.05


def word(number: int) -> bytes:
    return number.to_bytes(2, "little")


class Moving(Hand):
    """The axis goes 50 mm/s; its probe has one rising edge, 0.4 ms after a telegram."""

    def __init__(self) -> None:
        super().__init__((EDGE_NS,))
        self.axis: Any = self.drive.servo.axis
        self.axis.motion = lambda time_s: V_M_S * time_s

    def arm(self) -> None:
        for ident, value in ((SELECT, 1), (ENABLE, 1), (COMMAND, 3)):
            assert self.written(ident, word(value)) is None

    @property
    def place(self) -> int:
        """Increments at the edge, later by the delay of the input: 2^20 a turn of 10 mm."""
        latch_s = (EDGE_NS + self.drive.profile.input_delay_ns) * 1e-9
        return round(V_M_S * latch_s / 0.01 * (1 << 20))


@pytest.mark.parametrize("ends_by", ["enable", "cancel", "interrupt"])
def test_an_edge_before_the_probe_is_switched_off_is_latched_still(ends_by: str) -> None:
    """No telegram comes between the edge and the write; the value stays, the bit goes."""
    one = Moving()
    one.arm()
    one.cycle(0, 10)
    one.clock.run_until(EDGE_NS + 300 * US)
    if ends_by == "interrupt":
        one.drive.interrupt_probing()
    else:
        one.written(ENABLE if ends_by == "enable" else COMMAND, word(0))
    one.cycle(0, 2)
    assert one.number("S-0-0130") == one.place
    assert one.number("S-0-0409") == 0


def test_an_edge_after_the_probe_is_switched_off_is_none() -> None:
    one = Moving()
    one.arm()
    one.cycle(0, 10)
    assert one.written(ENABLE, word(0)) is None
    one.cycle(0, 2)
    assert (one.number("S-0-0130"), one.number("S-0-0409")) == (0, 0)


@pytest.mark.parametrize("phase", [AlState.SAFEOP, AlState.OP])
def test_a_probe_is_armed_by_the_write_and_not_by_the_next_telegram(phase: AlState) -> None:
    """In phase 3 no telegram of the master is taken."""
    one = Moving()
    one.drive.states.state = phase
    one.clock.run_until(EDGE_NS - 100 * US)
    one.arm()
    assert one.drive.servo.image.probe_function == 0x11
    one.clock.run_until(EDGE_NS + 300 * US)
    one.drive.servo.refresh(one.clock.now_ns)
    assert one.number("S-0-0409") == 1


class _Limited(FakeAxis):
    """An axis that records its time when its torque is limited, and the limit."""

    def __init__(self) -> None:
        super().__init__()
        self.taken: list[tuple[int, float]] = []

    def limit_force(self, negative_n: float, positive_n: float) -> None:
        super().limit_force(negative_n, positive_n)
        self.taken.append((self.now_ns, positive_n))


def test_a_torque_limit_acts_on_what_comes_after_it() -> None:
    """Up to the instant of the write the axis is stepped under the limit before it."""
    one = Hand()
    old = one.drive
    axis = _Limited()
    one.drive = SercosDrive("Z", one.clock, axis, (None, None), old.sercos)
    one.start()
    one.cycle(FOLLOW, 8)
    at_ns = one.clock.now_ns + 300 * US
    for limit in (200, 700):
        one.clock.run_until(at_ns)
        axis.taken.clear()
        assert one.written(TORQUE, word(limit)) is None
        rated_n = one.drive.profile.rated_force_n
        assert axis.taken
        assert all(taken == (at_ns, pytest.approx(limit / 1000 * rated_n)) for taken in axis.taken)
        at_ns += 400 * US


@pytest.mark.parametrize("phase", [AlState.PREOP, AlState.SAFEOP])
@pytest.mark.parametrize("brakes", [False, True])
def test_an_error_is_reset_where_no_telegram_comes(phase: AlState, brakes: bool) -> None:
    """In phases 2 and 3, on and on again; also while the axis brakes still."""
    one = Hand()
    for _ in range(2):
        one.drive.states.state = AlState.OP
        one.cycle(FOLLOW if brakes else 0, 8)
        one.drive.leave(AlState.OP, phase, "")
        one.drive.states.state = phase
        one.fault(SHORT)
        if brakes:
            assert one.drive.state is State.FAULT_REACTION_ACTIVE
        else:
            one.clock.run_until(one.clock.now_ns + 20 * MS)
            assert one.drive.state is State.FAULT
        assert one.written("S-0-0099", word(3)) is None
        assert one.state("S-0-0099") == ("RUNNING" if brakes else "DONE")
        one.clock.run_until(one.clock.now_ns + 20 * MS)
        assert (one.drive.state, one.state("S-0-0099")) == (State.SWITCH_ON_DISABLED, "DONE")
        assert (one.number("S-0-0011"), one.text()) == (0, "")
        assert one.drive.commands.has_changed
        assert one.written("S-0-0099", word(0)) is None
        assert one.drive.state is State.SWITCH_ON_DISABLED


@pytest.mark.parametrize("code", ["", "WATCHDOG"])
@pytest.mark.parametrize("phase", [AlState.PREOP, AlState.SAFEOP])
def test_no_write_switches_on_a_drive_that_has_left_phase_4(phase: AlState, code: str) -> None:
    """Its last control word had all bits; S-0-0134 counts no more, and is shown as 0."""
    one = Hand()
    one.cycle(FOLLOW, 8)
    assert one.number("S-0-0134") == FOLLOW
    one.drive.states.fall(phase, code)
    one.clock.run_until(one.clock.now_ns + 20 * MS)
    assert one.number("S-0-0134") == 0
    for ident, value in [("S-0-0099", 3), ("S-0-0099", 0), *[(TORQUE, 500)] * 8]:
        assert one.written(ident, word(value)) is None
        one.clock.run_until(one.clock.now_ns + 2 * MS)
        assert one.drive.state is State.SWITCH_ON_DISABLED
    one.drive.states.state = AlState.OP
    one.cycle(FOLLOW, 8)
    assert one.drive.state is State.OPERATION_ENABLED


@pytest.mark.parametrize("mode", [3, 11])
def test_either_primary_mode_follows_the_position_command(mode: int) -> None:
    """S-0-0032: 3 is position with feedback 1, 11 the same without lag; 11 at power on."""
    one = Hand()
    assert one.number(MODE) == 11
    one.drive.states.state = AlState.PREOP
    for number in (14 - mode, mode):
        assert one.written(MODE, word(number)) is None
    one.drive.states.state = AlState.OP
    one.cycle(FOLLOW, 8)
    assert one.drive.state is State.OPERATION_ENABLED
    for n in range(1, 40):
        one.clock.run_until(one.clock.now_ns + MS)
        servo = one.drive.servo
        servo.begin(one.clock.now_ns)
        one.drive.telegrams.take(servo.image, struct.pack("<Hi", FOLLOW, min(n, 20) * 1000))
        servo.cycle(one.clock.now_ns)
    assert one.number("S-0-0051") == pytest.approx(20_000, abs=1)
    assert one.number(MODE) == mode


@pytest.mark.parametrize("mode", [0, 1, 2, 4, 8, 10, 12])
def test_another_mode_is_refused_and_changes_nothing(mode: int) -> None:
    one = Hand()
    one.drive.states.state = AlState.PREOP
    assert one.written(MODE, word(mode)) == "INVALID"
    assert one.number(MODE) == 11


def test_a_check_that_is_cancelled_leaves_the_probing_cycle() -> None:
    """S-0-0128 and S-0-0170 are both of phase 3; each is cancelled for itself."""
    one = Hand()
    one.drive.states.state = AlState.SAFEOP
    for ident, value in ((SELECT, 1), (COMMAND, 3), ("S-0-0128", 3), ("S-0-0128", 0)):
        assert one.written(ident, word(value)) is None
    assert (one.state(COMMAND), one.drive.probing.is_running) == ("RUNNING", True)
    assert one.written("S-0-0099", word(3)) is None
    assert one.written("S-0-0099", word(0)) is None
    assert (one.state(COMMAND), one.drive.probing.is_running) == ("RUNNING", True)
    assert one.written("S-0-0128", word(3)) is None
    assert one.written(COMMAND, word(0)) is None
    assert (one.state("S-0-0128"), one.drive.probing.is_running) == ("DONE", False)


def test_of_several_disturbances_of_the_channel_the_first_that_says_something_counts() -> None:
    one = Hand()
    first, second = list[Any]([None, "NOT_NOW", None, "", None]), list[Any](["", "NO_IDENT", None])
    one.drive.disturb_channel(lambda: first.pop(0))
    one.drive.disturb_channel(lambda: second.pop(0))
    found = [one.ask(Operation.READ, "S-0-0014") for _ in range(5)]
    assert found == [None, "NOT_NOW", "NO_IDENT", None, word(4)]
    assert (first, second) == ([], [])


@pytest.mark.parametrize(
    ("listed", "layout"),
    [
        (("S-0-0080", "S-0-0047"), "<Hhi"),
        (("S-0-0047", "S-0-0080"), "<Hih"),
        (("S-0-0092", "S-0-0036", "S-0-0047"), "<HHii"),
    ],
)
def test_the_values_of_an_mdt_are_in_the_order_of_its_list(
    listed: tuple[str, ...], layout: str
) -> None:
    """S-0-0024; their lengths go with them."""
    one = Hand()
    one.drive.states.state = AlState.PREOP
    numbers = [ident_number(ident) for ident in listed]
    assert one.written("S-0-0024", pack_list(numbers, 2, len(numbers))) is None
    one.drive.telegrams.compile()
    given = {"S-0-0047": -70_000, "S-0-0080": -123, "S-0-0092": 65_000, "S-0-0036": 99_999}
    data = struct.pack(layout, 0, *(given[ident] for ident in listed))
    assert one.drive.telegrams.outputs.codec.size == len(data)
    one.drive.telegrams.take(one.drive.servo.image, data)
    for ident in listed:
        value = one.ask(Operation.READ, ident)
        assert isinstance(value, bytes)
        assert int.from_bytes(value, "little", signed=ident != "S-0-0092") == given[ident]


@pytest.mark.parametrize(
    ("listed", "layout"),
    [
        (("S-0-0390", "S-0-0051", "S-0-0179"), "<HIiH"),
        (("S-0-0179", "S-0-0390", "S-0-0051"), "<HHIi"),
        (("S-0-0084", "S-0-0390", "S-0-0040"), "<HhIi"),
    ],
)
def test_the_values_of_an_at_are_in_the_order_of_its_list(
    listed: tuple[str, ...], layout: str
) -> None:
    """S-0-0016; each is what the service channel has for it."""
    one = Hand(place_m=-0.0123)
    one.drive.states.state = AlState.PREOP
    numbers = [ident_number(ident) for ident in listed]
    assert one.written("S-0-0016", pack_list(numbers, 2, len(numbers))) is None
    one.drive.telegrams.compile()
    one.cycle(0, 2)
    data = one.drive.telegrams.message(one.drive.servo.image)
    _, *values = struct.unpack(layout, data)
    known = {"S-0-0390": 0xD0012, "S-0-0051": round(-1.23 * (1 << 20)), "S-0-0179": 0}
    for ident, value in zip(listed, values, strict=True):
        assert value == known.get(ident, 0)
