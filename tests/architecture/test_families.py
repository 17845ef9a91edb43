"""Families of drives and what carries them: who may know whom (docs/architecture.md)."""

from collections.abc import Iterator

import pytest
from tests.architecture.sources import MODULES, imported_names, trees

from axisrig.bench.rig.reading import families as registry

KERNEL, DRIVES, PROFILES = "axisrig.kernel", "axisrig.kernel.drives", "axisrig.kernel.profiles"
DRIVE, BUS = "axisrig.bench.drive", "axisrig.bench.bus"
# A module, or a package with all in it -> what it may take of a package, and nothing else
MAY_TAKE = {
    # The bench's end of a drive is written without a look at the control's
    DRIVE: (KERNEL, ("axisrig.kernel.time", "axisrig.kernel.errors", PROFILES)),
    BUS: (KERNEL, ("axisrig.kernel.time", "axisrig.kernel.errors", PROFILES)),
    # Any drive, and what words mean, without a look at what carries them
    f"{DRIVE}.axis": (DRIVE, (f"{DRIVE}.axis",)),
    f"{DRIVE}.cia402": (DRIVE, (f"{DRIVE}.axis", f"{DRIVE}.cia402")),
    # The channel asks a drive, and knows no family
    f"{KERNEL}.channel": (
        DRIVES,
        (f"{DRIVES}.interface", f"{DRIVES}.carrier", f"{DRIVES}.power"),
    ),
    # Words have no behaviour
    PROFILES: (KERNEL, ("axisrig.kernel.errors", PROFILES)),
}
NOTHING_OF = {f"{DRIVE}.axis": BUS, f"{DRIVE}.cia402": BUS, f"{KERNEL}.channel": PROFILES}
# Folders of a family, in every room that has them
FAMILIES = ("canopen", "conventional", "encoder_terminal", "lightbus", "profidrive", "sercos")
ROOMS = (DRIVES, DRIVE, "axisrig.bench.rig", "axisrig.bench.machine")


def lies_in(name: str, package: str) -> bool:
    return f"{name}.".startswith(f"{package}.")


def imports_of(package: str) -> Iterator[tuple[str, str]]:
    """Each module of a package with the full name of each thing that it imports."""
    for module in MODULES:
        if lies_in(module, package):
            yield from ((module, name) for _, name in imported_names(trees()[module]))


def wrong_imports(package: str) -> list[str]:
    of, allowed = MAY_TAKE[package]
    return sorted(
        f"{module} imports {name}"
        for module, name in imports_of(package)
        if lies_in(name, of) and not any(lies_in(name, one) for one in allowed)
    )


@pytest.mark.parametrize("package", MAY_TAKE)
def test_rooms_of_drives_take_only_what_they_may(package: str) -> None:
    assert wrong_imports(package) == []


@pytest.mark.parametrize(("package", "stranger"), NOTHING_OF.items())
def test_what_is_no_business_of_a_room_is_not_imported(package: str, stranger: str) -> None:
    assert [pair for pair in imports_of(package) if lies_in(pair[1], stranger)] == []


def test_a_family_imports_no_other() -> None:
    folders = [f"{room}.{family}" for room in ROOMS for family in FAMILIES]
    for folder in folders:
        other = [f for f in folders if f.rpartition(".")[2] != folder.rpartition(".")[2]]
        assert [p for p in imports_of(folder) if any(lies_in(p[1], f) for f in other)] == []


def carriers_of(family: str) -> set[str]:
    """Folders of the carriers that the registry joins with a family, by their last name."""
    return {row.rig.split(".")[-2] for row in registry.FAMILIES if row.family == family}


def test_a_room_finds_its_families_by_the_registry() -> None:
    """Nothing of rig and machine imports the folder of a family, but what lies in it.

    A carrier that the registry joins with it takes its tables: it looks at all on its segments.
    """
    for room in ROOMS[2:]:
        for family in FAMILIES:
            folder = f"{room}.{family}"
            allowed = {f"{any_room}.{name}" for any_room in ROOMS for name in carriers_of(family)}
            inside = [
                pair
                for pair in imports_of(room)
                if lies_in(pair[1], folder)
                and not lies_in(pair[0], folder)
                and not any(lies_in(pair[0], one) for one in allowed)
            ]
            assert inside == [], folder


def test_each_row_of_the_registry_has_its_modules() -> None:
    """Tables follow from the family or the carrier, the rest from the carrier alone."""
    rows = registry.FAMILIES
    for row in rows:
        assert {row.drive, row.segment, row.rig, row.machine} <= set(MODULES)
        assert row.drive.split(".")[-2] in FAMILIES
    assert len({row.drive for row in rows}) == len({row.family for row in rows})
    assert len({(row.segment, row.rig, row.machine) for row in rows}) == len(
        {row.carrier for row in rows}
    )


def test_rooms_that_the_rules_name_exist() -> None:
    for package in (*MAY_TAKE, *NOTHING_OF):
        assert any(lies_in(module, package) for module in MODULES), package


def test_a_canopen_slave_has_one_home() -> None:
    """Whatever device is behind it: what listens to NMT and SDO is `CanopenSlave` alone."""
    listens = {
        f"axisrig.kernel.profiles.canopen.identifiers.{n}" for n in ("NMT_ID", "LSS_REQUEST_ID")
    }
    found = {module for module, name in imports_of(DRIVE) if name in listens}
    assert found == {f"{DRIVE}.canopen.slave"}
    foreign = ("canopen.LocalNode", "canopen.nmt")
    for room in (DRIVE, "axisrig.bench.machine"):
        assert [pair for pair in imports_of(room) if lies_in(pair[1], foreign[1])] == []
        for module in MODULES:
            if lies_in(module, room):
                assert foreign[0] not in MODULES[module].read_text(encoding="utf-8"), module
