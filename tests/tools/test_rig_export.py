"""A rig as an SSP package: what is in it, and what foreign masters make of it."""

import zipfile
from pathlib import Path

import fmpy
import fmpy.ssp.simulation as foreign
import pytest
from fmpy.ssp.ssd import read_ssd, read_ssv
from typer.testing import CliRunner

from axisrig.bench.cli.main import app
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.rig_export.package import export_rig
from axisrig.bench.tools.rig_export.parts import parts_of
from axisrig.fmus import ensure_built
from axisrig.kernel.cosim.fmi.fmu import load_fmu
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "testplans" / "rigs"
PROBE_Z = RIGS / "probe-z.toml"
SPAN_S, STEP_S, FEED = 0.7, 1e-3, -0.05
PLACE_M, EDGE_S = 1e-12, 2e-9


@pytest.fixture(scope="session")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package of the rig with one axis and a probe."""
    target = tmp_path_factory.mktemp("ssp") / "probe-z.ssp"
    export_rig(settings_of(PROBE_Z, []), target, "2.0")
    return target


@pytest.fixture(scope="session")
def bench() -> tuple[float, float]:
    """Place after the span and instant of the edge, as the bench steps axis and probe."""
    plant = Plant(20 * MS)
    starts = {
        "AxisRig.Drives.ServoAxis": {"position_start": 0.13, "kv": 40.0}
        | dict.fromkeys(("coulomb_friction", "breakaway_friction"), 0.0),
        "AxisRig.Sensors.TouchProbe": {"surface": 0.1},
    }
    axis, probe = (
        load_fmu(ensure_built(m), n) for m, n in zip(starts, ("z", "probe"), strict=True)
    )
    for slave, start in zip((axis, probe), starts.values(), strict=True):
        for key, value in start.items():
            slave.set_start(key, value)
    try:
        plant.add_axis(axis)
        plant.add_probe(probe, {"z": "z"})
        plant.initialize(0)
        plant.axes["z"].command(0, 0.13, FEED, 1000 * 1000 * MS, True)
        for number in range(round(SPAN_S / STEP_S)):
            plant.advance_to((number + 1) * MS)
        return plant.axes["z"].position_m(), plant.probes["probe"].signal.edges[0][0] * 1e-9
    finally:
        plant.close()


def inputs() -> dict[str, float]:
    return {
        "z_reference_position": 0.13,
        "z_reference_velocity": FEED,
        "z_reference_end": 1e3,
    }


@pytest.mark.long
def test_the_package_is_valid_and_has_the_values_of_the_rig(package: Path) -> None:
    """fmpy checks structure and values by the schemas of SSP 1.0, and the FMU by that of FMI."""
    system = read_ssd(str(package)).system
    (component,) = system.elements
    assert (component.name, component.source) == ("z", "resources/z.fmu")
    kinds = {connector.name: connector.kind for connector in component.connectors}
    assert kinds["z_reference_position"] == "input"
    assert kinds["probe_rising_count"] == "output"
    assert not {name for name in kinds if "x_start" in name or "step_time" in name}
    values = read_ssv(str(package), "resources/z.ssv").parameters
    assert {parameter.name: float(parameter.value) for parameter in values} == {
        "z.position_start": 0.13,
        "z.kv": 40.0,
        "z.coulomb_friction": 0.0,
        "z.breakaway_friction": 0.0,
        "probe.surface": 0.1,
    }
    with zipfile.ZipFile(package) as archive:
        archive.extract("resources/z.fmu", package.parent)
    description = fmpy.read_model_description(str(package.parent / "resources/z.fmu"))
    variables = {variable.name for variable in description.modelVariables}
    assert set(kinds) <= variables
    assert {parameter.name for parameter in values} <= variables


@pytest.fixture(scope="session")
def own_package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same with an axis of a model of its own, which uses another one beside it."""
    folder = tmp_path_factory.mktemp("own")
    text = PROBE_Z.read_text(encoding="utf-8").replace('"lists/', f'"{RIGS.as_posix()}/lists/')
    rig = folder / "own-z.toml"
    rig.write_text(text.replace("AxisRig.Drives.ServoAxis", "MyAxis.mo"), encoding="utf-8")
    own = "model MyAxis import AxisRig; extends MyBase; end MyAxis;\n"
    (folder / "MyAxis.mo").write_text(own, encoding="utf-8")
    base = "model MyBase extends AxisRig.Drives.ServoAxis(kv = 30); end MyBase;\n"
    (folder / "MyBase.mo").write_text(base, encoding="utf-8")
    export_rig(settings_of(rig, []), folder / "own-z.ssp", "2.0")
    return folder / "own-z.ssp"


@pytest.mark.long
@pytest.mark.parametrize("which", ["package", "own_package"])
def test_fmpy_as_master_gets_what_the_bench_gets(
    request: pytest.FixtureRequest, which: str, bench
) -> None:
    package = request.getfixturevalue(which)
    component = read_ssd(str(package)).system.elements[0]
    values = read_ssv(str(package), "resources/z.ssv")
    folder = package.parent / "unpacked"
    with zipfile.ZipFile(package) as archive:
        archive.extractall(folder)
    for parameter in values.parameters:  # fmpy wants the name of the component before each
        parameter.name = f"{component.name}.{parameter.name}"
    foreign.instantiate_fmu(component, str(folder), 0.0, parameter_set=values)
    for name, value in inputs().items():
        foreign.set_value(component, name, value)
    foreign.set_value(component, "z_enabled", True)
    for number in range(round(SPAN_S / STEP_S)):
        component.fmu.doStep(number * STEP_S, STEP_S)
    place, edge = bench
    assert foreign.get_value(component, "z_position") == pytest.approx(place, abs=PLACE_M)
    assert foreign.get_value(component, "probe_rising_time") == pytest.approx(edge, abs=EDGE_S)
    assert foreign.get_value(component, "probe_rising_count") == 1
    foreign.free_fmu(component)


@pytest.mark.long
def test_ecos_as_master_gets_what_the_bench_gets(package: Path, bench) -> None:
    ecospy = pytest.importorskip("ecospy", reason="ecos is not installed: pip install ecospy")
    simulation = ecospy.EcosSimulation(step_size=STEP_S, ssp_path=str(package))
    simulation.init(parameter_set=PROBE_Z.stem)
    for name, value in inputs().items():
        simulation.set_real(f"z::{name}", value)
    simulation.set_bool("z::z_enabled", True)
    simulation.step(round(SPAN_S / STEP_S))
    place, edge = bench
    assert simulation.get_real("z::z_position") == pytest.approx(place, abs=PLACE_M)
    assert simulation.get_real("z::probe_rising_time") == pytest.approx(edge, abs=EDGE_S)
    assert simulation.get_integer("z::probe_rising_count") == 1
    simulation.terminate()
    simulation.free()


@pytest.mark.long
def test_libcosim_as_master_gets_what_the_bench_gets(package: Path, bench) -> None:
    reason = "libcosim is not installed: pip install libcosimpy"
    execution_of = pytest.importorskip("libcosimpy.CosimExecution", reason=reason).CosimExecution
    manipulator_of = pytest.importorskip("libcosimpy.CosimManipulator").CosimManipulator
    observer_of = pytest.importorskip("libcosimpy.CosimObserver").CosimObserver
    execution = execution_of.from_ssp_file(str(package), round(STEP_S * 1e9))
    slave = execution.slave_index_from_instance_name("z")
    known = {v.name.decode(): v.reference for v in execution.slave_variables(slave)}
    override, observer = manipulator_of.create_override(), observer_of.create_last_value()
    execution.add_manipulator(override)
    execution.add_observer(observer)
    override.slave_real_values(slave, [known[n] for n in inputs()], list(inputs().values()))
    override.slave_boolean_values(slave, [known["z_enabled"]], [True])
    for _ in range(round(SPAN_S / STEP_S)):
        execution.step()
    wanted = [known[name] for name in ("z_position", "probe_rising_time")]
    place, edge = bench
    found = observer.last_real_values(slave, wanted)
    assert found[0] == pytest.approx(place, abs=PLACE_M)
    assert found[1] == pytest.approx(edge, abs=EDGE_S)
    assert observer.last_integer_values(slave, [known["probe_rising_count"]]) == [1]


@pytest.mark.long
def test_sensors_and_their_axes_are_one_fmu() -> None:
    """Three axes with one probe, an axis with three switches and a scale, axes alone."""
    (one,) = parts_of(settings_of(RIGS / "probe-xyz.toml", []))
    assert one.plants == ("x", "y", "z", "probe")
    assert "  probe.y_end = y.position;" in one.text
    assert 'returns_early = "probe_signal"' in one.text
    (homing,) = parts_of(settings_of(RIGS / "homing-z.toml", []))
    assert homing.plants == ("z", "negative", "positive", "home", "scale")
    assert "  scale.x_rate_start = z.velocity;" in homing.text
    alone = parts_of(settings_of(RIGS / "fixed-stop-xy.toml", []))
    assert [part.model for part in alone] == ["AxisRig.Drives.ServoAxis"] * 2
    assert [part.name for part in alone] == ["x", "y"]
    shared = parts_of(settings_of(RIGS / "gantry-pair.toml", []))
    assert "  probe.x_start = x.position_1;" in shared[0].text


# A sensor or a probe on rotary axes
TILTED = [p.stem for w in ("distance-5", "distance-r", "probe-5") for p in RIGS.glob(f"{w}*.toml")]
REFUSED = ("distance-z-probe", "probe-z-akd", *TILTED)  # a touch probe on KinematicAxis


@pytest.mark.long(but=1)
@pytest.mark.parametrize(
    "rig",
    [rig for rig in sorted(RIGS.glob("*.toml")) if rig.stem not in REFUSED],
    ids=lambda path: path.stem,
)
def test_every_shipped_rig_becomes_parts(rig: Path) -> None:
    parts = parts_of(settings_of(rig, []))
    plants = [plant for part in parts for plant in part.plants]
    assert sorted(plants) == sorted(set(plants))
    for part in parts:
        names = [port.name for port in part.ports]
        assert len(names) == len(set(names))
        assert not [name for name in names if name.endswith(("step_time", "rate_end"))]


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (
            '"AxisRig.Drives.ServoAxis"',
            '"table.fmu"',
            r"plant z: table\.fmu is no \.mo and not of the lib",
        ),
        ('{ z = "z" }', '{ z = "y" }', "plant probe is wired to y, which is not simulated here"),
        ("AxisRig.Drives.ServoAxis", "AxisRig.Drives.RotaryAxis", "wired to z, a rotary axis"),
        ("AxisRig.Drives.ServoAxis", "AxisRig.Drives.KinematicAxis", "no touch probe on z, a Kin"),
    ],
)
def test_what_cannot_be_exported_is_said(before, after, words, tmp_path: Path) -> None:
    text = PROBE_Z.read_text(encoding="utf-8").replace('"lists/', f'"{RIGS.as_posix()}/lists/')
    rig = tmp_path / "rig.toml"
    rig.write_text(text.replace(before, after), encoding="utf-8")
    with pytest.raises(UserError, match=words):
        parts_of(settings_of(rig, []))


@pytest.mark.parametrize("rig", TILTED)
def test_a_sensor_that_reads_angles_is_refused(rig: str) -> None:
    """Its map makes rad of the degrees of the rig, which a package cannot hold."""
    with pytest.raises(UserError, match=r"plant (gap|probe) is wired to (c|j1), a rotary axis"):
        parts_of(settings_of(RIGS / f"{rig}.toml", []))


@pytest.mark.long
def test_the_command_says_what_is_in_the_package_and_what_not(tmp_path: Path) -> None:
    target = tmp_path / "xy.ssp"
    rig = RIGS / "fixed-stop-xy.toml"
    done = CliRunner().invoke(app, ["rig", "export", str(rig), "-o", str(target)])
    assert done.exit_code == 0, done.output
    assert "x: AxisRig.Drives.ServoAxis" in done.stderr
    assert "not in it: buses" in done.stderr
    assert done.stdout.strip() == str(target)
    assert [component.name for component in read_ssd(str(target)).system.elements] == ["x", "y"]
    first = target.read_bytes()
    CliRunner().invoke(app, ["rig", "export", str(rig), "-o", str(target)])
    assert target.read_bytes() == first
