"""What a master sets at a SERCOS drive and sets back: window of the lag, units, phase checks."""

import struct

import pytest
from tests.sercos.test_scaling_of_a_drive import EXPONENT, FACTOR, Scaled
from tests.sercos.test_sercos_faults_by_hand import FOLLOW, Hand

from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.profiles.sercos.service import Operation, ident_number, pack_list, read_list

WINDOW, DISTANCE, TORQUE = "S-0-0159", "S-0-0189", "S-0-0092"


def _u32(value: int) -> bytes:
    return value.to_bytes(4, "little")


class Standing(Hand):
    """A drive whose axis stands at 0, whatever it is led to."""

    def __init__(self) -> None:
        super().__init__()
        self.drive.servo.axis.motion = lambda _time_s: 0.0  # type: ignore[attr-defined]
        for _ in range(8):
            self.cycle(FOLLOW)

    def lead(self, target: int, count: int) -> int:
        """Lead it to a position for so many cycles; return the error of class 1."""
        telegrams, servo = self.drive.telegrams, self.drive.servo
        for _ in range(count):
            self.clock.run_until(self.clock.now_ns + 1_000_000)
            servo.begin(self.clock.now_ns)
            telegrams.take(servo.image, struct.pack("<Hi", FOLLOW, target))
            servo.cycle(self.clock.now_ns)
        return self.number("S-0-0011")


@pytest.mark.parametrize("sign", [1, -1])
def test_a_window_of_0_watches_no_lag(sign: int) -> None:
    """S-0-0159: 0 at power on, and 0 again after another one; it is shown as it was written."""
    one = Standing()
    assert one.number(WINDOW) == 0
    assert one.lead(sign * 9000, 120) == 0
    assert one.number(DISTANCE) == (sign * 9000) % (1 << 32)
    assert one.written(WINDOW, _u32(9001)) is None
    assert one.number(WINDOW) == 9001
    assert one.lead(sign * 9000, 120) == 0
    assert one.written(WINDOW, _u32(0)) is None
    assert (one.number(WINDOW), one.lead(sign * 90_000, 120)) == (0, 0)
    assert one.written(WINDOW, _u32(80_000)) is None
    assert one.lead(sign * 90_000, 120) == 1 << 11  # excessive deviation
    assert one.number("S-0-0390") == 0xF2028  # AX5000: diagnostic codes


@pytest.mark.parametrize(
    ("factor", "exponent", "units"),
    [
        (3, -6, 12.5e3 / 3),  # 3333 1/3 per turn of 10 mm
        (7, -6, 12.5e3 / 7),
        (9, -7, 12.5e4 / 9),
        (7, -5, 12.5e2 / 7),
        (30_000, -10, 12.5e7 / 30_000),
    ],
)
def test_a_unit_that_does_not_divide_a_turn_counts_exactly(
    factor: int, exponent: int, units: float
) -> None:
    """1.25 turns: units of one turn that were rounded would be off by up to 0.6."""
    drive = Scaled()
    for ident, value in (("S-0-0076", 0x09), (FACTOR, factor), (EXPONENT, exponent)):
        assert drive.scale(ident, value) is None
    assert drive.units == round(units)


@pytest.mark.parametrize("far_m", [1.2345, -1.2345])
def test_a_unit_that_does_not_divide_a_turn_counts_exactly_far_away(far_m: float) -> None:
    """123.45 turns of 3333 1/3 units of 3 um."""
    drive = Scaled()
    drive.drive.servo.axis.motion = lambda _time_s: far_m  # type: ignore[attr-defined]
    for ident, value in (("S-0-0076", 0x09), (FACTOR, 3), (EXPONENT, -6)):
        assert drive.scale(ident, value) is None
    drive.cycle(0)
    value = drive.ask(Operation.READ, "S-0-0051")
    assert isinstance(value, bytes)
    assert int.from_bytes(value, "little", signed=True) == round(far_m * 1e6 / 3)


@pytest.mark.parametrize(
    ("phase", "command", "invalid", "ident", "wrong", "right", "listed"),
    [
        (2, "S-0-0127", "S-0-0021", "S-0-0015", 3, 7, ["S-0-0015"]),
        (3, "S-0-0128", "S-0-0022", "S-0-0002", 4000, 2000, ["S-0-0001", "S-0-0002"]),
        (3, "S-0-0128", "S-0-0022", "S-0-0001", 1000, 2000, ["S-0-0001", "S-0-0002"]),
    ],
)
def test_what_is_invalid_is_listed_until_the_next_check_finds_it_right(
    phase: int, command: str, invalid: str, ident: str, wrong: int, right: int, listed: list[str]
) -> None:
    one = Hand()
    states = one.drive.states

    def checked() -> tuple[str, list[int]]:
        states.state = AlState.PREOP if phase == 2 else AlState.SAFEOP
        assert one.written(command, b"\3\0") is None
        state = one.state(command)
        assert one.written(command, b"\0\0") is None
        assert one.state(command) == "IDLE"
        found = one.ask(Operation.READ, invalid)
        assert isinstance(found, bytes)
        return state, read_list(found, 2)

    def write(value: int) -> None:
        states.state = AlState.PREOP
        assert one.written(ident, value.to_bytes(2, "little")) is None

    assert checked() == ("DONE", [])
    for _ in range(2):
        write(wrong)
        assert checked() == ("FAILED", [ident_number(name) for name in listed])
        write(right)
        assert checked() == ("DONE", [])


@pytest.mark.parametrize("limit", [0, 500, 1000, 65_535])
def test_a_torque_limit_is_that_of_both_directions_and_shown_as_it_was_written(limit: int) -> None:
    """S-0-0092, bipolar; 65535 at power on is none."""
    one = Hand()
    assert one.number(TORQUE) == 65_535
    for value in (300, limit):
        assert one.written(TORQUE, value.to_bytes(2, "little")) is None
        one.cycle(FOLLOW)
        assert one.number(TORQUE) == value
        rated_n = one.drive.profile.rated_force_n
        negative_n, positive_n = one.drive.servo.axis.limits[-1]  # type: ignore[attr-defined]
        assert negative_n == positive_n == pytest.approx(value / 1000 * rated_n)


PHASES = {2: AlState.PREOP, 3: AlState.SAFEOP, 4: AlState.OP}


@pytest.mark.parametrize(
    ("ident", "data", "protected"),
    [
        ("S-0-0001", "d007", {3, 4}),
        ("S-0-0032", "0b00", {4}),
        ("S-0-0127", "0000", {3, 4}),
        ("S-0-0128", "0000", {2, 4}),
        ("S-0-0170", "0000", {2}),
        ("S-0-0301", "0000", set()),
        ("S-0-0305", "0000", {3, 4}),
        ("S-0-0159", "00000000", set()),
        ("S-0-0405", "0000", set()),
    ],
)
def test_a_value_is_protected_in_its_own_phases(ident: str, data: str, protected: set[int]) -> None:
    """Modes change until the drive operates; each check is made in the phase before its own."""
    one = Hand()
    for phase, state in PHASES.items():
        one.drive.states.state = state
        refused = one.written(ident, bytes.fromhex(data))
        assert refused == ("PROTECTED" if phase in protected else None)


def test_a_reset_of_no_error_is_done_at_once() -> None:
    """S-0-0099: 3 and no change in the status word is waited for; the next one is as good."""
    one = Standing()
    for _ in range(2):
        assert one.written("S-0-0099", b"\x03\x00") is None
        assert one.state("S-0-0099") == "DONE"
        assert one.drive.front.is_resetting is False
        one.cycle(FOLLOW, 3)
        assert one.written("S-0-0099", b"\x00\x00") is None
        assert one.state("S-0-0099") == "IDLE"


@pytest.mark.parametrize("period_us", [500, 1000, 2000, 8000])
def test_the_cycle_of_the_bus_is_the_time_of_a_set_value(period_us: int) -> None:
    """S-0-0002, in phase 2."""
    one = Standing()
    one.drive.states.state = AlState.PREOP
    assert one.written("S-0-0002", period_us.to_bytes(2, "little")) is None
    assert one.drive.servo.interpolation.period_ns() == period_us * 1000


@pytest.mark.parametrize(("mine", "other"), [("S-0-0405", "S-0-0406"), ("S-0-0406", "S-0-0405")])
@pytest.mark.parametrize("bit", ["S-0-0301", "S-0-0303"])
def test_an_enable_that_a_real_time_bit_has_is_written_by_it_alone(
    mine: str, other: str, bit: str
) -> None:
    """0 may be written, and the other enable is free."""
    one = Hand(profile="two_probes")
    assert one.written(bit, ident_number(mine).to_bytes(2, "little")) is None
    assert one.written(mine, b"\x01\x00") == "BY_OTHERS"
    assert one.written(mine, b"\x00\x00") is None
    assert one.written(other, b"\x01\x00") is None
    assert one.written(bit, b"\x00\x00") is None
    assert one.written(mine, b"\x01\x00") is None


def test_a_write_acts_from_its_instant_on() -> None:
    """Units between two cycles: what moved until then was latched in the old ones."""
    edge_ns = 10_400_000
    one = Hand((edge_ns,), place_m=0.0)
    axis = one.drive.servo.axis
    axis.motion = lambda time_s: 0.05 * time_s  # type: ignore[attr-defined]
    for ident, value in (("S-0-0169", 1), ("S-0-0405", 1), ("S-0-0170", 3)):
        assert one.written(ident, value.to_bytes(2, "little")) is None
    one.cycle(0, 10)
    one.clock.run_until(edge_ns + 300_000)
    assert axis.now_ns == 10_000_000  # type: ignore[attr-defined]
    assert one.written(TORQUE, (500).to_bytes(2, "little")) is None
    assert axis.now_ns == edge_ns + 300_000  # type: ignore[attr-defined]
    assert one.number("S-0-0409") == 1


@pytest.mark.parametrize(
    ("listed", "carried"),
    [
        ((51,), {"position_actual"}),
        ((51, 53), {"position_actual", "second_position"}),
        ((53, 51), {"position_actual", "second_position"}),
        ((), set()),
    ],
)
def test_what_the_at_carries_is_what_the_drive_has_to_sample(
    listed: tuple[int, ...], carried: set[str]
) -> None:
    """S-0-0016 of the AT; the MDT has the set position alone."""
    one = Hand()
    one.drive.states.state = AlState.PREOP
    assert one.written("S-0-0016", pack_list(listed, 2, len(listed))) is None
    assert one.drive.telegrams.compile() == carried
