"""A parameter in words: values in both units, ranges, warnings, who decides while it is unset."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.rig.parameter_words import (
    acts,
    chain,
    chosen,
    decided_by,
    default,
    named,
    range_of,
    unit_of,
    warning,
    with_unit,
)
from axisrig.kernel.parameters.table import Correction


def row(unit: str = "", **given: Any) -> Any:
    values = {"unit": unit, "unset": "", "allowed": "", "correction": None, "acts": "yes",
              "default": 0, "number": "", "path": "a.b"}  # fmt: skip
    return SimpleNamespace(**(values | given))


@pytest.mark.parametrize(
    ("unit", "value", "linear", "rotary"),
    [
        ("0.1 um", 12_345, "12345 x 0.1 um = 1.2345 mm", "12345 x 0.0001 deg = 1.2345 deg"),
        ("um/s", -1500, "-1500 um/s = -1.5 mm/s", "-1500 x 0.001 deg/s = -1.5 deg/s"),
        ("mm/s2", 700, "700 mm/s2", "700 deg/s2"),
        ("us", 500, "500 us = 0.5 ms", "500 us = 0.5 ms"),
        ("0.1 %", 1005, "1005 x 0.1 % = 100.5 %", "1005 x 0.1 % = 100.5 %"),
        ("0.01/s", 250, "250 x 0.01/s = 2.5 1/s", "250 x 0.01/s = 2.5 1/s"),
        ("s", 0.25, "0.25 s", "0.25 s"),
        ("", 3, "3", "3"),
        ("", True, "1", "1"),
        ("0.1 um", "", "blank", "blank"),
        ("", "LINEAR", "LINEAR", "LINEAR"),
    ],
)
def test_a_value_in_the_unit_of_the_manuals_and_of_people(
    unit: str, value: Any, linear: str, rotary: str
) -> None:
    assert with_unit(row(unit), value) == linear
    assert with_unit(row(unit), value, is_rotary=True) == rotary


@pytest.mark.parametrize(
    ("unset", "value", "text"),
    [
        ("<0", -1, "-1 x 0.1 um"),  # a mark for not set is no length
        ("<=0", -1, "-1 x 0.1 um"),
        ("<=0", 0, "0 x 0.1 um = 0 mm"),
        ("<0", 1, "1 x 0.1 um = 0.0001 mm"),
        ("=0", -1, "-1 x 0.1 um = -0.0001 mm"),
    ],
)
def test_a_mark_for_not_set_has_one_unit(unset: str, value: int, text: str) -> None:
    assert with_unit(row("0.1 um", unset=unset), value) == text


def test_units_ranges_and_defaults() -> None:
    assert (unit_of(row("um/s")), unit_of(row("um/s"), is_rotary=True)) == ("um/s", "0.001 deg/s")
    assert unit_of(row()) == ""
    assert range_of(row("um/s", allowed="0 .. 100 um/s")) == "0 .. 100"
    assert range_of(row(allowed="0, 1")) == "0, 1"
    assert [default(row(default=value)) for value in (0, "", False, 1.5)] == [
        "0",
        "blank",
        "0",
        "1.5",
    ]
    for text, words in (("yes", "yes"), ("indexed yes", "yes"), ("A second B", "A, B"), ("", "")):
        assert acts(row(acts=text)) == words


@pytest.mark.parametrize(
    ("correction", "text"),
    [
        (None, ""),
        (Correction(110001), "110001, corrected to the nearer limit"),
        (Correction(110001, is_above_only=True),
         "110001, corrected to the nearer limit when above"),
        (Correction(110001, is_kept=True), "110001, not corrected"),
        (Correction(110001, low=5), "110001, corrected to 5 or the upper limit"),
        (Correction(110001, low=0), "110001, corrected to 0 or the upper limit"),
        (Correction(110001, older_id=7),
         "110001 (7 in the older structure), corrected to the nearer limit"),
    ],
)  # fmt: skip
def test_what_becomes_of_a_value_out_of_range(correction: Correction | None, text: str) -> None:
    assert warning(row(correction=correction)) == text


def test_where_a_value_comes_from() -> None:
    origin = SimpleNamespace(short="axis-z.lst:3")
    for found, words in (
        (SimpleNamespace(origin=None, key="a.b"), "default"),
        (SimpleNamespace(origin=origin, key="a.b"), "axis-z.lst:3"),
        (SimpleNamespace(origin=origin, key="c.d"), "c.d: axis-z.lst:3"),
        (SimpleNamespace(origin=None, key="c.d"), "c.d: default"),
    ):
        assert decided_by(found, "a.b") == words  # type: ignore[arg-type]


def test_a_number_a_path_and_an_older_path_mean_one_row() -> None:
    """kp of distance control, P-AXIS-00759; a number alone where only one kind has it."""
    one = named("P-AXIS-00759")
    assert one is not None
    assert named(one.path) is one
    assert all(named(path) is one for path in one.old_paths)
    assert named("00759") is named("0759") is named("759") is one
    assert named("9759") is None
    # P-AXIS-00016 and P-CHAN-00016 are two
    assert named("00016") is named("16") is None
    of_axis, of_channel = named("P-AXIS-00016"), named("P-CHAN-00016")
    assert of_axis is not None
    assert of_channel is not None
    assert (of_axis.kind, of_channel.kind) == ("axis", "channel")
    assert named("00000") is None
    assert named("kp") is None


def test_every_word_has_to_fit() -> None:
    rows = chosen(["P-AXIS-00759"])
    assert len(rows) == 1
    assert chosen(["p-axis-00759", rows[0].topic]) == rows
    assert chosen(["P-AXIS-00759", "no such word"]) == []


SLOPES = "getriebe[i].lslope_profil"
INPUTS = (
    "antr.probing_input_nbr (P-AXIS-00430), then antr.canopen.probing_input_number (P-AXIS-00295)"
)


@pytest.mark.parametrize(
    ("number", "text"),
    [
        ("P-AXIS-00209", ""),  # nothing decides in its place
        (
            "P-AXIS-00024",
            f"0: the smallest of {SLOPES}.a_grenz_stufe_1 (P-AXIS-00005) and"
            f" {SLOPES}.a_grenz_stufe_2 (P-AXIS-00006)",
        ),
        ("P-AXIS-00532", "negative: getriebe[i].pos_einschw_zeit (P-AXIS-00151)"),
        ("P-AXIS-00518", "blank: NEG by kenngr.mess_neg_flanke (P-AXIS-00113); else POS"),
        (
            "P-AXIS-00776",
            "negative: antr.fixed_stop.detect.start_distance (P-AXIS-00771); else 0",
        ),
        (
            "P-AXIS-00583",
            "0: [0] kenngr.measure.input (P-AXIS-00517), then"
            f" {INPUTS}; [1] kenngr.measure.input_edge_banding (P-AXIS-00539), then"
            f" kenngr.measure.input (P-AXIS-00517), then {INPUTS}",
        ),
    ],
)
def test_who_decides_while_a_parameter_is_unset_link_by_link(number: str, text: str) -> None:
    """Each link once, by index where they differ, words with the switch that means them."""
    found = named(number)
    assert found is not None
    assert chain(found) == text


def test_of_several_older_switches_each_has_its_word_in_the_order_of_asking() -> None:
    found = named("P-AXIS-00516")
    assert found is not None
    first, *rest = chain(found).removeprefix("blank: ").partition("; else ")[0].split(", then ")
    assert first == "FIXED_STOP by kenngr.meas_signal_fixed_stop (P-AXIS-00330)"
    assert [link.split()[0] for link in rest] == ["PLC", "PLC", "DRIVE", "DRIVE", "DRIVE"]
    assert chain(found).endswith("; else DRIVE")
