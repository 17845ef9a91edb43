"""A program file as bytes: UTF-8 with or without a mark, Latin-1 of old editors, neither."""

from pathlib import Path

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import parse_program, read_program, read_text

XYZ = ("X", "Y", "Z")
TEXT = "G0 X1 ; Höhe\nX2\n"


def file(folder: Path, data: bytes) -> Path:
    path = folder / "part.nc"
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1"])
def test_each_kind_of_text_is_read_as_the_same_program(tmp_path: Path, encoding: str) -> None:
    path = file(tmp_path, TEXT.encode(encoding))
    assert read_text(path) == TEXT
    read, meant = read_program(path, XYZ), parse_program(TEXT, file=path, axes=XYZ)
    assert read == meant
    assert (read.blocks[0].block.column, read.file) == (1, str(path))


@pytest.mark.parametrize(
    ("data", "line"),
    [
        (TEXT.encode("utf-16"), 1),
        ("G0\nX1 ; Höhe\n".encode("latin-1") + b"X2\0\n", 3),
        ("; Höhe\n\n\n".encode("latin-1") + b"\0\0\n\0", 4),
        ("; Höhe\0".encode("latin-1"), 1),
    ],
)
def test_a_file_of_another_kind_is_refused_with_the_line_of_its_first_zero(
    tmp_path: Path, data: bytes, line: int
) -> None:
    path = file(tmp_path, data)
    with pytest.raises(UserError) as caught:
        read_text(path)
    error = caught.value
    assert (error.file, error.line, error.column) == (str(path), line, None)
    assert (error.value, error.allowed) == ("byte 0", "UTF-8 or Latin-1")
    assert error.hint == "save it as UTF-8"


def test_a_file_that_is_not_there_names_what_is_near(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file(tmp_path, b"G0")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UserError) as caught:
        read_text("parts.nc")
    assert caught.value.message == "NC program cannot be read"
    assert caught.value.file == "parts.nc"
    assert caught.value.hint == "there is no such file; near it: part.nc"
    with pytest.raises(UserError) as caught:
        read_text(tmp_path)
    assert caught.value.hint == "Is a directory"


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_ends_of_lines_of_every_system_give_the_same_blocks(tmp_path: Path, end: str) -> None:
    path = file(tmp_path, f"G0 X1{end}{end}X2{end}".encode())
    program = read_program(path, XYZ)
    assert [(part.block.line, part.block.text) for part in program.blocks] == [
        (1, "G0 X1"),
        (3, "X2"),
    ]
