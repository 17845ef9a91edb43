"""What every FMU of the exporter must do as FMI 3.0 asks: states, reset, instances, errors."""

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from axisrig.fmus import CATALOGUE, FMI_VERSIONS, MODELS, ensure_built


@pytest.fixture
def moving(servo):
    """An axis on its way into a stop."""
    axis = servo(stop_position=0.004, enabled=True, force_limit=500.0)
    axis.set(reference_velocity=0.05, reference_end=100.0)
    axis.step(0.05)
    return axis


def run(axis, count=80):
    """Outputs after each of `count` steps."""
    results = []
    for _ in range(count):
        axis.step(1e-3)
        results.append(axis.outputs())
    return results


@pytest.mark.long(but=1)
@pytest.mark.parametrize("fmi", FMI_VERSIONS)
@pytest.mark.parametrize("model", MODELS)
def test_validator_finds_no_problem(model, fmi):
    assert validate_fmu(str(ensure_built(model, fmi=fmi))) == []


@pytest.mark.parametrize("model", MODELS)
def test_every_real_variable_has_a_unit_and_every_one_a_meaning(model):
    description = fmpy.read_model_description(str(ensure_built(model)))
    for variable in description.modelVariables:
        if variable.type == "Float64":
            assert variable.unit, variable.name
        calculated_part = variable.causality == "calculatedParameter" and "." in variable.name
        if variable.causality != "local" and not calculated_part:
            assert variable.description, variable.name


def test_restored_state_repeats_bit_by_bit(moving):
    state, time = moving.slave.getFMUState(), moving.time
    first = run(moving)
    moving.slave.setFMUState(state)
    moving.time = time
    assert run(moving) == first
    moving.slave.freeFMUState(state)


def test_serialized_state_moves_to_another_instance(moving, servo):
    state = moving.slave.getFMUState()
    data = moving.slave.serializeFMUState(state)
    first = run(moving)
    other = servo(stop_position=1.0)
    restored = other.slave.deserializeFMUState(data)
    other.slave.setFMUState(restored)
    other.time = 0.05
    assert run(other) == first
    moving.slave.freeFMUState(state)
    other.slave.freeFMUState(restored)


def test_bytes_of_another_fmu_are_no_state(moving, probe):
    state = moving.slave.getFMUState()
    data = moving.slave.serializeFMUState(state)
    moving.slave.freeFMUState(state)
    fmu = probe()
    with pytest.raises(FMICallException):
        fmu.slave.deserializeFMUState(data)
    assert "not a state of this FMU" in fmu.messages[-1]


def test_reset_gives_a_new_start(servo):
    axis = servo(position_start=0.3)
    axis.step(0.1)
    axis.slave.reset()
    axis.start()
    assert axis.position == 0.0
    assert axis.kv == 10.0


def test_instances_do_not_meet(servo):
    """Two axes in turn give the same bits as each one alone."""
    alone = [servo(enabled=True, kv=kv) for kv in (10, 40)]
    mixed = [servo(enabled=True, kv=kv) for kv in (10, 40)]
    for axis in (*alone, *mixed):
        axis.set(reference_velocity=0.02, reference_end=1.0)
    expected = [run(axis, 50) for axis in alone]
    found = [[], []]
    for _ in range(50):
        for number, axis in enumerate(mixed):
            found[number] += run(axis, 1)
    assert found == expected


def test_steps_of_whole_internal_steps_do_not_change_a_bit(servo):
    """The demand ends and the stop is met between two internal steps."""
    internal_ns = round(CATALOGUE["AxisRig.Drives.ServoAxis"].step_s * 1e9)
    whole_ns = 8000 * internal_ns
    ends = []
    for size_ns in (internal_ns * count for count in (1, 4, 16, 80, 4000)):
        axis = servo(stop_position=0.0005, enabled=True, force_limit=500.0)
        axis.step_to(48e-6)
        axis.set(reference_velocity=0.05, reference_time=48e-6, reference_end=0.0873211)
        for end_ns in range(48_000 + size_ns, 48_001 + whole_ns, size_ns):
            axis.step_to(end_ns * 1e-9)
        ends.append(axis.outputs())
    assert ends[0]["stop_force"] > 100
    assert all(end == ends[0] for end in ends)


def test_communication_step_does_not_change_the_motion(servo):
    """Steps that are no multiple of the internal step end within 1e-12 m of the same place."""
    ends = []
    for size, count in ((1e-3, 210), (0.7e-3, 300), (0.21, 1), (30e-6, 7000)):
        axis = servo(stop_position=0.004, enabled=True, force_limit=500.0)
        axis.set(reference_velocity=0.05, reference_end=100.0)
        for _ in range(count):
            axis.step(size)
        ends.append(axis.position)
    assert max(ends) - min(ends) < 1e-10


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("force_limit", -1.0, "force_limit = -1 is outside 0 .. inf"),
        ("reference_velocity", float("nan"), "reference_velocity = "),
        ("kv", 20.0, "kv can only be set before the start"),
        ("position", 1.0, "position cannot be set"),
    ],
)
def test_forbidden_values_are_refused_with_a_message(servo, name, value, text):
    axis = servo()
    before = axis.outputs()
    with pytest.raises(FMICallException):
        axis.set(**{name: value})
    assert text in axis.messages[-1]
    assert axis.outputs() == before


@pytest.mark.parametrize(
    ("time", "size", "text"),
    [(0.5, 1e-3, "not 0.5 s"), (0.0, 0.0, "step size 0"), (0.0, -1e-3, "step size -0.001")],
)
def test_wrong_step_is_refused(servo, time, size, text):
    axis = servo()
    with pytest.raises(FMICallException):
        axis.slave.doStep(time, size)
    assert text in axis.messages[-1]


def test_step_behind_the_stop_time_is_refused(servo):
    axis = servo()
    axis.slave.reset()
    axis.slave.enterInitializationMode(startTime=0.0, stopTime=0.01)
    axis.slave.exitInitializationMode()
    axis.slave.doStep(0.0, 0.01)
    with pytest.raises(FMICallException):
        axis.slave.doStep(0.01, 0.01)
    assert "after the stop time" in axis.messages[-1]


def test_start_time_other_than_zero(servo):
    """The same motion begun at 1000 s."""
    early, late = servo(enabled=True), servo(enabled=True)
    late.slave.reset()
    late.slave.enterInitializationMode(startTime=1000.0)
    late.set(enabled=True)
    late.slave.exitInitializationMode()
    late.time = 1000.0
    for axis in (early, late):
        axis.set(reference_velocity=0.02, reference_time=axis.time, reference_end=axis.time + 0.1)
        for _ in range(200):
            axis.step(1e-3)
    assert late.position == pytest.approx(early.position, abs=1e-10)


def test_foreign_token_gives_no_instance(servo):
    axis = servo()
    axis.slave.guid = "of another model"
    with pytest.raises(Exception, match="instantiate"):
        axis.slave.instantiate(logMessage=axis.log)
    assert "instantiation token" in axis.messages[-1]
