"""Which kind of plant an FMU is: by the roles that a rig maps, else by all its variables."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi.roles import Source, coordinates_of, guess_kind

RAMP = ("reference_position", "reference_velocity", "reference_time", "reference_end")
WAY = ("step_time", "step_size", "z_start", "z_rate_start", "z_end", "z_rate_end")


def fmu(inputs: tuple[str, ...] = (), outputs: tuple[str, ...] = (), **others: str) -> Any:
    """An FMU with these variables; others: causality by name."""
    found = dict.fromkeys(inputs, "input") | dict.fromkeys(outputs, "output") | others
    return SimpleNamespace(
        has=found.__contains__, variable=lambda name: SimpleNamespace(causality=found[name]),
        names=lambda causality: [name for name, own in found.items() if own == causality],
    )  # fmt: skip


AXIS, PROBE, DISTANCE = (RAMP, ("position",)), (WAY, ("signal",)), (WAY, ("distance",))


def both(*kinds: tuple[tuple[str, ...], tuple[str, ...]]) -> Any:
    return fmu(sum((k[0] for k in kinds), ()), sum((k[1] for k in kinds), ()))


@pytest.mark.parametrize(
    ("inputs", "outputs", "kind"),
    [
        (*AXIS, "axis"), (("demand",), ("position",), "axis"), (("demand",), ("velocity",), None),
        (RAMP[:3], ("position",), None), ((), ("position",), None),
        (*PROBE, "probe"), (("z_position",), ("signal",), "probe"),
        (("x_position", "z_position"), ("signal",), "probe"), (WAY[:5], ("signal",), None),
        (WAY, (), None), ((), ("signal",), None), (("z_position",), ("clearance",), None),
        (*DISTANCE, "distance"), (("z_position",), ("distance",), "distance"),
        (("z_position",), ("distance_true",), None), (("position", "demand"), (), None),
    ],
)  # fmt: skip
def test_an_fmu_is_the_kind_whose_roles_its_variables_fill(
    inputs: tuple[str, ...], outputs: tuple[str, ...], kind: str | None
) -> None:
    assert guess_kind(fmu(inputs, outputs), {}) == kind


@pytest.mark.parametrize(
    "kinds",
    [(AXIS, PROBE), (AXIS, DISTANCE), (PROBE, DISTANCE), (AXIS, PROBE, DISTANCE)],
)
def test_an_fmu_that_fits_several_kinds_is_none_of_them_by_itself(kinds: Any) -> None:
    """The rig then has to say `kind`."""
    assert guess_kind(both(*kinds), {}) is None


@pytest.mark.parametrize(
    ("names", "kind"),
    [
        (("clearance",), "probe"), (("contact_count", "signal"), "probe"),
        (("valid",), "distance"), (("touching", "distance_true"), "distance"),
        (("kv",), "axis"), (("force", "velocity"), "axis"),
        (("step_time",), None), (("z_position",), None),  # probes and distance sensors have them
        (("clearance", "valid"), None), (("kv", "signal"), None),
    ],
)  # fmt: skip
def test_roles_that_a_rig_maps_decide_where_one_kind_has_them(
    names: tuple[str, ...], kind: str | None
) -> None:
    found = both(AXIS, PROBE, DISTANCE)
    assert guess_kind(found, {name: Source("anything") for name in names}) == kind


@pytest.mark.parametrize(
    ("left_out", "kind"),
    [
        (("distance",), "probe"), (("signal",), "distance"), (("valid",), None),
        (("signal", "clearance"), "distance"), (("signal", "distance"), None),
    ],
)  # fmt: skip
def test_a_role_that_is_left_out_speaks_for_no_kind(
    left_out: tuple[str, ...], kind: str | None
) -> None:
    """A sensor that reports both: `signal = false` makes it a distance sensor."""
    assert guess_kind(both(PROBE, DISTANCE), dict.fromkeys(left_out)) == kind


def test_a_role_that_is_left_out_stands_beside_mapped_ones() -> None:
    found = both(PROBE, DISTANCE)
    sources = {"distance": None, "valid": None, "clearance": Source("gap")}
    assert guess_kind(found, sources) == "probe"
    assert guess_kind(fmu(*AXIS), {"enabled": None, "kv": None}) == "axis"


@pytest.mark.parametrize(("causality", "kind"), [("output", "axis"), ("local", "axis"),
                                                 ("input", None), ("parameter", None)])  # fmt: skip
def test_a_variable_of_another_causality_has_only_the_name_of_a_role(
    causality: str, kind: str | None
) -> None:
    assert guess_kind(fmu(("demand",), position=causality), {}) == kind


@pytest.mark.parametrize(
    ("inputs", "mapped", "found"),
    [
        (("z_position",), (), ["z"]), (("x_start", "x_rate_start", "z_end"), (), ["x", "z"]),
        (("x_rate_start", "z_rate_end"), (), ["x", "z"]), ((), ("y_position",), ["y"]),
        (("z_position",), ("x_position",), ["z", "x"]),
        (("z_start", "z_end", "z_position"), (), ["z"]), (("position", "offset"), (), []),
        (RAMP, (), []), ((), ("motor_position",), []),  # of an axis
    ],
)  # fmt: skip
@pytest.mark.parametrize("kind", ["probe", "distance"])
def test_coordinates_are_those_of_inputs_and_mapped_roles(
    inputs: tuple[str, ...], mapped: tuple[str, ...], found: list[str], kind: str
) -> None:
    sources = {name: Source("anything") for name in mapped}
    assert sorted(coordinates_of(fmu(inputs), kind, sources)) == sorted(found)
    assert coordinates_of(fmu(inputs), "axis", sources) == []
