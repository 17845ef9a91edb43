"""An FMU of either version under the master, also when it does not behave."""

import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from zipfile import ZipFile

import pytest

from axisrig.kernel.cosim.fmi.fmu import Exchange, FmuSlave, PlantError, load_fmu
from axisrig.kernel.cosim.fmi.library import grid_of
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

Odd = Callable[..., FmuSlave]


def saving(version: int) -> dict[str, bool]:
    """The flag of a state that can be saved, in the words of the version."""
    return {"canGetAndSetFMUstate" if version == 2 else "canGetAndSetFMUState": True}


def test_step_moves_by_speed_times_time(odd: Odd) -> None:
    slave = odd()
    for end_ms in range(1, 31):
        slave.step_to(end_ms * MS)
    assert slave.get("slide.x") == pytest.approx(3.0, abs=1e-12)
    assert slave.get("level") == 1.0


def test_values_of_other_types(odd: Odd) -> None:
    slave = odd("warns")
    assert slave.get("behaviour") == 7
    level = Exchange(slave, ["level"])
    level.read()
    assert bool(level.values[0]) is False
    with pytest.raises(UserError, match=r"slide\.x, level differ in type"):
        Exchange(slave, ["slide.x", "level"])


def test_misspelt_variable_gets_the_nearest_names(odd: Odd) -> None:
    with pytest.raises(UserError, match=r"found 'slide.y'; did you mean: slide\.\w"):
        odd().get("slide.y")


def test_messages_keep_status_and_time_and_fill_in_their_numbers(odd: Odd, version: int) -> None:
    first, second = odd("warns"), odd("warns", name="other")
    first.step_to(1 * MS)
    second.step_to(1 * MS)
    second.step_to(2 * MS)
    assert [(m.time_ns, m.status, m.category) for m in second.messages] == [
        (0, 1, "trouble"),
        (1 * MS, 1, "trouble"),
    ]
    assert len(first.messages) == 1
    if version == 2:  # FMI 2.0 hands over a format and its arguments
        assert second.messages[-1].text == "hot at 1 ms"


# ---- steps of one length


def test_steps_of_one_length_are_kept_and_outputs_hold_between(odd: Odd, version: int) -> None:
    """x = 0.1 mm per ms, seen at the last whole millisecond."""
    fixed = {"canHandleVariableCommunicationStepSize": False, "stepSize": "0.001"}
    slave = odd("plain", **saving(version), **fixed)
    seen = []
    for end_us in (300, 999, 1000, 1001, 2500, 5000):
        slave.step_to(end_us * US)
        assert slave.time_ns == end_us * US
        seen.append(slave.get("slide.x"))
    assert seen == pytest.approx([0.0, 0.0, 0.1, 0.1, 0.2, 0.5], abs=1e-12)
    slave.step_to(5_500 * US)
    state = slave.save_state()
    slave.step_to(8 * MS)
    slave.restore_state(state)
    slave.step_to(6 * MS)
    assert slave.get("slide.x") == pytest.approx(0.6, abs=1e-12)


@pytest.mark.parametrize(
    ("internal", "of_experiment", "can_vary", "grid_ns"),
    [
        (None, "0.001", False, 1_000_000),
        (None, "0.000258", False, 258_000),  # times 1e9 it is less than the whole number
        ("0.000065", "0.001", False, 65_000),
        ("0.0000000016", None, False, 2),
        ("1e-12", None, False, 1),
        ("0.0003", "0.001", True, None),
        (None, None, False, None),
    ],
)
def test_the_grid_is_the_step_of_the_description_to_the_nearest_ns(
    internal: str | None, of_experiment: str | None, can_vary: bool, grid_ns: int | None
) -> None:
    """That of the FMU itself before that of its experiment; none for one whose steps may vary."""
    experiment = None if of_experiment is None else SimpleNamespace(stepSize=of_experiment)
    description: Any = SimpleNamespace(
        coSimulation=SimpleNamespace(
            fixedInternalStepSize=internal, canHandleVariableCommunicationStepSize=can_vary
        ),
        defaultExperiment=experiment,
    )
    assert grid_of(description) == grid_ns


# ---- steps that are discarded


def test_long_steps_that_are_discarded_become_short_ones(odd: Odd, version: int) -> None:
    slave = odd("discards long steps", **saving(version))
    slave.step_to(10 * MS)
    assert slave.time_ns == 10 * MS
    assert slave.get("slide.x") == pytest.approx(1.0, abs=1e-12)


def test_step_that_is_done_half_way_goes_on_from_there(odd: Odd) -> None:
    slave = odd("discards half way")
    slave.step_to(10 * MS)
    assert slave.time_ns == 10 * MS
    assert slave.get("slide.x") == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    ("behaviour", "can_save", "can_vary", "text"),
    [
        ("discards all", True, True, "discards every step down to 1 ns"),
        ("discards all", False, True, "discard without progress, and the FMU cannot save its"),
        ("discards all", True, False, "cannot take steps that differ in length"),
        ("tells no progress", True, True, "does not say how far it came"),
    ],
)
def test_discard_ends_in_an_error_and_never_in_an_endless_loop(
    odd: Odd, version: int, behaviour: str, can_save: bool, can_vary: bool, text: str
) -> None:
    promises = saving(version) if can_save else {}
    slave = odd(behaviour, **promises, canHandleVariableCommunicationStepSize=can_vary)
    with pytest.raises(PlantError, match=f"plant odd at t = 0.000000 ms: .*{text}"):
        slave.step_to(1 * MS)


# ---- ends


def test_error_tells_time_and_the_words_of_the_fmu(odd: Odd) -> None:
    slave = odd("fails")
    slave.step_to(5 * MS)
    with pytest.raises(PlantError, match=r"t = 5\.0+ ms: doStep: error; the spring is broken"):
        slave.step_to(6 * MS)


@pytest.mark.parametrize("behaviour", ["ends", "ends without a time"])
def test_fmu_that_ends_the_simulation_is_told(odd: Odd, behaviour: str) -> None:
    """Also one that refuses to say when: then it is the time of the last step."""
    slave = odd(behaviour)
    slave.step_to(5 * MS)
    with pytest.raises(PlantError, match=r"t = 5\.0+ ms: the FMU ended the simulation"):
        slave.step_to(6 * MS)


# ---- early return


@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
def test_early_return_loses_neither_the_outputs_nor_the_rest_of_the_step(odd: Odd) -> None:
    """x passes 1 mm at 10 ms exactly, in the middle of a step of 4 ms."""
    slave = odd("returns early", mightReturnEarlyFromDoStep=True)
    assert slave.can.can_return_early
    slave.step_to(9_500 * US)
    assert slave.step_towards(13_500 * US) == 10 * MS
    assert slave.get("slide.x") == pytest.approx(1.0, abs=1e-12)
    assert slave.get("level") == 1.0
    assert slave.step_towards(13_500 * US) == 13_500 * US
    assert slave.get("slide.x") == pytest.approx(1.35, abs=1e-12)


@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
def test_whole_step_goes_over_early_returns_at_odd_instants(odd: Odd) -> None:
    """u = 100/3 mm/s passes 1 mm at 30 ms less a fraction of a nanosecond."""
    slave = odd("returns early", mightReturnEarlyFromDoStep=True)
    speed = Exchange(slave, ["slide.u"])
    speed.values[0] = 7.0
    speed.write()
    for end_ms in range(10, 200, 10):
        slave.step_to(end_ms * MS)
        assert slave.time_ns == end_ms * MS
    assert slave.get("slide.x") == pytest.approx(7.0 * 0.19, abs=1e-9)


@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
def test_what_an_early_return_has_left_over_is_none_of_the_next_run(odd: Odd) -> None:
    """The FMU stands a fraction of a nanosecond before its edge; it is initialised anew at 0."""
    slave = odd("returns early", mightReturnEarlyFromDoStep=True)
    speed = Exchange(slave, ["slide.u"])
    speed.values[0] = 7.0
    speed.write()
    end_ns = slave.time_ns
    for end_ns in range(MS, 200 * MS, MS):
        if slave.step_towards(end_ns) < end_ns:
            break
    assert slave.time_ns < end_ns

    def asked(_pointer: int, begin_s: float, step_s: float, *_: object) -> int:
        raise LookupError(begin_s, step_s)

    slave._step, slave._enter_initialization = asked, lambda _: None
    slave.initialize(0)
    with pytest.raises(LookupError) as call:
        slave.step_towards(MS)
    assert call.value.args == (0.0, 1e-3)


@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
def test_early_return_is_not_allowed_to_fmus_that_do_not_offer_it(odd: Odd) -> None:
    slave = odd("returns early")
    assert slave.step_towards(20 * MS) == 20 * MS


@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
def test_early_returns_without_progress_end_in_an_error(odd: Odd) -> None:
    slave = odd("returns at once", mightReturnEarlyFromDoStep=True)
    with pytest.raises(PlantError, match="returns early again and again"):
        slave.step_to(1 * MS)


# ---- where the FMU says that it stands


@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
@pytest.mark.parametrize(
    ("behaviour", "text"),
    [
        ("stands still", r"the FMU does not advance \(lastSuccessfulTime 0\.005 s\)"),
        ("loses its time", r"where the FMU has come \(lastSuccessfulTime\) is no number"),
    ],
)
def test_time_that_does_not_go_on_is_an_error(odd: Odd, behaviour: str, text: str) -> None:
    """The status is ok, no flag is set: without a look at its time it would go on for ever."""
    slave = odd(behaviour)
    slave.step_to(5 * MS)
    with pytest.raises(PlantError, match=rf"plant odd at t = 5\.0+ ms: doStep: ok, but {text}"):
        slave.step_to(6 * MS)


@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
def test_time_may_wait_for_a_longer_step_that_the_description_tells(odd: Odd) -> None:
    slave = odd("waits", fixedInternalStepSize="1e-3")
    for end_us in range(250, 4001, 250):
        slave.step_to(end_us * US)
        assert slave.get("slide.x") == pytest.approx(100.0 * (end_us // 1000) * 1e-3, abs=1e-9)
    slave = odd("waits", name="silent")
    with pytest.raises(PlantError, match="the FMU does not advance"):
        slave.step_to(250 * US)


# ---- saved states


def test_restored_state_repeats_the_motion_and_the_time(odd: Odd, version: int) -> None:
    slave = odd(**saving(version))
    slave.step_to(3 * MS)
    state = slave.save_state()
    slave.step_to(8 * MS)
    first = slave.get("slide.x")
    slave.restore_state(state)
    assert slave.time_ns == 3 * MS
    assert slave.get("slide.x") == pytest.approx(0.3, abs=1e-12)
    slave.step_to(8 * MS)
    assert slave.get("slide.x") == first
    assert slave.save_state(state) is state
    slave.restore_state(state)
    assert slave.time_ns == 8 * MS


def test_state_that_cannot_be_saved_is_told(odd: Odd) -> None:
    slave = odd()
    assert not slave.can.can_save_state
    with pytest.raises(PlantError, match="cannot save its state"):
        slave.save_state()


@pytest.mark.parametrize(
    ("status", "is_done"), [(0, True), (1, True), (2, False), (3, False), (4, False)]
)
def test_a_state_that_is_taken_with_a_warning_is_taken(
    odd: Odd, version: int, status: int, is_done: bool
) -> None:
    """OK and WARNING; not DISCARD, ERROR, FATAL. After an error only freeing is allowed."""
    slave = odd(**saving(version))
    slave.step_to(3 * MS)
    state, stand_in = slave.save_state(), SimpleNamespace(calls=0)
    slave.step_to(4 * MS)

    def answer(*_any: Any) -> int:
        stand_in.calls += 1
        return status

    for name in ("_restore", "_save"):
        before = getattr(slave, name)
        setattr(slave, name, answer)
        act = slave.restore_state if name == "_restore" else slave.save_state
        if is_done:
            act(state)
            assert slave.time_ns == state.time_ns
        else:
            with pytest.raises(PlantError, match=f"{name[1:]} the state"):
                act(state)
        setattr(slave, name, before)
    assert (stand_in.calls, slave.time_ns) == (2, 3 * MS if is_done else 4 * MS)
    assert slave._can_terminate is is_done
    assert slave._is_fatal is (status == 4)
    slave._is_fatal = False


# ---- loading


def test_library_without_optional_functions_loads(odd: Odd) -> None:
    """odd.c has no strings, no derivatives, no clocks, no reset."""
    odd().step_to(1 * MS)


def test_function_that_is_missing_and_needed_is_named(odd: Odd) -> None:
    level = Exchange(odd(), ["level"])
    with pytest.raises(UserError, match=r"has no function fmi[23]SetBoolean"):
        level.write()


def test_fmu_that_exists_once_per_process_is_refused_a_second_time(odd: Odd) -> None:
    first = odd(canBeInstantiatedOnlyOncePerProcess=True)
    for name in ("second", "odd"):
        with pytest.raises(UserError, match=r"only once in a process and is already plant odd"):
            odd(name=name, canBeInstantiatedOnlyOncePerProcess=True)
    first.close()
    odd(name="third", canBeInstantiatedOnlyOncePerProcess=True).step_to(1 * MS)


def test_failed_load_leaves_the_working_directory(fmu: Callable[..., Path], tmp_path: Path) -> None:
    """The library is no library; the hint says what the FMU needs."""
    spoilt = tmp_path / "spoilt.fmu"
    good = fmu(needsExecutionTool=True)
    with ZipFile(good) as old, ZipFile(spoilt, "w") as new:
        for name in old.namelist():
            new.writestr(name, b"no library" if "binaries" in name else old.read(name))
    before = Path.cwd()
    with pytest.raises(UserError, match=r"cannot be loaded.*needs the tool that made it") as error:
        load_fmu(spoilt, "odd")
    assert Path.cwd() == before
    assert re.match(re.escape(str(spoilt)), str(error.value))
