"""docs/recording.md names everything that a recording holds."""

import re
from dataclasses import fields
from pathlib import Path

from axisrig.bench.judge.topics import TOPICS
from axisrig.bench.record.facts import Facts

PAGE = (Path(__file__).parents[2] / "docs" / "recording.md").read_text(encoding="utf-8")


def test_every_entry_of_the_facts_is_described() -> None:
    rows = [line for line in PAGE.splitlines() if line.startswith("| `")]
    named = {name for line in rows for name in re.findall(r"`(\w+)`", line.split("|")[1])}
    assert {field.name for field in fields(Facts)} <= named


def test_the_topics_are_those_of_the_judge() -> None:
    (listed,) = re.findall(r"a folder for each topic \(([^)]*)\)", PAGE)
    assert re.findall(r"`(\w+)`", listed) == [topic.name for topic in TOPICS]
