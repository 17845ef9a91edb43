"""Zero offset and tool lists: the limits of each value, and what a refusal of a line names."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.coordinates.lists import (
    TOOLS,
    ZERO_OFFSETS,
    Form,
    forms,
    guess_list,
    read_entries,
    read_entry,
)
from axisrig.kernel.parameters import Origin

HERE = Origin("some.lst", 4, 3)
LIMITS = {"BOOL": (0, 1), "UNS16": (0, 65535), "UNS32": (0, 4294967295),
          "SGN32": (-2147483648, 2147483647)}  # fmt: skip
"""What a type holds; a list may allow less."""
LESS = {"default_index": (0, 96), "wz[i].typ": (0, 2), "wz[i].mass_einheit": (0, 1)}
ROWS = [(name, form) for name in (ZERO_OFFSETS, TOOLS) for form in forms(name).values()]
WHOLE = [(name, form) for name, form in ROWS if form.type in LIMITS]


def filled(path: str) -> str:
    return path.replace("[i]", "[1]").replace("[j]", "[0]")


def read(name: str, form: Form, text: str) -> float:
    return float(read_entry(name, filled(form.path), text, HERE).value)


@pytest.mark.parametrize(("name", "form"), WHOLE, ids=lambda each: getattr(each, "path", None))
def test_a_value_may_be_the_least_and_the_largest_and_none_beside_them(
    name: str, form: Form
) -> None:
    low, high = LESS.get(form.path, LIMITS[form.type])
    for value in (low, high):
        if form.acts in ("yes", "ignored") or value == float(form.acts):
            assert read(name, form, str(value)) == value
        else:
            with pytest.raises(UserError, match="does not act yet"):
                read(name, form, str(value))
    for value in (low - 1, high + 1, -9_999_999_999):
        with pytest.raises(UserError) as caught:
            read(name, form, str(value))
        error = caught.value
        assert error.message == f"value of {form.path} ({form.number}) is outside its range"
        assert (error.value, error.file, error.line, error.column) == (
            str(value), "some.lst", 4, 3,
        )  # fmt: skip
        if form.acts in ("yes", "ignored"):
            assert str(error.allowed) == f"{low:g} .. {high:g} {form.unit}".rstrip()


def test_every_row_has_a_type_whose_limits_are_known() -> None:
    assert {form.type for _, form in ROWS} == {*LIMITS, "REAL64"}
    assert LESS.keys() <= {form.path for _, form in ROWS}


@pytest.mark.parametrize("text", ["-1e300", "0", "-0.5", "1e300"])
def test_a_real_number_has_no_limits(text: str) -> None:
    for name, form in ROWS:
        if form.type == "REAL64" and form.acts == "ignored":
            assert read(name, form, text) == float(text)
            assert form.allowed == "any number"


@pytest.mark.parametrize(("name", "form"), ROWS, ids=lambda each: getattr(each, "path", None))
def test_what_is_no_number_of_its_type_is_refused(name: str, form: Form) -> None:
    texts = ["ten", "1,5"] if form.type == "REAL64" else ["ten", "1.5", "1,5"]
    for text in texts:
        with pytest.raises(UserError) as caught:
            read(name, form, text)
        message = f"{form.path} ({form.number}) takes a value of type {form.type}"
        assert (caught.value.message, caught.value.value) == (message, text)
        assert str(caught.value.allowed) == form.allowed


def test_what_does_not_act_takes_the_value_without_effect_alone() -> None:
    """P-TOOL-00001: 0, a milling tool; 1 turning and 2 grinding do not act."""
    form = forms(TOOLS)["wz[i].typ"]
    assert read(TOOLS, form, "0") == 0
    for text in ("1", "2"):
        with pytest.raises(UserError) as caught:
            read(TOOLS, form, text)
        error = caught.value
        assert f"wz[i].typ (P-TOOL-00001) = {text}" in error.message
        assert (str(error.allowed), error.hint) == ("0", "remove the line")


# Names


@pytest.mark.parametrize(
    ("name", "path", "hint"),
    [
        (TOOLS, "wz[1].lange", "nearest names: wz[i].laenge"),
        (TOOLS, "wz[1][0].param", "nearest names: wz[i].param[j]"),
        (ZERO_OFFSETS, "np_grp[1].achse[0].vers", "nearest names: np_grp[i].achse[j].versch"),
        (ZERO_OFFSETS, "p-zero-00002", "it is the number of `default_index`"),
        (TOOLS, "P-TOOL-00003", "it is the number of `wz[i].laenge`"),
    ],
)
def test_a_name_that_there_is_not_has_a_hint(name: str, path: str, hint: str) -> None:
    with pytest.raises(UserError) as caught:
        read_entry(name, path, "1", HERE)
    assert caught.value.message == f"unknown name in a list of {name}"
    assert caught.value.value == path
    assert hint in str(caught.value.hint)


def test_a_name_of_the_other_list_is_unknown() -> None:
    for name, path in ((TOOLS, "default_index"), (ZERO_OFFSETS, "wz[1].laenge")):
        with pytest.raises(UserError, match="unknown name"):
            read_entry(name, path, "1", HERE)


def test_an_entry_keeps_its_indices_its_value_and_its_place() -> None:
    entry = read_entry(ZERO_OFFSETS, "np_grp[2].achse [13].versch", "-70", HERE)
    assert (entry.path, entry.indices) == ("np_grp[i].achse[j].versch", (2, 13))
    assert (entry.value, entry.origin) == (-70, HERE)
    assert entry.written == "np_grp[2].achse[13].versch -70"


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("# head\n\nnp_grp[1].achse[0].versch 5", ZERO_OFFSETS), ("default_index 1", ZERO_OFFSETS),
        ("g53_verfuegbar 1", ZERO_OFFSETS), ("  wz[1].laenge 5", TOOLS), ("wz [1].laenge 5", TOOLS),
        ("kv 5\nwz[1].laenge 5", TOOLS), ("kv[0] 5", None), ("", None), ("wzx 5", None),
    ],
)  # fmt: skip
def test_a_list_is_known_by_its_names(text: str, name: str | None) -> None:
    assert guess_list(text) == name


# Lines of a file


def places(tmp_path, name, text):
    path = tmp_path / "some.lst"
    path.write_text(text, encoding="utf-8")
    return [(each.written, origin.line, origin.column) for each, origin in read_entries(name, path)]


def test_each_value_has_the_place_of_its_name(tmp_path):
    text = "# head\n\n  wz[1].laenge 5 ; mm\nwz[2].laenge 6 (long)\n\twz[2].radius 7"
    assert places(tmp_path, TOOLS, text) == [
        ("wz[1].laenge 5", 3, 3), ("wz[2].laenge 6", 4, 1), ("wz[2].radius 7", 5, 2),
    ]  # fmt: skip


def test_a_byte_order_mark_is_no_part_of_the_first_name(tmp_path):
    assert places(tmp_path, TOOLS, "\ufeffwz[1].laenge 5") == [("wz[1].laenge 5", 1, 1)]


@pytest.mark.parametrize(
    ("line", "column", "message", "value", "hint"),
    [
        ("  wz[1].laenge", 3, "no value after the name", "wz[1].laenge", None),
        ("wz[1].lang", 1, "no value after the name", "wz[1].lang", None),
        ("wz[1].laenge 5 mm", 16, "more than one value after the name", "mm", "counts in 0.1 um"),
        ("wz[1].laenge 15 1", 17, "more than one value after the name", "1", None),
        ("wz[1].laenge 5  6 7", 17, "more than one value after the name", "6 7", None),
        (" wz[1].laenge = 5", 2, "no `=`", "wz[1].laenge = 5", "write `wz[1].laenge 5`"),
        ("wz[1].laenge=5", 1, "no `=`", "wz[1].laenge=5", "write `wz[1].laenge 5`"),
    ],
)
def test_a_wrong_line_names_its_place_and_what_to_write(
    tmp_path, line, column, message, value, hint
):
    with pytest.raises(UserError) as caught:
        places(tmp_path, TOOLS, f"wz[3].laenge 1\n{line}\n")
    error = caught.value
    assert message in error.message
    assert (error.line, error.column, error.value) == (2, column, value)
    assert (hint or "") in str(error.hint)


def test_a_name_is_twice_only_with_the_same_indices(tmp_path):
    text = "wz[1].ax_versatz[0] 1\nwz[1].ax_versatz[1] 2\nwz[2].ax_versatz[0] 3\n"
    assert len(places(tmp_path, TOOLS, text)) == 3
    with pytest.raises(UserError, match="it is in line 2 already") as caught:
        places(tmp_path, TOOLS, f"{text}wz[1].ax_versatz [1] 2\n")
    assert (caught.value.line, caught.value.value) == (4, "wz[1].ax_versatz [1]")


@pytest.mark.parametrize(
    ("name", "path", "allowed"),
    [
        (ZERO_OFFSETS, "np_grp[96].achse[31].versch", None),
        (ZERO_OFFSETS, "np_grp[97].achse[0].versch", "0 .. 96"),
        (ZERO_OFFSETS, "np_grp[1].achse[32].versch", "0 .. 31"),
        (ZERO_OFFSETS, "np_grp[1].achse[32].inaktiv", "0 .. 31"),
        (TOOLS, "wz[200].param[69]", None),
        (TOOLS, "wz[201].param[0]", "0 .. 200"), (TOOLS, "wz[3].param[70]", "0 .. 69"),
        (TOOLS, "wz[201].param[70]", "0 .. 200"),
    ],
)  # fmt: skip
def test_each_index_has_its_own_last_one(name: str, path: str, allowed: str | None) -> None:
    """97 groups of 32 axes, 201 tools of 70 parameters."""
    if allowed is None:
        assert read_entry(name, path, "1", HERE).written == f"{path} {1.0 if 'wz' in path else 1}"
        return
    with pytest.raises(UserError, match="index too large") as caught:
        read_entry(name, path, "1", HERE)
    assert (caught.value.value, caught.value.allowed) == (path, allowed)
