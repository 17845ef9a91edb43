"""What passes to the PLC side at one instant stands in the order of the program everywhere."""

from collections.abc import Callable
from typing import Any

from axisrig.bench.judge.program.findings import program_notes
from axisrig.bench.judge.topics import events


def said(out: Any) -> list[str]:
    """What `axisrig nc` notes of the PLC side."""
    return [text for text, _ in program_notes(out.facts)]


def test_the_events_of_one_instant_keep_the_order_of_the_program(
    run_nc: Callable[..., Any],
) -> None:
    """In the order of the alphabet V.E.DONE would be the last."""
    out = run_nc(
        "N10 M9\nN20 V.E.DONE = 1\nN30 M7\nN40 V.E.DONE = 2\nN50 M1\nN60 M8",
        "",
        "plc:V.E.DONE=0",
        "plc:start_ms=0",
        "plc:optional_stop=1",
    )
    wanted = ["M9 to", "V.E.DONE = 1", "M7 to", "V.E.DONE = 2", "M1: stop", "M1: started", "M8 to"]
    labels = [event.label for event in events(out.observed)]
    found = [label for label in labels if label.startswith(("M", "V.E."))]
    for seen in (found, [line.split(" s: ")[1] for line in said(out)]):
        assert [line[: len(want)] for line, want in zip(seen, wanted, strict=True)] == wanted
