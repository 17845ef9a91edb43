"""Accuracy and sameness: instants of events, order, communication steps, copies of one instance."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

SEVERAL = [
    "Classics.VanDerPol",
    "Control.RelayControl",
    "Process.Thermostat",
    "Logic.Edges",
    "Control.CascadeWithEvents",
    "Circuits.Chua",
]


def walk(plant, sizes):
    """Steps of whole nanoseconds, so that every partition meets at the same instants."""
    now = 0
    for size in sizes:
        plant.slave.doStep(now * 1e-9, size * 1e-9)
        now += size
    return plant.outputs()


@pytest.mark.long(but=1)
@pytest.mark.parametrize("model", SEVERAL)
@pytest.mark.parametrize("size_s", [1e-4, 1e-2, 1.0])
def test_result_does_not_depend_on_the_communication_step(built, load, model, size_s):
    """2 s in equal steps, against one step."""
    path = built(model)
    whole = walk(load(path), [2 * 10**9])
    parts = walk(load(path), [round(size_s * 1e9)] * round(2 / size_s))
    for name, value in whole.items():
        assert parts[name] == pytest.approx(value, rel=1e-12, abs=1e-12), name


@pytest.mark.parametrize("size_s", [1e-9, 1e-8, 1e-6, 10.0])
@pytest.mark.long(but=1)
def test_any_step_size_is_taken(built, load, size_s):
    plant = load(built("Classics.Dahlquist"))
    for k in range(50):
        plant.slave.doStep(k * size_s, size_s)
    assert plant.x == pytest.approx(math.exp(-50 * size_s), abs=1e-12)


@pytest.mark.long
def test_at_least_fourth_order_on_a_nonlinear_oscillator(built, load, solve):
    """Half the internal step, at most a sixteenth of the error, down to what is allowed for it."""
    expected = solve.smooth(
        lambda _, s: [s[1], (1 - s[0] ** 2) * s[1] - s[0]], [2, 0], np.linspace(0, 5, 51)
    )[0, -1]
    errors = []
    for step_s in (0.02, 0.01, 0.005):
        plant = load(built("Classics.VanDerPol", step_s))
        plant.step(5.0)
        errors.append(abs(plant.x - expected))
    for coarse, fine in itertools.pairwise(errors):
        assert fine <= max(coarse / 13, 1e-8)
    assert errors[-1] < 1e-8


def test_events_cost_no_order(built, load):
    """Thermostat with long internal steps: on, off, on, off, on within a minute, each located."""
    down, up = 100 * math.log(16 / 14), 100 * math.log(26 / 24)
    last_on = 100 * math.log(30 / 24) + 2 * down + up
    expected = 45 - 26 * math.exp(-(60 - last_on) / 100)
    for step_s in (0.5, 0.05):
        plant = load(built("Process.Thermostat", step_s))
        plant.step(60.0)
        assert plant.switchings == 4
        assert plant.get("T") == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("step_s", [5e-5, 1e-3, 1e-2])
def test_events_of_a_smooth_signal_are_located_to_a_nanosecond(built, load, step_s):
    """x = sin t through 1/2 (rising) and -1/2 (falling), whatever the internal step."""
    plant = load(built("Process.Hysteresis", step_s))
    for _ in range(39):
        plant.step(0.5)
        turns = int((plant.time - math.pi / 6) // (2 * math.pi))
        if turns >= 0:
            assert plant.t_on == pytest.approx(math.pi / 6 + 2 * math.pi * turns, abs=1e-9)
        turns = int((plant.time - 7 * math.pi / 6) // (2 * math.pi))
        if turns >= 0:
            assert plant.t_off == pytest.approx(7 * math.pi / 6 + 2 * math.pi * turns, abs=1e-9)


def test_two_events_a_nanosecond_apart_are_told_apart(built, load):
    plant = load(built("Logic.CloseEvents"))
    plant.step(1.0)
    assert plant.ta == pytest.approx(0.3333333, abs=1e-10)
    assert plant.tb - plant.ta == pytest.approx(1e-9, abs=1e-10)
    assert (plant.n, plant.order) == (2, 1)


@pytest.mark.parametrize("size_s", [0.5, 0.25, 0.1, 0.125])
def test_event_at_an_instant_of_communication_happens_once(built, load, size_s):
    """x >= 0.5 at t = 0.5: in this step or at once in the next, never twice, never late."""
    plant = load(built("Logic.AtCommunicationPoint"))
    for k in range(round(1 / size_s)):
        plant.slave.doStep(k * size_s, size_s)
    assert plant.n == 1
    assert plant.t_event == pytest.approx(0.5, abs=1e-9)


@pytest.mark.parametrize("begin_s", [1e3, 1e6, 1e9])
def test_start_far_from_zero(built, load, begin_s):
    """One second of decay; the resolution of the time is what 64 bits give."""
    plant = load(built("Classics.Dahlquist"))
    plant.slave.terminate()
    plant.slave.reset()
    plant.slave.enterInitializationMode(startTime=begin_s)
    plant.slave.exitInitializationMode()
    for k in range(10):
        plant.slave.doStep(begin_s + k * 0.125, 0.125)
    resolution = np.spacing(begin_s)
    assert plant.x == pytest.approx(math.exp(-1.25), abs=1e-10 + 10 * resolution)


@pytest.mark.parametrize("model", SEVERAL)
@settings(max_examples=5, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(sizes=st.lists(st.integers(1, 4 * 10**8), min_size=2, max_size=8), cut=st.integers(0, 7))
def test_same_bits_again_from_copy_reset_and_saved_state(built, load, model, sizes, cut):
    """The same steps give the same bits: another instance, after reset, from any saved state."""
    path = built(model)
    first, second = load(path), load(path)
    expected = walk(first, sizes)
    assert walk(second, sizes) == expected
    second.slave.reset()
    second.start()
    now = 0
    for k, size in enumerate(sizes):
        if k == cut % len(sizes):
            state = second.slave.getFMUState()
            data = second.slave.serializeFMUState(state)
            second.slave.doStep(now * 1e-9, 123456 * 1e-9)
            second.slave.setFMUState(second.slave.deserializeFMUState(data))
            second.slave.freeFMUState(state)
        second.slave.doStep(now * 1e-9, size * 1e-9)
        now += size
    assert second.outputs() == expected


def test_sampled_input_is_held(run):
    """u = t, sampled at 0.05, 0.15, ...: the value of the step that holds the instant."""
    t = np.arange(101) * 0.0101
    found = run("Control.SampledInput", t, ["held", "n"], inputs=lambda s: {"u": 100 + s})
    n = np.floor((t - 0.05) / 0.1 + 1) * (t >= 0.05)
    ticks = 0.05 + 0.1 * (n - 1)
    held = np.where(n > 0, 100 + np.floor(ticks / 0.0101) * 0.0101, -1)
    np.testing.assert_array_equal(found["n"], n)
    np.testing.assert_allclose(found["held"], held, rtol=0, atol=1e-9)


def test_rising_edges_of_an_input_are_counted(run):
    t = np.arange(21) * 0.1
    found = run(
        "Logic.BooleanInput", t, ["n"], inputs=lambda s: {"u": round(s * 10) % 4 >= 2, "k": 3}
    )
    # True at 0.2, 0.3, 0.6, 0.7, ...: edges at 0.2 + 0.4 k, seen at the latest after their step.
    edges = np.floor((np.round(t, 6) - 0.3 + 0.4) / 0.4 + 1e-9)
    np.testing.assert_array_equal(found["n"], 3 * np.maximum(edges, 0))


def test_input_acts_over_the_step(run):
    """T y' = k u - y with u constant in each step."""
    t = np.arange(31) * 0.1
    found = run("Process.Gain", t, ["y"], inputs=lambda s: {"u": math.cos(3 * s)})
    y = [0.0]
    for s in t[:-1]:
        y.append(2 * math.cos(3 * s) + (y[-1] - 2 * math.cos(3 * s)) * math.exp(-0.1 / 0.5))
    np.testing.assert_allclose(found["y"], y, rtol=0, atol=1e-11)
