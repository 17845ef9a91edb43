"""What is said of plants before and after a run, and what a rig may not wire: with stand-ins."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine import plants
from axisrig.bench.machine.live import states
from axisrig.bench.machine.live.pipe import CAPACITY, Inlet, Outlet
from axisrig.bench.machine.plants import check_plants, describe_plants, plant_warnings
from axisrig.kernel.errors import UserError

# After a run


class Slave(SimpleNamespace):
    """An FMU, which is itself and no other."""

    __hash__ = object.__hash__


def slave(name: str, messages: int = 0, version: str = "3.0") -> Any:
    lines = [SimpleNamespace(time_ns=1_500_000 * (n + 1), text=f"m{n}") for n in range(messages)]
    description = SimpleNamespace(fmiVersion=version)
    return Slave(name=name, messages=lines, description=description)


def test_edges_that_are_not_well_known_and_warnings_of_fmus_are_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(plants, "WARNINGS_SHOWN_MAX", 2)
    both = slave("z", 4)
    plant: Any = SimpleNamespace(
        axes={
            "z": SimpleNamespace(slave=both),
            "y": SimpleNamespace(slave=both),
        },  # one FMU of two axes
        probes={
            "p": SimpleNamespace(slave=slave("p", 2), edge_uncertainty_ns=1.0),
            "q": SimpleNamespace(slave=slave("q"), edge_uncertainty_ns=250.5),
        },
        distances={"gap": SimpleNamespace(slave=slave("gap", 1))},
        notes={"z": [], "y": [], "p": ["no contact_z"], "q": [], "gap": []},
    )
    assert plant_warnings(plant) == [
        "plant q: edges are known to 250.5 ns",
        "plant z at 1.500000 ms: m0", "plant z at 3.000000 ms: m1", "plant z: 2 more messages",
        "plant p at 1.500000 ms: m0", "plant p at 3.000000 ms: m1",
        "plant gap at 1.500000 ms: m0",
    ]  # fmt: skip
    assert plants.lacking_notes(plant) == ["plant p: no contact_z"]


def test_foreign_fmus_are_described_and_others_where_something_is_missing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tables = {"z": "/x/own.fmu", "p": "Lib.Probe", "gap": "Lib.Gap"}
    monkeypatch.setattr(
        plants, "simulated_plants",
        lambda _: {name: SimpleNamespace(fmu=fmu) for name, fmu in tables.items()},
    )  # fmt: skip
    plant: Any = SimpleNamespace(
        axes={"z": SimpleNamespace(slave=slave("z", version="2.0"))},
        probes={"p": SimpleNamespace(slave=slave("p"))},
        distances={"gap": SimpleNamespace(slave=slave("gap"))},
        notes={"z": [], "p": [], "gap": ["no valid"]}, remarks={"z": ["a"], "p": [], "gap": ["b"]},
    )  # fmt: skip
    assert describe_plants(None, plant) == [  # type: ignore[arg-type]
        "plant z (own.fmu, FMI 2.0) is an axis", "  a",
        "plant gap (Lib.Gap, FMI 3.0) is a distance sensor", "  no valid", "  b",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("screw_m", "lead_mm", "is_own", "is_noted"),
    [
        (0.01, 10.0, True, False),
        (0.02, 10.0, True, True),
        (0.01, 10.000001, True, True),
        (0.02, 10.0, False, False),
        (None, 10.0, True, False),
    ],
)
def test_a_screw_that_is_not_that_of_the_drive_is_noted(
    screw_m: float | None, lead_mm: float, is_own: bool, is_noted: bool
) -> None:
    drive = SimpleNamespace(facts=lambda: SimpleNamespace(lead_mm=lead_mm))
    model = plants.MODELS[0] if is_own else "/x/own.fmu"
    rig = SimpleNamespace(
        axis={"Z": SimpleNamespace(plant="z", drive="servo")}, drive={"servo": drive},
        plant={"z": SimpleNamespace(fmu=model)},
    )  # fmt: skip
    known = {} if screw_m is None else {"screw_lead": screw_m}
    one = SimpleNamespace(has=known.__contains__, get=known.__getitem__)
    plant: Any = SimpleNamespace(axes={"z": SimpleNamespace(slave=one)}, notes={"z": []})
    plants._compare_leads(SimpleNamespace(rig=rig), plant, "Z")  # type: ignore[arg-type]
    assert bool(plant.notes["z"]) is is_noted


def test_a_note_about_contacts_is_needless_for_a_switch_alone() -> None:
    def needless(note: str, *wired: tuple[str, str]) -> bool:
        axis = SimpleNamespace(signals=dict(wired))
        settings: Any = SimpleNamespace(rig=SimpleNamespace(axis={"Z": axis}))
        return plants._is_needless(settings, "s", note)

    about = "no contact_z: nothing is known of contacts"
    assert needless(about, ("home", "s"))
    assert not needless(about, ("home", "s"), ("probe_1", "s"))
    assert not needless(about, ("home", "other"))
    assert not needless("no signal", ("home", "s"))


# What a rig may not wire


def rig(tmp_path: Path, **changes: Any) -> Any:
    path = tmp_path / "r.toml"
    path.write_text("[axis.Z]\nplant = 'z'\n", encoding="utf-8")
    axis = {"plant": "z", "signals": {}, "encoder_2": None}
    axis |= {key: value for key, value in changes.items() if key in axis}
    own = SimpleNamespace(
        axis={"Z": SimpleNamespace(**axis)}, plc=changes.get("plc", {}),
        plc_task=changes.get("task"),
    )  # fmt: skip
    return SimpleNamespace(rig=own, files=[path])


def probe(can_be_switched: bool = True) -> Any:
    return SimpleNamespace(can_be_switched=lambda: can_be_switched)


PLANT: Any = SimpleNamespace(
    axes={"z": None}, probes={"p": probe(), "fixed": probe(False)}, distances={"gap": None}
)


def task(switches: str | None = None, **inputs: str) -> Any:
    wired = {int(key[-1]): name for key, name in inputs.items()}
    return SimpleNamespace(terminal=SimpleNamespace(inputs=wired), switches=switches)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, None),
        ({"plant": "p"}, "axis Z: plant must name an axis plant of this rig"),
        ({"signals": {"probe_1": "p", "home": "fixed"}}, None),
        ({"signals": {"probe_1": "p", "probe_2": "gap"}}, "axis Z: probe_2 must name a probe"),
        ({"encoder_2": "gap"}, None),
        ({"encoder_2": plants.LOAD}, None),
        ({"encoder_2": "z"}, "axis Z: encoder_2 must name a distance sensor"),
        ({"plc": {"V.E.S": SimpleNamespace(sensor="gap")}}, None),
        ({"plc": {"V.E.S": SimpleNamespace(sensor="p")}}, "V.E.S: sensor must name a distance"),
        ({"task": task(input_1="p", input_2="fixed")}, None),
        ({"task": task(input_2="gap")}, "plc.terminal.input_2 must name a probe or a switch"),
        ({"task": task(switches="p")}, None),
        ({"task": task(switches="fixed")}, "plc.switches must name a probe that can be switched"),
        ({"task": task(switches="gap")}, "plc.switches must name a probe that can be switched"),
        ({"task": SimpleNamespace(terminal=None, switches=None)}, None),
    ],
)
def test_what_is_wired_is_of_its_kind(
    tmp_path: Path, changes: dict[str, Any], words: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plants, "check_strokes", lambda *_: None)
    monkeypatch.setattr(plants, "outside_axes", lambda _: frozenset())
    settings = rig(tmp_path, **changes)
    if words is None:
        check_plants(settings, PLANT)
        return
    with pytest.raises(UserError) as caught:
        check_plants(settings, PLANT)
    assert caught.value.message.startswith(words)
    assert caught.value.file == str(tmp_path / "r.toml")
    if "plc" not in words and "V.E." not in words:
        monkeypatch.setattr(plants, "outside_axes", lambda _: frozenset({"Z"}))
        check_plants(settings, PLANT)  # nothing of an axis outside is simulated


# A running machine


@pytest.mark.parametrize(
    ("has_latched", "is_armed", "is_probing", "word"),
    [(True, True, True, "edge stored"), (False, True, True, "armed"),
     (False, False, True, "ordered"), (False, False, False, "off")],
)  # fmt: skip
def test_a_touch_probe_is_told_by_the_farthest_that_it_has_come(
    has_latched: bool, is_armed: bool, is_probing: bool, word: str
) -> None:
    link: Any = SimpleNamespace(has_latched=has_latched, is_armed=is_armed, is_probing=is_probing)
    assert states._touch_probe(link) == word


def test_the_last_run_of_an_axis_that_has_a_value_counts() -> None:
    def run(block: str, at_ns: int | None, **latched: float) -> Any:
        return SimpleNamespace(block=block, signal_ns=at_ns, end_ns=99, latched_mm=latched)

    records = [run("N10", 5, Z=1.0), run("N20", 6, Z=2.0, X=3.0), run("N30", None, Y=4.0)]
    machine: Any = SimpleNamespace(channel=SimpleNamespace(records=records))
    assert states._last_latch(machine, "Z") == {"position": 2.0, "block": "N20", "time_ns": 6}
    assert states._last_latch(machine, "Y") == {"position": 4.0, "block": "N30", "time_ns": 99}
    assert states._last_latch(machine, "W") is None
    many = [run("N1", 1, Z=0.5), *(run("N2", 2) for _ in range(states._RUNS_LOOKED_AT))]
    machine.channel.records = many
    assert states._last_latch(machine, "Z") is None
    machine.channel.records = many[:-1]
    assert states._last_latch(machine, "Z") is not None


def test_a_distance_control_is_told_with_its_own_set_value(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(states, "is_rotary", lambda _settings, name: name in ("C", "channel"))
    monkeypatch.setattr(states, "source_word", lambda sensor: f"of {sensor}")
    control = SimpleNamespace(
        state=states.DistanceState.ACTIVE_CONST_DIST, source=SimpleNamespace(name="PLC"),
        is_dry_run=True, settings=SimpleNamespace(sensor_sign=-1.0), distance_mm=2.0,
        set_dist_mm=3.0, set_pos_mm=4.0, filtered_mm=5.0, error_mm=6.0, offset_mm=7.0,
    )  # fmt: skip
    found: Any = SimpleNamespace(control=control, sensor_mm=1.5, sensor="s", is_held=False)
    machine: Any = SimpleNamespace(settings=None)
    shown = states._distance(machine, "C", found)
    assert shown == {
        "axis": "C", "unit": "°", "state": "active const dist", "source": "PLC", "sensor": "of s",
        "is_held": False, "is_dry_run": True, "reading": -1.5, "distance": 2.0,
        "set_name": "SET_DIST", "set": 3.0, "filtered": 5.0, "error": 6.0, "offset": 7.0,
    }  # fmt: skip
    control.state, found.sensor_mm = states.DistanceState.ACTIVE, None
    before = states._distance(machine, "Z", found)
    assert (before["set_name"], before["set"], before["state"]) == ("SET_POS", 4.0, "active")
    assert (before["reading"], before["distance"], before["unit"]) == (None, None, "mm")
    assert states._distance(machine, "channel", found)["unit"] == "mm"  # of a tool


def test_a_state_may_fill_the_pipe(tmp_path: Path) -> None:
    inlet = Inlet(tmp_path / "pipe")
    outlet = Outlet(tmp_path / "pipe")
    for size, is_there in ((CAPACITY, True), (CAPACITY + 1, False), (0, True)):
        inlet.ask()
        assert outlet.is_asked
        outlet.put(b"x" * size)
        assert not outlet.is_asked
        found = inlet.take()
        assert found == (b"x" * size if is_there else None)
        assert inlet.take() is None
    inlet.close()
