"""The campaign of fault scenarios: its oracle sees a wrong value, and its runs repeat."""

import pytest

from axisrig.bench.tools.scenarios.campaign import Tally, run_scenario, run_scenarios
from axisrig.bench.tools.scenarios.oracle import Judgement, Result
from axisrig.bench.tools.scenarios.scenario import Scenario, make_scenario

INPUTS = ("plc:V.E.FEED1=900", "plc:V.E.FEED2=300", "plc:V.E.RETRACT=0.2")


def run(*faults: str) -> Judgement:
    return run_scenario(Scenario(0, 1, (*INPUTS, *faults)))


@pytest.mark.long
def test_without_a_fault_both_values_are_right() -> None:
    """Printed and published, for two measurement runs."""
    judgement = run()
    assert (judgement.result, judgement.right, judgement.alarms) == (Result.GOOD, 4, [])


@pytest.mark.long
def test_the_oracle_does_not_believe_the_bench(monkeypatch: pytest.MonkeyPatch) -> None:
    """A published value that is two increments off is called wrong."""
    from axisrig.kernel.drives.canopen.link import AxisLink  # noqa: PLC0415

    true_mm = AxisLink.latched_mm.fget  # type: ignore[attr-defined]

    def shifted(link: AxisLink) -> float | None:
        value: float | None = true_mm(link)
        return None if value is None else value + 2 / 104_857.6

    monkeypatch.setattr(AxisLink, "latched_mm", property(shifted))
    assert run().broken == ("value",)


@pytest.mark.long
def test_the_oracle_looks_up_the_position_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """A drive that latches between two steps wrongly, by two increments, is seen."""
    from axisrig.kernel.cosim.plant import axis  # noqa: PLC0415

    true = axis.hermite
    off_m = 2e-3 / 104_857.6
    monkeypatch.setattr(axis, "hermite", lambda *of: true(*of) + off_m)
    assert run().broken == ("value",)


@pytest.mark.long
def test_a_scenario_is_the_same_whenever_it_is_run() -> None:
    assert make_scenario(1, 56) == make_scenario(1, 56)
    assert make_scenario(1, 56) != make_scenario(2, 56)
    first, second = (list(run_scenarios(3, 40, 4)) for _ in range(2))
    assert first == second


def test_the_tally_counts_every_scenario_and_names_the_defects() -> None:
    tally = Tally()
    bad = Scenario(7, 1, ("fault:drop=Z.TPDO1",))
    tally.add(bad, Judgement(Result.BROKEN, note="value: off by 3", broken=("value",)))
    tally.add(bad, Judgement(Result.ALARM, [900006], 2))
    text = tally.table()
    assert "2 scenarios" in text
    assert "scenario 7: AN INVARIANT DOES NOT HOLD: value: off by 3" in text
    assert "alarm 900006, 1 values right before it" in text
