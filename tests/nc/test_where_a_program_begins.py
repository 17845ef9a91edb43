"""Where the axes are when a program begins, and the zero offsets that are in use then."""

import pytest
from tests.nc.conftest import of, texts

from axisrig.kernel.nc.canon import LinearMove
from axisrig.kernel.nc.coordinates import OffsetTables, Tool, Tools, ZeroOffsets


def targets(commands):
    return [move.target_mm for move in of(commands, LinearMove)]


def test_distances_count_from_the_set_positions_and_not_from_the_actual_ones(run, plane_machine):
    """The axes lag by 0.25 mm; V.A.ACT_POS alone shows it."""
    machine = plane_machine({"X": 10.0, "Y": -5.0, "Z": 1.0}, None)
    machine.lag_mm = 0.25
    text = 'G91 G0 X1 Y1\n#MSG ["%g %g %g", V.A.ABS.Z, V.A.PROG.X, V.A.ACT_POS.Z]'
    commands = run(text, machine)
    assert targets(commands) == [{"X": 11.0, "Y": -4.0}]
    assert texts(commands) == ["1 11 1.25"]


@pytest.mark.parametrize(
    ("group", "own", "x_mm"), [(0, False, 0.0), (0, True, 4.0), (1, False, 10.0), (2, True, 20.0)]
)
def test_the_default_group_is_in_use_until_another_one_is_chosen(run, group, own, x_mm):
    """P-ZERO-00002; group 0 only where P-ZERO-00001 lets it act."""
    offsets = ZeroOffsets(
        {(0, 0): 4.0, (1, 0): 10.0, (2, 0): 20.0}, group_0_acts=own, default_group=group
    )
    found = targets(run("G0 X1\nG55\nX1\nG53\nX1", tables=OffsetTables(zero_offsets=offsets)))
    places = [x_mm + 1.0, 21.0, 5.0 if own else 1.0]
    moved = [at for at, before in zip(places, [0.0, *places], strict=False) if at != before]
    assert [target["X"] for target in found] == moved


def test_each_program_begins_with_the_tables_of_the_rig(run):
    """What one has written of offsets and tools is not there for the next one."""
    tables = OffsetTables(
        zero_offsets=ZeroOffsets({(1, 0): 10.0}),
        tools=Tools({1: Tool(length_mm=5.0, offsets_mm={0: 2.0}, valid=True)}),
    )
    text = (
        '#MSG ["%g %g %g", V.G.NP[1].V.X, V.G.WZ[1].L, V.G.WZ[1].V.X]\n'
        "V.G.NP[1].V.X=3\nV.G.WZ[1].L=4\nV.G.WZ[1].V.X=6\nV.G.NP_DEFAULT=1\n"
        '#MSG ["%g %g %g", V.G.NP[1].V.X, V.G.WZ[1].L, V.G.WZ[1].V.X]'
    )
    for _ in range(2):
        assert texts(run(text, tables=tables)) == ["10 5 2", "3 4 6"]
    assert tables.zero_offsets.default_group == 0
