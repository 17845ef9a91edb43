"""Notes and warnings about FMUs, before and after a run."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine import plants
from axisrig.bench.machine.plants import describe_plants, plant_warnings


class Slave(SimpleNamespace):
    """An FMU, which is itself and no other."""

    __hash__ = object.__hash__


def slave(name: str, messages: int = 0, version: str = "3.0") -> Any:
    lines = [SimpleNamespace(time_ns=1_500_000 * (n + 1), text=f"m{n}") for n in range(messages)]
    description = SimpleNamespace(fmiVersion=version)
    return Slave(name=name, messages=lines, description=description)


def test_edges_that_are_not_well_known_and_warnings_of_fmus_are_named(
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
    tables = {"z": "/x/own.fmu", "p": "Lib.Probe", "gap": "Lib.Gap", "q": "bare.fmu"}
    monkeypatch.setattr(
        plants, "simulated_plants",
        lambda _: {name: SimpleNamespace(fmu=fmu) for name, fmu in tables.items()},
    )  # fmt: skip
    plant: Any = SimpleNamespace(
        axes={"z": SimpleNamespace(slave=slave("z", version="2.0"))},
        probes={"p": SimpleNamespace(slave=slave("p")), "q": SimpleNamespace(slave=slave("q"))},
        distances={"gap": SimpleNamespace(slave=slave("gap"))},
        notes={"z": [], "p": [], "gap": ["no valid"], "q": []},
        remarks={"z": ["a"], "p": [], "gap": ["b"], "q": []},
    )  # fmt: skip
    assert describe_plants(None, plant) == [  # type: ignore[arg-type]
        "plant z (own.fmu, FMI 2.0) is an axis", "  a",
        "plant gap (Lib.Gap, FMI 3.0) is a distance sensor", "  no valid", "  b",
        "plant q (bare.fmu, FMI 3.0) is a probe",  # of the user, with nothing to say about it
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
