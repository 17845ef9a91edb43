"""Parts of a budget: the way up to the first and last SYNC, and the probe of a terminal."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.tools.test_budget_closed_forms import moved_um, seen, track

from axisrig.bench.tools.budget.causes import probe_of, terminal_probe


@pytest.mark.parametrize("at_ms", [-2.0, -1.999, 5.5, 6.0])
def test_the_way_of_a_motion_is_known_up_to_its_first_and_last_sync(at_ms: float) -> None:
    """SYNCs from 2 ms before the contact to 6 ms after it; 8 steps."""
    motion = track()
    assert motion.position_um(at_ms) - motion.position_um(0.0) == pytest.approx(
        moved_um(0.0, at_ms)
    )


@pytest.mark.parametrize("source_um", [None, 4.0])
@pytest.mark.parametrize("latch_ms", [None, 0.5])
def test_a_value_that_a_drive_has_latched_has_the_way_of_its_source_alone(
    latch_ms: float | None, source_um: float | None
) -> None:
    """-30 um of error; an instant is known of both, 0.5 ms after the contact."""
    given: dict[str, Any] = {"value_ms": 0.5, "between_um": 0.25, "lost_um": 0.125}
    found = seen(latch_ms=latch_ms, source_um=source_um, **given)
    until_um = moved_um(0.0, 0.5)
    if latch_ms is None:
        assert found.way_um == found.delayed_um == pytest.approx(until_um + 0.375)
    else:
        assert found.delayed_um == pytest.approx(until_um)
        assert found.way_um == (None if source_um is None else -34.0)


@pytest.mark.parametrize("wired", [("left", "right"), ("right", "left"), ("left",)])
def test_the_probe_of_a_terminal_is_that_at_its_first_input(wired: tuple[str, ...]) -> None:
    inputs = {str(number): name for number, name in enumerate(wired, 1)}
    task = SimpleNamespace(terminal=SimpleNamespace(inputs=inputs))
    axis = {"Z": SimpleNamespace(probe_1=None), "X": SimpleNamespace(probe_1="own")}
    settings: Any = SimpleNamespace(rig=SimpleNamespace(plc_task=task, axis=axis))
    assert terminal_probe(settings) == wired[0]
    assert (probe_of(settings, "Z"), probe_of(settings, "X")) == (wired[0], "own")
    task.terminal = None  # type: ignore[assignment]
    assert terminal_probe(settings) is None
    assert probe_of(settings, "Z") == ""
