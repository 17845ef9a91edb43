"""What is ordered for each class of alarm, and which axes leave the path; the log of alarms."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.alarm_log import AlarmLog, faulty_axes
from axisrig.kernel.channel.reactions import Reactions
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import Alarm

AXES = ("X", "Y", "Z")
AT_ONCE, BY_RAMP = True, False


def lag(axis: str) -> Alarm:
    return Alarm(900036, axis=axis, lag_mm="2", limit_mm="1")


WARNS = Alarm(900035, axis="Y", emcy="0x8120")
PROGRAM_ENDS = Alarm(900110, axis="Y", key="k", known="none")
FEEDHOLD = Alarm(50059, axis="Y")
AXIS_AT_ONCE = Alarm(70082, axis="Y", lag_mm="1", ms="2", window_mm="1")
ALL_AT_ONCE = Alarm(60207, axis="Y", channel="1")
AXIS_HALTS = lag("Y")


class Ramp:
    """A ramp that ends after two cycles."""

    def __init__(self, place: float) -> None:
        self.place, self.cycles = place, 0

    @property
    def is_standing(self) -> bool:
        return self.cycles >= 2

    def advance(self) -> float:
        self.cycles += 1
        return self.place + self.cycles


class Bench:
    """Reactions, and what they ask of path, drives and the rest."""

    def __init__(self, *, each_axis_halts: bool = False, measures: bool = False) -> None:
        self.left: list[tuple[str, bool]] = []
        self.put: list[tuple[str, float]] = []
        self.calls: list[str] = []
        self.orders: dict[str, list[PowerOrder]] = {axis: [] for axis in AXES}
        self.path: Any = SimpleNamespace(
            leaders=["coupled"], brake=lambda: self.calls.append("brake"),
            own_ramp=self._own_ramp, put_off_path=lambda *at: self.put.append(at),
        )  # fmt: skip
        measurement: Any = SimpleNamespace(
            is_active=measures, abort=lambda: self.calls.append("abort")
        )
        block = SimpleNamespace(place="line 3")
        self.execution: Any = SimpleNamespace(block=block, failed=None)
        links: Any = [SimpleNamespace(name=axis, order=self.orders[axis].append) for axis in AXES]
        self.clock: Any = SimpleNamespace(now_ns=5)
        self.log = AlarmLog(self.clock)
        self.reactions = Reactions(
            self.log, self.path, measurement, self.execution, links,
            lambda: self.calls.append("beside"), each_axis_halts=each_axis_halts,
        )  # fmt: skip

    def _own_ramp(self, axis: str, *, at_once: bool) -> Ramp:
        self.left.append((axis, at_once))
        return Ramp(100.0 * AXES.index(axis))


@pytest.mark.parametrize(
    ("alarm", "ends", "calls", "left"),
    [
        (WARNS, False, [], []),
        (PROGRAM_ENDS, True, ["abort", "beside"], []),
        (FEEDHOLD, True, ["brake", "abort", "beside"], []),
        (AXIS_AT_ONCE, True, ["brake", "abort", "beside"], [("Y", AT_ONCE)]),
        (
            ALL_AT_ONCE, True, ["brake", "abort", "beside"],
            [("X", AT_ONCE), ("Y", AT_ONCE), ("Z", AT_ONCE)],
        ),
        (AXIS_HALTS, True, ["brake", "abort", "beside"], [("Y", BY_RAMP)]),
    ],
)  # fmt: skip
def test_what_is_done_by_the_class_of_the_alarm(
    alarm: Alarm, ends: bool, calls: list[str], left: list[tuple[str, bool]]
) -> None:
    bench = Bench()
    assert bench.reactions.come_up(alarm) is ends
    assert (bench.calls, bench.left) == (calls, left)
    ordered = [PowerOrder.HOLD_BACK] if ends else []
    assert bench.orders == dict.fromkeys(AXES, ordered)
    assert bench.log.alarms == [alarm]


@pytest.mark.parametrize(
    ("alarm", "left"),
    [
        (AXIS_HALTS, {"X": BY_RAMP, "Y": BY_RAMP, "Z": BY_RAMP}),
        (AXIS_AT_ONCE, {"X": BY_RAMP, "Y": AT_ONCE, "Z": BY_RAMP}),
        (ALL_AT_ONCE, {"X": AT_ONCE, "Y": AT_ONCE, "Z": AT_ONCE}),
        (FEEDHOLD, {}),
        (Alarm(900030, segment="can0"), {}),  # no axis is faulty
    ],
)
def test_with_p_chan_00218_every_axis_halts_by_its_own_ramp_where_one_is_faulty(
    alarm: Alarm, left: dict[str, bool]
) -> None:
    bench = Bench(each_axis_halts=True)
    bench.reactions.come_up(alarm)
    assert dict(bench.left) == left


def test_an_alarm_of_several_axes_takes_them_all_off_and_no_other() -> None:
    bench = Bench()
    bench.reactions.come_up(lag("X Z"))
    assert bench.left == [("X", BY_RAMP), ("Z", BY_RAMP)]


def test_a_run_brakes_also_where_only_the_program_ends() -> None:
    bench = Bench(measures=True)
    bench.reactions.come_up(PROGRAM_ENDS)
    assert bench.calls == ["brake", "abort", "beside"]


def test_a_drive_whose_position_has_jumped_stops_by_itself_and_only_that() -> None:
    bench = Bench()
    bench.reactions.come_up(Alarm(900029, axis="Z", jump_mm="2"))
    held = [PowerOrder.HOLD_BACK]
    assert bench.orders == {"X": held, "Y": held, "Z": [*held, PowerOrder.STOP]}


def test_axes_are_led_beside_the_path_until_they_are_given_back() -> None:
    """In front of what couples axes; the leader is there once, however often axes leave."""
    bench = Bench()
    reactions, leaders = bench.reactions, bench.path.leaders
    assert reactions.has_stopped
    reactions.come_up(AXIS_HALTS)
    reactions.stop_alone(("Y", "Z"))
    assert bench.left == [("Y", BY_RAMP), ("Z", BY_RAMP)]  # Y is off it already
    assert (len(leaders), leaders[1]) == (2, "coupled")
    assert not reactions.has_stopped
    for _ in range(2):
        leaders[0]()
    assert bench.put == [("Y", 101.0), ("Z", 201.0), ("Y", 102.0), ("Z", 202.0)]
    assert reactions.has_stopped
    for _ in range(2):
        reactions.give_back()
        assert leaders == ["coupled"]
    reactions.stop_alone(("X",))
    assert (len(leaders), bench.left[-1]) == (2, ("X", BY_RAMP))
    reactions.reset()
    assert leaders == ["coupled"]
    assert {axis: orders[-1] for axis, orders in bench.orders.items()} == dict.fromkeys(
        AXES, PowerOrder.LET_GO
    )


def test_nothing_leaves_the_path_where_nobody_is_to_stop_alone() -> None:
    bench = Bench()
    bench.reactions.stop_alone(())
    assert (bench.path.leaders, bench.left) == (["coupled"], [])


@pytest.mark.parametrize("place", [None, "line 7"])
def test_an_alarm_has_the_place_of_its_block_unless_it_has_one(place: str | None) -> None:
    alarm = lag("Y")
    alarm.place = place
    bench = Bench()
    bench.reactions.come_up(alarm)
    assert alarm.place == (place or "line 3")


def test_what_has_failed_in_the_queue_comes_up_beside_what_stops() -> None:
    bench = Bench()
    bench.execution.failed = PROGRAM_ENDS
    bench.reactions.come_up(WARNS)
    assert bench.reactions.further == []
    bench.reactions.come_up(AXIS_HALTS)
    assert bench.reactions.further == [PROGRAM_ENDS]
    assert bench.reactions.further_ns == [5]


def test_what_comes_up_besides_is_noted_once_for_each_id_and_axis() -> None:
    bench = Bench()
    log = bench.log
    log.register(lag("X"))
    other = Alarm(900027, axis="X", statusword="0x0233", state="SWITCHED_ON")
    for time_ns, alarm in enumerate((lag("X"), lag("Y"), lag("Y"), other, lag("Y"))):
        bench.clock.now_ns = time_ns
        log.register_further(alarm)
    assert [(each.id, each.values["axis"]) for each in log.further] == [
        (900036, "Y"), (900027, "X"),
    ]  # fmt: skip
    assert (log.further_ns, log.alarm_ns) == ([1, 3], [5])


@pytest.mark.parametrize(
    ("alarm", "axes"),
    [
        (lag("X"), ("X",)), (lag("X Y"), ("X", "Y")), (Alarm(900030, segment="can0"), ()),
        (Alarm(310029, owner="axis Z", source="s"), ("Z",)),
        (Alarm(310029, owner="channel", source="s"), ()),
    ],
)  # fmt: skip
def test_faulty_are_the_axes_that_an_alarm_names_also_as_owners(
    alarm: Alarm, axes: tuple[str, ...]
) -> None:
    assert faulty_axes(alarm) == axes
