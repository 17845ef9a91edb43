"""A budget of several: motions without which there is no value, causes, sources of a signal."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from tests.tools.test_budget_of_a_run import ERROR, VELOCITY, recorded, result, settings
from tests.tools.test_budget_parts import Game, Ran, row
from tests.tools.test_budget_signs import INCREMENT_UM, PLANS, latched, running
from tests.tools.test_rows_of_a_budget import budget, share

from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.record.signal_sources import HELD, STAMPED
from axisrig.bench.tools.budget import budget as made_here
from axisrig.bench.tools.budget.budget import _Runs, _with_motion, make_budget
from axisrig.bench.tools.budget.causes import Active, causes
from axisrig.bench.tools.budget.combining import MOST, combined
from axisrig.bench.tools.budget.encoder import is_stamped
from axisrig.bench.tools.budget.observed_run import Seen, see
from axisrig.bench.tools.budget.words import budget_table
from axisrig.kernel.errors import UserError

pytestmark = pytest.mark.interpreted


def test_every_motion_without_which_there_is_no_value_is_named() -> None:
    run_up, braking = (each for each in causes() if each.place == "motion")
    refused = "plant:probe.trigger_delay_us"
    found = [Active(each, "", "", {refused: "1"}) for each in (run_up, braking)]
    kept, names = _with_motion(_Runs(row(), "Z", Ran(refused)), found)
    assert (kept, names) == ([], (run_up.cause, braking.cause))


@pytest.mark.parametrize("sign", [1, -1])
def test_the_rounding_has_its_own_share_beside_means_of_others(sign: int) -> None:
    """0.5 um of it in whatever order; pre-travel and trigger are 6 um where both are on."""

    def touched(inputs: Any) -> tuple[float, float, float | None, float | None]:
        both = (
            float(inputs["plant:probe.pretravel_um"]) > 0
            and float(inputs["plant:probe.trigger_delay_us"]) > 0
        )
        rounded = "drive:servo.encoder_increments" not in inputs
        return sign * (6.0 * both + 0.5 * rounded), sign * 10.0, 0.5, None

    made: list[Case] = []
    case = latched("plant:probe.pretravel_um=8", "plant:probe.trigger_delay_us=20")
    found = make_budget(case, "Z", running(touched, made))
    means = {each.cause.cause: each.combined_um for each in found.shares}
    assert means["encoder"] == pytest.approx(sign * 0.5)
    assert means["pre-travel"] == means["trigger"] == pytest.approx(sign * 3.0)
    assert [each.cause.cause for each in found.interacting] == ["pre-travel", "trigger"]


def every(on: set[int]) -> float:
    return 9.0 * (len(on) == 9)


@pytest.mark.parametrize("most", [MOST, 512, 10_000])
def test_no_more_runs_are_combined_than_the_most_of_all(most: int) -> None:
    """Nine that act on each other only all together need 512: one is switched off in turn."""
    error_um: Callable[[set[int]], float] = every
    found = combined(Game(9, error_um).runs, 1e-6, most)
    assert len(found.left_out) == 1
    assert sum(found.shares_um.values()) == pytest.approx(9.0)


@pytest.mark.parametrize(("off_um", "differs"), [(0.005, None), (-0.005, None), (0.02, 0.02)])
def test_what_a_share_differs_by_is_in_its_row_above_an_increment_alone(
    off_um: float, differs: float | None
) -> None:
    """10 nm here; and above 1 % of its closed form."""
    made = budget(share("trigger", 0.1 + off_um, expected_um=0.1))
    first, left = budget_table(made)
    assert first["differs_um"] == (None if differs is None else pytest.approx(differs))
    assert left["differs_um"] is None


@pytest.mark.parametrize(
    ("source", "position", "is_handed"),
    [(HELD, "1", True), (HELD, "0", False), (STAMPED, "1", False), ("PLC", "1", False)],
)
def test_a_position_that_external_hardware_hands_over_comes_in_tenths_of_a_micrometre(
    source: str, position: str, is_handed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """FCT-C4 8.2.3; what the CNC takes itself has the increment of its drive, 10 mm/2^20."""
    given = Seen(4.0, 10.0, None, 4.0, None, source=source)
    monkeypatch.setattr(made_here, "see", lambda *_: given)
    case = only(read_plan(PLANS / "plc_sources.csv").cases, "ext-f600")
    case = replace(case, inputs={**case.inputs, "plc:V.E.POSITION": position})
    found = make_budget(case, "Z", running(lambda _: (4.0, 10.0, None, 4.0), []))
    assert found.increment_um == (0.1 if is_handed else INCREMENT_UM)


def with_sources(*sources: str) -> Any:
    runs = [SimpleNamespace(sources={"Z": source}) for source in sources]
    return SimpleNamespace(facts=SimpleNamespace(runs=runs))


@pytest.mark.parametrize(
    ("sources", "stamped"),
    [((STAMPED,), True), (("DRIVE",), False), (("DRIVE", STAMPED), True),
     ((STAMPED, "DRIVE"), False)],
)  # fmt: skip
def test_the_source_of_a_value_is_that_of_the_last_run(
    sources: Iterable[str], stamped: bool
) -> None:
    assert is_stamped(with_sources(*sources), "Z") is stamped
    assert not is_stamped(with_sources(*sources), "X")


@pytest.mark.parametrize(
    ("error", "words"),
    [("the plant failed", "no latch_error_um of p-a: the plant failed"),
     (None, "no latch_error_um of p-a: no latch")],
)  # fmt: skip
def test_a_run_without_a_value_says_first_what_has_broken_it_off(
    error: str | None, words: str
) -> None:
    """Else why the metric has none."""
    lacking = replace(result(recorded(), **{VELOCITY: -100.0}), error=error)
    with pytest.raises(UserError) as caught:
        see(lacking, "Z", settings())
    assert words in str(caught.value)
    assert ERROR in words
