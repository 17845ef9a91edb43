"""Another edge from the next run on, the speed at a latch, and what a fault of a drive says."""

from dataclasses import replace

import pytest
from tests.speed_drive.ends import FAMILIES, MILLISECOND, SETTINGS, Ends

from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.drives.speed_drive.link import SpeedDrive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS, US

DELAY_NS = 4 * US
"""Of the input."""
READY, OPERATES, FAULT = 1, 2, 4
STEP_MM = {"lightbus": 1e-3}
"""LATCH32 counts um."""


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("speed_mm_s", [10.0, -20.0])
def test_another_edge_counts_from_the_next_run_on(family: str, speed_mm_s: float) -> None:
    """There and back; each value is where the axis was, and the travel of its cycle v T."""
    chosen = ["POS"] * 4 if family == "encoder_terminal" else ["POS", "NEG", "POS", "NEG", "NEG"]
    edges = [round((30.3 + 20 * n + 7 * late) * MS) for n in range(len(chosen)) for late in (0, 1)]

    def position_m(time_s: float) -> float:
        return (100.0 + speed_mm_s * max(0.0, time_s - 0.02)) * 1e-3

    ends = Ends(family, position_m, edges, MILLISECOND)
    found: list[tuple[float, float]] = []

    def run(link: SpeedDrive) -> None:
        if link.is_clear and ends.now_ns > edges[0] - 9 * MS + len(found) * 20 * MS:
            link.arm()
        elif link.latched_mm is not None and link.is_probing:
            found.append((link.latched_mm, link.latched_speed_mm))
            link.disarm()
            if len(found) < len(chosen):
                link.choose_latch(1, chosen[len(found)])

    while len(found) < len(chosen) and ends.number < 400:
        ends.cycle(run)
    increment_mm = 1.0 / float(FAMILIES[family].table.per_mm)
    for number, ((value_mm, travel_mm), edge) in enumerate(zip(found, chosen, strict=True)):
        instant_ns = edges[2 * number + (edge == "NEG")] + DELAY_NS
        true_mm = position_m(instant_ns * 1e-9) * 1e3
        assert abs(value_mm - true_mm) <= increment_mm / 2 + STEP_MM.get(family, 0.0) / 2 + 1e-9
        assert travel_mm == pytest.approx(speed_mm_s * 1e-3, abs=increment_mm)


@pytest.mark.parametrize("family", FAMILIES)
def test_a_fault_says_its_word_and_no_number_and_homing_is_refused(family: str) -> None:
    """On, off, on; DRIVE as each message has it. Nothing is asked, nothing comes by itself."""
    made = FAMILIES[family]
    port = ImagePort()
    link = made.link(replace(SETTINGS, axis="Q", echo_cycles=1), port, lambda: 0)
    link.order(PowerOrder.SWITCH_ON)
    words = (
        (READY | FAULT, "FAULT", "0x05"),
        (READY, "READY", "0x01"),
        (READY | OPERATES | FAULT, "FAULT", "0x07"),
        (READY | OPERATES, "OPERATION", "0x03"),
        (0, "NOT_READY", "0x00"),
    )
    for drive, name, text in words:
        port.receive(made.images[1].packed({"DRIVE": drive}))
        link.take()
        assert (link.is_in_fault, link.state_name) == (name == "FAULT", name)
        link.acknowledges_faults = True
        link.ask_for_fault()
        assert (link.is_asked, link.has_reported, link.is_prepared) == (False, False, True)
        fault, left = link.fault(), link.left_operation()
        assert (fault.id, fault.values) == (
            900005,
            {"axis": "Q", "statusword": text, "emcy": "none"},
        )
        assert (left.id, left.values) == (900027, {"axis": "Q", "statusword": text, "state": name})
        link.forget_fault()
        assert not link.acknowledges_faults
    with pytest.raises(Alarm) as raised:
        link.home(None)  # type: ignore[arg-type]
    assert (raised.value.id, raised.value.values) == (900782, {"axis": "Q"})
