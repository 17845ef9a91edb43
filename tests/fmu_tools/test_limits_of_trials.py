"""Trials of an FMU at their limits: versions, inner steps, first readings, bounds; no FMU."""

import math
import struct
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import texts
from tests.fmu_tools.test_fmu_trial_run import OUTPUTS, reading
from tests.fmu_tools.test_libraries_and_states import BYTES_CAN, FMI2, FMI3, library, packing
from tests.fmu_tools.test_trials_and_roles import Slave as Instance
from tests.fmu_tools.test_trials_and_roles import variable
from tests.fmu_tools.trials import CAN

from axisrig.bench.tools.fmu import stages, stepped_instance
from axisrig.bench.tools.fmu.courses import course_findings
from axisrig.bench.tools.fmu.findings import Finding
from axisrig.bench.tools.fmu.stepped_instance import first_difference
from axisrig.kernel.time.clock import US

FMU = Path("a.fmu")


@pytest.mark.parametrize(("prefix", "plain"), [("fmi2", FMI2), ("fmi3", FMI3)])
def test_a_version_that_is_no_utf_8_is_shown_as_far_as_it_is(
    prefix: str, plain: list[str], fake: Any
) -> None:
    """U+FFFD stands for what is none. The number before the point counts."""
    version = f"{prefix[-1]}.0".encode() + b"\xff"
    library(fake, prefix, plain, version, can_save_state=False)
    (found,) = stages.load(FMU).findings
    assert (found.level, found.area) == ("ok", "library")
    assert found.text == f"loads, has every function needed, version {prefix[-1]}.0\ufffd"


@pytest.mark.parametrize("inner_us", [15, 50, 55, 100, 250, 251, 1000])
def test_an_inner_step_is_a_whole_number_of_nanoseconds(
    inner_us: int, fake: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """15e-6 s times 1e9 is 14999.999999999998 as a double."""
    given: list[int] = []

    def judged(_: Path, inner_ns: int) -> list[Finding]:
        given.append(inner_ns)
        return []

    fake(can=SimpleNamespace(**{**CAN, "fixed_step_s": float(f"{inner_us}e-6")}))
    monkeypatch.setattr(stages, "course_findings", judged)
    warnings = texts(stages.steps(FMU).findings, "warn")
    assert given == [inner_us * US]
    words = f"its own step of {inner_us / 1000:g} ms is longer than those of the bench"
    assert warnings == ([words] if inner_us > 250 else [])


@pytest.mark.parametrize("odd_at", [0, 1, 50, 100])
def test_each_reading_after_a_reset_is_compared_that_of_the_start_too(
    fake: Any, odd_at: int
) -> None:
    def odd(trial: Any, count: int) -> float:
        return 0.5 * (hasattr(trial, "was_reset") and count == odd_at)

    fake(odd=staticmethod(odd))
    (found,) = stages.reset(FMU).findings
    assert (found.area, found.level) == ("reset", "warn")
    values = f"{odd_at}.0 and {odd_at}.5"
    assert found.text == f"a run after reset differs: x at t = {odd_at} ms is {values}"
    assert found.remedy == "the bench makes new instances instead"


def test_a_state_that_is_off_by_less_than_an_increment_is_tried_through_bytes_too(
    fake: Any,
) -> None:
    """Only what cannot be used at all is not tried any further."""

    def odd(trial: Any, count: int) -> float:
        return 1e-9 * (trial.restores > 0 and count == 40)

    made = fake(can=BYTES_CAN, prepare=staticmethod(packing), odd=staticmethod(odd))
    found = stages.state(FMU).findings
    assert [(one.area, one.level) for one in found] == [
        ("state", "warn"), ("state as bytes", "warn"),
    ]  # fmt: skip
    assert [call[0] for call in made.last.slave.calls] == ["pack", "unpack", "set", "free"]


@pytest.mark.parametrize(("off", "level"), [(0.0, "ok"), (1.0, "warn"), (2.0, "FAIL")])
def test_a_state_may_be_off_by_exactly_the_bound(off: float, level: str) -> None:
    """1 of 1e9 is 1e-9 of the range."""
    one, other = ([reading(0, (1e9 - each,), (1,))] for each in (0.0, off))
    trial: Any = SimpleNamespace(outputs=OUTPUTS)
    found = stages._compared("state", "restored", one, other, trial)
    assert found.level == level


@pytest.mark.parametrize("length", [1, 2, 41, 99])
def test_instances_that_end_by_themselves_are_compared_up_to_their_end(
    fake: Any, length: int
) -> None:
    """An odd number of steps is shared by the two as well."""
    fake(ends_after=length)
    assert [one.level for one in stages.instances(FMU).findings] == ["ok"]
    for name in ("one", "two"):

        def odd(one: Any, at: int, name: str = name) -> float:
            return 0.5 * (one.name == name and at == length)

        fake(ends_after=length, odd=staticmethod(odd))
        (found,) = stages.instances(FMU).findings
        values = f"{length}.0 and {length}.5"
        assert found.text == (f"two instances disturb each other: x at t = {length} ms is {values}")
        assert found.level == "FAIL"


def test_two_numbers_that_are_none_differ_by_their_bits() -> None:
    """IEEE 754, 6.2: a NaN has a payload. Memory that was never written may be one."""
    nans = [struct.unpack("<d", struct.pack("<Q", 0x7FF8 << 48 | payload))[0] for payload in (0, 1)]
    assert all(map(math.isnan, nans))
    one, other = ([reading(2, (1.0,), (each,))] for each in nans)
    assert first_difference(one, list(one), OUTPUTS) is None
    assert first_difference(one, other, OUTPUTS) == "b at t = 2 ms is nan and nan"


class Sampled(Instance):
    """An FMU that looks at its input at the begin of each period and gives it out."""

    def __init__(self, period_ns: int) -> None:
        super().__init__([variable("u", 1, causality="input"), variable("y", 2)])
        for one in self.description.modelVariables:
            one.variability = "continuous"
        self._period_ns, self.given, self.held = period_ns, 0.0, 9.0
        self.fmpy = SimpleNamespace(
            setFloat64=self._put, getFloat64=lambda _references: [self.held]
        )

    def _put(self, _references: list[int], values: list[float]) -> None:
        (self.given,) = values

    def step_to(self, time_ns: int) -> None:
        if self.time_ns % self._period_ns == 0:
            self.held = self.given
        super().step_to(time_ns)


@pytest.mark.parametrize(
    ("period_us", "held"),
    [(50, None), (100, None), (150, None), (200, None), (250, None), (300, "0.3"), (400, "0.4"),
     (500, "0.5"), (1000, "1"), (2000, "2"), (4000, "4")],
)  # fmt: skip
def test_an_fmu_that_looks_at_its_inputs_now_and_then_only_stands_still_between(
    period_us: int, held: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """4 times in 1 ms is fine enough; whenever it looks, it finds another value."""
    monkeypatch.setattr(stepped_instance, "load_fmu", lambda *_: Sampled(period_us * US))
    found = texts(course_findings(FMU, 0), "FAIL")
    assert found == ([] if held is None else [f"its outputs stand still for steps below {held} ms"])


def test_inputs_that_drift_have_another_value_in_every_step() -> None:
    """A swing of up to 2 per mille of the start value, and a drift below half a per mille."""
    one = variable("u", start="2000")
    values = [
        value
        for count in range(450)
        for _, value in stepped_instance._moved_inputs([one], count, 1e-3 * count)
    ]
    assert len(set(values)) == 450
    assert all(abs(value - 2000.0) < 2.5e-3 * 2000.0 for value in values)
