"""Runs of distance control on whole machines, with what the bus told in every cycle."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from axisrig.kernel.channel import Channel

LISTS = Path(__file__).parents[3] / "testplans" / "rigs" / "lists"
PREFIX = {False: "kenngr.distc.", True: "kenngr.dist_ctrl[0]."}
MM_PER_INCREMENT = 1e-5
"""Of the sensor: 10 increments are 0.1 um (P-AXIS-00422 and 00423 of the shipped lists)."""


@dataclass(frozen=True)
class Cycle:
    """What the bus and the axis tell at the end of one NC cycle; state and offset of the control.

    sensor_mm: falls when the tool lifts (P-AXIS-00230 = 1). alarms: how many have come up.
    """

    sensor_mm: float | None
    actual_mm: float
    state: str | None
    offset_mm: float
    block: int | None
    alarms: int


@dataclass
class Watched:
    """Every cycle of a run and what the run left.

    outcome: as of `run_nc`; alarm: the one that ended the program, or the first.
    """

    cycles: list[Cycle] = field(default_factory=list)
    outcome: Any = None

    @property
    def channel(self) -> Channel:
        channel: Channel = self.outcome.machine.channel
        return channel

    @property
    def alarm(self) -> Any:
        return next((a for a in self.channel.alarms if a.ends_program), self.channel.alarms[0])

    def alarm_cycle(self, count: int = 1) -> int:
        """The cycle in which the given alarm of the run came up."""
        return next(i for i, cycle in enumerate(self.cycles) if cycle.alarms >= count)

    def first(self, holds: Callable[[Cycle], bool]) -> int:
        """The first cycle of which something holds."""
        return next(i for i, cycle in enumerate(self.cycles) if holds(cycle))

    def first_of(self, block: int) -> int:
        """The cycle in which a block begins."""
        return self.first(lambda cycle: cycle.block == block)


RunDistance = Callable[..., Watched]


@pytest.fixture
def run_distance(run_nc: Callable[..., Any], tmp_path: Path) -> RunDistance:
    """Return `run(program, *assignments, newer=..)`; `{list}` is the prefix of the structure.

    newer: lists with kenngr.dist_ctrl[0], whose alarms are 3100xx. lines: of the list of Z, in the
    place of the shipped ones. act: called in every cycle.
    """

    def run(
        program: str,
        *assignments: str,
        newer: bool = False,
        rig: str = "",
        base: str = "distance-z.toml",
        lines: Sequence[str] = (),
        act: Callable[[Channel, int], None] | None = None,
    ) -> Watched:
        watched = Watched()

        def watch(channel: Channel) -> None:
            watched.cycles.append(_seen(channel))
            if act is not None:
                act(channel, len(watched.cycles))

        if newer or lines:
            name = "axis-z-distance-new.lst" if newer else "axis-z-distance.lst"
            own = _with_lines(tmp_path / name, LISTS / name, [put_prefix(t, newer) for t in lines])
            rig = f'[axis.Z]\nlist = "{own.as_posix()}"\n{rig}'
        put = [put_prefix(text, newer) for text in assignments]
        watched.outcome = run_nc(program, rig, *put, base=base, watch=watch)
        return watched

    return run


def put_prefix(text: str, newer: bool) -> str:
    return text.replace("{list}", PREFIX[newer])


def _with_lines(own: Path, shipped: Path, lines: Sequence[str]) -> Path:
    names = {line.split()[0] for line in lines}
    kept = [
        line
        for line in shipped.read_text("utf-8").splitlines()
        if line.split() and line.split()[0] not in names
    ]
    own.write_text("\n".join([*kept, *lines, ""]), "utf-8")
    return own


def _seen(channel: Channel) -> Cycle:
    link = next(link for link in channel.links if link.name == "Z")
    found = channel.distance.axes.get("Z")
    block = channel.execution.block
    count = link.second_increments
    return Cycle(
        sensor_mm=None if count is None else -count * MM_PER_INCREMENT,
        actual_mm=link.actual_mm,
        state=None if found is None else found.control.state.name,
        offset_mm=0.0 if found is None else found.control.offset_mm,
        block=None if block is None else block.number,
        alarms=len(channel.alarms),
    )
