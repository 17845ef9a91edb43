"""All topics put together: which handler takes which word, command and variable."""

from collections.abc import Iterable, Mapping
from typing import TypeVar

from kernel.nc.decoder import (
    axes,
    circles,
    drives,
    flow,
    measuring,
    messages,
    motion,
    offsets,
    pauses,
    systems,
    tools,
)
from kernel.nc.decoder import variables as variables_
from kernel.nc.decoder.topic import Handler, Reader

Key = TypeVar("Key")
Value = TypeVar("Value")

TOPICS = tuple(
    module.TOPIC
    for module in (
        motion,
        pauses,
        circles,
        measuring,
        systems,
        offsets,
        tools,
        axes,
        drives,
        messages,
        flow,
        variables_,
    )
)


def _together(tables: Iterable[Mapping[Key, Value]]) -> Mapping[Key, Value]:
    whole: dict[Key, Value] = {}
    for table in tables:
        twice = whole.keys() & table.keys()
        assert not twice, f"two topics handle {twice}"
        whole.update(table)
    return whole


STATEMENTS: Mapping[type, Handler] = _together(topic.statements for topic in TOPICS)
COMMANDS: Mapping[str, Handler] = _together(topic.commands for topic in TOPICS)
ADDRESSES: Mapping[str, Handler] = _together(topic.addresses for topic in TOPICS)
SETTINGS: Mapping[str, Handler] = _together(topic.settings for topic in TOPICS)
TAKES_AXES: Mapping[str, Handler] = _together(topic.takes_axes for topic in TOPICS)
ENDINGS: Mapping[str, Handler] = _together(topic.endings for topic in TOPICS)
READERS: Mapping[str, Reader] = _together(topic.readers for topic in TOPICS)
