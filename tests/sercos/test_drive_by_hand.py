"""The control's end of a SERCOS drive with telegrams and answers written by hand."""

import struct
from typing import Any

import pytest

from axisrig.kernel.drives.ethercat.settings import Pdo
from axisrig.kernel.drives.ethercat.slave_data import Silent
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.drives.power import Power, PowerOrder, PowerRequest
from axisrig.kernel.drives.sercos.accesses import SercosAccesses
from axisrig.kernel.drives.sercos.data import TelegramData
from axisrig.kernel.drives.sercos.link import SercosDrive
from axisrig.kernel.drives.sercos.service_channel import SoeError
from axisrig.kernel.drives.sercos.settings import SercosSettings, real_time_bits
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import DriveWait
from axisrig.kernel.profiles.sercos.service import Element, ident_number, pack_text

AT = (
    MappedObject(135, 0, 16, False, "statusword"),
    MappedObject(51, 0, 32, True, "actual"),
    MappedObject(130, 0, 32, True, ""),
    MappedObject(133, 0, 32, True, ""),  # probe 2, negative edge
)
SECOND = MappedObject(53, 0, 32, True, "second")
MDT = (
    MappedObject(134, 0, 16, False, "controlword"),
    MappedObject(47, 0, 32, True, "target"),
)
OPERATES, FOLLOWS, C1D = 0xC000, 0x0008, 0x2000
ON, ENABLE, RUN, TOGGLE = 0x8000, 0x4000, 0x2000, 0x0400
READ_VALUE = Element.VALUE
BITS = {0: (0x40, 0x80, 0x40), 1: (0x40, 0x40, 0x80), 2: (0x80, 0x80, 0x40)}
"""By P-AXIS-00060: enable in S-0-0134, done measurement and level in S-0-0135."""


class Channel:
    """Keeps what is asked; the test answers, the oldest question first."""

    def __init__(self) -> None:
        self.asked: list[tuple[int, Any]] = []
        self._open: list[tuple[int, Any]] = []

    def read(self, _drive: int, ident: int, elements: Element, done: Any) -> None:
        self.asked.append((ident, elements))
        self._open.append((ident, done))

    def write(self, _drive: int, ident: int, value: bytes, done: Any) -> None:
        self.asked.append((ident, value))
        self._open.append((ident, done))

    @property
    def is_open(self) -> bool:
        return bool(self._open)

    def answer(self, data: bytes = b"") -> None:
        self._open.pop(0)[1](data)

    def refuse(self, code: int | None = None) -> None:
        ident, done = self._open.pop(0)
        done(SoeError(ident, code))


class Bench:
    """A drive of 1000 increments per mm."""

    def __init__(self, *, second: bool = False, at: Any = AT, **settings: Any) -> None:
        self.inputs = (*at, SECOND) if second else at
        self.settings = SercosSettings(
            "Z", 1000.0, node_id=1, lead_mm=10.0, period_us=1000,
            inputs=[Pdo(0, self.inputs)], outputs=[Pdo(0, MDT)],
            **{"proves_latches": False, "proves_places": False, **settings},
        )  # fmt: skip
        self.data, self.channel = TelegramData(self.settings, 130), Channel()
        channel: Any = self.channel
        self.drive = SercosDrive(self.settings, self.data, channel)
        self.drive.begin()

    def cycle(self, status: int, place: int = 0, *more: int) -> int:
        """One cycle; returns S-0-0134 as it was sent."""
        values = (place, *(more if len(more) > 1 else (1300, -1310, *more)))
        self.data.forget()
        self.data.arrived(struct.pack(f"<H{len(values)}i", status, *values))
        self.drive.take()
        self.drive.send(0.0)
        return int(struct.unpack("<Hi", self.data.outputs)[0])


@pytest.mark.parametrize(
    ("status", "needs_following", "power", "name"),
    [
        (0x0000, True, Power.OFF, "NOT_READY"),
        (0x4000, True, Power.OFF, "LOGIC_READY"),
        (0x8000 | FOLLOWS, True, Power.OFF, "POWER_READY"),
        (OPERATES, True, Power.OFF, "OPERATES"),
        (OPERATES, False, Power.OPERATING, "OPERATES"),
        (OPERATES | FOLLOWS, True, Power.OPERATING, "OPERATES"),
        (OPERATES | FOLLOWS | C1D, True, Power.FAULT, "CLASS_1_ERROR"),
    ],
)
def test_its_power_is_what_the_status_word_shows(
    status: int, needs_following: bool, power: Power, name: str
) -> None:
    """S-0-0135: bits 15 and 14, bit 13, and bit 3 where P-AXIS-00411 wants it."""
    bench = Bench(needs_following=needs_following)
    bench.cycle(status)
    assert (bench.drive.power, bench.drive.state_name) == (power, name)
    assert bench.drive.is_in_fault is (power is Power.FAULT)


def test_the_control_word_leads_it_and_toggles_with_each_cycle() -> None:
    bench = Bench()
    sent = [bench.cycle(0x8000)]
    bench.drive.order(PowerOrder.SWITCH_ON)
    sent += [bench.cycle(0x8000), bench.cycle(OPERATES | FOLLOWS)]
    bench.drive.order(PowerOrder.STOP)
    sent.append(bench.cycle(OPERATES | FOLLOWS))
    assert bench.drive.power is Power.STOPPING
    sent.append(bench.cycle(OPERATES | FOLLOWS | C1D))
    assert [word & ~TOGGLE for word in sent] == [
        *(0, ON | ENABLE | RUN, ON | ENABLE | RUN, ON | ENABLE, 0),
    ]
    assert [bool(word & TOGGLE) for word in sent] == [True, False, True, False, True]


MOVES, HALTS = ON | ENABLE | RUN, ON | ENABLE


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        # S-0-0134 where the drive has power, operates, operates without following, has a fault
        (PowerRequest.OFF, (0, 0, 0, 0)), (PowerRequest.RELEASE, (0, 0, 0, 0)),
        (PowerRequest.ON, (MOVES, MOVES, MOVES, 0)), (PowerRequest.KEEP, (0, MOVES, MOVES, 0)),
        (PowerRequest.STOP, (0, HALTS, HALTS, 0)),
    ],
)  # fmt: skip
@pytest.mark.parametrize("acknowledges", [False, True])
def test_what_the_drive_gets_is_in_the_table_of_requests(
    request_: PowerRequest, words: tuple[int, ...], acknowledges: bool
) -> None:
    """KEEP and STOP go on with what it does, and never lead it into operation; see `power.csv`."""
    for status, word in zip((0x8000, OPERATES | FOLLOWS, OPERATES, C1D), words, strict=True):
        bench = Bench()
        bench.drive.request = request_
        bench.drive.acknowledges_faults = acknowledges
        assert bench.cycle(status) & ~TOGGLE == word, status
        is_reset = status == C1D and acknowledges
        assert bench.channel.asked == [(99, b"\3\0")] * is_reset


def test_what_a_fault_says_is_two_numbers_and_a_text() -> None:
    bench = Bench()
    bench.cycle(C1D)
    bench.drive.ask_for_fault()
    assert bench.channel.asked == [(ident, READ_VALUE) for ident in (11, 390, 95)]
    assert bench.drive.fault().values["emcy"] == "none"
    for data in ((0x8000).to_bytes(2, "little"), (0xC00F4A5).to_bytes(4, "little")):
        bench.channel.answer(data)
        assert bench.drive.is_asked
    bench.channel.answer(pack_text("axis blocked"))
    assert not bench.drive.is_asked
    alarm = bench.drive.fault()
    assert (alarm.id, alarm.values["statusword"]) == (900005, "0x2000")
    assert alarm.values["emcy"] == "S-0-0011 0x8000, S-0-0390 0xC00F4A5, axis blocked"


def test_a_question_about_a_fault_may_be_refused_or_forgotten() -> None:
    """On, off, on: the answer to a question about a forgotten fault is not of the next one."""
    bench = Bench()
    bench.drive.ask_for_fault()
    bench.channel.answer(b"\x01\x00")
    bench.drive.acknowledges_faults = True
    bench.drive.forget_fault()
    assert not bench.drive.acknowledges_faults
    for _ in range(2):
        bench.channel.answer(b"\x02\x00")
    assert (bench.drive.is_asked, bench.drive.fault().values["emcy"]) == (False, "none")
    bench.drive.ask_for_fault()
    bench.channel.answer(b"\x03\x00")
    bench.channel.refuse()
    bench.channel.answer(pack_text("x"))
    words = str(bench.drive.fault().values["emcy"]).split(", ")
    assert (len(words), words[0], words[-1]) == (3, "S-0-0011 0x3", "x")
    assert not bench.drive.is_asked


def test_a_fault_is_acknowledged_by_one_command_at_a_time() -> None:
    """S-0-0099 is set and enabled (3), then cancelled (0); again where the fault stays."""
    bench = Bench()
    reset = ident_number("S-0-0099")
    for _ in range(3):
        assert bench.cycle(C1D) & ~TOGGLE == 0
    assert bench.channel.asked == []
    bench.drive.acknowledges_faults = True
    for _ in range(2):
        for _ in range(3):
            bench.cycle(C1D)
        assert bench.channel.asked == [(reset, b"\x03\x00")]
        bench.channel.answer()
        bench.cycle(C1D)
        assert bench.channel.asked[1:] == [(reset, b"\x00\x00")]
        bench.channel.refuse()
        bench.channel.asked.clear()
    bench.cycle(0x8000)
    assert bench.channel.asked == []


@pytest.mark.parametrize("number", BITS)
def test_another_edge_has_its_own_value_and_one_that_the_telegram_lacks_is_refused(
    number: int,
) -> None:
    """There and back; 900223 leaves the edge in use as it was."""
    bench = Bench(bits=real_time_bits(number, 0))
    enable, done, _ = BITS[number]
    for probe_input, edge, latched in ((2, "NEG", -1.31), (1, "POS", 1.3), (2, "NEG", -1.31)):
        bench.drive.choose_latch(probe_input, edge)
        for bad in ((1, "NEG"), (2, "POS")):
            with pytest.raises(Alarm) as caught:
                bench.drive.choose_latch(*bad)
            assert caught.value.id == 900223
        assert (bench.drive.probe_input, bench.drive.edge) == (probe_input, edge)
        for _ in range(8):
            bench.cycle(OPERATES)
        assert not bench.drive.is_probing
        bench.drive.arm()
        for _ in range(8):
            assert bench.cycle(OPERATES) & 0xC0 == enable
        assert bench.drive.is_probing
        bench.cycle(OPERATES | done, 7)
        assert bench.drive.latched_mm == latched
        assert bench.drive.latched_speed_mm == 0.007
        bench.drive.disarm()
        assert (bench.cycle(OPERATES) & 0xC0, bench.drive.is_probing) == (0, False)


def test_each_edge_of_each_probe_is_confirmed_by_its_own_idents() -> None:
    """S-0-0130 to 133 are the values, S-0-0409 to 412 show that one is there (FCT-C4 6.1)."""
    values = tuple(MappedObject(130 + at, 0, 32, True, "") for at in range(4))
    bench = Bench(at=(*AT[:2], *values), proves_latches=True, bits=real_time_bits(0, 0))
    for at in (0, 1, 3, 2, 3, 1, 0):
        probe_input, edge = at // 2 + 1, ("POS", "NEG")[at % 2]
        bench.drive.choose_latch(probe_input, edge)
        assert (bench.drive.probe_input, bench.drive.edge) == (probe_input, edge)
        for _ in range(8):
            bench.cycle(OPERATES, 0, 1000, 2000, 3000, 4000)
        bench.drive.arm()
        bench.channel.answer()
        for _ in range(8):
            bench.cycle(OPERATES, 0, 1000, 2000, 3000, 4000)
        bench.cycle(OPERATES | BITS[0][1], 7, 1000, 2000, 3000, 4000)
        assert bench.drive.latched_mm == at + 1.0
        bench.channel.asked.clear()
        assert not bench.drive.is_confirmed()
        bench.channel.answer(b"\1\0")
        bench.channel.answer((1000 * (at + 1)).to_bytes(4, "little"))
        assert bench.drive.is_confirmed()
        assert [ident for ident, _ in bench.channel.asked] == [409 + at, 130 + at]
        bench.drive.disarm()


@pytest.mark.parametrize("number", BITS)
@pytest.mark.parametrize("edge", ["POS", "NEG"])
def test_the_level_of_the_probe_is_that_of_its_edge(edge: str, number: int) -> None:
    bits = real_time_bits(number, 0)
    bench = Bench(probe_input=1 if edge == "POS" else 2, edge=edge, bits=bits)
    level = BITS[number][2]
    bench.cycle(OPERATES | level)
    assert bench.drive.is_actuated is None
    bench.drive.knows_level = True
    actuated = []
    for status in (OPERATES | level, OPERATES | (level ^ 0xC0)):
        bench.cycle(status)
        actuated.append(bench.drive.is_actuated)
    assert actuated == [edge == "POS", edge == "NEG"]


def test_a_second_encoder_is_the_value_that_came_last_and_its_age() -> None:
    bench = Bench(second=True)
    assert (bench.drive.has_second, bench.drive.second_increments) == (True, None)
    bench.cycle(OPERATES, 5, 777)
    for age in (1, 2):
        bench.data.forget()
        bench.drive.take()
        assert (bench.drive.second_increments, bench.drive.second_age_cycles) == (777, age)
    bench.cycle(OPERATES, 5, -3)
    assert (bench.drive.second_increments, bench.drive.second_age_cycles) == (-3, 0)
    assert bench.drive.second_period_ns(2_000_000) == 2_000_000
    assert (Bench().drive.has_second, Bench().drive.second_period_ns(1)) == (False, None)


@pytest.mark.parametrize("missing_cycles", [0, 2])
def test_telegrams_may_stay_out_so_often_in_a_row(missing_cycles: int) -> None:
    bench = Bench(missing_cycles=missing_cycles)
    for _ in range(2):
        bench.cycle(OPERATES)
        for _ in range(missing_cycles):
            bench.data.forget()
            bench.drive.take()
    bench.data.forget()
    with pytest.raises(Alarm) as caught:
        bench.drive.take()
    assert (caught.value.id, caught.value.values["cycles"]) == (900730, missing_cycles + 1)


def test_telegrams_that_stayed_out_before_the_begin_do_not_count() -> None:
    bench = Bench(missing_cycles=2)
    for _ in range(3):
        for _ in range(2):
            bench.data.forget()
            bench.drive.take()
        bench.drive.begin()
    bench.cycle(OPERATES)


def test_missing_telegrams_leave_more_way_before_a_position_has_jumped() -> None:
    """1 mm a cycle: 3 mm after two that stayed out."""
    for place, jumps in ((3000, False), (3001, True), (-3000, False), (-3001, True)):
        bench = Bench(jump_mm=1.0)
        bench.cycle(OPERATES, 0)
        for _ in range(2):
            bench.data.forget()
            bench.drive.take()
        bench.cycle(OPERATES, place)
        assert bench.drive.has_jumped is jumps


def test_a_drive_is_led_into_operation_from_a_proved_place_and_goes_on_without_one() -> None:
    """S-0-0051 over the service channel; a new reference has to be proved while it follows."""
    bench = Bench(proves_places=True)
    bench.drive.order(PowerOrder.SWITCH_ON)
    assert bench.cycle(0x8000, 4000) & ~TOGGLE == 0
    bench.drive.find_place()
    assert bench.channel.asked == [(51, READ_VALUE)]
    bench.channel.answer((4000).to_bytes(4, "little"))
    bench.drive.find_place()
    assert bench.cycle(0x8000, 4000) & ~TOGGLE == ON | ENABLE | RUN
    bench.cycle(OPERATES, 4000)
    bench.drive.forget_place()
    assert bench.cycle(OPERATES, 4000) & ~TOGGLE == ON | ENABLE | RUN
    assert bench.cycle(0x8000, 4000) & ~TOGGLE == 0


def test_a_slave_that_answers_again_is_not_blamed_for_what_comes_later() -> None:
    """900733 names it while it is silent; until somebody has asked anew it is a wrong counter."""
    bench = Bench(missing_cycles=0)
    silent = Silent(axis="Y", position=2, found=1, expected=2)
    for asked in (silent, None, silent, None):
        bench.cycle(OPERATES)
        bench.data.forget()
        bench.data.refused(3, 6)
        if asked is not None:
            bench.data.silent = asked
        with pytest.raises(Alarm) as caught:
            bench.drive.take()
        alarm = caught.value
        if asked is None:
            values = {"axis": "Z", "cycles": 1, "counter": 3, "expected": 6}
            assert (alarm.id, alarm.values) == (900731, values)
        else:
            values = {"axis": "Y", "position": 2, "found": 1, "expected": 2, "cycles": 1}
            assert (alarm.id, alarm.values) == (900733, values)


def test_it_says_nothing_by_itself_and_homing_by_it_is_refused() -> None:
    """Neither before a fault nor in it: what it is has to be asked for."""
    bench = Bench()
    for status in (OPERATES, C1D, OPERATES, C1D):
        bench.cycle(status)
        assert bench.drive.has_reported is False
    with pytest.raises(Alarm) as caught:
        bench.drive.home(None)  # type: ignore[arg-type]
    assert (caught.value.id, caught.value.values) == (900747, {"axis": "Z"})


def test_after_a_reset_a_procedure_command_goes_on_and_nobody_asks_for_it() -> None:
    """S-0-0170 runs (7): it is asked again and again; not after the reset, and by the next wait."""
    drives = {axis: Bench() for axis in ("Y", "Z")}
    accesses = SercosAccesses({axis: bench.drive for axis, bench in drives.items()})
    running, done = b"\x07\x00", b"\x03\x00"
    command, state = ident_number("S-0-0170"), (ident_number("S-0-0170"), Element.DATA_STATE)
    for axis in ("Z", "Y", "Z"):
        channel = drives[axis].channel
        channel.asked.clear()
        block = Block(1, 10, "")
        wait = DriveWait(block, axis, commands=True, key="S-0-0170")
        accesses.begin(wait)
        channel.answer(running)
        assert channel.asked == [state, state]
        assert (accesses.is_waiting, accesses.is_busy) == (True, True)
        accesses.reset()
        assert (accesses.is_waiting, accesses.is_busy) == (False, True)
        channel.answer(running)
        assert channel.asked == [state, state]  # not asked again, not cancelled
        assert not accesses.is_busy
        accesses.begin(wait)
        channel.answer(running)
        channel.answer(done)
        assert channel.asked[2:] == [state, state, (command, b"\x00\x00")]
        assert accesses.is_waiting
        channel.answer()
        assert (accesses.is_waiting, accesses.is_busy) == (False, False)
        accesses.check()


def _look_for_a_place(bench: Bench, cycles: int) -> None:
    for _ in range(cycles):
        bench.cycle(0x4000, 1000)
        bench.drive.find_place()
        while bench.channel.is_open:
            bench.channel.refuse(0x7002)


def test_a_place_that_the_drive_does_not_report_is_asked_for_again_and_then_an_alarm() -> None:
    """S-0-0051 over the service channel, ten times; the alarm has the words of the refusal."""
    bench = Bench(proves_places=True)
    with pytest.raises(Alarm) as caught:
        _look_for_a_place(bench, 100)
    assert caught.value.id == 900085
    assert caught.value.values["answer"] == str(SoeError(51, 0x7002))
    assert bench.channel.asked == [(51, READ_VALUE)] * 10
    assert not bench.drive.is_placed
