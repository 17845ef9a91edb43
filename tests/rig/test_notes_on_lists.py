"""Notes on parameter and offset lists, the kind of a list, and the values that `params` shows."""

import re
from pathlib import Path

import pytest

from axisrig.bench.rig import contents
from axisrig.bench.rig.contents import contents_text
from axisrig.bench.rig.parameter_words import named
from axisrig.bench.rig.reading.lists import offset_notes, stop_notes
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.coordinates.tables import Lists
from axisrig.kernel.parameters import Origin, ParameterSet
from axisrig.kernel.parameters.table import INDEX

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def axis(**values: int) -> ParameterSet:
    found = ParameterSet("axis")
    for name, value in values.items():
        path = "kenngr.measure." + name.replace("__", ".")
        found.load(path, str(value) if name != "signal" else "FIXED_STOP", Origin("z.lst", 1))
    return found


STOP = "fixed_stop_detect__"


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, None),  # another source
        ({"signal": 1}, "set a lag limit (P-AXIS-00774"),
        ({"signal": 1, STOP + "pos_lag_limit": 5000}, None),
        ({"signal": 1, STOP + "max_delta_position_window": 1500}, "no minimum time: set min_time"),
        ({"signal": 1, STOP + "max_delta_position_window": 1500, STOP + "min_time": 20_000}, None),
        ({STOP + "max_delta_position_window": 1500}, None),
    ],
)
def test_a_stop_that_nothing_can_find_is_said(values: dict[str, int], words: str | None) -> None:
    notes = stop_notes({"X": axis(), "Z": axis(**values)})
    if words is None:
        assert notes == []
        return
    (note,) = notes
    assert note.startswith("axis Z: as listed no stop can be found")
    assert words in note


def offsets(tmp_path: Path, name: str, *lines: str) -> Lists:
    path = tmp_path / f"{name}.lst"
    path.write_text("\n".join(["# a list", *lines, ""]), encoding="utf-8")
    lists = Lists()
    lists.read(name, path)
    return lists


@pytest.mark.parametrize(
    ("lines", "notes"),
    [
        (["wz[2].gueltig 1", "wz[2].radius 0", "wz[2].laenge 800000"], []),
        (["wz[2].gueltig 1", "wz[2].radius -1"], ["a radius below 0"]),
        (["wz[2].laenge 800000"], ["the list has no `wz[2].gueltig 1`, so D2 is refused"]),
        (["wz[2].gueltig 0", "wz[2].laenge 1"], ["no `wz[2].gueltig 1`"]),
        (["wz[2].laenge 1", "wz[2].radius 5"], ["no `wz[2].gueltig 1`"]),  # once for each tool
        (["wz[2].laenge 1", "wz[3].laenge 1", "wz[3].gueltig 1"], ["no `wz[2].gueltig 1`"]),
        (["wz[0].gueltig 1"], ["D0 is no tool, its data never act"]),
        (["wz[2].gueltig 1", "wz[2].ax_versatz[1] 10"], []),
        (["wz[2].gueltig 1", "wz[2].ax_versatz[2] 10"], ["the rig has no axis 2, it has 0 = X"]),
    ],
)
def test_what_cannot_be_meant_in_a_list_of_tools_is_said(
    tmp_path: Path, lines: list[str], notes: list[str]
) -> None:
    found = offset_notes(offsets(tmp_path, "tools", *lines), ("X", "Z"))
    assert len(found) == len(notes), found
    for note, words in zip(found, notes, strict=True):
        assert note.startswith("tools: wz[")
        assert words in note
    beside = offset_notes(offsets(tmp_path, "tools", "wz[2].gueltig 1", "wz[2].ax_versatz[7] 1"))
    assert beside == []  # without a rig nobody knows its axes


def test_a_list_of_tools_is_shown_in_mm_where_it_is_not_in_inch(tmp_path: Path) -> None:
    """0.1 um; of a tool in inch only what is written."""
    path = tmp_path / "tools.lst"
    path.write_text(
        "wz[2].gueltig 1\nwz[2].laenge 800000\nwz[3].gueltig 1\nwz[3].mass_einheit 1\n"
        "wz[3].laenge 10000\nwz[4].laenge 5\n",
        encoding="utf-8",
    )
    lines = [line.strip() for line in contents_text(path).splitlines() if line.strip()]
    assert lines[0] == "tools"
    assert "wz[2].laenge 800000 x 0.1 um = 80 mm  tools.lst:2" in lines
    assert any(line.startswith("wz[3].laenge 10000  ") for line in lines)
    assert "wz[2].gueltig 1  tools.lst:1" in lines
    assert lines[-1].startswith("note: tools: wz[4].laenge 5 (tools.lst:6): the list has no")


@pytest.mark.parametrize(
    ("lines", "shown"),
    [
        # The index of an axis is no number of a tool
        (["wz[2].mass_einheit 1", "wz[5].ax_versatz[2] 70"], [None, "0.007 mm"]),
        (["wz[2].mass_einheit 1", "wz[2].ax_versatz[5] 70"], [None, None]),
        (["wz[2].mass_einheit 1", "wz[2].ax_versatz[2] 70"], [None, None]),
        (["wz[0].mass_einheit 1", "wz[3].ax_versatz[0] -70"], [None, "-0.007 mm"]),
        # The unit of a tool may be after its values, and 0 is 0.1 um
        (["wz[4].radius 20000", "wz[4].mass_einheit 1"], [None, None]),
        (["wz[4].radius 20000", "wz[4].mass_einheit 0"], ["2 mm", None]),
        (["wz[4].radius 20000", "wz[4].laenge -5", "wz[4].mass_einheit 0"],
         ["2 mm", "-0.0005 mm", None]),
        (["wz[1].mass_einheit 1", "wz[1].laenge 1", "wz[2].laenge 2", "wz[3].mass_einheit 1",
          "wz[3].radius 3"], [None, None, "0.0002 mm", None, None]),
        # What is no length has no unit
        (["wz[4].gueltig 1", "wz[4].param[1] 5.5", "wz[4].vb_max 9"], [None, None, None]),
        # Zero offsets know no inches
        (["np_grp[1].achse[2].versch 1234567", "np_grp[1].achse[2].inaktiv 1"],
         ["123.457 mm", None]),
        (["default_index 3", "np_grp[96].achse[31].versch -10"], [None, "-0.001 mm"]),
    ],
)  # fmt: skip
def test_a_length_of_0_1_um_is_shown_in_mm_and_one_in_inch_is_not(
    tmp_path: Path, lines: list[str], shown: list[str | None]
) -> None:
    path = tmp_path / "own.lst"
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    name, *rows = contents_text(path).split("\n\n")[0].splitlines()
    assert name == ("tools" if lines[0].startswith("wz") else "zero offsets")
    for number, (row, line, in_mm) in enumerate(zip(rows, lines, shown, strict=True), 1):
        unit = "" if in_mm is None else f" x 0.1 um = {in_mm}"
        assert row == f"  {line}{unit}  own.lst:{number}"


def test_values_of_a_rig_are_chosen_by_all_words_or_by_one_parameter() -> None:
    settings = contents.settings_of(RIGS / "probe-z.toml", ["set:Z.getriebe[0].vb_eilgang=77000"])
    parts = contents.parts_of(settings, None)
    assert list(parts) == ["channel", "Z"]
    assert list(contents.parts_of(settings, "Z")) == ["Z"]
    with pytest.raises(UserError, match="the rig has no such axis"):
        contents.parts_of(settings, "Q")
    (one,) = contents.blocks_text(parts, ["P-AXIS-00209"])
    title, line = one.splitlines()
    assert title == "axis Z"
    assert "vb_eilgang" in line
    assert "77000" in line
    both = "\n".join(contents.blocks_text(parts, ["p-axis-00209", "rapid"]))
    assert "vb_eilgang" in both
    assert contents.blocks_text(parts, ["rapid", "zebra"]) == []
    assert contents.blocks_text(parts, ["P-AXIS-00209", "zebra"]) == []  # each word has to occur
    assert contents.blocks_text(parts, ["zebra", "P-AXIS-00209"]) == []
    # Without words what is set alone
    of_set = "\n".join(contents.blocks_text(parts, None))
    assert "vb_eilgang" in of_set
    every = "\n".join(contents.blocks_text(parts, []))
    assert len(every.splitlines()) > len(of_set.splitlines())


@pytest.mark.parametrize(
    ("number", "loaded", "with_words", "without"),
    [
        # What acts of an element comes first, whether it is set or not
        ("00209", ["getriebe[1].vb_eilgang"],
         ["getriebe[0].vb_eilgang", "getriebe[1].vb_eilgang"],
         ["getriebe[0].vb_eilgang", "getriebe[1].vb_eilgang"]),
        ("00209", ["getriebe[0].vb_eilgang"], ["getriebe[0].vb_eilgang"],
         ["getriebe[0].vb_eilgang"]),
        # Of a second encoder element 1 acts
        ("00230", ["lr_hw[0].vz_istw"], ["lr_hw[1].vz_istw", "lr_hw[0].vz_istw"],
         ["lr_hw[1].vz_istw", "lr_hw[0].vz_istw"]),
        # What acts by its index, or not at all, has a line without words where it is there
        ("00423", [], ["lr_hw[1].encoder_resolution_denom"], ["lr_hw[1].encoder_resolution_denom"]),
        ("00234", [], ["getriebe[0].wegaufz"], []),
        ("00234", ["getriebe[1].wegaufz"], ["getriebe[0].wegaufz", "getriebe[1].wegaufz"],
         ["getriebe[1].wegaufz"]),
    ],
)  # fmt: skip
def test_of_elements_of_a_list_the_acting_one_comes_first(
    number: str, loaded: list[str], with_words: list[str], without: list[str]
) -> None:
    parameters = ParameterSet("axis")
    for path in loaded:
        parameters.load(path, "1", Origin("z.lst", 1))
    row = named(f"P-AXIS-{number}")
    assert row is not None

    def shown(words: list[str]) -> list[str]:
        (block,) = contents.blocks_text({"Z": parameters}, words)
        keys = [line.split()[0] for line in block.splitlines()[1:]]
        return [key for key in keys if INDEX.sub("[i]", key) == row.path]

    assert (shown([row.number]), shown([])) == (with_words, without)
    # An element as a list writes it means its parameter too
    assert all(shown([path]) == with_words for path in [*loaded, with_words[-1]])


def test_a_list_has_the_kind_of_most_of_its_names_then_of_fewest_errors(tmp_path: Path) -> None:
    for text, kind in (
        ("kopf.log_achs_name Z\ngetriebe[0].vb_eilgang 5\n", "Z"),
        ("getriebe[0].vb_eilgang 5\n", "#1"),
        ("messtyp 1\nmittelpkt_diff 5\n", "channel"),
        ("kopf.log_achs_name Z\nmesstyp 1\ngetriebe[0].vb_eilgang 5\n", "Z"),
    ):
        path = tmp_path / "own.lst"
        path.write_text(text, encoding="utf-8")
        if "messtyp" in text and "kopf" in text:
            with pytest.raises(UserError, match="messtyp"):
                contents.read_parts(path)
        else:
            assert list(contents.read_parts(path)) == [kind]
    with pytest.raises(UserError, match=r"gone\.lst"):
        contents.read_parts(tmp_path / "gone.lst")


AS_AXIS, AS_CHANNEL = "unknown axis parameter", "unknown channel parameter"


@pytest.mark.parametrize(
    ("lines", "read_as"),
    [
        # One name is of the axis and one of the channel: what has fewer errors counts
        (["kenngr.messachse 1", "messtyp 99"], AS_AXIS),
        (["messtyp 99", "kenngr.messachse 1"], AS_AXIS),
        (["kenngr.messachse 7", "messtyp 1"], AS_CHANNEL),
        (["messtyp 1", "kenngr.messachse 7"], AS_CHANNEL),
        # As many errors: the first kind
        (["kenngr.messachse 1", "messtyp 1"], AS_AXIS),
        (["kenngr.messachse 7", "messtyp 99"], AS_AXIS),
        # Most of the names count before any error
        (["kenngr.messachse 7", "kenngr.measure.edge UP", "messtyp 1"], AS_AXIS),
        (["kenngr.messachse 1", "messtyp 98", "messtyp 99"], AS_CHANNEL),
        # Two of each: one error more is enough
        (["kenngr.messachse 7", "kenngr.measure.edge NEG", "messtyp 1", "mittelpkt_diff 5"],
         AS_CHANNEL),
        (["kenngr.messachse 7", "kenngr.measure.edge NEG", "messtyp 98", "mittelpkt_diff x"],
         AS_AXIS),
    ],
)  # fmt: skip
def test_a_list_that_fits_no_kind_is_read_as_what_it_most_looks_like(
    tmp_path: Path, lines: list[str], read_as: str
) -> None:
    path = tmp_path / "own.lst"
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    with pytest.raises(UserError) as caught:
        contents.read_parts(path)
    found = [caught.value, *caught.value.further]
    assert next(one.message for one in found if "unknown" in one.message) == read_as


@pytest.mark.parametrize("wrong", [["X"], ["Y"], ["Z"], ["X", "Z"], []])
def test_each_axis_of_a_list_has_its_notes(tmp_path: Path, wrong: list[str]) -> None:
    """An acceleration of a stage above P-AXIS-00008 is taken as it is."""
    path = tmp_path / "own.lst"
    path.write_text(
        "".join(
            f"kopf.achs_nr {number}\nkopf.log_achs_name {axis}\ngetriebe[0].dynamik.a_max 500\n"
            f"getriebe[0].lslope_profil.a_stufe_1 {501 if axis in wrong else 500}\n"
            for number, axis in enumerate("XYZ", 1)
        ),
        encoding="utf-8",
    )
    assert list(contents.read_parts(path)) == ["X", "Y", "Z"]
    text = contents_text(path)
    notes = [line for line in text.splitlines() if line.startswith("note: ")]
    assert len([note for note in notes if "taken as it is" in note]) == len(wrong)


def test_axes_without_a_name_are_counted_from_1(tmp_path: Path) -> None:
    path = tmp_path / "own.lst"
    path.write_text("getriebe[0].vb_eilgang 5\n", encoding="utf-8")
    assert list(contents.read_parts(path)) == ["#1"]
    assert contents_text(path).splitlines()[0] == "axis #1"


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        ("kenngr.messachse 1", None),
        ("antr.sercos.mdt_offset 300", None),  # this one does not act, others of its kind do
        ("messtyp 1", None),
        ("auto_memory_mode 1", "external"),
        ("mds_time_slots 1", "startup"),
    ],
)
def test_a_list_of_which_nothing_can_act_is_said_to_change_nothing(
    tmp_path: Path, line: str, kind: str | None
) -> None:
    path = tmp_path / "own.lst"
    path.write_text(f"{line}\n", encoding="utf-8")
    found = re.findall(r"a list of this kind \((\w+)\) is read", contents.contents_text(path))
    assert found == ([] if kind is None else [kind])
