"""Every command in every state, from the program and from the PLC, on a whole machine.

The surface sways, so that each state shows in what the offset does. What is expected stands here,
from the texts on states and transitions (FCT-M3 8.1, TF5200 distance control 290206347).
"""

import pytest

from axisrig.kernel.distance import DistanceCommand, DistanceState, Source
from axisrig.kernel.distance.states import changes
from axisrig.kernel.plc.unit import UnitCommand

ON = "Z[DIST_CTRL ON SET_POS=30]"
ON_CONST = "Z[DIST_CTRL ON CONST_DIST SET_DIST=3]"
WORDS = {
    "OFF": "Z[DIST_CTRL OFF]",
    "ON": ON,
    "FREEZE": "Z[DIST_CTRL FREEZE]",
    "ON_CONST_DIST": ON_CONST,
}
WAY = {
    "INACTIVE": "N10 G4 0.01",
    "ACTIVE": f"N10 {ON}\nN20 G4 0.3",
    "FREEZE": f"N10 {ON}\nN20 G4 0.3\nN30 Z[DIST_CTRL FREEZE]\nN35 G4 0.05",
    "TURNING_OFF": f"N10 {ON}\nN20 G4 0.3\nN30 Z[DIST_CTRL OFF]",
    "ACTIVE_CONST_DIST": f"N10 {ON_CONST}\nN20 G4 0.3",
}
STATES = {
    "INACTIVE": ("INACTIVE", "ACTIVE", 900310, "ACTIVE_CONST_DIST"),
    "ACTIVE": ("TURNING_OFF", "ACTIVE", "FREEZE", 70440),
    "FREEZE": ("TURNING_OFF", "ACTIVE", "FREEZE", "ACTIVE_CONST_DIST"),
    "TURNING_OFF": ("TURNING_OFF", 70334, 900310, 70334),
    "ACTIVE_CONST_DIST": ("TURNING_OFF", 70440, "FREEZE", "ACTIVE_CONST_DIST"),
}
"""Behind OFF, ON, FREEZE, ON_CONST_DIST: the next state, or the ID that the program is told."""
PAIRS = [
    (state, command, after)
    for state, row in STATES.items()
    for command, after in zip(WORDS, row, strict=True)
]
SWAY = (
    "plant:gap.workpiece.plane.level_mm=31",
    "plant:gap.sway_mm=0.5",
    "plant:gap.sway_frequency_hz=2",
)
FOLLOWS_MM = 0.15
"""Ramp error of either law at 6.3 mm/s, kp 0.2, a mean of 4 and 2 dead cycles: below 0.1 mm."""


def sways(values):
    """Whether they go with the surface: around its turning point a sine has each value twice."""
    return 2 * len(set(values)) >= len(values)


def does(state, cycles):
    """Whether the axis did in the last cycles what the state means; by bus and plant alone."""
    offsets = [cycle.offset_mm for cycle in cycles]
    gaps = [-cycle.sensor_mm for cycle in cycles]
    wanted_mm = {"ACTIVE": 2.0, "ACTIVE_CONST_DIST": 3.0}
    if state in wanted_mm:
        follows = all(abs(gap - wanted_mm[state]) < FOLLOWS_MM for gap in gaps)
        return follows and sways(offsets)
    stands = len(set(offsets)) == 1 and sways(gaps)
    return stands and (offsets[0] == 0.0) == (state != "FREEZE")


def holds_in_the_end(watched, after):
    """The program has ended behind the last motion; TURNING_OFF has become INACTIVE by itself."""
    end = "INACTIVE" if after == "TURNING_OFF" else after
    assert watched.cycles[-1].state == end
    assert does(end, watched.cycles[-30:])
    found = [] if end == "INACTIVE" else [70332]
    assert [alarm.id for alarm in watched.channel.alarms] == found


def stays_behind_an_alarm(watched):
    """An axis does not move in an error: the offset of the cycle of the alarm is kept."""
    behind = [cycle.offset_mm for cycle in watched.cycles[watched.alarm_cycle() :]]
    assert set(behind) == {behind[0]}


def test_the_table_of_the_control_is_this_one():
    for state, command, after in PAIRS:
        row = changes()[DistanceState[state], DistanceCommand[command]]
        assert (row.next.name if row.next is not None else row.alarm_ids[-1]) == after
    beyond = {key for key in changes() if key[0].name not in STATES}
    assert {(state.name, command.name) for state, command in beyond} == {
        ("ERROR", command) for command in WORDS
    }


@pytest.mark.long(but=1)
@pytest.mark.parametrize(("state", "command", "after"), PAIRS)
def test_the_program_commands(run_distance, state, command, after):
    watched = run_distance(f"{WAY[state]}\nN50 {WORDS[command]}\nN60 G4 0.3", *SWAY)
    if isinstance(after, int):
        assert watched.alarm.id == after
        assert watched.alarm_cycle() == watched.first_of(50)
        stays_behind_an_alarm(watched)
        return
    begin = watched.first_of(60)
    if state != "TURNING_OFF":  # OFF twice in a row is carried out in one cycle
        assert watched.cycles[begin - 1].state in {state, after}
    assert [cycle.state for cycle in watched.cycles[begin : begin + 5]] == [after] * 5
    holds_in_the_end(watched, after)
    if command != "OFF":
        assert watched.channel.distance.control("Z").source is Source.NC


class Asks:
    """A PLC that commands once, some cycles into a block; the kernel takes it in the next cycle."""

    def __init__(self, command, block=60, cycles=3):
        self.command, self.block, self.cycles = DistanceCommand[command], block, cycles
        self.taken_in = None

    def __call__(self, channel, cycle):
        head = channel.execution.block
        if self.taken_in is not None or head is None or head.number != self.block:
            return
        self.cycles -= 1
        if self.cycles:
            return
        self.taken_in = cycle
        unit = channel.plc.axis["Z"].distance
        unit.command_w = UnitCommand(self.command, 30.0, 3.0)
        unit.enable_w = unit.command_semaphor_rw = True


@pytest.mark.long(but=1)
@pytest.mark.parametrize(("state", "command", "after"), PAIRS)
def test_the_plc_commands(run_distance, state, command, after):
    asks = Asks(command)
    watched = run_distance(f"{WAY[state]}\nN60 G4 0.3", *SWAY, act=asks)
    unit = watched.channel.plc.axis["Z"].distance
    assert not unit.command_semaphor_rw
    taken = asks.taken_in
    assert watched.cycles[taken - 1].state == state
    if isinstance(after, int):
        assert watched.alarm.id == 310014
        values = watched.alarm.values
        assert (values["current"], values["wanted"]) == (state, command)
        assert watched.alarm_cycle() == taken
        stays_behind_an_alarm(watched)
        return
    assert [cycle.state for cycle in watched.cycles[taken : taken + 5]] == [after] * 5
    holds_in_the_end(watched, after)
    assert unit.state_r.source is Source.PLC


@pytest.mark.long
@pytest.mark.parametrize("command", WORDS)
def test_in_an_error_nothing_is_commanded_and_the_offset_stays(run_distance, command):
    """The tool would touch: the program has ended, a command of the PLC waits in its unit."""

    def act(channel, cycle):
        if channel.alarms:
            unit = channel.plc.axis["Z"].distance
            unit.command_w = UnitCommand(DistanceCommand[command], 30.0, 3.0)
            unit.enable_w = unit.command_semaphor_rw = True

    watched = run_distance(
        f"N10 {ON}\nN20 G4 0.3\nN30 Z[DIST_CTRL SET_POS=33]\nN40 G4 1\nN50 {WORDS[command]}",
        "plant:gap.workpiece.plane.level_mm=31",
        act=act,
    )
    assert watched.alarm.id == 70330
    assert 50 not in {cycle.block for cycle in watched.cycles}
    behind = watched.cycles[watched.alarm_cycle() :]
    assert {cycle.state for cycle in behind} == {"ERROR"}
    stays_behind_an_alarm(watched)
