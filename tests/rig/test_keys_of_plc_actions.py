"""Which keys and moments an action of the PLC side has: those of its column, and no others."""

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.plc.axis_words import axis_columns
from axisrig.bench.rig.plc.channel_words import channel_columns
from axisrig.bench.rig.plc.words import Moment, Rule, needs_variables, plc_objects, read_rules
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

GIVEN = {"at": "M50", "nth": "2", "over": "10ms", "for": "10ms", "until": "M51",
         "file": "b.nc", "set_pos": "30", "set_dist": "1"}  # fmt: skip


def rules(text: str) -> list[Rule]:
    return read_rules(parse_assignment(text), ["Z"])[1]


def columns() -> list[tuple[str, tuple[str, ...]]]:
    """Each column with the keys that its table has; of objects and variables docs/plc.md."""
    known = [(name, row.keys) for name, row in channel_columns().items()]
    known += [(f"Z.{name}", row.keys) for name, row in axis_columns().items() if "<" not in name]
    known += [(f"Z.{name}", ("at", "nth")) for name in plc_objects()]
    return [*known, ("V.E.GO", ("at", "nth"))]


@pytest.mark.parametrize(("column", "keys"), columns())
def test_a_key_of_another_column_is_refused(column: str, keys: tuple[str, ...]) -> None:
    """It would do nothing: an object moves at once, a reset does not last."""
    head = "0; 1" if column == "V.E.GO" else "1"
    others = [key for key in GIVEN if key not in keys]
    assert others
    for key in (*others, "off"):
        with pytest.raises(UserError, match="has no such key") as caught:
            rules(f"plc:{column}={head} {key}={GIVEN.get(key, '1')}")
        assert (caught.value.value, str(caught.value.allowed)) == (key, ", ".join(keys))


@pytest.mark.parametrize(
    "cell",
    ["; {}", "{};", "{}; ", "{}; ; {}", "{};;{}", ";"],
)
@pytest.mark.parametrize(
    ("column", "action"),
    [
        ("Z.torque_limit", "100 at=M50"),
        ("feedhold", "at=M50 for=1s"),
        ("reset", "at=M50"),
        ("override", "50 at=M50"),
        ("Z.dist_ctrl", "ON at=M50"),
        ("V.E.GO", "0"),
    ],
)
def test_an_action_is_missing_wherever_two_semicolons_have_nothing_between(
    column: str, action: str, cell: str
) -> None:
    text = cell.replace("{}", action)
    with pytest.raises(UserError, match="an action is missing between the semicolons") as caught:
        rules(f"plc:{column}={text}")
    assert str(caught.value.value).strip() == text.strip()


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("m50", "M50"), ("M50", "M50"), ("h7", "H7"), ("t12", "T12"), ("t1000", "T1000"),
        ("M050", "M50"), ("v.e.go", "V.E.GO"),
    ],
)  # fmt: skip
@pytest.mark.parametrize(("after", "offset_ns"), [("", 0), ("+20ms", 20 * MS), ("+1ns", 1)])
def test_a_moment_is_the_function_whatever_its_letters_and_its_zeros(
    text: str, word: str, after: str, offset_ns: int
) -> None:
    """The program has it as M50, and a time after it counts from there."""
    (at,) = rules(f"plc:Z.torque_limit=100 at={text}{after}")
    assert at.moment == Moment(word, None, offset_ns)
    (until,) = rules(f"plc:feedhold=at=M99 until={text}{after}")
    assert until.until == Moment(word, None, offset_ns)


@pytest.mark.parametrize("word", ["m3", "m30", "m40", "m1000", "h1000", "s5", "x1", "run_ends"])
def test_a_small_letter_makes_no_function_of_what_is_none(word: str) -> None:
    with pytest.raises(UserError):
        rules(f"plc:Z.torque_limit=100 at={word}")


@pytest.mark.parametrize("keys", ["at=V.E.GO", "at=V.E.GO=1", "at=M50 until=V.E.GO+5ms"])
@pytest.mark.parametrize("known", [["GO"], ["go", "STEP"], ["Go"]])
def test_a_variable_of_a_moment_is_asked_for_in_the_column_of_the_rule(
    keys: str, known: list[str]
) -> None:
    """A rule of another column is that of another cell, which names its own mistake."""
    cell = f"{keys} for=1s" if "until" not in keys else keys
    found = rules(f"plc:feedhold={cell}")
    other = rules("plc:override=50 at=M50")
    needs_variables([*other, *found], "plc:override", [])
    needs_variables([*other, *found], "plc:feedhold", known)
    with pytest.raises(UserError, match="at: the run has no such variable") as caught:
        needs_variables([*other, *found], "plc:feedhold", ["STEP"])
    assert caught.value.value == "V.E.GO"
    assert str(caught.value.allowed) == "V.E.STEP"
    assert caught.value.hint == "plc:V.E.GO=0 gives it its first value"
