"""A drive on Lightbus: latches that are always on, LATCH32 and LATCH16, DRVSTAT; both ends."""

import csv
from dataclasses import replace
from pathlib import Path

import pytest
from tests.speed_drive.ends import SETTINGS

from axisrig.bench.drive.lightbus import unit as of_unit
from axisrig.bench.drive.lightbus.unit import LightbusUnit
from axisrig.bench.rig.lightbus.keys import DriveTable
from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.lightbus import latch as of_control
from axisrig.kernel.drives.lightbus.latch import ReadLatch
from axisrig.kernel.drives.lightbus.link import LightbusDrive
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.profiles.lightbus import words

S, E = of_control.ReadState, of_control.ReadInput
U, V = of_unit.ReadState, of_unit.ReadInput
TURN = 1 << 20
POS = words.LATCHED["POS"]
TABLE = DriveTable.model_validate({"family": "lightbus", "in2mode": 26})


@pytest.mark.parametrize(
    ("module", "name", "states", "inputs"), [(of_control, "latch", S, E), (of_unit, "read", U, V)]
)
def test_each_state_has_each_input_once(
    module: object, name: str, states: type, inputs: type
) -> None:
    here = Path(str(module.__file__)).parent  # type: ignore[attr-defined]
    text = (here / f"{name}.csv").read_text(encoding="utf-8")
    rows = [(row["state"], row["input"]) for row in csv.DictReader(text.splitlines())]
    expected = [(state.name, asked.name) for state in states for asked in inputs]  # type: ignore[attr-defined]
    assert sorted(rows) == sorted(expected)


@pytest.mark.parametrize(
    ("state", "properties"),
    [
        (S.IDLE, ""), (S.CLEAR, "is_clear"), (S.CLEARING, "reads"), (S.ARMING, "is_ordered reads"),
        (S.RELEASING, "is_ordered"), (S.ARMED, "is_ordered is_armed"),
        (S.READING, "is_ordered is_armed has_latched reads"),
        (S.VALUE, "is_ordered is_armed has_latched reads value"), (S.LOST, "is_ordered"),
    ],
)  # fmt: skip
def test_what_a_state_is_for_a_measuring_run(state: of_control.ReadState, properties: str) -> None:
    latch = ReadLatch(2)
    latch.state, latch._raw = state, 7
    names = ("is_ordered", "is_clear", "is_armed", "has_latched", "reads", "value")
    found = [name for name in names if getattr(latch, name) not in (False, None)]
    assert sorted(found) == sorted(properties.split())


@pytest.mark.parametrize("state", S)
@pytest.mark.parametrize("asked", E)
def test_what_the_control_takes_for_a_value(
    state: of_control.ReadState, asked: of_control.ReadInput
) -> None:
    """The same value twice, read after an edge that came after what was there was thrown away."""
    after = of_control.TABLE[state, asked]
    if after is S.VALUE and state is not S.VALUE:
        assert (state, asked) == (S.READING, E.SAME)
    if after is S.READING and state is not S.READING:
        assert asked is E.LATCHED
        assert state in (S.RELEASING, S.ARMED)
    if after is S.RELEASING and state is not S.RELEASING:
        assert state is S.ARMING
        assert asked in (E.NEW, E.SAME)
    if after is S.ARMING and state is not S.ARMING:
        assert (state, asked) == (S.CLEAR, E.ARM)
    if asked is E.DISARM:
        assert after in (S.IDLE, S.CLEAR, S.CLEARING)


@pytest.mark.parametrize("state", S)
def test_what_a_state_of_the_control_does_with_each_telegram(state: of_control.ReadState) -> None:
    """Of OLD nothing; a value that nobody has ordered is read away, and one that nobody reads
    makes an edge before it uncertain.
    """
    after = {asked: of_control.TABLE[state, asked] for asked in E}
    assert after[E.OLD] is state
    if state in (S.IDLE, S.CLEAR):
        assert (after[E.LOW], after[E.LATCHED]) == (S.CLEAR, S.CLEARING)
        assert (after[E.NEW], after[E.SAME]) == (S.IDLE, S.IDLE)
        assert after[E.ARM] is (S.ARMING if state is S.CLEAR else S.IDLE)
    if state is S.CLEARING:
        assert {after[asked] for asked in (E.ARM, E.DISARM, E.LOW, E.LATCHED)} == {S.CLEARING}
        assert (after[E.NEW], after[E.SAME]) == (S.IDLE, S.IDLE)
    if state not in (S.IDLE, S.CLEAR, S.CLEARING):
        assert (after[E.ARM], after[E.DISARM]) == (state, S.IDLE)
    if state is S.ARMING:
        assert (after[E.LOW], after[E.LATCHED]) == (S.ARMING, S.ARMING)
    if state is S.RELEASING:
        assert (after[E.LOW], after[E.LATCHED]) == (S.ARMED, S.READING)
    if state is S.ARMED:
        assert (after[E.LOW], after[E.NEW], after[E.SAME]) == (S.ARMED, S.LOST, S.LOST)
    if state is S.READING:
        assert (after[E.LOW], after[E.LATCHED], after[E.NEW]) == (S.LOST, S.READING, S.READING)
    if state is S.VALUE:
        assert (after[E.LOW], after[E.LATCHED], after[E.NEW]) == (S.LOST, S.LOST, S.LOST)
        assert after[E.SAME] is S.VALUE
    if state is S.LOST:
        assert {after[asked] for asked in (E.LOW, E.LATCHED, E.NEW, E.SAME)} == {S.LOST}


@pytest.mark.parametrize("state", U)
@pytest.mark.parametrize("asked", V)
def test_what_the_drive_does(state: of_unit.ReadState, asked: of_unit.ReadInput) -> None:
    """The first edge stores until it is read; no other one changes the value."""
    unit = LightbusUnit(TABLE.make(), 26, is_in_turn=False)
    unit.states[True], unit.values[True] = state, 7
    if asked is V.PULSE:
        if True in unit.edges():
            unit.pulse(True, 9)
    else:
        unit.command({"READ": words.READ["POS"] if asked is V.READ else 0}, 0)
    assert unit.states[True] is of_unit.TABLE[state, asked]
    assert unit.values[True] == (9 if (state, asked) == (U.WAITING, V.PULSE) else 7)
    status = unit.inputs(0, level=True)["DRVSTAT"]
    assert bool(status & POS) is (of_unit.TABLE[state, asked] is U.STORED)


@pytest.mark.parametrize(
    ("keys", "edges"),
    [({}, 0), ({"in2mode": 0}, 0), ({"in2mode": 26}, 2), ({"latch_variable": "LATCH16"}, 0)],
)
def test_a_drive_latches_both_edges_only_where_its_table_says_so(
    keys: dict[str, object], edges: int
) -> None:
    """A table without in2mode has an input of no function; LATCH32 where nothing else is asked."""
    table = DriveTable.model_validate({"family": "lightbus", **keys})
    unit = LightbusUnit(table.make(), table.in2mode, is_in_turn=table.is_in_turn)
    assert len(unit.edges()) == edges
    variable, mode = keys.get("latch_variable", "LATCH32"), keys.get("in2mode", 0)
    assert table.in_words.endswith(f"latched in {variable}, IN2MODE {mode}")


@pytest.mark.parametrize("in2mode", [0, 25, 27, 50])
def test_an_input_with_another_function_latches_nothing(in2mode: int) -> None:
    assert LightbusUnit(TABLE.make(), in2mode, is_in_turn=False).edges() == ()


@pytest.mark.parametrize(
    ("turns", "um"), [(0.0, 0), (1.0, 10_000), (-0.25, -2500), (12.34567, 123_457)]
)
def test_latch32_counts_micrometres(turns: float, um: int) -> None:
    unit = LightbusUnit(TABLE.make(), 26, is_in_turn=False)
    unit.pulse(True, round(turns * TURN))
    unit.command({"READ": 1}, 0)
    assert unit.inputs(0, level=False)["LATCH_P"] == um


def test_latch16_counts_65536_a_turn() -> None:
    unit = LightbusUnit(TABLE.make(), 26, is_in_turn=True)
    unit.pulse(False, 3 * TURN - 16)
    unit.command({"READ": 2}, 0)
    assert unit.inputs(0, level=False)["LATCH_N"] == 65_535


# The control's side


@pytest.fixture
def latch() -> ReadLatch:
    """A latch that waits for an edge."""
    made = ReadLatch(echo_cycles=2)
    show(made, "low", "low", "low")
    assert made.is_clear
    made.arm()
    assert made.reads
    show(made, "low", 7, 7)  # a value of an earlier edge is thrown away
    assert not made.reads
    show(made, 7, "low")
    assert made.is_armed
    return made


def show(latch: ReadLatch, *telegrams: int | str) -> None:
    for each in telegrams:
        shown = each if isinstance(each, int) else None
        latch.take(each == "latched", shown, 100, -4)


def test_a_value_counts_when_it_was_read_and_two_telegrams_have_it(latch: ReadLatch) -> None:
    show(latch, "latched")
    assert (latch.has_latched, latch.reads, latch.value) == (True, True, None)
    show(latch, "latched", 5)
    assert latch.value is None
    show(latch, 5)
    assert (latch.value, latch.place, latch.travel) == (5, 100, -4)


@pytest.mark.parametrize("telegrams", [2, 3, 6])
def test_the_place_is_that_of_the_first_telegram_with_the_edge(
    latch: ReadLatch, telegrams: int
) -> None:
    """The axis has moved on until the value is read, however many telegrams that takes."""
    for number, telegram in enumerate(("latched",) * telegrams + (5, 5)):
        shown = telegram if isinstance(telegram, int) else None
        latch.take(shown is None, shown, 100 + number, number)
    assert (latch.value, latch.place, latch.travel) == (5, 100, 0)


def test_each_run_has_the_place_of_its_own_edge(latch: ReadLatch) -> None:
    for turn, place in enumerate((100, 250)):
        for later, telegram in enumerate(("latched", "latched", 5 + turn, 5 + turn)):
            shown = telegram if isinstance(telegram, int) else None
            latch.take(shown is None, shown, place + 10 * later, -place - later)
        assert (latch.value, latch.place, latch.travel) == (5 + turn, place, -place)
        latch.disarm()
        show(latch, 5 + turn, "low", "low")
        assert latch.is_clear
        latch.arm()
        show(latch, 5 + turn, 5 + turn, 5 + turn, "low", "low")
        assert latch.is_armed


def test_a_value_from_before_the_bit_to_read_is_not_the_first_of_two(latch: ReadLatch) -> None:
    """The telegram after the edge is older than the bit: it shows the value of an earlier read."""
    show(latch, "latched", 5)
    assert (latch.reads, latch.value) == (True, None)
    show(latch, 5)
    assert latch.value is None
    show(latch, 5)
    assert latch.value == 5


def test_a_value_that_changes_or_goes_is_none(latch: ReadLatch) -> None:
    show(latch, "latched", "latched", 5, 5, 6)
    assert (latch.value, latch.has_latched) == (None, False)
    latch.disarm()
    assert not latch.reads


def test_a_value_that_nobody_has_asked_for_is_none(latch: ReadLatch) -> None:
    show(latch, 5, 5, 5)
    assert (latch.value, latch.has_latched) == (None, False)


def test_an_edge_between_two_runs_is_read_and_thrown_away(latch: ReadLatch) -> None:
    latch.disarm()
    show(latch, "low", "latched")
    assert not latch.is_clear
    show(latch, "latched")
    assert latch.reads
    show(latch, "latched", 5)
    assert not latch.reads
    show(latch, 5, "low")
    assert latch.is_clear


def given(drive: LightbusDrive, values: dict[str, int]) -> dict[str, int]:
    drive.port.receive(words.FROM_DRIVE.packed({"DRIVE": 3, **values}))
    drive.take()
    drive.send(drive.actual_mm)
    assert drive.port.outputs is not None
    return words.TO_DRIVE.values_of(drive.port.outputs)


@pytest.mark.parametrize("edge", ["POS", "NEG"])
@pytest.mark.parametrize("turn", [-3, 0, 7])
@pytest.mark.parametrize("apart", [-(TURN // 2) + 16, -16, 0, 16, TURN // 2 - 16])
def test_latch16_is_of_the_nearest_turn(edge: str, turn: int, apart: int) -> None:
    """The turn wraps between latch and reading, and nothing is 10 mm off."""
    settings = replace(SETTINGS, increments_per_mm=TURN / 10, edge=edge, echo_cycles=1)
    drive = LightbusDrive(settings, ImagePort(), is_in_turn=True)
    drive.order(PowerOrder.SWITCH_ON)
    place = turn * TURN
    other = "NEG" if edge == "POS" else "POS"
    still = {
        "POSITION": place,
        "DRVSTAT": words.LATCHED[other],
    }  # the other edge counts for nothing
    shown = {**still, "SHOWN": words.READ[edge], words.VALUE[edge]: (place + apart) >> 4 & 0xFFFF}
    given(drive, still)
    drive.arm()
    assert given(drive, still)["READ"] == words.READ[edge]
    assert given(drive, shown)["READ"] == 0
    given(drive, still)
    assert drive.is_armed
    latched = {**still, "DRVSTAT": words.LATCHED[edge] | words.LATCHED[other]}
    assert given(drive, latched)["READ"] == words.READ[edge]
    for _ in range(3):
        given(drive, {**shown, "POSITION": place + 3 * TURN})
    assert drive.latched_mm == pytest.approx((place + apart) * 10 / TURN, abs=1e-9)
    assert drive.is_actuated is None
