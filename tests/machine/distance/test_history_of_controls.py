"""What a run keeps of its distance controls: changes, orders, guides and diagnosis data.

Controls are set by hand, cycle by cycle of 1 ms; what must be kept is written out.
"""

from dataclasses import fields
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.recording.distance_log import DistanceLog, controller
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.record.distance import DistanceOrder
from axisrig.bench.record.kinematics import GuideChange
from axisrig.kernel.channel.distance.guide import AxisGuide, StayingGuide, ToolGuide
from axisrig.kernel.channel.distance.orders import Order
from axisrig.kernel.channel.distance.sensor import VariableSensor
from axisrig.kernel.distance import DistanceSettings, DistanceState, Source
from axisrig.kernel.distance.filters import FilterSettings
from axisrig.kernel.distance.law import Derivative, DerivativeOf, DistanceLaw, StepLimiter
from axisrig.kernel.time.clock import MS

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

OFF, ON = DistanceState.INACTIVE, DistanceState.ACTIVE


class Control:
    """The control of an axis, or that of the channel, with a variable as its sensor."""

    def __init__(self, variable: str) -> None:
        self.sensor = VariableSensor.__new__(VariableSensor)
        self.sensor.name = variable
        self.guide: Any = None
        self.control = SimpleNamespace(
            state=OFF, source=Source.NC, is_dry_run=False, settings=DistanceSettings()
        )


class Channel:
    """A channel whose controls a test changes; `cycle` lets the log look at it."""

    def __init__(self, *axes: str, whole: bool = False) -> None:
        self.log = DistanceLog()
        self.orders: list[Order] = []
        self.axes = {name: Control(f"GAP_{name}") for name in axes}
        self.whole = Control("GAP") if whole else None
        self.counted = 0
        self.distance = SimpleNamespace(
            orders=self.orders, axes=self.axes, channel=self.whole, diagnosis=self._diagnosis
        )
        self.sync_ns = 0

    def _diagnosis(self) -> dict[str, str]:
        self.counted += 1
        return {"DIST_CTRL::kp": str(self.counted)}

    def cycle(self, axis: str | None = None, **changes: Any) -> None:
        self.sync_ns += MS
        if axis is not None:
            found = self.whole if axis == CHANNEL else self.axes[axis]
            assert found is not None
            for name, value in changes.items():
                setattr(found.control, name, value)
        self.log(self)  # type: ignore[arg-type]

    def states(self, axis: str) -> list[tuple[int, str]]:
        return [(one.time_ns // MS, one.state) for one in self.log.recorded(axis)]


CHANGES: dict[str, tuple[str, Any, str, Any]] = {
    "state": ("state", DistanceState.FREEZE, "state", "FREEZE"),
    "who commanded": ("source", Source.PLC, "by", "PLC"),
    "dry run": ("is_dry_run", True, "is_dry_run", True),
}


@pytest.mark.parametrize("what", CHANGES)
def test_each_kind_of_change_is_noted_once_and_of_its_axis_alone(what: str) -> None:
    field, value, name, kept = CHANGES[what]
    channel = Channel("Y", "Z")
    channel.cycle("Z", state=ON)
    channel.cycle()
    channel.cycle("Z", **{field: value})
    channel.cycle()
    found = channel.log.recorded("Z")
    assert [one.time_ns for one in found] == [MS, 3 * MS]
    assert getattr(found[1], name) == kept != getattr(found[0], name)
    assert len(channel.log.recorded("Y")) == 1
    assert channel.log.axes == ["Y", "Z"]


def test_another_sensor_is_a_change_and_named() -> None:
    channel = Channel("Z")
    channel.cycle("Z", state=ON)
    channel.axes["Z"].sensor.name = "OTHER"
    channel.cycle()
    assert [one.sensor for one in channel.log.recorded("Z")] == [
        "VARIABLE V.E.GAP_Z",
        "VARIABLE V.E.OTHER",
    ]


def test_parameters_of_a_control_that_is_off_are_kept_when_it_is_on() -> None:
    """Off with kp 0.5, then 0.25; on in the fourth cycle; 0.75 while it is on; off again, 0.1."""

    def with_kp(kp: float) -> DistanceSettings:
        return DistanceSettings(kp=kp)

    channel = Channel("Z")
    for changes in (
        {"settings": with_kp(0.5)}, {"settings": with_kp(0.25)}, {}, {"state": ON},
        {"settings": with_kp(0.75)}, {"state": OFF}, {"settings": with_kp(0.1)},
        {"settings": with_kp(0.2), "state": DistanceState.FREEZE}, {"settings": with_kp(0.3)},
    ):  # fmt: skip
        channel.cycle("Z", **changes)
    found = channel.log.recorded("Z")
    kept = [(one.time_ns // MS, one.state, one.controller.kp) for one in found]
    assert kept == [
        (1, "INACTIVE", 0.5), (4, "ACTIVE", 0.25), (5, "ACTIVE", 0.75), (6, "INACTIVE", 0.75),
        (8, "FREEZE", 0.2), (9, "FREEZE", 0.3),
    ]  # fmt: skip
    assert channel.log.recorded("X") == ()


def test_every_parameter_comes_from_its_own_setting() -> None:
    """P-AXIS-00783 (sigma) is 0.1 um in the list, mm in the recording."""
    settings = DistanceSettings(
        kp=1.5, tn_s=2.5, tv_s=3.5, both_encoders=True,
        filter=FilterSettings(kind="LOWPASS_FILTER", n_cycles=7, smoothing_factor=0.125,
                              low_pass_filter_order=4, low_pass_filter_fg_f0=60.0,
                              kalman_sigma=250.0),
        law=DistanceLaw(DerivativeOf.ERROR, StepLimiter.CLAMP, Derivative.PER_CYCLE),
    )  # fmt: skip
    found = controller(settings)
    expected = {
        "kp": 1.5, "tn_s": 2.5, "tv_s": 3.5, "both_encoders": True,
        "filter_type": "LOWPASS_FILTER", "count": 7, "alpha": 0.125, "order": 4,
        "corner_hz": 60.0, "sigma_mm": 0.025, "derivative_of": "error", "limiter": "clamp",
        "derivative": "per_cycle",
    }  # fmt: skip
    assert {one.name: getattr(found, one.name) for one in fields(found)} == expected


def test_orders_belong_to_their_axis_and_to_the_cycle_that_has_seen_them() -> None:
    channel = Channel("Y", "Z", whole=True)
    channel.orders.append(Order("Z", "NC", "ON", is_dry_run=True, set_pos_mm=3.0))
    channel.cycle()
    channel.cycle()
    channel.orders += [
        Order("Y", "PLC", "FREEZE"),
        Order(None, "NC", "ON_CONST_DIST", set_dist_mm=2.0, parameters={"kp": 0.5}),
        Order("Z", "OBJECT", parameters={"v_max": 2000.0}),
    ]
    channel.cycle()
    log = channel.log
    assert log.orders("Z") == (
        DistanceOrder(MS, "NC", "ON", True, 3.0, None, {}),
        DistanceOrder(3 * MS, "OBJECT", "", False, None, None, {"v_max": 2000.0}),
    )
    assert log.orders("Y") == (DistanceOrder(3 * MS, "PLC", "FREEZE"),)
    assert log.orders(CHANNEL) == (
        DistanceOrder(3 * MS, "NC", "ON_CONST_DIST", False, None, 2.0, {"kp": 0.5}),
    )


def test_set_values_of_the_plc_are_kept_beside_an_order_of_the_program_only() -> None:
    channel = Channel("Y", "Z")
    value = Order("Z", "PLC", set_dist_mm=2.5)
    for orders in ([value], [value, Order("Y", "NC", set_dist_mm=1.0)],
                   [value, Order("Z", "NC", set_dist_mm=2.0)]):  # fmt: skip
        channel.orders += orders
        channel.cycle()
    kept = [(one.time_ns // MS, one.by, one.set_dist_mm) for one in channel.log.orders("Z")]
    assert kept == [(3, "PLC", 2.5), (3, "NC", 2.0)]
    assert [one.by for one in channel.log.orders("Y")] == ["NC"]


WORDS = {
    # As `DistanceControl.program` calls them, and as the lists do (objects.csv, docs/parameters.md)
    "kp": "kp", "tn_s": "i_tn", "tv_s": "d_tv", "filter_type": "filter_type",
    "smoothing_factor": "smoothing_factor", "low_pass_filter_order": "low_pass_filter_order",
    "max_change_mm_s": "max_act_value_change", "both_encoders": "mode_dist_use_both_encoder",
    "filter_time_s": "filter_time_s", "v_max": "v_max",
}  # fmt: skip


@pytest.mark.parametrize("name", WORDS)
def test_a_parameter_that_is_ordered_has_the_name_of_the_list(name: str) -> None:
    channel = Channel("Z")
    channel.orders.append(Order("Z", "NC", parameters={name: 1.0}))
    channel.cycle()
    (order,) = channel.log.orders("Z")
    assert order.words == {WORDS[name]: 1.0}


def tool_guide() -> ToolGuide:
    guide = ToolGuide.__new__(ToolGuide)
    guide.mode, guide.axes = "ECS", ("X", "Y", "Z", "A", "B")
    guide.normal, guide.origin_mm = (0.0, 0.6, 0.8), (1.0, 2.0, 3.0)
    return guide


def test_a_guide_is_noted_when_another_one_acts() -> None:
    """An offset that stays where it was acts nowhere new; what comes after it is compared with
    the guide before it.
    """
    channel = Channel(whole=True)
    assert channel.whole is not None
    along_z, along_tool = AxisGuide("Z", 2), tool_guide()
    staying = StayingGuide.__new__(StayingGuide)
    for guide in (None, along_z, along_z, staying, along_z, along_tool, staying, None, along_z):
        channel.whole.guide = guide
        channel.cycle()
    assert channel.log.guides == (
        GuideChange(2 * MS, "ACS", "Z"),
        GuideChange(6 * MS, "ECS", "", (0.0, 0.6, 0.8), (1.0, 2.0, 3.0)),
        GuideChange(8 * MS),
        GuideChange(9 * MS, "ACS", "Z"),
    )


def test_diagnosis_data_are_those_of_each_change_and_of_the_end() -> None:
    channel = Channel("Z", whole=True)
    channel.cycle()
    channel.cycle("Z", state=ON)  # another control
    channel.cycle(CHANNEL, state=ON)
    channel.cycle()
    assert channel.states(CHANNEL) == [(1, "INACTIVE"), (3, "ACTIVE")]
    assert channel.log.axes == ["Z"]
    dumps = channel.log.dumps(channel)  # type: ignore[arg-type]
    assert [dump.time_ns for dump in dumps] == [MS, 3 * MS, 4 * MS]
    assert [dump.values["DIST_CTRL::kp"] for dump in dumps] == ["1", "2", "3"]
    plain = Channel("Z")
    plain.cycle()
    assert (plain.log.dumps(plain), plain.log.guides) == ((), ())  # type: ignore[arg-type]


@pytest.mark.parametrize("names", [("Z", "X"), ("X", "Z"), ("Z", "A", "X")])
def test_axes_with_a_control_are_in_the_order_of_the_channel(names: tuple[str, ...]) -> None:
    """That of the channel itself, 3D control, is none of them."""
    made = Channel(*names, whole=True)
    made.cycle()
    made.cycle(CHANNEL, state=ON)
    assert made.log.axes == list(names)
