"""How far a probe gives way: followed from each contact, beyond the stroke told, broken once."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.deflection import DeflectionLog, check_strokes
from axisrig.bench.machine.plants import check_plant
from axisrig.bench.rig.reading.file import PlantTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.cosim.plant.probe import Contact
from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import ArcMove, Dwell, LinearMove, MeasuringRun
from axisrig.kernel.time.clock import MS

Write = Callable[..., Path]
Read = Callable[..., Settings]
STROKE_MM = 0.3


Wiring = Mapping[str, tuple[str | None, str | None]]
WIRED: Wiring = {"X": ("tip", None), "Z": ("tip", None)}


def _axes(wiring: Wiring) -> dict[str, Any]:
    """Axes with what is at their inputs 1 and 2."""
    found = {}
    for name in "XZ":
        first, second = wiring.get(name, (None, None))
        found[name] = SimpleNamespace(plant=name.lower(), probe_1=first, probe_2=second)
    return found


def _task(inputs: Mapping[int, str]) -> Any:
    return SimpleNamespace(terminal=SimpleNamespace(inputs=inputs))


class Bench:
    """Axes x and z with a probe, moved by hand in cycles of 1 ms; positions in mm."""

    def __init__(self, wiring: Wiring = WIRED, task: Any = None, **keys: Any) -> None:
        self.axes = [SimpleNamespace(motion=[0.0, 0.0], name=name) for name in "xz"]
        roles = SimpleNamespace(has_group=lambda group: group == "contact")
        self.probe: Any = SimpleNamespace(sources=self.axes, contacts=[], roles=roles)
        self.plant: Any = SimpleNamespace(probes={"tip": self.probe}, now_ns=0)
        tables = {"tip": PlantTable(fmu="own.fmu", **keys)}
        settings: Any = SimpleNamespace(
            rig=SimpleNamespace(plant=tables, axis=_axes(wiring), plc_task=task)
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


@pytest.mark.provokes(900072, 4, probe="tip", deflection_mm="0.4000", stroke_mm="0.3")
def test_a_probe_that_bore_a_touch_breaks_at_a_later_one() -> None:
    """Two touches within its stroke, then two beyond it: it breaks once."""
    bench = Bench(stroke_mm=STROKE_MM, breaks=True)
    for down_mm in (-0.1, -0.3, -0.4, -0.6):
        bench.cycle(0.0, 0.2)
        bench.cycle(0.0, 0.1)
        bench.cycle(0.0, down_mm, contact_mm=(0.0, 0.0))
    assert bench.ways_mm == pytest.approx([0.1, 0.3, 0.4, 0.6])
    assert [each.beyond_ns for each, _ in bench.log.of("tip")] == [None, None, 9 * MS, 12 * MS]
    (alarm,) = bench.alarms
    assert (alarm.id, alarm.values["deflection_mm"]) == (900072, "0.4000")
    words = [words for _, words in bench.log.of("tip")]
    assert words[:2] == ["", ""]
    assert words[2] == ("tip: deflected by 0.4000 mm, more than its stroke of 0.3 mm; it is broken")


def test_the_stroke_itself_is_borne() -> None:
    bench = Bench(stroke_mm=0.5, breaks=True)
    bench.approach()
    bench.cycle(0.0, -0.5, contact_mm=(0.0, 0.0))
    assert bench.ways_mm == [0.5]
    assert [words for _, words in bench.log.of("tip")] == [""]
    assert bench.alarms == []


def test_the_direction_is_that_in_which_the_axes_came() -> None:
    """Down along z, and sidewards within the cycle of the contact: 0.1 mm down."""
    bench = Bench()
    bench.approach()
    bench.cycle(0.3, -0.1, contact_mm=(0.0, 0.0))
    assert bench.ways_mm == pytest.approx([0.1])


def test_from_a_contact_at_rest_every_way_counts_and_no_block_is_blamed() -> None:
    """The workpiece came: 0.3 and 0.4 in any direction are 0.5 mm, and it is never back."""
    for to in ((0.3, 0.4), (-0.3, 0.4), (0.3, -0.4)):
        bench = Bench()
        for _ in range(2):
            bench.cycle(0.0, 0.0)
        bench.cycle(0.0, 0.0, contact_mm=(0.0, 0.0))
        bench.cycle(*to)
        bench.cycle(0.0, 0.0)
        bench.cycle(-to[0], -to[1] * 1.5)
        assert bench.ways_mm == pytest.approx([(0.09 + 0.36) ** 0.5])
        ((found, words),) = bench.log.of("tip")
        assert (found.block, found.axis, words) == (None, "", "")


def test_a_contact_in_the_first_cycle_has_the_direction_of_that_cycle() -> None:
    bench = Bench()
    bench.cycle(0.0, -0.2, contact_mm=(0.0, -0.1))
    assert bench.ways_mm == pytest.approx([0.1])
    bench.cycle(0.5, -0.3)  # sidewards it does not count
    assert bench.ways_mm == pytest.approx([0.2])


def test_who_is_back_at_the_contact_is_still_pressed_and_beyond_it_free() -> None:
    bench = Bench()
    bench.approach()
    bench.cycle(0.0, -0.1, contact_mm=(0.0, 0.0))
    bench.cycle(0.0, 0.0)
    bench.cycle(0.0, -0.3)  # no new contact: it never left
    assert bench.ways_mm == pytest.approx([0.3])
    bench.cycle(0.0, 0.001)
    bench.cycle(0.0, -0.9)
    assert bench.ways_mm == pytest.approx([0.3])


def test_each_probe_has_its_own_contacts_and_breaks_by_itself() -> None:
    bench = Bench(stroke_mm=STROKE_MM, breaks=True)
    roles = bench.probe.roles
    other: Any = SimpleNamespace(sources=bench.axes[1:], contacts=[], roles=roles)
    deaf = SimpleNamespace(has_group=lambda _group: False)
    bench.plant.probes |= {"other": other, "deaf": SimpleNamespace(roles=deaf)}
    bench.settings.rig.plant["other"] = PlantTable(fmu="own.fmu", stroke_mm=1.0, breaks=True)
    bench.log = DeflectionLog(bench.settings, bench.plant, MS)
    bench.approach()
    other.contacts.append(Contact(bench.plant.now_ns, {"z": 0.1}))
    bench.cycle(0.0, -0.35, contact_mm=(0.0, 0.0))
    assert [alarm.values["probe"] for alarm in bench.alarms] == ["tip"]
    bench.cycle(0.0, -1.0)
    assert [alarm.values["probe"] for alarm in bench.alarms] == ["tip", "other"]
    assert bench.ways_mm == pytest.approx([1.0])
    assert [each.mm for each, _ in bench.log.of("other")] == pytest.approx([1.1])


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


def test_a_probe_at_either_input_of_a_drive_is_one_that_measures() -> None:
    """At input 1 or 2, of the first axis or of the last, and with another probe at the other."""
    for wiring in (
        {"X": ("tip", None)}, {"X": (None, "tip")}, {"Z": ("tip", None)}, {"Z": (None, "tip")},
        {"X": ("tip", "other")}, {"X": ("other", "tip")},
        {"X": ("other", None), "Z": (None, "tip")},
    ):  # fmt: skip
        assert _driven(Bench(wiring=wiring)) != [""], wiring
    for wiring in ({}, {"X": ("other", None)}, {"X": (None, "other"), "Z": ("other", "other")}):
        assert _driven(Bench(wiring=wiring)) == [""], wiring


@pytest.mark.parametrize(
    ("inputs", "is_noted"),
    [({1: "tip"}, True), ({1: "other", 2: "tip"}, True), ({1: "other"}, False), ({}, False)],
)
def test_a_probe_at_an_input_of_the_plc_measures_too(
    inputs: dict[int, str], is_noted: bool
) -> None:
    bench = Bench(wiring={"X": (None, "other")}, task=_task(inputs))
    assert (_driven(bench) != [""]) is is_noted
    assert _driven(Bench(task=_task(inputs))) != [""]  # that at a drive still does


def test_a_task_without_inputs_reads_no_probe() -> None:
    assert _driven(Bench(wiring={}, task=SimpleNamespace(terminal=None))) == [""]
    assert _driven(Bench(task=SimpleNamespace(terminal=None))) != [""]


@pytest.mark.parametrize(
    ("to", "axis"),
    [((0.3, -0.4), "Z"), ((0.4, -0.3), "X"), ((-0.4, -0.3), "X"), ((-0.3, 0.4), "Z")],
)
def test_the_axis_that_leads_the_probe_farthest_is_named(
    to: tuple[float, float], axis: str
) -> None:
    """By the way, in whatever direction: 0.3 and 0.4 are 0.5 mm."""
    bench = Bench()
    bench.cycle(0.0, 0.0)
    bench.cycle(*to, contact_mm=(0.0, 0.0))
    ((_, words),) = bench.log.of("tip")
    assert words.startswith(f"tip: driven 0.5000 mm past its contact by axis {axis} in line 7,")


def test_an_axis_of_the_plant_that_no_rig_axis_moves_has_its_own_name() -> None:
    bench = Bench(wiring={"X": ("tip", None)})
    del bench.settings.rig.axis["Z"]
    bench.log = DeflectionLog(bench.settings, bench.plant, MS)
    assert "by axis z in line 7" in _driven(bench)[0]


def test_a_probe_that_any_of_its_axes_measures_with_is_not_driven() -> None:
    """X measures while Z moves."""
    for measuring in ("X", "Z", "XZ"):
        bench = Bench()
        bench.measuring.update(measuring)
        assert _driven(bench) == [""]


def test_arcs_and_straight_blocks_drive_a_probe_and_nothing_else_does() -> None:
    block = Block(7, 30, "N30")
    arc = ArcMove(block, {"Z": -1.0}, {}, {}, 1.0, 600.0)
    for begun, is_noted in (
        (arc, True), (LinearMove(block, {"Z": -1.0}, True, None), True),
        (Dwell(block, MS), False),
        (MeasuringRun(block, {"Z": 0.0}, ("Z",), ("Z",), 600.0, 1), False),
    ):  # fmt: skip
        bench = Bench()
        bench.begun = begun
        assert (_driven(bench) != [""]) is is_noted


def test_an_axis_beside_the_path_comes_before_the_block_of_the_path() -> None:
    """Also one that is not the first axis of the probe."""
    for axis in "XZ":
        bench = Bench()
        bench.beside[axis] = Block(9, 50, "[INDP_ASYN ..]")
        assert "in line 9, block N50" in _driven(bench)[0]


def test_a_way_is_uncertain_by_half_of_what_a_cycle_goes() -> None:
    """Down by 0.3 and 0.4 mm in a cycle: 0.25 mm; a slower cycle later on changes nothing less."""
    bench = Bench()
    bench.cycle(0.0, 0.0)
    bench.cycle(0.3, -0.4, contact_mm=(0.0, 0.0))
    ((found, _),) = bench.log.of("tip")
    assert (found.mm, found.doubt_mm) == pytest.approx((0.5, 0.25))
    bench.cycle(0.15, -0.2)  # on the way back
    assert (found.mm, found.doubt_mm) == pytest.approx((0.5, 0.25))
    bench.cycle(0.33, -0.44)
    assert (found.mm, found.doubt_mm) == pytest.approx((0.55, 0.15))


def test_each_contact_beyond_the_stroke_has_its_first_cycle() -> None:
    bench = Bench(stroke_mm=STROKE_MM)
    bench.approach()
    bench.cycle(0.0, -0.2, contact_mm=(0.0, 0.0))
    bench.cycle(0.0, -0.4)
    bench.cycle(0.0, -0.6)
    bench.cycle(0.0, 0.2)
    bench.cycle(0.0, 0.1)
    bench.cycle(0.0, -0.5, contact_mm=(0.0, 0.0))
    found = [each for each, _ in bench.log.of("tip")]
    assert [each.beyond_ns for each in found] == [4 * MS, 8 * MS]
    assert [each.mm for each in found] == pytest.approx([0.6, 0.5])
    assert [each.block for each in found] == [bench.begun.block] * 2
    assert bench.alarms == []


def test_a_sensor_that_reports_no_contact_is_not_followed() -> None:
    bench = Bench()
    roles = SimpleNamespace(has_group=lambda _group: False)
    bench.plant.probes["other"] = SimpleNamespace(sources=[], contacts=[], roles=roles)
    bench.log = DeflectionLog(bench.settings, bench.plant, MS)
    assert _driven(bench) != [""]
    with pytest.raises(KeyError):
        bench.log.of("other")


def test_a_run_a_switch_a_known_stroke_and_a_workpiece_that_comes_are_not_noted() -> None:
    runs = Bench()
    runs.measuring.add("Z")
    homing = Bench()
    homing.begun = None
    for bench in (runs, homing, Bench(wiring={}), Bench(stroke_mm=20.0)):
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
    bench.cycle(0.0, 0.1)
    bench.cycle(0.0, -0.4, contact_mm=(0.0, 0.0))
    assert [alarm.id for alarm in bench.alarms] == [900072]
    assert [words for _, words in bench.log.of("tip")] == [
        "tip: deflected by 0.5000 mm, more than its stroke of 0.3 mm; it is broken",
        "tip: deflected by 0.4000 mm, more than its stroke of 0.3 mm; it is broken",
    ]


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


@pytest.mark.parametrize(
    ("keys", "key", "has_contacts", "why"),
    [
        ("stroke_mm = 1", "stroke_mm", False, "plant probe: its FMU has no output contact_count"),
        ("breaks = true", "breaks", False, "plant probe: its FMU has no output contact_count"),
        ("breaks = true", "breaks", True, "plant probe: a probe that breaks has a stroke"),
        ("stroke_mm = 1\nbreaks = true", "stroke_mm", False, "plant probe: its FMU has no output"),
        ("stroke_mm = 1\nbreaks = true", "", True, ""),
        ("stroke_mm = 1", "", True, ""),
        ("breaks = false", "", False, ""),
    ],
)
def test_what_a_stroke_needs_is_named_at_its_key(
    rig_file: Write, settings_of: Read, keys: str, key: str, has_contacts: bool, why: str
) -> None:
    path = rig_file(("[plant.probe]\n", f"[plant.probe]\n{keys}\n"))
    settings = settings_of(path)
    probe: Any = SimpleNamespace(roles=SimpleNamespace(has_group=lambda _group: has_contacts))
    if not why:
        check_strokes(settings, {"probe": probe})
        return
    with pytest.raises(UserError, match=why) as caught:
        check_strokes(settings, {"probe": probe})
    assert path.read_text().splitlines()[(caught.value.line or 0) - 1].startswith(f"{key} = ")
    assert caught.value.file == str(path)
