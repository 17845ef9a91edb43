"""What the PLC side and the CNC know of each other comes, changes, and goes again."""

from pathlib import Path
from typing import Any

import pytest
from tests.machine.cnc_beside_task import Cnc
from tests.machine.test_plc_side_by_hand import Rules

from axisrig.bench.machine.plc.hli import Hli, Inputs
from axisrig.bench.machine.plc.program import PlcProgram
from axisrig.kernel.cosim.fmi import journal
from axisrig.kernel.errors import UserError
from axisrig.kernel.plc.probing import LatchOrder, LatchTask
from axisrig.kernel.time.clock import MS, US

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


@pytest.mark.parametrize(
    ("value", "words"),
    [("0.123456789", "0.123456789"), ("125.000001", "125.000001"), ("-2", "-2"), ("1e6", "1000000"),
     ("123456789.25", "123456789.25")],
)  # fmt: skip
def test_a_value_is_noted_with_all_its_digits(value: str, words: str) -> None:
    on = Rules(V__E__A=f"0; {value} at=1ms")
    on.turns(3)
    assert [text for _, text in on.words()] == [f"V.E.A = {words} from the PLC"]
    assert on.plc.values["A"] == float(value)


def test_a_function_waits_until_a_set_value_has_arrived() -> None:
    """From 4 mm to 8 mm in 3 ms: M50 at 1 ms goes on in the turn at 4 ms."""
    on = Rules(Z__set_dist="8 at=M50 over=3ms")
    on.turns().sends(50)
    waits = []
    for _ in range(5):
        on.turns()
        waits.append(on.plc.is_waiting())
        on.plc.axis["Z"].distance.command_semaphor_rw = False
    assert waits == [True, True, True, False, False]


@pytest.mark.parametrize("cells", [{"Z__dist_ctrl": "ON at=1ms"}, {"Z__set_pos": "2 at=1ms"}])
def test_a_command_of_a_column_enables_its_unit(cells: dict[str, str]) -> None:
    """Without `enable_w` commands wait; that of the other axis stays as it is."""
    on = Rules(**cells)
    on.turns()
    assert not on.plc.axis["Z"].distance.enable_w
    on.turns(2)
    assert on.plc.axis["Z"].distance.enable_w
    assert not on.plc.axis["X"].distance.enable_w


# The task


IDLE = """class Program:
    probe_on = False
    outlives_program = {outlives}
    def __init__(self):
        self.is_idle = False
    def cycle(self, inputs, hli):
        self.is_idle = inputs.cycle >= 2
"""


@pytest.mark.parametrize("outlives", [True, False])
def test_a_task_that_goes_on_behind_the_program_says_when_it_is_done(
    tmp_path: Path, outlives: bool
) -> None:
    """The third cycle comes at 4 ms. One that does not go on is never waited for."""
    path = tmp_path / "own.py"
    path.write_text(IDLE.format(outlives=outlives), encoding="utf-8")
    cnc = Cnc(tmp_path, program=str(path))
    program = cnc.runner._program._program

    def script(inputs: Inputs, hli: Hli) -> None:
        program.cycle(inputs, hli)

    cnc.runner.start()
    assert cnc.plc.outlives_program is outlives
    found = [cnc.run(at_ms, script).plc.is_idle() for at_ms in (1, 3, 5, 7)]
    assert found == ([False, False, True, True] if outlives else [True] * 4)


def reading(tmp_path: Path) -> tuple[Cnc, list[tuple[Any, ...]]]:
    """A task that keeps what it reads of the channel and of Z in each cycle, 2 ms apart."""
    cnc, read = Cnc(tmp_path), list[tuple[Any, ...]]()

    def script(_inputs: Inputs, hli: Hli) -> None:
        state = hli.ax["Z"].lr_state
        read.append((hli.ch.state_r, state.probe_actuated_r, state.measurement_active_r,
                     state.measure_value_ok_r))  # fmt: skip

    cnc.script = script
    cnc.runner.start()
    return cnc, read


def test_states_are_read_as_they_come_and_as_they_go(tmp_path: Path) -> None:
    """Each by itself; the PLC has them in the cycle after that of the NC."""
    cnc, read = reading(tmp_path)
    cnc.run(1)  # the NC cycle at 0.6 ms has shown RUNNING and nothing else
    for states in (cnc.actuated, cnc.measuring, cnc.measured):
        states.add("Z")
        cnc.run(cnc.clock.now_ns / MS + 2)
        states.clear()
    cnc.state.name = "RESET"
    cnc.run(cnc.clock.now_ns / MS + 2)
    cnc.state.name = "READY"
    cnc.run(cnc.clock.now_ns / MS + 2)
    assert read[1:] == [
        ("RUNNING", True, False, False), ("RUNNING", False, True, False),
        ("RUNNING", False, False, True), ("RESET", False, False, False),
        ("READY", False, False, False),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("measured_mm", "is_ok"), [(0.0, True), (-0.5, True), (1e-9, True), (None, False)]
)
def test_a_measured_value_of_0_is_a_value(
    tmp_path: Path, measured_mm: float | None, is_ok: bool
) -> None:
    cnc, read = reading(tmp_path)
    cnc.measurement.measured_acs_mm = lambda name: measured_mm if name == "Z" else None
    cnc.run(3)
    assert [row[3] for row in read] == [False, is_ok]


@pytest.mark.parametrize(("period_us", "newest"), [(250, [2, 6, 10]), (100, [5, 15, 25])])
def test_of_several_cycles_between_two_of_the_nc_the_last_one_counts(
    tmp_path: Path, period_us: int, newest: list[int]
) -> None:
    """NC cycles at 0.6, 1.6 and 2.6 ms; what is written at that very instant comes later."""
    cnc = Cnc(tmp_path, period_us=period_us)

    def script(inputs: Inputs, hli: Hli) -> None:
        hli.ch.override.enable_w, hli.ch.override.command_w = True, inputs.cycle

    cnc.runner.start()
    found = []
    for at_ms in (0.7, 1.7, 2.7):
        cnc.run(at_ms, script)
        found.append(cnc.plc.override_permille)
    assert found == newest


def test_a_task_behind_another_is_given_in_the_cycle_that_takes_its_acknowledgement(
    tmp_path: Path,
) -> None:
    """The second order of a probe waits for the first; from its own cycle on its time counts.

    The PLC acknowledges in its cycle at 4 ms; the NC has it at 4.6 ms.
    """
    cnc = Cnc(tmp_path)
    probing = cnc.plc.axis["Z"].probing
    probing.give(LatchOrder(LatchTask.ENABLE, 3), 0)
    probing.give(LatchOrder(LatchTask.DISABLE, 3), 0)

    def script(inputs: Inputs, hli: Hli) -> None:
        unit = hli.ax["Z"].lr_mc_control.ext_latch
        if unit.please_rw and inputs.cycle == 2:
            unit.please_rw, unit.done_w = False, True

    cnc.runner.start()
    cnc.run(4.5, script)
    assert (probing.number, probing.given_ns) == (1, 0)
    cnc.run(9.5)
    assert (probing.number, probing.order.task) == (2, LatchTask.DISABLE)
    assert probing.given_ns == 4_600 * US


def test_what_the_plc_has_written_is_taken_once(tmp_path: Path) -> None:
    """Each write of a cycle of 2 ms, in the NC cycle behind it; the next one brings nothing new."""
    cnc, taken = Cnc(tmp_path), list[int]()
    probing = cnc.plc.axis["Z"].probing
    take = probing.take

    def note(writes: Any, now_ns: int) -> None:
        taken.append(now_ns // (100 * US))
        take(writes, now_ns)

    probing.take = note  # type: ignore[method-assign]
    cnc.runner.start()
    cnc.run(6.9)
    assert taken == [6, 26, 46, 66]


def test_calls_into_the_program_are_noted_by_what_they_are(tmp_path: Path) -> None:
    """Where somebody watches: its start, then each cycle at its time."""
    path, notes = tmp_path / "plc.py", tmp_path / "notes"
    path.write_text("class Program:\n    def cycle(self, inputs, hli):\n        pass\n", "utf-8")
    journal.create(notes)
    journal.begin(notes)
    try:
        program = PlcProgram(path)
        first = journal.last_call(notes)
        program.cycle(Inputs(5 * MS, 1, {}), Hli("Z"))
        second = journal.last_call(notes)
    finally:
        journal._OPEN.clear()
    assert first is not None
    assert second is not None
    assert [(one.function, one.time_ns, one.number) for one in (first, second)] == [
        ("its start", 0, 1), ("cycle", 5 * MS, 2),
    ]  # fmt: skip
    assert second.what == f"the PLC program {path}"
    assert not second.is_inside


def test_all_names_that_there_are_are_shown_for_one_that_is_none(tmp_path: Path) -> None:
    path = tmp_path / "plc.py"
    text = "class Program:\n    def cycle(self, inputs, hli):\n        hli.ax['Q']\n"
    path.write_text(text, "utf-8")
    with pytest.raises(UserError, match="asks for an unknown axis") as caught:
        PlcProgram(path).cycle(Inputs(0, 0, {}), Hli(["X", "Y", "Z", "A", "C"]))
    assert (caught.value.value, caught.value.allowed) == ("Q", "X, Y, Z, A, C")
    assert caught.value.line == 3
