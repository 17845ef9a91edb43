"""Random programs: no set position that goes into the buffer passes what its axis may do."""

from itertools import pairwise
from typing import Any

import pytest
from tests.channel import random_programs

from axisrig.kernel.channel import ChannelSettings, CycleTiming
from axisrig.kernel.channel.distance.offsets import Offsets
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.time.clock import MS


@pytest.mark.parametrize("seed", [0, 1, 1779, 4134, 9835])  # the last three did once
def test_no_set_position_of_a_random_program_passes_a_limit(seed: int) -> None:
    machine = random_programs.run(seed)
    assert machine.passed is None, machine.text
    assert machine.refused is None, machine.text


@pytest.mark.long
@pytest.mark.parametrize("block", range(10))
def test_no_set_position_of_many_random_programs_passes_a_limit(block: int) -> None:
    for seed in range(30 * block, 30 * block + 30):
        machine = random_programs.run(seed)
        assert machine.passed is None, (seed, machine.text)


ON = "V.G.WZ_AKT.L = 80\n#TRAFO [9]\nG1 F6000 X0 Y0 Z0 C0 A0\n"


@pytest.mark.parametrize("permille", [1000, 2000])
@pytest.mark.parametrize(
    "program",
    [
        "G17 G2 F3000 X40 Y0 I20 J0",
        "G17 G3 F3000 X0 Y0 I20 J5",
        f"{ON}G1 F3000 X30 A-60",
        f"{ON}G17 G2 F3000 X40 Y0 A-40 C30 I20 J0",
    ],
    ids=["arc", "circle", "tool", "arc of the tool"],
)
def test_arcs_and_paths_of_the_tool_keep_the_acceleration_of_the_axes_at_any_override(
    words: Any, program: str, permille: int
) -> None:
    """200 % where P-CHAN-00056 lets it count: ramps get what the curve leaves at twice the feed.

    From and back to 100 % while they move, so that the ramps are in the curve too.
    """
    a_mm_s2 = 600.0
    axes = [words.axis(name, a_mm_s2=a_mm_s2).settings() for name in random_programs.HEAD]
    start = (0.0, 0.0, 80.0, 0.0, 0.0, 0.0)
    links: list[Any] = [
        random_programs.IdealLink(axis.name, mm) for axis, mm in zip(axes, start, strict=True)
    ]
    settings = ChannelSettings(override_max_permille=2000)
    clock: Any = random_programs.SimpleNamespace(now_ns=0)
    path = Path(clock, CycleTiming(MS), axes, links, Offsets({}), settings)
    path.take_over(start)
    places, cycle = [start] * 2, 0
    for command in random_programs.commands_of(program, random_programs.HEAD, path):
        random_programs.begin(path, command)
        while path.is_moving:
            path.override(1000 if cycle % 400 > 300 else permille, {})
            assert path.advance() is None
            places.append(path.interpolator.positions_mm)
            cycle += 1
    for axis in range(len(axes)):
        ways = [b[axis] - a[axis] for a, b in pairwise(places)]
        steepest = max(abs(b - a) for a, b in pairwise(ways)) / 1e-6
        assert steepest <= a_mm_s2 * (1.0 + 1e-3)
