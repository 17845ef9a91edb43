"""A PROFIdrive drive with a probe: what power takes, both edges, and edges of its parameters."""

import csv
from importlib import resources
from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis, FakeSignal
from tests.profidrive.test_profidrive_node import OFF, OPERATE, Node

from axisrig.bench.drive.profidrive.node import ProfidriveDrive
from axisrig.bench.drive.profidrive.parameters import DriveParameters
from axisrig.bench.rig.profidrive.keys import DriveTable
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.profidrive import words
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

POS, NEG = words.FUNCTION_OF[1, "POS"], words.FUNCTION_OF[1, "NEG"]
ACTIVATE = words.FLYING | words.ACTIVATE << words.COMMAND_SHIFT
READ = words.FLYING | words.READ << words.COMMAND_SHIFT
SPEED_M_S = 0.02


class Probing(Node):
    """The axis goes 20 mm/s; edges_ns: of the probe, whose input has no delay."""

    def __init__(self, edges_ns: tuple[int, ...] = (), telegram: int = 105, **keys: Any) -> None:
        self.axis = axis = FakeAxis(motion=lambda time_s: SPEED_M_S * time_s)
        table = DriveTable.model_validate(
            {"family": "profidrive", "telegram": telegram, "p0660": 80, "input_delay_us": 0.0}
            | keys
        )
        made = table.make()
        self.clock, self.per_mm = new_scheduler(), float(table.per_mm)
        probe: Any = FakeSignal(axis, edges_ns)
        self.node = ProfidriveDrive("Z", self.clock, axis, (probe, None), made)
        self.telegram = made.telegram
        self.given = dict.fromkeys(self.telegram.to_drive, 0)
        self.life = 0
        self.clock.run_until(0)

    def until(self, time_ms: int, **values: float) -> None:
        while self.clock.now_ns < time_ms * MS:
            self.cycle(**values)


@pytest.mark.parametrize("function", [POS, NEG, POS | NEG])
def test_each_function_has_the_position_of_its_own_edge(function: int) -> None:
    """Up at 5.25 ms, down at 7.5 ms; the value of one is read after the other."""
    one = Probing((5_250_000, 7_500_000))
    one.until(3, STW1=OFF)
    one.until(10, STW1=OFF, G1_STW=ACTIVATE | function)
    assert one.shown("G1_ZSW") & 0xFF == function << words.VALUE_SHIFT
    for bit, edge_ms in ((POS, 5.25), (NEG, 7.5)):
        if not function & bit:
            continue
        one.cycle(G1_STW=READ | bit)
        one.cycle()
        assert one.shown("G1_XIST2") == round(edge_ms * SPEED_M_S * one.per_mm)
        one.cycle(G1_STW=0)
        one.cycle()
    assert one.shown("G1_ZSW") & 0xFF == 0


@pytest.mark.parametrize("edges_ns", [(), (5_250_000,)])
def test_power_takes_the_functions_of_the_encoder(edges_ns: tuple[int, ...]) -> None:
    """Neither active nor with a value afterwards, and an edge that comes then is nobody's."""
    one = Probing((*edges_ns, 21_000_000, 22_000_000, 23_000_000)[: len(edges_ns) + 2])
    one.until(3, STW1=OFF)
    one.until(8, STW1=OFF, G1_STW=ACTIVATE | POS)
    active = POS << words.VALUE_SHIFT if edges_ns else POS
    assert one.shown("G1_ZSW") & 0xFF == active
    one.node.power_off()
    assert one.node.inputs == b""
    one.clock.run_until(15 * MS)
    one.node.power_on()
    assert one.shown("G1_ZSW") & 0xFF == 0
    assert one.shown("G1_XIST2") == 0
    one.until(25, STW1=OFF, G1_STW=0)
    assert one.shown("G1_ZSW") & 0xFF == 0
    one.cycle(G1_STW=READ | POS)
    one.cycle()
    assert one.shown("G1_XIST2") == 0


def test_power_takes_an_error_of_the_encoder_and_its_acknowledge() -> None:
    one = Probing()
    one.until(3, STW1=OFF)
    one.until(6, G1_STW=ACTIVATE | words.FUNCTION_OF[2, "POS"])
    assert one.shown("G1_ZSW") & words.ENCODER_ERROR
    code = one.shown("G1_XIST2")
    assert code == words.encoder_errors()["MEASUREMENT"]
    one.cycle(G1_STW=words.ENCODER_ACKNOWLEDGE)
    one.node.power_off()
    one.node.power_on()
    assert (one.shown("G1_ZSW") & 0x8800, one.shown("G1_XIST2")) == (0, 0)
    one.cycle(G1_STW=0)
    one.cycle(G1_STW=ACTIVATE | POS)
    one.cycle()
    assert one.shown("G1_ZSW") & 0xFF == POS


def test_power_takes_parameters_and_set_values_that_have_come() -> None:
    """P1230 is that of the rig again, and a telegram from before power is none."""
    one = Node(FakeAxis(), p1230=1500)
    one.operate()
    one.cycle(NSOLL_B=0.1 * one.per_m_s, MOMRED=8192)
    assert one.node.image.max_torque == 750
    one.node.parameters.values[1230] = 800
    one.cycle()
    assert one.node.image.max_torque == 400
    one.node.exchange(words.codec_of(one.telegram.to_drive).pack(*one.given.values()))
    one.node.power_off()
    one.node.power_on()
    assert one.node.parameters.values[1230] == 1500
    one.clock.run_until(one.clock.now_ns + MS)
    one.node.sample()
    one.node.cycle()
    assert one.node.image.max_torque == 1500
    assert one.node.state is State.SWITCH_ON_DISABLED
    assert one.shown("ZSW1") & (1 << 4 | 1 << 5) == 0  # no OFF2, no OFF3: as STW1 has them
    assert one.shown("ZSW2") >> words.LIFE_SHIFT == 2  # the second sample since then


def test_a_sign_of_life_that_is_held_stays_and_goes_on_from_there() -> None:
    one = Node(FakeAxis())
    lives = []
    for number in range(9):
        one.node.holds_life = 3 <= number < 6
        one.cycle(STW1=OFF)
        lives.append(one.shown("ZSW2") >> words.LIFE_SHIFT)
    first = lives[0]
    assert lives == [first + step for step in (0, 1, 2, 2, 2, 2, 3, 4, 5)]


@pytest.mark.parametrize("speed_m_s", [0.05, -0.05])
def test_a_rolling_axis_is_taken_over_with_its_speed(speed_m_s: float) -> None:
    """The first demand of operation is that of the axis; the set speed comes a cycle later."""
    axis = FakeAxis(motion=lambda time_s: speed_m_s * time_s)
    one = Node(axis)
    for word in (OFF, OFF, *[OPERATE] * 6):
        count = len(axis.commands)
        one.cycle(STW1=word, NSOLL_B=0)
        if one.node.state is State.OPERATION_ENABLED:
            break
    begun = axis.commands[count]
    assert (begun.velocity_m_s, begun.acceleration_m_s2) == (pytest.approx(speed_m_s), 0.0)
    one.cycle()
    assert axis.commands[-1].velocity_m_s == 0.0


# Parameters


def table() -> list[dict[str, str]]:
    text = resources.files("axisrig.kernel.profiles.profidrive") / "parameters.csv"
    return list(csv.DictReader(text.read_text(encoding="utf-8").splitlines()))


def made(**keys: Any) -> DriveParameters:
    return DriveParameters(DriveTable.model_validate({"family": "profidrive"} | keys).make())


@pytest.mark.parametrize(
    ("reduction", "p1230", "p0881", "limit"),
    [
        (0, 1000, 100, 1000),
        (8192, 1000, 100, 500),
        (5000, 1000, 100, 694),  # 694.82
        (1, 1000, 100, 999),  # 999.94
        (16384, 1000, 100, 0),
        (16384, 1000, 60, 400),
        (16384, 1000, 200, 0),  # never below 0
        (8192, 1000, 200, 0),
        (8192, 999, 150, 249),  # 249.75
        (20000, 1000, 100, 0),
    ],
)
def test_a_torque_limit_is_reduced_down_to_a_whole_tenth_of_a_percent(
    reduction: int, p1230: int, p0881: int, limit: int
) -> None:
    """P1230 (1 - P0881 MOMRED / (100 % 16384)): SIMODRIVE 611 universal p. 224."""
    assert made(p1230=p1230, p0881=p0881).torque_limit(reduction) == limit


@pytest.mark.parametrize("row", table(), ids=lambda row: str(row["number"]))
def test_each_parameter_is_read_with_all_its_bits(row: dict[str, str]) -> None:
    """Its least and its largest value, and one with the upper bit of its format."""
    drive, number, size = made(), int(row["number"]), int(row["bits"]) // 8
    for value in {int(row["low"]), int(row["high"]), 1 << 8 * size - 1}:
        if row["signed"] != "no" or not value < 1 << 8 * size:
            continue
        drive.values[number] = value
        request = bytes((1, 1, 0, 1, 0x10, 1)) + number.to_bytes(2, "big") + bytes(2)
        answer = drive.answer(request)
        assert answer[:4] == bytes((1, 1, 0, 1))
        assert int.from_bytes(answer[-size:], "big") == value


@pytest.mark.parametrize(
    "row", [row for row in table() if row["access"] == "rw"], ids=lambda row: str(row["number"])
)
def test_each_limit_of_a_parameter_may_be_written_and_not_one_beyond(row: dict[str, str]) -> None:
    drive, number, bits = made(), int(row["number"]), int(row["bits"])
    low, high = int(row["low"]), int(row["high"])
    for value, is_taken in ((high, True), (low, True), (low - 1, False), (high + 1, False)):
        if not 0 <= value < 1 << bits:
            continue
        before = drive.values[number]
        head = bytes((1, 2, 0, 1, 0x10, 1)) + number.to_bytes(2, "big") + bytes(2)
        answer = drive.answer(head + bytes((0x42, 1)) + value.to_bytes(2, "big"))
        assert (answer[1] == 2) is is_taken
        assert drive.values[number] == (value if is_taken else before)


def test_a_request_that_is_cut_off_is_none() -> None:
    """Head and address are 10 bytes; with fewer there is nothing to answer to."""
    request = bytes.fromhex("07 01 00 01  10 01 04CE 0000")
    for size in range(len(request)):
        assert made().answer(request[:size]) == b""
    assert made().answer(request)
