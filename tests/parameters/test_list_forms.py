"""The format of parameter lists: comments, quotes, several axes, older names, damaged names."""

import string
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import (
    KINDS,
    Kind,
    Origin,
    Parameter,
    ParameterSet,
    Value,
    list_text,
    read_list,
    read_sections,
    start_up,
    table,
    write_list,
    written,
)
from axisrig.kernel.parameters.errata import errata, meant

Listed = Callable[..., ParameterSet]
Sections = Callable[..., list[ParameterSet]]
Refused = Callable[..., UserError]


@pytest.mark.parametrize(
    "line",
    [
        "kenngr.messachse 1",
        "\tkenngr.messachse\t1\t",
        "kenngr.messachse 1# comment",
        "kenngr.messachse 1 ; comment # more",
        "kenngr.messachse 1 ( P-AXIS-00118 )",
        "kenngr.messachse 0x1",
        "kenngr.messachse TRUE",
        '   kenngr.messachse "1"   # quoted',
    ],
)
def test_one_line_in_many_forms(listed: Listed, line: str) -> None:
    assert listed(f"{line}\r\n").flag("kenngr.messachse") is True


@pytest.mark.parametrize(
    ("text", "value"),
    [('"MON WINDOW"', "MON WINDOW"), ("'a # b'", "a # b"), ('""', ""), ('"x;(y)"', "x;(y)"),
     ("'say \"it\"'", 'say "it"')],
)  # fmt: skip
def test_texts_in_quotes_keep_blanks_and_signs(
    listed: Listed, tmp_path: Path, text: str, value: str
) -> None:
    axis = listed(f"antr.function[3].id {text} # comment\n")
    assert axis.word("antr.function[3].id") == value
    write_list(axis, tmp_path / "out.lst")
    assert read_list(tmp_path / "out.lst", "axis").word("antr.function[3].id") == value


def test_each_axis_of_a_list_begins_with_its_number(sections: Sections) -> None:
    parts = sections(
        "kopf.achs_nr 1\nkopf.log_achs_name X\nkenngr.messachse 1\n"
        "kopf.achs_nr 2\nkopf.log_achs_name Y\n"
    )
    assert [part.word("kopf.log_achs_name") for part in parts] == ["X", "Y"]
    assert [part.flag("kenngr.messachse") for part in parts] == [True, False]


def test_one_axis_out_of_a_list_of_several(tmp_path: Path) -> None:
    path = tmp_path / "axes.lst"
    path.write_text("kopf.achs_nr 1\nkopf.log_achs_name X\nkopf.achs_nr 4\nkopf.log_achs_name Z\n")
    assert read_list(path, "axis", "Z").integer("kopf.achs_nr") == 4
    with pytest.raises(UserError, match=r"none of them is Y.*allowed: X, Z"):
        read_list(path, "axis", "Y")
    with pytest.raises(UserError, match="several axes"):
        read_list(path, "axis")


def test_a_name_twice_in_one_axis_is_told_with_the_way_to_the_next(refused: Refused) -> None:
    error = refused("kopf.achs_nr 1\nkenngr.messachse 1\nkopf.achs_nr 2\n"
                    "kenngr.messachse 1\nkenngr.messachse 1\n")  # fmt: skip
    assert error.line == 5
    assert "line 4" in error.message
    assert "kopf.achs_nr begins the next axis" in str(error.hint)


def test_what_is_before_the_first_number_of_an_axis_belongs_to_it(tmp_path: Path) -> None:
    """The number of an axis begins the next one only where there has been one already."""
    path = tmp_path / "axes.lst"
    first = "kenngr.messachse 1\nkopf.log_achs_name X\nkopf.achs_nr 3\n"
    path.write_text(first, encoding="utf-8")
    (only,) = read_sections(path, "axis")
    assert (only.integer("kopf.achs_nr"), only.flag("kenngr.messachse")) == (3, True)
    path.write_text(f"{first}kopf.achs_nr 4\nkopf.log_achs_name Y\n", encoding="utf-8")
    found = [
        (
            each.integer("kopf.achs_nr"),
            each.word("kopf.log_achs_name"),
            each.flag("kenngr.messachse"),
        )
        for each in read_sections(path, "axis")
    ]
    assert found == [(3, "X", True), (4, "Y", False)]


@pytest.mark.parametrize(
    ("older", "present"),
    [
        ("kenngr.distc.kp", "kenngr.dist_ctrl[0].kp"),
        ("kenngr.distc.max_abweichung", "kenngr.dist_ctrl[0].max_deviation"),
        ("kenngr.dist_ctrl[0].max_istw_sprung", "kenngr.dist_ctrl[0].max_act_value_change"),
        ("kenngr.distc.toleranz", "kenngr.dist_ctrl[0].tolerance"),
    ],
)
def test_older_and_german_names_are_the_same_parameter(
    listed: Listed, refused: Refused, older: str, present: str
) -> None:
    assert [name for name, _ in listed(f"{older} 2\n").items()] == [present]
    assert "line 1" in refused(f"{present} 1\n{older} 2\n").message


@pytest.mark.parametrize(
    ("path", "allowed"),
    [
        ("kenngr.dist_ctrl[1].kp", "index 0 .. 0"),
        ("kenngr.measure.probe[2].input", "index 0 .. 1"),
        ("antr.function[10].id", "index 0 .. 9"),
        ("antr.function[0].wr_ident[2]", "index 0 .. 9, 0 .. 1"),
    ],
)
def test_an_index_that_does_not_exist(refused: Refused, path: str, allowed: str) -> None:
    error = refused(f"{path} 1\n")
    assert "no such index" in error.message
    assert error.allowed == allowed


def test_a_parameter_of_another_list_is_recognised(refused: Refused) -> None:
    assert "the channel" in str(refused("messtyp 1\n").hint)
    assert "list of external variables" in str(refused("var[0].name A\n", "channel").hint)
    assert "start-up" in str(refused("configuration.channel[0].decoder.function -\n").hint)


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ("kopf.achs nr 4", "it means kopf.achs_nr 4"),
        ("kenngr.hub_messtaster2000", "it means kenngr.hub_messtaster 2000"),
        ("kenngr.hub\\_messtaster 7", "it means kenngr.hub_messtaster 7"),
        ("kenngr.DIST<sup>-</sup>CTRL[0].kp 1", "it means kenngr.dist_ctrl[0].kp 1"),
        ("Kenngr.Messachse 1", "it means kenngr.messachse 1"),
        ("antr.function[4].wr ident[0] 6065 00", "it means antr.function[4].wr_ident[0] 6065_00"),
        ("kenngr.distc.n cycles 30 # comment", "it means kenngr.distc.n_cycles 30"),
    ],
)
def test_a_damaged_name_is_refused_with_what_is_meant(
    refused: Refused, listed: Listed, line: str, hint: str
) -> None:
    error = refused(f"\n{line}\n")
    assert error.message == "damaged parameter name"
    assert (error.line, error.hint) == (2, hint)
    listed(hint.removeprefix("it means ") + "\n")  # and that is accepted


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ("antr.function[0].id MON WINDOW", "MON_WINDOW, or the text in quotes"),
        ("antr.function[0].mask NOT USED", "NOT_USED, or the text in quotes"),
        ("kenngr.measure.signal PLC TIMESTAMP", "it means PLC_TIMESTAMP"),
        ("kenngr.messachse 1 0", None),
    ],
)
def test_a_value_in_several_words(refused: Refused, line: str, hint: str | None) -> None:
    error = refused(f"{line}\n")
    assert "more than one value" in error.message
    assert error.hint == hint


def test_of_misprints_that_begin_alike_the_longest_one_is_mended() -> None:
    """The rows of the table in the order in which they are looked for."""
    lengths = [len(printed) for printed, _, _ in errata()]
    assert len(lengths) > 2
    assert lengths == sorted(lengths, reverse=True)


def test_errata_leave_undamaged_lists_alone() -> None:
    text = "kopf.achs_nr 1\nkenngr.messachse 1\n"
    assert meant(text) == text


# --- every parameter, every text ---------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_every_parameter_is_written_and_read_back(tmp_path: Path, kind: Kind) -> None:
    whole = ParameterSet(kind)
    for row in table(kind).parameters:
        path = row.path.replace("[i]", "[0]")
        value = row.values[-1] if row.values else written(row.default) or "word"
        whole.load(path, value, Origin("here", 1))
    write_list(whole, tmp_path / "all.lst")
    again = read_sections(tmp_path / "all.lst", kind)
    assert [list(part.items()) for part in again] == [list(whole.items())]
    assert len(list(whole.items())) == len(table(kind).parameters)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_every_axis_of_a_list_is_written_with_its_number_first(tmp_path: Path, count: int) -> None:
    """The number may have been set last, or never; words are quoted where they have to be."""
    words = ["Z", "a b", "X#1", "it's", 'say "Z"', ""]
    parts = []
    for number in range(count):
        part = ParameterSet("axis")
        part.load("kopf.log_achs_name", words[number], Origin("here", 1))
        part.load("antr.function[0].id", words[-1 - number], Origin("here", 2))
        if number != 1:
            part.load("kopf.achs_nr", str(number + 4), Origin("here", 3))
        parts.append(part)
    path = tmp_path / "axes.lst"
    write_list(parts, path)
    again = read_sections(path, "axis")
    assert [part.integer("kopf.achs_nr") for part in again] == [
        part.integer("kopf.achs_nr") for part in parts
    ]
    for name in ("kopf.log_achs_name", "antr.function[0].id"):
        assert [part.word(name) for part in again] == [part.word(name) for part in parts]


NAMES = [name for kind in KINDS for name in table(kind).paths()]
words = st.one_of(
    st.sampled_from(NAMES),
    st.sampled_from(["kopf.achs_nr", "kenngr.distc.kp", "1", "-1", "0x", "DRIVE", '"', "'a b'"]),
    st.integers().map(str),
    st.floats().map(str),
    st.text(alphabet=string.printable + "äµ€\0\u2028", max_size=12),
)
lists = st.lists(st.lists(words, max_size=4).map(" ".join), max_size=8).map("\n".join)


@given(text=lists, kind=st.sampled_from(KINDS))
@example(text="kopf.achs_nr " + "9" * 10_000, kind="axis")
@example(text="kenngr.distc.kp 1e999", kind="axis")
@example(text="(" * 5000, kind="axis")
@example(text="kopf.achs nr " * 400, kind="axis")
@example(text='a "', kind="axis")
@settings(
    max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@pytest.mark.long
def test_no_text_ends_in_anything_but_a_list_or_a_user_error(
    tmp_path: Path, text: str, kind: Kind
) -> None:
    path = tmp_path / "any.lst"
    path.write_text(text, encoding="utf-8", newline="")
    try:
        parts = read_sections(path, kind)
        for part in parts:
            start_up(part, "Z")
    except UserError:
        return
    write_list(parts, path)
    again = read_sections(path, kind)
    assert [list(part.items()) for part in again] == [list(part.items()) for part in parts]


def test_a_list_of_an_editor_that_marks_utf_8_begins_with_its_first_name(tmp_path: Path) -> None:
    path = tmp_path / "axis.lst"
    path.write_bytes(b"\xef\xbb\xbfkopf.achs_nr 3\r\nkopf.log_achs_name Z\r\n")
    assert read_list(path, "axis").integer("kopf.achs_nr") == 3


@pytest.mark.parametrize("text", ["0x1F", "0X1F", "0X1f", "31", "+31"])
def test_whole_numbers_may_be_hexadecimal(listed: Listed, text: str) -> None:
    assert listed(f"kopf.achs_nr {text}\n").integer("kopf.achs_nr") == 31


HERE = Origin("here", 1)


def parameter_of(type_name: str) -> Parameter:
    return next(row for kind in KINDS for row in table(kind).parameters if row.type == type_name)


@pytest.mark.parametrize(
    ("text", "type_name", "value"),
    [
        ("TRUE", "BOOL", True), ("true", "BOOL", True), ("False", "BOOL", False),
        ("1", "BOOL", True), ("0", "BOOL", False), ("0x1", "BOOL", True),
        ("-7", "SGN16", -7), ("0xff", "UNS08", 255), ("-0.5", "REAL64", -0.5), ("7", "REAL64", 7.0),
        ("true", "STRING", "true"), ("0x1", "STRING", "0x1"), ("1_0", "STRING", "1_0"),
        ("true", "UNS08", None), ("1.0", "SGN32", None), ("", "UNS08", None),
        ("1_0", "UNS32", None), ("1_0", "REAL64", None), ("inf", "REAL64", None),
        ("9" * 401, "UNS32", None),
    ],
)  # fmt: skip
def test_a_text_is_a_value_of_its_type(text: str, type_name: str, value: Value | None) -> None:
    """None: it is none, whatever the range; lists of external variables write TRUE and FALSE."""
    if value is None:
        with pytest.raises(UserError, match="takes a value of type"):
            parameter_of(type_name).convert(text, HERE)
        return
    found = parameter_of(type_name).convert(text, HERE)
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize("text", ["inf", "-inf", "nan", "1e400", "0x10", "1_0"])
def test_what_is_no_finite_number_is_refused(refused: Refused, text: str) -> None:
    error = refused(f"kenngr.dist_ctrl[0].kp {text}\n")
    assert (error.value, error.line) == (text, 1)


@pytest.mark.parametrize(
    ("name", "written"),
    [
        ("kenngr.distc.kp", "kenngr.distc."),
        ("kenngr.dist_ctrl[0].kp", "kenngr.dist_ctrl[0]."),
    ],
)
def test_a_list_that_is_written_again_keeps_the_structure_of_distance_control(
    listed: Listed, name: str, written: str
) -> None:
    """The structure chooses the family of IDs, 703xx or 3100xx."""
    again = listed(list_text(listed(f"{name} 0.5\n")))
    assert again.get("kenngr.dist_ctrl[0].kp") == 0.5
    assert again.is_written_as(written)


@pytest.mark.parametrize(
    ("kind", "older", "present"),
    [
        ("channel", "trafo[1].id", "kin_step[0].trafo[1].id"),
        ("channel", "trafo[0].param[3]", "kin_step[0].trafo[0].param[3]"),
        ("external", "anzahl_belegt", "number_used_variables"),
        ("axis", "kenngr.dist_ctrl[0].toleranz", "kenngr.dist_ctrl[0].tolerance"),
    ],
)
def test_any_other_older_name_is_written_again_as_the_present_one(
    kind: Kind, older: str, present: str
) -> None:
    found = ParameterSet(kind)
    found.load(older, "9", Origin("a.lst", 3, 1))
    (line,) = list_text(found).splitlines()[1:]
    name, value = line.split()[:2]
    assert (name, float(value)) == (present, 9.0)
