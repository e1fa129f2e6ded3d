"""A journal states whose it is and nothing else, and its key opens it or nothing does."""

import os
from dataclasses import replace
from pathlib import Path
from uuid import UUID

import pytest

from app.storage.journal.header import (
    HEADER_BYTES,
    IDENTITY,
    JournalHeader,
    JournalRefusedError,
    destroy_key,
    find_segments,
    read_header,
    segment_path,
)
from tests.safety.journal_material import ID, KEY, NAMES, OTHER_ID, read_all, record_some

OTHER_KEY = bytes(32)
HEADER = JournalHeader(ID, segment=3, opened_wall_ns=1_700_000_000_000_000_000, opened_ns=5)


def test_a_header_is_read_back() -> None:
    sealed, key = HEADER.with_new_key(KEY)
    for header in (HEADER, sealed):
        assert len(header.packed()) == HEADER_BYTES
        assert JournalHeader.parsed(header.packed(), "a") == header
    assert sealed.key(KEY, "a") == key


def test_every_journal_has_a_key_of_its_own(tmp_path: Path) -> None:
    keys = {HEADER.with_new_key(KEY)[1] for _ in range(50)}
    assert len(keys) == 50
    first, second = record_some(tmp_path, KEY, rounds=1), record_some(tmp_path, KEY, rounds=1)
    headers = [read_header(summary.path) for summary in (first, second)]
    assert [header.segment for header in headers] == [1, 2]
    assert headers[0].key(KEY, "a") != headers[1].key(KEY, "a")


def test_another_librarys_key_is_refused() -> None:
    sealed, _ = HEADER.with_new_key(KEY)
    with pytest.raises(JournalRefusedError, match="the key of this recording is damaged or belongs to another library"):
        sealed.key(OTHER_KEY, "a")


def test_a_wrapped_key_put_into_another_header_does_not_open() -> None:
    sealed, _ = HEADER.with_new_key(KEY)
    with pytest.raises(JournalRefusedError, match="the key of this recording is damaged or belongs to another library"):
        replace(sealed, recording_id=OTHER_ID).key(KEY, "a")


def test_without_logging_in_a_sealed_journal_stays_closed(tmp_path: Path) -> None:
    path = record_some(tmp_path, KEY, rounds=1).path
    with pytest.raises(JournalRefusedError, match="Log in"):
        read_all(path, None)


def test_an_open_journal_is_not_taken_for_one_of_a_sealed_library(tmp_path: Path) -> None:
    path = record_some(tmp_path, None, rounds=1).path
    with pytest.raises(
        JournalRefusedError, match="this recording is not encrypted, so it does not belong to this library"
    ):
        read_all(path, KEY)


@pytest.mark.parametrize("content", [b"", b"\x89GWJ\r\n\x1a\n", b"\x89GWJ\n\x1a\n" + bytes(200), bytes(200)])
def test_what_is_no_journal_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.journal").write_bytes(content)
    with pytest.raises(JournalRefusedError, match="this is not a Gaitwright recording, or its beginning is missing"):
        read_header(tmp_path / "a.journal")


def test_a_later_format_is_reported() -> None:
    content = bytearray(HEADER.packed())
    content[8] = 2
    with pytest.raises(JournalRefusedError, match="format 2"):
        JournalHeader.parsed(bytes(content), "a")


def test_the_rows_copy_of_the_key_opens_a_journal_whose_own_is_damaged(tmp_path: Path) -> None:
    path = record_some(tmp_path, KEY).path
    wrapped_key, whole = read_header(path).wrapped_key, read_all(path, KEY)[0]
    content = bytearray(path.read_bytes())
    content[IDENTITY.size + 20] ^= 1
    path.write_bytes(content)
    with pytest.raises(JournalRefusedError, match="damaged"):
        read_all(path, KEY)
    assert read_all(path, KEY, wrapped_key)[0] == whole


def test_a_destroyed_key_leaves_nothing_to_read(tmp_path: Path) -> None:
    path = record_some(tmp_path, KEY).path
    wrapped_key, size = read_header(path).wrapped_key, path.stat().st_size
    destroy_key(path)
    assert wrapped_key[12:] not in path.read_bytes()
    assert path.stat().st_size == size
    with pytest.raises(JournalRefusedError, match="this recording was permanently destroyed"):
        read_all(path, KEY)
    open_one = record_some(tmp_path, None, recording_id=OTHER_ID).path
    with pytest.raises(JournalRefusedError, match="no key"):
        destroy_key(open_one)


def test_names_show_in_an_open_journal_only(tmp_path: Path) -> None:
    sealed, bare = record_some(tmp_path, KEY), record_some(tmp_path, None, recording_id=OTHER_ID)
    for name in (*NAMES, "walker", "port-1", "round 0"):
        assert name.encode() not in sealed.path.read_bytes()
        assert name.encode() in bare.path.read_bytes()


@pytest.mark.skipif(os.name == "nt", reason="Windows keeps other users out by the folder")
def test_nobody_else_may_read_a_journal(tmp_path: Path) -> None:
    path = record_some(tmp_path / "library", KEY, rounds=1).path
    assert path.stat().st_mode & 0o077 == 0
    assert path.parent.stat().st_mode & 0o077 == 0


def test_segments_are_found_in_order_and_other_files_are_left_alone(tmp_path: Path) -> None:
    for segment in (10, 2, 1):
        segment_path(tmp_path, ID, segment).touch()
    segment_path(tmp_path, OTHER_ID, 1).touch()
    for name in ("notes.journal", f"{ID}.journal", f"{ID}.one.journal", "library.db"):
        (tmp_path / name).touch()
    found = find_segments(tmp_path)
    assert set(found) == {ID, OTHER_ID}
    assert list(found[ID].items()) == [(k, segment_path(tmp_path, ID, k)) for k in (1, 2, 10)]
    assert find_segments(tmp_path / "nowhere") == {}
    assert UUID(bytes=ID.bytes).version == 7
