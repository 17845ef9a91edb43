"""Metrics of a measurement run, of what the plant and the record say."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.judge.metrics import observe
from axisrig.bench.judge.observe import Touch
from axisrig.bench.plan.checks import parse_check
from axisrig.kernel.cosim.plant.probe import Contact
from axisrig.kernel.time.clock import MS, US

CONTACT_NS = 123_456_789


def told(metric: str, period_ns: int, end_ns: int | None) -> Any:
    """Observe a metric of a run of Z whose contact came at CONTACT_NS."""
    record: Any = SimpleNamespace(end_ns=end_ns, axes=("Z",), fixed_stop=None)
    touch = Touch(record, Contact(CONTACT_NS, {"z": 100.0}), None, end_ns or 0, 1.0, True)
    observed: Any = SimpleNamespace(
        machine=SimpleNamespace(
            links={"Z": None}, timing=SimpleNamespace(period_ns=period_ns), settings=None
        ),
        hides=lambda *_: "",
        about=lambda *_: ["Z"],
        touch=lambda _: touch,
        moved_axis=lambda _: "Z",
    )
    return observe(observed, parse_check(metric, "> 0", ""))


@pytest.mark.parametrize("period_ms", [1, 2])
def test_contact_to_standstill_is_known_to_a_period(period_ms: int) -> None:
    """The axes stand in a cycle; that they stood one earlier it cannot have seen."""
    end_ns = 200 * MS + 600 * US
    found = told("contact_to_standstill_ms", period_ms * MS, end_ns)
    assert found.value == (end_ns - CONTACT_NS) / 1e6 == 77.143211
    assert found.uncertainty == period_ms


def test_a_run_that_did_not_end_has_no_standstill() -> None:
    found = told("contact_to_standstill_ms", MS, None)
    assert (found.value, found.note) == (None, "the measurement run did not end")
