"""The control's ends of the drives of a rig: links, carriers, start-ups, made of the settings."""

from collections.abc import Mapping
from typing import Any

from axisrig.bench.rig.canopen.answers import first_answer_ns
from axisrig.bench.rig.canopen.arrival import stamp_clock
from axisrig.bench.rig.canopen.checks import axis_steps
from axisrig.bench.rig.canopen.latches import SdoRoom, sdo_room
from axisrig.bench.rig.canopen.loop import loop_settings
from axisrig.bench.rig.canopen.members import can_axes, drive_of
from axisrig.bench.rig.canopen.schedule import (
    has_inputs,
    has_latch_counter,
    has_second,
    has_touch_probe,
)
from axisrig.bench.rig.canopen.startup import start_up_settings
from axisrig.bench.rig.reading.lists import acceleration_mm_s2, drive_input, jump_mm
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.canopen.carrier import CanCarrier
from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.drives.canopen.sdo import SdoClient
from axisrig.kernel.drives.canopen.startup import DriveAddress, StartUp
from axisrig.kernel.drives.cia402.latch_check import StandstillRoom
from axisrig.kernel.time.clock import Clock, S


def build_links(
    settings: Settings, networks: Mapping[str, Any], clock: Clock
) -> dict[str, AxisLink]:
    """Make the kernel's end of the drive of every axis; networks: by segment."""
    members: dict[str, list[AxisLink]] = {segment: [] for segment in networks}
    rooms = {segment: StandstillRoom(links) for segment, links in members.items()}
    links: dict[str, AxisLink] = {}
    for name in can_axes(settings):
        axis = settings.rig.axis[name]
        drive, network = drive_of(settings, name), networks[axis.segment]
        declared = start_up_settings(drive)
        sdo = SdoClient(
            network,
            clock,
            axis.node_id,
            timeout_ns=declared.sdo_timeout_ns,
            attempts=declared.sdo_attempts,
        )
        room = sdo_room(settings, name)
        links[name] = AxisLink(
            _link_settings(settings, name),
            network,
            sdo,
            proves_latches=drive.latch_check and room is not SdoRoom.NONE,
            proves_places=drive.position_check and room is not SdoRoom.NONE,
            room=rooms[axis.segment] if room is SdoRoom.STANDSTILL else None,
            clock=clock,
        )
        members[axis.segment].append(links[name])
    return links


@once
def _link_settings(settings: Settings, name: str) -> LinkSettings:
    axis, parameters = settings.rig.axis[name], settings.axis[name]
    drive = drive_of(settings, name)
    return LinkSettings(
        axis=name,
        node_id=axis.node_id,
        increments_per_mm=float(drive.make().units_per_mm),
        probe_input=drive_input(parameters),
        edge=parameters.word("kenngr.measure.edge"),
        lag_delay_cycles=parameters.integer("antr.nbr_delay_cycles"),
        pdo_map=drive.pdo_map,
        missing_cycles=drive.missing_cycles,
        answers_ns=tuple(first_answer_ns(settings, axis.segment, n) for n in range(9)),
        homing_limit_ns=round(drive.homing_limit_s * S),
        lag_limit_mm=drive.lag_limit_mm or float("inf"),
        fault_reset=drive.fault_reset,
        jump_mm=jump_mm(parameters, drive.jump_factor, settings.rig.cycle.period_us),
        acceleration_mm_s2=acceleration_mm_s2(parameters),
        status_delay_cycles=drive.make().status_delay_cycles,
        stamps=stamp_clock(settings, name),
        trigger_source=parameters.word("antr.canopen.probing_trigger_source"),
        has_counter=has_latch_counter(settings, name),
        has_inputs=has_inputs(settings, name),
        has_second=has_second(settings, name),
        has_probe=has_touch_probe(settings, name),
        sensor_age_limit_ms=axis.sensor_age_limit_ms,
        loop=loop_settings(settings, name),
    )


def build_carriers(settings: Settings, networks: Mapping[str, Any]) -> dict[str, CanCarrier]:
    """Make what begins the cycles, by segment."""
    overflow = settings.rig.cycle.sync_counter
    return {name: CanCarrier(network, overflow) for name, network in networks.items()}


def build_start_up(settings: Settings, name: str, link: AxisLink, clock: Clock) -> StartUp:
    """Make the start-up of the drive of one axis."""
    axis = settings.rig.axis[name]
    assert link.sdo is not None, "made with it"
    declared = start_up_settings(drive_of(settings, name))
    steps = axis_steps(settings, name)
    address = DriveAddress(name, axis.node_id)
    return StartUp(address, link.network, clock, link.sdo, steps, declared, keep=link.set_object)
