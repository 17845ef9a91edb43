"""Zero offsets and tools as tables: what a value of a list makes of them, and copies of them."""

from pathlib import Path

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.kinematics import KinematicData
from axisrig.kernel.nc.coordinates.circle import CircleLimits
from axisrig.kernel.nc.coordinates.lists import TOOLS, ZERO_OFFSETS, Entry, read_entry
from axisrig.kernel.nc.coordinates.tables import Lists, OffsetTables
from axisrig.kernel.nc.coordinates.tools import Tool, Tools, make_tools
from axisrig.kernel.nc.coordinates.zero_offsets import ZeroOffsets, make_zero_offsets
from axisrig.kernel.parameters import Origin


def entries(name: str, *lines: str) -> list[Entry]:
    origin = Origin("list", 1, 1)
    return [read_entry(name, *line.rsplit(" ", 1), origin) for line in lines]


def offsets(*lines: str) -> ZeroOffsets:
    return make_zero_offsets(entries(ZERO_OFFSETS, *lines))


# Zero offsets


def test_an_offset_counts_tenths_of_a_micrometre_of_its_group_and_axis() -> None:
    table = offsets("np_grp[1].achse[0].versch 15000", "np_grp[2].achse[1].versch -1")
    assert [table.shift_mm(group, axis) for group in (1, 2) for axis in (0, 1)] == [
        1.5, 0.0, 0.0, -0.0001,
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("lines", "acts"),
    [
        ((), True), (("inaktiv 1",), False), (("inaktiv 0",), True),
        (("inaktiv 1", "inaktiv 0"), True), (("inaktiv 0", "inaktiv 1"), False),
    ],
)  # fmt: skip
def test_an_inactive_offset_does_not_act_and_others_of_its_group_do(
    lines: tuple[str, ...], acts: bool
) -> None:
    """The last value counts: a plan may set what a file has set before."""
    written = ["np_grp[1].achse[0].versch 10000", "np_grp[1].achse[1].versch 20000"]
    written += [f"np_grp[1].achse[0].{line}" for line in lines]
    table = offsets(*written)
    assert (table.shift_mm(1, 0), table.shift_mm(1, 1)) == (1.0 if acts else 0.0, 2.0)


def test_an_offset_is_inactive_in_its_group_alone() -> None:
    written = [f"np_grp[{group}].achse[1].versch {group}0000" for group in (1, 2, 3)]
    table = offsets(*written, "np_grp[2].achse[1].inaktiv 1")
    assert [table.shift_mm(group, 1) for group in (1, 2, 3)] == [1.0, 0.0, 3.0]


@pytest.mark.parametrize(("available", "acts"), [("0", False), ("1", True)])
def test_group_0_acts_only_where_the_list_says_so(available: str, acts: bool) -> None:
    table = offsets(f"g53_verfuegbar {available}", "np_grp[0].achse[2].versch 30000")
    assert table.shift_mm(0, 2) == (3.0 if acts else 0.0)
    assert offsets("np_grp[0].achse[2].versch 30000").shift_mm(0, 2) == 0.0


def test_a_program_writes_to_a_table_of_its_own() -> None:
    """Offsets, inactive ones, group 0 and the default group."""
    table = offsets(
        "g53_verfuegbar 1", "default_index 3", "np_grp[1].achse[0].versch 10000",
        "np_grp[1].achse[1].inaktiv 1",
    )  # fmt: skip
    copied = table.copy()
    assert copied == table
    copied.offsets_mm[1, 0] = 9.0
    copied.inactive.clear()
    copied.group_0_acts, copied.default_group = False, 0
    assert (table.offsets_mm, table.inactive) == ({(1, 0): 1.0}, {(1, 1)})
    assert (table.group_0_acts, table.default_group) == (True, 3)


# Tools


def test_a_tool_may_be_in_inches_wherever_its_unit_stands() -> None:
    """P-TOOL-00008: 1/10000 inch; its axis offsets too, and no other tool."""
    tools = make_tools(
        entries(
            TOOLS, "wz[1].laenge 10000", "wz[1].radius 5000", "wz[1].mass_einheit 1",
            "wz[1].ax_versatz[2] -20000", "wz[1].gueltig 1", "wz[2].laenge 10000",
            "wz[2].mass_einheit 0", "wz[2].gueltig 1", "wz[3].laenge 10000",
        )
    )  # fmt: skip
    inch, metric = tools.find(1), tools.find(2)
    assert inch == Tool(25.4, 12.7, {2: -50.8}, valid=True)
    assert metric == Tool(1.0, valid=True)
    assert tools.find(3) is None  # its data are not valid
    assert tools.record(3).length_mm == 1.0


@pytest.mark.parametrize("number", [1, 200])
def test_only_tool_0_is_there_without_data(number: int) -> None:
    tools = Tools()
    assert tools.find(0) == Tool(valid=True)
    assert tools.find(number) is None
    tools.record(number).valid = True
    assert tools.find(number) == Tool(valid=True)


def test_a_program_writes_to_tools_of_its_own() -> None:
    tools = Tools({1: Tool(1.0, 2.0, {0: 3.0}, valid=True)})
    copied = tools.copy()
    copied.record(1).length_mm = 9.0
    copied.record(1).offsets_mm[0] = 9.0
    copied.record(2).valid = True
    assert tools.find(1) == Tool(1.0, 2.0, {0: 3.0}, valid=True)
    assert tools.find(2) is None
    tool = tools.record(1)
    other = tool.copy()
    other.offsets_mm[1] = 1.0
    assert tool.offsets_mm == {0: 3.0}


# Indices


@pytest.mark.parametrize(
    ("name", "path", "last"),
    [
        (ZERO_OFFSETS, "np_grp[{}].achse[0].versch", 96),
        (ZERO_OFFSETS, "np_grp[{}].achse[31].inaktiv", 96),
        (ZERO_OFFSETS, "np_grp[0].achse[{}].versch", 31),
        (ZERO_OFFSETS, "np_grp[96].achse[{}].inaktiv", 31),
        (TOOLS, "wz[{}].laenge", 200),
        (TOOLS, "wz[{}].param[69]", 200),
        (TOOLS, "wz[0].param[{}]", 69),
        (TOOLS, "wz[200].param[{}]", 69),
    ],
)
def test_each_bracket_takes_its_last_index_and_none_after_it(
    name: str, path: str, last: int
) -> None:
    """97 groups of zero offsets, 32 axes, 201 tools and 70 parameters of each count from 0."""
    for index in (0, 1, last - 1, last):
        (entry,) = entries(name, f"{path.format(index)} 1")
        assert entry.written.split()[0] == path.format(index)
    for index in (last + 1, last + 2, 9999):
        with pytest.raises(UserError, match="index too large") as caught:
            entries(name, f"{path.format(index)} 1")
        assert (caught.value.value, caught.value.allowed) == (path.format(index), f"0 .. {last}")


def test_the_last_group_the_last_axis_and_the_last_tool_act() -> None:
    """Each at its own place: 1 mm, 2 mm and a length of 3 mm with 4 mm in its first axis."""
    table = offsets("np_grp[96].achse[0].versch 10000", "np_grp[96].achse[31].versch 20000")
    places = [(group, axis) for group in (95, 96) for axis in (0, 30, 31)]
    assert [table.shift_mm(*place) for place in places] == [0.0, 0.0, 0.0, 1.0, 0.0, 2.0]
    lines = ("wz[200].laenge 30000", "wz[200].ax_versatz[0] 40000", "wz[200].gueltig 1")
    tools = make_tools(entries(TOOLS, *lines))
    assert tools.find(200) == Tool(3.0, offsets_mm={0: 4.0}, valid=True)
    assert tools.find(199) is None


# Several lists


def test_lists_and_cells_of_a_plan_add_up_and_the_last_value_counts(tmp_path: Path) -> None:
    first, second, tools = (tmp_path / f"{name}.lst" for name in ("first", "second", "tools"))
    first.write_text("np_grp[1].achse[0].versch 10000\nnp_grp[1].achse[1].versch 20000\n")
    second.write_text("np_grp[1].achse[1].versch 30000\nnp_grp[2].achse[0].versch 40000\n")
    tools.write_text("wz[3].laenge 50000\nwz[3].gueltig 1\n")
    lists = Lists()
    lists.read(ZERO_OFFSETS, first)
    lists.set(ZERO_OFFSETS, "np_grp[2].achse[1].versch", "70000", Origin("plan", 2, 1))
    lists.read(TOOLS, tools)
    lists.read(ZERO_OFFSETS, second)
    lists.set(TOOLS, "wz[3].laenge", "60000", Origin("plan", 2, 1))
    found = lists.tables(rotary=["C"], ball_radius_counts=False, cycle_changes_modal=True)
    shifts = [found.zero_offsets.shift_mm(group, axis) for group in (1, 2) for axis in (0, 1)]
    assert shifts == [1.0, 3.0, 4.0, 7.0]
    assert found.tools.find(3) == Tool(6.0, valid=True)
    assert (found.rotary, found.ball_radius_counts) == ({"C"}, False)
    assert found.cycle_changes_modal


@pytest.mark.parametrize("values", [(1,), (0,), (1, 0), (0, 1)])
def test_a_tool_is_valid_and_fixed_as_its_last_value_says(values: tuple[int, ...]) -> None:
    """P-TOOL-00010; a plan may take back what a file has set."""
    for name in ("gueltig", "tool_fixed"):
        tools = make_tools(entries(TOOLS, *(f"wz[4].{name} {value}" for value in values)))
        tool = tools.record(4)
        assert (tool.valid, tool.fixed) == (
            name == "gueltig" and values[-1] == 1,
            name == "tool_fixed" and values[-1] == 1,
        )
        assert (tools.find(4) is not None) is (name == "gueltig" and values[-1] == 1)


def test_what_the_channel_says_of_arcs_and_kinematics_is_beside_the_offsets() -> None:
    """As given; where nothing is given as without any list."""
    limits, data = CircleLimits(1.0, 0.02, 0.03, 0.004), KinematicData(default_ids=(1, 2))
    found = Lists().tables(rotary=(), ball_radius_counts=True, circle=limits, kinematics=data)
    assert (found.circle, found.kinematics) == (limits, data)
    usual = Lists().tables(rotary=(), ball_radius_counts=True)
    assert (usual.circle, usual.kinematics) == (OffsetTables().circle, KinematicData())
    assert not usual.cycle_changes_modal
