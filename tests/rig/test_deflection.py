"""How far a probe gives way: followed from each contact, beyond the stroke told, broken once."""

from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.deflection import DeflectionLog
from axisrig.bench.machine.plants import check_plant
from axisrig.bench.rig.reading.file import PlantTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.cosim.plant.probe import Contact
from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import LinearMove
from axisrig.kernel.time.clock import MS

Write = Callable[..., Path]
Read = Callable[..., Settings]
STROKE_MM = 0.3


def _axes(is_wired: bool) -> dict[str, Any]:
    probe = "tip" if is_wired else None
    return {name: SimpleNamespace(plant=name.lower(), probe_1=probe, probe_2=None) for name in "XZ"}


class Bench:
    """Axes x and z with a probe, moved by hand in cycles of 1 ms; positions in mm."""

    def __init__(self, is_wired: bool = True, **keys: Any) -> None:
        self.axes = [
            SimpleNamespace(motion=[0.0, 0.0], slave=SimpleNamespace(name=name)) for name in "xz"
        ]
        roles = SimpleNamespace(has_group=lambda group: group == "contact")
        self.probe: Any = SimpleNamespace(sources=self.axes, contacts=[], roles=roles)
        self.plant: Any = SimpleNamespace(probes={"tip": self.probe}, now_ns=0)
        tables = {"tip": PlantTable(fmu="own.fmu", **keys)}
        settings: Any = SimpleNamespace(
            rig=SimpleNamespace(plant=tables, axis=_axes(is_wired), plc_task=None)
        )
        self.settings = settings
        self.log = DeflectionLog(settings, self.plant, MS)
        self.alarms: list[Alarm] = []
        self.begun: Any = LinearMove(Block(7, 30, "Z-1"), {"Z": -1.0}, False, 600.0)
        self.measuring: set[str] = set()
        self.beside: dict[str, Block] = {}
        single = SimpleNamespace(
            measuring_state=lambda axis: "MOVING" if axis in self.measuring else None,
            independent=SimpleNamespace(block_of=self.beside.get),
        )
        self.channel: Any = SimpleNamespace(
            stop=self.alarms.append, single=single, execution=SimpleNamespace(begun=None)
        )

    def cycle(self, x_mm: float, z_mm: float, contact_mm: Sequence[float] | None = None) -> None:
        """Move to a place within one cycle, through a contact on the way if one is given."""
        self.plant.now_ns += MS
        self.channel.execution.begun = self.begun
        if contact_mm is not None:
            places = dict(zip("xz", contact_mm, strict=True))
            self.probe.contacts.append(Contact(self.plant.now_ns - 1, places))
        for axis, place_mm in zip(self.axes, (x_mm, z_mm), strict=True):
            axis.motion = [place_mm * 1e-3, place_mm * 1e-3 - axis.motion[0]]
            axis.motion[1] /= 1e-3
        self.log(self.channel)

    def approach(self) -> None:
        """Come down along z to 0.1 mm above the workpiece, in two cycles."""
        self.cycle(0.0, 0.2)
        self.cycle(0.0, 0.1)

    @property
    def ways_mm(self) -> list[float]:
        return [each.mm for each, _ in self.log.of("tip")]


def test_the_way_counts_in_the_direction_of_the_contact() -> None:
    """Obliquely by 0.3 and 0.4 per cycle; a contact half way; sidewards is no deflection."""
    bench = Bench()
    bench.cycle(0.0, 0.0)
    bench.cycle(0.3, 0.4)
    bench.cycle(0.6, 0.8, contact_mm=(0.45, 0.6))
    assert bench.ways_mm == pytest.approx([0.25])
    bench.cycle(0.6 - 0.4, 0.8 + 0.3)
    assert bench.ways_mm == pytest.approx([0.25])
    bench.cycle(0.6 - 0.4 + 0.03, 0.8 + 0.3 + 0.04)
    assert bench.ways_mm == pytest.approx([0.3])


def test_an_axis_at_two_coordinates_of_its_probe_moves_it_once() -> None:
    """As in a rig that wires x and z of its probe to one axis: 0.2 mm are 0.2 mm."""
    bench = Bench()
    bench.probe.sources = [bench.axes[1], bench.axes[1]]
    log = DeflectionLog(bench.settings, bench.plant, MS)
    bench.log = log
    bench.approach()
    bench.cycle(0.0, -0.2, contact_mm=(0.0, 0.0))
    assert bench.ways_mm == pytest.approx([0.2])


def test_each_contact_counts_from_its_place_until_the_axes_are_back() -> None:
    bench = Bench(stroke_mm=STROKE_MM)
    bench.approach()
    bench.cycle(0.0, -0.1, contact_mm=(0.0, 0.0))
    bench.cycle(0.0, 0.2)
    bench.cycle(0.0, -5.0)  # beside the workpiece: no contact
    bench.cycle(0.0, -5.5, contact_mm=(0.0, -5.1))
    assert bench.ways_mm == pytest.approx([0.1, 0.4])
    assert bench.alarms == []
    ((found, words),) = [item for item in bench.log.of("tip") if item[1]]
    assert found.beyond_ns == 6 * MS
    assert words == "tip: deflected by 0.4000 mm, more than its stroke of 0.3 mm"


def test_the_stroke_itself_is_borne() -> None:
    bench = Bench(stroke_mm=STROKE_MM)
    bench.approach()
    bench.cycle(0.0, -STROKE_MM + 1e-9, contact_mm=(0.0, 0.0))
    assert bench.ways_mm == pytest.approx([STROKE_MM])
    assert [words for _, words in bench.log.of("tip")] == [""]


def _driven(bench: Bench) -> list[str]:
    bench.approach()
    bench.cycle(0.0, -0.1, contact_mm=(0.0, 0.0))
    bench.cycle(0.0, -10.0)
    return [words for _, words in bench.log.of("tip")]


def test_a_block_that_drives_a_probe_without_stroke_into_the_workpiece_is_noted() -> None:
    (words,) = _driven(Bench())
    assert words.startswith(
        "tip: driven 10.0000 mm past its contact by axis Z in line 7, block N30"
    )


def test_the_block_of_an_axis_beside_the_path_is_the_one_that_is_noted() -> None:
    bench = Bench()
    bench.begun, bench.beside["Z"] = None, Block(9, 50, "Z[INDP_ASYN ..]")
    assert "block N50" in _driven(bench)[0]


def test_a_run_a_switch_a_known_stroke_and_a_workpiece_that_comes_are_not_noted() -> None:
    runs = Bench()
    runs.measuring.add("Z")
    homing = Bench()
    homing.begun = None
    for bench in (runs, homing, Bench(is_wired=False), Bench(stroke_mm=20.0)):
        assert _driven(bench) == [""]
    still = Bench()
    still.cycle(0.0, 0.0)
    still.cycle(0.0, 0.0, contact_mm=(0.0, 0.0))
    still.cycle(0.0, -1.0)
    assert [words for _, words in still.log.of("tip")] == [""]


@pytest.mark.provokes(900072, 4, probe="tip", deflection_mm="0.3100", stroke_mm="0.3")
def test_a_probe_breaks_once() -> None:
    bench = Bench(stroke_mm=STROKE_MM, breaks=True)
    bench.approach()
    bench.cycle(0.0, -0.31, contact_mm=(0.0, 0.0))
    bench.cycle(0.0, -0.5)
    bench.cycle(0.0, 0.5)
    bench.cycle(0.0, -0.5, contact_mm=(0.0, 0.0))
    assert [alarm.id for alarm in bench.alarms] == [900072]
    assert "it is broken" in bench.log.of("tip")[0][1]


def test_a_contact_at_rest_counts_every_way() -> None:
    bench = Bench()
    bench.cycle(0.0, 0.0)
    bench.cycle(0.0, 0.0, contact_mm=(0.0, 0.0))
    bench.cycle(0.3, 0.4)
    assert bench.ways_mm == pytest.approx([0.5])


@pytest.mark.parametrize(
    ("plant", "keys", "why"),
    [
        ("z", "stroke_mm = 1", "plant z: only a probe has a stroke"),
        ("probe", "breaks = true", "plant probe: a probe that breaks has a stroke"),
    ],
)
def test_a_stroke_that_nothing_can_watch_is_refused(
    rig_file: Write, settings_of: Read, plant: str, keys: str, why: str
) -> None:
    path = rig_file((f"[plant.{plant}]\n", f"[plant.{plant}]\n{keys}\n"))
    with pytest.raises(UserError, match=why) as caught:
        check_plant(settings_of(path))
    assert path.read_text().splitlines()[(caught.value.line or 0) - 1] == keys
