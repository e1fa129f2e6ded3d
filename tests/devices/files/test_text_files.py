"""Tests that texts are read whatever program wrote them, and that what is no text stays what it is."""

import codecs
from pathlib import Path

import numpy as np
import pytest

from devices.files.refusal import FileRefusedError
from devices.files.tables import number_in, read_csv
from devices.files.text_files import as_utf8, encoding_of, open_text

TEXT = "Zeit (s);Gyroskop x (°/s)\n0,01;1,5\n0,02;-2,5\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"])
def test_every_encoding_gives_the_same_numbers(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(TEXT.encode(encoding))
    table = read_csv(path, "a.csv", {"Zeit (s)", "Gyroskop x (°/s)"}, delimiters=",;")
    assert table.numbers["Zeit (s)"].tolist() == [0.01, 0.02]
    assert table.numbers["Gyroskop x (°/s)"].tolist() == [1.5, -2.5]
    assert as_utf8(path.read_bytes()).decode("utf-8-sig").lstrip("\ufeff") == TEXT


def test_a_letter_cut_at_the_end_of_a_head_makes_no_other_encoding() -> None:
    head = ("x" * 10 + "°").encode()
    assert encoding_of(head[:-1]) == "utf-8"
    assert encoding_of("°".encode("cp1252") + b"abc") == "cp1252"


@pytest.mark.parametrize(
    "content",
    [b"\xfa\xff\x36\x20" + bytes(range(256)), b"\x89HDF\r\n\x1a\n\0\0\0\0", b"PK\x03\x04\xff\x01", b"\0\0\0\1"],
)
def test_what_is_no_text_is_left_alone(content: bytes) -> None:
    assert as_utf8(content) == content


def test_a_session_folders_table_is_utf_8_with_points_and_whole_rows(tmp_path: Path) -> None:
    path = tmp_path / "left_thigh.csv"
    path.write_bytes(TEXT.encode("utf-16"))
    with pytest.raises(FileRefusedError):
        read_csv(path, "left_thigh.csv", {"Zeit (s)"}, is_ours=True)
    path.write_text("time_s,a\n0,1\n1\n")
    with pytest.raises(FileRefusedError, match=r"left_thigh\.csv, line 3: the line ends after 1 of 2 columns"):
        read_csv(path, "left_thigh.csv", {"time_s", "a"}, is_ours=True)


def test_incomplete_rows_at_the_end_are_left_out_and_others_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t,a,b\n0,1,2\n1,3,4\n2\n3,5\n")
    table = read_csv(path, "a.csv", {"t", "a", "b"})
    assert table.numbers["b"].tolist() == [2.0, 4.0]
    assert [(one.key, one.numbers) for one in table.findings] == [("rows_cut_short", {"count": 2})]
    for text, line in (("t,a,b\n0,1\n1,3,4\n", 2), ("t,a,b\n0,1,2\n1,3", 3), ("t,a,b\n0,1,2\n" + "1,2\n" * 9, 3)):
        path.write_text(text)
        with pytest.raises(FileRefusedError, match=f"a.csv, line {line}: the line ends after"):
            read_csv(path, "a.csv", {"t", "a", "b"})


def test_a_header_that_is_written_again_and_empty_rows_at_the_end_are_no_rows(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t,a\n0,1\nt,a\n1,NA\n2,x\n")
    with pytest.raises(FileRefusedError, match='line 5: "x" in column a is not a number'):
        read_csv(path, "a.csv", {"t", "a"})
    path.write_text("t,a\n0,1\nt,a\n1,NA\n2,3\n,\n,\n")
    table = read_csv(path, "a.csv", {"t", "a"})
    assert table.numbers["t"].tolist() == [0.0, 1.0, 2.0]
    np.testing.assert_array_equal(table.numbers["a"], [1.0, np.nan, 3.0])
    assert table.place(1) == "line 4"


@pytest.mark.parametrize("cell", ["NA", "n/a", "NULL", "null", "nan", "NaN", "None", "-", "--", " NA", ""])
def test_words_for_nothing_are_missing_values(tmp_path: Path, cell: str) -> None:
    (tmp_path / "a.csv").write_text(f"t,a\n0,{cell}\n1,2\n")
    assert np.isnan(read_csv(tmp_path / "a.csv", "a.csv", {"t", "a"}).numbers["a"][0])
    assert np.isnan(number_in(cell))


def test_a_number_has_a_point_or_a_comma() -> None:
    assert [number_in(cell) for cell in ("1.5", "1,5", " -2,5e3 ", "7")] == [1.5, 1.5, -2500.0, 7.0]
    for cell in ("1,2,3", "1.000,5", "x"):
        with pytest.raises(ValueError, match="could not convert"):
            number_in(cell)


def test_opened_text_has_its_mark_at_most_once(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(codecs.BOM_UTF16_LE + "a\n".encode("utf-16-le"))
    with open_text(tmp_path / "a.csv") as file:
        assert file.read() == b"a\n"
