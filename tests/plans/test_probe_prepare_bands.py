"""What the rows of #MEAS PREPARE expect, made anew from FCT-C4 7.2 by a few lines of its own.

Nothing of the bench is imported. A record is a string of tasks: 3 PREPARE, 1 ENABLE, 2 DISABLE.
"""

import pytest
from tests.plans.shipped_files import rows_of

INCREMENT_UM = 10_000 / 2**20
NOTHING, HOMING, EXCHANGE, RESET, END, ALARM = range(6)
AT_PLC = ("EXT_PROBE_WITH_DRIVE", "PLC_EXT_LATCH_CONTROL")


ROWS = rows_of("probe_prepare")


def _ve(row: dict[str, str], name: str) -> int:
    return int(row[f"plc:V.E.{name}"])


def _expected(row: dict[str, str]) -> dict[int, str]:
    """By block of the program what it prints; a block that is not reached is missing."""
    if row["set:Z.kenngr.measure.signal"] not in AT_PLC:
        return {270: "0", 280: "0", 290: "0", 300: "0", 330: "0", 350: "0", 360: "0"}
    cause, both, late_ms = _ve(row, "CAUSE"), _ve(row, "BOTH"), _ve(row, "PREPARE_MS")
    # homing and exchange are of X: they count where X is prepared as well
    resets = cause in (RESET, END, ALARM) or (cause in (HOMING, EXCHANGE) and both == 1)
    tasks = done = "3"
    if late_ms:
        done = "0"  # and DISABLE waits for it
    elif resets:
        tasks, done = "32", "3" if _ve(row, "DISABLE_MS") else "32"
    of_x = (tasks, done) if both else ("0", "0")
    found = {270: tasks, 280: done, 290: of_x[0], 300: of_x[1]}
    if (_ve(row, "RUN") and "alarm" not in row["tags"].split()) or cause == ALARM:
        after = "3212" if resets else "312"
        edge = "1" if row["set:Z.kenngr.measure.edge"] == "NEG" else "0"
        waits = _ve(row, "DISABLE_MS") > 100  # ms from the end of the run to N350
        found |= {330: "1", 350: after, 360: after[:-1] if waits else after, 380: edge}
        found[370] = row["set:Z.kenngr.measure.input"] or "1"
    return found


@pytest.mark.parametrize("case", ROWS)
def test_a_row_expects_the_tasks_of_the_manual(case: str) -> None:
    row = ROWS[case]
    checked = {
        int(column.removeprefix("check:msg:N")): cell.removeprefix("== ")
        for column, cell in row.items()
        if column.startswith("check:msg:N") and cell and column != "check:msg:N305"
    }
    assert checked == _expected(row)


@pytest.mark.parametrize("case", ROWS)
def test_a_task_that_is_not_acknowledged_stops_the_run_that_waits_for_it(case: str) -> None:
    row = ROWS[case]
    expected = "none"
    if _ve(row, "RUN"):
        if _ve(row, "PREPARE_MS") < 0 or _ve(row, "ENABLE_MS") < 0:
            expected = "== 50050"
        elif _ve(row, "DISABLE_MS") < 0:
            expected = "== 900406"
    if _ve(row, "CAUSE") == ALARM:
        expected = "== 900131"
    assert row["check:alarms"] == expected


def test_every_reset_of_the_manual_has_a_row_for_each_source_that_prepares() -> None:
    for source in AT_PLC:
        of_source = [r for r in ROWS.values() if r["set:Z.kenngr.measure.signal"] == source]
        assert {_ve(row, "CAUSE") for row in of_source} == set(range(6))
    never = [row for row in ROWS.values() if _ve(row, "PREPARE_MS") < 0]
    assert {(_ve(row, "CAUSE"), _ve(row, "RUN")) for row in never} >= {
        (NOTHING, 0), (NOTHING, 1), (HOMING, 1), (EXCHANGE, 1), (RESET, 1), (END, 0), (END, 1)
    }  # fmt: skip


def test_measured_values_are_those_of_their_source() -> None:
    """4 us of the drive at 10 mm/s; at the PLC -0.252 to 1.748 ms (docs/measuring-sources.md)."""
    for row in ROWS.values():
        text = row["check:latch_error_um"]
        if text and row["set:Z.kenngr.measure.signal"] == "PLC_EXT_LATCH_CONTROL":
            low, high = (float(part) for part in text.split(" .. "))
            assert low == pytest.approx(-17.48 - INCREMENT_UM, abs=1e-4)
            assert high == pytest.approx(2.52 + INCREMENT_UM, abs=1e-4)
        elif text:
            assert text == "-0.0400 +- 0.0095"
