"""What is drawn of each source of the measuring signal, from its recording."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from source_panels import (
    bus_lane,
    cnc_lane,
    handshake_panel,
    plc_lane,
    probe_lane,
    since,
    touch_panel,
)
from source_recording import AXIS, Handshake, Recorded
from timing_diagram import Curve, Event, Lane, Panel

MS = 1_000_000
IO_TELEGRAM, INPUTS_TELEGRAM = 0x194, 0x383


@dataclass(frozen=True)
class Picture:
    """A picture with its instants. instants: name -> ns from the contact, or what else is 0."""

    title: str
    panels: Sequence[Panel]
    instants: Mapping[str, int]
    unit: str = "us"


def drive(found: Recorded) -> Picture:
    """DRIVE: the drive stores its position."""
    contact, latch, seen = found.contact_ns, found.latch_ns, found.signal_ns
    sync = found.sync_before(seen)
    lanes = [
        probe_lane(found),
        Lane("drive", [Event(latch, "edge latched: value", "value")]),
        bus_lane(found, [Event(sync, "status and latch sampled", "chain")]),
        cnc_lane(found),
    ]
    spans = [("t_in", contact, latch)]
    instants = {
        "edge latched: value": latch,
        "SYNC that samples status and latch": sync,
        "NC cycle that sees the status": seen,
        "NC cycle of the first set position that brakes": found.brakes_ns,
    }
    return Picture(
        "DRIVE",
        [
            touch_panel(
                found, "One touch at 600 mm/min; times in us from the contact", lanes, latch, spans
            )
        ],
        since(contact, instants),
    )


def _reaction(found: Recorded) -> dict[str, int]:
    return {
        "NC cycle that sees the signal": found.signal_ns,
        "NC cycle of the first set position that brakes": found.brakes_ns,
    }


def _of_level(found: Recorded, lanes: Sequence[Lane], spans: Any, instants: Any) -> Picture:
    """What the sources have in common whose value is the actual position of the NC cycle."""
    contact, seen = found.contact_ns, found.signal_ns
    value = found.sync_before(seen)
    bus = next((lane for lane in lanes if lane.name.startswith("CAN bus")), None)
    event = Event(value, "actual position: value", "value")
    if bus is None:
        lanes = [*lanes[:-1], bus_lane(found, [event]), lanes[-1]]
    else:
        both = replace(bus, events=[*bus.events, event])
        lanes = [both if lane is bus else lane for lane in lanes]
    feed = abs(found.series[f"{AXIS}.velocity_mm_s"][np.searchsorted(found.times_ns, contact) - 1])
    title = f"One touch, Z at {feed * 60:.0f} mm/min; times in us from the contact"
    return Picture(
        next(iter(found.run.sources.values())),
        [touch_panel(found, title, lanes, value, [*spans, ("- a", value, seen)])],
        since(contact, {**instants, **_reaction(found), "SYNC whose position is the value": value}),
    )


def at_terminal(found: Recorded) -> Picture:
    """The level of a terminal that the PLC exchanges in its cycle."""
    contact, image, plc = found.contact_ns, found.image_ns, found.plc_ns
    lanes = [
        probe_lane(found),
        Lane("terminal", [Event(image, "exchange: level in the image", "chain")]),
        plc_lane(found, "probing_signal written", plc),
        cnc_lane(found),
    ]
    spans = [("wait for the exchange", contact, image), ("h", plc, found.signal_ns)]
    instants = {"exchange of the terminal": image, "cycle of the PLC that writes": plc}
    return _of_level(found, lanes, spans, instants)


def drive_input(found: Recorded) -> Picture:
    """The level of an input of the drive, over the CNC to the PLC and back."""
    contact, plc = found.contact_ns, found.plc_ns
    has = found.inputs_ns(found.nc)
    sampled = found.sync_before(has)
    telegram = found.frame_after(sampled, INPUTS_TELEGRAM)
    lanes = [
        probe_lane(found),
        bus_lane(found, [Event(sampled, "60FD sampled", "chain"), Event(telegram, "60FD sent")]),
        plc_lane(found, "probing_signal written", plc),
        cnc_lane(found, "signal seen, path brakes", Event(has, "60FD taken", "chain")),
    ]
    spans = [
        ("wait for the SYNC", contact, sampled),
        ("to the CNC", sampled, has),
        ("to the PLC", has, plc),
        ("h", plc, found.signal_ns),
    ]
    instants = {
        "SYNC that samples 60FD": sampled,
        "NC cycle that has 60FD": has,
        "cycle of the PLC that writes": plc,
    }
    return _of_level(found, lanes, spans, instants)


def io_node(found: Recorded) -> Picture:
    """The level of a CiA 401 node: of a SYNC, and in the cycle of the PLC after it."""
    contact, plc = found.contact_ns, found.plc_ns
    sampled = found.sync_before(plc)
    telegram = found.frame_after(sampled, IO_TELEGRAM)
    lanes = [
        probe_lane(found),
        bus_lane(
            found,
            [Event(telegram, "telegram of the node"), Event(sampled, "level sampled", "chain")],
        ),
        plc_lane(found, "probing_signal written", plc),
        cnc_lane(found),
    ]
    spans = [
        ("wait for the SYNC", contact, sampled),
        ("w", sampled, plc),
        ("h", plc, found.signal_ns),
    ]
    instants = {"SYNC that samples the level": sampled, "cycle of the PLC that writes": plc}
    return _of_level(found, lanes, spans, instants)


def first_event(found: Recorded) -> Picture:
    """As a terminal with PLC; X takes its position of the same SYNC."""
    picture = at_terminal(found)
    (panel,) = picture.panels
    value_ns = found.sync_before(found.signal_ns)
    x_mm = found.run.latched_mm["X"]
    event = Event(value_ns, f"X {x_mm:.4f} mm, Z {found.run.latched_mm[AXIS]:.4f} mm: values")
    lanes = [
        replace(lane, events=[*lane.events, event]) if lane.name.startswith("CNC") else lane
        for lane in panel.lanes
    ]
    cnc = found.signal_ns
    lanes[-1] = replace(
        panel.lanes[-1], events=[Event(cnc, "signal seen, paths brake, X and Z latched", "chain")]
    )
    return replace(picture, panels=[replace(panel, lanes=lanes)])


def timestamp(found: Recorded) -> Picture:
    """The stamp of the terminal is the instant of the value."""
    contact, stamp, plc = found.contact_ns, found.stamp_ns, found.plc_ns
    lanes = [
        probe_lane(found),
        Lane(
            "terminal",
            [
                Event(stamp, "edge stamped: value", "value"),
                Event(found.image_ns, "exchange: level and stamp in the image", "chain"),
            ],
        ),
        plc_lane(found, "probing_signal and timestamp written", plc),
        cnc_lane(found),
    ]
    spans = [
        ("t_in", contact, stamp),
        ("wait for the exchange", stamp, found.image_ns),
        ("h", plc, found.signal_ns),
    ]
    title = "One touch at 1000 mm/min; times in us from the contact"
    instants = {
        "stamp of the terminal: value": stamp,
        "exchange of the terminal": found.image_ns,
        "cycle of the PLC that writes": plc,
        **_reaction(found),
    }
    return Picture(
        "PLC_TIMESTAMP",
        [touch_panel(found, title, lanes, stamp, spans)],
        since(contact, instants),
    )


def _shakes(name: str, shakes: Handshake) -> dict[str, int]:
    return {
        f"{name}: NC cycle that asks": shakes.asked_ns,
        f"{name}: cycle of the PLC that reads it": shakes.read_ns,
        f"{name}: cycle of the PLC that acknowledges": shakes.done_ns,
        f"{name}: NC cycle that sees it": shakes.seen_ns,
    }


def _enabling(found: Recorded, shakes: Handshake) -> Panel:
    """ENABLE at the start of the block; the path waits."""
    start = found.run.start_ns
    assert start is not None
    return handshake_panel(
        found,
        "ENABLE; times in us from the begin of the block",
        "ENABLE",
        shakes,
        found.run.begin_ns,
        before="begin of the block",
        begin_ns=found.run.begin_ns,
        after=(start, "probe armed, path begins"),
    )


def _disabling(found: Recorded, shakes: Handshake) -> Panel:
    """DISABLE after the run; the next one waits."""
    end = found.run.end_ns
    assert end is not None
    return handshake_panel(
        found,
        "DISABLE; times in us from the end of the run",
        "end of the run: DISABLE",
        shakes,
        end,
    )


def ext_latch(found: Recorded) -> Picture:
    """Handshake with the hardware, then as a terminal with PLC."""
    enable, disable = found.handshake(1), found.handshake(2)
    picture = at_terminal(found)
    panels = [_enabling(found, enable), *picture.panels, _disabling(found, disable)]
    begin, end = found.run.begin_ns, found.run.end_ns
    assert end is not None
    return Picture(
        "PLC_EXT_LATCH_CONTROL",
        panels,
        {
            **since(begin, _shakes("ENABLE", enable)),
            **picture.instants,
            **since(end, _shakes("DISABLE", disable)),
        },
    )


def ext_probe(found: Recorded) -> Picture:
    """PREPARE lets the probe get ready; ENABLE, the latch of the drive, DISABLE."""
    prepare, enable, disable = (found.handshake(number) for number in (1, 2, 3))
    title = "#MEAS PREPARE; times in ms from its NC cycle"
    preparing = handshake_panel(found, title, "PREPARE", prepare, prepare.asked_ns, unit="ms")
    touch = drive(found)
    end = found.run.end_ns
    assert end is not None
    return Picture(
        "EXT_PROBE_WITH_DRIVE",
        [preparing, _enabling(found, enable), *touch.panels, _disabling(found, disable)],
        {
            **since(prepare.asked_ns, _shakes("PREPARE", prepare)),
            **since(found.run.begin_ns, _shakes("ENABLE", enable)),
            **touch.instants,
            **since(end, _shakes("DISABLE", disable)),
        },
    )


def fixed_stop(found: Recorded) -> Picture:
    """FIXED_STOP: lag and standstill, in NC cycles; times in ms."""
    stop, (run, *_) = found.run.fixed_stop, found.stops
    assert stop is not None
    assert stop.detected_ns is not None
    assert stop.brake_end_ns is not None
    assert stop.relax_end_ns is not None
    contact = round(run.earliest_contact[1].time_ns)
    beyond, detected = stop.beyond_ns[AXIS], stop.detected_ns
    begin_ns, end_ns = contact - 60 * MS, stop.relax_end_ns + 40 * MS
    inside = (found.times_ns >= begin_ns) & (found.times_ns <= end_ns)
    value_mm = found.run.latched_mm[AXIS]
    contact_mm = float(found.truth_mm(contact))
    curve = Curve(
        f"{AXIS}, true and set",
        [int(t) for t in found.times_ns[inside]],
        [float(p) for p in found.series[f"{AXIS}.truth_mm"][inside]],
        [("value", value_mm, "value")],
        (detected, value_mm),
        [float(p) for p in found.series[f"{AXIS}.set_mm"][inside]],
    )
    lanes = [
        Lane("axis", [Event(contact, f"contact, {value_mm - contact_mm:.3f} mm before the value")]),
        Lane(
            "CNC: lag",
            [Event(beyond, "above its limit", "chain")],
            bars=[(beyond, detected, "minimum time")],
        ),
        Lane(
            "CNC: path",
            [
                Event(detected, "stop found: value, path brakes", "value"),
                Event(stop.brake_end_ns, "set position at rest"),
                Event(stop.relax_end_ns, "run over"),
            ],
            bars=[(stop.brake_end_ns, stop.relax_end_ns, "relaxing motion")],
        ),
    ]
    spans = [
        ("to the lag limit", contact, beyond),
        ("tau", beyond, detected),
        ("v/a", detected, stop.brake_end_ns),
    ]
    title = "One run at 600 mm/min; times in ms from the contact; grey: set position"
    panel = Panel(title, contact, begin_ns, end_ns, lanes, curve, spans, "ms")
    instants = {
        "lag above its limit": beyond,
        "stop found: value": detected,
        "set position at rest": stop.brake_end_ns,
        "end of the relaxing motion": stop.relax_end_ns,
    }
    return Picture("FIXED_STOP", [panel], since(contact, instants), "ms")
