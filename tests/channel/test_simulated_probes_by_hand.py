"""Which axes of a run have a simulated probe, what each sees of the path, and 900523."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.path import simulated_probes
from axisrig.kernel.channel.path.simulated_probes import SimulatedProbes
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.simulated import ALL, BODY, CYCLES, FIRST, POSITION, REST
from axisrig.kernel.nc.block import Block

HERE_MM = {"X": 1.0, "Y": 2.0, "Z": 3.0}
ENDS_MM = {"X": 11.0, "Y": 2.0, "Z": -7.0}


class Straight(SimpleNamespace):
    """A straight path."""


class Bent(SimpleNamespace):
    """A path that bends under a kinematic."""


def bench(
    modes: dict[str, tuple[int, ...]], curve: Any
) -> tuple[SimulatedProbes, list[Alarm], Any]:
    """Probes of axes with these P-AXIS-00112 and 00145 to 00148; what they warn of; their path."""
    path: Any = SimpleNamespace(
        settings=lambda name: SimpleNamespace(measuring=SimpleNamespace(simulated=modes[name])),
        straight=lambda _target: curve,
        position_mm=lambda: dict(HERE_MM),
        position_acs_mm=lambda name: HERE_MM[name] + 100.0,
    )
    warned: list[Alarm] = []
    return SimulatedProbes(path, tuple(HERE_MM), warned.append), warned, path


def run(measuring: str, offset_mm: float = 0.0) -> Any:
    target_mm = {axis: ENDS_MM[axis] for axis in "XZ"}
    return SimpleNamespace(
        measuring_axes=tuple(measuring), target_mm=target_mm, simulated_offset_mm=offset_mm,
        programmed_axes=("X", "Z"), block=Block(3, 30, "N30"),
    )  # fmt: skip


STRAIGHT = Straight(start_mm=tuple(HERE_MM.values()), end_mm=tuple(ENDS_MM.values()))


@pytest.mark.parametrize(
    ("x", "z", "measuring", "is_shifted"),
    [
        (ALL, 0, "XZ", True),
        (0, ALL, "XZ", True),
        (ALL, POSITION, "XZ", True),
        (FIRST, ALL, "XZ", True),
        (ALL, POSITION, "Z", False),  # X does not measure
        (POSITION, REST, "XZ", False),
        (0, 0, "XZ", False),
        (BODY, CYCLES, "XZ", False),
    ],
)
def test_an_offset_is_warned_of_where_it_shifts_none_of_the_measuring_axes(
    x: int, z: int, measuring: str, is_shifted: bool
) -> None:
    lists = {"X": (x, 0, 0, 0, 0), "Y": (ALL, 0, 0, 0, 0), "Z": (z, 0, 0, 0, 0)}
    for offset_mm in (0.0, -3.0, 3.0):
        probes, warned, _ = bench(lists, STRAIGHT)
        found = probes.make(run(measuring, offset_mm))
        assert list(found) == [axis for axis in measuring if lists[axis][0]]
        assert all(probe.way.offset_mm == offset_mm for probe in found.values())
        expected = [] if is_shifted or not offset_mm else [(900523, f"{offset_mm:g}")]
        assert [(alarm.id, alarm.values["offset_mm"]) for alarm in warned] == expected
        assert all(alarm.place == "line 3, block N30" for alarm in warned)


@pytest.mark.parametrize("is_bent", [False, True])
def test_each_probe_has_its_own_places_of_the_path_and_sees_every_cycle(
    monkeypatch: pytest.MonkeyPatch, is_bent: bool
) -> None:
    """Under a kinematic the path has more places than its ends, and a length of its own."""
    monkeypatch.setattr(simulated_probes, "ToolCurve", Bent)
    middle = (4.0, 5.0, 6.0)
    places = [STRAIGHT.start_mm, middle, STRAIGHT.end_mm]
    bent = Bent(start_mm=places[0], end_mm=places[-1], places=places, share=0.6)
    lists = {"X": (CYCLES, 2, 0, 0, 0), "Y": (BODY, 0, 40_000, 0, 0), "Z": (CYCLES, 3, 0, 0, 0)}
    probes, _, _ = bench(lists, bent if is_bent else STRAIGHT)
    found = probes.make(run("XZ"))
    assert found["X"].places_mm == ((1.0, 4.0, 11.0) if is_bent else (1.0, 11.0))
    assert found["Z"].places_mm == ((3.0, 6.0, -7.0) if is_bent else (3.0, -7.0))
    for name, probe in found.items():
        assert (probe.mode, probe.parameter) == (CYCLES, lists[name][1])
        assert (probe.way.start_mm, probe.way.programmed) == (HERE_MM, ("X", "Z"))
        assert probe.way.share == (0.6 if is_bent else 1.0)
        assert probe.body.axes == {"Y": (0.0, 4.0, 0.0, 0.0)}
        probe.arm()
    values = []
    for _ in range(3):
        probes.look()
        values.append([probe.latched_mm for probe in found.values()])
    assert values == [[None, None], [101.0, None], [101.0, 103.0]]
    lists |= dict.fromkeys("XZ", (0, 0, 0, 0, 0))
    assert probes.make(run("XZ")) == {}
    probes.look()  # nobody looks any more
    assert found["X"].latched_mm == 101.0
