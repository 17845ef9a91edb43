"""Zero offset and tool lists in the format of the manuals."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.coordinates.lists import TOOLS, ZERO_OFFSETS, forms
from axisrig.kernel.nc.coordinates.tables import Lists
from axisrig.kernel.parameters import Origin

# After TF5200 zero offsets 103727115 and tool data 104781195
ZERO_LIST = """\
# zero offsets
g53_verfuegbar    1    ( offsets unequal to 0 are evaluated )
default_index     2    ( G55 is in use when a program begins )
np_grp[0].achse[0].versch   80000   # 8 mm
np_grp[1].achse [0].versch 100000 ; a blank as printed
np_grp[1].achse[1].versch  200000
np_grp[1].achse[1].inaktiv      1
np_grp[2].achse[0].versch       1
"""
TOOL_LIST = """\
wz[5].laenge        600000   # 60 mm
wz[5].radius         20000
wz[5].gueltig            1
wz[5].ax_versatz[0] 2050000
wz[5].ax_versatz[3] -4080000
wz[5].log_ax_nr_spdl     6
wz[8].laenge         10000
wz[8].mass_einheit       1
wz[8].gueltig            1
wz[8].tool_fixed         1
wz[9].laenge          5000
"""


@pytest.fixture
def lists(tmp_path):
    def read(name, text):
        path = tmp_path / "some.lst"
        path.write_text(text)
        lists = Lists()
        lists.read(name, path)
        return lists

    return read


def test_zero_offsets_of_a_list(lists):
    table = lists(ZERO_OFFSETS, ZERO_LIST).tables(rotary=(), ball_radius_counts=True).zero_offsets
    assert table.default_group == 2
    assert table.shift_mm(0, 0) == 8.0
    assert table.shift_mm(1, 0) == 10.0
    assert table.shift_mm(1, 1) == 0.0
    assert table.shift_mm(2, 0) == 0.0001
    assert table.shift_mm(3, 0) == 0.0


def test_g53_is_without_offset_unless_the_list_says_so(lists):
    table = lists(ZERO_OFFSETS, "np_grp[0].achse[0].versch 80000").tables(
        rotary=(), ball_radius_counts=True
    )
    assert table.zero_offsets.shift_mm(0, 0) == 0.0


def test_tools_of_a_list(lists):
    tools = lists(TOOLS, TOOL_LIST).tables(rotary=(), ball_radius_counts=True).tools
    five, eight = tools.find(5), tools.find(8)
    assert five is not None
    assert eight is not None
    assert (five.length_mm, five.radius_mm, five.fixed) == (60.0, 2.0, False)
    assert five.offsets_mm == {0: 205.0, 3: -408.0}
    assert (eight.length_mm, eight.fixed) == (pytest.approx(25.4), True)
    assert tools.find(9) is None, "without gueltig the data may not be used"
    assert tools.find(0) is not None, "D0 is always there"


@pytest.mark.parametrize("unit_first", [True, False])
def test_a_tool_in_inches_has_all_of_its_lengths_in_inches(lists, unit_first):
    """0.0001 inch: length, radius and offsets, wherever the unit is; the other tool stays in mm."""
    unit = "wz[3].mass_einheit 1\n"
    values = "wz[3].laenge 20000\nwz[3].radius 1250\nwz[3].ax_versatz[1] -500\nwz[3].gueltig 1\n"
    other = "wz[4].mass_einheit 0\nwz[4].radius 1250\nwz[4].gueltig 1\n"
    text = (unit + values if unit_first else values + unit) + other
    tools = lists(TOOLS, text).tables(rotary=(), ball_radius_counts=True).tools
    three, four = tools.find(3), tools.find(4)
    assert three is not None
    assert four is not None
    assert three.length_mm == pytest.approx(50.8)
    assert three.radius_mm == pytest.approx(3.175)
    assert three.offsets_mm == pytest.approx({1: -1.27})
    assert four.radius_mm == 0.125


def test_single_values_come_after_the_file(lists):
    both = lists(TOOLS, TOOL_LIST)
    both.set(TOOLS, "wz[5].radius", "30000", Origin("set:tools.wz[5].radius"))
    tool = both.tables(rotary=(), ball_radius_counts=True).tools.find(5)
    assert tool is not None
    assert tool.radius_mm == 3.0


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        (ZERO_OFFSETS, "default index 2", "unknown name in a list of zero offsets"),
        (ZERO_OFFSETS, "default_index 97", "outside its range"),
        (ZERO_OFFSETS, "np_grp[97].achse[0].versch 1", "index too large"),
        (ZERO_OFFSETS, "np_grp[1].achse[0].versch 1.5", "takes a value of type SGN32"),
        (ZERO_OFFSETS, "np_grp[1].achse[0].inaktiv 80000", "outside its range"),
        (ZERO_OFFSETS, "g53_verfuegbar", "no value after the name"),
        (ZERO_OFFSETS, "np_grp[1].achse[2].versch 33 mm", "more than one.*'mm'.*counts in 0.1 um"),
        (ZERO_OFFSETS, "np_grp[1].achse [2].versch = 33", "no `=` between"),
        (ZERO_OFFSETS, "default_index=3", "no `=` between.*write `default_index 3`"),
        (ZERO_OFFSETS, "P-ZERO-00003 4", r"the number of `np_grp\[i\].achse\[j\].versch`"),
        (ZERO_OFFSETS, "np_grp[1.achse 5", "unknown name"),
        (ZERO_OFFSETS, "[ 5", "no name"),
        (TOOLS, "wz[1].length 5", "unknown name in a list of tools"),
        (TOOLS, "wz[1].laenge 99999999999", "outside its range"),
        (TOOLS, "wz[1].orientation_vector[2] -1", "does not act yet"),
        (TOOLS, "wz[1].radius 5\nwz[1].radius 6", "it is in line 1 already"),
    ],
)
def test_what_a_list_may_not_hold(lists, name, text, message):
    with pytest.raises(UserError, match=message) as error:
        lists(name, text)
    assert error.value.file is not None
    assert error.value.line == text.count("\n") + 1


def test_all_mistakes_of_a_list_come_together(lists):
    with pytest.raises(UserError) as error:
        lists(TOOLS, "wz[1].length 5\nwz[1].laenge 5\nwz[300].laenge 5\nwz[1].laenge 6\n")
    assert [one.line for one in (error.value, *error.value.further)] == [1, 3, 4]


def test_a_list_that_is_not_there(tmp_path):
    with pytest.raises(UserError, match="the list of tools cannot be read"):
        Lists().read(TOOLS, tmp_path / "none.lst")


def test_the_table_has_a_source_and_a_meaning_for_every_name():
    for name in (ZERO_OFFSETS, TOOLS):
        for form in forms(name).values():
            assert form.number.startswith("P-"), form.path
            assert all((form.meaning, form.source)), form.path
