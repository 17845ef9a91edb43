"""FMU files written by hand, good and bad."""

import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from kernel.cosim.archive import inspect, session_folder, unpack
from kernel.errors import UserError

Entry = tuple[str | zipfile.ZipInfo, bytes]
Pack = Callable[..., Path]

DESCRIPTION = b'<?xml version="1.0" encoding="UTF-8"?>\n<fmiModelDescription fmiVersion="3.0"/>\n'


@pytest.fixture
def pack(tmp_path: Path) -> Pack:
    """Write an archive of these entries behind a modelDescription.xml; gives its path."""

    def write(*entries: Entry, description: bytes | None = DESCRIPTION) -> Path:
        path = tmp_path / "attack.fmu"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # two entries of one name are what some tests want
            if description is not None:
                packed.writestr("modelDescription.xml", description)
            for name, content in entries:
                packed.writestr(name, content)
        return path

    return write


@pytest.fixture
def refused() -> Callable[[Path], str]:
    """Gives the message with which an archive is refused; nothing may have been written."""

    def check(path: Path) -> str:
        before = sorted(session_folder().iterdir())
        with pytest.raises(UserError) as looked_at:
            inspect(path)
        with pytest.raises(UserError) as unpacked:
            unpack(path)
        assert str(looked_at.value) == str(unpacked.value)
        assert sorted(session_folder().iterdir()) == before
        assert str(path) in str(unpacked.value)
        return str(unpacked.value)

    return check
