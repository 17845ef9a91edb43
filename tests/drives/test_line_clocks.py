"""Before SYNC0 begins every clock of a line has to follow, or its drive has an alarm."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.ethercat.frames import Answer, at_station
from axisrig.kernel.drives.ethercat.line_start import LineStart, Starting
from axisrig.kernel.drives.ethercat.settings import LineSettings, RegisterInputs, station_of
from axisrig.kernel.drives.ethercat.steps import Ask, DriveSteps, Pause
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.ethercat.tables import Command, address_of
from axisrig.kernel.time.clock import MS

LIMIT_NS, TIMEOUT_NS, PERIOD_NS = 500, 20 * MS, MS
SILENT = None
SIGN = 1 << 31
"""Bit 31 of 092C says that the clock is behind; the rest is the amount."""

SHIFT_NS = 300_000
LINE = LineSettings(
    name="ec1",
    period_ns=PERIOD_NS,
    shift_ns=SHIFT_NS,
    clock_limit_ns=LIMIT_NS,
    clock_timeout_ns=TIMEOUT_NS,
)


class Waiting:
    """Lets a line wait for its clocks. differences: of every slave, for each look in turn.

    drives: so many of the slaves have one, those behind them have none.
    """

    def __init__(self, *differences: list[int | None], drives: int = 3) -> None:
        self.drives = drives
        self.alarms: dict[str, Alarm | None] = {}
        self.clock = SimpleNamespace(now_ns=0)
        self.differences = list(differences)
        self.slaves = [self.slave(number) for number in range(len(differences[0]))]
        master: Any = SimpleNamespace(line=LINE, transactions=None)
        self.start = LineStart(master, self.clock, self.slaves)  # type: ignore[arg-type]
        self.looks = 0

    def slave(self, number: int) -> Starting:
        axis: str = "XYZ"[number]
        settings = RegisterInputs(axis=axis, node_id=number + 1, first=0, size=0)
        ended = lambda alarm: self.alarms.update({axis: alarm})  # noqa: E731
        if number >= self.drives:
            return Starting(settings, None, None)
        return Starting(settings, None, DriveSteps(), ended)

    def run(self) -> None:
        steps, answer = self.start._follow(station_of(self.slaves[0].settings)), None
        while True:
            try:
                step = steps.send(answer)
            except StopIteration:
                return
            if isinstance(step, Pause):
                self.clock.now_ns += step.time_ns
                answer = None
            else:
                assert isinstance(step, Ask)
                answer = self.answer(step)

    def answer(self, step: Ask) -> Any:
        """As slaves answer: two datagrams hand the time on, then each shows its difference."""
        address = address_of("SYSTEM_TIME_DIFFERENCE")
        stations = [station_of(slave.settings) for slave in self.start._alive]
        commands = [each.command for each in step.datagrams]
        assert commands == [Command.FPWR, Command.FRMW, *[Command.FPRD] * len(stations)]
        read = [each.address for each in step.datagrams[2:]]
        assert read == [at_station(station, address) for station in stations]
        shown = self.differences[min(self.looks, len(self.differences) - 1)]
        self.looks += 1
        found = [Answer(b"", 1)] * 2
        for off in shown:
            data = bytes(4) if off is None else off.to_bytes(4, "little")
            found.append(Answer(data, 0 if off is SILENT else 1))
        return found


@pytest.mark.parametrize("late", [0, 1, 2])
@pytest.mark.parametrize("far", [LIMIT_NS + 1, SIGN | LIMIT_NS + 1, SILENT])
def test_the_last_clock_that_follows_ends_the_waiting(late: int, far: int | None) -> None:
    """At the limit a clock follows; ahead, behind or unknown it is waited for, whichever it is."""
    off: list[int | None] = [LIMIT_NS, SIGN | LIMIT_NS, 0]
    off[late] = far
    waiting = Waiting(off, off, [LIMIT_NS, SIGN | LIMIT_NS, 0])
    waiting.run()
    assert waiting.looks == 3
    assert waiting.clock.now_ns == 2 * PERIOD_NS
    assert waiting.alarms == {}


@pytest.mark.parametrize("late", [0, 1, 2])
@pytest.mark.parametrize(("far", "shown"), [(LIMIT_NS + 1, "501"), (SILENT, "unknown")])
def test_a_clock_that_never_follows_is_the_alarm_of_its_drive(
    late: int, far: int | None, shown: str
) -> None:
    off: list[int | None] = [0, 0, 0]
    off[late] = far
    waiting = Waiting(off)
    waiting.run()
    assert waiting.clock.now_ns == TIMEOUT_NS
    (axis,) = waiting.alarms
    alarm = waiting.alarms[axis]
    assert alarm is not None
    assert (axis, alarm.id) == ("XYZ"[late], 900707)
    assert alarm.values == {"axis": axis, "position": late + 1, "ns": shown, "ms": 20}


def test_beside_a_clock_that_never_follows_one_at_the_limit_does() -> None:
    """X has the limit, Y 1 ns more, Z the limit with the sign: Y alone has an alarm."""
    waiting = Waiting([LIMIT_NS, LIMIT_NS + 1, SIGN | LIMIT_NS])
    waiting.run()
    assert list(waiting.alarms) == ["Y"]
    assert [slave.has_failed for slave in waiting.slaves] == [False, True, False]


@pytest.mark.parametrize("late", [[1], [2], [1, 2]])
def test_a_slave_without_a_drive_stops_the_first_drive_once(late: list[int]) -> None:
    """X has a drive, the terminals Y and Z behind it have none: the alarm names the terminal."""
    off: list[int | None] = [SILENT if number in late else 0 for number in range(3)]
    waiting = Waiting(off, drives=1)
    waiting.run()
    (alarm,) = waiting.alarms.values()
    assert alarm is not None
    assert (list(waiting.alarms), alarm.values["axis"]) == (["X"], "XYZ"[late[0]])
    has_failed = [slave.has_failed for slave in waiting.slaves]
    assert has_failed == [True, 1 in late, 2 in late]


@pytest.mark.parametrize(
    ("without", "silent", "reference", "failed"),
    [
        ("", "", "X", ""), ("X", "", "Y", "X"), ("Y", "", "X", "Y"), ("XY", "", "Z", "XY"),
        ("XYZ", "", None, "XYZ"), ("", "X", None, "X"), ("", "Z", None, "Z"),
        ("X", "YZ", None, "XYZ"), ("Y", "X", None, "XY"),
    ],
)  # fmt: skip
def test_the_first_clock_of_a_line_is_its_reference_if_all_have_answered(
    without: str, silent: str, reference: str | None, failed: str
) -> None:
    """Bit 2 of 0008 says that there is one. With a silent one no clock is written to."""
    waiting = Waiting([0, 0, 0])
    names = dict(zip((1001, 1002, 1003), "XYZ", strict=True))
    written = set()

    def answer(each: Any) -> Answer:
        name, register = names.get(each.address & 0xFFFF, ""), each.address >> 16
        if each.command is not Command.FPRD:
            written.add(register)
            return Answer(b"", 1)
        if register == 0x0008:
            return Answer(bytes((0 if name in without else 4, 0)), 1)
        return Answer(bytes(len(each.data)), 0 if name in silent else 1)

    steps, found, given = waiting.start._set_clocks(), None, None
    while given is None:
        try:
            step = steps.send(found)
        except StopIteration as end:
            given = (end.value,)
        else:
            assert isinstance(step, Ask)
            found = [answer(each) for each in step.datagrams]
    assert [reference and {v: k for k, v in names.items()}[reference]] == [*given]
    assert {axis: alarm and alarm.id for axis, alarm in waiting.alarms.items()} == dict.fromkeys(
        failed, 900706
    )
    assert (0x0920 in written) is (reference is not None)  # offset of the system time


@pytest.mark.parametrize(
    ("now_ns", "start_ns"), [(0, 10 * MS), (1, 11 * MS), (MS, 11 * MS), (7 * MS - 1, 17 * MS)]
)
def test_sync0_of_all_drives_begins_at_one_instant_of_the_grid(now_ns: int, start_ns: int) -> None:
    """Ten cycles ahead at least, on the grid of the cycles, and shifted as the rig says."""
    waiting = Waiting([0, 0, 0], drives=2)
    waiting.clock.now_ns = now_ns
    found: dict[int, dict[int, bytes]] = {}
    for step in waiting.start._begin_sync():
        assert isinstance(step, Ask)
        for each in step.datagrams:
            found.setdefault(each.address & 0xFFFF, {})[each.address >> 16] = each.data
    drives = [station_of(slave.settings) for slave in waiting.slaves[:2]]
    assert list(found) == drives  # none of the terminal
    for registers in found.values():
        begin = int.from_bytes(registers[address_of("START_TIME")], "little")
        period = int.from_bytes(registers[address_of("SYNC0_CYCLE")], "little")
        assert (begin, period) == (start_ns + SHIFT_NS, PERIOD_NS)
        assert registers[address_of("ACTIVATION")] == b"\3"
