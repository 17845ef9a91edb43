"""One program on one rig (`axisrig nc`): what is built, what is refused, what it ends with."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import single_program
from axisrig.bench.campaign.single_program import Ended, run_program
from axisrig.bench.machine.machine import SimulatedTimeoutError
from axisrig.kernel.cosim.fmi.library import PlantError
from axisrig.kernel.errors import UserError

PROGRAM, RIG = Path("part.nc"), Path("rig.toml")


class Stage:
    """Stands in for the machine and for what is read before it is built."""

    def __init__(self, patch: pytest.MonkeyPatch, error: Exception | None = None) -> None:
        self.did: list[Any] = []
        self._error = error
        table = SimpleNamespace(axis={"X": 1, "Z": 2})
        patch.setattr(single_program, "read_rig", lambda path: (table, [path]))
        patch.setattr(single_program, "read_settings", self._settings)
        patch.setattr(single_program, "read_program", lambda path, axes: (path, axes))
        used = SimpleNamespace(
            has=lambda column: column != "plc:V.E.NONE",
            error=lambda item, path: UserError(f"{item.column} in {path}", value=item.value),
        )
        patch.setattr(single_program, "used_variables", lambda *_: used)
        patch.setattr(single_program, "Machine", self._machine)
        patch.setattr(single_program, "facts_of", lambda _, sim_ns: sim_ns)
        patch.setattr(single_program, "program_notes", lambda _: [("a note", False), ("bad", True)])

    def _settings(self, table: Any, files: Any, changes: Any) -> Any:
        self.did.append([(item.column, item.value) for item, _ in changes])
        return "settings"

    def _machine(self, settings: object, parsed: object, **given: Any) -> Any:
        self.did.append((settings, parsed, given))
        return SimpleNamespace(run=self._run, close=lambda: self.did.append("closed"))

    def _run(self) -> int:
        if self._error is not None:
            raise self._error
        return 5


def run(*assignments: str, hardware: Any = None) -> list[Ended]:
    return run_program(PROGRAM, RIG, assignments, [Path("a.blf")], print, hardware)


def test_a_program_runs_with_its_inputs_and_ends_with_its_notes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stage = Stage(monkeypatch)
    assert run("plc:V.E.FEED=5", hardware="bus") == [Ended("a note", False), Ended("bad", True)]
    given = {"bus_logs": [Path("a.blf")], "put_out": print, "hardware": "bus"}
    assert stage.did == [
        [("plc:V.E.FEED", "5")], ("settings", (PROGRAM, ("X", "Z")), given), "closed"
    ]  # fmt: skip


@pytest.mark.parametrize(
    "error", [PlantError("z", 5_000_000, "it broke"), SimulatedTimeoutError("no end after 600 s")]
)
def test_what_breaks_a_run_names_the_program_and_the_machine_is_taken_down(
    error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = Stage(monkeypatch, error)
    with pytest.raises(UserError) as caught:
        run()
    assert (caught.value.file, caught.value.message) == (str(PROGRAM), str(error))
    assert stage.did[-1] == "closed"


def test_a_variable_that_nothing_uses_is_refused_before_anything_is_built(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Also behind one that is used; inputs that are no variables are none of it."""
    stage = Stage(monkeypatch)
    with pytest.raises(UserError, match=r"--set plc:V\.E\.NONE in part\.nc") as caught:
        run("set:Z.a=1", "plc:V.E.FEED=5", "plc:V.E.NONE=7")
    assert caught.value.value == "7"
    assert len(stage.did) == 1


@pytest.mark.parametrize("hint", ["did you mean V.E.FEED?", None])
def test_a_variable_that_is_near_one_of_the_program_is_shown_that(
    monkeypatch: pytest.MonkeyPatch, hint: str | None
) -> None:
    Stage(monkeypatch)
    used = SimpleNamespace(
        has=lambda _: False, error=lambda item, _: UserError("odd", value=item.value, hint=hint)
    )
    monkeypatch.setattr(single_program, "used_variables", lambda *_: used)
    with pytest.raises(UserError, match="--set odd") as caught:
        run("plc:V.E.FED=7")
    assert (caught.value.value, caught.value.hint) == ("7", hint)
