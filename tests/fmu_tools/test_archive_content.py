"""Files that are no FMU, model descriptions that attack their parser, and what is unpacked."""

import os
import stat
import subprocess
import sys
import zipfile
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path

import pytest

from axisrig.kernel.cosim.fmi import archive
from axisrig.kernel.cosim.fmi.archive import inspect, unpack
from axisrig.kernel.cosim.fmi.session import session_folder
from axisrig.kernel.errors import UserError

ROOT = Path(__file__).parents[2]
DESCRIPTION = b'<?xml version="1.0" encoding="UTF-8"?>\n<fmiModelDescription fmiVersion="3.0"/>\n'

Pack = Callable[..., Path]
Refused = Callable[[Path], str]

# ---- Files that are no FMU


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "the file is empty"),
        (b"hello", "this is no FMU"),
        (bytes(range(256)) * 400, "this is no FMU"),
        (b"PK\5\6" + bytes(18), "an empty archive"),
        (b"PK\5\6", "this is no FMU"),
        (b"PK\3\4" + b"\xff" * 300 + b"PK\5\6" + b"\1" * 18, "damaged"),
    ],
    ids=["empty", "text", "bytes", "empty zip", "cut end", "noise"],
)
def test_a_file_that_is_no_archive(
    tmp_path: Path, refused: Refused, content: bytes, reason: str
) -> None:
    path = tmp_path / "garbage.fmu"
    path.write_bytes(content)
    assert reason in refused(path)


@pytest.mark.parametrize("step", [1, 37])
def test_a_file_cut_or_damaged_anywhere_is_refused_or_whole(pack: Pack, step: int) -> None:
    path = pack(("binaries/x86_64-linux/a.so", bytes(range(256)) * 4))
    whole = path.read_bytes()
    damaged = [whole[:cut] for cut in range(1, len(whole), step)]
    for place in range(0, len(whole), step):
        damaged.append(whole[:place] + bytes([whole[place] ^ 0x55]) + whole[place + 1 :])
    for number, content in enumerate(damaged[:: 1 if step > 1 else 7]):
        path.unlink()
        path.write_bytes(content)
        try:
            found = inspect(path)
        except UserError:
            continue
        assert {entry.size for entry in found.entries} == {len(DESCRIPTION), 1024}, number


def test_a_missing_file_and_a_folder(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="FMU not found"):
        unpack(tmp_path / "none.fmu")
    with pytest.raises(UserError, match="this is a folder"):
        unpack(tmp_path)


def test_the_folder_was_packed_instead_of_its_content(pack: Pack, refused: Refused) -> None:
    path = pack(("Model/modelDescription.xml", DESCRIPTION), description=None)
    message = refused(path)
    assert "Model/modelDescription.xml" in message
    assert "pack the content of the folder" in message


# ---- The model description


LAUGHS = b"""<?xml version="1.0"?>
<!DOCTYPE lolz [
 <!ENTITY a "aaaaaaaaaa">
 <!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">
]>
<fmiModelDescription fmiVersion="3.0" modelName="&b;"/>
"""
FILE_READER = b"""<!DOCTYPE x SYSTEM "file:///etc/passwd">
<fmiModelDescription fmiVersion="3.0"/>
"""


@pytest.mark.parametrize("text", [LAUGHS, FILE_READER, LAUGHS.decode().encode("utf-16")])
def test_a_description_with_a_document_type(pack: Pack, refused: Refused, text: bytes) -> None:
    message = refused(pack(description=text))
    assert "modelDescription.xml, line " in message
    assert "declares a document type" in message


def test_the_build_description_is_judged_too(pack: Pack, refused: Refused) -> None:
    assert "declares a document type" in refused(pack(("sources/buildDescription.xml", LAUGHS)))


def test_a_description_nested_without_end(pack: Pack, refused: Refused) -> None:
    text = b"<a>" * 300 + b"</a>" * 300
    assert "is nested too deep" in refused(pack(description=text))


@pytest.mark.long
def test_a_huge_description(pack: Pack, refused: Refused, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archive, "XML_BYTES_MAX", 1 << 20)
    text = b"<a>" + os.urandom(1 << 20).hex().encode() + b"</a>"
    assert "'modelDescription.xml' has 2 MiB" in refused(pack(description=text))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (b"", "line 1, column 1: no element found"),
        (b"<a>\n<b></a>", "line 2, column 6: mismatched tag"),
        (b"<a b='\xff'/>", "line 1, column 7: not well-formed"),
        (b"<?xml version='1.0' encoding='martian'?><a/>", "unknown encoding: martian"),
    ],
)
def test_a_description_that_is_no_xml(
    pack: Pack, refused: Refused, text: bytes, reason: str
) -> None:
    message = refused(pack(description=text))
    assert "modelDescription.xml" in message
    assert reason in message


# ---- What is accepted


@pytest.mark.parametrize(
    ("mode", "kept"),
    [(0o644, 0o600), (0o755, 0o700), (0o100, 0o700), (0o010, 0o700), (0o001, 0o700), (0, 0o600)],
)
@pytest.mark.skipif(os.name != "posix", reason="files have no modes")
def test_what_anybody_may_run_its_owner_may_run(pack: Pack, mode: int, kept: int) -> None:
    entry = zipfile.ZipInfo("binaries/tool")
    entry.external_attr = (stat.S_IFREG | mode) << 16
    folder = unpack(pack((entry, b"tool"), ("resources/data", f"{mode}".encode())))
    assert stat.S_IMODE((folder / "binaries" / "tool").stat().st_mode) == kept


def test_unpacked_files_are_private_and_whole(pack: Pack) -> None:
    content = bytes(range(256)) * 5000
    tool = zipfile.ZipInfo("binaries/tool")
    tool.external_attr = (stat.S_IFREG | 0o755) << 16
    path = pack((tool, content), ("resources/a/b.txt", b"text"))
    folder = unpack(path)
    assert (folder / "binaries" / "tool").read_bytes() == content
    assert (folder / "resources" / "a" / "b.txt").read_bytes() == b"text"
    assert (folder / "modelDescription.xml").read_bytes() == DESCRIPTION
    if os.name == "posix":
        for place in (session_folder(), folder, *folder.rglob("*")):
            assert place.stat().st_mode & 0o077 == 0, place
        assert os.access(folder / "binaries" / "tool", os.X_OK)
        assert not os.access(folder / "modelDescription.xml", os.X_OK)


def test_the_same_content_is_unpacked_once_and_other_content_again(
    pack: Pack, tmp_path: Path
) -> None:
    path = pack(("resources/a", b"one"))
    first = unpack(path)
    copy = tmp_path / "copy.fmu"
    copy.write_bytes(path.read_bytes())
    assert unpack(path) == unpack(copy) == first
    path.unlink()
    assert unpack(pack(("resources/a", b"two"))) != first


@pytest.mark.long
def test_what_was_unpacked_goes_with_the_process(pack: Pack) -> None:
    path = pack(("resources/a", b"one"))
    script = (
        "import os, sys; from pathlib import Path;"
        "from axisrig.kernel.cosim.fmi.archive import unpack;"
        "folder = unpack(Path(sys.argv[1])); print(folder);"
        "child = os.fork(); child or sys.exit(0); os.waitpid(child, 0);"
        "print((folder / 'resources' / 'a').is_file())"
    )
    if not hasattr(os, "fork"):
        pytest.skip("no fork on this system")
    printed = subprocess.run(
        [sys.executable, "-c", script, str(path)],
        capture_output=True,
        text=True,
        check=True,
        cwd=ROOT,
    ).stdout.split()
    # The child that ends first leaves the folder alone; the process that made it takes it away
    assert printed[1:] == ["True"]
    assert not Path(printed[0]).exists()
    assert not Path(printed[0]).parent.exists()


@pytest.mark.parametrize(("inside", "is_refused"), [(-1, False), (0, False), (1, True)])
def test_a_description_may_be_as_deep_as_the_limit_and_no_deeper(
    pack: Pack, inside: int, is_refused: bool
) -> None:
    """Elements beside each other are not deeper: only what is open counts."""
    depth = archive.XML_DEPTH_MAX + inside
    path = pack(description=b"<a>" + b"<a/>" * 500 + b"<a>" * (depth - 1) + b"</a>" * depth)
    with pytest.raises(UserError) if is_refused else nullcontext() as found:
        inspect(path)
    assert found is None or "is nested too deep" in str(found.value)
