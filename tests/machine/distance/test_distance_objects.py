"""CNC objects that the PLC side writes: they act when control is switched on the next time.

Source: FCT-M3 7.6: from INACTIVE and from FREEZE to ACTIVE.
"""

import pytest

from axisrig.kernel.distance import DistanceCommand

NO_FILTER = ("set:Z.kenngr.distc.n_cycles=0", "set:Z.kenngr.distc.kp=0.2")
ON = "Z[DIST_CTRL ON CONST_DIST SET_DIST=2.5]"


def gains(outcome):
    """What the control asks for over its error, wherever there is one."""
    error, asked = outcome.column("Z.error_mm"), outcome.column("Z.delta_mm")
    state = outcome.column("Z.distance_state")
    follows = (state == 4) & (abs(error) > 1e-4)
    return [round(float(gain), 9) for gain in asked[follows] / error[follows]]


@pytest.mark.parametrize(
    ("program", "found"),
    [
        (f"N10 M50\nN20 {ON}\nN30 G4 0.2", [0.3]),  # written while INACTIVE
        (f"N10 {ON}\nN20 G4 0.01\nN30 M50\nN40 G4 0.1", [0.2]),  # while it is on: not at all
        (
            f"N10 {ON}\nN20 G4 0.01\nN30 M50\nN40 G4 0.01\nN50 Z[DIST_CTRL FREEZE]\nN60 {ON}\n"
            "N70 G4 0.1",
            [0.2, 0.3],  # from FREEZE on
        ),
        (f"N10 {ON}\nN20 G4 0.01\nN30 Z[DIST_CTRL KP=0.3]\nN40 G4 0.1", [0.2, 0.3]),  # program
    ],
)
def test_a_gain_acts_at_the_transitions_and_that_of_a_program_at_once(run_distance, program, found):
    write = "plc:Z.object.DIST_CTRL::kp=0.3 at=M50"
    put = (*NO_FILTER, write) if "M50" in program else NO_FILTER
    outcome = run_distance(program, *put).outcome
    assert list(dict.fromkeys(gains(outcome))) == found


def test_a_command_waits_until_the_plc_is_enabled(run_distance):
    """enable_w redirects the control to the PLC: before, its command stays where it is."""

    def ask(channel, cycle):
        unit = channel.plc.axis["Z"].distance
        if cycle == 20:
            unit.command_w.transition = DistanceCommand(3)
            unit.command_w.set_dist_mm = 2.5
            unit.command_semaphor_rw = True
        if cycle == 40:
            unit.enable_w = True

    watched = run_distance("N10 G4 0.1", act=ask)
    states = [cycle.state for cycle in watched.cycles]
    assert states[:40] == ["INACTIVE"] * 40
    assert states[41] == "ACTIVE_CONST_DIST"
