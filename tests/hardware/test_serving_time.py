"""How long the drives of a rig run for a master outside: for a time, or until they are stopped."""

import time
from contextlib import nullcontext
from pathlib import Path

import pytest

from axisrig.bench.bus.paced import RealTime
from axisrig.bench.campaign.hardware_runs import Outside
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.tools.virtual_drive.serve import drive_settings, serve

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z.toml"


@pytest.mark.parametrize(("for_s", "asked"), [(0.0, 1), (None, 4)])
def test_without_a_time_the_operator_stops_them(for_s: float | None, asked: int) -> None:
    """The fourth look at Ctrl-C finds it; after no time at all there is one look."""
    looks: list[int] = []

    def stop() -> bool:
        looks.append(1)
        return len(looks) > 3

    hardware = Hardware(RealTime(time.monotonic_ns, time.sleep), stop)
    outside = Outside(
        lambda: nullcontext(hardware), True, lambda _: None,
        interface="virtual", channel=f"serving-{asked}",
    )  # fmt: skip
    settings = drive_settings(RIG, outside, [], [])
    serve(settings, outside, lambda _: None, by_sync=False, folder=None, for_s=for_s)
    assert len(looks) == asked
