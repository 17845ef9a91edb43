"""Drives on several EtherCAT lines: each is started, watched and numbered on its own line."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.made_rigs import above, settings_of

from axisrig.bench.machine.ethercat import family
from axisrig.bench.machine.ethercat.family import EthercatLines
from axisrig.bench.rig.ethercat.members import (
    axes_on,
    ec_axes,
    ec_segments,
    position_of,
    slaves_on,
)
from axisrig.bench.rig.settings import Settings

WIRED: list[dict[str, str]] = [
    {"X": "one", "Y": "one", "Z": "two"},
    {"X": "one", "Y": "two", "Z": "two"},
    {"X": "one", "Y": "two", "Z": "one"},
    {"X": "two", "Y": "one", "Z": "one"},
    {"X": "two", "Y": "one", "Z": "two"},
    {"X": "one", "Y": "can1", "Z": "two"},
]
"""Segments of the axes; what does not begin with `can` is a line."""


def order(wired: dict[str, str], line: str) -> str:
    return "".join(axis for axis, segment in wired.items() if segment == line)


class Start:
    """The start-up of a line: who has begun it."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.begun: list[tuple[int, Any]] = []

    def begin(self, number: int, ended: Any) -> None:
        self.begun.append((number, ended))


def lines_of(wired: dict[str, str]) -> Any:
    """The part of a machine that has these lines."""
    part: Any = EthercatLines.__new__(EthercatLines)
    axes = {axis: SimpleNamespace(segment=segment) for axis, segment in wired.items()}
    part._bench = SimpleNamespace(settings=SimpleNamespace(rig=SimpleNamespace(axis=axes)))
    part.lines, part.links = {}, {}
    for name in ("one", "two"):
        on = order(wired, name)
        slaves = [SimpleNamespace(axis=axis, outputs=[], inputs=[]) for axis in on]
        watches = {axis: lambda carrier, axis=axis: f"watch of {axis} on {carrier}" for axis in on}
        part.lines[name] = SimpleNamespace(
            axes=[*on], start=Start(name), watches=watches, carrier=name,
            master=SimpleNamespace(slaves=slaves),
        )  # fmt: skip
        part.links |= {
            axis: SimpleNamespace(settings=slave) for axis, slave in zip(on, slaves, strict=True)
        }
    return part


@pytest.mark.interpreted
@pytest.mark.parametrize("wired", WIRED)
def test_a_drive_begins_the_start_of_its_own_line_by_its_place_there(wired: dict[str, str]) -> None:
    part = lines_of(wired)
    for axis in part.links:
        part.start_up(axis).begin(f"{axis} has ended")
    for name, line in part.lines.items():
        on = order(wired, name)
        begun = [(on.index(axis), f"{axis} has ended") for axis in on]
        assert line.start.begun == begun, name


@pytest.mark.interpreted
@pytest.mark.parametrize("wired", WIRED)
def test_a_drive_is_watched_over_the_carrier_of_its_own_line(wired: dict[str, str]) -> None:
    part = lines_of(wired)
    for axis in part.links:
        assert part.watch(axis) == f"watch of {axis} on {wired[axis]}"


@pytest.mark.interpreted
@pytest.mark.parametrize("wired", WIRED)
def test_the_process_data_of_an_axis_are_those_of_its_slave(
    wired: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    part = lines_of(wired)
    monkeypatch.setattr(family, "_telegram", lambda name, pdos: (name, *pdos))
    for line in part.lines.values():
        for slave in line.master.slaves:
            slave.outputs, slave.inputs = [f"out {slave.axis}"], [f"in {slave.axis}"]
    for axis in part.links:
        assert part.telegrams(axis) == [("RxPDO1", f"out {axis}"), ("TxPDO1", f"in {axis}")]


# The same of a rig

EMPTY = """
[segment.one]
carrier = "ethercat"
[segment.two]
carrier = "ethercat"
[segment.can1]
bitrate = 1_000_000
"""


def rig(folder: Path, wired: dict[str, str]) -> Settings:
    text = EMPTY + "".join(
        f'[axis.{axis}]\nsegment = "{segment}"\n'
        + (f"node = {node}\n" if segment == "can1" else "")
        for node, (axis, segment) in enumerate(wired.items(), 1)
    )
    return settings_of(above(folder, "probe-xyz-ethercat.toml", text))


@pytest.mark.parametrize("wired", WIRED)
def test_axes_of_a_line_are_numbered_from_1_on_in_the_order_of_the_rig(
    tmp_path: Path, wired: dict[str, str]
) -> None:
    settings = rig(tmp_path, wired)
    assert [name for name in ec_segments(settings) if name != "ec1"] == ["one", "two"]
    assert ec_axes(settings) == [axis for axis in "XYZ" if wired[axis] != "can1"]
    for name in ("one", "two"):
        on = [*order(wired, name)]
        assert axes_on(settings, name) == slaves_on(settings, name) == on
        assert [position_of(settings, axis) for axis in on] == list(range(1, len(on) + 1))
