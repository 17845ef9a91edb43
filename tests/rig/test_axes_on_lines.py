"""Axes on EtherCAT lines: keys that are about CAN alone, latches, clocks where there are none."""

from collections.abc import Callable

import pytest

from axisrig.bench.rig.ethercat import on_line as lines
from axisrig.bench.rig.ethercat.on_line import on_line
from axisrig.bench.rig.ethercat.schedule import schedule_of
from axisrig.bench.rig.ethercat.timing import phases_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

Read = Callable[..., Settings]
PROBE = "probe-z-ethercat.toml"


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("boot", '"wait"', "there is no NMT"),
        ("boot", '"reset_node"', "there is no NMT"),
        ("heartbeat_ms", "20", "there is no heartbeat"),
        ("consumer_ms", "50", "there is no heartbeat"),
        ("guard_time_ms", "20", "there is no node guarding"),
        ("sync_window_us", "100", "there is no SYNC message"),
    ],
)
def test_a_key_that_is_about_can_is_refused_on_a_line(
    rig_above: Read, key: str, value: str, words: str
) -> None:
    settings = rig_above(PROBE, f"[drive.servo]\n{key} = {value}")
    with pytest.raises(UserError, match=words) as caught:
        on_line(settings, "Z").check(settings, "Z", 0)
    assert "drive servo of axis Z is on EtherCAT" in caught.value.message
    assert str(caught.value.value) == value.strip('"')
    assert str(caught.value.hint).startswith(f"leave {key} out")


def test_the_way_to_pre_operational_that_is_the_default_is_taken(rig_above: Read) -> None:
    settings = rig_above(PROBE, '[drive.servo]\nboot = "reset_communication"')
    on_line(settings, "Z").check(settings, "Z", 0)


@pytest.mark.parametrize("missing", [[], ["warning: no touch probe"]])
@pytest.mark.interpreted
def test_a_drive_without_a_touch_probe_has_no_words_about_its_proof(
    rig_above: Read, monkeypatch: pytest.MonkeyPatch, missing: list[str]
) -> None:
    """The warning is in their place."""
    monkeypatch.setattr(lines, "missing_touch_probe", lambda *_: missing)
    settings = rig_above(PROBE)
    found = on_line(settings, "Z").describe(settings, "Z", 0)
    assert [line for line in found if "touch probe" in line] == missing
    assert sum("proves its latches" in line for line in found) == (not missing)


@pytest.mark.parametrize("frame_us", [0, 100, 990, 999])
@pytest.mark.parametrize("has_clocks", [True, False])
def test_instants_of_a_line_are_within_the_cycle_also_of_a_late_frame(
    rig_above: Read, frame_us: int, has_clocks: bool
) -> None:
    """Without clocks the outputs count when the frame is there, maybe in the next cycle."""
    text = f'[segment.ec1]\ncarrier = "ethercat"\nframe_us = {frame_us}\nshift_us = 100\n'
    text += f"dc = {str(has_clocks).lower()}"
    settings = rig_above(PROBE, text)
    phases, schedule = phases_of(settings, "Z"), schedule_of(settings, "ec1")
    assert schedule.there_ns > 1_000
    there_ns = (frame_us * 1000 + schedule.there_ns) % 1_000_000
    assert phases.sync_ns == (100_000 if has_clocks else there_ns)
    assert phases.sample_ns == phases.sync_ns
    assert phases.frame_ns == frame_us * 1000
