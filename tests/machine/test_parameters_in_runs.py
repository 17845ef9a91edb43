"""What parameter lists bring about when a program runs: warnings, sources that do not act."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
RunNc = Callable[..., Any]
MEASURE = "N10 G90 G1 Z101 F3000\nN20 G100 Z98 F300\n"


def z_list(tmp_path: Path, *lines: str) -> str:
    """A rig whose axis Z has these settings above those of the shipped list."""
    text = (RIGS / "lists/axis-z-fine.lst").read_text(encoding="utf-8")
    names = {line.split()[0] for line in lines}
    kept = [line for line in text.splitlines() if line.split()[:1] != [] and
            line.split()[0] not in names]  # fmt: skip
    (tmp_path / "z.lst").write_text("\n".join([*kept, *lines, ""]), encoding="utf-8")
    return '[axis.Z]\nlist = "z.lst"\n'


@pytest.mark.long
@pytest.mark.provokes(315002, 1, owner="axis Z", value=200, high=99, corrected=99)
@pytest.mark.provokes(110757, 1, axis="Z", value_permille=1200, limit_permille=1000)
def test_warnings_of_lists_stand_at_the_begin_of_a_run_that_goes_on(
    tmp_path: Path, run_nc: RunNc
) -> None:
    rig = z_list(
        tmp_path,
        "kenngr.dist_ctrl[0].n_cycles 200",
        "kenngr.measure.fixed_stop_detect.start_distance_per_mille 1200",
    )
    outcome = run_nc('N10 G1 Z131 F3000\nN20 #MSG ["done"]', rig, base="probe-z.toml")
    assert outcome.lines == ["done"]
    assert outcome.alarms == [315002, 110757]


@pytest.mark.long
@pytest.mark.provokes(900400, 2, axis="Z", source="PLC")
def test_a_source_without_a_plc_ends_the_run_and_never_measures_by_the_drive(
    tmp_path: Path, run_nc: RunNc
) -> None:
    rig = z_list(tmp_path, "kenngr.measure.signal PLC")
    outcome = run_nc(MEASURE, rig, base="probe-z.toml")
    assert outcome.alarms == [900400]
    assert outcome.machine.channel.records == []


@pytest.mark.long
@pytest.mark.provokes(900242, 2, axis="Z", source="FIXED_STOP", type=1)
def test_an_older_switch_decides_while_the_source_is_blank(tmp_path: Path, run_nc: RunNc) -> None:
    rig = z_list(tmp_path, 'kenngr.measure.signal ""', "kenngr.meas_signal_fixed_stop 1")
    assert run_nc(MEASURE, rig, base="probe-z.toml").alarms == [900242]


@pytest.mark.long
def test_a_body_is_touched_where_its_list_has_it(tmp_path: Path, run_nc: RunNc) -> None:
    """P-AXIS-00112 mode 6: centre 98 mm, radius 2 mm; from above that is 100 mm, to a cycle."""
    rig = z_list(
        tmp_path,
        "meas_simu.meas_simu_mode 6",
        "meas_simu.parameter3 980000",
        "meas_simu.parameter4 20000",
    )
    outcome = run_nc(f'{MEASURE}N30 #MSG ["%f", V.A.MESS.Z]\n', rig, base="probe-z.toml")
    assert outcome.alarms == []
    assert 100.0 - 0.005 - 1e-6 <= float(outcome.lines[0]) <= 100.0 + 1e-6


@pytest.mark.long
@pytest.mark.provokes(900100, 2, word="meas_simu.meas_simu_mode = 5 of axis Z")
def test_a_simulated_probe_beside_the_path_is_not_taken_for_the_drive(
    tmp_path: Path, run_nc: RunNc
) -> None:
    rig = z_list(tmp_path, "meas_simu.meas_simu_mode 5")
    program = "N10 G90 G1 Z101 F3000\nN20 Z[INDP_SYN G100 G90 POS98 FEED300]"
    assert run_nc(program, rig, base="probe-z.toml").alarms == [900100]


@pytest.mark.long
def test_the_source_of_the_drive_type_is_the_drive(tmp_path: Path, run_nc: RunNc) -> None:
    rig = z_list(tmp_path, "kenngr.measure.signal DRIVE_TYPE_DEFAULT")
    print_it = '\nN30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]'
    outcome = run_nc(MEASURE + print_it, rig, base="probe-z.toml")
    assert (outcome.alarms, outcome.lines) == ([], ["V.A.MERF.Z=1"])


@pytest.mark.long
@pytest.mark.provokes(900241, 2, axis="Z", source="DRIVE", type=7)
def test_a_run_to_a_fixed_stop_never_waits_for_a_latch(tmp_path: Path, run_nc: RunNc) -> None:
    (tmp_path / "channel.lst").write_text("messtyp 7\n", encoding="utf-8")
    outcome = run_nc(MEASURE, '[channel]\nlist = "channel.lst"\n', base="probe-z.toml")
    assert outcome.alarms == [900241]
    assert outcome.machine.channel.records == []
