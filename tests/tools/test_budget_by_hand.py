"""A budget by hand: its increment, what is apart, columns in other units, its probe."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from tests.tools.test_budget import causes_off, probe_row

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.record.signal_sources import HELD, STAMPED
from axisrig.bench.tools.budget import budget as made
from axisrig.bench.tools.budget.budget import Share, _combine, _without, make_budget
from axisrig.bench.tools.budget.causes import ROUNDING, _column, causes
from axisrig.bench.tools.budget.combining import combined, groups
from axisrig.bench.tools.budget.observed_run import Seen

UNIT_UM = 0.1
"""A position of the HLI."""


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("source", "is_handed", "latches_um", "increment_um"),
    [
        (HELD, True, 5.0, 5.0),
        (HELD, True, 0.02, UNIT_UM),
        (HELD, False, 0.02, 0.02),
        (STAMPED, True, 0.02, 0.02),
        ("DRIVE", True, 0.02, 0.02),
    ],
)
def test_a_position_that_a_plc_hands_over_is_of_the_coarser_of_both_units(
    source: str,
    is_handed: bool,
    latches_um: float,
    increment_um: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of another source it does not matter what the PLC could hand over."""

    def ran(cases: Sequence[Any]) -> Iterable[CaseResult]:
        found: list[Any] = [SimpleNamespace(case=case, frame_log_sha256="ab") for case in cases]
        return found

    seen = Seen(3.0, -10.0, None, None, None, source=source)
    monkeypatch.setattr(made, "see", lambda *_: seen)
    monkeypatch.setattr(made, "is_handed", lambda _: is_handed)
    monkeypatch.setattr(made, "increment_of_value_um", lambda *_: latches_um)
    monkeypatch.setattr(made, "active_causes", lambda *_, **__: [])
    assert make_budget(probe_row(), None, ran).increment_um == increment_um


def test_the_rounding_has_what_it_adds_alone_beside_means_of_the_others() -> None:
    """1 um of 0 alone and 6 um of 0 and 2 together; 1 rounds, and is in no combination."""
    found = [each for each in causes() if each.form != ROUNDING][:2]
    rounding = next(each for each in causes() if each.form == ROUNDING)
    order = [found[0], rounding, found[1]]
    of_on = causes_off(3, lambda on: 1.0 * (0 in on) + 6.0 * ({0, 2} <= on) + 0.3 * (1 in on))
    runs: Any = SimpleNamespace(
        active=[SimpleNamespace(cause=cause) for cause in order],
        make=of_on.make,
        error_um=of_on.error_um,
    )
    shares = [Share(cause, "", 0.3 + place, 9.0, None, None) for place, cause in enumerate(order)]
    combined_um, left_out = _combine(runs, shares, 0.1, 64)
    assert [share.combined_um for share in combined_um] == pytest.approx([4.0, 1.3, 3.0])
    assert [share.interacts for share in combined_um] == [True, False, True]
    assert left_out == ()


@pytest.mark.parametrize(
    ("column", "changed"),
    [
        ("plant:probe.pretravel_mm", "plant:probe.pretravel_um"),
        ("plant:probe.pretravel_um", "plant:probe.pretravel_um"),
        ("plant:probe.pretravel", "plant:probe.pretravel_um"),
        ("plant:probe.trigger_delay_ms", "plant:probe.trigger_delay_us"),
    ],
)
def test_what_is_switched_off_takes_the_place_of_its_column_in_whatever_unit(
    column: str, changed: str
) -> None:
    """Two columns of one value would be refused, or the wrong one would count."""
    case = probe_row()
    inputs = {"drive:servo.input_delay_us": "7", column: "0.008"}
    case = replace(case, inputs=inputs)
    found = _without(case, "Z", "run-1", {changed: "0"})
    assert found.inputs == {"drive:servo.input_delay_us": "7", changed: "0"}
    assert found.run == "run-1"
    taken = _without(case, "Z", "run-2", {column: None})
    assert taken.inputs == {"drive:servo.input_delay_us": "7"}
    # The same name at another place is another value
    beside = replace(case, inputs={column.replace("probe.", "other."): "1"})
    assert _without(beside, "Z", "run-3", {changed: "0"}).inputs == {
        column.replace("probe.", "other."): "1", changed: "0"
    }  # fmt: skip


@pytest.mark.parametrize(
    ("own", "at_terminal", "probe"),
    [("own", None, "own"), (None, "other", "other"), ("own", "other", "own")],
)
def test_the_probe_of_an_axis_is_its_own_before_that_of_the_terminal(
    own: str | None, at_terminal: str | None, probe: str
) -> None:
    axis = SimpleNamespace(probe_1=own, plant="z", drive="servo")
    terminal = SimpleNamespace(inputs={"1": at_terminal}) if at_terminal else None
    task = SimpleNamespace(terminal=terminal)
    settings: Any = SimpleNamespace(rig=SimpleNamespace(axis={"Z": axis}, plc_task=task))
    cause = next(each for each in causes() if each.cause == "pre-travel")
    assert _column(settings, "Z", cause, cause.key) == f"plant:{probe}.pretravel_um"


def test_who_depends_on_others_in_turn_alone_is_combined() -> None:
    """1 has 8 um with 0 and without 2: none as the first, none as the last one, 8 in turn.

    0 and 3 have 3 um together; of 4 runs there is room for two causes.
    """

    def error_um(on: set[int]) -> float:
        return 8.0 * ({0, 1} <= on) * (2 not in on) + 3.0 * ({0, 3} <= on)

    runs = causes_off(4, error_um)
    assert groups(runs, 1e-6) == [[0, 1, 2, 3]]
    found = combined(runs, 1e-6, 4)
    assert found.left_out == {0, 3}
    assert sum(found.shares_um.values()) == pytest.approx(3.0)
