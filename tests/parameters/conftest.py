"""Parameter lists written to a file and read back."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import Kind, ParameterSet, read_sections

Listed = Callable[..., ParameterSet]
Sections = Callable[..., list[ParameterSet]]
Refused = Callable[..., UserError]


@pytest.fixture
def sections(tmp_path: Path) -> Sections:
    """Read a text as a list that may hold several axes."""

    def read(text: str, kind: Kind = "axis") -> list[ParameterSet]:
        path = tmp_path / "list.lst"
        path.write_text(text, encoding="utf-8")
        return read_sections(path, kind)

    return read


@pytest.fixture
def listed(sections: Sections) -> Listed:
    """Read a text as a list of one axis or of the channel."""

    def read(text: str, kind: Kind = "axis") -> ParameterSet:
        (only,) = sections(text, kind)
        return only

    return read


@pytest.fixture
def refused(sections: Sections) -> Refused:
    """Return the error with which a list is refused."""

    def read(text: str, kind: Kind = "axis") -> UserError:
        with pytest.raises(UserError) as caught:
            sections(text, kind)
        return caught.value

    return read
