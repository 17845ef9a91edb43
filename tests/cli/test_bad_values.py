"""Assignments and plant FMUs that cannot be used, and what is said about them."""

import re
import shutil
import zipfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest

from axisrig.fmus import ensure_built

Outcome = tuple[int, str, str]
Call = Callable[..., Outcome]
Reject = Callable[..., str]

FEED = ("--set", "plc:V.E.FEED=3000")


def _table(names: str, rows: Iterable[Any], *, named: bool = False) -> pytest.MarkDecorator:
    """Make the cases of a table whose rows begin with their name; named: the test takes it too."""
    return pytest.mark.parametrize(
        names.split(),
        [
            pytest.param(
                *(row if named else row[1:]),
                id=row[0][:40] or "empty",
            )
            for row in rows
        ],
    )


def _holds(message: str, *fragments: str) -> None:
    for fragment in fragments:
        assert fragment in message, message


# ---- --set

ASSIGNMENTS = [
    ("", ["equals sign"]),
    ("=", ["equals sign"]),
    ("set:Z.kenngr.messachse", ["equals sign"]),
    ("set:Z.kenngr.messachse=", ["equals sign"]),
    ("=3", ["not an input column", "set:<axis>.<path>"]),
    ("title=x", ["not an input column", "'title'", "plant:<instance>.<variable>"]),
    ("check:alarms=none", ["not an input column"]),
    ("set:Z=1", ["not an input column", "'set:Z'"]),
    ("set:Q.kenngr.messachse=1", ["'Q'", "allowed: channel, Z"]),
    ("set:Z.kenngr.messachs=1", ["nearest names: kenngr.messachse"]),
    ("set:Z.kenngr.messachse=7", ["P-AXIS-00118", "'7'", "allowed: 0 .. 1"]),
    ("set:channel.messtyp=8", ["P-CHAN-00057", "'8'", "allowed: 1 .. 7"]),
    ("set:Z.kenngr.measure.edge=UP", ["'UP'", "allowed: POS, NEG"]),
    ("plant:q.kv=1", ["'q'", "allowed: z, probe"]),
    ("plant:z.kvv=1", ["'kvv'", "did you mean: kv"]),
    ("plant:z.kv=fast", ["not a number", "'fast'"]),
    ("plant:z.kv=40,5", ["not a number", "'40,5'"]),
    ("plant:z.kv=1=2", ["not a number", "'1=2'"]),
    ("plant:z.kv=nan", ["nan"]),
    ("plant:z.kv=inf", ["inf"]),
    ("plant:z.kv=sNaN", ["sNaN"]),
    ("plant:z.kv=1_0", ["1_0"]),
    ("plant:z.kv=-1", ["kv", "-1"]),
    ("plant:z.kv_mm=1", ["another unit", "'mm'"]),
    ("plant:probe.surface_mm=", ["equals sign"]),
    ("plant:probe.surface_mm=1e999999999999", ["number"]),
    ("plant:probe.inverted=2", ["allowed: true, false"]),
    ("plant:z.stop_direction=0.5", ["whole number", "0.5"]),
    ("plant:probe.inverted_mm=1", ["inverted"]),
    ("plant:probe.signal=1", ["can be set"]),
    ("bus:can9.bitrate=125000", ["'can9'", "allowed: can1"]),
    ("bus:can1.speed=125000", ["'speed'", "bitrate"]),
    ("bus:can1.bitrate=fast", ["125000", "'fast'"]),
    (f"bus:can1.bitrate={'9' * 5000}", ["125000"]),
    ("plc:FEED=1", ["V.E.<NAME>"]),
    ("plc:V.E.=1", ["no name"]),
    ("plc:V.E.FEED=nan", ["not a number"]),
    ("plc:V.E.FEED=-inf", ["not a number"]),
    ("plc:V.E.FEED=1_500", ["not a number"]),
    ("plc:V.E.FEED=１５", ["not a number"]),
    ("fault:drop=Z", ["'Z'", "allowed: Z.TPDO1"]),
    ("fault:drop=Z.TPDO2,Z.TPDO1", ["no such telegram"]),
    ("fault:drip=Z.TPDO1", ["'drip'", "did you mean: drop"]),
]


@_table("text fragments", ASSIGNMENTS, named=True)
def test_assignment_is_rejected(
    place: Path, rejected: Reject, text: str, fragments: list[str]
) -> None:
    _holds(rejected("nc", "part.nc", "--rig", "rig.toml", *FEED, "--set", text), *fragments)


def test_external_variable_that_nobody_gives(place: Path, rejected: Reject) -> None:
    message = rejected("nc", "part.nc", "--rig", "rig.toml")
    _holds(message, "part.nc:2:17:", "'V.E.FEED'")


def test_external_variable_that_nothing_reads(place: Path, rejected: Reject) -> None:
    message = rejected("nc", "part.nc", "--rig", "rig.toml", "--set", "plc:V.E.FED=1")
    _holds(message, "--set plc:V.E.FED is not used", "did you mean V.E.FEED")


def test_message_does_not_repeat_a_value_of_any_length(place: Path, rejected: Reject) -> None:
    message = rejected("nc", "part.nc", "--rig", "rig.toml", "--set", f"{'x' * 50_000}=1")
    assert len(message) < 1000


# ---- FMUs: copies of the built axis, each with one thing spoilt

AXIS_MODEL = "AxisRig.Drives.ServoAxis"
Names = Callable[[str], str]
Texts = Callable[[str], str]


def _spoilt(place: Path, *, names: Names = str, description: Texts | None = None) -> None:
    """Write `place/own.fmu`; names: new name of each file, empty leaves it out."""
    with (
        zipfile.ZipFile(ensure_built(AXIS_MODEL)) as built,
        zipfile.ZipFile(place / "own.fmu", "w") as own,
    ):
        for item in built.namelist():
            content = built.read(item)
            if item == "modelDescription.xml" and description is not None:
                content = description(content.decode()).encode()
            if names(item):
                own.writestr(names(item), content)


def _use_own(place: Path) -> None:
    text = (place / "rig.toml").read_text(encoding="utf-8")
    (place / "rig.toml").write_text(text.replace(AXIS_MODEL, "own.fmu"), encoding="utf-8")


@pytest.mark.long
def test_copy_of_the_built_fmu_runs(place: Path, axisrig: Call) -> None:
    shutil.copy(ensure_built(AXIS_MODEL), place / "own.fmu")
    _use_own(place)
    code, out, err = axisrig("nc", "part.nc", "--rig", "rig.toml", *FEED)
    assert (code, out, err) == (0, "V.A.MERF.Z=1\n", "")


def _elsewhere(name: str) -> str:
    return re.sub("binaries/[^/]+", "binaries/riscv64-plan9", name)


FMUS: list[tuple[str, Names, Texts | None, list[str]]] = [
    ("other platform", _elsewhere, None, ["no binary for this platform", "riscv64-plan9"]),
    ("no binary", lambda n: "" if "binaries" in n else n, None, ["no binary", "'none'"]),
    ("binary with another name", lambda n: n.replace(".so", "x.so"), None, ["cannot be loaded"]),
    ("no description", lambda n: n if "/" in n else "", None, ["modelDescription.xml"]),
    ("description cut", str, lambda t: t[: len(t) // 2], ["model description", "line"]),
    ("empty description", str, lambda _: "", ["model description"]),
    ("another FMI version", str, lambda t: t.replace('"3.0"', '"9.0"'), ["9.0"]),
    (
        "model exchange",
        str,
        lambda t: t.replace("CoSimulation", "ModelExchange"),
        ["co-simulation"],
    ),
    (
        "token of another model",
        str,
        lambda t: re.sub('instantiationToken="[^"]*"', 'instantiationToken="x"', t),
        ["instantiation token"],
    ),
    (
        "no position",
        str,
        lambda t: t.replace('"position"', '"place"'),
        ["rig.toml:26", "an axis nor a sensor"],
    ),
    (
        "neither axis nor sensor",
        str,
        lambda t: t.replace('"reference_end"', '"reference_stop"'),
        ["rig.toml:26", "neither an axis nor a sensor", "docs/rigs.md"],
    ),
    (
        "a name twice",
        str,
        lambda t: t.replace('"motor_velocity"', '"motor_position"'),
        ["motor_position", "not unique"],
    ),
]


@pytest.mark.long
@_table("names description fragments", FMUS)
def test_fmu_is_rejected(
    place: Path, rejected: Reject, names: Names, description: Texts | None, fragments: list[str]
) -> None:
    _spoilt(place, names=names, description=description)
    _use_own(place)
    message = rejected("nc", "part.nc", "--rig", "rig.toml", *FEED)
    _holds(message, *fragments)
    assert "own.fmu" in message
    assert Path.cwd() == place


FMI_2 = (
    '<?xml version="1.0"?><fmiModelDescription fmiVersion="2.0" modelName="m" guid="g">'
    '<CoSimulation modelIdentifier="m"/><ModelVariables>'
    '<ScalarVariable name="a" valueReference="0"><Real/></ScalarVariable></ModelVariables>'
    "<ModelStructure/></fmiModelDescription>"
)

FMI_1 = (
    '<?xml version="1.0"?><fmiModelDescription fmiVersion="1.0" modelName="m" guid="g" '
    'modelIdentifier="m" numberOfContinuousStates="0" numberOfEventIndicators="0">'
    "<ModelVariables/><Implementation><CoSimulation_StandAlone><Capabilities/>"
    "</CoSimulation_StandAlone></Implementation></fmiModelDescription>"
)


@pytest.mark.long
def test_fmus_of_other_versions_and_files_that_are_no_fmu(place: Path, rejected: Reject) -> None:
    _use_own(place)
    own = place / "own.fmu"
    with zipfile.ZipFile(own, "w") as archive:
        archive.writestr("modelDescription.xml", FMI_2)
    message = rejected("nc", "part.nc", "--rig", "rig.toml", *FEED)
    _holds(message, "own.fmu", "no binary for this platform", "'none'")
    with zipfile.ZipFile(own, "w") as archive:
        archive.writestr("modelDescription.xml", FMI_1)
    message = rejected("nc", "part.nc", "--rig", "rig.toml", *FEED)
    _holds(message, "own.fmu", "'1.0'", "allowed: 2.0, 3.0")
    built = ensure_built(AXIS_MODEL).read_bytes()
    for content in (b"", b"text", built[: len(built) // 2]):
        own.write_bytes(content)
        _holds(rejected("nc", "part.nc", "--rig", "rig.toml", *FEED), "own.fmu", "no FMU", "zip")
    damaged = bytearray(built)
    damaged[200:-2000:97] = bytes(byte ^ 0xFF for byte in damaged[200:-2000:97])
    own.write_bytes(bytes(damaged))
    _holds(rejected("nc", "part.nc", "--rig", "rig.toml", *FEED), "own.fmu")
    own.unlink()
    own.mkdir()
    _holds(rejected("nc", "part.nc", "--rig", "rig.toml", *FEED), "own.fmu")
