"""The control's end of a PROFIdrive drive: what it takes for a value and what it sends."""

from dataclasses import replace

import pytest

from axisrig.kernel.drives.cyclic.carrier import CyclicCarrier, ImagePort
from axisrig.kernel.drives.position_loop import LoopSettings
from axisrig.kernel.drives.power import Power, PowerOrder
from axisrig.kernel.drives.profidrive.encoder import EncoderControl
from axisrig.kernel.drives.profidrive.link import ProfidriveDrive
from axisrig.kernel.drives.profidrive.settings import ProfidriveSettings
from axisrig.kernel.drives.profidrive.watch import ProfidriveWatch
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.profidrive import words
from axisrig.kernel.time.clock import MS

ECHO = 2
POS, NEG = words.FUNCTION_OF[1, "POS"], words.FUNCTION_OF[1, "NEG"]
READING = POS | words.READ << words.COMMAND_SHIFT | words.FLYING
SETTINGS = ProfidriveSettings(
    axis="Z",
    increments_per_mm=419_430.4,
    telegram=words.telegrams()[5],
    speed_counts=393_216.0,
    period_s=1e-3,
    gain=16_667,
    proves_places=False,
    missing_cycles=1,
)


@pytest.fixture
def armed() -> EncoderControl:
    """One that has seen a clear interface and the active function."""
    control = EncoderControl(POS, ECHO)
    cycles(control, (0, 0), (0, 0))
    assert control.is_clear
    control.arm()
    cycles(control, (0, 0), (0, 0), (POS, 0))
    assert control.is_armed
    return control


def cycles(control: EncoderControl, *telegrams: tuple[int, int]) -> None:
    """Send and take: G1_ZSW and G1_XIST2 of each cycle."""
    for status, value in telegrams:
        control.take(status, value, 0)
        _ = control.control


def test_a_value_counts_when_it_was_read_and_two_telegrams_have_it(armed: EncoderControl) -> None:
    cycles(armed, (POS << 4, 99))
    assert armed.has_latched
    assert armed.control == READING
    assert armed.increments is None
    cycles(armed, (POS << 4, 99), (POS << 4, 1234))
    assert armed.increments is None
    cycles(armed, (POS << 4, 1234))
    assert armed.increments == 1234


def test_two_telegrams_with_different_values_prove_none(armed: EncoderControl) -> None:
    cycles(armed, (POS << 4, 0), (POS << 4, 0), (POS << 4, 1), (POS << 4, 2), (POS << 4, 3))
    assert armed.increments is None


def test_an_error_code_is_never_a_value(armed: EncoderControl) -> None:
    cycles(armed, *[(POS << 4 | words.ENCODER_ERROR, 6)] * 6)
    assert (armed.increments, armed.has_latched, armed.error) == (None, False, 6)


@pytest.mark.parametrize("other", [words.ABSOLUTE, words.PARK, words.ACKNOWLEDGING, NEG])
def test_what_shows_something_else_is_never_a_value(armed: EncoderControl, other: int) -> None:
    """Absolute position, parking, or a function that still waits."""
    cycles(armed, (POS << 4, 0), *[(POS << 4 | other, 77)] * 5)
    assert armed.increments is None


def test_a_value_of_an_earlier_run_is_none(armed: EncoderControl) -> None:
    """It has to be cleared before, and the clearing to be seen."""
    armed.disarm()
    cycles(armed, *[(POS << 4, 5)] * 4)
    assert not armed.is_clear
    assert armed.control == POS | words.ABORT << words.COMMAND_SHIFT | words.FLYING
    armed.arm()  # nobody may, and nothing comes of it
    cycles(armed, *[(POS << 4, 5)] * 8)
    assert (armed.increments, armed.has_latched) == (None, False)


@pytest.mark.parametrize("moved", [7, -7, 0])
@pytest.mark.parametrize("place", [0, 2**31 - 3, -(2**31) + 3])
def test_the_speed_at_a_latch_is_that_of_its_cycle_also_where_the_position_wraps(
    armed: EncoderControl, place: int, moved: int
) -> None:
    after = (place + moved + 2**31) % 2**32 - 2**31  # G1_XIST1 has 32 bits and a sign
    armed.take(POS, 0, place)
    armed.take(POS << 4, 99, after)
    assert (armed.has_latched, armed.speed_increments) == (True, moved)


def test_an_error_is_acknowledged_before_the_next_run(armed: EncoderControl) -> None:
    armed.disarm()
    cycles(armed, *[(words.ENCODER_ERROR, 6)] * 4)
    assert (armed.control, armed.is_clear) == (words.ENCODER_ACKNOWLEDGE, False)
    cycles(armed, (words.ACKNOWLEDGING, 0), (words.ACKNOWLEDGING, 0))
    assert (armed.control, armed.is_clear) == (0, False)
    cycles(armed, (0, 0), (0, 0))
    assert armed.is_clear


@pytest.mark.parametrize("is_active", [True, False])
def test_a_run_that_the_drive_refuses_waits_for_nothing(is_active: bool) -> None:
    """It is armed with the error, which the watch names; without any word it is not."""
    control = EncoderControl(POS, ECHO)
    cycles(control, (0, 0), (0, 0))
    control.arm()
    cycles(control, (0, 0), (0, 0))
    if is_active:
        cycles(control, (POS, 0))
    assert control.is_armed is is_active
    cycles(control, (words.ENCODER_ERROR, 3))
    assert (control.error, control.is_armed, control.has_latched) == (3, True, False)
    control.disarm()
    assert not control.is_armed


def test_an_absolute_position_is_asked_for_between_runs(armed: EncoderControl) -> None:
    found: list[int | str] = []
    assert not armed.ask_absolute(found.append)
    armed.disarm()
    cycles(armed, *[(0, 0)] * 4)
    assert armed.ask_absolute(found.append)
    cycles(armed, (0, 0), (0, 0))
    assert armed.control == words.ABSOLUTE
    cycles(armed, (words.ABSOLUTE, 42), (words.ABSOLUTE, 42))
    assert found == [42]
    assert not armed.is_clear
    cycles(armed, (0, 0), (0, 0), (0, 0))
    assert armed.is_clear


# Telegrams


class Bus:
    """The far end of a port: gives a telegram, keeps what the control has sent."""

    def __init__(self, settings: ProfidriveSettings) -> None:
        self.port = ImagePort()
        self.drive = ProfidriveDrive(settings, self.port)
        self.carrier = CyclicCarrier("bus", {"Z": self.port}, self._begin)
        self._names = settings.telegram.to_drive
        self._codec = words.codec_of(self._names)
        self._inputs = words.codec_of(settings.telegram.from_drive)
        self._taken = settings.telegram.from_drive
        self.sent: dict[str, int] = {}
        self.life = 0
        self.values = {"ZSW1": 0x0237}

    def _begin(self, outputs: object) -> None:
        data = outputs["Z"]  # type: ignore[index]
        if data is not None:
            self.sent = dict(zip(self._names, self._codec.unpack(data), strict=True))

    def cycle(self, set_mm: float, *, is_new: bool = True, **values: int) -> dict[str, int]:
        """Run one cycle of the control; return what it has sent with it."""
        self.values |= values
        self.drive.begin_cycle()
        self.carrier.begin_cycle()
        if is_new:
            self.life = words.next_life(self.life)
        given = self.values | {"ZSW2": self.life << words.LIFE_SHIFT}
        self.port.receive(self._inputs.pack(*(given.get(name, 0) for name in self._taken)))
        self.drive.take()
        self.drive.find_place()
        self.drive.send(set_mm)
        self.drive.begin_cycle()
        self.carrier.begin_cycle()
        return self.sent


@pytest.fixture
def bus() -> Bus:
    made = Bus(SETTINGS)
    made.drive.order(PowerOrder.SWITCH_ON)
    return made


def test_dsc_gets_deviation_and_gain(bus: Bus) -> None:
    """1 mm of lag is 419 430 increments; 10 mm/s forward are 10 x 393 216 x share."""
    bus.cycle(1.0, G1_XIST1=0)
    sent = bus.cycle(1.0)
    assert (sent["XERR"], sent["KPC"], sent["NSOLL_B"]) == (419_430, 16_667, 0)
    forward = Bus(replace(SETTINGS, feed_forward=0.5))
    forward.drive.order(PowerOrder.SWITCH_ON)
    forward.cycle(1.0)
    assert forward.cycle(1.01)["NSOLL_B"] == 5 * 393_216


def test_a_loop_in_the_cnc_gives_a_speed_and_no_gain() -> None:
    """Kv 10 1/s and 1 mm: 10 mm/s."""
    loop = LoopSettings(kv_per_s=10.0, period_s=1e-3)
    bus = Bus(replace(SETTINGS, loop=loop, gain=0))
    bus.drive.order(PowerOrder.SWITCH_ON)
    bus.cycle(0.0)
    sent = bus.cycle(1.0)
    assert (sent["NSOLL_B"], sent["XERR"], sent["KPC"]) == (10 * 393_216, 0, 0)
    assert bus.drive.lag_mm == 1.0


@pytest.mark.parametrize("feed_forward", [0.0, 1.0])
def test_the_loop_of_the_cnc_begins_where_the_drive_begins_to_follow(feed_forward: float) -> None:
    """Set positions that go on while it does not follow are no way that is still to be gone.

    10 1/s by 1 um, and 1 um in 1 ms: 0.01 and 1 mm/s, rounded to one count of NSOLL_B.
    """
    loop = LoopSettings(kv_per_s=10.0, period_s=1e-3, feed_forward=feed_forward)
    bus = Bus(replace(SETTINGS, loop=loop, gain=0))
    bus.drive.order(PowerOrder.SWITCH_ON)
    place = round(5.0 * SETTINGS.increments_per_mm)
    for set_mm in (4.0, 4.9):
        assert bus.cycle(set_mm, ZSW1=0x0233, G1_XIST1=place)["NSOLL_B"] == 0
        assert bus.drive.lag_mm == pytest.approx(set_mm - 5.0)
    bus.cycle(5.0, ZSW1=0x0237)
    sent = bus.cycle(5.001)
    demand_mm_s = feed_forward * 1.0 + 10.0 * 0.001
    assert sent["NSOLL_B"] == pytest.approx(demand_mm_s * 393_216, abs=0.5)
    sent = bus.cycle(5.001)
    assert sent["NSOLL_B"] == pytest.approx(10.0 * 0.001 * 393_216, abs=0.5)


def test_a_drive_that_does_not_follow_gets_standstill(bus: Bus) -> None:
    sent = bus.cycle(1.0, ZSW1=0x0233)
    assert (sent["XERR"], sent["NSOLL_B"]) == (0, 0)


def test_signs_of_life_run_from_1_to_15(bus: Bus) -> None:
    lives = [bus.cycle(0.0)["STW2"] >> words.LIFE_SHIFT for _ in range(16)]
    assert lives == [*range(1, 16), 1]


@pytest.mark.provokes(900764, 7, axis="Z", cycles="2")
def test_900764_where_the_sign_of_life_of_the_drive_stays(bus: Bus) -> None:
    bus.cycle(0.0, G1_XIST1=4194)
    bus.cycle(0.0, is_new=False, G1_XIST1=8388)
    assert not bus.drive.has_actual
    assert bus.drive.actual_increments == 4194
    with pytest.raises(Alarm) as raised:
        bus.cycle(0.0, is_new=False)
    assert raised.value.id == 900764


@pytest.mark.parametrize(
    ("status", "power", "word"),
    [
        (0x0270, Power.OFF, 0x047E),  # inhibited: off first
        (0x0231, Power.OFF, 0x047F),
        (0x0233, Power.OFF, 0x047F),
        (0x0237, Power.OPERATING, 0x047F),
        (0x0238, Power.FAULT, 0x047E),
    ],
)
def test_a_drive_is_led_into_operation(bus: Bus, status: int, power: Power, word: int) -> None:
    sent = bus.cycle(0.0, ZSW1=status)
    assert (bus.drive.power, sent["STW1"]) == (power, word)


def test_a_fault_is_acknowledged_where_the_rig_says_so(bus: Bus) -> None:
    bus.drive.acknowledges_faults = True
    assert bus.cycle(0.0, ZSW1=0x0238)["STW1"] == 0x04FE


def test_orders_of_power(bus: Bus) -> None:
    bus.cycle(0.0)
    bus.drive.order(PowerOrder.STOP)
    assert bus.cycle(0.0)["STW1"] == 0x043F
    assert bus.drive.power is Power.STOPPING
    bus.drive.order(PowerOrder.SWITCH_OFF)
    assert bus.cycle(0.0)["STW1"] == 0x047E


def test_a_second_encoder_comes_with_telegram_6() -> None:
    bus = Bus(replace(SETTINGS, telegram=words.telegrams()[6]))
    assert bus.drive.second_increments is None
    for place in (-5, 7):
        bus.cycle(0.0, G2_XIST1=place)
        assert (bus.drive.has_second, bus.drive.second_increments) == (True, place)
    assert [bus.drive.second_period_ns(period_ns) for period_ns in (1, 4 * MS)] == [1, 4 * MS]
    alone = Bus(SETTINGS)  # telegram 5
    alone.cycle(0.0)
    found = alone.drive.has_second, alone.drive.second_increments, alone.drive.second_period_ns(MS)
    assert found == (False, None, None)


@pytest.mark.parametrize(("absolute", "is_placed"), [(5, True), (4194304, False)])
def test_a_drive_is_led_only_from_the_place_that_its_absolute_position_gives(
    absolute: int, is_placed: bool
) -> None:
    bus = Bus(replace(SETTINGS, proves_places=True))
    bus.drive.order(PowerOrder.SWITCH_ON)
    raised = list[int]()
    for _ in range(60):
        asked = bool(bus.sent.get("G1_STW", 0) & words.ABSOLUTE)
        shown = {"G1_ZSW": words.ABSOLUTE, "G1_XIST2": absolute} if asked else {}
        try:
            bus.cycle(0.0, ZSW1=0x0231, G1_XIST1=5, **({"G1_ZSW": 0, "G1_XIST2": 0} | shown))
        except Alarm as alarm:
            raised.append(alarm.id)
    assert bus.drive.is_placed is is_placed
    assert bus.sent["STW1"] == (0x047F if is_placed else 0x047E)
    assert set(raised) == (set() if is_placed else {900084})


@pytest.mark.parametrize(
    ("status", "name"),
    [
        (0x0200, "NOT_READY"),
        (0x0201, "READY_TO_SWITCH_ON"),
        (0x0203, "SWITCHED_ON"),
        (0x0207, "OPERATION"),
        (0x0240, "SWITCHING_ON_INHIBITED"),
        (0x0247, "SWITCHING_ON_INHIBITED"),
        (0x020F, "FAULT"),
        (0x0248, "FAULT"),
    ],
)
def test_the_state_is_that_of_the_bit_that_counts_most(bus: Bus, status: int, name: str) -> None:
    bus.cycle(0.0, ZSW1=status)
    assert (bus.drive.state_name, bus.drive.status_text) == (name, f"0x{status:04X}")
    assert bus.drive.is_in_fault is (name == "FAULT")


def test_another_input_or_edge_is_another_function(bus: Bus) -> None:
    """G1_STW: bits 0 to 3 are the functions of probe 1 and 2, both edges; there and back.

    The same one again changes nothing of what is ordered.
    """
    chosen = ((1, "POS"), (2, "NEG"), (2, "POS"), (1, "NEG"), (1, "POS"))
    for number, function in zip(chosen, (1, 8, 4, 2, 1), strict=True):
        bus.drive.choose_latch(*number)
        for _ in range(4):
            assert bus.cycle(0.0, G1_ZSW=0, G1_XIST2=0)["G1_STW"] == 0
        bus.drive.arm()
        bus.drive.choose_latch(*number)
        for _ in range(4):
            assert bus.cycle(0.0, G1_ZSW=function)["G1_STW"] & 0xF == function
        assert (bus.drive.is_armed, bus.drive.has_latched) == (True, False)
        bus.cycle(0.0, G1_ZSW=function << 4, G1_XIST1=0)
        for _ in range(5):
            bus.cycle(0.0, G1_XIST2=419_430 * function)
        assert bus.drive.latched_mm == 419_430 * function / 419_430.4
        bus.drive.disarm()
        assert bus.cycle(0.0)["G1_STW"] & 0xF == function  # dropped with its own command
        assert not bus.drive.is_probing


@pytest.mark.parametrize(("probe_input", "deflected"), [(1, 0x0100), (2, 0x0200)])
def test_a_probe_is_actuated_at_the_level_that_its_edge_leads_to(
    bus: Bus, probe_input: int, deflected: int
) -> None:
    for edge in ("POS", "NEG"):
        bus.drive.choose_latch(probe_input, edge)
        for level, of_other in ((True, False), (False, True), (True, True), (False, False)):
            status = deflected * level | (deflected ^ 0x0300) * of_other
            bus.cycle(0.0, G1_ZSW=status)
            assert bus.drive.is_actuated is (level == (edge == "POS"))


@pytest.mark.parametrize("moved", [839, -839, 0])
def test_the_travel_at_a_latch_is_in_mm(bus: Bus, moved: int) -> None:
    """839 increments of 419 430.4 to a mm in the cycle of the latch; those before and after not."""
    for _ in range(4):
        bus.cycle(0.0, G1_ZSW=0, G1_XIST2=0, G1_XIST1=1000)
    bus.drive.arm()
    for _ in range(4):
        bus.cycle(0.0, G1_ZSW=POS)
    bus.cycle(0.0, G1_ZSW=POS << 4, G1_XIST1=1000 + moved)
    for number in range(4):
        bus.cycle(0.0, G1_XIST2=5, G1_XIST1=77 * number)
    assert bus.drive.latched_mm == 5 / 419_430.4
    assert bus.drive.latched_speed_mm == moved / 419_430.4


def test_homing_by_the_drive_is_refused(bus: Bus) -> None:
    with pytest.raises(Alarm) as raised:
        bus.drive.home(None)  # type: ignore[arg-type]
    assert (raised.value.id, raised.value.values) == (900765, {"axis": "Z"})


@pytest.mark.parametrize(
    ("code", "word"),
    [(1, "fault"), (2, "zero mark"), (4, "search"), (6, "measurement"), (0x0F01, "manufacturer")],
)
def test_900763_while_the_encoder_shows_an_error_and_what_it_means(
    bus: Bus, code: int, word: str
) -> None:
    """SINAMICS S120 4-113. On, off, on; a stop that is under way is not disturbed."""
    watch = ProfidriveWatch(bus.drive)
    for _ in range(2):
        bus.cycle(0.0, G1_ZSW=0, G1_XIST2=0)
        assert watch.condition() is None
        bus.cycle(0.0, G1_ZSW=words.ENCODER_ERROR, G1_XIST2=code)
        alarm = watch.condition()
        assert alarm is not None
        assert (alarm.id, alarm.values["axis"], alarm.values["code"]) == (900763, "Z", code)
        assert word in str(alarm.values["meaning"])
    bus.drive.order(PowerOrder.STOP)
    assert watch.condition() is None
