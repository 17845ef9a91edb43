"""Keys and numbers of a rig file that are refused, and the first value of a SYNC counter."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


@pytest.mark.parametrize(
    ("text", "near", "others"),
    [
        ("[plant.z.map.position]\nvariabel = 'x'\n", "variable", {"sign", "threshold"}),
        ("[plc]\nperiod_us = 1000\nprogramm = 'p.py'\n", "program", {"busy_us", "task"}),
        (
            "[plc]\nperiod_us = 1000\nprogram = 'p.py'\n[plc.terminal]\nstamp_edgy = 'last'\n",
            "stamp_edge", {"node", "filter_us"},
        ),
        ('[plc]\n"V.E.S" = { sensor = "z", delay_cycle = 1 }\n', "delay_cycles", {"sign"}),
        ("[distance]\nlimitr = 'slope'\n", "limiter", {"derivative_of"}),
    ],
)  # fmt: skip
def test_a_key_that_is_written_wrong_is_named_with_those_of_its_table(
    rig_file: Write, text: str, near: str, others: set[str]
) -> None:
    path = rig_file()
    path.write_text(path.read_text(encoding="utf-8") + text, encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_rig(path)
    error = caught.value
    assert error.message.startswith("unknown rig key ")
    assert error.hint == f"did you mean {near}?"
    assert set((error.allowed or "").split(", ")) >= {near, *others}
    assert error.line is not None
    line = path.read_text(encoding="utf-8").splitlines()[error.line - 1]
    assert near[:5] in line


@pytest.mark.parametrize(
    ("wrong", "hint"),
    [
        ("input_x", None),  # input_delay_us, input_jitter_us, input_filter_us
        ("rated_x_and_so_on", None),  # rated_torque_mnm, rated_current_ma
        ("lead_of_the_screw", "did you mean lead_mm?"),
    ],
)
def test_of_several_keys_with_the_same_first_word_none_is_meant(
    rig_file: Write, wrong: str, hint: str | None
) -> None:
    path = rig_file(("[drive.servo]\n", f"[drive.servo]\n{wrong} = 1\n"))
    with pytest.raises(UserError) as caught:
        read_rig(path)
    assert caught.value.message == f"unknown rig key drive.servo.{wrong}"
    assert caught.value.hint == hint


def test_a_sync_counter_begins_at_2(rig_file: Write) -> None:
    for value, is_good in ((0, True), (1, False), (2, True), (240, True), (241, False)):
        path = rig_file(("[cycle]", f"[cycle]\nsync_counter = {value}"))
        if is_good:
            assert read_rig(path)[0].cycle.sync_counter == value
        else:
            with pytest.raises(UserError, match=r"cycle\.sync_counter"):
                read_rig(path)


def test_a_number_of_a_rig_is_finite(rig_file: Write) -> None:
    for word in ("nan", "inf", "-inf"):
        path = rig_file(("[cycle]", f"[realtime]\nlate_us = {word}\n[cycle]"))
        with pytest.raises(UserError, match=r"late_us: must be a finite number"):
            read_rig(path)


def test_a_terminal_that_a_rig_does_not_have_cannot_be_changed(
    rig_file: Write, settings_of: Read
) -> None:
    without = rig_file()
    with pytest.raises(UserError, match="the rig has no PLC task"):
        settings_of(without, "plc:terminal.filter_us=5")
    settings = settings_of(RIGS / "plc-timestamp.toml", "plc:terminal.filter_us=5")
    task = settings.rig.plc_task
    assert task is not None
    assert task.terminal is not None
    assert task.terminal.filter_us == 5
    text = (RIGS / "plc-drive-input.toml").read_text(encoding="utf-8")
    assert "terminal" not in text.partition("[")[2]
    with pytest.raises(UserError, match="the PLC of this rig has no terminal"):
        settings_of(RIGS / "plc-drive-input.toml", "plc:terminal.filter_us=5")
