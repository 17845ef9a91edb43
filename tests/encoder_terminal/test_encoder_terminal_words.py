"""An encoder terminal: counter and latch that wrap, CNT_SET, images; both ends."""

import pytest
from tests.speed_drive.ends import MILLISECOND, SETTINGS, Ends

from axisrig.bench.drive.encoder_terminal.unit import EncoderTerminal
from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.encoder_terminal.link import EncoderTerminalDrive
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.encoder_terminal import words
from axisrig.kernel.profiles.speed_drive import words as of_drive

LOW, SET = words.CNTSET_ACC, words.CNTSET_ACC | words.LAT_EXT_VAL
INCREMENT_UM = 10_000 / 4096
TURN_MM = 160.0


class Control:
    """The control's end; give: images from the terminal."""

    def __init__(self, kept: int = 0) -> None:
        self.port = ImagePort()
        self.drive = EncoderTerminalDrive(SETTINGS, self.port, lambda: kept)
        self.drive.order(PowerOrder.SWITCH_ON)
        for status in (0, 0, 0, LOW, LOW):
            self.give(status, kept)

    def give(self, status: int, counter: int, latch: int = 0, drive: int = 3) -> dict[str, int]:
        """Give an image; return what the control sends."""
        values = {"DRIVE": drive, "STATUS": status, "COUNTER": counter % 65536, "LATCH": latch}
        self.port.receive(words.FROM_TERMINAL.packed(values))
        self.drive.take()
        self.drive.send(self.drive.actual_mm)
        assert self.port.outputs is not None
        self.drive.begin_cycle()
        return words.TO_TERMINAL.values_of(self.port.outputs)


def armed(kept: int) -> Control:
    control = Control(kept)
    assert control.drive.is_clear
    control.drive.arm()
    for _ in range(3):
        control.give(LOW, kept)
    assert control.drive.is_armed
    return control


def test_images_have_6_bytes_of_the_terminal_each_way() -> None:
    assert (words.TO_TERMINAL.codec.size, words.FROM_TERMINAL.codec.size) == (3 + 6, 1 + 6)
    data = words.FROM_TERMINAL.packed({"STATUS": 2, "COUNTER": 0xFFFE, "LATCH": 3})
    assert data[-6:] == bytes.fromhex("02 fe ff 00 03 00")


def test_latch_3_and_counter_fffe_are_12_2_um_and_not_160_mm() -> None:
    """5 increments of 10 mm / 4096; without the wrap it were -65 531 of them."""
    control = armed(0)
    for _ in range(2):
        control.give(SET, 0xFFFE, 3)
    found = control.drive.latched_mm
    assert found is not None
    ahead_um = (found - control.drive.actual_mm) * 1e3
    assert ahead_um == pytest.approx(5 * INCREMENT_UM) == pytest.approx(12.207, abs=1e-3)
    assert abs(-65_531 * INCREMENT_UM / 1e3 + TURN_MM) < 0.02


@pytest.mark.parametrize("step", [-1000, 1000])
def test_a_counter_that_wraps_is_counted_on(step: int) -> None:
    control = Control(100_000)
    for number in range(1, 300):
        control.give(LOW, 100_000 + step * number)
    assert control.drive.actual_increments == 100_000 + step * 299


@pytest.mark.parametrize("behind", [-32_768, -1, 0, 1, 32_767])
def test_a_latch_is_at_most_half_a_turn_away(behind: int) -> None:
    control = armed(70_000)
    for _ in range(2):
        control.give(SET, 70_000, (70_000 + behind) % 65_536)
    assert control.drive.latched_mm == (70_000 + behind) / 409.6


def test_the_place_is_that_of_the_telegram_that_brought_the_value() -> None:
    """An axis that goes on for more than half a turn changes nothing of it."""
    control = armed(0)
    control.give(SET, 0xFFFE, 3)
    for number in range(1, 60):
        control.give(SET, 0xFFFE - 1000 * number, 3)
    assert control.drive.latched_mm == 3 / 409.6


def test_a_latch_at_the_zero_pulse_is_none() -> None:
    control = armed(0)
    for _ in range(4):
        control.give(SET | words.LATC_VAL, 0, 3)
    assert (control.drive.latched_mm, control.drive.has_latched) == (None, False)


def test_a_second_pulse_changes_nothing() -> None:
    terminal = EncoderTerminal()
    terminal.reset(0)
    terminal.command({"CONTROL": words.EN_LAT_EXT}, 0)
    assert terminal.edges() == (True,)
    terminal.pulse(True, 3)
    assert terminal.edges() == ()
    terminal.pulse(True, 9)
    assert terminal.inputs(0xFFFE, level=True) == {
        "STATUS": words.LAT_EXT_VAL | words.LEVEL, "COUNTER": 0xFFFE, "LATCH": 3,
    }  # fmt: skip


def test_the_counter_is_set_at_an_edge_of_cnt_set_alone() -> None:
    terminal = EncoderTerminal()
    terminal.reset(777)
    assert terminal.inputs(778, level=False)["COUNTER"] == 1
    ordered = {"CONTROL": words.CNT_SET, "SET": 5}
    terminal.command(ordered, 778)  # high since power on: no edge
    assert terminal.inputs(778, level=False) == {"STATUS": 0, "COUNTER": 1, "LATCH": 0}
    terminal.command({}, 778)
    terminal.command(ordered, 778)
    terminal.command(ordered, 800)
    assert terminal.inputs(800, level=False) == {"STATUS": LOW, "COUNTER": 27, "LATCH": 0}


def test_no_axis_is_led_before_its_counter_was_set() -> None:
    control = Control.__new__(Control)
    control.port = ImagePort()
    control.drive = EncoderTerminalDrive(SETTINGS, control.port, lambda: 53_248)
    control.drive.order(PowerOrder.SWITCH_ON)
    sent = [control.give(status, 0, drive=1) for status in (0, 0, 0, 0, LOW)]
    assert [each["CONTROL"] for each in sent] == [0, 0, *[words.CNT_SET] * 3]
    assert [each["DRIVE"] for each in sent] == [0, 0, 0, 0, of_drive.ENABLE]
    assert sent[-1]["SET"] == 53_248


@pytest.mark.parametrize("accepted", [1, 2])
def test_a_counter_that_was_set_before_counts_only_once_it_is_set_anew(accepted: int) -> None:
    """CNT_SET is high from the third image on, and only its edge sets: what is there is old."""
    control = Control.__new__(Control)
    control.port = ImagePort()
    control.drive = EncoderTerminalDrive(SETTINGS, control.port, lambda: 53_248)
    control.drive.order(PowerOrder.SWITCH_ON)
    for _ in range(accepted):
        sent = control.give(LOW, 17, drive=1)
        assert (sent["CONTROL"], sent["DRIVE"]) == (0, 0)
        assert (control.drive.is_placed, control.drive.actual_increments) == (False, 53_248)
    for _ in range(3):
        control.give(0, 17, drive=1)
        assert not control.drive.is_placed
    control.give(LOW, 53_249, drive=1)
    assert (control.drive.is_placed, control.drive.actual_increments) == (True, 53_249)


@pytest.mark.provokes(900781, 7, axis="Z")
def test_900781_for_a_terminal_that_was_without_power() -> None:
    control = armed(0)
    sent = control.give(0, 0, drive=1)
    assert not control.drive.is_placed
    assert sent["DRIVE"] == 0
    for _ in range(4):
        control.give(SET, 4000, 3)
    assert control.drive.latched_mm is None
    assert control.drive.actual_mm == 0.0
    with pytest.raises(Alarm) as raised:
        control.drive.find_place()
    assert raised.value.id == 900781


@pytest.mark.provokes(900780, 7, axis="Z", cycles="2")
def test_900780_where_images_stay_out() -> None:
    control = Control()
    control.drive.take()
    assert not control.drive.has_actual
    with pytest.raises(Alarm) as raised:
        control.drive.take()
    assert raised.value.id == 900780


def test_a_drive_that_stops_by_order_gets_a_ramp() -> None:
    """1000 mm/s2: 1 mm/s less in each cycle of 1 ms."""
    control = Control()
    drive = control.drive
    control.port.receive(words.FROM_TERMINAL.packed({"DRIVE": 3, "STATUS": LOW}))
    drive.take()
    drive.send(0.25)
    drive.order(PowerOrder.STOP)
    speeds = [control.give(LOW, 0)["SPEED"] for _ in range(4)]
    assert speeds == [round(each * 32767 / 500) for each in (1.5, 0.5, 0.0, 0.0)]


def test_both_ends_come_into_operation_together() -> None:
    ends = Ends("encoder_terminal", lambda _time_s: 0.0805, [], MILLISECOND)
    for _ in range(12):
        ends.cycle()
    assert ends.link.state_name == "OPERATION"
    assert ends.link.actual_mm == pytest.approx(80.5, abs=INCREMENT_UM / 1e3)
    assert ends.link.is_clear


def test_without_images_the_outputs_fall_to_0() -> None:
    """watchdog_cycles = 3: the fourth lost image; CNT_SET falls with the others."""
    ends = Ends("encoder_terminal", lambda _time_s: 0.0805, [], MILLISECOND)
    for _ in range(12):
        ends.cycle()
    ends.segment.loses = lambda _axis: True
    for _ in range(4):
        ends.cycle()
    with pytest.raises(Alarm) as raised:
        ends.cycle()
    assert (raised.value.id, ends.link.state_name) == (900781, "READY")


@pytest.mark.parametrize("place", [-3, 70_000, -70_000, 0])
@pytest.mark.parametrize("began_at", [0, 12, -40_000])
def test_counter_and_latch_wrap_alike_in_both_directions(place: int, began_at: int) -> None:
    """16 bits from 0 at power on; an edge that is latched there is what the counter shows there."""
    unit = EncoderTerminal()
    unit.reset(began_at)
    unit.command({"CONTROL": words.EN_LAT_EXT, "SET": 0}, began_at)
    assert unit.inputs(began_at, level=False)["COUNTER"] == 0
    unit.pulse(True, place)
    shown = unit.inputs(place, level=True)
    expected = (place - began_at) & 0xFFFF
    assert (shown["COUNTER"], shown["LATCH"]) == (expected, expected)
    assert shown["STATUS"] == words.LAT_EXT_VAL | words.LEVEL
    unit.command({"CONTROL": words.CNT_SET | words.EN_LAT_EXT, "SET": 100}, place)
    unit.command({"CONTROL": words.EN_LAT_EXT, "SET": 100}, place)
    unit.command({"CONTROL": words.CNT_SET | words.EN_LAT_EXT, "SET": 0xFFFF}, place)
    assert unit.inputs(place + 2, level=False)["COUNTER"] == 1


def test_a_terminal_is_asked_for_nothing_before_its_first_image() -> None:
    """The place that was kept is asked for with it, and a measuring run may have begun before."""
    asked: list[int] = []
    port = ImagePort()
    drive = EncoderTerminalDrive(SETTINGS, port, lambda: asked.append(1) or 4711)
    drive.order(PowerOrder.SWITCH_ON)
    drive.arm()
    drive.send(0.0)
    assert port.outputs is not None
    sent = words.TO_TERMINAL.values_of(port.outputs)
    assert (sent["CONTROL"], sent["SET"], asked) == (0, 0, [])
    port.receive(words.FROM_TERMINAL.packed({"DRIVE": 1}))
    drive.take()
    drive.send(0.0)
    assert words.TO_TERMINAL.values_of(port.outputs)["SET"] == 4711
    assert asked == [1]
