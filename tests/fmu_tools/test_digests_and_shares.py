"""What the trials of an FMU compare: digests, shares, long values, flags; no FMU is run."""

import ctypes
import math
import platform
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import texts, variable
from tests.fmu_tools.test_course_shares import REAL, course, outputs
from tests.fmu_tools.test_fmu_trial_run import OUTPUTS, reading
from tests.fmu_tools.test_trials_and_roles import Kinds, found, role

from axisrig.bench.tools.fmu import check, library, roles, stages, stepped_instance
from axisrig.bench.tools.fmu.check import check_fmu
from axisrig.bench.tools.fmu.courses import _differing
from axisrig.bench.tools.fmu.examine import Examined
from axisrig.bench.tools.fmu.findings import ok
from axisrig.bench.tools.fmu.stepped_instance import first_difference, largest_share
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

FMU = Path("a.fmu")


def test_a_digest_is_of_every_reading_from_the_start_to_the_last_step(fake: Any) -> None:
    """Another process has other memory: a value that depends on it changes the digest, anywhere."""
    digests = {}
    for odd_at in (None, 0, 1, 50, 99, 100):
        fake(odd=staticmethod(lambda _, count, at=odd_at: 0.5 * (count == at)))
        digests[odd_at] = stages.determinism(FMU).digest
    assert len(set(digests.values())) == len(digests)


# IEEE 754, 4.3: modes of rounding, as fenv.h has them on x86
UP, DOWN, TO_ZERO = 0x800, 0x400, 0xC00


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="words of x86")
@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "fesetround"), reason="needs fenv.h")
@pytest.mark.parametrize("mode", [UP, DOWN, TO_ZERO])
def test_arithmetic_that_does_not_round_to_nearest_is_no_plain_one(mode: int) -> None:
    fesetround = ctypes.CDLL(None).fesetround
    assert stages._has_plain_arithmetic()
    try:
        assert fesetround(mode) == 0
        is_plain = stages._has_plain_arithmetic()
    finally:
        fesetround(0)
    assert not is_plain
    assert stages._has_plain_arithmetic()


# Shares


@pytest.mark.parametrize(("few", "many"), [(1, 2), (0, 3)])
def test_runs_of_other_lengths_have_no_share(few: int, many: int) -> None:
    """Whichever is longer."""
    both = [[reading(at, (1.0,), (1.0,)) for at in range(count)] for count in (few, many)]
    assert largest_share(*both, OUTPUTS) == math.inf
    assert largest_share(*both[::-1], OUTPUTS) == math.inf


@pytest.mark.parametrize(
    ("offs", "share"),
    [
        ((0.5, 0.0), 0.05), ((0.0, 0.5), 0.5), ((0.5, 0.25), 0.25), ((4.0, 0.25), 4 / 13),
        ((-4.0, 0.25), 0.4), ((0.0, -0.25), 0.25), ((0.0, 0.0), 0.0),
    ],
)  # fmt: skip
def test_the_share_is_that_of_the_output_that_differs_most(
    offs: tuple[float, float], share: float
) -> None:
    """Of outputs that go to 10 and to 1: in the middle of the run they are off."""
    one = [reading(at, (10.0 - at,), (1.0 - at / 2,)) for at in range(3)]
    other = list(one)
    other[1] = reading(1, (9.0 + offs[0],), (0.5 + offs[1],))
    assert largest_share(one, other, OUTPUTS) == pytest.approx(share)
    assert largest_share(other, one, OUTPUTS) == pytest.approx(share)


@pytest.mark.parametrize("value", [math.inf, math.nan, True, "word"])
def test_what_is_no_finite_number_has_no_share(value: Any) -> None:
    one, other = ([reading(0, (1.0,), (each,))] for each in (value, 0.0))
    assert largest_share(one, other, OUTPUTS) == math.inf
    assert largest_share(one, list(one), OUTPUTS) == 0.0


@pytest.mark.parametrize(("middle", "share"), [(1000.5005, None), (1000.502, 0.002)])
def test_a_range_is_how_far_an_output_goes_and_not_where_it_is(
    middle: float, share: float | None
) -> None:
    """From 1000 to 1001 in steps of 1 ms; that of 0.5 ms is off in the middle."""
    courses = {MS: course([1000.0, 1000.5, 1001.0]),
               MS // 2: course([1000.0, 0.0, middle, 0.0, 1001.0])}  # fmt: skip
    shares = [by for _, _, by in _differing(courses, outputs(REAL))]
    assert shares == ([] if share is None else [pytest.approx(share)])


@pytest.mark.parametrize(("count", "is_cut"), [(20, False), (21, True)])
def test_values_of_sixty_signs_are_shown_whole(count: int, is_cut: bool) -> None:
    """20 numbers of one digit and their commas are 58 signs."""
    values = (777, *[7] * (count - 1))
    text = ", ".join(map(str, values))
    assert (len(text) > 60) is is_cut
    one, other = ([reading(0, each, (1,))] for each in (values, (0,)))
    words = first_difference(one, other, OUTPUTS)
    assert words == f"a at t = 0 ms is {f'{text[:60]}...' if is_cut else text} and 0"


# Inputs


@pytest.mark.parametrize(
    ("start", "is_on"),
    [("true", True), ("True", True), (" 1", True), ("1", True), ("false", False), ("0", False),
     (None, False), ("", False)],
)  # fmt: skip
def test_a_flag_begins_as_its_start_value_and_changes_once(start: Any, is_on: bool) -> None:
    """FMI 2.0 and 3.0: xs:boolean, which is true, false, 1 or 0."""
    flag = variable("flag", type="Boolean", start=start)
    for at, value in ((0, is_on), (9, is_on), (10, not is_on), (99, not is_on)):
        assert [one for _, one in stepped_instance._moved_inputs([flag], at)] == [value]


# What the command line says


def test_strictness_and_the_longest_call_reach_the_process_that_reads(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given: list[tuple[Any, Any]] = []

    def run_apart(_: object, tasks: Any, **options: Any) -> Any:
        given.extend((task, options["call_limit_s"]) for task in tasks)
        return iter([Examined([ok("archive", "x")], "ab", False)])

    monkeypatch.setattr(check, "run_apart", run_apart)
    for is_strict in (False, True):
        check_fmu(FMU, 7.0, is_strict=is_strict)
    assert given == [([FMU, False], 7.0), ([FMU, True], 7.0)]


@pytest.mark.parametrize(
    "given", [{"fmi": ["2.0"]}, {"fmi": ["3.0", "2.0"]}, {"platforms": ["x86_64-linux"]},
              {"platforms": ["all"]}, {"compiler": "cc"}, {"compiler": "zig"}],
)  # fmt: skip
def test_a_model_of_ones_own_is_built_in_one_way(given: dict[str, Sequence[str] | str]) -> None:
    with pytest.raises(UserError, match=r"as FMI 3\.0 for this platform") as caught:
        list(library.build_models("own.mo", **given))  # type: ignore[arg-type]
    assert caught.value.value == "own.mo"
    with pytest.raises(UserError, match="there is no such model"):
        list(library.build_models("own.mo"))


@pytest.mark.parametrize(
    ("coordinates", "words"),
    [([], "at_x = here"), (["x"], "at_x = here"), (["x", "z"], "at_x = here; at_z = here")],
)
def test_a_sensor_that_names_no_coordinate_may_read_x_by_a_map(
    coordinates: list[str], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    kinds = Kinds(monkeypatch)
    kinds.coordinates["axis"] = coordinates
    monkeypatch.setattr(roles, "KINDS", ("axis",))
    monkeypatch.setattr(
        roles, "roles_of", lambda _, names: {f"at_{name}": role() for name in names}
    )
    monkeypatch.setattr(roles, "bind", lambda *_: None)
    slave = SimpleNamespace(description=SimpleNamespace(
        modelVariables=[variable("here", causality="output")]))  # fmt: skip
    assert texts(roles.role_findings(slave)) == [  # type: ignore[arg-type]
        f"kind axis with a map (docs/rigs.md): {words}"
    ]
    assert [level for level, _ in found(slave)] == ["ok"]
