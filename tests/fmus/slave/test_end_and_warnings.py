"""What a model says by terminate() and by warnings, in the words of both versions of FMI."""

import ctypes

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2LastSuccessfulTime, fmi2Terminated
from tests.small_fmus import small_fmu

LIBRARY = """package Small
  model Plant
    input Real u(unit="1", start=1) "Speed";
    parameter Real far(unit="m") = 0.25 "Where it ends";
    output Real x(unit="m", start=0, fixed=true) "Way";
  equation
    der(x) = u;
    when x > far then terminate("far enough"); end when;
    assert(u < 2, "u is large, 50 % more than planned", AssertionLevel.warning);
  end Plant;
end Small;
"""
END_LINE, WARNING_LINE = 8, 9


@pytest.fixture(scope="module")
def fmu(fmi, tmp_path_factory, unpack):
    root = tmp_path_factory.mktemp("library") / "Small"
    root.mkdir()
    (root / "package.mo").write_text(LIBRARY, encoding="utf-8")
    return unpack(small_fmu("Small.Plant", root, fmi=fmi))


@pytest.fixture
def plant(slaves, fmu):
    """A slave that is not yet initialized."""
    return slaves(*fmu)


def ended_at(plant, size):
    """Where the model ends the simulation in a step, as the version tells it."""
    if plant.fmi == "3.0":
        _, terminate, early, last = plant.step(size)
        assert (terminate, early) == (True, False)  # nobody has allowed an early return
        return last
    with pytest.raises(FMICallException) as found:
        plant.step(size)
    assert found.value.status == 2  # discard
    ended, last = ctypes.c_int(), ctypes.c_double()
    component = plant.slave.component
    plant.slave.fmi2GetBooleanStatus(component, fmi2Terminated, ctypes.byref(ended))
    plant.slave.fmi2GetRealStatus(component, fmi2LastSuccessfulTime, ctypes.byref(last))
    assert ended.value == 1
    return last.value


def test_end_is_told_with_its_instant_line_and_text(plant):
    plant.start()
    plant.step(0.2)
    assert ended_at(plant, 0.2) == pytest.approx(0.25, abs=1e-9)
    (message,) = plant.messages
    assert f"Small/package.mo:{END_LINE}: far enough (t = 0.25" in message
    assert plant.get("x") == pytest.approx(0.25, abs=1e-9)


def test_after_the_end_only_termination_reset_or_an_earlier_state_lead_on(plant):
    plant.start()
    state = plant.save()
    ended_at(plant, 0.4)
    assert ended_at(plant, 0.1) == pytest.approx(0.25, abs=1e-9)  # it does not move
    assert "cannot be set after the model has ended" in plant.refusal(plant.set, u=0.5)
    plant.restore(state, 0.0)
    plant.step(0.1)
    assert plant.get("x") == pytest.approx(0.1, abs=1e-12)
    ended_at(plant, 0.4)
    plant.slave.terminate()
    plant.forget(state)


def test_end_at_the_start_is_told_by_the_first_step(plant):
    """The condition of a `when` that holds from the beginning never becomes true: no end."""
    plant.start(far=-1.0)
    plant.step(0.1)
    plant.reset()
    plant.start(far=0.0)
    assert ended_at(plant, 0.1) == pytest.approx(0.0, abs=1e-9)


def test_warning_is_logged_with_its_line_and_the_step_succeeds(plant):
    plant.start()
    plant.set(u=2.5)
    plant.step(0.01)
    (message,) = plant.messages
    percent = "%%" if plant.fmi == "2.0" else "%"  # in version 2 the message is a format
    text = f"u is large, 50 {percent} more than planned"
    assert message == f"Small/package.mo:{WARNING_LINE}: {text} (t = 0 s)"
    assert plant.get("x") == pytest.approx(0.025, abs=1e-12)


def test_warning_has_the_status_of_one(plant):
    statuses = []
    call = plant.slave._call
    plant.slave._call = lambda *words: statuses.append(call(*words)) or statuses[-1]
    plant.start(u=2.5)
    plant.step(0.01)
    assert 1 in statuses
    assert max(statuses) == 1
