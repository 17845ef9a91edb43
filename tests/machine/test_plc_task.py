"""A PLC task on the machine: its instants, its program, and what passes between it and the CNC."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.machine.plc_programs import IDLE

from axisrig.kernel.errors import UserError

MS = 1_000_000
RunNc = Callable[..., Any]


def test_each_side_sees_what_the_other_wrote_before_never_at_the_same_instant(
    run_plc: RunNc,
) -> None:
    """PLC at 600 us of every second millisecond, as the NC cycle.

    The program writes V.E.ASKED in a cycle; the PLC reads it at its next instant after that one and
    answers with its time, which the program waits for.
    """
    body = """    def cycle(self, inputs, hli):
        if hli.ve.get("ASKED", 0) and not hli.ve["SEEN"]:
            hli.ve["SEEN"] = inputs.time_ns / 1e6
"""
    out = run_plc(
        "N10 V.E.ASKED = 1\nN20 #WAIT FOR V.E.SEEN > 0",
        body,
        "plc:V.E.ASKED=0",
        "plc:V.E.SEEN=0",
        keys="period_us = 2000\noffset_us = 600",
    )
    again_ms = out.machine.channel.plc.values["SEEN"]
    asked_ns = next(e.time_ns for e in out.machine.channel.plc.events if hasattr(e.command, "name"))
    assert asked_ns % MS == 600_000
    expected_ns = asked_ns + 1  # the first instant of the PLC after it
    expected_ns += (600_000 - expected_ns) % (2 * MS)
    assert round(again_ms * 1e6) == expected_ns


@pytest.mark.parametrize(("busy_us", "taken_ms"), [(999, 1), (1000, 2)])
def test_what_a_cycle_of_the_plc_writes_acts_after_it_has_ended(
    run_plc: RunNc, busy_us: int, taken_ms: int
) -> None:
    """Both at 600 us: the first NC cycle after the end of the PLC's, never at the same instant."""
    body = """    def cycle(self, inputs, hli):
        if inputs.time_ns >= 40_000_000 and not hli.ve["SEEN"]:
            hli.ve["SEEN"] = inputs.time_ns / 1e6
"""
    out = run_plc(
        "N20 #WAIT FOR V.E.SEEN > 0\nN30 V.E.GOT = 1",
        body,
        *("plc:V.E.GOT=0", "plc:V.E.SEEN=0"),
        keys=f"period_us = 4000\noffset_us = 600\nbusy_us = {busy_us}",
    )
    plc = out.machine.channel.plc
    got_ns = next(e.time_ns for e in plc.events if getattr(e.command, "name", "") == "GOT")
    assert got_ns - round(plc.values["SEEN"] * 1e6) == taken_ms * MS


@pytest.mark.long
def test_feedhold_and_override_of_the_program_act_on_the_path(run_plc: RunNc) -> None:
    """Half the feed until 200 ms after the begin of the motion, then a hold of 100 ms."""
    body = """    def cycle(self, inputs, hli):
        moving = hli.ve.get("GO", 0)
        self.since = getattr(self, "since", None)
        if moving and self.since is None:
            self.since = inputs.time_ns
        age_ms = 0 if self.since is None else (inputs.time_ns - self.since) / 1e6
        hli.ch.override.enable_w = age_ms < 200
        hli.ch.override.command_w = 500
        hli.ch.feedhold.enable_w = True
        hli.ch.feedhold.command_w = 200 <= age_ms < 300
"""
    plain = run_plc("N10 V.E.GO = 1\nN20 G1 Z120 F1200", IDLE, "plc:V.E.GO=0")
    led = run_plc("N10 V.E.GO = 1\nN20 G1 Z120 F1200", body, "plc:V.E.GO=0")
    took = [out.facts.end_ns - out.facts.start_ns for out in (plain, led)]
    # 200 ms at half the feed cost 100 ms, the hold 100 ms; ramps of v/a = 25 ms shift half of it
    assert (took[1] - took[0]) / MS == pytest.approx(200, abs=12.5)
    assert led.alarms == []


@pytest.mark.long
def test_what_the_program_does_not_enable_does_nothing(run_plc: RunNc) -> None:
    """Every command without its enable, for the path and for the axis, in every cycle."""
    body = """    def cycle(self, inputs, hli):
        z = hli.ax["Z"].lr_mc_control
        for unit in (hli.ch.feedhold, hli.ch.reset, hli.ch.start, z.feedhold, z.probing_signal):
            unit.command_w = True
        for unit in (hli.ch.override, z.override):
            unit.command_w = 100
        z.timestamp.command_w = z.probing_position.command_w = 5
"""
    program = "N10 G1 Z129 F1200"
    plain, led = run_plc(program, IDLE), run_plc(program, body)
    assert led.alarms == []
    assert led.facts.end_ns == plain.facts.end_ns
    assert led.facts.frame_log_sha256 == plain.facts.frame_log_sha256


def test_reset_and_start_of_the_program(run_plc: RunNc) -> None:
    body = """    outlives_program = True
    is_idle = False

    def cycle(self, inputs, hli):
        self.ready = getattr(self, "ready", False) or hli.ch.state_r == "READY"
        hli.ch.reset.enable_w = hli.ch.start.enable_w = True
        hli.ch.reset.command_w = inputs.time_ns > 500_000_000
        hli.ch.start.command_w = self.ready
        self.is_idle = self.ready and inputs.time_ns > 900_000_000
"""
    out = run_plc('N10 #MSG SYN["begun"]\nN20 G4 0.2', body)
    assert out.lines == ["begun", "begun"]
    assert out.alarms == []


@pytest.mark.long
def test_status_bits_follow_the_run(run_plc: RunNc) -> None:
    """probe_actuated_r, measurement_active_r and measure_value_ok_r, counted by the PLC.

    And what the CNC has taken of each unit that the PLC enables.
    """
    body = """    def cycle(self, inputs, hli):
        units = hli.ax["Z"].lr_mc_control
        names = ("probing_signal", "timestamp", "probing_position")
        for number, name in enumerate(names):
            unit, command = getattr(units, name), (True, 77, 12345)[number]
            unit.enable_w, unit.command_w = True, command
            if f"UNIT_{number}" in hli.ve:
                hli.ve[f"UNIT_{number}"] = int(unit.state_r)
        state = hli.ax["Z"].lr_state
        for name, bit in (
            ("ACTIVE", state.measurement_active_r),
            ("OK", state.measure_value_ok_r),
            ("ACTUATED", state.probe_actuated_r),
        ):
            if bit and name in hli.ve:
                hli.ve[name] += 1
"""
    out = run_plc(
        "N10 G1 Z101 F3000\nN20 G100 Z98 F600\nN30 G1 Z110 F3000",
        body,
        *(f"plc:V.E.{name}=0" for name in ("ACTIVE", "OK", "ACTUATED")),
        *(f"plc:V.E.UNIT_{number}=0" for number in range(3)),
    )
    values, (record,) = out.machine.channel.plc.values, out.machine.channel.records
    cycles = (record.end_ns - record.begin_ns) / (2 * MS)
    assert values["ACTIVE"] == pytest.approx(cycles, abs=2)
    assert values["OK"] > 0
    assert 0 < values["ACTUATED"] < values["ACTIVE"] + values["OK"]
    assert [values[f"UNIT_{number}"] for number in range(3)] == [1, 77, 12345]


@pytest.mark.long
def test_columns_give_the_signal_in_a_rig_without_a_task(run_nc: RunNc) -> None:
    """200 ms after the run has begun; the value is the actual position of that cycle."""
    out = run_nc(
        "N10 G1 Z120 F3000\nN20 G100 Z110 F600",
        "",
        "set:Z.kenngr.measure.signal=PLC",
        "plc:Z.probing_signal=0; 1 at=run+200ms",
        base="probe-z.toml",
    )
    (record,) = out.machine.channel.records
    assert out.alarms == []
    assert record.signal_ns - record.begin_ns == 200 * MS
    row = out.observed.index_at(record.signal_ns)
    assert record.latched_mm["Z"] == pytest.approx(
        out.observed.value("Z", "actual_mm", row), abs=1e-9
    )


@pytest.mark.long
def test_columns_give_a_position_with_the_signal(run_nc: RunNc) -> None:
    out = run_nc(
        "N10 G1 Z120 F3000\nN20 G100 Z110 F600",
        "",
        "set:Z.kenngr.measure.signal=PLC",
        "plc:Z.probing_signal=0; 1 at=run+200ms",
        "plc:Z.probing_position=119.1234",
        base="probe-z.toml",
    )
    assert out.machine.channel.records[0].latched_mm == {"Z": 119.1234}


def test_a_column_beside_a_task_is_refused(run_plc: RunNc) -> None:
    with pytest.raises(UserError, match="the PLC task of this rig gives the probing signal"):
        run_plc("N10 G4 0.1", IDLE, "plc:Z.probing_signal=0")


@pytest.mark.long
def test_evenly_spread_phases_have_the_mean_and_the_spread_of_the_chain(
    run_own: Callable[..., Any],
) -> None:
    """40 phases over 1 ms: mean and spread of an even distribution, to a fortieth of it.

    PLC of 1 ms at 300 us, NC cycle at 600 us, SYNC at 48 us: -0.252 .. 0.748 ms at 10 mm/s.
    """
    plans = Path(__file__).parents[2] / "testplans"
    out = run_own(
        plans / "programs/probe-phases.nc",
        plans / "rigs/plc-signal.toml",
        [
            "plc:V.E.FEED=600",
            "plc:V.E.TOUCHES=40",
            "plc:V.E.SHIFT=0.00025",
            "plc:period_us=1000",
            "plant:z.position_start_mm=102.5",
            "plant:z.feed_forward=1",
        ],
    )
    (probe,) = out.facts.probes.values()
    errors_um = sorted(
        1e3 * (run.latched_mm["Z"] - contact.position_mm["z"])
        for run, contact in zip(out.facts.runs, probe.contacts, strict=True)
    )
    assert len(errors_um) == 40
    step_um = 10.0 / 40
    for number, error_um in enumerate(errors_um):
        even_um = -7.48 + (number + 0.5) * step_um
        assert error_um == pytest.approx(even_um, abs=step_um / 2 + 0.02)
