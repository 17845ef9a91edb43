"""`axisrig params`: every column of the list and of the CSV table, and what is near a wrong name.

Numbers: TF5200 axis and channel parameters, at the place that `source` names.
"""

import csv
import io

import pytest

from axisrig.bench.tools.params.listing import COLUMNS, parameters_text
from axisrig.kernel.errors import UserError


def row_of(number: str) -> dict[str, str]:
    """The row of the CSV table, as any reader of CSV has it."""
    rows = csv.DictReader(io.StringIO(parameters_text([number], "csv")))
    (row,) = (row for row in rows if row["number"] == number)
    return row


@pytest.mark.parametrize(
    ("number", "cells"),
    [
        (
            "P-AXIS-00414",
            {"kind": "axis", "topic": "distance_axis", "path": "kenngr.dist_ctrl[i].max_deviation",
             "older_names": "kenngr.distc.max_deviation kenngr.dist_ctrl[i].max_abweichung"
             " kenngr.distc.max_abweichung",
             "type": "SGN32", "unit": "0.1 um", "rotary_unit": "0.0001 deg",
             "range": "0 .. 2147483647", "default": "50000", "while_unset": "", "warning": "",
             "acts": "yes", "source": "TF5200 axis parameters 117800075"},
        ),
        (
            "P-AXIS-00280",
            {"kind": "axis", "topic": "dynamics", "unit": "mm/s2", "rotary_unit": "deg/s2",
             "older_names": "", "range": "0 .. 100000000", "default": "0", "warning": "",
             "while_unset": "0: getriebe[i].lslope_profil.a_grenz_stufe_1 (P-AXIS-00005)"},
        ),
        (
            "P-AXIS-00415",
            {"unit": "um/s", "rotary_unit": "0.001 deg/s", "range": "1 .. 2147483647",
             "default": "5000", "while_unset": "", "meaning": "Largest speed of the offset",
             "warning": "315000 (110604 in the older structure), corrected to the nearer limit"},
        ),
        (
            "P-CHAN-00821",
            {"kind": "channel", "topic": "distance_channel", "path": "dist_ctrl[i].kp",
             "type": "REAL64", "unit": "", "rotary_unit": "", "range": "above 0.0, up to 2.0",
             "default": "1.0", "warning": "315010, corrected to 0.001 or the upper limit"},
        ),
        ("P-AXIS-00129", {"acts": "no"}),
    ],
)  # fmt: skip
def test_a_row_of_the_csv_table_has_each_column(number: str, cells: dict[str, str]) -> None:
    row = row_of(number)
    assert tuple(row) == COLUMNS
    assert row["number"] == number
    assert {name: row[name] for name in cells} == cells


def test_one_parameter_is_explained_in_text_alone() -> None:
    """As a table it is a row below the head, as a page it has its topic."""
    text = parameters_text(["P-AXIS-00774"], "csv")
    assert len(text.splitlines()) == 2
    assert text == text.rstrip()
    page = parameters_text(["P-AXIS-00774"], "markdown")
    assert page.startswith("# Parameters\n")
    assert page.count("P-AXIS-00774 |") == 1


def cells(words: list[str]) -> list[list[str]]:
    """The lines of the list below its head, by the columns that the head has."""
    head, *lines = parameters_text(words, "text").splitlines()
    names = ("number", "path", "type, unit", "default", "acts")
    places = [head.index(name) for name in names]
    ends = [*places[1:], None]
    return [
        [line[begin:end].strip() for begin, end in zip(places, ends, strict=True)] for line in lines
    ]


def test_the_list_has_number_path_type_unit_default_and_whether_it_acts() -> None:
    assert cells(["P-AXIS-00414", "offset"]) == [
        ["P-AXIS-00414", "kenngr.dist_ctrl[i].max_deviation", "SGN32 0.1 um", "50000", "yes"]
    ]
    # Most paths are shorter than their column; what has no number has a sign in its place
    assert ["-", "kopf.log_achs_name", "STRING", "blank", "yes"] in cells(["kopf"])
    assert cells(["kenngr.vorz_richtung", "axis"])[0][:3] == ["-", "kenngr.vorz_richtung", "UNS16"]
    assert cells(["P-AXIS-00129", "axis"])[0][-1] == "no"
    assert cells(["P-AXIS-00020", "axis"])[0][-1] == "2, 3, 8"  # these values alone


@pytest.mark.parametrize(
    ("number", "line"),
    [
        ("P-AXIS-00008", "  type         UNS32 mm/s2 (rotary axis: deg/s2)"),
        ("P-AXIS-00414", "  type         SGN32 0.1 um (rotary axis: 0.0001 deg); 10000 are 1 mm"),
        ("P-AXIS-00415", "  type         SGN32 um/s (rotary axis: 0.001 deg/s); 1000 are 1 mm/s"),
        ("P-CHAN-00821", "  type         REAL64"),
        ("P-AXIS-00020", "  type         UNS16"),
    ],
)
def test_a_unit_is_explained_with_the_one_of_a_rotary_axis_and_its_scale(
    number: str, line: str
) -> None:
    """A scale only where the unit is a part of one that the kernel computes with."""
    assert line in parameters_text([number], "text").splitlines()


@pytest.mark.parametrize(
    ("wrong", "near"),
    [
        (["P-AXIS-0041x"], "P-AXIS-0041"),
        (["kenngr.distc.max_devation"], "kenngr.distc.max_deviation"),  # an older name
        (["kenngr.dist_ctrl[i].max_devation"], "kenngr.dist_ctrl[i].max_deviation"),
        (["kenngr.measure", "nowhere"], "kenngr.measure"),
    ],
)
def test_a_name_that_fits_nothing_has_near_ones(wrong: list[str], near: str) -> None:
    for form in ("text", "csv", "markdown"):
        with pytest.raises(UserError, match="no parameter fits") as caught:
            parameters_text(wrong, form)
        assert caught.value.value == " ".join(wrong)
        assert near in str(caught.value.allowed)
