"""Position units of a SERCOS drive by S-0-0076 to S-0-0079, and what else its master sets.

The axis has a screw of 10 mm and stands at 12.5 mm: 1.25 turns. FCT-C4, SERCOS interface: bits 2..0
of S-0-0076 are linear (1) or rotary (2), bit 3 is by parameters, else the preferred unit is 1e-7 m
or 1e-4 degrees.
"""

from itertools import permutations

import pytest
from tests.sercos.test_sercos_faults_by_hand import FOLLOW, Hand

from axisrig.bench.drive.sercos.idents import rows
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.profiles.sercos.service import ident_number
from axisrig.kernel.time.clock import US

PLACE_M, TURNS, LEAD_M = 0.0125, 1.25, 0.010
WIDTHS = {"S-0-0076": 2, "S-0-0077": 2, "S-0-0078": 2, "S-0-0079": 4}
FACTOR, EXPONENT, RESOLUTION = "S-0-0077", "S-0-0078", "S-0-0079"


class Scaled(Hand):
    """A drive in phase 2; `units` is S-0-0051."""

    def __init__(self) -> None:
        super().__init__(place_m=PLACE_M)
        self.drive.states.state = AlState.PREOP

    def scale(self, ident: str, value: int) -> bytes | str | None:
        return self.written(ident, value.to_bytes(WIDTHS[ident], "little", signed=value < 0))

    @property
    def units(self) -> int:
        self.cycle(0)
        return self.number("S-0-0051")


def test_a_drive_begins_with_2_to_the_20_increments_a_turn() -> None:
    assert Scaled().units == round(TURNS * (1 << 20))


@pytest.mark.parametrize("order", list(permutations(WIDTHS)))
@pytest.mark.parametrize(
    ("kind", "per_turn"),
    [
        (0x09, LEAD_M / (5 * 1e-6)),
        (0x0A, 36_000),
        (0x01, LEAD_M / 1e-7),
        (0x02, 3_600_000),
    ],
)
def test_the_unit_is_that_of_all_four_in_whatever_order_they_are_written(
    order: tuple[str, ...], kind: int, per_turn: float
) -> None:
    """A unit of 5 um, or 36000 a turn; the preferred ones leave these two out."""
    drive = Scaled()
    values = {"S-0-0076": kind, FACTOR: 5, EXPONENT: -6, RESOLUTION: 36_000}
    for ident in order:
        assert drive.scale(ident, values[ident]) is None
    assert drive.units == round(TURNS * per_turn)


@pytest.mark.parametrize(
    ("kind", "ident", "values", "per_turn"),
    [
        (0x0A, RESOLUTION, (4096, 1 << 24, 4096), (4096, 1 << 24, 4096)),
        (0x09, FACTOR, (1, 25, 1), (100_000, 4_000, 100_000)),
        (0x09, EXPONENT, (-8, -5, -8), (1_000_000, 1_000, 1_000_000)),
        # Of the other kind, or of none: nothing changes
        (0x0A, FACTOR, (1, 25), (1 << 20, 1 << 20)),
        (0x0A, EXPONENT, (-8, -5), (1 << 20, 1 << 20)),
        (0x09, RESOLUTION, (4096, 1 << 24), (100_000, 100_000)),
        (0x01, FACTOR, (1, 25), (100_000, 100_000)),
        (0x02, RESOLUTION, (4096, 1 << 24), (3_600_000, 3_600_000)),
    ],
)
def test_a_parameter_that_is_written_after_the_kind_changes_its_own_unit(
    kind: int, ident: str, values: tuple[int, ...], per_turn: tuple[int, ...]
) -> None:
    drive = Scaled()
    assert drive.scale("S-0-0076", kind) is None
    for value, units in zip(values, per_turn, strict=True):
        assert drive.scale(ident, value) is None
        assert drive.units == round(TURNS * units)


def test_kinds_follow_each_other_with_the_parameters_that_are_there() -> None:
    drive = Scaled()
    for kind, per_turn in ((0x09, 100_000), (0x0A, 1 << 20), (0x02, 3_600_000), (0x0A, 1 << 20)):
        assert drive.scale("S-0-0076", kind) is None
        assert drive.units == round(TURNS * per_turn)


@pytest.mark.parametrize(
    ("ident", "value", "code"),
    [
        ("S-0-0076", 0x00, "INVALID"),  # no scaling at all
        ("S-0-0076", 0x0B, "INVALID"),  # a kind that there is not
        (FACTOR, 0, "BELOW"),
        (EXPONENT, -11, "BELOW"),
        (EXPONENT, -1, "ABOVE"),
        (RESOLUTION, 0, "BELOW"),
        (RESOLUTION, (1 << 30) + 1, "ABOVE"),
    ],
)
def test_a_scaling_that_cannot_be_is_refused_and_the_unit_stays(
    ident: str, value: int, code: str
) -> None:
    drive = Scaled()
    assert drive.scale(RESOLUTION, 36_000) is None
    before = drive.number(ident)
    assert drive.scale(ident, value) == code
    assert (drive.number(ident), drive.units) == (before, 45_000)


@pytest.mark.parametrize("state", [AlState.SAFEOP, AlState.OP])
@pytest.mark.parametrize("ident", WIDTHS)
def test_the_scaling_is_set_in_phase_2_alone(ident: str, state: AlState) -> None:
    """SAFEOP is phase 3, OP 4; back in phase 2 it can be set again."""
    drive, value = Scaled(), 0x09 if ident == "S-0-0076" else -5 if ident == EXPONENT else 7
    drive.drive.states.state = state
    before = drive.number(ident)
    assert drive.scale(ident, value) == "PROTECTED"
    assert (drive.number(ident), drive.units) == (before, round(TURNS * (1 << 20)))
    drive.drive.states.state = AlState.PREOP
    assert drive.scale(ident, value) is None


# --- what else is set


@pytest.mark.parametrize("profile", ["one_probe", "two_probes"])
def test_what_is_read_at_power_on_may_be_written_back(profile: str) -> None:
    """FCT-C4 7.3 does so behind a stop: of each ident that a master may write, in phase 2."""
    hand = Hand(profile=profile)
    hand.drive.states.state = AlState.PREOP
    refused = dict[str, object]()
    for row in rows():
        number = ident_number(row["ident"])
        if row["access"] != "rw" or row["form"] != "value" or number not in hand.drive.idents.table:
            continue
        before = hand.number(row["ident"])
        code = hand.written(row["ident"], before.to_bytes(int(row["bytes"]), "little"))
        if code is not None or hand.number(row["ident"]) != before:
            refused[row["ident"]] = code
    assert refused == {}


@pytest.mark.parametrize("name", ["S-0-0076", RESOLUTION, "S-0-0092", "S-0-0159", "S-0-0032"])
def test_a_value_that_was_set_is_forgotten_without_power(name: str) -> None:
    drive, number = Scaled(), ident_number(name)
    before = drive.drive.idents.number(number)
    values = {"S-0-0076": 0x09, RESOLUTION: 36_000, "S-0-0092": 500, "S-0-0159": 777, "S-0-0032": 3}
    size = 4 if name in (RESOLUTION, "S-0-0159") else 2
    assert drive.written(name, values[name].to_bytes(size, "little")) is None
    assert drive.drive.idents.number(number) == values[name] != before
    drive.drive.power_off()
    drive.drive.power_on()
    assert drive.drive.idents.number(number) == before
    drive.drive.telegrams.compile()
    drive.cycle(0)
    assert drive.drive.idents.number(ident_number("S-0-0051")) == round(TURNS * (1 << 20))


def test_the_limit_of_torque_is_that_which_was_written_last() -> None:
    """0.1 % of the rated torque; 65535, as at power on, is the limit of the motor alone."""
    hand = Hand()
    assert hand.number("S-0-0092") == 0xFFFF
    for value in (3000, 500, 0, 10_001, 0xFFFF, 500):
        assert hand.written("S-0-0092", value.to_bytes(2, "little")) is None
        assert (hand.number("S-0-0092"), hand.drive.servo.image.max_torque) == (value, value)


def test_the_cycle_of_the_drive_is_s_0_0002_and_not_s_0_0001() -> None:
    hand = Scaled()
    interpolation = hand.drive.servo.interpolation
    for cycle_us in (2000, 500, 8000, 1000, 2000):
        assert hand.written("S-0-0002", cycle_us.to_bytes(2, "little")) is None
        assert interpolation.period_ns() == cycle_us * US
        assert hand.written("S-0-0001", (3000).to_bytes(2, "little")) is None
        assert interpolation.period_ns() == cycle_us * US


@pytest.mark.parametrize("mode", [3, 11])
def test_either_mode_of_positions_leads_the_axis(mode: int) -> None:
    """S-0-0032: 3 with lag and 11 without; others are refused."""
    hand = Scaled()
    for other in (0, 1, 2, 4, 19, 0x8003):
        assert hand.written("S-0-0032", other.to_bytes(2, "little")) == "INVALID"
    assert hand.written("S-0-0032", mode.to_bytes(2, "little")) is None
    assert hand.number("S-0-0032") == mode
    hand.drive.states.state = AlState.OP
    assert hand.cycle(FOLLOW, 8) & 0xC000 == 0xC000
    assert hand.cycle(FOLLOW) & 1 << 3
