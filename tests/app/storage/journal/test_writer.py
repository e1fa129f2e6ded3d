"""What is put in is on the disk within moments, whatever the disk does, and what is not is counted and stated."""

import errno
import itertools
import os
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.storage.journal.disk import REPORTED, JournalFile, Room, Trouble
from app.storage.journal.header import JournalRefusedError, find_segments
from app.storage.journal.payloads import Footer, SourceEntry
from app.storage.journal.records import MAX_PAYLOAD, RecordKind
from app.storage.journal.writer import SLOW_S, SYNC_EVERY_S, WRITE_EVERY_S, JournalWriter, State
from devices.source import SourceInfo
from tests.safety.journal_material import (
    ID,
    KEY,
    LAYOUT,
    LINES,
    NAMES,
    NO_ROOM_ASKED,
    WALKER,
    block,
    line,
    read_all,
    record_some,
)
from tests.waiting import wait_for

PATIENCE_S = 20.0


class Disk:
    """Is in the way of every journal's file: holds it up, or fails it."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.error: int | None = None
        self.answers = threading.Event()
        self.answers.set()
        self.syncs: list[float] = []
        append, sync = JournalFile.append, JournalFile.sync

        def slow_append(file: JournalFile, data: bytes | bytearray) -> None:
            assert self.answers.wait(PATIENCE_S)
            if self.error is not None:
                raise OSError(self.error, os.strerror(self.error))
            append(file, data)

        def noted_sync(file: JournalFile) -> None:
            sync(file)
            self.syncs.append(time.monotonic())

        monkeypatch.setattr(JournalFile, "append", slow_append)
        monkeypatch.setattr(JournalFile, "sync", noted_sync)


@pytest.fixture
def disk(monkeypatch: pytest.MonkeyPatch) -> Iterator[Disk]:
    disk = Disk(monkeypatch)
    yield disk
    disk.answers.set()


@pytest.mark.parametrize("key", [KEY, None], ids=["sealed", "open"])
def test_what_is_put_in_comes_out_in_order_and_whole(tmp_path: Path, key: bytes | None) -> None:
    summary = record_some(tmp_path, key, rounds=20)
    records, damages, report = read_all(summary.path, key)
    kinds = [record.kind for record in records]
    assert kinds[:3] == [RecordKind.SOURCE, RecordKind.SOURCE, RecordKind.SENT]
    assert (kinds.count(RecordKind.SAMPLES), kinds.count(RecordKind.BYTES), kinds.count(RecordKind.MARK)) == (
        120,
        20,
        2,
    )
    assert kinds[-1] is RecordKind.FOOTER
    assert [record.number for record in records] == list(range(1, len(records) + 1))
    assert [r.payload[2:] for r in records if r.kind is RecordKind.BYTES] == [line(k) for k in range(20)]
    assert SourceEntry.parsed(records[0].payload) == SourceEntry(0, WALKER, LAYOUT)
    assert SourceEntry.parsed(records[1].payload) == SourceEntry(1, LINES)
    assert report.is_whole
    assert damages == []
    assert report.footer == Footer("stopped", 0, 0)
    assert (summary.state, summary.sha256, summary.bytes) == (
        State.CLOSED,
        report.sha256,
        summary.path.stat().st_size,
    )
    assert summary.records == len(records) - 1  # the footer is no record of anything


@pytest.mark.endurance
def test_what_was_put_in_can_be_read_while_the_recording_goes_on(tmp_path: Path, disk: Disk) -> None:
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        source = journal.source(LINES)
        assert journal.received(source, line(0))
        wait_for(lambda: journal.status.records == 2)
        records, damages, report = read_all(journal.path, KEY)
        assert [record.kind for record in records] == [RecordKind.SOURCE, RecordKind.BYTES]
        assert damages == []
        assert report.footer is None
        wait_for(lambda: len(disk.syncs) >= 3)
        assert disk.syncs[2] - disk.syncs[1] < 5.0  # half a second on a machine that is not busy
        wait_for(lambda: journal.status.stuck_s == 0.0)


def test_resuming_opens_the_next_segment(tmp_path: Path) -> None:
    first = record_some(tmp_path, KEY, rounds=1)
    before = first.path.read_bytes()
    record_some(tmp_path, KEY, rounds=1)
    assert list(find_segments(tmp_path)[ID]) == [1, 2]
    assert first.path.read_bytes() == before


def test_a_disk_that_stalls_holds_up_nobody_and_costs_nothing(tmp_path: Path, disk: Disk) -> None:
    stated: list[Trouble] = []
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED, on_trouble=stated.append) as journal:
        source = journal.source(LINES)
        wait_for(lambda: journal.status.records == 1)
        disk.answers.clear()
        slowest_s = 0.0
        for number in range(2000):
            begin_s = time.perf_counter()
            assert journal.received(source, line(number))
            slowest_s = max(slowest_s, time.perf_counter() - begin_s)
        assert slowest_s < 1.0  # the stall itself lasts until this test ends it
        wait_for(lambda: journal.status.stuck_s > SLOW_S)
        journal.received(source, line(2000))
        assert stated == [Trouble.DISK_SLOW]
        disk.answers.set()
    records, _, report = read_all(journal.path, KEY)
    assert [r.payload[2:] for r in records if r.kind is RecordKind.BYTES] == [line(k) for k in range(2001)]
    assert report.is_whole


@pytest.mark.parametrize(("awake_s", "expected"), [(0.5, []), (20.0, [Trouble.DISK_SLOW])])
def test_a_process_that_stood_still_blames_no_disk(
    tmp_path: Path, disk: Disk, awake_s: float, expected: list[Trouble]
) -> None:
    """What counts is for how long the process ran while the disk did not answer."""
    stated: list[Trouble] = []
    clock_s = [0.0]
    with JournalWriter.create(
        tmp_path, ID, KEY, room=NO_ROOM_ASKED, on_trouble=stated.append, awake_s=lambda: clock_s[0]
    ) as journal:
        source = journal.source(LINES)
        wait_for(lambda: journal.status.records == 1)
        disk.answers.clear()
        journal.received(source, line(0))
        clock_s[0] = awake_s
        journal.received(source, line(1))
        assert stated == expected
        disk.answers.set()


def test_status_shows_up_to_when_records_are_written_and_synced(tmp_path: Path, disk: Disk) -> None:
    now_ns = 5_000_000_000
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED, now_ns=lambda: now_ns) as journal:
        source = journal.source(LINES)
        now_ns += 3_000_000_000
        journal.received(source, line(0))
        wait_for(lambda: journal.status.synced_s == 3.0)
        disk.answers.clear()
        now_ns += 4_000_000_000
        journal.received(source, line(1))
        assert (journal.status.written_s, journal.status.synced_s) == (3.0, 3.0)
        disk.answers.set()
    assert (journal.status.written_s, journal.status.synced_s) == (7.0, 7.0)


def test_it_is_written_every_20_ms_synced_every_half_second_and_its_name_at_the_beginning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    synced: list[Path] = []
    monkeypatch.setattr("app.storage.files.sync_folder", synced.append)
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED):
        assert synced == [tmp_path]
    assert (WRITE_EVERY_S, SYNC_EVERY_S) == (0.02, 0.5)


def test_ten_seconds_of_six_sensors_fit_into_the_queue(tmp_path: Path, disk: Disk) -> None:
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        walker = journal.source(WALKER, LAYOUT)
        disk.answers.clear()
        assert all(journal.samples(walker, k, block(NAMES[k], n)) for n in range(2000) for k in range(6))
        disk.answers.set()
    assert journal.stop().dropped_records == 0


def test_what_a_stalled_disk_has_no_room_for_is_dropped_counted_and_stated(tmp_path: Path, disk: Disk) -> None:
    stated: list[Trouble] = []
    with JournalWriter.create(
        tmp_path, ID, KEY, room=NO_ROOM_ASKED, on_trouble=stated.append, queue_bytes=100_000
    ) as journal:
        source, other = journal.source(LINES), journal.source(LINES)
        disk.answers.clear()
        taken = [journal.received(source, bytes(1000)) for _ in range(150)]
        dropped = taken.count(False)
        assert dropped > 40
        assert taken == [True] * (150 - dropped) + [False] * dropped
        assert stated == [Trouble.DROPPED]
        assert journal.mark("still here")
        disk.answers.set()
        wait_for(lambda: journal.status.stuck_s == 0.0)
        assert journal.received(source, b"after")
        assert journal.received(other, b"nothing dropped here")
    records, _, report = read_all(journal.path, KEY)
    reported = [SourceEntry.parsed(record.payload) for record in records if record.kind is RecordKind.SOURCE]
    assert [(entry.number, entry.dropped_records, entry.dropped_bytes) for entry in reported] == [
        (0, 0, 0),
        (1, 0, 0),
        (0, dropped, dropped * 1002),
    ]
    kinds = [record.kind for record in records]
    assert kinds[-4:] == [
        RecordKind.SOURCE,
        RecordKind.BYTES,
        RecordKind.BYTES,
        RecordKind.FOOTER,
    ]  # reported again right before it goes on
    assert report.footer == Footer("stopped", dropped, dropped * 1002)
    assert journal.stop().dropped_records == dropped


@pytest.mark.parametrize(
    ("error", "trouble"),
    [(errno.EIO, Trouble.DISK_GONE), (errno.ENODEV, Trouble.DISK_GONE), (errno.ENOSPC, Trouble.DISK_FULL)],
)
def test_a_disk_that_fails_ends_the_recording_at_its_last_batch_and_states_so(
    tmp_path: Path, disk: Disk, error: int, trouble: Trouble
) -> None:
    stated: list[tuple[Trouble, float]] = []
    journal = JournalWriter.create(
        tmp_path, ID, KEY, room=NO_ROOM_ASKED, on_trouble=lambda one: stated.append((one, time.monotonic()))
    )
    source = journal.source(LINES)
    assert journal.received(source, line(0))
    wait_for(lambda: journal.status.records == 2)
    disk.error = error
    failing_s = time.monotonic()
    journal.received(source, line(1))
    wait_for(lambda: journal.status.state is State.BROKEN)
    assert [one for one, _ in stated] == [trouble]
    assert stated[0][1] - failing_s < 1.0
    assert not journal.received(source, line(2))
    assert not journal.mark("too late")
    summary = journal.stop()
    assert (summary.state, summary.reason, summary.sha256) == (State.BROKEN, trouble, "")
    assert summary.dropped_records == 3
    records, damages, _ = read_all(journal.path, KEY)
    assert [record.kind for record in records] == [RecordKind.SOURCE, RecordKind.BYTES]
    assert damages == []


def test_a_sync_that_fails_ends_the_recording_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # after a failed sync the system forgets which pages were not written: syncing again would only seem to work
    def fail(file: JournalFile) -> None:
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(JournalFile, "sync", fail)
    journal = JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED)
    journal.source(LINES)
    wait_for(lambda: journal.status.state is State.BROKEN)
    assert Trouble.DISK_GONE in journal.status.troubles
    journal.stop()


def test_a_piece_that_a_full_disk_cut_off_is_taken_back_and_no_number_comes_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, is_full = os.write, False

    def cut_off(descriptor: int, data: memoryview) -> int:
        nonlocal is_full
        if len(data) < 10_000:
            return write(descriptor, data)
        if is_full:
            raise OSError(errno.ENOSPC, "No space left on device")
        is_full = True
        return write(descriptor, data[:20_000])

    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        source = journal.source(LINES)
        wait_for(lambda: journal.status.records == 1)
        monkeypatch.setattr(os, "write", cut_off)
        journal.received(source, bytes(60_000))
        wait_for(lambda: journal.status.state is not State.RECORDING)
    records, damages, report = read_all(journal.path, KEY)
    assert [(record.number, record.kind) for record in records] == [(1, RecordKind.SOURCE), (3, RecordKind.FOOTER)]
    assert damages == []
    assert report.missing_records == 1  # number 2 was on the disk for a moment; its nonce is spent
    assert report.footer == Footer("disk_full", 1, 60_002)
    assert journal.stop().sha256 == report.sha256


def test_a_recording_does_not_begin_without_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    free = 600 * 50_000 + 500_000_000

    class Usage:
        def __init__(self, folder: Path) -> None:
            self.free = free

    monkeypatch.setattr("shutil.disk_usage", Usage)
    JournalWriter.create(tmp_path, ID, KEY, bytes_per_s=50_000).stop()
    free -= 1
    with pytest.raises(JournalRefusedError, match=r"to record: 530 MB needed, 530 MB free\. Delete or move"):
        JournalWriter.create(tmp_path, ID, KEY, bytes_per_s=50_000)
    assert list(find_segments(tmp_path)[ID]) == [1]


@pytest.mark.endurance
def test_five_minutes_before_the_end_it_is_stated_and_before_the_disk_is_full_it_is_closed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    room, left_s, stated = Room(), 400.0, list[Trouble]()
    monkeypatch.setattr(JournalFile, "free_bytes", lambda file: room.kept_bytes + left_s * 1000)
    with JournalWriter.create(tmp_path, ID, None, bytes_per_s=1000, on_trouble=stated.append) as journal:
        source = journal.source(LINES)
        journal.received(source, line(0))
        wait_for(lambda: journal.status.left_s == 400.0)
        assert stated == []
        left_s = 299.0
        wait_for(lambda: stated == [Trouble.LITTLE_ROOM])
        left_s = 0.0
        wait_for(lambda: journal.status.state is State.CLOSED)
        assert stated == [Trouble.LITTLE_ROOM, Trouble.NO_ROOM]
        assert not journal.received(source, line(1))
    _, _, report = read_all(journal.path, None)
    assert report.is_whole
    assert report.footer is not None
    assert report.footer.reason == "no_room"


def test_a_listener_that_fails_ends_no_recording(tmp_path: Path, disk: Disk) -> None:
    def fail(trouble: Trouble) -> None:
        raise RuntimeError(trouble)

    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED, on_trouble=fail, queue_bytes=10_000) as journal:
        source = journal.source(LINES)
        disk.answers.clear()
        assert not journal.received(source, bytes(20_000))
        disk.answers.set()
        assert journal.received(source, b"goes on")
    assert read_all(journal.path, KEY)[2].is_whole


def test_what_is_too_long_for_a_record_is_kept_in_pieces(tmp_path: Path) -> None:
    data = os.urandom(2 * MAX_PAYLOAD + 5)
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        source = journal.source(LINES)
        assert journal.received(source, data)
        with pytest.raises(ValueError, match="at most"):
            journal.source(SourceInfo("lines", "1", settings={"all": "x" * MAX_PAYLOAD}))
    records, _, report = read_all(journal.path, KEY)
    assert b"".join(record.payload[2:] for record in records if record.kind is RecordKind.BYTES) == data
    assert report.is_whole


def test_an_import_waits_for_the_disk_and_loses_nothing(tmp_path: Path) -> None:
    whole = block(NAMES[0], 0, 30_000)
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED, queue_bytes=300_000) as journal:
        walker = journal.source(WALKER, LAYOUT)
        assert not journal.samples(walker, 0, whole)
        assert all(journal.samples(walker, 0, block(NAMES[0], k, 3000), waits=True) for k in range(0, 30_000, 3000))
    assert journal.stop().dropped_records > 0  # of the first attempt, which did not wait


def test_an_import_that_waits_is_let_go_when_the_disk_fails(tmp_path: Path, disk: Disk) -> None:
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED, queue_bytes=300_000) as journal:
        walker = journal.source(WALKER, LAYOUT)
        wait_for(lambda: journal.status.records == 1)
        disk.error = errno.EIO
        pieces = (block(NAMES[0], k, 3000) for k in range(0, 30_000, 3000))
        assert not all(journal.samples(walker, 0, piece, waits=True) for piece in pieces)


def test_many_threads_may_put_in_at_once(tmp_path: Path) -> None:
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:

        def send(source: int) -> None:
            for number in range(300):
                journal.received(source, line(number))

        threads = [threading.Thread(target=send, args=(journal.source(LINES),)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    records, _, _ = read_all(journal.path, KEY)
    assert all(a.time_ns <= b.time_ns for a, b in itertools.pairwise(records))
    for source in range(4):
        sent = [r.payload[2:] for r in records if r.kind is RecordKind.BYTES and r.payload[0] == source]
        assert sent == [line(k) for k in range(300)]


def test_samples_that_a_source_never_promised_are_refused_at_once(tmp_path: Path) -> None:
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        lines, walker = journal.source(LINES), journal.source(WALKER, LAYOUT)
        with pytest.raises(ValueError, match="gives no samples"):
            journal.samples(lines, 0, block("a", 0))
        with pytest.raises(ValueError, match="of a sensor 6"):
            journal.samples(walker, 6, block("a", 0))


def test_every_trouble_has_its_words() -> None:
    assert set(REPORTED) == set(Trouble)


def test_a_segment_that_another_program_writes_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.1.journal"
    first = JournalFile(path, b"header")
    first.append(b"samples")
    with pytest.raises(FileExistsError, match="another program"):
        JournalFile(path, b"header")
    first.close()
    assert path.read_bytes() == b"headersamples"
