"""The homing of one axis against a drive that does what the test says."""

from collections.abc import Callable
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.axes.homing import Homing
from axisrig.kernel.drives.cia402.homing import (
    BLIND_CYCLES,
    MODE_POLLS_MAX,
    SDO_CYCLES,
    AxisHoming,
    Phase,
)
from axisrig.kernel.drives.cia402.objects import SdoError
from axisrig.kernel.drives.cia402.settings import HOMING_LIMIT_NS
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS, S, TimeNs

MODE, DISPLAY, METHOD, ERROR = 0x6060, 0x6061, 0x6098, 0x603F
ATTAINED, AT_REST, FAILED = 1 << 12, 1 << 10, 1 << 13
CSP, HOMING = 8, 6


class Drive:
    """Objects that answer at once; refuses: objects that cannot be written or read."""

    def __init__(self, *, mode_in_pdo: bool = False, refuses: tuple[int, ...] = ()) -> None:
        self.objects = {MODE: CSP, DISPLAY: CSP, METHOD: 17, ERROR: 0x7305}
        self.mode_in_pdo, self.refuses = mode_in_pdo, refuses
        self.follows = True
        self.node_id = 3
        self.name, self.sdo = "Z", self
        self.mode_bits, self.statusword, self.leads_itself = 0, 0, False
        self.may_jump = self.is_placed = False
        self.proof_cycles = 2
        self.place_mm = 0.0

    def forget_place(self) -> None:
        self.is_placed, self._asked = False, 0

    def find_place(self) -> None:
        assert not self.may_jump, "a place that may jump proves nothing"
        self._asked += 1
        self.is_placed = self._asked >= self.proof_cycles

    def home(self, _clock: Any) -> AxisHoming:
        return homing(self)[0]

    def set_object(self, index: int, sub: int, value: int) -> None:
        if not self.mode_in_pdo:
            raise KeyError(index)
        self._take(index, value)

    def _take(self, index: int, value: int) -> None:
        self.objects[index] = value
        if self.follows:
            self.objects[DISPLAY] = self.objects[MODE]

    def read(self, index: int, sub: int, done: Callable[[Any], None]) -> None:
        if index in self.refuses:
            done(SdoError(index, sub, 0x06020000))
        else:
            done(self.objects[index].to_bytes(2, "little"))

    def write(self, index: int, sub: int, data: bytes, done: Callable[[Any], None]) -> None:
        if index in self.refuses:
            done(SdoError(index, sub, 0x06090030))
        else:
            self._take(index, data[0])
            done(b"")


def homing(drive: Drive, limit_ns: TimeNs = HOMING_LIMIT_NS) -> tuple[AxisHoming, SimpleNamespace]:
    clock = SimpleNamespace(now_ns=0)
    return AxisHoming(drive, clock, drive.sdo, limit_ns), clock  # type: ignore[arg-type]


def cycles(axis: AxisHoming, count: int) -> None:
    for _ in range(count):
        axis.step()


@pytest.mark.parametrize("mode_in_pdo", [False, True])
def test_the_course_of_a_homing(mode_in_pdo: bool) -> None:
    drive = Drive(mode_in_pdo=mode_in_pdo)
    axis, _ = homing(drive)
    assert drive.leads_itself
    cycles(axis, 4 * SDO_CYCLES)
    assert (drive.objects[MODE], drive.mode_bits, axis.phase) == (HOMING, 1 << 4, Phase.SEARCHING)
    cycles(axis, 100)
    assert axis.phase is Phase.SEARCHING
    for word in (ATTAINED, AT_REST):
        drive.statusword = word
        cycles(axis, 5)
        assert axis.phase is Phase.SEARCHING  # home is known or the axis is at rest, not both
    drive.statusword = ATTAINED | AT_REST
    cycles(axis, 4 * SDO_CYCLES)
    assert (drive.objects[MODE], drive.mode_bits, axis.phase) == (CSP, 0, Phase.DONE)
    assert not drive.leads_itself


def test_a_reference_of_before_is_not_taken_for_the_new_one() -> None:
    drive = Drive()
    drive.statusword = ATTAINED | AT_REST
    axis, _ = homing(drive)
    cycles(axis, 4 * SDO_CYCLES)
    cycles(axis, BLIND_CYCLES - 2 * SDO_CYCLES)
    drive.statusword = 0  # now the drive has seen the start
    cycles(axis, 100)
    assert axis.phase is Phase.SEARCHING


@pytest.mark.parametrize("word", [ATTAINED | AT_REST, FAILED])
def test_bits_of_before_count_for_nothing_in_the_first_16_cycles_of_each_search(word: int) -> None:
    """They may be those of an earlier homing; in the 17th cycle they are of this one."""
    drive = Drive()
    for _ in range(2):
        drive.statusword = word
        axis, _ = homing(drive)
        while axis.phase is not Phase.SEARCHING:
            axis.step()
        cycles(axis, 16 - 1)
        assert axis.phase is Phase.SEARCHING
        axis.step()
        assert axis.phase is (Phase.EXPLAINING if word == FAILED else Phase.PROVING)
        axis.abort()
        cycles(axis, 20 * SDO_CYCLES)


@pytest.mark.provokes(900190, 4, axis="Z", method=17, error="0x7305", statusword="0x2000")
def test_bit_13_is_an_alarm_with_what_the_drive_tells() -> None:
    drive = Drive()
    axis, _ = homing(drive)
    cycles(axis, 4 * SDO_CYCLES)
    drive.statusword = FAILED
    with pytest.raises(Alarm, match="reports an error"):
        cycles(axis, BLIND_CYCLES + 4 * SDO_CYCLES)


def test_the_alarm_has_the_status_word_of_the_failure_and_not_a_later_one() -> None:
    """The drive takes its bit back while it is asked for method and error."""
    drive = Drive()
    axis, _ = homing(drive)
    cycles(axis, 4 * SDO_CYCLES)
    drive.statusword = FAILED | 0x0237
    cycles(axis, BLIND_CYCLES)
    assert axis.phase is Phase.EXPLAINING
    drive.statusword = 0x0217
    with pytest.raises(Alarm) as caught:
        cycles(axis, 4 * SDO_CYCLES)
    assert caught.value.values["statusword"] == "0x2237"


@pytest.mark.parametrize(("limit_ns", "limit"), [(HOMING_LIMIT_NS, "300 s"), (S // 2, "0.5 s")])
def test_a_homing_without_end_is_an_alarm(limit_ns: TimeNs, limit: str) -> None:
    drive = Drive()
    axis, clock = homing(drive, limit_ns)
    cycles(axis, 4 * SDO_CYCLES + BLIND_CYCLES)
    clock.now_ns = limit_ns
    cycles(axis, 1)
    clock.now_ns += MS
    with pytest.raises(Alarm, match=f"not at its end after {limit}"):
        cycles(axis, 4 * SDO_CYCLES)


def test_a_drive_without_bit_10_is_named_by_the_alarm() -> None:
    drive = Drive()
    axis, clock = homing(drive, S)
    cycles(axis, 4 * SDO_CYCLES + BLIND_CYCLES)
    drive.statusword = ATTAINED
    clock.now_ns = S + MS
    with pytest.raises(Alarm, match="bit 12 of 6041 is set, bit 10 is not"):
        cycles(axis, 4 * SDO_CYCLES)


@pytest.mark.provokes(900011, 4, axis="Z", node=3)
@pytest.mark.parametrize("refused", [MODE, DISPLAY])
def test_a_drive_that_does_not_take_the_mode(refused: int) -> None:
    axis, _ = homing(Drive(refuses=(refused,)))
    with pytest.raises(Alarm, match="900011"):
        cycles(axis, 10 * SDO_CYCLES)


def test_a_drive_that_does_not_change_its_mode() -> None:
    drive = Drive()
    drive.follows = False
    axis, _ = homing(drive)
    with pytest.raises(Alarm, match="6061 shows mode 8"):
        cycles(axis, (MODE_POLLS_MAX + 5) * SDO_CYCLES)


def test_an_axis_that_is_home_is_held_while_others_of_its_group_look_for_it() -> None:
    """X stands by a droop beside its set position: led by its actual one it would creep on."""
    drives, clock = {name: Drive() for name in "XZ"}, SimpleNamespace(now_ns=0)
    put: list[tuple[str, float]] = []
    path = SimpleNamespace(put=lambda axis, at_mm: put.append((axis, at_mm)))
    group = Homing([("X", "Z")], path, drives, clock)  # type: ignore[arg-type]
    drives["X"].statusword = ATTAINED | AT_REST
    for cycle in range(200):
        drives["X"].place_mm = -0.001 * cycle
        assert not group.step()
    last_mm = [at_mm for axis, at_mm in put if axis == "X"][-1]
    assert -0.06 < last_mm < 0.0
    assert [axis for axis, _ in put[-100:]] == ["Z"] * 100
    assert list(group.abort()) == ["Z"]


class LateDrive(Drive):
    """Answers so many cycles late, in the order of the requests."""

    def __init__(self, late: int, **options: Any) -> None:
        super().__init__(**options)
        self.late, self._now = late, 0
        self._waiting: list[tuple[int, Callable[[], None]]] = []

    def read(self, index: int, sub: int, done: Callable[[Any], None]) -> None:
        self._put(lambda: super(LateDrive, self).read(index, sub, done))

    def write(self, index: int, sub: int, data: bytes, done: Callable[[Any], None]) -> None:
        self._put(lambda: super(LateDrive, self).write(index, sub, data, done))

    def _put(self, answer: Callable[[], None]) -> None:
        self._waiting.append((self._now + self.late, answer))

    def cycle(self) -> None:
        self._now += 1
        while self._waiting and self._waiting[0][0] <= self._now:
            self._waiting.pop(0)[1]()


@pytest.mark.parametrize("late", [0, 7])
@pytest.mark.parametrize("mode_in_pdo", [False, True])
def test_a_homing_that_is_broken_off_anywhere_leads_the_drive_back(
    mode_in_pdo: bool, late: int
) -> None:
    """Also before 6061 is known, and while the drive still has to answer what was asked before."""
    was_homing = 0
    for broken_off in range(12 * SDO_CYCLES):
        drive = LateDrive(late, mode_in_pdo=mode_in_pdo)
        axis, _ = homing(drive)
        for cycle in range(30 * SDO_CYCLES):
            if cycle == broken_off:
                was_homing += drive.objects[MODE] == HOMING
                axis.abort()
                assert drive.mode_bits == 0
            drive.cycle()
            axis.step()
        shown = drive.objects[MODE], drive.objects[DISPLAY]
        assert (shown, drive.mode_bits, axis.phase) == ((CSP, CSP), 0, Phase.DONE)
        assert not drive.leads_itself
    assert was_homing > 10


class NotingDrive(Drive):
    """Notes which modes it was given."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.modes: list[int] = []

    def _take(self, index: int, value: int) -> None:
        self.modes.append(value)
        super()._take(index, value)


@pytest.mark.parametrize("mode_in_pdo", [False, True])
def test_a_homing_that_is_broken_off_sends_no_drive_into_homing_any_more(mode_in_pdo: bool) -> None:
    """A request that waits for its turn is none any more, at whatever cycle it is broken off."""
    for broken_off in range(12 * SDO_CYCLES):
        drive = NotingDrive(mode_in_pdo=mode_in_pdo)
        axis, _ = homing(drive)
        cycles(axis, broken_off)
        axis.abort()
        drive.modes.clear()
        cycles(axis, 30 * SDO_CYCLES)
        assert HOMING not in drive.modes, broken_off
        assert drive.objects[MODE] == CSP


def test_breaking_off_what_is_over_asks_for_nothing() -> None:
    drive = Drive()
    axis, _ = homing(drive)
    axis.abort()
    assert axis.phase is Phase.DONE
    axis.abort()
    drive.refuses = (MODE, DISPLAY)
    cycles(axis, 10 * SDO_CYCLES)


@pytest.mark.provokes(900011, 4, axis="Z", node=3)
def test_a_drive_that_stays_in_homing_is_an_alarm_of_the_way_back() -> None:
    drive = Drive()
    axis, _ = homing(drive)
    cycles(axis, 4 * SDO_CYCLES)
    drive.follows = False
    axis.abort()
    with pytest.raises(Alarm, match="6061 shows mode 6"):
        cycles(axis, (MODE_POLLS_MAX + 5) * SDO_CYCLES)


class SlowDrive(Drive):
    """Shows another mode only after so many readings of 6061; METHOD and ERROR are bytes."""

    def __init__(self, readings: int, method: bytes = b"\x11", error: bytes = b"\0\0") -> None:
        super().__init__()
        self.readings, self._left = readings, 0
        self._bytes = {METHOD: method, ERROR: error}

    def _take(self, index: int, value: int) -> None:
        self.objects[index], self._left = value, self.readings

    def read(self, index: int, sub: int, done: Callable[[Any], None]) -> None:
        if index == DISPLAY:
            self._left -= 1
            if self._left < 0:
                self.objects[DISPLAY] = self.objects[MODE]
            done(bytes((self.objects[DISPLAY],)))
        else:
            done(self._bytes[index])


def test_the_way_back_may_take_as_many_readings_as_the_way_there() -> None:
    drive = SlowDrive(MODE_POLLS_MAX - 1)
    axis, _ = homing(drive)
    cycles(axis, (MODE_POLLS_MAX + 3) * SDO_CYCLES)
    assert axis.phase is Phase.SEARCHING
    drive.statusword = ATTAINED | AT_REST
    cycles(axis, BLIND_CYCLES + (MODE_POLLS_MAX + 3) * SDO_CYCLES)
    assert axis.phase is Phase.DONE


@pytest.mark.parametrize(
    ("method", "error", "shown"),
    [(b"\xfd", b"\x01\xff", (-3, "0xFF01")), (b"\x23", b"\x05\x73", (35, "0x7305"))],
)
def test_the_alarm_names_method_and_error_as_their_objects_count(
    method: bytes, error: bytes, shown: tuple[int, str]
) -> None:
    """6098 is signed, with methods of the maker below 0; 603F is not."""
    drive = SlowDrive(0, method, error)
    axis, _ = homing(drive)
    cycles(axis, 4 * SDO_CYCLES)
    drive.statusword = FAILED
    with pytest.raises(Alarm) as caught:
        cycles(axis, BLIND_CYCLES + 4 * SDO_CYCLES)
    assert (caught.value.values["method"], caught.value.values["error"]) == shown


@pytest.mark.parametrize("after_cycles", [0, 4 * SDO_CYCLES, 4 * SDO_CYCLES + BLIND_CYCLES])
def test_positions_may_jump_while_a_drive_looks_for_its_home_and_never_afterwards(
    after_cycles: int,
) -> None:
    """Also where it is broken off before its mode is known."""
    drive = Drive()
    axis, _ = homing(drive)
    cycles(axis, after_cycles)
    assert (drive.may_jump, drive.leads_itself) == (True, True)
    axis.abort()
    cycles(axis, 10 * SDO_CYCLES)
    assert axis.is_done
    assert (drive.may_jump, drive.leads_itself) == (False, False)


class CountedDrive(Drive):
    """Notes in which cycle it was read."""

    cycle = 0

    def __init__(self) -> None:
        super().__init__()
        self.follows = False
        self.asked: list[int] = []

    def read(self, index: int, sub: int, done: Callable[[Any], None]) -> None:
        self.asked.append(self.cycle)
        super().read(index, sub, done)


def test_between_two_questions_of_a_homing_are_some_cycles() -> None:
    """A bus with little room has an SDO frame in every fourth cycle at most."""
    drive = CountedDrive()
    axis, _ = homing(drive)
    for drive.cycle in range(1, 20 * SDO_CYCLES):
        axis.step()
    gaps = {after - before for before, after in pairwise(drive.asked)}
    assert drive.asked[0] == SDO_CYCLES
    assert gaps == {SDO_CYCLES, 2 * SDO_CYCLES}  # the write lies between two readings


class DriveOfMaker(Drive):
    """A drive whose modes are bytes with a sign, as CiA 402 has 6060 and 6061."""

    def read(self, index: int, sub: int, done: Callable[[Any], None]) -> None:
        done(self.objects[index].to_bytes(1, "little", signed=True))

    def write(self, index: int, sub: int, data: bytes, done: Callable[[Any], None]) -> None:
        assert len(data) == 1
        self._take(index, int.from_bytes(data, "little", signed=True))
        done(b"")


@pytest.mark.parametrize("mode", [CSP, 9, -1, -128])
@pytest.mark.parametrize("mode_in_pdo", [False, True])
def test_the_mode_of_before_comes_back_also_one_of_the_maker(mode: int, mode_in_pdo: bool) -> None:
    """Modes below 0 are those of the maker (CiA 402-2, 6060)."""
    drive = DriveOfMaker(mode_in_pdo=mode_in_pdo)
    drive.objects[MODE] = drive.objects[DISPLAY] = mode
    axis, _ = homing(drive)
    cycles(axis, 4 * SDO_CYCLES)
    assert (drive.objects[MODE], axis.phase) == (HOMING, Phase.SEARCHING)
    cycles(axis, BLIND_CYCLES)
    drive.statusword = ATTAINED | AT_REST
    cycles(axis, 4 * SDO_CYCLES)
    assert (drive.objects[MODE], axis.phase) == (mode, Phase.DONE)
