"""Who has the axis of a drive: the table, its page, and walks of a drive through its states."""

from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.drive.cia402.functions.axis_states import NEXT, AxisEvent, AxisState
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
ROOT = Path(__file__).parents[2]
PER_M = 104_857_600
NEW, HALT = 1 << 4, 1 << 8
OFF, OPERATING, STOPPING, HALTED, BEGINNING, RESUMING = AxisState
PAIRS = list(product(AxisState, AxisEvent))


def expected(state: AxisState, event: AxisEvent) -> AxisState:
    """What each event does, said of the event."""
    left, entered = {  # None: left in any state
        AxisEvent.POWER_OFF: (None, OFF),
        AxisEvent.STOP: (None, STOPPING),
        AxisEvent.HALT: ((OPERATING,), HALTED),
        AxisEvent.HALT_ENDS: ((HALTED,), RESUMING),
        AxisEvent.LIMIT_SWITCH: ((OPERATING,), BEGINNING),
        AxisEvent.MODE: ((OPERATING,), BEGINNING),
        AxisEvent.ENABLE: (set(AxisState) - {OPERATING}, BEGINNING),
        AxisEvent.READY: ((BEGINNING, RESUMING), OPERATING),
    }[event]
    return entered if left is None or state in left else state


@pytest.mark.parametrize(
    ("state", "event"), PAIRS, ids=[f"{state.name}-{event.name}" for state, event in PAIRS]
)
def test_every_event_in_every_state(state: AxisState, event: AxisEvent) -> None:
    assert NEXT[state, event] is expected(state, event)


def test_each_pair_has_one_row() -> None:
    folder = ROOT / "bench" / "axisrig" / "bench" / "drive" / "cia402" / "functions"
    rows = (folder / "axis_states.csv").read_text("utf-8").splitlines()[1:]
    assert sorted(row.split(",")[:2] for row in rows) == sorted(
        [state.name, event.name] for state, event in PAIRS
    )


def test_the_page_has_the_same_table() -> None:
    lines = (ROOT / "docs" / "drive.md").read_text("utf-8").splitlines()
    begin = next(at for at, line in enumerate(lines) if line.startswith("| axis | power off |"))
    head, _, *rows = [line.split("|")[1:-1] for line in lines[begin : begin + 2 + len(AxisState)]]
    columns = [AxisEvent[word.strip().replace(" ", "_").upper()] for word in head[1:]]
    found = {}
    for name, *nexts in rows:
        state = AxisState[name.strip().upper()]
        for event, word in zip(columns, nexts, strict=True):
            found[state, event] = AxisState[word.strip().upper()] if word.strip() else state
    assert found == NEXT


class Walk:
    """A drive without any SYNC on an axis that follows exactly; `states`: each that it was in."""

    def __init__(self, bench: Any, mode: int, **objects: float) -> None:
        self.bench, self.scheduler = bench, bench.scheduler
        self.servo, self.sdo = bench.node.servo, bench.remote.sdo
        self.states = [self.servo.axis_state]
        enter = self.servo._enter

        def note(event: AxisEvent, now_ns: int) -> bool:
            before = self.servo.axis_state
            changes: bool = enter(event, now_ns)
            assert self.servo.axis_state is NEXT[before, event]
            if changes:
                self.states.append(self.servo.axis_state)
            return changes

        self.servo._enter = note
        self.sdo[0x6060].raw = mode
        for name, value in objects.items():
            self.sdo[int(name.removeprefix("o"), 16)].raw = round(value)
        for word in (0x06, 0x07, 0x0F):
            self.word(word)

    def word(self, word: int) -> None:
        self.sdo[0x6040].raw = word

    def sync(self) -> None:
        self.bench.master.send_message(0x80, b"")
        self.run_ms(1)

    def run_ms(self, time_ms: int) -> None:
        self.scheduler.run_until(self.scheduler.now_ns + time_ms * MS)


RAMPS = {"o6083": 2 * PER_M, "o6084": 2 * PER_M, "o6085": 2 * PER_M}
TO_POINT = {**RAMPS, "o6081": 0.2 * PER_M, "o607A": 0.1 * PER_M}
STARTED = [OFF, BEGINNING, OPERATING]


@pytest.fixture
def walk(drive_bench: Make) -> Callable[..., Walk]:
    return lambda mode, **objects: Walk(drive_bench(), mode, **objects)


def test_a_halt_that_ends_while_the_axis_brakes(walk: Callable[..., Walk]) -> None:
    one = walk(1, **TO_POINT)
    one.word(0x0F | NEW)
    one.run_ms(200)
    one.word(0x0F | NEW | HALT)
    one.run_ms(20)
    assert one.states == [*STARTED, HALTED]
    one.word(0x0F | NEW)
    assert one.states[-1] is RESUMING  # the ramp still runs, under control of velocity
    one.run_ms(300)
    assert one.states == [*STARTED, HALTED, RESUMING, OPERATING]


def test_a_stop_that_is_called_off(walk: Callable[..., Walk]) -> None:
    one = walk(1, **TO_POINT, o605C=1)
    one.word(0x0F | NEW)
    one.run_ms(200)
    one.word(0x07)
    assert one.states == [*STARTED, STOPPING]
    one.word(0x0F)
    one.run_ms(300)
    assert one.states == [*STARTED, STOPPING, BEGINNING, OPERATING]


def test_a_mode_of_position_waits_for_the_end_of_a_motion_under_velocity(
    walk: Callable[..., Walk],
) -> None:
    one = walk(9, **RAMPS, o60FF=0.2 * PER_M)
    one.sync()
    one.sdo[0x6060].raw = 8
    assert one.states == [*STARTED, BEGINNING]
    one.run_ms(300)
    assert one.states == [*STARTED, BEGINNING, OPERATING]


@pytest.mark.parametrize(("code", "last"), [(2, OFF), (6, STOPPING)])
def test_after_a_quick_stop_the_axis_has_power_or_none(
    walk: Callable[..., Walk], code: int, last: AxisState
) -> None:
    one = walk(3, **RAMPS, o60FF=0.2 * PER_M, o605A=code)
    one.run_ms(200)
    one.word(0x02)
    assert one.states == [*STARTED, STOPPING]
    one.run_ms(300)
    assert one.states[-1] is last
