"""The model identifier of an FMU is part of the path of its library: a C name, nothing else."""

import zipfile
from pathlib import Path

import pytest

from axisrig.kernel.cosim.fmi.fmu import load_description
from axisrig.kernel.errors import UserError

INTERFACE = '<CoSimulation modelIdentifier="{}"/>'


def packed(
    folder: Path,
    identifier: str = "axis",
    version: str = "3.0",
    interface: str = INTERFACE,
    binaries: tuple[str, ...] = (),
) -> Path:
    """Write an FMU without variables."""
    token = "guid" if version.startswith("2") else "instantiationToken"
    path = folder / "one.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(
            "modelDescription.xml",
            f'<?xml version="1.0"?><fmiModelDescription fmiVersion="{version}" modelName="M"'
            f' {token}="t">{interface.format(identifier)}<ModelVariables/><ModelStructure/>'
            "</fmiModelDescription>",
        )
        for name in binaries:
            archive.writestr(f"binaries/{name}/axis.so", b"no library")
    return path


def refused(path: Path) -> UserError:
    with pytest.raises(UserError) as caught:
        load_description(path)
    assert caught.value.file == str(path)
    return caught.value


@pytest.mark.parametrize("version", ["2.0", "3.0"])
@pytest.mark.parametrize(
    "identifier",
    [
        "a/../b",
        "../b",
        "a.b",
        "a b",
        "a-b",
        "a\\b",
        "1a",
        "",
        "a\u00e4",
        "\u00e4",
        "a/",
        ".",
        "a:b",
    ],
)
def test_an_identifier_that_is_no_c_name_is_refused(
    tmp_path: Path, identifier: str, version: str
) -> None:
    """Also where its begin is one: `a/../b` would be another file."""
    error = refused(packed(tmp_path, identifier, version))
    assert error.message == "the model identifier is no C name"
    assert error.value == identifier
    assert error.allowed == "[A-Za-z_]\\w*"


@pytest.mark.parametrize("version", ["2.0", "3.0"])
@pytest.mark.parametrize("identifier", ["a", "_", "_1", "Axis_2", "a" * 200])
def test_a_c_name_is_taken(tmp_path: Path, identifier: str, version: str) -> None:
    error = refused(packed(tmp_path, identifier, version))
    assert error.message.startswith("the FMU has no binary for this platform")


@pytest.mark.parametrize(
    ("binaries", "value"),
    [((), "none"), (("riscv9-plan9",), "riscv9-plan9"),
     (("zz-odd", "riscv9-plan9"), "riscv9-plan9 zz-odd")],
)  # fmt: skip
def test_platforms_that_an_fmu_has_are_named_where_this_one_is_missing(
    tmp_path: Path, binaries: tuple[str, ...], value: str
) -> None:
    error = refused(packed(tmp_path, binaries=binaries))
    assert error.message.startswith("the FMU has no binary for this platform (")
    assert (error.value, error.hint) == (value, "build the FMU for this platform")


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_a_model_without_its_solver_is_refused(tmp_path: Path, version: str) -> None:
    exchange = '<ModelExchange modelIdentifier="{}"/>'
    error = refused(packed(tmp_path, version=version, interface=exchange))
    assert error.message == "the FMU has no co-simulation interface"
    assert error.hint is not None
    assert error.hint.startswith("export it for co-simulation")


def test_an_fmu_with_both_interfaces_is_taken_by_that_of_its_co_simulation(tmp_path: Path) -> None:
    both = '<ModelExchange modelIdentifier="a/b"/>' + INTERFACE
    error = refused(packed(tmp_path, version="3.0", interface=both))
    assert error.message.startswith("the FMU has no binary")
    both = '<ModelExchange modelIdentifier="axis"/><CoSimulation modelIdentifier="a/b"/>'
    assert refused(packed(tmp_path, interface=both)).value == "a/b"
