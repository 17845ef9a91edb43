"""Units of the HLI that are not enabled, values of 0, and runs that are under way."""

from pathlib import Path

import pytest
from tests.machine.cnc_beside_task import Cnc

from axisrig.bench.machine.plc.hli import Hli, Inputs

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


@pytest.mark.parametrize("enabled", [False, True])
def test_a_command_counts_only_while_its_unit_is_enabled(tmp_path: Path, enabled: bool) -> None:
    """MC_CONTROL_BOOL_UNIT: enable_w makes command_w count."""
    cnc = Cnc(tmp_path)

    def script(_inputs: Inputs, hli: Hli) -> None:
        units = [hli.ch.feedhold, hli.ch.reset, hli.ch.start]
        units += [axis.lr_mc_control.feedhold for axis in hli.ax.values()]
        for unit in units:
            unit.enable_w, unit.command_w = enabled, True
        for override in (hli.ch.override, hli.ax["Z"].lr_mc_control.override):
            override.enable_w, override.command_w = enabled, 500

    cnc.runner.start()
    cnc.run(5, script)
    assert set(cnc.held) == ({"PXZ"} if enabled else {""})
    assert (cnc.plc.wants_reset, cnc.starts) == ((True, 1) if enabled else (False, 0))
    assert cnc.overrides() == ((500, 1000, 500) if enabled else (1000, 1000, 1000))


def test_0_is_a_stamp_and_a_position_of_an_enabled_unit(tmp_path: Path) -> None:
    cnc = Cnc(tmp_path)

    def script(_inputs: Inputs, hli: Hli) -> None:
        units = hli.ax["X"].lr_mc_control
        for unit in (units.timestamp, units.probing_position, units.probing_signal):
            unit.enable_w = True

    cnc.runner.start()
    cnc.run(3, script)
    writes = cnc.plc.axis["X"].probing.writes
    assert (writes.signal, writes.timestamp_ns, writes.position_units) == (False, 0, 0)


def test_a_measured_value_and_a_run_under_way_are_shown_each_by_itself(tmp_path: Path) -> None:
    cnc = Cnc(tmp_path)
    cnc.measuring.add("X")
    cnc.measured.add("Z")
    states: list[tuple[bool, bool, bool, bool]] = []

    def script(_inputs: Inputs, hli: Hli) -> None:
        x, z = (axis.lr_state for axis in hli.ax.values())
        states.append((x.measurement_active_r, x.measure_value_ok_r,
                       z.measurement_active_r, z.measure_value_ok_r))  # fmt: skip

    cnc.runner.start()
    cnc.run(3, script)
    assert states[-1] == (True, False, False, True)
