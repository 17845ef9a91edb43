"""What a terminal shows of a running campaign, drawn with rich beneath the line of its progress."""

from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from axisrig.bench.cli.beside.feed import Look

OLD_S = 1.5
"""A state as old as this is shown with its age."""
_BAD = ("fault", "fault reaction active", "quick stop active", "error")
_GOOD = ("operation enabled", "active", "active const dist")


def drawing(look: Look) -> RenderableType:
    """Draw what is known of the run that is under way."""
    state = look.state
    if state is None:
        return Text("waiting for a run", style="dim")
    parts: list[RenderableType] = [*_head(look, state), _axes(state["axes"])]
    if state["distance"]:
        parts.append(_distance(state["distance"]))
    parts += _probes_and_buses(state)
    parts += [Text(text, style="bold red") for text in state["alarms"]]
    parts += [Text(text) for text in state["messages"][-2:]]
    return Group(*parts)


def _head(look: Look, state: Mapping[str, Any]) -> list[Text]:
    factor = "" if look.factor is None else f", {look.factor:.3g} times real time"
    old = f", no new state for {look.age_s:.0f} s" if look.age_s > OLD_S else ""
    held = ", feedhold" if state["is_held"] else ""
    time = f"{state['time_ns'] / 1e9:.3f} s simulated{factor}{old}; channel {state['channel']}"
    at = state["block"]
    block = state["waits_for"]
    if at is not None:
        block = f"{at}: {state['block_text']}  waits for {block}"
    return [
        Text(f"{state['run']}  {state['title']}", style="bold"),
        Text(time + held),
        Text(block),
        *_real_time(state["real_time"]),
    ]


def _real_time(kept: Mapping[str, Any] | None) -> list[Text]:
    if kept is None:
        return []
    late = f"{kept['late']} of the last {kept['looked_at']} SYNCs late"
    return [Text(f"real time: {late}, {kept['worst_us']:.0f} us at most")]


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:z.4f}"


def _word(word: str) -> Text:
    return Text(word, style="red" if word in _BAD else "green" if word in _GOOD else "")


def _table(columns: Sequence[str]) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for column in columns:
        name, _, side = column.partition(">")
        table.add_column(name, justify="right" if side else "left", no_wrap=True)
    return table


def _axes(axes: Sequence[Mapping[str, Any]]) -> Table:
    columns = ("axis", "actual>r", "set>r", "lag>r", "", "drive", "touch probe", "measuring")
    table = _table([*columns, "last latch>r"])
    for axis in axes:
        latch = axis["latch"]
        table.add_row(
            axis["axis"],
            *(_number(axis[name]) for name in ("actual", "set", "lag")),
            axis["unit"],
            _word(axis["drive"]),
            axis["touch_probe"],
            axis["measuring"] or "no",
            "none" if latch is None else _number(latch["position"]),
        )
    return table


def _distance(controls: Sequence[Mapping[str, Any]]) -> Table:
    names = ("offset", "reading", "distance", "error")
    table = _table(["distance control", "state", *(f"{name}>r" for name in names), ""])
    for one in controls:
        numbers = (_number(one[name]) for name in names)
        table.add_row(one["axis"], _word(one["state"]), *numbers, one["unit"])
    return table


def _probes_and_buses(state: Mapping[str, Any]) -> list[Text]:
    probes = [f"probe {one['probe']} {'on' if one['level'] else 'off'}" for one in state["probes"]]
    buses = [
        f"bus {one['segment']} {one['load_pct']:.1f} %, {one['frames']} frames,"
        f" {one['error_frames']} error frames{', lost' if one['lost'] else ''}"
        f"{_line_words(one.get('line'))}"
        for one in state["bus"]
    ]
    return [Text(line) for line in (*probes, *buses)]


def _line_words(line: Mapping[str, Any] | None) -> str:
    """Say working counter and AL states of an EtherCAT line."""
    if line is None:
        return ""
    states = ", ".join(f"{axis} {state}" for axis, state in line["slaves"])
    return f", working counter {line['counter']}, wrong in {line['wrong']}; {states}"
