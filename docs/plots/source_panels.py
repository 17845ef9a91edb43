"""Panels of the timing diagrams of sources: what several of them have."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from source_recording import AXIS, Handshake, Recorded
from timing_diagram import Curve, Event, Lane, Panel

US = 1_000


def curve_of(found: Recorded, begin_ns: int, end_ns: int, value_ns: int) -> Curve:
    """True position of Z; its place at the contact and the measured value as levels."""
    times = np.linspace(begin_ns, end_ns, 97).round().astype(int)
    value_mm = found.run.latched_mm[AXIS]
    contact_mm = float(found.truth_mm(found.contact_ns))
    levels = [("place at contact", contact_mm, ""), ("value", value_mm, "value")]
    if abs(value_mm - contact_mm) < 0.1 * abs(np.ptp(found.truth_mm(times))):
        levels = [("value, contact", value_mm, "value")]
    return Curve(
        f"{AXIS}, true",
        [int(t) for t in times],
        [float(p) for p in found.truth_mm(times)],
        levels,
        (value_ns, float(found.truth_mm(value_ns))),
    )


def ticks_of(found: Recorded, who: str) -> list[int]:
    """Cycles of a participant, ns."""
    times = {"SYNC": found.times_ns, "PLC": found.plc, "CNC": found.nc}[who]
    return [int(t) if who == "SYNC" else t.time_ns for t in times]


def probe_lane(found: Recorded, words: str = "contact, edge") -> Lane:
    """The probe at its contact."""
    return Lane("probe", [Event(found.contact_ns, words, "chain")])


def bus_lane(found: Recorded, events: Sequence[Event]) -> Lane:
    """The bus with its SYNCs."""
    return Lane("CAN bus: SYNC", events, ticks_of(found, "SYNC"))


def plc_lane(found: Recorded, words: str, time_ns: int, *more: Event) -> Lane:
    """The task of the PLC with its cycles."""
    return Lane("PLC task", [Event(time_ns, words, "chain"), *more], ticks_of(found, "PLC"))


def cnc_lane(found: Recorded, words: str = "signal seen, path brakes", *more: Event) -> Lane:
    """The CNC with its cycles."""
    events = [Event(found.signal_ns, words, "chain"), *more]
    return Lane("CNC: NC cycle", events, ticks_of(found, "CNC"))


def touch_panel(
    found: Recorded,
    title: str,
    lanes: Sequence[Lane],
    value_ns: int,
    spans: Sequence[tuple[str, int, int]],
) -> Panel:
    """The panel from the contact to the reaction; its chain goes through all chain events."""
    last_ns = max(found.signal_ns, value_ns)
    begin_ns = min(found.contact_ns, value_ns) - 400 * US
    end_ns = last_ns + max(900 * US, (last_ns - begin_ns) // 2)
    chain = sorted(
        (
            (lane.name, event.time_ns)
            for lane in lanes
            for event in lane.events
            if event.kind == "chain" or (event.kind == "value" and lane.name == "drive")
        ),
        key=lambda point: point[1],
    )
    return Panel(
        title,
        found.contact_ns,
        begin_ns,
        end_ns,
        lanes,
        curve_of(found, begin_ns, end_ns, value_ns),
        spans,
        chain=chain,
    )


def handshake_panel(
    found: Recorded, title: str, task: str, shakes: Handshake, zero_ns: int, **more: Any
) -> Panel:
    """The order of the CNC and its acknowledgement. after: what the CNC does then."""
    begin_ns, end_ns = more.get("begin_ns", shakes.asked_ns), shakes.seen_ns
    if "after" in more:
        end_ns = max(end_ns, more["after"][0])
    room = max((end_ns - begin_ns) * 6 // 10, 600 * US)
    cnc = [
        Event(shakes.asked_ns, f"{task}, please_rw", "chain"),
        Event(shakes.seen_ns, "done_w seen", "chain"),
    ]
    if "before" in more:
        cnc.append(Event(begin_ns, more["before"]))
    if "after" in more:
        cnc.append(Event(*more["after"]))
    plc = [Event(shakes.read_ns, "please_rw FALSE", "chain")]
    if shakes.done_ns == shakes.read_ns:
        plc = [Event(shakes.read_ns, "please_rw FALSE, done_w", "chain")]
    else:
        plc.append(Event(shakes.done_ns, "done_w", "chain"))
    unit = more.get("unit", "us")
    ticks = {name: ticks_of(found, name) if unit == "us" else [] for name in ("PLC", "CNC")}
    lanes = [Lane("CNC: NC cycle", cnc, ticks["CNC"]), Lane("PLC task", plc, ticks["PLC"])]
    chain = [
        ("CNC: NC cycle", shakes.asked_ns),
        ("PLC task", shakes.read_ns),
        ("PLC task", shakes.done_ns),
        ("CNC: NC cycle", shakes.seen_ns),
    ]
    margin = (end_ns - begin_ns) // 20
    return Panel(
        title, zero_ns, begin_ns - margin, end_ns + room, lanes, None, (), unit, chain=chain
    )


def since(zero_ns: int, instants: Mapping[str, int]) -> dict[str, int]:
    """Instants counted from one of them."""
    return {name: time_ns - zero_ns for name, time_ns in instants.items()}
