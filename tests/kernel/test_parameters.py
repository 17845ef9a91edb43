"""Parameter table, parameter sets and lists. Expected values: FCT-C4 section 8, written by hand."""

from pathlib import Path

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import (
    INTEGER_RANGES,
    KINDS,
    UNITS,
    Kind,
    Origin,
    Parameter,
    ParameterSet,
    Table,
    read_list,
    table,
    write_list,
)

ALL = tuple(row for kind in KINDS for row in table(kind).parameters)
KIND_OF = {"": "axis", "P-AXIS": "axis", "P-CHAN": "channel", "P-EXTV": "external",
           "P-STUP": "startup"}  # fmt: skip
SLOPE = "getriebe[0].lslope_profil"


def listed(tmp_path: Path, text: str, kind: Kind = "axis") -> ParameterSet:
    path = tmp_path / "axis.lis"
    path.write_text(text, encoding="utf-8")
    return read_list(path, kind)


def refused(tmp_path: Path, text: str, kind: Kind = "axis") -> UserError:
    with pytest.raises(UserError) as caught:
        listed(tmp_path, text, kind)
    assert caught.value.file == str(tmp_path / "axis.lis")
    return caught.value


# --- the table -------------------------------------------------------------------------------


def test_numbers_and_paths_are_unique_over_present_and_older_names() -> None:
    paths = [(row.kind, path) for row in ALL for path in (row.path, *row.old_paths)]
    numbers = [row.number for row in ALL if row.number]
    assert len(set(paths)) == len(paths)
    assert len(set(numbers)) == len(numbers)


@pytest.mark.parametrize("row", ALL, ids=lambda row: row.path)
def test_row_is_complete_and_consistent(row: Parameter) -> None:
    assert row.type in (*INTEGER_RANGES, "REAL64", "STRING")
    assert row.unit in (*UNITS, "")
    assert row.meaning
    assert row.source
    assert row.kind == KIND_OF[row.number[:6]]
    for other in row.fallback:
        assert table(row.kind).row(other.path) is not None
    acting = [word for word in row.acts.split() if word not in ("indexed", "second")]
    assert acting in (["yes"], ["no"]) or {str(row.default), str(row.otherwise)} & set(acting)
    if row.default != "":
        written = str(int(row.default)) if isinstance(row.default, bool) else str(row.default)
        assert row.accept(written, Origin("here")) == row.default


@pytest.mark.parametrize(
    ("path", "default"),
    [
        ("kenngr.messachse", False),
        ("kenngr.hub_messtaster", 50000),
        ("kenngr.probing_offset", 0),
        (f"{SLOPE}.a_stufe_1", 1000),
        (f"{SLOPE}.vb_stufe_1_2", 100000),
        ("getriebe[0].kv", 1000),
        ("kenngr.vb_messen", 16666),
    ],
)
def test_documented_defaults(path: str, default: object) -> None:
    assert ParameterSet("axis").get(path) == default


def test_older_path_sets_the_same_parameter() -> None:
    row = Parameter(
        "P-AXIS-00001", "axis", "new[i].name", ("old[i].name",), "REAL64", "", 0.0, 2.0, 1.0,
        (), (), "yes", "m", "s",
    )  # fmt: skip
    assert Table([row]).find("old[3].name") == (row, "new[3].name")


# --- values ----------------------------------------------------------------------------------


def test_units_of_the_manuals_become_mm_and_seconds() -> None:
    axis = ParameterSet("axis")
    axis.set("kenngr.probing_offset", "12345", "plan")
    axis.set("getriebe[0].dynamik.vb_max", "16666", "plan")
    axis.set(f"{SLOPE}.a_stufe_1", "5000", "plan")
    axis.set("getriebe[0].position_settling_time", "200000", "plan")
    assert axis.mm("kenngr.probing_offset") == 1.2345
    assert axis.mm_s("getriebe[0].dynamik.vb_max") == 16.666
    assert axis.mm_s2(f"{SLOPE}.a_stufe_1") == 5000.0
    assert axis.ns("getriebe[0].position_settling_time") == 200_000_000


def test_conversion_of_the_wrong_quantity_is_a_defect() -> None:
    axis = ParameterSet("axis")
    with pytest.raises(TypeError):
        axis.mm("getriebe[0].dynamik.vb_max")
    with pytest.raises(TypeError):
        axis.ns("kenngr.probing_offset")
    with pytest.raises(TypeError):
        axis.flag("kenngr.measure.signal")
    with pytest.raises(KeyError):
        axis.get("getriebe[i].kv")


def test_probing_input_falls_back_over_two_older_parameters_to_input_1() -> None:
    axis = ParameterSet("axis")
    assert axis.integer("kenngr.measure.input") == 1
    axis.set("antr.canopen.probing_input_number", "2", "plan")
    assert axis.integer("kenngr.measure.input") == 2
    axis.set("antr.probing_input_nbr", "1", "plan")
    assert axis.integer("kenngr.measure.input") == 1
    axis.set("kenngr.measure.input", "2", "plan")
    assert axis.integer("kenngr.measure.input") == 2


def test_edge_falls_back_to_the_older_flag() -> None:
    axis = ParameterSet("axis")
    assert axis.word("kenngr.measure.edge") == "POS"
    axis.set("kenngr.mess_neg_flanke", "1", "plan")
    assert axis.word("kenngr.measure.edge") == "NEG"
    axis.set("kenngr.measure.edge", "POS", "plan")
    assert axis.word("kenngr.measure.edge") == "POS"


def test_unset_decelerations_take_the_accelerations() -> None:
    axis = ParameterSet("axis")
    for name, value in [("a_stufe_1", "11"), ("a_stufe_2", "12"),
                        ("a_grenz_stufe_1", "6"), ("a_grenz_stufe_2", "5")]:  # fmt: skip
        axis.set(f"{SLOPE}.{name}", value, "plan")
    assert axis.integer(f"{SLOPE}.d_stufe_1") == 11
    assert axis.integer(f"{SLOPE}.d_stufe_2") == 12
    assert axis.integer(f"{SLOPE}.d_grenz_stufe_1") == 6
    assert axis.integer(f"{SLOPE}.d_grenz_stufe_2") == 5
    assert axis.integer(f"{SLOPE}.a_feedh") == 5  # the smaller of the two rapid steps
    axis.set(f"{SLOPE}.a_feedh", "7", "plan")
    assert axis.integer(f"{SLOPE}.a_feedh") == 7


@pytest.mark.parametrize(("written", "us"), [("-1", 30), ("-9", 30), ("0", 0), ("8", 8)])
def test_negative_settling_time_leaves_the_decision_to_the_older_one(written: str, us: int) -> None:
    axis = ParameterSet("axis")
    axis.set("getriebe[0].pos_einschw_zeit", "30", "plan")
    axis.set("getriebe[0].position_settling_time", written, "plan")
    assert axis.integer("getriebe[0].position_settling_time") == us


# --- lists -----------------------------------------------------------------------------------


def test_list_in_the_format_of_the_manuals(tmp_path: Path) -> None:
    axis = listed(
        tmp_path,
        "# axis list\n\n"
        "kopf.achs_nr                 3   ; logical number\n"
        "kopf.log_achs_name           Z\n"
        "   kenngr.messachse\t1\n"
        "kenngr.measure.edge          NEG # falling\n"
        "getriebe[0].lslope_profil.a_grenz_stufe_1 0x1388\n",
    )
    assert axis.integer("kopf.achs_nr") == 3
    assert axis.word("kopf.log_achs_name") == "Z"
    assert axis.flag("kenngr.messachse") is True
    assert axis.word("kenngr.measure.edge") == "NEG"
    assert axis.integer(f"{SLOPE}.a_grenz_stufe_1") == 5000


def test_channel_list(tmp_path: Path) -> None:
    channel = listed(tmp_path, "messtyp 1\nmeas_error_no_signal 1\n", "channel")
    assert channel.flag("meas_error_no_signal") is True
    assert channel.integer("messtyp") == 1


def test_written_list_reads_back_equal(tmp_path: Path) -> None:
    axis = ParameterSet("axis")
    for path, text in [
        (f"{SLOPE}.a_stufe_1", "5000"),
        ("kenngr.messachse", "1"),
        ("kopf.log_achs_name", "Z"),
        ("getriebe[0].position_settling_time", "-7"),
    ]:
        axis.set(path, text, "plan")
    write_list(axis, tmp_path / "out.lis")
    again = read_list(tmp_path / "out.lis", "axis")
    assert list(again.items()) == list(axis.items())
    assert next(path for path, _ in again.items()) == "kopf.log_achs_name"


def test_index_written_in_two_ways_is_one_parameter(tmp_path: Path) -> None:
    error = refused(tmp_path, "getriebe[0].vb_eilgang 5\ngetriebe[00].vb_eilgang 6\n")
    assert "line 1" in error.message


# --- what is refused -------------------------------------------------------------------------


@pytest.mark.long
def test_unknown_name_is_told_with_place_and_nearest_names(tmp_path: Path) -> None:
    error = refused(tmp_path, "kopf.achs_nr 1\n  kenngr.mesachse 1\n")
    assert (error.line, error.column) == (2, 3)
    assert error.value == "kenngr.mesachse"
    assert "kenngr.messachse" in str(error.hint)


def test_name_of_the_other_list_is_recognised(tmp_path: Path) -> None:
    assert "parameter of the channel" in str(refused(tmp_path, "messtyp 1\n").hint)
    error = refused(tmp_path, "kenngr.messachse 1\n", "channel")
    assert "parameter of the axis" in str(error.hint)


@pytest.mark.parametrize(
    ("line", "value", "allowed"),
    [
        ("kenngr.probing_offset far", "far", "0 .. 4294967295 0.1 um"),
        ("kenngr.probing_offset 1.5", "1.5", "0 .. 4294967295 0.1 um"),
        ("kenngr.probing_offset 1_0", "1_0", "0 .. 4294967295 0.1 um"),
        ("kenngr.probing_offset -1", "-1", "0 .. 4294967295 0.1 um"),
        ("kenngr.probing_offset 4294967296", "4294967296", "0 .. 4294967295 0.1 um"),
        ("kenngr.messachse 2", "2", "0 .. 1"),
        ("kenngr.measure.edge RISING", "RISING", "POS, NEG"),
        ("kenngr.antr_typ 9", "9", "1, 2, 3, 4, 5, 6, 7, 8, 16, 32"),
        ("lr_hw[0].mask_mess_1 0x00c0", "0x00c0", "64, 128"),
        ("kenngr.measure.input 256", "256", "0 .. 255"),
        (f"{SLOPE}.a_stufe_1 0", "0", "1 .. 100000000 mm/s2"),
    ],
)
def test_value_of_wrong_type_or_range(tmp_path: Path, line: str, value: str, allowed: str) -> None:
    error = refused(tmp_path, f"\n{line}\n")
    assert (error.line, error.column) == (2, len(line) - len(value) + 1)
    assert error.value == value
    assert error.allowed == allowed


@pytest.mark.parametrize("text", ["nan", "inf", "1,5", "1_0", "2.5", "-0.1"])
def test_real_value_must_be_a_finite_number_in_range(text: str) -> None:
    row = Parameter("", "axis", "x", (), "REAL64", "", 0.0, 2.0, 1.0, (), (), "yes", "m", "s")
    assert row.accept("1.25", Origin("plan")) == 1.25
    with pytest.raises(UserError, match=r"0\.0 \.\. 2\.0"):
        row.accept(text, Origin("plan"))


def test_line_without_value_and_with_two_values(tmp_path: Path) -> None:
    assert "no value" in refused(tmp_path, "kenngr.messachse ; forgotten\n").message
    error = refused(tmp_path, "kenngr.messachse 1 0\n")
    assert "more than one value" in error.message
    assert error.value == "0"


def test_name_that_stands_twice_names_both_lines(tmp_path: Path) -> None:
    error = refused(tmp_path, "kenngr.messachse 1\n#\nkenngr.messachse 1\n")
    assert error.line == 3
    assert "line 1" in error.message


@pytest.mark.parametrize(
    ("line", "allowed"),
    [
        ("getriebe[0].multi_gain_z 300", "2000"),
        ("kenngr.measure.input_edge_banding 2", "0"),
        (f"{SLOPE.replace('0', '1')}.a_stufe_1 5000", "1000"),
        ("lr_hw[0].vz_istw 1", "0"),
    ],
)
def test_what_does_not_act_yet_may_stand_in_a_list_and_is_refused_in_a_cell(
    tmp_path: Path, line: str, allowed: str
) -> None:
    path, text = line.split()
    axis = listed(tmp_path, f"{line}\nkenngr.messachse 1\n")
    assert [name for name, _ in axis.inert()] == [path]
    with pytest.raises(UserError, match="known to the manuals, does not act yet") as caught:
        ParameterSet("axis").set(path, text, "plan")
    assert caught.value.allowed in (allowed, "yes")
    cell = ParameterSet("axis")
    cell.set(path, allowed.partition(",")[0], "plan")  # the value that acts is accepted
    assert cell.inert() == []


def test_setting_from_a_plan_is_checked_alike_and_names_its_origin() -> None:
    axis = ParameterSet("axis")
    with pytest.raises(UserError) as caught:
        axis.set("kenngr.measure.edge", "UP", Origin("plan.csv", 4, 7))
    assert str(caught.value).startswith("plan.csv:4:7: ")
    with pytest.raises(UserError, match=r"set:Z\.kenngr\.edge: unknown axis parameter"):
        axis.set("kenngr.edge", "POS", "set:Z.kenngr.edge")


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read"):
        read_list(tmp_path / "none.lis", "axis")
