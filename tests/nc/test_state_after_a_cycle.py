"""What the caller of a cycle has of circles, planes and block ends when the cycle has changed it.

TF5200 channel parameters 476043659 (P-CHAN-00210). Each pair is a state of the caller, what a cycle
changes it to, and blocks that show the difference: the same as without the cycle.
"""

import pytest
from tests.nc.test_modal_state_of_cycles import XYZ, machine, tables, without_place

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import Warn
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import read_program

__all__ = ["machine"]

STATES = {
    # arcs from X1 to X11: half a turn about X6, or with a radius
    "plane": ("G17", "G19", "G2 X11 I5 J0"),
    "radius": ("G2 R7", "R9", "X11"),
    "centre in coordinates": ("G161", "G162", "G2 X11 I6 J0"),
    "centre from the start": ("G162", "G161", "G2 X11 I5 J0"),
    "centre as it is": ("G164", "G165", "G2 X11 I5.002 J0"),
    "centre corrected": ("G165", "G164", "G2 X11 I5.002 J0"),
    "exact stop": ("G360", "G359", "G0 X5"),
    "no exact stop": ("G359", "G360", "G0 X5"),
    "motion": ("G3", "G0", "X11 I5 J0"),
    "feed": ("F77", "F5", "X5"),
    "inches": ("G70", "G71", "X0.5"),
    "distances": ("G91", "G90", "X5\nX5"),
    "zero offset": ("G55", "G57", "X5 Y6"),
    "no zero offset": ("G53", "G56", "X5"),
}
# Alarms of the blocks where the change stays
REFUSED = {
    "plane": 900153,  # no I in G19
    "motion": 900153,  # nor in G0
    "centre in coordinates": 900150,  # the ends are 6 and 4 mm from such a centre
    "centre from the start": 900150,
}


def decoded(tmp_path, at, before, cycle, after, *, stays=False):
    """What the blocks after the call of a cycle give."""
    (tmp_path / "own.cyc").write_text(f"{cycle}\nM17\n", encoding="utf-8")
    text = f"G1 F100\nX1 Y0\n{before}\nL CYCLE [NAME=own.cyc @P1=1]\n{after}\nM30"
    (tmp_path / "main.nc").write_text(text, encoding="utf-8")
    program = read_program(tmp_path / "main.nc", XYZ)
    data = tables(cycle_changes_modal=stays)
    commands = Interpreter(program, XYZ, at, external={}, tables=data).commands()
    begin = text.splitlines().index(after.splitlines()[0]) + 1
    return [without_place(each) for each in commands if each.block.line >= begin]


@pytest.mark.parametrize("state", STATES)
def test_the_caller_goes_on_as_if_the_cycle_had_changed_nothing(tmp_path, machine, state):
    before, change, after = STATES[state]
    free = decoded(tmp_path, machine(), before, "G4 X0", after)
    assert decoded(tmp_path, machine(), before, change, after) == free
    # P-CHAN-00210 = 1: what the cycle has changed stays
    if state not in REFUSED:
        assert decoded(tmp_path, machine(), before, change, after, stays=True) != free
        return
    with pytest.raises(Alarm) as caught:
        decoded(tmp_path, machine(), before, change, after, stays=True)
    assert caught.value.id == REFUSED[state]


@pytest.mark.parametrize("state", STATES)
def test_a_cycle_that_ends_the_program_gives_nothing_back(tmp_path, machine, state):
    """M30 in it: the blocks of the caller do not come any more."""
    before, change, after = STATES[state]
    found = decoded(tmp_path, machine(), before, f"{change}\nM30", after)
    assert [kind for kind, _ in found if kind is not Warn] == []


def test_a_radius_of_the_cycle_is_none_of_the_caller(tmp_path, machine):
    for cycle in ("G4 X0", "R9"):
        with pytest.raises(Alarm) as caught:
            decoded(tmp_path, machine(), "G2", cycle, "X11")
        assert caught.value.id == 20036


def test_what_is_kept_of_contouring_is_that_of_the_caller(tmp_path, machine):
    """G261 in the cycle: a measuring run of the caller is none that contouring forbids."""
    run = "G100 X5 F100"
    free = decoded(tmp_path, machine(), "G260", "G4 X0", run)
    assert decoded(tmp_path, machine(), "G260", "G261", run) == free
    for before, change in (("G261", "G260"), ("G261", "G4 X0")):
        with pytest.raises(Alarm) as caught:
            decoded(tmp_path, machine(), before, change, run)
        assert caught.value.id == 120652


@pytest.mark.parametrize(
    ("before", "cycle", "is_refused"),
    [
        ("G261\nG260", "G4 X0", False),
        ("G0 X5", "G61 G1 X9", True),
        ("G61 G1 X5", "G1 X9", False),
        ("G61 G1 X5", "G4 X0", True),
    ],
)
def test_a_rounded_corner_is_that_of_the_last_motion_wherever_it_was(
    tmp_path, machine, before, cycle, is_refused
):
    """G61 of the block before a run is refused, 120652; it is no state that a cycle gives back."""
    if not is_refused:
        assert decoded(tmp_path, machine(), before, cycle, "G100 X50 F100")
        return
    with pytest.raises(Alarm) as caught:
        decoded(tmp_path, machine(), before, cycle, "G100 X50 F100")
    assert caught.value.id == 120652
