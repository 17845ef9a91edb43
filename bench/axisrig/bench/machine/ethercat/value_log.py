"""Cyclic values of axes on EtherCAT, from the frames that are back."""

from collections.abc import Mapping
from typing import Any

import pyarrow as pa

from axisrig.bench.bus.journal import Entry, Journal
from axisrig.bench.machine.ethercat.line import Line
from axisrig.bench.machine.recording.cyclic_values import FIELDS, CyclicValues, FieldValues
from axisrig.bench.record.series import Times
from axisrig.kernel.drives.ethercat.frames import INDEX_PLACE
from axisrig.kernel.drives.ethercat.image import codec_of, objects_of
from axisrig.kernel.drives.ethercat.master import FIRST_INDEX

Part = tuple[int, int, Any, list[tuple[int, FieldValues]]]


class ValueLog(CyclicValues):
    """Notes 607A, 6064 and 60E4:1 of some axes; lines: by name."""

    def __init__(self, lines: Mapping[str, Line], axes: set[str], journal: Journal) -> None:
        super().__init__()
        self._lines, self._journal = lines, journal
        self._parts: dict[str, list[Part]] = {}
        for name, line in lines.items():
            parts: list[Part] = []
            for slave, place in zip(line.master.slaves, line.master.image.places, strict=True):
                if slave.axis in axes:
                    parts += self._part(slave.axis, place.outputs, objects_of(slave.outputs))
                    parts += self._part(slave.axis, place.inputs, objects_of(slave.inputs))
            if parts:
                self._parts[name] = parts
        if self._parts:
            journal.add(self._take)

    def _part(self, axis: str, at: int, objects: tuple[Any, ...]) -> list[Part]:
        codec = codec_of(objects)
        places = [
            (place, self.of(axis, mapped.field))
            for place, mapped in enumerate(objects)
            if mapped.field in FIELDS
        ]
        return [(at, at + codec.size, codec, places)] if places else []

    def _take(self, block: list[Entry]) -> None:
        for time_ns, segment, frame, _ in block:
            parts = self._parts.get(segment)
            if parts is None or frame[INDEX_PLACE] < FIRST_INDEX:
                continue
            image = self._lines[segment].master.image_in(frame)
            if image is None:
                continue
            for begin, end, codec, places in parts:
                numbers = codec.unpack(frame[image + begin : image + end])
                for place, values in places:
                    values.frame_ns.append(time_ns)
                    values.increments.append(numbers[place])

    def take_columns(self, times_ns: Times, *, is_last: bool) -> dict[str, pa.Array]:
        """Return lists of the values up to each instant; see `CyclicValues`."""
        self._journal.drain()
        return super().take_columns(times_ns, is_last=is_last)
