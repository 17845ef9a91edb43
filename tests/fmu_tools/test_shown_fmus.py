"""What `axisrig fmu show` says of a description that is written down here."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.fmu import show
from axisrig.bench.tools.fmu.binaries import Binary
from axisrig.bench.tools.fmu.show import Shown


def unknown(name: str, *on: tuple[str, str], given: bool = True, kinds: bool = True) -> Any:
    return SimpleNamespace(
        variable=SimpleNamespace(name=name),
        dependencies=[SimpleNamespace(name=other) for other, _ in on] if given else None,
        dependenciesKind=[kind for _, kind in on] if kinds else None,
    )


def test_what_an_output_depends_on_is_shown_with_its_kind() -> None:
    for one, text in (
        (unknown("y", ("a", "dependent"), ("b", "constant")), "y: depends on a, b (constant)"),
        (unknown("y", ("a", "fixed"), kinds=False), "y: depends on a"),
        (unknown("y"), "y: depends on nothing"),
        (unknown("y", given=False), "y: dependencies are not given"),
    ):
        assert show._depends(one) == text
    bare = SimpleNamespace(variable=None, dependencies=[], dependenciesKind=[])
    assert show._depends(bare) == "?: depends on nothing"  # type: ignore[arg-type]
    own: Any = SimpleNamespace(outputs=[unknown("y")], derivatives=[1, 2], eventIndicators=[],
                               numberOfEventIndicators=5, initialUnknowns=[1])  # fmt: skip
    last = "  2 continuous states, 5 event indicators, 1 initial unknowns"
    assert list(show._structure(own)) == ["structure", "  y: depends on nothing", last]
    own.eventIndicators = [1, 2, 3]
    assert "3 event indicators" in list(show._structure(own))[-1]


@pytest.mark.parametrize(
    ("values", "text"),
    [
        (None, None), ((None, None, None), None), (("0", None, "0.001"), "start 0 s, step 0.001 s"),
        (("0", "1", "2"), "start 0 s, stop 1 s, step 2 s"),
    ],
)  # fmt: skip
def test_an_experiment_is_shown_as_far_as_it_is_given(values: Any, text: str | None) -> None:
    keys = ("startTime", "stopTime", "stepSize")
    given = None if values is None else SimpleNamespace(**dict(zip(keys, values, strict=True)))
    found = list(show._experiment(SimpleNamespace(defaultExperiment=given)))  # type: ignore[arg-type]
    assert found == ([] if text is None else [("experiment", text)])


def test_promises_are_shown_one_by_one() -> None:
    can = {"can_vary_step": True, "can_save_state": False, "can_serialize_state": True,
           "can_return_early": False, "fixed_step_s": None, "once_per_process": False,
           "needs_tool": False}  # fmt: skip
    words = ["take steps of any length: yes", "save and restore its state: no",
             "write its state as bytes: yes", "return early from a step: no"]  # fmt: skip
    assert list(show._capabilities(SimpleNamespace(**can))) == words  # type: ignore[arg-type]
    more = {"fixed_step_s": 0.0005, "once_per_process": True, "needs_tool": True}
    assert list(show._capabilities(SimpleNamespace(**{**can, **more}))) == [  # type: ignore[arg-type]
        *words, "internal step 0.0005 s", "exist once in a process only",
        "run only with the tool that made it",
    ]  # fmt: skip


def shown(binaries: list[Binary], can: Any = None, **given: Any) -> list[tuple[str, str]]:
    known = {"modelName": "M", "fmiVersion": "3.0", "coSimulation": None,
             "modelExchange": None, "scheduledExecution": None,
             "buildConfigurations": [], "defaultExperiment": None}  # fmt: skip
    words = ("description", "version", "author", "license", "generationTool",
             "generationDateAndTime")  # fmt: skip
    own: Any = SimpleNamespace(**{**known, **dict.fromkeys(words), **given})
    entries = [SimpleNamespace(size=1 << 20), SimpleNamespace(size=1 << 19)]
    archive: Any = SimpleNamespace(path=Path("a.fmu"), entries=entries, sha256="ab")
    object.__setattr__(archive, "bytes", 0)
    archive.size = 1234
    return list(show._head(Shown(archive, own, can, binaries)))


def test_the_head_has_file_model_interfaces_and_platforms() -> None:
    here = Binary("x86_64-linux", "m.so", "linux", ("x86_64",))
    head = shown([here], coSimulation=1, modelExchange=1, author="somebody", license="")
    assert ("model", "M") in head
    assert ("FMI", "3.0, co-simulation, model exchange") in head
    assert ("author", "somebody") in head
    assert not any(label == "license" for label, _ in head)
    assert ("platform", "x86_64-linux (x86_64, linux)") in head
    assert dict(head)["size"].endswith("1.50 MiB in 2 entries")
    none = dict(shown([]))
    assert (none["FMI"], none["platform"]) == ("3.0, no interface", "none")
    assert dict(shown([], buildConfigurations=[1]))["platform"] == "none: sources only"


@pytest.mark.parametrize(
    ("folder", "processors", "end"),
    [
        ("darwin64", ("x86_64", "aarch64"), "; runs on Intel and Apple processors"),
        ("darwin64", ("x86_64",),
         "; not universal: FMI 2.0 has one folder for both processors of macOS"),
        ("x86_64-darwin", ("x86_64",), ")"),
    ],
)  # fmt: skip
def test_the_one_folder_of_macos_is_explained(
    folder: str, processors: tuple[str, ...], end: str
) -> None:
    assert show._platform(Binary(folder, "m.dylib", "darwin", processors)).endswith(end)


def test_the_size_is_that_of_the_file_and_what_is_in_it_is_beside_it() -> None:
    """1234 bytes as it lies there; 1 MiB and half a MiB are in it. Then what identifies it."""
    found = shown([])
    assert found[:4] == [
        ("file", "a.fmu"), ("size", "1234 bytes, 1.50 MiB in 2 entries"), ("sha256", "ab"),
        ("model", "M"),
    ]  # fmt: skip
    assert [label for label, _ in found[4:]] == ["FMI", "platform"]  # nothing else is given
    facts = {"description": "d", "version": "v", "author": "a", "license": "l",
             "generationTool": "t", "generationDateAndTime": "2026"}  # fmt: skip
    labels = ["description", "version", "author", "license", "tool", "made"]
    assert [pair for pair in shown([], **facts) if pair not in found] == [
        *zip(labels, facts.values(), strict=True)
    ]
    for name, label in zip(facts, labels, strict=True):
        assert [pair for pair in shown([], **{name: facts[name]}) if pair not in found] == [
            (label, facts[name])
        ]
