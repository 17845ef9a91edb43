"""What a slave must do in both versions of FMI: order of calls, states, instances, refusals."""

import subprocess
import sys
from pathlib import Path

import pytest
from tests.small_fmus import small_fmu

from axisrig.fmus import FMI_VERSIONS, ensure_built

SERVO = "AxisRig.Drives.ServoAxis"
MOVE = {
    "stop_position": 0.004,
    "enabled": True,
    "force_limit": 500.0,
    "reference_velocity": 0.05,
    "reference_end": 100.0,
}
NAN, INF = float("nan"), float("inf")
# d runs away to infinity in finite time, at t = 1/d(0); a limit of x stops the model at x = 0.5.
LIBRARY = """package Small
  model Plant
    input Real u(unit="1") "Speed";
    parameter Real d_start(unit="1") = 0.5 "Start of d";
    parameter Real limit(unit="m") = 1e9 "Largest x";
    output Real x(unit="m", start=0, fixed=true) "Way";
    Real d(unit="1", start=d_start, fixed=true);
  equation
    der(x) = u;
    der(d) = d^2;
    assert(x < limit, "x has passed its limit");
  end Plant;
end Small;
"""
ASSERT_LINE = 11


@pytest.fixture(scope="module")
def servo_fmu(fmi, unpack):
    return unpack(ensure_built(SERVO, fmi=fmi))


@pytest.fixture(scope="module")
def library_fmu(fmi, tmp_path_factory, unpack):
    root = tmp_path_factory.mktemp("library") / "Small"
    root.mkdir()
    (root / "package.mo").write_text(LIBRARY, encoding="utf-8")
    return unpack(small_fmu("Small.Plant", root, fmi=fmi))


@pytest.fixture
def new(slaves, servo_fmu):
    """Makes servo axes."""
    return lambda: slaves(*servo_fmu)


@pytest.fixture
def small(slaves, library_fmu):
    """Makes slaves of the small model."""
    return lambda: slaves(*library_fmu)


# --- order of calls ----------------------------------------------------------------------------


def test_nothing_moves_and_nothing_is_read_before_initialization(new):
    slave = new()
    assert "DoStep cannot be called before initialization" in slave.refusal(slave.step, 1e-3)
    assert "cannot be called before initialization" in slave.refusal(slave.get, "position")
    refusal = slave.refusal(slave.slave.exitInitializationMode)
    assert "ExitInitializationMode cannot be called before initialization" in refusal
    assert "Terminate cannot be called before" in slave.refusal(slave.slave.terminate)


def test_initialization_is_entered_once(new):
    slave = new()
    slave.enter()
    refusal = slave.refusal(slave.slave.enterInitializationMode)
    assert "EnterInitializationMode cannot be called in initialization" in refusal
    assert "DoStep cannot be called in initialization" in slave.refusal(slave.step, 1e-3)
    slave.slave.exitInitializationMode()
    refusal = slave.refusal(slave.slave.exitInitializationMode)
    assert "cannot be called between steps" in refusal


def test_after_termination_values_can_be_read_but_nothing_moves(new):
    slave = new().start(**MOVE)
    slave.run(3)
    last = slave.outputs()
    slave.slave.terminate()
    assert slave.outputs() == last
    assert "cannot be called after termination" in slave.refusal(slave.step, 1e-3)
    assert "cannot be set after termination" in slave.refusal(slave.set, enabled=False)
    assert "cannot be called after termination" in slave.refusal(slave.slave.terminate)


def test_parameters_and_start_values_rest_after_the_start(new, small):
    axis, plant = new().start(), small().start()
    assert "kv can only be set before the start" in axis.refusal(axis.set, kv=20.0)
    assert "x can only be set before the start" in plant.refusal(plant.set, x=1.0)


def test_reading_during_initialization_shows_what_was_set_and_changes_nothing(new):
    """Values set in several goes with looks between them end in the same bits as at once."""
    slow, fast = new(), new().start(position_start=0.25, mass=99.0, **MOVE)
    slow.enter()
    for name, value in {"position_start": 0.25, "mass": 99.0, **MOVE}.items():
        slow.set(**{name: value})
        assert slow.get("position") == 0.25
    slow.slave.exitInitializationMode()
    assert slow.run(60) == fast.run(60)


def test_start_value_of_a_state_can_be_set(small):
    plant = small().start(x=0.125, u=2.0)
    assert plant.get("x") == 0.125
    plant.step(0.1)
    assert plant.get("x") == pytest.approx(0.325, abs=1e-12)


# --- steps and values ----------------------------------------------------------------------------


@pytest.mark.parametrize("size", [0.0, -1e-3, NAN, INF, -INF])
def test_step_must_lead_forward(new, size):
    slave = new().start(**MOVE)
    before = slave.outputs()
    assert "step size" in slave.refusal(slave.slave.doStep, 0.0, size)
    assert slave.outputs() == before


@pytest.mark.parametrize("begin", [0.5, -0.5, NAN, INF])
def test_step_must_begin_where_the_last_one_ended(new, begin):
    slave = new().start(**MOVE)
    assert "at t = 0 s, not" in slave.refusal(slave.slave.doStep, begin, 1e-3)


def test_tiny_and_huge_steps_end_where_they_should(small):
    """x = u*t, exactly what a fourth-order method integrates."""
    for sizes in ([5e-324, 1e-300, 1e-20, 1e-12, 1e-9], [1.5], [1e-7] * 100):
        plant = small().start(u=2.0, d_start=0.0)
        for size in sizes:
            plant.step(size)
        assert plant.get("x") == pytest.approx(2.0 * sum(sizes), rel=1e-12, abs=0.0)


def test_time_at_which_the_internal_step_is_lost_in_rounding_is_refused(small):
    plant = small()
    plant.enter(start=1e12)
    plant.slave.exitInitializationMode()
    assert "lost in rounding" in plant.refusal(plant.step, 1.0)


def test_stop_time_must_lie_behind_the_start_and_holds(small):
    plant = small()
    assert "stop time 1 s is not after" in plant.refusal(plant.enter, start=1.0, stop=1.0)
    plant.enter(start=1.0, stop=1.01)
    plant.slave.exitInitializationMode()
    plant.step(0.01)
    assert "after the stop time 1.01 s" in plant.refusal(plant.step, 0.01)


@pytest.mark.parametrize("value", [NAN, INF, -INF])
def test_values_that_are_no_numbers_are_refused(small, value):
    plant = small().start(u=2.0)
    assert plant.refusal(plant.set, u=value).startswith("u = ")
    assert plant.refusal(plant.set, u=value).endswith("(t = 0 s)")
    plant.step(1.0)
    assert plant.get("x") == pytest.approx(2.0, rel=1e-12)


def test_unknown_references_and_wrong_types_are_refused(small, fmi):
    plant = small().start()
    name = "getReal" if fmi == "2.0" else "getFloat64"
    assert "value reference 999 is not known" in plant.refusal(getattr(plant.slave, name), [999])
    wrong = plant.slave.getInteger if fmi == "2.0" else plant.slave.getInt32
    assert "x is of another type" in plant.refusal(wrong, [plant.variables["x"].valueReference])


# --- failures of the equations -------------------------------------------------------------------


def test_runaway_is_told_with_variable_and_time(small):
    """d = 0.5/(1 - 0.5 t) has its pole at t = 2."""
    plant = small().start()
    plant.step(1.9)
    message = plant.refusal(plant.step, 0.5)
    assert message.startswith("d is not a finite number at t = 2.0")


def test_assertion_is_told_with_line_text_and_time(small):
    plant = small().start(u=2.0, limit=0.5)
    plant.step(0.2)
    message = plant.refusal(plant.step, 0.2)
    assert message.startswith(f"Small/package.mo:{ASSERT_LINE}: x has passed its limit (t = 0.2")


def test_after_a_failure_values_can_be_read_and_only_restoring_or_reset_helps(small):
    plant = small().start(u=2.0, limit=0.5)
    plant.step(0.2)
    state, good = plant.save(), plant.outputs()
    plant.refusal(plant.step, 0.2)
    plant.get("x")
    assert "DoStep cannot be called after an error" in plant.refusal(plant.step, 0.1)
    assert "cannot be set after an error" in plant.refusal(plant.set, u=0.0)
    plant.restore(state, 0.2)
    assert plant.outputs() == good
    plant.set(u=0.0)
    plant.step(0.1)
    plant.refusal(plant.step, NAN)
    plant.reset()
    plant.start(u=1.0)
    plant.step(0.1)
    assert plant.get("x") == pytest.approx(0.1, rel=1e-12)
    plant.forget(state)


def test_failure_at_the_start_is_told(small):
    plant = small()
    plant.enter()
    plant.set(limit=-1.0)
    assert "x has passed its limit (t = 0 s)" in plant.refusal(plant.slave.exitInitializationMode)


def test_both_versions_move_bit_by_bit_alike(slaves, unpack):
    two, three = (
        slaves(*unpack(ensure_built(SERVO, fmi=version))).start(**MOVE) for version in FMI_VERSIONS
    )
    assert two.run(150) == three.run(150)


# --- states and instances ------------------------------------------------------------------------


def test_restored_state_repeats_bit_by_bit(new):
    slave = new().start(**MOVE)
    slave.run(50)
    state, time = slave.save(), slave.time
    first = slave.run(60)
    for _ in range(2):
        slave.restore(state, time)
        assert slave.run(60) == first
    slave.forget(state)


def test_reset_gives_a_new_instance_bit_by_bit(new):
    used, fresh = new().start(position_start=-0.1, mass=50.0, **MOVE), new()
    used.run(70)
    used.reset()
    assert used.start(**MOVE).run(100) == fresh.start(**MOVE).run(100)


def test_instances_in_turn_are_as_each_one_alone(new):
    starts = [{**MOVE, "kv": kv, "stop_position": 0.002 * kv / 10} for kv in (10, 20, 40)]
    alone = [new().start(**start).run(80) for start in starts]
    together = [new().start(**start) for start in starts]
    found = [[] for _ in starts]
    for _ in range(80):
        for number, slave in enumerate(together):
            found[number] += slave.run(1)
    assert found == alone


CONTINUE = """import runpy
from pathlib import Path
slave = runpy.run_path({helper!r})["Slave"](Path({fmu!r}), Path({folder!r}))
state = slave.deserialized(Path({data!r}).read_bytes())
slave.restore(state, {time!r})
print(slave.run(60))
"""


def test_serialized_state_goes_on_in_another_process(new, servo_fmu, tmp_path):
    slave = new().start(**MOVE)
    slave.run(50)
    state = slave.save()
    data = tmp_path / "state"
    data.write_bytes(slave.serialized(state))
    slave.forget(state)
    time = slave.time
    first = slave.run(60)
    fmu, folder = (str(path) for path in servo_fmu)
    helper = str(Path(__file__).with_name("conftest.py"))
    code = CONTINUE.format(helper=helper, fmu=fmu, folder=folder, data=str(data), time=time)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == repr(first)


def test_bytes_that_are_no_state_are_refused(new, small):
    axis, plant = new().start(), small().start()
    state = plant.save()
    for data in (plant.serialized(state), b"", b"nonsense"):
        assert "the bytes are not a state" in axis.refusal(axis.deserialized, data)
    plant.forget(state)


def test_foreign_token_gives_no_instance(new):
    slave = new()
    slave.slave.guid = "of another model"
    component = slave.slave.component
    with pytest.raises(Exception, match="nstantiat"):
        slave.instantiate()
    slave.slave.component = component
    assert '"of another model" is not that of this FMU' in slave.messages[-1]


def test_messages_can_be_switched_off_and_on(small):
    plant = small().start()
    assert "log category nonsense is not known" in plant.refusal(
        plant.slave.setDebugLogging, True, ["nonsense"]
    )
    plant.slave.setDebugLogging(False, ["logStatusError"])
    with pytest.raises(AssertionError):  # no message arrives
        plant.refusal(plant.set, u=NAN)
    plant.slave.setDebugLogging(True, [])
    assert plant.refusal(plant.set, u=NAN)
