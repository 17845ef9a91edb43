"""A run that its plant, its time or its input broke off leaves what it has and what was printed."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of
from tests.recordings import facts

from axisrig.bench.campaign import preparing, runner
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.machine.machine import SimulatedTimeoutError
from axisrig.bench.plan.assignment import parse_column
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.errors import UserError

ERRORS = (
    PlantError("plant", 5, "it broke"),
    SimulatedTimeoutError("600 s"),
    UserError("a wrong file"),
)


class Broken:
    """A machine whose run raises."""

    def __init__(self, error: Exception, closed: list[bool]) -> None:
        self._error, self._closed = error, closed
        self.recorder = SimpleNamespace(series=lambda: SimpleNamespace(released=lambda: "series"))

    def run(self) -> int:
        raise self._error

    def close(self) -> None:
        self._closed.append(True)


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("has_parameters", [True, False])
def test_a_run_that_is_broken_off_has_what_it_left(
    error: Exception, has_parameters: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    closed: list[bool] = []
    left, settings = facts(), SimpleNamespace(rig="the rig")

    def facts_of(_machine: object, *, broken_by: Exception) -> Any:
        assert broken_by is error
        if not has_parameters:
            raise PlantError("plant", 5, "none")
        return left

    monkeypatch.setattr(runner, "recall", lambda _: None)
    monkeypatch.setattr(runner, "read_case", lambda _: (settings, "program"))
    monkeypatch.setattr(runner, "Machine", lambda *_, **__: Broken(error, closed))
    monkeypatch.setattr(runner, "facts_of", facts_of)
    monkeypatch.setattr(runner, "printed_log", lambda given: [f"printed by {given.rig}"])
    times = iter([10.0, 11.0, 14.5])
    result = runner.run_case(case_of("a"), RunFiles(), lambda: next(times))
    assert (result.verdict, result.error, result.wall_s) == (Verdict.ERROR, str(error), 4.5)
    assert result.log[-1] == "printed by the rig"
    assert (result.facts, result.series) == ((left, "series") if has_parameters else (None, None))
    assert closed == [True]


def test_a_machine_that_cannot_be_built_is_an_error_of_its_row(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def build(*_: object, **__: object) -> None:
        raise UserError("no such axis")

    monkeypatch.setattr(runner, "recall", lambda _: (None, None))
    monkeypatch.setattr(runner, "Machine", build)
    result = runner.run_case(case_of("a"), RunFiles())
    assert (result.verdict, result.error) == (Verdict.ERROR, "no such axis")
    assert result.facts is None


# Variables that nothing uses

COLUMN = "plc:V.E.FED"


@pytest.mark.parametrize(
    ("place", "overridden", "is_refused"),
    [
        (("p.csv", 2), (), True),  # a cell of the row itself
        (("p.csv", 9), (), False),  # of a row of defaults
        (("base.csv", 2), (), False),  # of another file
        (("p.csv", 2), (COLUMN,), False),  # --set puts it into every row
        (None, (), False),
    ],
)
def test_a_variable_is_refused_in_the_row_that_names_it(
    place: tuple[str, int] | None,
    overridden: tuple[str, ...],
    is_refused: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    used = SimpleNamespace(
        has=lambda name: name != COLUMN,
        error=lambda item, _: UserError(f"{item.name} is not used", hint="V.E.FEED"),
    )
    monkeypatch.setattr(preparing, "used_variables", lambda *_: used)
    known: Any = {}
    if place is not None:
        known[COLUMN] = SimpleNamespace(file=case_of(place[0]).file.with_name(place[0]),
                                        line=place[1], column=4, words="a cell")  # fmt: skip
    items = [parse_column(name, "1") for name in (COLUMN, "plc:override_pct")]
    case: Any = SimpleNamespace(
        file=case_of("p").file,
        line=2,
        places=known,
        overridden=frozenset(overridden),
        program="a.nc",
        assignments=lambda: items,
        error=lambda message, column, **_: UserError(f"{column}: {message}"),
    )
    found = [str(error) for error in preparing._wrong_variables(case, None, None)]  # type: ignore[arg-type]
    assert found == ([f"{COLUMN}: V.E.FED is not used"] if is_refused else [])
