"""What a rig says of the start-up of a drive gets to the kernel, each key by itself."""

from dataclasses import fields
from typing import Any

import pytest

from axisrig.bench.rig.canopen.startup import StartUpKeys, start_up_settings, watch_settings
from axisrig.kernel.drives.canopen.startup_steps import StartUpSettings
from axisrig.kernel.time.clock import MS

# Key and value of the rig; field and value of the kernel, times in ns
KEYS: tuple[tuple[str, Any, str, Any], ...] = (
    ("boot", "wait", "boot", "wait"),
    ("boot_timeout_ms", 700, "boot_timeout_ns", 700 * MS),
    ("boot_attempts", 5, "boot_attempts", 5),
    ("sdo_timeout_ms", 120, "sdo_timeout_ns", 120 * MS),
    ("sdo_attempts", 4, "sdo_attempts", 4),
    ("device_type", 401, "device_type", 401),
    ("device_type", False, "device_type", None),
    ("identity", {"vendor": 7, "serial": 9}, "identity", {1: 7, 4: 9}),
    ("identity", {"product": 7, "revision": 9}, "identity", {2: 7, 3: 9}),
    ("mode", -3, "mode", -3),
    ("sync_window_us", 500, "sync_window_us", 500),
    ("heartbeat_ms", 20, "heartbeat_ms", 20),
    ("consumer_ms", 30, "consumer_ms", 30),
    ("guard_time_ms", 40, "guard_time_ms", 40),
    ("life_factor", 5, "life_factor", 5),
    ("options", {"quick_stop": 6, "halt": 2}, "options", {0x605A: 6, 0x605D: 2}),
    ("options", {"shutdown": 1, "fault_reaction": 2}, "options", {0x605B: 1, 0x605E: 2}),
    ("scaling_check", False, "scaling_check", False),
    ("rpdo_timeout_ms", 12, "rpdo_timeout_ms", 12),
    ("sdo", [["0x6065:0", 1000], ["0x2010:3", -1]], "writes", [(0x6065, 0, 1000), (0x2010, 3, -1)]),
)
"""Objects: CiA 301 (1018) and CiA 402-2 (605A to 605E)."""


@pytest.mark.parametrize(("key", "given", "name", "value"), KEYS)
def test_a_key_changes_its_field_of_the_kernel_and_no_other(
    key: str, given: Any, name: str, value: Any
) -> None:
    usual = vars(start_up_settings(StartUpKeys()))
    found = vars(start_up_settings(StartUpKeys.model_validate({key: given})))
    assert found[name] != usual[name]
    assert found == {**usual, name: value}


def test_every_field_has_its_key() -> None:
    assert {name for _, _, name, _ in KEYS} == {field.name for field in fields(StartUpSettings)}


@pytest.mark.parametrize(
    ("keys", "limits"),
    [
        ({}, (0, 0)),
        ({"heartbeat_ms": 20}, (40, 0)),  # two of them may be lost
        ({"heartbeat_ms": 20, "heartbeat_timeout_ms": 70}, (70, 0)),
        ({"heartbeat_timeout_ms": 70}, (70, 0)),
        ({"guard_time_ms": 20, "life_factor": 5}, (0, 20)),
    ],
)
def test_the_watch_of_the_kernel_follows_the_same_keys(
    keys: dict[str, int], limits: tuple[int, int]
) -> None:
    watch = watch_settings(StartUpKeys.model_validate(keys))
    assert (watch.heartbeat_ns, watch.guard_ns) == (limits[0] * MS, limits[1] * MS)
    assert watch.life_factor == keys.get("life_factor", 3)
