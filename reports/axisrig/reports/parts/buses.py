"""The buses of a run: a row of figures for each segment."""

from typing import Any

from axisrig.bench.bus.can.frame import identifier_text
from axisrig.bench.bus.can.load import EXTENDED_FLAG
from axisrig.bench.record.bus import BusFigures, LineFigures

MBIT_S = 1_000_000


def bus_row(bus: BusFigures) -> dict[str, Any]:
    """Return the figures of a segment as the table prints them."""
    return {
        "segment": bus.segment,
        "bitrate": _bit_rate(bus.bitrate),
        "loads": [
            f"{load_pct:.1f}" for load_pct in (bus.load_pct, bus.load_100ms_pct, bus.load_1ms_pct)
        ],
        "frames": bus.frames,
        "error_frames": bus.error_frames,
        "overload": bus.overload,
        "counters": [
            {"port": port, "tec": tec, "rec": rec, "state": state}
            for port, tec, rec, state in bus.counters
        ],
        "waiting": [
            {"name": wait.name, "id": _identifier(wait.can_id), "us": f"{wait.worst_us:.1f}"}
            for wait in bus.waiting
        ],
        "line": line_facts(bus.line) if bus.line else [],
    }


def _identifier(can_id: int) -> str:
    """The identifier of frames that waited; bit 31 marks one of 29 bits."""
    return identifier_text(can_id & ~EXTENDED_FLAG, bool(can_id & EXTENDED_FLAG))


def _bit_rate(bits_s: int) -> str:
    return f"{bits_s / 1e6:g} Mbit/s" if bits_s > MBIT_S else f"{bits_s / 1000:g} kbit/s"


def line_facts(line: LineFigures) -> list[tuple[str, str, bool]]:
    """Return cycle, working counters and states of a line: name, text, whether it is wrong."""
    lost = line.sent - line.back
    wrong = f"{line.counter}, another one in {line.wrong} frames"
    if line.wrong_in_a_row > 1:
        wrong += f", {line.wrong_in_a_row} in a row"
    return [
        ("cycle", f"{line.period_us:g} µs, of it the frame {line.wire_us:.2f} µs", False),
        ("cyclic frames", f"{line.sent}, not back {lost}", lost > 0),
        ("working counter", wrong, line.wrong > 0),
        *((f"{axis}: AL state", state, state != "OP") for axis, state in line.slaves),
    ]
