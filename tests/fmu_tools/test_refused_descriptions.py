"""Model descriptions that cannot be used: what the refusal names, and how many more there are."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from fmpy.model_description import ValidationError

from axisrig.kernel.cosim.fmi import fmu
from axisrig.kernel.errors import UserError

FILE = Path("press.fmu")


@pytest.fixture
def refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[..., UserError]:
    """Load a description that is what the test says, or raises it."""
    monkeypatch.setattr(fmu, "unpack", lambda _path: tmp_path)

    def load(found: Any) -> UserError:
        def read(_folder: Path) -> Any:
            if isinstance(found, Exception):
                raise found
            return found, ()

        monkeypatch.setattr(fmu, "read_description", read)
        with pytest.raises(UserError) as caught:
            fmu.load_description(FILE)
        assert caught.value.file == str(FILE)
        return caught.value

    return load


@pytest.mark.parametrize(("count", "more"), [(1, ""), (2, " (and 1 more)"), (5, " (and 4 more)")])
def test_of_several_problems_the_first_is_named_and_the_others_are_counted(
    refused: Callable[..., UserError], count: int, more: str
) -> None:
    error = refused(ValidationError([f"problem {n}" for n in range(count)]))
    assert error.message == f"the model description is rejected: problem 0{more}"
    assert error.hint == "axisrig fmu check FILE lists what is wrong"


@pytest.mark.parametrize(
    ("error", "words"), [(ValueError("no element"), "no element"), (KeyError(), "KeyError")]
)
def test_another_error_is_named_by_its_words_or_its_kind(
    refused: Callable[..., UserError], error: Exception, words: str
) -> None:
    assert refused(error).message == f"the model description is rejected: {words}"


def described(version: str = "3.0", identifier: str = "press", *, steps: bool = True) -> Any:
    interface = SimpleNamespace(modelIdentifier=identifier) if steps else None
    return SimpleNamespace(fmiVersion=version, coSimulation=interface, modelVariables=[])


@pytest.mark.parametrize("version", ["1.0", "4.0", "23.0"])
def test_another_version_is_named_beside_those_that_are_read(
    refused: Callable[..., UserError], version: str
) -> None:
    error = refused(described(version))
    assert (error.message, error.value) == ("FMI version not supported here", version)
    assert error.allowed == "2.0, 3.0"


@pytest.mark.parametrize("version", ["2.0", "2.0.4", "3.0", "3.1-beta"])
def test_every_release_of_two_and_three_is_asked_for_its_interface(
    refused: Callable[..., UserError], version: str
) -> None:
    assert refused(described(version, steps=False)).message == (
        "the FMU has no co-simulation interface"
    )


@pytest.mark.parametrize("identifier", ["", "../press", "a b", "1press", "pr\u00e4sse", "a.so"])
def test_a_model_identifier_is_a_name_in_c(
    refused: Callable[..., UserError], identifier: str
) -> None:
    """It is part of the path of the library."""
    error = refused(described(identifier=identifier))
    assert (error.message, error.value) == ("the model identifier is no C name", identifier)


@pytest.mark.parametrize("folders", [(), ("b86-linux", "a64-other")])
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_a_binary_for_another_platform_is_none_for_this_one(
    refused: Callable[..., UserError], tmp_path: Path, version: str, folders: tuple[str, ...]
) -> None:
    for name in folders:
        (tmp_path / "binaries" / name).mkdir(parents=True)
    error = refused(described(version))
    assert error.message.startswith("the FMU has no binary for this platform (")
    assert error.value == (" ".join(sorted(folders)) or "none")
