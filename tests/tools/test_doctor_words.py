"""Lines of `axisrig doctor` on compilers and models, whatever this computer has."""

from importlib import metadata
from typing import Any

import pytest

from axisrig.bench.tools.listings import doctor
from axisrig.bench.tools.listings.doctor import LACK, _compilers, _modelica

pytestmark = pytest.mark.interpreted  # replaces what the computer has


def without(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    def version(name: str) -> str:
        if name in names:
            raise metadata.PackageNotFoundError(name)
        return "1.2"

    monkeypatch.setattr(doctor.metadata, "version", version)


@pytest.mark.parametrize(
    ("lacks", "is_needed", "line"),
    [
        (False, True, "ok    rumoca 1.2"),
        (False, False, "ok    rumoca 1.2"),
        (True, True, f"{LACK.strip()} rumoca, for models: pip install 'axisrig[models]'"),
        (True, False, "info  rumoca, for models: pip install 'axisrig[models]'"),
    ],
)
def test_models_are_lacking_where_they_are_needed(
    monkeypatch: pytest.MonkeyPatch, lacks: bool, is_needed: bool, line: str
) -> None:
    without(monkeypatch, *(["rumoca"] if lacks else []))
    assert _modelica(is_needed=is_needed) == line


@pytest.mark.parametrize(
    ("cc", "zig", "omc", "lines"),
    [
        ("/cc", True, None,
         ["ok    C compiler /cc", "ok    C compiler ziglang 1.2, also for other platforms"]),
        ("/cc", False, None,
         ["ok    C compiler /cc",
          "info  FMUs for other platforms need ziglang: pip install 'axisrig[cc]'"]),
        (None, True, "/omc",
         ["ok    C compiler ziglang 1.2, also for other platforms",
          "info  OpenModelica /omc (fmu build --compiler omc)"]),
        (None, False, None, ["LACK C compiler: install a system cc, or pip install 'axisrig[cc]'"]),
    ],
)  # fmt: skip
@pytest.mark.parametrize("is_needed", [True, False])
def test_which_compilers_there_are(
    monkeypatch: pytest.MonkeyPatch, cc: str | None, zig: bool, omc: str | None,
    lines: list[str], is_needed: bool,
) -> None:  # fmt: skip
    without(monkeypatch)
    monkeypatch.setattr(doctor.shutil, "which", {"cc": cc, "omc": omc}.get)
    found: Any = object() if zig else None
    monkeypatch.setattr(doctor, "find_spec", lambda _name: found)
    word = LACK.strip() if is_needed else "info "
    assert _compilers(is_needed=is_needed) == [line.replace("LACK", word) for line in lines]
