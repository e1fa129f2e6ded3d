"""A journal is read in bounded memory, over damage and to the end, and the reader states what it met."""

import tracemalloc
from dataclasses import replace
from pathlib import Path

import pytest
from crc32c import crc32c

from app.storage.journal.header import HEADER_BYTES, JournalHeader
from app.storage.journal.reader import Damage, JournalReader
from app.storage.journal.records import CHECKSUM, MAX_PAYLOAD, RECORD_HEADER, Record, RecordKind, Seal
from app.storage.journal.writer import JournalWriter
from tests.safety.journal_material import (
    ID,
    KEY,
    LAYOUT,
    NAMES,
    NO_ROOM_ASKED,
    OTHER_ID,
    WALKER,
    block,
    read_all,
    record_some,
)
from tests.safety.journal_tails import Original

RECORD = Record(7, RecordKind.BYTES, 1_000, b"some bytes")
HEADER, OWN_KEY = JournalHeader(ID, 1, 0, 0).with_new_key(KEY)


def test_a_record_opens_under_its_own_key_number_and_journal_only() -> None:
    seal = Seal(HEADER, OWN_KEY)
    content = seal.closed(RECORD)
    assert RECORD.payload not in content
    assert seal.opened(memoryview(content), None) == (RECORD, len(content))
    assert Seal(HEADER, bytes(32)).opened(memoryview(content), None) is None
    stranger, _ = JournalHeader(OTHER_ID, 1, 0, 0).with_new_key(KEY)
    assert Seal(stranger, OWN_KEY).opened(memoryview(content), None) is None


@pytest.mark.parametrize("key", [OWN_KEY, None], ids=["sealed", "open"])
def test_a_record_of_another_segment_is_no_record_even_where_nothing_is_sealed(key: bytes | None) -> None:
    content = memoryview(Seal(HEADER, key).closed(RECORD))
    assert Seal(JournalHeader(ID, 2, 0, 0, HEADER.wrapped_key), key).opened(content, None) is None


def test_a_record_does_not_follow_one_that_is_younger() -> None:
    seal = Seal(HEADER, OWN_KEY)
    content = memoryview(seal.closed(RECORD))
    for after in (RECORD, RECORD._replace(number=8), RECORD._replace(number=6, time_ns=1_001)):
        assert seal.opened(content, after) is None
    assert seal.opened(content, RECORD._replace(number=6)) is not None


def test_a_forged_record_with_a_right_checksum_fails_its_tag() -> None:
    # who has no key can compute a checksum, but not a tag
    forged = Seal(HEADER, None).closed(RECORD._replace(payload=bytes(40)))
    assert Seal(HEADER, None).opened(memoryview(forged), None) is not None
    assert Seal(HEADER, OWN_KEY).opened(memoryview(forged), None) is None


def test_who_has_no_key_can_neither_change_a_records_header_nor_move_it_to_another_recording() -> None:
    content = bytearray(Seal(HEADER, OWN_KEY).closed(RECORD))
    stranger = replace(HEADER, recording_id=OTHER_ID)
    for place in (4, 16, 17):  # number, kind, time
        changed = content.copy()
        changed[place] ^= 1
        assert Seal(HEADER, None).opened(with_checksum(changed, HEADER), None) is not None
        assert Seal(HEADER, OWN_KEY).opened(with_checksum(changed, HEADER), None) is None
    assert Seal(stranger, None).opened(with_checksum(content, stranger), None) is not None
    assert Seal(stranger, OWN_KEY).opened(with_checksum(content, stranger), None) is None


def with_checksum(content: bytearray, header: JournalHeader) -> memoryview:
    body = bytes(content[: -CHECKSUM.size])
    return memoryview(body + CHECKSUM.pack(crc32c(body, crc32c(header.identity))))


@pytest.mark.parametrize("key", [KEY, None], ids=["sealed", "open"])
def test_what_follows_damage_is_found_and_the_damage_is_reported(tmp_path: Path, key: bytes | None) -> None:
    original = Original.recorded(tmp_path, key)
    begin, end = original.ends[10], original.ends[13]
    content = bytearray(original.content)
    content[begin + 3 : end - 3] = bytes(end - begin - 6)
    (tmp_path / "damaged").write_bytes(content)
    records, damages, report = read_all(tmp_path / "damaged", key)
    assert records == [*original.records[:11], *original.records[14:]]
    assert damages == [Damage(begin, end - begin)]
    assert (report.damaged_stretches, report.damaged_bytes, report.missing_records) == (1, end - begin, 3)
    assert report.footer is not None
    assert not report.is_whole


def test_a_torn_end_is_reported_and_no_footer_is_claimed(tmp_path: Path) -> None:
    original = Original.recorded(tmp_path, KEY)
    (tmp_path / "torn").write_bytes(original.content[: original.ends[-2] + 9])
    records, damages, report = read_all(tmp_path / "torn", KEY)
    assert records == list(original.records[:-1])
    assert damages == [Damage(original.ends[-2], 9)]
    assert report.footer is None


def test_a_record_taken_out_cleanly_is_missed(tmp_path: Path) -> None:
    original = Original.recorded(tmp_path, KEY)
    (tmp_path / "cut").write_bytes(original.content[: original.ends[4]] + original.content[original.ends[5] :])
    _, damages, report = read_all(tmp_path / "cut", KEY)
    assert damages == []
    assert report.missing_records == 1
    assert not report.is_whole


def test_nothing_counts_that_is_behind_the_footer(tmp_path: Path) -> None:
    path = record_some(tmp_path, KEY, rounds=1).path
    header = JournalReader(path, KEY).header
    key = header.key(KEY, "a")
    before = path.read_bytes()
    path.write_bytes(before + Seal(header, key).closed(Record(999, RecordKind.MARK, 1 << 62, b'"added"')))
    records, damages, report = read_all(path, KEY)
    assert records[-1].kind is RecordKind.FOOTER
    assert damages == [Damage(len(before), path.stat().st_size - len(before))]
    assert not report.is_whole


def test_a_journal_of_which_only_the_header_is_there_is_empty(tmp_path: Path) -> None:
    path = record_some(tmp_path, KEY).path
    path.write_bytes(path.read_bytes()[:HEADER_BYTES])
    records, damages, report = read_all(path, KEY)
    assert (records, damages, report.footer) == ([], [], None)


def test_a_length_that_was_scrambled_hides_no_later_record(tmp_path: Path) -> None:
    original = Original.recorded(tmp_path, None)
    content = bytearray(original.content)
    magic, number, _, kind, time_ns = RECORD_HEADER.unpack_from(content, original.ends[10])
    RECORD_HEADER.pack_into(content, original.ends[10], magic, number, MAX_PAYLOAD, kind, time_ns)
    (tmp_path / "damaged").write_bytes(content)
    records, _, report = read_all(tmp_path / "damaged", None)
    assert records == [*original.records[:11], *original.records[12:]]
    assert report.missing_records == 1


def test_a_long_journal_is_read_in_little_memory(tmp_path: Path) -> None:
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        source = journal.source(WALKER, LAYOUT)
        for number in range(300):
            journal.samples(source, 0, block(NAMES[0], number, 2300), waits=True)
    assert journal.path.stat().st_size > 35_000_000
    tracemalloc.start()
    reader = JournalReader(journal.path, KEY)
    count = sum(isinstance(record, Record) for record in reader.records())
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 12_000_000
    assert count == 302
    assert reader.report.sha256 == journal.stop().sha256


def test_a_file_that_is_all_magic_words_ends(tmp_path: Path) -> None:
    path = record_some(tmp_path, None, rounds=1).path
    whole = path.read_bytes()
    path.write_bytes(whole[:HEADER_BYTES] + b"\xa7GWr" * 50_000)
    records, damages, _ = read_all(path, None)
    assert records == []
    assert damages == [Damage(HEADER_BYTES, 200_000)]
