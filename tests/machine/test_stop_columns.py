"""Motor force, force of the fixed stop and its place in the trace of a run."""

from typing import Any

import numpy as np
import pytest

STOP = "stop_force_n", "stop_force_peak_n", "stop_mm"
INTO_THE_STOP = "N10 G1 Z132.2 F1200\nN20 G1 Z128"
K_N_MM = 20e3


def columns(out: Any) -> set[str]:
    return {
        name.removeprefix("Z.")
        for name in out.machine.recorder.table().column_names
        if name.startswith("Z.")
    }


@pytest.mark.long
def test_an_axis_without_a_stop_shows_its_motor_force_only(run_nc: Any) -> None:
    out = run_nc("N10 G1 Z131 F6000", "", base="probe-z.toml")
    assert columns(out) & {"force_n", *STOP} == {"force_n"}
    speed, force = out.column("Z.velocity_mm_s"), out.column("Z.force_n")
    steady = np.abs(np.diff(speed, prepend=0.0)) < 1e-6
    # 800 N.s/m of viscous friction
    assert force[steady] == pytest.approx(0.8 * speed[steady], abs=0.05)


@pytest.mark.long
def test_columns_of_a_contact_belong_to_the_sync(run_nc: Any) -> None:
    out = run_nc(INTO_THE_STOP, "", "plant:z.stop_position_mm=132", base="probe-z.toml")
    force, stop = out.column("Z.force_n"), out.column("Z.stop_force_n")
    deep_mm = out.column("Z.truth_mm") - 132.0
    approach_m_s = out.column("Z.velocity_mm_s") * 1e-3
    expected = np.maximum(0.0, K_N_MM * deep_mm * (1 + 20 * approach_m_s))
    assert np.max(stop) > 300.0
    assert stop == pytest.approx(expected, rel=1e-6, abs=1e-6)
    assert np.max(force) <= 4000.0 + 1e-6
    assert set(out.column("Z.stop_mm")) == {132.0}
    peak = out.column("Z.stop_force_peak_n")
    assert np.all(peak[1:] >= np.maximum(stop[1:], stop[:-1]))
    assert np.any(peak[1:] > np.maximum(stop[1:], stop[:-1]))
