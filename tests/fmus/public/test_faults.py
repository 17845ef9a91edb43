"""What must go wrong: told with status, variable and time, never a value that is silently wrong."""

import re
from pathlib import Path

import pytest
from fmpy.fmi1 import FMICallException

# model, start values, time of the fault, words of the message
FAULTS = [
    ("Faults.DivisionByZero", {}, 0.5, "y is not a finite number"),
    ("Faults.RootOfNegative", {}, 1.0, "y is not a finite number"),
    ("Faults.LogOfNegative", {}, 1.5, "x is not a finite number"),
    ("Faults.Diverging", {}, 0.0709, "x is not a finite number"),
    ("Classics.BlowUp", {}, 1.0, "x is not a finite number"),
    ("Faults.AssertError", {}, 0.5, ": x has left its range"),
    ("Faults.Restless", {}, 0.5, "do not come to rest"),
    ("Faults.Zeno", {}, 1.3545, "Faults/package.mo"),
    ("Control.Chattering", {}, 1.0886, "Control/package.mo"),
    ("Faults.NoSolution", {}, 1.0, "y"),
    ("Faults.IndexOutOfRange", {}, 0.3, "y is not a finite number"),
    ("Faults.RoundedProduct", {}, 0.02, "seed is not a finite number"),
    ("Faults.IntegerOverflow", {}, 0.2, "n"),
]


@pytest.mark.long(but=1)
@pytest.mark.parametrize(("model", "start", "time_s", "words"), FAULTS, ids=[f[0] for f in FAULTS])
def test_fault_is_told_with_place_and_time(built, load, model, start, time_s, words):
    """Steps of 1 ms: the first that fails holds the fault, and the message tells its instant."""
    plant = load(built(model), **start)

    def run():
        for k in range(3000):
            plant.slave.doStep(k * 1e-3, 1e-3)

    with pytest.raises(FMICallException):
        run()
    found = plant.messages[-1]
    assert words in found
    match = re.search(r"t = ([-+.e\d]+)", found)
    assert match is not None, found
    assert float(match.group(1)) == pytest.approx(time_s, abs=2e-3)


@pytest.mark.parametrize("step_s", [5e-5, 1e-3, 1e-2])
def test_stiff_system_is_right_or_told(built, load, step_s):
    """Robertson's reaction has a mode of up to 1e4 1/s: with a step too long it must not drift."""
    plant = load(built("Classics.Robertson", step_s))
    try:
        for k in range(40):
            plant.slave.doStep(float(k), 1.0)
    except FMICallException:
        assert "is not a finite number at t = " in plant.messages[-1]
    else:
        assert plant.y1 == pytest.approx(0.7158270688, abs=1e-6)


def test_assertion_at_the_start_ends_the_initialization(built, load):
    path = built("Faults.AssertAtStart")
    with pytest.raises(FMICallException):
        load(path, p=-1.0)


def test_failed_warning_is_told_and_the_run_goes_on(built, load):
    plant = load(built("Faults.AssertWarning"))
    plant.step(0.4)
    assert not any("x is high" in message for message in plant.messages)
    plant.step(0.4)
    assert any("x is high" in message for message in plant.messages)
    plant.step(0.4)
    assert plant.x == pytest.approx(1.2, abs=1e-12)


def test_division_by_a_parameter_of_zero_is_told(built, load):
    """w = sqrt(k/m) with m = 0."""
    path = built("Language.ParameterChain")
    with pytest.raises(FMICallException):
        load(path, m=0.0).step(0.1)


def test_value_that_is_no_number_is_refused(built, load):
    for value in (float("nan"), float("inf"), float("-inf")):
        with pytest.raises(FMICallException):
            load(built("Classics.Dahlquist"), k=value)


def test_time_events_that_pile_up_are_bounded(built, load):
    """Events at 1 - 2^-n: as many as the resolution of the time holds, then the run goes on."""
    plant = load(built("Faults.ZenoByMode"))
    plant.step(2.0)
    assert 30 <= plant.n <= 60
    assert plant.next == pytest.approx(1.0, abs=1e-9)


def test_failed_assertion_names_its_line(built, load):
    plant = load(built("Faults.AssertError"))
    with pytest.raises(FMICallException):
        plant.step(1.0)
    file = Path(__file__).parent / "Faults" / "package.mo"
    lines = file.read_text(encoding="utf-8").splitlines()
    line = 1 + next(i for i, text in enumerate(lines) if "x has left its range" in text)
    assert f"Faults/package.mo:{line}: " in plant.messages[-1]
