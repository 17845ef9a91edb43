"""`axisrig errors`: the list, its filters, and everything about one alarm."""

from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.tools.listings.alarms import alarm_listing, explained, page, unit_of
from axisrig.kernel.errors import UserError, catalogue, reaction_classes


def test_the_list_has_every_alarm_once() -> None:
    lines = alarm_listing().splitlines()
    ids = [int(line[:6]) for line in lines if line[:6].strip().isdigit()]
    assert ids == list(catalogue())


@pytest.mark.parametrize(
    ("options", "present", "absent"),
    [
        ({"word": "Fixed Stop"}, 51026, 50052),
        ({"word": "P-AXIS-00518"}, 50052, 50059),
        ({"reaction_class": 5}, 70082, 50052),
        ({"area": "bus"}, 900031, 70082),
        ({"word": "probe", "reaction_class": 4}, 50052, 110622),
    ],
)
def test_word_class_and_area_filter(options: dict[str, object], present: int, absent: int) -> None:
    shown = alarm_listing(**options)  # type: ignore[arg-type]
    assert f"{present:>6}  " in shown
    assert f"{absent:>6}  " not in shown


@pytest.mark.parametrize(
    "options",
    [{}, {"word": "probe"}, {"reaction_class": 5}, {"area": "bus"},
     {"area": "bus", "word": "frame"}, {"reaction_class": 4, "word": "probe"}],
)  # fmt: skip
def test_the_legend_counts_the_alarms_that_are_listed(options: dict[str, object]) -> None:
    *lines, blank, legend, last = alarm_listing(**options).splitlines()  # type: ignore[arg-type]
    assert legend.startswith(f"ID, class, text; {len(lines)} of {len(catalogue())}.")
    assert (blank, last) == ("", "axisrig errors ID shows all about one.")


@pytest.mark.parametrize("word", ["70331", "ID 70331", "ID70331"])
def test_one_id_is_told_in_full(word: str) -> None:
    message = alarm_listing(word)
    assert message.startswith("ID 70331, class 7: controlled halt of the axis (distance control)")
    assert "Newer builds report 310017." in message
    assert "deviation_mm [mm]" in message
    assert "P-AXIS-00414" in message
    assert "raised     yes" in message
    assert "raised     not yet" in alarm_listing("310021")
    assert "FCT-M3 11" in message
    assert "retract with care" in message


def test_a_newer_twin_says_under_which_id_it_is_raised() -> None:
    assert "raised     as 110757" in alarm_listing("110657")


def test_every_alarm_can_be_told() -> None:
    for alarm_id, entry in catalogue().items():
        message = " ".join(explained(alarm_id).split())
        assert entry.remedy in message
        assert reaction_classes()[entry.reaction_class]["machine"] in message


def test_an_unknown_id_names_the_nearest() -> None:
    with pytest.raises(UserError, match=r"70337; did you mean: .*70336 \(Distance control"):
        alarm_listing("70337")


def test_a_word_that_nothing_has_is_told() -> None:
    with pytest.raises(
        UserError, match="no alarm fits; found 'wrokpiece'; did you mean: workpiece"
    ):
        alarm_listing("wrokpiece")
    with pytest.raises(UserError, match="no area of alarms; found 'buss'; did you mean: bus"):
        alarm_listing(area="buss")


def test_reactions_of_the_catalogue_are_those_of_the_classes() -> None:
    assert list(reaction_classes()) == [1, 2, 3, 4, 5, 6, 7]
    for entry in catalogue().values():
        assert entry.reaction == reaction_classes()[entry.reaction_class]["reaction"]


@pytest.mark.parametrize(
    ("name", "unit"),
    [("lag_mm", "mm"), ("ms", "ms"), ("a_mm_s2", "mm/s2"), ("axis", ""), ("forms", ""),
     ("change_um_s", "um/s"), ("limit_permille", "0.1 %")],
)  # fmt: skip
def test_the_unit_stands_at_the_end_of_the_name(name: str, unit: str) -> None:
    assert unit_of(name) == unit


def test_the_page_is_fresh() -> None:
    """Else: axisrig errors --format markdown > docs/errors.md."""
    path = Path(__file__).parents[2] / "docs" / "errors.md"
    assert path.read_text(encoding="utf-8") == page()


def test_the_page_has_every_alarm_under_its_area() -> None:
    rows = [line for line in page().splitlines() if line.startswith("| ")]
    ids = {int(row.split()[1]) for row in rows if row.split()[1].isdigit()}
    assert set(catalogue()) <= ids


def test_a_word_that_is_like_nothing_gets_no_guesses() -> None:
    with pytest.raises(UserError) as caught:
        alarm_listing("foo")
    assert "did you mean" not in str(caught.value)
    assert "axisrig errors lists all" in str(caught.value)


def guess(word: str, **given: Any) -> str:
    """What is offered for a word that no alarm has."""
    with pytest.raises(UserError, match="no alarm fits") as caught:
        alarm_listing(word, **given)
    assert caught.value.value == word
    return str(caught.value.allowed or "")


@pytest.mark.parametrize(
    ("word", "like"),
    [
        ("probee", "probe"), ("PROBEE", "probe"), ("plsc", "plc"), ("toleranse", "tolerance"),
        ("P-CHAN-0153", "p-chan-00153"),  # it is there in brackets alone
        ("greatre", "greater"),  # before a full stop alone
        ("xyz", ""), ("lqg", ""),  # three letters are like many
        ("qqqqqq", ""),
    ],
)  # fmt: skip
def test_a_word_that_is_nearly_there_is_offered_without_the_signs_around_it(
    word: str, like: str
) -> None:
    offered = guess(word).split(", ")
    assert like in offered
    assert [one for one in offered if one.strip(".,:;(){}") != one] == []


@pytest.mark.long
def test_a_word_of_other_classes_or_areas_is_not_offered_for_itself() -> None:
    """Alarms of probes are no warnings of the drives: what is offered is there, and another."""
    texts = {entry.id: f"{entry.text} {entry.remedy} {entry.source} {entry.area} {entry.reaction}"
             for entry in catalogue().values()}  # fmt: skip
    for given in ({"area": "edge banding"}, {"area": "drives", "reaction_class": 1}):
        inside = [
            texts[entry.id].casefold() for entry in catalogue().values()
            if entry.area == given["area"]
            and entry.reaction_class == given.get("reaction_class", entry.reaction_class)
        ]  # fmt: skip
        outside = {word for text in texts.values() for word in text.casefold().split()}
        outside = {word for word in outside if word.isalpha() and len(word) > 5}
        absent = sorted(word for word in outside if not any(word in text for text in inside))
        offers = {word: text.split(", ") for word in absent if (text := guess(word, **given))}
        assert len(offers) > 5  # most of them are like nothing
        for word, offered in offers.items():
            assert word not in offered
            assert all(any(one in text for text in inside) for one in offered)


def test_a_class_that_no_alarm_of_an_area_has_is_named() -> None:
    """A word counts before it."""
    for given, value in (
        ({"reaction_class": 99}, 99), ({"reaction_class": 99, "area": "drives"}, 99),
        ({"reaction_class": 99, "word": "probe"}, "probe"),
    ):  # fmt: skip
        with pytest.raises(UserError, match="no alarm fits") as refused:
            alarm_listing(**given)  # type: ignore[arg-type]
        assert refused.value.value == value
        assert refused.value.allowed is None
