"""Rows that a recorder writes, changes of a torque limit, and the largest lag between two rows."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.drive.axis.drive import NO_TICK
from axisrig.bench.machine.recording import recorder
from axisrig.bench.machine.recording.lag import largest_lag
from axisrig.bench.machine.recording.limit_log import LimitLog
from axisrig.bench.machine.recording.recorder import RecordedAxis, Recorder
from axisrig.bench.record.series import SeriesWriter, column_of
from axisrig.kernel.time.clock import MS, US

MOTION = {
    "X": [0.001, 0.002, 0.003, 0.004, 0.005, 6.0, 7.0, 0.008],
    "C": [0.011, 0.012, 0.013, 0.014, 0.015, 16.0, 17.0, 200.0],
}
"""Position, velocity, motor, its velocity, demand, force, force and face of the stop; m, N."""


class Plant:
    """An axis of the plant with the roles that it fills; moves by 1 mm/s."""

    def __init__(self, name: str, roles: str) -> None:
        self._start = MOTION[name]
        self.roles: Any = SimpleNamespace(has=roles.split().__contains__)
        self.asked: list[tuple[int, int]] = []

    def motion_at(self, time_ns: int) -> list[float]:
        moved = time_ns / MS * 1e-6
        return [value + moved * (place in (0, 2, 4)) for place, value in enumerate(self._start)]

    def stop_force_peak_n(self, since_ns: int, time_ns: int) -> float:
        self.asked.append((since_ns, time_ns))
        return 100.0 + time_ns / MS


class Cycle:
    """A channel in one of its cycles; links have other values than the plant."""

    def __init__(self, number: int) -> None:
        self.sync_ns = number * MS
        self.links = [
            SimpleNamespace(set_mm=10.0 * k + number, actual_mm=20.0 * k + number,
                            lag_mm=30.0 * k + number)
            for k in (1, 2, 3)
        ]  # fmt: skip
        self.distance = SimpleNamespace(axes={}, channel=None)


class Recording:
    """A recorder of some axes and the servos of their drives; keys are those of `Recorder`."""

    def __init__(self, plants: dict[str, Plant], *, tick_ns: int = 250 * US, **keys: Any) -> None:
        self.servos: dict[str, Any] = {
            name: SimpleNamespace(tick_ns=tick_ns, sync_ns=0, lag_peak_m=NO_TICK) for name in plants
        }
        axes = [RecordedAxis(name, plants[name], self.servos[name]) for name in plants]  # type: ignore[arg-type]
        self.whole: Any = SimpleNamespace(distances={}, now_ns=0)
        probes, telegrams = keys.pop("probes", {}), keys.pop("telegrams", ())
        self.recorder = Recorder(self.whole, axes, probes, telegrams, SeriesWriter(None), **keys)

    def cycle(self, number: int, now_ns: int, **syncs_ns: int) -> None:
        """Write the row of this cycle at an instant. syncs_ns: when axes have got their SYNC."""
        for name, sync_ns in syncs_ns.items():
            self.servos[name].sync_ns = sync_ns
        self.whole.now_ns = now_ns
        cycle = Cycle(number)
        cycle.links = cycle.links[: len(self.servos)]
        self.recorder(cycle)  # type: ignore[arg-type]

    def table(self) -> Any:
        return self.recorder.table()


def written(rows: int, block_rows: int, late_ns: int, patch: pytest.MonkeyPatch) -> Any:
    """X with a stop, C that turns, and Z outside; C gets its SYNC later."""
    patch.setattr(recorder, "BLOCK_ROWS", block_rows)
    plants = {"X": Plant("X", "force stop_force stop_face"), "C": Plant("C", "stop_force stop_fac")}
    servos: Any = {
        name: SimpleNamespace(tick_ns=250 * US, sync_ns=0, lag_peak_m=NO_TICK) for name in plants
    }
    axes = [
        RecordedAxis("X", plants["X"], servos["X"]),  # type: ignore[arg-type]
        RecordedAxis("Z", None, None),
        RecordedAxis("C", plants["C"], servos["C"], is_rotary=True, torque_arm_m=0.5),  # type: ignore[arg-type]
    ]
    signal = SimpleNamespace(level=False)
    whole: Any = SimpleNamespace(distances={}, now_ns=0)
    made = Recorder(whole, axes, {"p": SimpleNamespace(signal=signal)}, (), SeriesWriter(None),  # type: ignore[dict-item]
                    segments=2 if late_ns else 1)  # fmt: skip
    for number in range(1, rows + 1):
        servos["X"].sync_ns = number * MS
        servos["C"].sync_ns = number * MS + late_ns
        whole.now_ns = number * MS + late_ns + 1
        signal.level = number % 2 == 0
        made(Cycle(number))  # type: ignore[arg-type]
    return made.table(), plants


@pytest.mark.interpreted
def test_a_row_has_what_belongs_together(monkeypatch: pytest.MonkeyPatch) -> None:
    table, plants = written(3, 100, 0, monkeypatch)
    at = np.array([1.0, 2.0, 3.0])
    columns = {name: table[name].to_numpy() for name in table.column_names}
    assert columns["time_ns"].tolist() == [MS, 2 * MS, 3 * MS]
    found = {name: values for name, values in columns.items() if name != "time_ns"}
    expected = {
        "X.set_mm": 10 + at, "X.actual_mm": 20 + at, "X.cnc_lag_mm": 30 + at,
        "Z.set_mm": 20 + at, "Z.actual_mm": 40 + at, "Z.cnc_lag_mm": 60 + at,
        "C.set_deg": 30 + at, "C.actual_deg": 60 + at, "C.cnc_lag_deg": 90 + at,
        "X.truth_mm": 1 + 1e-3 * at, "X.velocity_mm_s": 2 + 0 * at, "X.drive_lag_mm": 2 + 0 * at,
        "X.force_n": 6 + 0 * at, "X.stop_force_n": 7 + 0 * at, "X.stop_force_peak_n": 100 + at,
        "X.stop_mm": 8 + 0 * at,
        "C.truth_deg": 11 + 1e-3 * at, "C.velocity_deg_s": 12 + 0 * at,
        "C.drive_lag_deg": 2 + 0 * at, "C.stop_torque_nm": 8.5 + 0 * at,
        "C.stop_torque_peak_nm": 50 + at / 2,
        "p.signal": np.array([0, 1, 0]),
    }  # fmt: skip
    for name in ("X.drive_lag_peak_mm", "C.drive_lag_peak_deg"):
        assert np.all(found.pop(name) >= 2.0 - 1e-9)
    assert set(found) == set(expected)
    for name, values in expected.items():
        assert found[name] == pytest.approx(values), name
    # The largest force since the row before
    assert plants["X"].asked == [(MS, MS), (MS, 2 * MS), (2 * MS, 3 * MS)]


@pytest.mark.interpreted
def test_blocks_of_any_size_give_the_same_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    for late_ns in (0, 300 * US):
        whole, _ = written(7, 100, late_ns, monkeypatch)
        for block_rows in (1, 2, 3, 7):
            parts, plants = written(7, block_rows, late_ns, monkeypatch)
            # The largest force is of the way since the row before, also of one that is written
            since = [(max(1, row - 1) * MS, row * MS) for row in range(1, 8)]
            assert plants["X"].asked == since
            assert parts.column_names == whole.column_names
            for name in whole.column_names:
                assert parts[name].to_numpy().tolist() == whole[name].to_numpy().tolist(), name


@pytest.mark.interpreted
def test_truth_is_of_the_first_sync_and_what_a_drive_has_sampled_of_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Demand and motor of C 0.3 ms later; both move by 1 mm/s."""
    table, _ = written(2, 100, 300 * US, monkeypatch)
    at = np.array([1.0, 2.0])
    columns = {name: table[name].to_numpy() for name in table.column_names}
    assert columns["time_ns"].tolist() == [MS, 2 * MS]
    assert columns["C.truth_deg"] == pytest.approx(11 + 1e-3 * at)
    assert columns["C.drive_lag_deg"] == pytest.approx(2.0 + 0 * at)
    late = {name: values for name, values in columns.items() if "after" in name}
    assert sorted(values.tolist() for values in late.values()) == [[0, 0], [300 * US] * 2]


class Remembering(Plant):
    """Gives what it keeps, as the axes of a plant do: nobody may write into it."""

    def __init__(self, name: str) -> None:
        super().__init__(name, "force stop_force stop_face")
        self.past: dict[int, list[float]] = {}

    def motion_at(self, time_ns: int) -> list[float]:
        return self.past.setdefault(time_ns, super().motion_at(time_ns))


@pytest.mark.interpreted
@pytest.mark.parametrize("late_us", [0, 1, 300])
def test_what_an_axis_has_kept_of_its_motion_stays_as_it_is(late_us: int) -> None:
    """The row of the first SYNC has motor and demand of the later one; the axis has each its own.

    In the second cycle the plant stands at the first SYNC still: its motion is the present one.
    """
    first, later = Remembering("X"), Remembering("C")
    made = Recording({"X": first, "C": later}, segments=2)
    for number, is_ahead in ((1, True), (2, False)):
        at_ns = number * MS
        now_ns = at_ns + (late_us + 1) * US if is_ahead else at_ns
        for plant in (first, later):
            plant.motion = plant.motion_at(now_ns)  # type: ignore[attr-defined]
        made.cycle(number, now_ns, X=at_ns, C=at_ns + late_us * US)
    for plant, name in ((first, "X"), (later, "C")):
        assert {MS, 2 * MS} <= plant.past.keys()
        for time_ns, motion in plant.past.items():
            assert motion == Plant(name, "").motion_at(time_ns), (name, time_ns)
    table = made.table()
    lag_mm = table["C.drive_lag_mm"].to_numpy()
    assert lag_mm == pytest.approx([2.0, 2.0])
    assert table["C.truth_mm"].to_numpy() == pytest.approx([11.001, 11.002])


@pytest.mark.interpreted
@pytest.mark.parametrize("lost", ["X", "C"])
def test_a_drive_that_got_no_sync_leaves_the_rows_where_they_are(lost: str) -> None:
    """X and C get theirs 48 and 58 us after it was asked for; one of them only the first three."""
    made = Recording({name: Plant(name, "force") for name in "XC"})
    for number in range(1, 6):
        syncs_ns = {
            name: number * MS + late_us * US
            for name, late_us in (("X", 48), ("C", 58))
            if name != lost or number <= 3
        }
        made.cycle(number, number * MS + 70 * US, **syncs_ns)
    later_us = 48 if lost == "C" else 58
    expected = [at * MS + 48 * US for at in (1, 2, 3)] + [at * MS + later_us * US for at in (4, 5)]
    assert made.table()["time_ns"].to_numpy().tolist() == expected


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("after_us", "noted_mm", "peak_mm"),
    [
        (0, 5.0, 5.0),  # its SYNC is that of the row, as on one segment
        (0, 2.5, 2.5),
        (0, 1.0, 2.0),  # the lag in the row itself is 2 mm
        (0, 0.0, 2.0),
        (300, 5.0, 5.0),  # its SYNC comes later
        (-1000, 50.0, 2.0),  # it has got none: what it noted is of a cycle before
    ],
)
def test_the_lag_that_a_drive_has_noted_at_its_ticks_counts_in_its_row(
    after_us: int, noted_mm: float, peak_mm: float
) -> None:
    """Two axes: X has no ticks to note between its rows."""
    made = Recording({name: Plant(name, "") for name in "XC"}, tick_ns=MS)
    made.servos["C"].lag_peak_m = noted_mm * 1e-3
    for number in (2, 3):
        at_ns = number * MS
        made.cycle(number, at_ns + 400 * US, X=at_ns, C=at_ns + after_us * US)
    table = made.table()
    assert table["time_ns"].to_numpy().tolist() == [2 * MS, 3 * MS]
    assert table["C.drive_lag_peak_mm"].to_numpy() == pytest.approx([peak_mm] * 2)
    assert table["X.drive_lag_peak_mm"].to_numpy() == pytest.approx([2.0] * 2)


@pytest.mark.interpreted
@pytest.mark.parametrize("noted_m", [0.0, 0.001, NO_TICK])
def test_a_drive_that_has_noted_its_lag_is_believed_also_where_it_was_0(noted_m: float) -> None:
    """Without a note the way between two rows bulges: motor at 4 mm/s where it goes 1 um in 1 ms.

    Off by (1 - 4) um u (1 - u) (1 - 2 u), at its ticks of a quarter: by 3/32 of 3 um at most.
    """
    made = Recording({"X": Plant("X", "")})
    made.servos["X"].lag_peak_m = noted_m
    for number in (1, 2):
        made.cycle(number, number * MS + 1, X=number * MS)
    bulge_mm = 3e-3 * 3 / 32 if noted_m == NO_TICK else 0.0
    found = made.table()["X.drive_lag_peak_mm"].to_numpy()
    assert found == pytest.approx([2.0, 2.0 + bulge_mm], abs=1e-9)


@pytest.mark.interpreted
def test_a_stop_that_is_out_of_reach_when_the_program_begins_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    face = MOTION["X"][7]
    for face_m, has_stop in (
        *((99.9, True), (-99.9, True)),
        *((100.0, False), (-100.0, False), (1e6, False), (-1e6, False)),
    ):
        monkeypatch.setitem(MOTION, "X", [*MOTION["X"][:7], face_m])
        table, _ = written(2, 1, 0, monkeypatch)
        assert ("X.stop_mm" in table.column_names) is has_stop
        assert ("X.stop_force_n" in table.column_names) is has_stop
        assert "X.force_n" in table.column_names
    assert face == 0.008


@pytest.mark.interpreted
def test_a_torque_limit_is_noted_when_it_changes() -> None:
    drive: Any = SimpleNamespace(torque_limits=None)
    log = LimitLog({"Z": drive})
    limits = [None, (1000, 500, 400), (1000, 500, 400), (1000, 500, 300), (1000, 500, 400)]
    for number, now in enumerate(limits):
        drive.torque_limits = now
        log(SimpleNamespace(sync_ns=number * MS))  # type: ignore[arg-type]
    found = [(one.since_ns // MS, one.most, one.negative, one.positive) for one in log.of("Z")]
    assert found == [(1, 1000, 500, 400), (3, 1000, 500, 300), (4, 1000, 500, 400)]
    assert log.of("X") == ()


def test_the_lag_is_looked_at_at_the_ticks_between_two_rows() -> None:
    """The demand jumps back: x = u (1 - u) has its top of 1/4 half way, at a tick or beside it."""
    times = np.array([0, MS], dtype=np.int64)
    demand, motor = np.zeros(2), np.zeros(2)
    velocity = np.array([1.0, -1.0]) / 1e-3  # of the cubic u (1 - u), which is a parabola
    for tick_ns, top in ((500 * US, 0.25), (250 * US, 0.25), (400 * US, 0.24), (MS, 0.0)):
        found = largest_lag(times, (demand, motor, velocity), tick_ns)
        assert found.tolist() == pytest.approx([0.0, top])


@pytest.mark.parametrize("tick_us", [100, 250, 300, 400, 500, 600, 900, 999, 1000])
def test_the_last_tick_before_a_row_counts_whether_ticks_fit_between_rows_or_not(
    tick_us: int,
) -> None:
    """x = u (1 - u) (0.1 (1 - u) + u): slope 0.1 at the begin, -1 at the end, more at the end."""
    times = np.array([0, MS], dtype=np.int64)
    velocity = np.array([0.1, -1.0]) / 1e-3
    found = largest_lag(times, (np.zeros(2), np.zeros(2), velocity), tick_us * US)
    ticks = [tick / 1000 for tick in range(tick_us, 1000, tick_us)]
    expected = max((u * (1 - u) * (0.1 * (1 - u) + u) for u in ticks), default=0.0)
    assert found.tolist() == pytest.approx([0.0, expected])


def test_rows_of_different_distances_have_their_own_ticks() -> None:
    """Behind 1 ms come 0.4 ms: of these the ticks beyond are none."""
    times = np.array([0, MS, MS + 400 * US], dtype=np.int64)
    behind_m, velocity = np.array([0.0, 3e-6, -5e-6]), np.zeros(3)
    found = largest_lag(times, (behind_m, np.zeros(3), velocity), 250 * US)
    # The demand is straight and the motor at rest: the largest is at the row itself
    assert found.tolist() == pytest.approx([0.0, 3e-6, 5e-6])


@pytest.mark.parametrize("velocity", [(1e-3, 9e-3), (9e-3, 1e-3), (1e-3, 1e-3)])
def test_a_way_that_is_the_speed_of_either_end_is_straight(velocity: tuple[float, float]) -> None:
    """An axis that follows its demand exactly: 1 um in 1 ms, the demand stands at its end."""
    times = np.array([0, MS], dtype=np.int64)
    motion = (np.array([1e-6, 1e-6]), np.array([0.0, 1e-6]), np.array(velocity))
    found = largest_lag(times, motion, 250 * US)
    assert found.tolist() == pytest.approx([1e-6, 0.75e-6], rel=1e-6)


@pytest.mark.parametrize("first_us", [100, 400, 1000])
def test_a_longer_step_behind_a_short_one_has_all_its_ticks(first_us: int) -> None:
    """x = T u (1 - u) with its top of T/4 half way of the second step, at its second tick."""
    times = np.array([0, first_us * US, first_us * US + MS], dtype=np.int64)
    velocity = np.array([0.0, 1.0, -1.0])
    found = largest_lag(times, (np.zeros(3), np.zeros(3), velocity), 250 * US)
    assert found[2] == pytest.approx(1e-3 / 4)


class Shifting(Plant):
    """Its stop is out of reach in some of its rows."""

    def __init__(self, near_rows: set[int]) -> None:
        super().__init__("X", "force stop_force stop_face")
        self._near = near_rows

    def motion_at(self, time_ns: int) -> list[float]:
        face_m = 0.008 if time_ns // MS in self._near else 1e6
        return [*super().motion_at(time_ns)[:7], face_m]


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("near_rows", "has_stop"),
    [({1, 2, 3, 4}, True), ({1}, True), ({2}, True), ({3, 4}, False), (set(), False)],
)
def test_what_the_first_block_has_of_a_stop_all_blocks_have(
    monkeypatch: pytest.MonkeyPatch, near_rows: set[int], has_stop: bool
) -> None:
    """Four rows in blocks of two: one near place in the first block is enough."""
    monkeypatch.setattr(recorder, "BLOCK_ROWS", 2)
    made = Recording({"X": Shifting(near_rows)})
    for number in range(1, 5):
        made.cycle(number, number * MS + 1, X=number * MS)
    table = made.table()
    assert table.num_rows == 4
    stops = [name for name in table.column_names if ".stop" in name]
    assert stops == (["X.stop_force_n", "X.stop_force_peak_n", "X.stop_mm"] if has_stop else [])
    if has_stop:
        near = [row + 1 for row, mm in enumerate(table["X.stop_mm"].to_numpy()) if mm < 1e5]
        assert near == sorted(near_rows)


@pytest.mark.interpreted
def test_levels_of_wires_are_those_at_the_sync_of_the_row() -> None:
    """The SYNC is heard 48 us after it was asked for; the wire is looked up at that instant."""
    asked: list[int] = []
    probes: Any = {"p": SimpleNamespace(signal=SimpleNamespace(level=True))}

    def level_at(time_ns: int) -> bool:
        asked.append(time_ns)
        return time_ns > 2 * MS

    wires: Any = {"p": SimpleNamespace(level_at=level_at)}
    made = Recording({"X": Plant("X", "")}, probes=probes, wires=wires)
    for number in (1, 2):
        made.cycle(number, number * MS + 60 * US, X=number * MS + 48 * US)
    table = made.table()
    assert asked == [MS + 48 * US, 2 * MS + 48 * US]
    assert table["p.signal"].to_pylist() == [1, 1]
    assert table["p.passed"].to_pylist() == [0, 1]


@pytest.mark.interpreted
def test_levels_of_several_wires_are_those_of_their_own_names() -> None:
    """Signals in the order of the probes, then what passes of those that have wires, in theirs."""
    probes: Any = {
        name: SimpleNamespace(signal=SimpleNamespace(level=name == "q")) for name in "pqr"
    }
    wires: Any = {name: SimpleNamespace(level_at=lambda _, name=name: name == "p") for name in "rp"}
    made = Recording({"X": Plant("X", "")}, probes=probes, wires=wires)
    made.cycle(1, MS + 1, X=MS)
    table = made.table()
    levels = {name: table[name].to_pylist() for name in table.column_names if name[1] == "."}
    found = {name: values for name, values in levels.items() if name[0] != "X"}
    assert [*found] == ["p.signal", "q.signal", "r.signal", "r.passed", "p.passed"]
    assert found == {
        "p.signal": [0], "q.signal": [1], "r.signal": [0], "r.passed": [0], "p.passed": [1]
    }  # fmt: skip


class Counted:
    """Telegrams that note for which rows they were asked, and whether these are the last ones."""

    def __init__(self, name: str) -> None:
        self.name, self.asked = name, list[tuple[list[int], bool]]()

    def take_columns(self, times_ns: Any, *, is_last: bool) -> dict[str, Any]:
        self.asked.append(((times_ns // MS).tolist(), is_last))
        return {self.name: column_of(times_ns)}


@pytest.mark.interpreted
@pytest.mark.parametrize("rows", range(7))
def test_only_the_last_block_says_that_it_is_the_last(
    monkeypatch: pytest.MonkeyPatch, rows: int
) -> None:
    """Blocks of three, whole or not at the end: what came after the last row belongs to it."""
    monkeypatch.setattr(recorder, "BLOCK_ROWS", 3)
    telegrams: Any = [Counted("t.first"), Counted("t.second")]
    made = Recording({"X": Plant("X", "")}, telegrams=telegrams)
    for number in range(rows):
        made.cycle(number, number * MS + 1, X=number * MS)
    table = made.table()
    assert table["time_ns"].to_pylist() == [number * MS for number in range(rows)]
    whole = [[*range(rows)][begin : begin + 3] for begin in range(0, rows, 3)] or [[]]
    for each in telegrams:
        assert each.asked == [(block, block is whole[-1]) for block in whole]
        assert table[each.name].to_pylist() == table["time_ns"].to_pylist()
