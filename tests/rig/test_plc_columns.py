"""What a cell of `plc:` may hold, and how a wrong one is refused."""

from pathlib import Path

import pytest

from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.rig.plc.channel_words import Feedhold
from axisrig.bench.rig.plc.words import (
    Moment,
    ObjectWrite,
    Rule,
    VariableWrite,
    plc_moments,
    plc_objects,
    read_rules,
)
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.drives.functions import type_range
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

ROOT = Path(__file__).parents[2]
RIG = ROOT / "testplans" / "rigs" / "drive-functions.toml"
PLC_PAGE = ROOT / "docs" / "plc.md"


def rules(text: str) -> list[Rule]:
    return read_rules(parse_assignment(text), ["Z"])[1]


def settings(*assignments: str) -> Settings:
    table, files = read_rig(RIG)
    return read_settings(table, files, [(parse_assignment(a), as_written) for a in assignments])


def test_a_value_for_a_drive_with_its_moments() -> None:
    written, restored = rules("plc:Z.torque_limit=100 at=M50; 5000 at=V.E.Limit=0+1.5ms nth=2")
    limit = plc_objects()["torque_limit"]
    assert (limit.index, limit.type) == (0x6072, "UNS16")
    assert written.action == ObjectWrite("Z", limit, 100)
    assert (written.moment, written.nth) == (Moment("M50"), None)
    assert restored.moment == Moment("V.E.LIMIT", 0.0, 1500 * US)
    assert (restored.action, restored.nth) == (ObjectWrite("Z", limit, 5000), 2)


@pytest.mark.parametrize("name", ["lag_window", "6065", "0x6065", "0x6065:0"])
def test_an_object_by_name_or_number_and_off_in_hexadecimal(name: str) -> None:
    (rule,) = rules(f"plc:Z.{name}=0xFFFFFFFF")
    assert rule.action == ObjectWrite("Z", plc_objects()["lag_window"], 4294967295)
    assert rule.moment == Moment("start")


@pytest.mark.parametrize("name", list(plc_objects()))
def test_an_object_takes_each_value_of_its_type_from_the_lowest_on(name: str) -> None:
    """CiA 301: UNS16 is 0 to 65535, UNS32 0 to 4294967295, signed ones have both halves."""
    target = plc_objects()[name]
    bits, is_signed = int(target.type[-2:]), target.type.startswith("SGN")
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if is_signed else (0, (1 << bits) - 1)
    for value in (low, low + 1, high - 1, high):
        for text in (str(value), hex(value)):
            (rule,) = rules(f"plc:Z.{name}={text}")
            assert rule.action == ObjectWrite("Z", target, value)
    for text in (str(low - 1), str(high + 1), "1.0", "1_0", "ten", "\u0661"):
        with pytest.raises(UserError, match=f"{name}: not a value of it") as caught:
            rules(f"plc:Z.{name}={text}")
        assert f"a whole number from {low} to {high}" in str(caught.value)
        assert caught.value.value == text


def test_feedholds_and_variables() -> None:
    first, second = rules("plc:feedhold=at=400ms for=0.3s; for=20ms at=motion+1ms nth=3")
    assert (first.moment, first.action) == (Moment("start", None, 400 * MS), Feedhold(300 * MS))
    assert (second.moment.word, second.nth) == ("motion", 3)
    value, (later,) = read_rules(parse_assignment("plc:V.E.GO=-1.5; 1 at=run_end+20ms"), [])
    assert value == -1.5
    assert later.action == VariableWrite("GO", 1.0)
    assert later.moment == Moment("run_end", None, 20 * MS)


def test_the_last_of_two_assignments_of_one_column_counts() -> None:
    both = settings("plc:Z.torque_limit=100 at=M50; 5000 at=M51", "plc:Z.torque_limit=200")
    assert [rule.text for rule in both.plc] == ["200"]


@pytest.mark.parametrize(
    ("text", "found", "allowed"),
    [
        ("plc:Z.torque_limt=100", "torque_limt", "torque_limit"),
        ("plc:Z.6041=100", "6041", "torque_limit (6072)"),
        ("plc:Q.torque_limit=100", "'Q'", "allowed: Z"),
        ("plc:fedhold=for=1s", "fedhold", "feedhold"),
        ("plc:Z.torque_limit=70000", "70000", "0 to 65535, per mille of the rated torque 6076"),
        ("plc:Z.torque_limit=-1", "-1", "0 to 65535"),
        ("plc:Z.torque_limit=10.5", "10.5", "a whole number"),
        ("plc:Z.lag_window=4294967296", "4294967296", "0 to 4294967295"),
        ("plc:Z.torque_limit=at=M50", "at=M50", "100 at=M50"),
        ("plc:Z.torque_limit=100 200", "100 200", "100 at=M50"),
        ("plc:Z.torque_limit=100 at=M50;", "100 at=M50;", ""),
        ("plc:Z.torque_limit=100 at=M50 at=M51", "twice", ""),
        ("plc:Z.torque_limit=100 for=3ms", "'for'", "at, nth"),
        ("plc:Z.torque_limit=100 at=200", "'200'", "(400ms)"),
        ("plc:Z.torque_limit=100 at=M50+3", "M50+3", "M50+20ms"),
        ("plc:Z.torque_limit=100 at=run+3min", "run+3min", "M50+20ms"),
        ("plc:Z.torque_limit=100 at=", "''", "run_end"),
        ("plc:Z.torque_limit=100 at=M30", "M30", "M and H from 0 to 999"),
        ("plc:Z.torque_limit=100 at=H1000", "H1000", "M and H from 0 to 999"),
        ("plc:Z.torque_limit=100 at=V.E.", "V.E.", "V.E.<name>"),
        ("plc:Z.torque_limit=100 at=V.E.GO=x", "'x'", ""),
        ("plc:Z.torque_limit=100 at=V.E.GO", "V.E.GO", "plc:V.E.GO=0"),
        ("plc:Z.torque_limit=100 at=M50; 200 at=V.E.GO", "V.E.GO", "plc:V.E.GO=0"),
        ("plc:feedhold=at=V.E.GO for=1s", "V.E.GO", "plc:V.E.GO=0"),
        ("plc:feedhold=at=M50 until=V.E.GO", "V.E.GO", "plc:V.E.GO=0"),
        ("plc:feedhold=at=M50 for=1s; at=M51 until=V.E.GO=1", "V.E.GO", "plc:V.E.GO=0"),
        ("plc:Z.torque_limit=100 at=M1000", "M1000", "M and H from 0 to 999"),
        ("plc:Z.torque_limit=100 nth=2", "'2'", "1: it comes once"),
        ("plc:Z.torque_limit=100 at=M50 nth=0", "'0'", "1 to 999"),
        ("plc:feedhold=at=50ms", "how long", "for=300ms"),
        ("plc:feedhold=at=50ms for=0ms", "0ms", "for=300ms"),
        ("plc:feedhold=for=1h", "1h", "for=300ms"),
        ("plc:feedhold=1 for=1s", "'1'", "at=400ms for=300ms"),
        ("plc:V.E.GO=1 at=M50", "first value", "0; 1 at=M50+20ms"),
        ("plc:V.E.GO=1; 2", "moment", "1 at=M50+20ms"),
        ("plc:V.E.GO=1; x at=M50", "'x'", ""),
    ],
)
def test_a_cell_that_cannot_be_is_told_with_what_is_allowed(
    text: str, found: str, allowed: str
) -> None:
    with pytest.raises(UserError) as caught:
        settings(text)
    said = str(caught.value)
    assert said.startswith(f"--set {text}: ")
    assert found in said
    assert allowed in said


def test_a_moment_of_a_variable_that_the_run_has_is_taken_whatever_its_letters() -> None:
    found = settings(
        "plc:V.E.Go=0; 1 at=M50", "plc:feedhold=at=M51 until=V.E.GO=1", "plc:override=5 at=V.E.go"
    ).plc
    moments = [(rule.moment.word, rule.until and rule.until.word) for rule in found]
    assert moments == [("M50", None), ("M51", "V.E.GO"), ("V.E.GO", None)]


@pytest.mark.parametrize("word", ["M6", "M999", "H0", "H999", "T0", "T999", "T1000", "T123456789"])
def test_a_tool_has_any_number_and_other_functions_have_three_digits(word: str) -> None:
    (rule,) = rules(f"plc:Z.torque_limit=100 at={word}+5ms")
    assert rule.moment == Moment(word, None, 5 * MS)


def test_a_cell_of_a_plan_is_told_with_line_and_column(tmp_path: Path) -> None:
    program = tmp_path / "end.nc"
    program.write_text("M30\n", encoding="utf-8")
    plan = tmp_path / "plan.csv"
    plan.write_text(
        f"case,program,rig,plc:Z.torque_limit\na,end.nc,{RIG},100\nb,end.nc,{RIG},100 at=M5O\n",
        encoding="utf-8",
    )
    good, bad = read_plan(plan).cases
    assert len(settings_of(good).plc) == 1
    with pytest.raises(UserError) as caught:
        settings_of(bad)
    said = str(caught.value)
    assert "plan.csv:3:4: " in said
    assert "plc:Z.torque_limit" in said
    assert "M5O" in said


def test_objects_have_types_and_the_page_lists_all_of_them_and_every_moment() -> None:
    page = PLC_PAGE.read_text(encoding="utf-8")
    for known in plc_objects().values():
        assert type_range(known.type)[0] == 0
        assert f"| `{known.name}` | {known.index:04X} | {known.unit} |" in page
    for moment in plc_moments():
        assert f"| `{moment}` |" in page


def test_a_column_that_is_assigned_again_replaces_what_it_did() -> None:
    """`--set` acts on top of a table; other columns stay."""
    found = settings(
        "plc:Z.torque_limit=100 at=M50; 200 at=M51",
        "plc:feedhold=at=400ms for=300ms",
        "plc:Z.torque_limit=300 at=M52",
    ).plc
    assert [(rule.column, rule.moment.word) for rule in found] == [
        ("plc:feedhold", "start"),
        ("plc:Z.torque_limit", "M52"),
    ]


@pytest.mark.parametrize(
    ("moment", "fits"),
    [
        (Moment("V.E.READY"), (True, True, True, False)),
        (Moment("V.E.READY", 2.0), (False, True, False, False)),
        (Moment("V.E.READY", 0.0), (True, False, False, False)),
        (Moment("M50"), (False, False, False, True)),
    ],
)
def test_a_moment_of_a_variable_is_that_of_its_value_where_it_names_one(
    moment: Moment, fits: tuple[bool, ...]
) -> None:
    seen = (("V.E.READY", 0.0), ("V.E.READY", 2.0), ("V.E.READY", 3.0), ("M50", None))
    assert tuple(moment.fits(word, value) for word, value in seen) == fits
