"""Every row of a shipped plan also writes its frames as BLF twice, and both must be equal.

Once by block (`BlfLog.take`), once frame by frame by python-can's writer. Containers are not
compressed: equal bytes give equal compressed ones. A plugin of pytest: `-p tests.both_writers`.
"""

from collections.abc import Generator, Sequence
from contextlib import ExitStack
from io import BytesIO
from pathlib import Path
from types import FunctionType
from typing import Any

import can
import pytest

from axisrig.bench.bus.can.logs import BlfLog, MessageLog
from axisrig.bench.bus.journal import Entry, Journal
from axisrig.bench.campaign.pytest_plugin import CaseItem
from axisrig.bench.machine.canopen import family
from axisrig.bench.machine.canopen.nodes import build_segments
from axisrig.bench.machine.machine import Machine
from axisrig.bench.rig.canopen.keys import SegmentTable
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.reading.foreign import foreign_rigs


class _Kept(BytesIO):
    """A file whose content stays when it is closed."""

    def close(self) -> None:
        pass


class BothWriters:
    """Takes blocks of frames; segments: names in the order of channels."""

    def __init__(self, segments: Sequence[str]) -> None:
        self.frames = 0
        channels = {name: number for number, name in enumerate(segments)}
        self._files = _Kept(), _Kept()
        by_block, by_frame = (self._writer(file) for file in self._files)
        self._by_block = BlfLog(by_block, channels, Path("by-block.blf"))
        self._by_frame = MessageLog(by_frame, channels, Path("by-frame.blf"))

    @staticmethod
    def _writer(file: BytesIO) -> can.BLFWriter:
        writer = can.BLFWriter(file, compression_level=0)
        writer.start_timestamp = 0.0
        return writer

    def take(self, block: Sequence[Entry]) -> None:
        self.frames += len(block)
        self._by_block.take(block)
        for entry in block:
            self._by_frame(*entry)

    def check(self) -> None:
        """Close both files and compare them."""
        for log in (self._by_block, self._by_frame):
            log.stop()
        by_block, by_frame = (file.getvalue() for file in self._files)
        assert by_block == by_frame, "BLF by block differs from python-can's"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    """Compare in every row of a plan; not in a compiled machine: it takes no other functions."""
    if not isinstance(item, CaseItem) or not isinstance(Machine.run, FunctionType):
        return (yield)
    compared: list[BothWriters] = []

    def build(
        settings: Any, scheduler: Any, journal: Journal, bus_logs: Any, opened: ExitStack
    ) -> Any:
        both = BothWriters(list(settings.segment))
        compared.append(both)
        opened.callback(both.check)  # after the last block, before the verdict
        journal.add(both.take)
        return build_segments(settings, scheduler, journal, bus_logs, opened)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(family, "build_segments", build)
        result = yield
    # A row with a foreign FMU is compared in a process of its own
    is_apart = bool(foreign_rigs([item.case.rig])) or item.config.getoption(
        "axisrig_call_timeout", default=None
    )
    rig, _ = read_rig(item.case.rig)
    has_can = any(isinstance(table, SegmentTable) for table in rig.segment.values())
    assert is_apart or not has_can or sum(both.frames for both in compared) > 0
    return result
