"""What the caller of a cycle has afterwards; the shipped cycles from every modal state."""

from pathlib import Path

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import ExactStop, LinearMove, MeasuringRun, Wait
from axisrig.kernel.nc.coordinates import OffsetTables, Tool, Tools, ZeroOffsets
from axisrig.kernel.nc.decoder import Interpreter, registry
from axisrig.kernel.nc.text.parser import read_program

PLANS = Path(__file__).parents[2] / "testplans"
XYZ = ("X", "Y", "Z")
INCH_MM = 25.4
TOP_MM, RADIUS_MM = 100.0, 3.0
DFA_MM = 2.0

WHERE = "@P1=3 @P2={top} @P3={dfa} @P4=-1"
CYCLES = {
    "touch": f"L CYCLE [NAME=probe_touch.cyc {WHERE} @P5={{feed}} @P6={{fast}}]",
    "calibrate": f"L CYCLE [NAME=probe_calibrate.cyc {WHERE} @P5=2 @P6=1 @P7={{feed}}]",
    "measure": f"L CYCLE [NAME=probe_measure.cyc {WHERE} @P5=2 @P6=1 @P7={{feed}}]",
}
# A modal state of the caller, and a block that shows it
STATES = {
    "G0": ("G0", "X5"),
    "G1": ("G1 F1234", "X5"),
    "G2": ("G2 F1234", "X10 I5"),
    "G3": ("G3 F1234", "X10 I5"),
    "R": ("G2 F1234 R7", "X10"),
    "G17": ("G17 G2 F1234", "X10 I5 J0"),
    "G18": ("G18 G2 F1234", "X10 K0 I5"),
    "G19": ("G19 G1 F1234\nY1 X0", "G2 Y11 J5"),
    "G161": ("G161 G2 F1234", "X10 I5 J0"),
    "G162": ("G161\nG162 G2 F1234", "X10 I5 J0"),
    "G164": ("G164 G2 F1234", "X10 I5.002 J0"),
    "G165": ("G165 G2 F1234", "X10 I5.002 J0"),
    "G53": ("G53 G0", "X5"),
    **{f"G{number}": (f"G{number} G0", "X5") for number in range(54, 60)},
    "G70": ("G70 G1 F50", "X5"),
    "G71": ("G71 G1 F50", "X5"),
    "G90": ("G90 G0", "X1\nX5"),
    "G91": ("G91 G0", "X1\nX5"),
    "G94": ("G94 G1 F77", "X5"),
    "G260": ("G260 G0", "X5\nG100 Y1 F100"),
    "G359": ("G359 G0", "X5"),
    "G360": ("G360 G0", "X5"),
    **{f"type {kind}": (f"#MEAS MODE[{kind}]\nG0 F100", "X=V.G.MEAS_TYPE") for kind in range(1, 8)},
}
# One of each kind in the quick stage
QUICK = ("G0", "R", "G18", "G55", "G70", "G91", "G161", "G164", "G260", "G360", "type 3")
# Settings that are no state: they act in their block, or nothing of them acts here
OF_THE_BLOCK = {"G8", "G9", "G40", "G60", "G61", "G106", "G900", "G901"}
WITH_VALUES = {"G131", "G133", "G134", "G159"}


def tables(**more):
    offsets = {(group, 0): 10.0 * group for group in range(1, 7)}
    tools = Tools({0: Tool(valid=True), 1: Tool(radius_mm=RADIUS_MM, valid=True)})
    return OffsetTables(zero_offsets=ZeroOffsets(offsets), tools=tools, **more)


@pytest.fixture
def machine(plane_machine):
    """A ball of 3 mm above a workpiece: its centre is at TOP_MM + RADIUS_MM when it touches."""

    def make(radius_mm=0.0, z_mm=250.0):
        return plane_machine({"X": 0.0, "Y": 0.0, "Z": z_mm}, ("Z", TOP_MM + radius_mm))

    return make


@pytest.fixture
def play(tmp_path):
    """Run a program that calls the shipped cycles; give its commands."""

    def run(text, at, **more):
        for cycle in (PLANS / "programs").glob("probe_*.cyc"):
            (tmp_path / cycle.name).write_text(cycle.read_text(encoding="utf-8"), encoding="utf-8")
        (tmp_path / "main.nc").write_text(text, encoding="utf-8")
        program = read_program(tmp_path / "main.nc", XYZ)
        interpreter = Interpreter(
            program, XYZ, at, external={}, tables=more.pop("tables", tables()), **more
        )
        commands = []
        for command in interpreter.commands():
            commands.append(command)
            at.queue.append(command)
            if isinstance(command, Wait):
                at.execute()
        return commands

    return run


def call(cycle, *, inch=False):
    unit = INCH_MM if inch else 1.0
    values = {
        "top": repr(TOP_MM / unit),
        "dfa": repr(DFA_MM / unit),
        "feed": repr(300.0 / unit),
        "fast": repr(3000.0 / unit),
    }
    before = CYCLES["calibrate"].format(**values) + "\n" if cycle == "measure" else ""
    return before + CYCLES[cycle].format(**values)


def without_place(command):
    """A command without its line: the same block stands in another line of the other program."""
    return type(command), {
        key: value for key, value in vars(command).items() if key not in ("block", "place")
    }


def test_every_g_function_that_stays_is_a_state_of_this_test():
    stays = registry.SETTINGS.keys() - OF_THE_BLOCK - WITH_VALUES - {"G261"}
    assert stays <= STATES.keys()


@pytest.mark.parametrize(
    "state",
    [pytest.param(name, marks=() if name in QUICK else pytest.mark.long) for name in STATES],
)
def test_the_caller_of_the_measuring_cycles_goes_on_in_its_modal_state(play, machine, state):
    """TF5200 channel parameters 476043659 (P-CHAN-00210); the measuring type by the cycle."""
    before, after = STATES[state]
    free = play(f"{before}\n{after}\nM30", machine(z_mm=TOP_MM + DFA_MM))
    cycles = "\n".join(call(cycle, inch=state == "G70") for cycle in ("touch", "measure"))
    called = play(f"{before}\n{cycles}\n{after}\nM30", machine())
    shown = [without_place(each) for each in free if not isinstance(each, Wait)]
    last = [without_place(each) for each in called if not isinstance(each, Wait)]
    count = len(after.splitlines()) + (state == "G360") + 1
    assert last[-count:] == shown[-count:]


@pytest.mark.parametrize("cycle", CYCLES)
def test_contouring_is_off_in_a_measuring_cycle_and_on_after_it(play, machine, cycle):
    """FCT-C4 2: no measuring while it smooths; 120652."""
    text = f"G261 G0\n{call(cycle)}\nG60 X1\n"
    assert any(isinstance(each, ExactStop) for each in play(text + "M30", machine()))
    with pytest.raises(Alarm) as caught:
        play(text + "G100 Y1 F100\nM30", machine())
    assert caught.value.id == 120652


@pytest.mark.parametrize("inch", [False, True])
@pytest.mark.parametrize("cycle", CYCLES)
def test_positions_and_feeds_of_a_cycle_are_those_of_the_unit(play, machine, cycle, inch):
    """DFA before and after the place, 300 and 3000 mm/min, in whichever unit they were given."""
    text = f"{'G70' if inch else 'G71'}\n{call(cycle, inch=inch)}\nM30"
    commands = play(text, machine())
    runs = [each for each in commands if isinstance(each, MeasuringRun)]
    moves = [each for each in commands if isinstance(each, LinearMove)]
    assert runs
    assert moves
    for run in runs:
        assert run.target_mm["Z"] == pytest.approx(TOP_MM - DFA_MM, abs=1e-9)
        assert run.feed_mm_min == pytest.approx(300.0, abs=1e-9)
    for move in moves:
        assert move.target_mm["Z"] == pytest.approx(TOP_MM + DFA_MM, abs=1e-9)
        assert move.feed_mm_min == pytest.approx(3000.0, abs=1e-9)


@pytest.mark.parametrize("default", ["0", "0.0"])
def test_the_feed_of_a_calibration_that_gives_none_is_300_mm_min_under_g70(play, machine, default):
    """Siemens 6FC5398, 2.8."""
    text = (
        "G70\nL CYCLE [NAME=probe_calibrate.cyc @P1=3 @P2=100/25.4 @P3=2/25.4 @P4=-1 @P5=1 @P6=1"
        f" @P7={default}]\nM30"
    )
    (run,) = (each for each in play(text, machine()) if isinstance(each, MeasuringRun))
    assert run.feed_mm_min == 300.0


@pytest.mark.parametrize(("first", "second"), [(False, True), (True, False), (True, True)])
def test_calibrated_in_one_unit_and_measured_in_the_other_is_the_same_place(
    play, machine, first, second
):
    """What the cycles store is mm: the same place to 0.1 um, and no warning of another feed."""
    text = (
        f"{'G70' if first else 'G71'}\n{call('calibrate', inch=first)}\n"
        f"{'G70' if second else 'G71'}\n{CYCLES['measure'].format(**_measured(second))}\n"
        "G71 G0 X=V.P.OVR_VALUE Y=V.P.OVR_DIFF\nM30"
    )
    commands = play(text, machine())
    moved = [each for each in commands if isinstance(each, LinearMove)][-1]
    assert moved.target_mm["X"] == pytest.approx(TOP_MM, abs=1e-4)
    assert not any(type(each).__name__ == "Warn" for each in commands)


def _measured(inch):
    unit = INCH_MM if inch else 1.0
    return {"top": repr(TOP_MM / unit), "dfa": repr(DFA_MM / unit), "feed": "0"}


@pytest.mark.parametrize("counts", [True, False])
@pytest.mark.parametrize("inch", [False, True])
@pytest.mark.parametrize("cycle", CYCLES)
def test_the_centre_of_the_ball_stays_away_by_its_radius(play, machine, cycle, inch, counts):
    """Whatever P-CHAN-00311 puts into the result, with a DFA below the radius."""
    text = f"{'G70' if inch else 'G71'} D1\n{call(cycle, inch=inch)}\nM30"
    commands = play(text, machine(RADIUS_MM), tables=tables(ball_radius_counts=counts))
    runs = [each for each in commands if isinstance(each, MeasuringRun)]
    moves = [each for each in commands if isinstance(each, LinearMove)]
    for run in runs:
        assert run.target_mm["Z"] == pytest.approx(TOP_MM + RADIUS_MM - DFA_MM, abs=1e-9)
    for move in moves:
        assert move.target_mm["Z"] == pytest.approx(TOP_MM + RADIUS_MM + DFA_MM, abs=1e-9)


def test_variables_and_parameters_of_the_caller_stay_its_own(play, machine):
    names = ("FROM", "TO", "TYPE", "FEED", "UNIT", "CENTRE", "SUM", "WAY", "TOUCH", "COUNT")
    written = "\n".join(f"V.L.{name} = 7" for name in names)
    read = "+".join(f"V.L.{name}" for name in names)
    text = f"{written}\nP90 = 7\n{call('measure')}\nG0 X={read} Y=P90\nM30"
    moved = [each for each in play(text, machine()) if isinstance(each, LinearMove)][-1]
    assert (moved.target_mm["X"], moved.target_mm["Y"]) == (70.0, 7.0)


@pytest.mark.parametrize("field", ["10", "-1", "2.5"])
@pytest.mark.parametrize("cycle", ["calibrate", "measure"])
def test_a_field_that_is_none_is_refused_before_anything_moves(play, machine, cycle, field):
    at = machine()
    with pytest.raises(Alarm) as caught:
        play(CYCLES[cycle].format(**_measured(False)).replace("@P6=1", f"@P6={field}"), at)
    assert (caught.value.id, caught.value.values["number"]) == (900131, 9)
    assert at.acs_mm["Z"] == 250.0


class TestOwnCycles:
    """Any cycle, not only those that are shipped."""

    CHANGES = "G1 G91 G70 G360 G261 G55 G18 F3\nR9"

    def run(self, tmp_path, at, cycle, after, *, changes_stay=False, kind="CYCLE"):
        (tmp_path / "own.cyc").write_text(cycle, encoding="utf-8")
        call_of = "L CYCLE [NAME=own.cyc @P1=1]" if kind == "CYCLE" else "L own.cyc"
        text = f"G0 G90 G71 G54 F100\nX1\n{call_of}\n{after}\nM30"
        (tmp_path / "main.nc").write_text(text, encoding="utf-8")
        program = read_program(tmp_path / "main.nc", XYZ)
        data = tables(cycle_changes_modal=changes_stay)
        commands = Interpreter(program, XYZ, at, external={}, tables=data).commands()
        return [each for each in commands if isinstance(each, LinearMove)]

    @pytest.mark.parametrize("end", ["M17", "M29", ""])
    def test_it_gives_the_state_back_however_it_ends(self, tmp_path, machine, end):
        cycle = f"{self.CHANGES}\n{end}"
        moved = self.run(tmp_path, machine(), cycle, "X2\nX3\nG1 X4")
        assert [each.target_mm["X"] for each in moved] == [11, 12, 13, 14]
        assert [each.rapid for each in moved] == [True, True, True, False]
        assert moved[-1].feed_mm_min == 100

    @pytest.mark.parametrize(("stays", "kind"), [(True, "CYCLE"), (False, "SUBPROGRAM")])
    def test_a_subprogram_and_p_chan_00210_keep_the_changes(self, tmp_path, machine, stays, kind):
        cycle = "G1 G91 G70 F3\nM17"
        moved = self.run(tmp_path, machine(), cycle, "X1", changes_stay=stays, kind=kind)
        assert moved[-1].target_mm["X"] == pytest.approx(11 + INCH_MM)
        assert moved[-1].feed_mm_min == pytest.approx(3 * INCH_MM)

    def test_what_comes_with_a_value_or_an_axis_stays(self, tmp_path, machine):
        """G92 and G159, as the page names G92 and G129."""
        moved = self.run(tmp_path, machine(), "G92 X100\nG159=2\nM17", "X2")
        assert moved[-1].target_mm["X"] == 122

    def test_a_cycle_in_a_cycle_gives_back_what_that_one_had(self, tmp_path, machine):
        (tmp_path / "inner.cyc").write_text("G91 F5\nM17", encoding="utf-8")
        cycle = "G1 F50\nL CYCLE [NAME=inner.cyc @P1=1]\nX2\nM17"
        moved = self.run(tmp_path, machine(), cycle, "X3")
        assert [(each.target_mm["X"], each.rapid) for each in moved] == [
            (11, True),
            (12, False),
            (13, True),
        ]
        assert moved[1].feed_mm_min == 50
