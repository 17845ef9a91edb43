"""A PLC task beside a CNC by hand: its instants, what it commands, what it reads.

NC cycles at 600 us of each ms. What the program does in its cycles is a function of the test.
"""

import random
from pathlib import Path
from typing import Any

import pytest
from tests.machine.cnc_beside_task import Cnc, Script

from axisrig.bench.machine.plc.hli import Hli, Inputs
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.plc.probing import LatchOrder, LatchTask
from axisrig.kernel.time.clock import MS, US

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


# --- its instants


@pytest.mark.parametrize(
    ("now_us", "first_ms", "number"),
    [(0, 0.3, 0), (300, 0.3, 0), (301, 2.3, 1), (2300, 2.3, 1), (2299, 2.3, 1), (9000, 10.3, 5)],
)
def test_its_first_cycle_is_the_next_of_its_grid(
    tmp_path: Path, now_us: int, first_ms: float, number: int
) -> None:
    cnc = Cnc(tmp_path, offset_us=300)
    cnc.clock.run_until(now_us * US)
    cnc.runner.start()
    cnc.run(first_ms + 4.1)
    assert cnc.cycles == [(first_ms + 2 * count, number + count) for count in range(3)]
    assert cnc.switched == [False] * 3  # the probe is off, as `probe_on` of the program


def test_a_cycle_that_takes_longer_costs_those_that_come_meanwhile(tmp_path: Path) -> None:
    """3 ms of work each 2 ms; what it writes is there after its end, for the NC cycle behind."""
    cnc = Cnc(tmp_path, busy_us=3000)
    cnc.runner.start()

    def script(_inputs: Inputs, hli: Hli) -> None:
        hli.ch.feedhold.enable_w = hli.ch.feedhold.command_w = True

    cnc.run(9.0, script)
    assert cnc.cycles == [(0.0, 0), (4.0, 2), (8.0, 4)]
    assert cnc.runner.left_out == 2
    assert cnc.held == ["", "", "", *["P"] * 6]  # from the one at 3.6 ms on


def test_lost_and_late_cycles_keep_the_grid_and_their_numbers(tmp_path: Path) -> None:
    cnc = Cnc(tmp_path)
    cnc.runner.start()
    cnc.run(1.0)
    cnc.fault.begin_lost()
    cnc.run(5.0)
    cnc.fault.end_lost()
    cnc.fault.begin_late(500 * US, 0, random.Random(1))
    cnc.run(9.0)
    cnc.fault.end_late()
    cnc.run(10.5)
    assert cnc.cycles == [(0.0, 0), (6.5, 3), (8.5, 4), (10.0, 5)]
    assert cnc.runner.left_out == 2


@pytest.mark.parametrize(("silent_ms", "last_ms"), [(4.0, 2.0), (4.001, 4.0)])
def test_a_task_is_silent_from_its_instant_on(
    tmp_path: Path, silent_ms: float, last_ms: float
) -> None:
    cnc = Cnc(tmp_path, silent_from_ms=silent_ms)
    cnc.runner.start()
    cnc.run(12.0)
    assert cnc.cycles[-1][0] == last_ms
    task = cnc.plc.task
    assert task is not None
    assert task.written_ns == last_ms * MS


def test_what_the_cnc_knows_of_the_task(tmp_path: Path) -> None:
    """The watchdog waits for its cycles and one of the NC; an edge is late by the cycle of the
    PLC that reads it, its work, and the NC cycle behind: 2 + 0.5 ms, 3 of the NC and one more.
    """
    cnc = Cnc(tmp_path, watchdog_cycles=4, acknowledge_ms=12.5, busy_us=500,
              assumed_offset_ns=40, assumed_drift_ppm=2.0)  # fmt: skip
    task = cnc.plc.task
    assert task is not None
    assert (task.cycle_ns, task.watchdog_ns) == (MS, 4 * 2 * MS + MS)
    assert (task.acknowledge_ns, task.late_cycles) == (12_500 * US, 4)
    assert (task.stamps.offset_ns, task.stamps.drift_ppm) == (40, 2.0)
    assert task.clock_limit_ns == {"Z": 700}  # nobody watches the clocks of X
    cnc.runner.start()
    cnc.run(5.0)
    assert task.sync_ns == {"X": 4 * MS, "Z": 4 * MS - 125 * US}
    assert task.clocks_off_ns == {"X": 0, "Z": 90}


# --- what it commands


def by_time(*spans: tuple[str, int, int]) -> Script:
    """Feedholds of the path (P) or of an axis, each in its span of ms."""

    def script(inputs: Inputs, hli: Hli) -> None:
        now_ms = inputs.time_ns // MS
        for name in "PXZ":
            unit = hli.ch.feedhold if name == "P" else hli.ax[name].lr_mc_control.feedhold
            unit.enable_w = True
            unit.command_w = any(of == name and a <= now_ms < b for of, a, b in spans)

    return script


def test_feedholds_of_path_and_axes_come_and_go_each_by_itself(tmp_path: Path) -> None:
    cnc = Cnc(tmp_path)
    cnc.runner.start()
    cnc.run(12.0, by_time(("P", 0, 4), ("X", 2, 6), ("Z", 4, 8), ("P", 8, 10)))
    assert cnc.held == ["P", "P", "PX", "PX", "XZ", "XZ", "Z", "Z", "P", "P", "", ""]


def test_columns_and_the_task_both_hold(tmp_path: Path) -> None:
    """Without columns the task alone decides; with them what one of both holds is held."""
    for has_columns, held in ((False, ["Z", "Z", "", "", ""]), (True, ["XZ", "XZ", "X", "", ""])):
        cnc = Cnc(tmp_path, has_columns=has_columns)

        def column(cnc: Cnc = cnc) -> None:
            cnc.plc.feedhold = False
            for name, unit in cnc.plc.axis.items():
                unit.feedhold = name == "X" and cnc.clock.now_ns < 3 * MS

        cnc.columns = column
        cnc.runner.start()
        cnc.run(5.0, by_time(("Z", 0, 2)))
        assert cnc.held == held


def test_overrides_are_given_back_when_they_are_not_enabled_any_more(tmp_path: Path) -> None:
    """X, then Z, then the path; what columns have set of the other ones stays."""
    cnc = Cnc(tmp_path, has_columns=True)
    cnc.runner.start()
    given = {0: "X", 2: "Z", 4: "P", 8: "X"}

    def script(inputs: Inputs, hli: Hli) -> None:
        now_ms = inputs.time_ns // MS
        for name in "PXZ":
            unit = hli.ch.override if name == "P" else hli.ax[name].lr_mc_control.override
            unit.enable_w, unit.command_w = given.get(now_ms) == name, 300 + now_ms

    found = []
    for now_ms in range(1, 12, 2):
        cnc.run(now_ms, script)
        found.append(cnc.overrides())
        if now_ms == 7:
            cnc.plc.override_permille = 777  # by a column
    assert found == [
        (1000, 300, 1000), (1000, 1000, 302), (304, 1000, 1000), (1000, 1000, 1000),
        (777, 308, 1000), (777, 1000, 1000),
    ]  # fmt: skip


def test_an_override_of_0_is_one_and_stops(tmp_path: Path) -> None:
    """Of the path in the first cycle, of Z in the second, of none in the third."""
    cnc, found = Cnc(tmp_path), []
    cnc.runner.start()

    def script(inputs: Inputs, hli: Hli) -> None:
        units = (
            hli.ch.override,
            hli.ax["X"].lr_mc_control.override,
            hli.ax["Z"].lr_mc_control.override,
        )
        for unit, number in zip(units, (0, None, 1), strict=True):
            unit.enable_w, unit.command_w = inputs.cycle == number, 0

    for now_ms in (1, 3, 5):
        cnc.run(now_ms, script)
        found.append(cnc.overrides())
    assert found == [(0, 1000, 1000), (1000, 1000, 0), (1000, 1000, 1000)]


def test_reset_and_start_act_at_their_rising_edges(tmp_path: Path) -> None:
    """A reset of 2 to 6 ms and of 8 ms, a start of 4 to 8 ms and of 10 ms: two of each."""
    cnc = Cnc(tmp_path)
    cnc.runner.start()
    resets: list[float] = []

    def script(inputs: Inputs, hli: Hli) -> None:
        now_ms = inputs.time_ns // MS
        hli.ch.reset.enable_w = hli.ch.start.enable_w = True
        hli.ch.reset.command_w = 2 <= now_ms < 6 or now_ms == 8
        hli.ch.start.command_w = 4 <= now_ms < 8 or now_ms == 10

    for number in range(1, 15):
        cnc.run(number, script)
        if cnc.plc.wants_reset:
            resets.append(number - 1)
            cnc.plc.wants_reset = False
    assert (resets, cnc.starts) == ([2, 8], 2)
    words = [event.command.words for event in cnc.plc.events]  # type: ignore[union-attr]
    start = "start of the program from the PLC program"
    assert words == ["reset from the PLC program", start, "reset from the PLC program", start]


def test_only_variables_that_the_program_has_changed_are_written(tmp_path: Path) -> None:
    """The NC program writes A between the cycle of the PLC that has read it and its end."""
    cnc = Cnc(tmp_path, busy_us=900)
    cnc.plc.values.update({"A": 1.0, "B": 2.0})
    cnc.runner.start()
    block = Block(1, 10, "N10 V.E.A = 5")

    def script(inputs: Inputs, hli: Hli) -> None:
        if inputs.time_ns == 2 * MS:
            hli.ve["B"] = 9.0

    cnc.run(2.1, script)
    cnc.plc.write(canon.ExternalWrite(block, "A", 5.0))
    cnc.run(4.5)
    assert cnc.plc.values == {"A": 5.0, "B": 9.0}
    assert [event.time_ns for event in cnc.plc.events] == [2_100 * US]


# --- what it reads


def test_each_axis_shows_its_own_state(tmp_path: Path) -> None:
    """Positions in the nearest 0.1 um; a run of an axis beside the path is a measurement too."""
    cnc = Cnc(tmp_path)
    cnc.actuated.add("Z")
    cnc.measured.add("X")
    cnc.beside.add("X")
    cnc.plc.show_tool(30.49996, 80.25004)
    read: dict[str, Any] = {}

    def script(_inputs: Inputs, hli: Hli) -> None:
        states = {name: hli.ax[name].lr_state for name in "XZ"}
        read.update(
            {
                name: (state.probe_actuated_r, state.measurement_active_r,
                       state.measure_value_ok_r, state.position_r, state.digital_inputs_r)
                for name, state in states.items()
            }
        )  # fmt: skip
        read["ch"] = hli.ch.state_r, hli.ch.tool_tilt_r, hli.ch.tool_length_r

    cnc.runner.start()
    cnc.run(0.5, script)
    assert read["ch"] == ("", 0, 0)  # nothing was shown before its first cycle
    cnc.run(2.5)
    assert read == {
        "X": (False, True, True, 12_500, 0),
        "Z": (True, False, False, -25_000, 1 << 16),
        "ch": ("RUNNING", 305_000, 802_500),
    }
    cnc.measuring.add("Z")
    cnc.beside.clear()
    cnc.state.name = "READY"
    cnc.run(4.5)
    assert (read["X"][1], read["Z"][1], read["ch"][0]) == (False, True, "READY")


def test_a_cycle_sees_what_the_cnc_has_shown_before_it_not_at_the_same_instant(
    tmp_path: Path,
) -> None:
    """Both at 600 us: the PLC reads the position of the NC cycle one ms before, first of none.

    The NC cycle of the first of these instants is called before that of the PLC.
    """
    cnc = Cnc(tmp_path, offset_us=600)
    read: list[int] = []
    cnc.columns = lambda: setattr(cnc.links[0], "actual_mm", cnc.clock.now_ns // MS + 1.0)

    def script(_inputs: Inputs, hli: Hli) -> None:
        read.append(hli.ax["X"].lr_state.position_r)

    cnc.runner.start()
    cnc.run(7.0, script)
    assert read == [0, 20_000, 40_000, 60_000]


def test_a_task_of_a_probe_is_handed_over_and_acknowledged_axis_by_axis(tmp_path: Path) -> None:
    """FCT-C4 7.5: the CNC sets please_rw with a task, the PLC takes it back and sets done_w."""
    cnc = Cnc(tmp_path, task=7)
    orders = {"X": LatchOrder(LatchTask.ENABLE, 3, "NEG"), "Z": LatchOrder(LatchTask.DISABLE, 4)}
    for name, order in orders.items():
        cnc.plc.axis[name].probing.give(order, 0)
    log: list[tuple[str, bool, int, int, str, int]] = []

    def script(inputs: Inputs, hli: Hli) -> None:
        for name in "XZ":
            unit = hli.ax[name].lr_mc_control.ext_latch
            log.append((name, unit.please_rw, unit.task_r, unit.input_r, unit.edge_r,
                        unit.task_number_r))  # fmt: skip
            # X is served at once, Z in the third cycle
            if unit.please_rw and (name == "X" or inputs.cycle >= 3):
                unit.please_rw, unit.done_w = False, True

    cnc.runner.start()
    cnc.run(2.5, script)
    assert log[2:] == [("X", True, 1, 3, "NEG", 7), ("Z", True, 2, 4, "POS", 7)]
    x, z = (unit.probing for unit in cnc.plc.axis.values())
    cnc.run(2.9)
    assert (x.is_idle, z.is_idle) == (True, False)
    x.give(LatchOrder(LatchTask.PREPARE, 5), cnc.clock.now_ns)
    cnc.run(4.5)
    assert log[-2:] == [("X", True, 3, 5, "POS", 7), ("Z", True, 2, 4, "POS", 7)]
    cnc.run(8.0)
    assert (x.is_idle, z.is_idle, x.number, z.number) == (True, True, 2, 1)


def test_units_of_a_probe_are_taken_while_they_are_enabled(tmp_path: Path) -> None:
    cnc = Cnc(tmp_path)
    states: list[tuple[bool, int, int]] = []

    def script(inputs: Inputs, hli: Hli) -> None:
        units = hli.ax["Z"].lr_mc_control
        is_on = inputs.cycle in (1, 2)
        for unit, value in ((units.timestamp, 123), (units.probing_position, -45)):
            unit.enable_w, unit.command_w = is_on, value
        units.probing_signal.enable_w, units.probing_signal.command_w = is_on, True
        states.append((units.probing_signal.state_r, units.timestamp.state_r,
                       units.probing_position.state_r))  # fmt: skip

    cnc.runner.start()
    found = []
    for until_ms in (1, 3, 5, 7, 9):
        cnc.run(until_ms, script)
        writes = cnc.plc.axis["Z"].probing.writes
        found.append((writes.signal, writes.timestamp_ns, writes.position_units))
    on, off = (True, 123, -45), (None, None, None)
    assert found == [off, on, on, off, off]
    assert cnc.plc.axis["X"].probing.writes.signal is None
    # What the CNC has taken the PLC sees in its next cycle
    taken, none = (True, 123, -45), (False, 0, 0)
    assert states == [none, none, taken, taken, none]


@pytest.mark.parametrize("is_zero", [False, True])
@pytest.mark.parametrize("enabled", [*range(8)])
def test_each_unit_of_a_probe_is_taken_where_it_is_enabled_also_with_0(
    tmp_path: Path, enabled: int, is_zero: bool
) -> None:
    """Bits of `enabled`: signal, time stamp, position. What is not enabled is none, not 0."""
    cnc = Cnc(tmp_path)
    values = (False, 0, 0) if is_zero else (True, 123, -45)
    wanted = [value if enabled >> place & 1 else None for place, value in enumerate(values)]

    def script(_inputs: Inputs, hli: Hli) -> None:
        control = hli.ax["Z"].lr_mc_control
        units: Any = (control.probing_signal, control.timestamp, control.probing_position)
        for place, (unit, value) in enumerate(zip(units, values, strict=True)):
            unit.enable_w, unit.command_w = bool(enabled >> place & 1), value

    cnc.runner.start()
    cnc.run(1, script)
    writes = cnc.plc.axis["Z"].probing.writes
    assert [writes.signal, writes.timestamp_ns, writes.position_units] == wanted
    other = cnc.plc.axis["X"].probing.writes
    assert (other.signal, other.timestamp_ns, other.position_units) == (None, None, None)


def test_a_task_of_a_probe_is_done_when_the_plc_has_taken_it_and_says_so(tmp_path: Path) -> None:
    """`done_w` beside `please_rw` is that of the task before: it counts with please_rw taken back.

    In the cycles from 2 ms on: done only, taken only, both.
    """
    cnc, idle = Cnc(tmp_path), list[bool]()
    probing = cnc.plc.axis["Z"].probing
    probing.give(LatchOrder(LatchTask.ENABLE, 3), 0)

    def script(inputs: Inputs, hli: Hli) -> None:
        unit = hli.ax["Z"].lr_mc_control.ext_latch
        unit.done_w = inputs.cycle in (1, 3)
        unit.please_rw = inputs.cycle < 2

    cnc.runner.start()
    for until_ms in (1, 3, 5, 7):
        cnc.run(until_ms, script)
        idle.append(probing.is_idle)
    assert idle == [False, False, False, True]
