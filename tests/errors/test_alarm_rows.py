"""The rows of one alarm, and where a word is looked for: each alarm beside its row of the table."""

import re

import pytest

from axisrig.bench.tools.listings.alarms import alarm_listing, explained
from axisrig.kernel.errors import CatalogueEntry, UserError, catalogue, reaction_classes

ALL = list(catalogue().values())
TYPES = {
    1: "from the NC program",
    2: "from the transfer of the parameters",
    11: "from the position control",
}
UNITS = {
    "mm": "mm", "ms": "ms", "s": "s", "us": "us", "hz": "Hz", "deg": "degrees", "um_s": "um/s",
    "mm_s": "mm/s", "mm_s2": "mm/s2", "mm_min": "mm/min", "permille": "0.1 %",
}  # fmt: skip


def rows_of(message: str) -> dict[str, str]:
    """Each row below the head by its name, in one line."""
    found: dict[str, str] = {}
    for line in message.splitlines()[1:]:
        assert len(line) <= 96
        name, text = line[:11].strip(), line[11:]
        assert text == text.strip()
        if name:
            assert name not in found
            last, found[name] = name, text
        else:
            found[last] += f" {text}"
    return found


def named(text: str) -> str:
    return re.sub(r"\{(\w+)\}", r"<\1>", text)


def is_later(entry: CatalogueEntry) -> bool:
    twin = catalogue().get(entry.older_id or 0)
    return not entry.is_raised and not (twin is not None and twin.is_raised)


def with_unit(name: str) -> str:
    """A value with the longest unit at its end; one that is called as its unit has none."""
    parts = name.split("_")
    ends = ["_".join(parts[at:]) for at in range(1, len(parts))]
    units = [UNITS[end] for end in ends if end in UNITS]
    return f"{name} [{units[0]}]" if units else name


def test_each_alarm_has_a_row_for_each_fact_and_none_for_what_it_lacks() -> None:
    later = "not yet: what leads to it does not act here"
    for entry in ALL:
        reaction = reaction_classes()[entry.reaction_class]
        raised = later if is_later(entry) else "yes" if entry.is_raised else f"as {entry.older_id}"
        expected = {
            "says": named(entry.text),
            "values": ", ".join(with_unit(name) for name in entry.values),
            "family": entry.relation,
            "machine": reaction["machine"],
            "remedy": entry.remedy,
            "afterwards": reaction["afterwards"],
            "type": TYPES.get(entry.error_type or 0, ""),
            "raised": raised,
            "source": entry.source,
            "inferred": ", ".join(entry.inferred),
        }
        message = explained(entry.id)
        number = entry.reaction_class
        assert message.splitlines()[0] == (
            f"ID {entry.id}, class {number}: {entry.reaction} ({entry.area})"
        )
        found = {name: text.replace(" ", "") for name, text in rows_of(message).items()}
        # A line may end after a hyphen
        assert found == {name: text.replace(" ", "") for name, text in expected.items() if text}
        assert list(found) == [name for name, text in expected.items() if text]
    assert {entry.error_type for entry in ALL} == {None, *TYPES}


def ids(listing: str) -> list[int]:
    rows = listing.splitlines()[:-3]
    return [int(row[:6]) for row in rows]


@pytest.mark.parametrize("field", ["text", "remedy", "source", "area", "reaction"])
def test_a_word_is_looked_for_in_each_column_whatever_its_case(field: str) -> None:
    for entry in (ALL[0], ALL[len(ALL) // 2], ALL[-1]):
        whole = getattr(entry, field)
        assert whole  # nothing would be found in every row
        assert entry.id in ids(alarm_listing(whole.upper()))


def test_word_class_and_area_count_together() -> None:
    for entry in ALL[:: len(ALL) // 9]:
        area, number, word = entry.area, entry.reaction_class, entry.source
        same = [e.id for e in ALL if (e.area, e.reaction_class) == (area, number)]
        assert ids(alarm_listing(area=area, reaction_class=number)) == same
        found = ids(alarm_listing(word, number, area))
        assert entry.id in found
        assert set(found) <= set(same)


def test_a_line_is_marked_where_nothing_raises_the_alarm_or_its_older_twin() -> None:
    rows = alarm_listing().splitlines()[:-3]
    assert [row[11:] for row in rows] == [
        ("(-) " if is_later(entry) else "") + named(entry.text) for entry in ALL
    ]


def test_where_no_alarm_of_an_area_has_a_class_the_class_is_named() -> None:
    area, number = next(
        (area, number)
        for area in sorted({entry.area for entry in ALL})
        for number in reaction_classes()
        if not any((e.area, e.reaction_class) == (area, number) for e in ALL)
    )
    with pytest.raises(UserError, match="no alarm fits") as caught:
        alarm_listing(area=area, reaction_class=number)
    assert (caught.value.value, caught.value.allowed) == (number, None)
