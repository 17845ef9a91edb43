"""An offset that is left: it stays on its axes, turns no more, and is part of the position.

Closed form, lever 180 mm, A = -40 deg: Y = 180 sin 40, Z = 180 cos 40 without an offset. Along the
tool 0.5 mm of it are Y + 0.5 tan 40 and Z + 0.5; the control of axis Z adds 0.5 mm to Z alone.
"""

import math
from collections.abc import Callable
from typing import Any

import pytest
from tests.channel.distance3d.programs import HEAD, INCREMENT_MM, LONG, TILTED, Make

from axisrig.kernel.channel import ChannelState
from axisrig.kernel.channel.distance.settings import AxisDistanceSettings
from axisrig.kernel.distance import DistanceState
from axisrig.kernel.nc.coordinates import OffsetTables
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.plc.interface import PlcParticipant

OFFSET_MM = 0.5
LEAN = math.radians(40)
Y_MM, Z_MM = 180 * math.sin(LEAN), 180 * math.cos(LEAN)
TOOL = {"Y": Y_MM + OFFSET_MM * math.tan(LEAN), "Z": Z_MM + OFFSET_MM}
AXIS = {"Y": Y_MM, "Z": Z_MM + OFFSET_MM}
# Surface of the control of Z: the clamping point is 100 mm cos 40 below the axis
ON = {
    "tool": "#DIST CTRL ON [SET_POS=0 MODE=ECS]\n",
    "axis": "Z[DIST_CTRL SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.MINUS ON "
    f"SET_POS={100 * math.cos(LEAN):.9f}]\n",
}
LEFT = {"tool": TOOL, "axis": AXIS}
SHOWN = '#MSG SYN["%f %f", V.A.ABS.Y, V.A.ABS.Z]\n'
TURN = "#TIME 0.02\nG1 F60000 A0\n#TIME 0.02\n"


class Side:
    """A PLC side: what it does in a turn, then a second program when the channel is ready."""

    def __init__(self, made: Any, second: str, acts: dict[int, Callable[[], None]]) -> None:
        self.made, self.acts, self.turn = made, acts, 0
        self.second, self.begun_at = second, 0
        made.channel.plc.join(
            PlcParticipant(self.take_turn, outlives_program=True, is_idle=self.is_idle)
        )

    def is_idle(self) -> bool:
        return bool(self.begun_at) and self.turn > self.begun_at + 400

    def take_turn(self) -> None:
        self.turn += 1
        self.acts.get(self.turn, lambda: None)()
        channel = self.made.channel
        if channel.state is ChannelState.ERROR:
            channel.plc.wants_reset = True
        if channel.state is ChannelState.READY and not self.begun_at:
            self.begun_at = self.turn
            names = [link.name for link in channel.links]
            program = parse_program(f"%s\n{self.second}\nM30\n", file="second.nc", axes=names)
            tables = OffsetTables(rotary=frozenset({"C", "A"}))
            external = channel.plc.values
            reading = Interpreter(program, names, channel, external=external, tables=tables)
            channel.plc.program = reading.commands()


def head(
    make_head: Make, tool: Any, kind: str, *, height_mm: float = OFFSET_MM, **changes: Any
) -> Any:
    """A head over a surface, with the control of Z where that is wanted."""
    spec = {}
    if kind == "axis":
        own = {k: v for k, v in changes.items() if k not in ("is_optimized", "options")}
        wanted = tool.wide(**{"kp": 0.5, "sensor_sign": 1} | own)
        is_optimized = bool(changes.get("is_optimized", True))
        spec = {"Z": {"distance": AxisDistanceSettings(wanted, is_optimized=is_optimized)}}
    made = make_head(lambda _ms: height_mm, spec=spec, **changes)
    values = made.channel.plc.values
    values["MINUS"] = 0.0
    # The PLC gives the distance h, the control of an axis wants -h
    made.channel.plc.inputs.append(lambda: values.update(MINUS=-values["SENSOR"]))
    return made


def turns(made: Any) -> tuple[int, int]:
    """The cycles in which A begins and ends to turn back from -40 degrees."""
    a = made.sent["A"]
    begin = max(k for k, at in enumerate(a) if at == pytest.approx(-40.0, abs=1e-9))
    return begin, next(k for k in range(begin, len(a)) if a[k] == pytest.approx(0.0, abs=1e-9))


def stand(made: Any, first: int, last: int, axes: dict[str, float]) -> None:
    """Y and Z are where they are said to be, and do not move from one cycle to another."""
    for name, mm in axes.items():
        sent = made.sent[name][first:last]
        assert sent[0] == pytest.approx(mm, abs=2 * INCREMENT_MM)
        assert max(sent) - min(sent) < 1e-9


def shown(made: Any) -> list[list[float]]:
    return [[float(word) for word in text.split()] for _, text in made.bench.messages]


@pytest.mark.provokes(900560, 1, offset_mm="0.500")
@pytest.mark.parametrize("buffer_cycles", [0, LONG(5)])
@pytest.mark.parametrize("is_optimized", [True, LONG(False)])
@pytest.mark.parametrize(
    ("kind", "cause"),
    [
        ("tool", "reset"),
        LONG("tool", "error"),
        LONG("tool", "end"),
        LONG("axis", "reset"),
        ("axis", "error"),
    ],
)
@pytest.mark.long
def test_what_is_left_stays_until_its_axes_are_named_and_then_they_reach_their_target(
    make_head: Make, tool: Any, kind: str, cause: str, is_optimized: bool, buffer_cycles: int
) -> None:
    """A turns by 40 deg and nothing else moves, #TRAFO begins from there, X Y Z are named."""
    changes: dict[str, Any] = {"is_optimized": is_optimized}
    if cause == "error":  # the offset is exactly at its limit
        changes |= {"max_deviation_mm": OFFSET_MM, "height_mm": 2 * OFFSET_MM}
    made = head(make_head, tool, kind, options={"buffer_cycles": buffer_cycles}, **changes)
    second = SHOWN + TURN + HEAD + SHOWN + "G1 X1 Y2 Z3"

    def reset() -> None:
        made.channel.plc.wants_reset = True

    Side(made, second, {400: reset} if cause == "reset" else {})
    last = "#TIME 0.3" if cause == "end" else "#TIME 5"
    made.run(TILTED + "#TIME 0.02\n" + ON[kind] + last)
    left, (begin, end) = LEFT[kind], turns(made)
    stand(made, begin - 15, end + 15, left)
    assert made.state[begin] is DistanceState.INACTIVE
    assert made.offset_mm[begin] == 0.0
    at, tcp = shown(made)
    assert at == pytest.approx(list(left.values()), abs=1e-5)
    assert tcp == pytest.approx([left["Y"], left["Z"] - 180.0], abs=1e-5)
    assert [made.sent[n][-1] for n in "XYZ"] == pytest.approx([1.0, 2.0, 183.0], abs=1e-9)
    assert made.alarm_ids.count(900560) == 1
    note = next(a for a in made.channel.alarms if a.id == 900560)
    assert note.values["offset_mm"] == "0.500"
    assert note.values["axes"] == ("Z" if kind == "axis" else "Y Z")


@pytest.mark.long
@pytest.mark.provokes(70332, 1, axis="Z")
def test_the_control_of_an_axis_is_on_after_the_end_of_its_program(
    make_head: Make, tool: Any
) -> None:
    """FCT-M3 6, notice: not deselected. While A turns to 0 the clamping point comes down by
    100 (1 - cos 40) and the offset, which follows the surface, is 0.5 mm less that.
    """
    made = head(make_head, tool, "axis", kp=1.0)
    Side(made, TURN + "G1 Z180", {})
    made.run(TILTED + ON["axis"] + "#TIME 0.3")
    assert made.channel.distance.control("Z").state is DistanceState.ACTIVE
    lower_mm = 100 * (1 - math.cos(LEAN))
    assert made.sent["Z"][-1] == pytest.approx(180 + OFFSET_MM + lower_mm, abs=INCREMENT_MM)
    assert made.alarm_ids[-1] == 70332


@pytest.mark.long
@pytest.mark.parametrize("kind", ["tool", LONG("axis")])
@pytest.mark.parametrize("buffer_cycles", [0, LONG(5)])
def test_frozen_while_the_kinematic_goes_it_stays_on_its_axes(
    make_head: Make, tool: Any, kind: str, buffer_cycles: int
) -> None:
    """#TRAFO OFF, A turns alone; the offset is still one: OFF takes it off its axes again."""
    made = head(make_head, tool, kind, options={"buffer_cycles": buffer_cycles})
    of = {"tool": "#DIST CTRL {}\n", "axis": "Z[DIST_CTRL {}]\n"}[kind].format
    off = of("WAIT OFF") if kind == "tool" else of("OFF WAIT")
    made.run(
        TILTED
        + ON[kind]
        + "#TIME 0.2\n"
        + of("FREEZE")
        + "#TRAFO OFF\n"
        + TURN
        + off
        + "#TIME 0.01"
    )
    begin, end = turns(made)
    stand(made, begin - 10, end + 10, LEFT[kind])
    assert made.sent["Y"][-1] == pytest.approx(Y_MM, abs=1e-9)
    assert made.sent["Z"][-1] == pytest.approx(Z_MM, abs=1e-9)
    assert 900560 not in made.alarm_ids


@pytest.mark.long
def test_frozen_over_a_turn_without_a_kinematic_it_goes_on_along_the_tool_only_where_it_was(
    make_head: Make, tool: Any
) -> None:
    """Back at A = -40 the tool has the direction of before; at A = -20 the axes would jump."""
    for a, alarms in ((-40, [900315]), (-20, [900315, 900462])):
        made = head(make_head, tool, "tool")
        made.run(
            TILTED + ON["tool"] + "#TIME 0.2\n#DIST CTRL FREEZE\n#TRAFO OFF\nG1 A0\nA"
            f"{a}\n#TRAFO [9]\n#DIST CTRL ON\n#TIME 0.05"
        )
        assert made.alarm_ids == alarms
