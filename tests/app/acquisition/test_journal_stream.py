"""A journal gives what was sent to a sensor: the settings it measures with, before what it states under them."""

from collections.abc import Sequence
from pathlib import Path

from app.acquisition.journal_stream import JournalStream
from app.storage.journal.reader import JournalReader
from app.storage.journal.records import Record, RecordKind
from devices.drivers.ximu3 import Ximu3, command
from devices.stream import ByteSource
from tests.devices.scripted import ScriptedChannel
from tests.safety.journal_material import ID, KEY
from tests.safety.live_material import open_journal


def kept(path: Path) -> list[tuple[RecordKind, bytes]]:
    records = [record for record in JournalReader(path, KEY).records() if isinstance(record, Record)]
    return [
        (record.kind, record.payload[2:]) for record in records if record.kind in (RecordKind.SENT, RecordKind.BYTES)
    ]


def answers(written: bytes) -> bytes:
    return b'{"ping":{"sn":"A"}}\n' if b"ping" in written else written


def sent(*written: bytes) -> Sequence[tuple[RecordKind, bytes]]:
    return [(RecordKind.SENT, one) for one in written]


def test_what_was_sent_is_before_what_came_of_it_and_again_after_a_loss(tmp_path: Path) -> None:
    channel = ScriptedChannel(answers=answers)
    source = ByteSource(Ximu3(), channel)
    source.open()
    greeting = list(channel.written)
    assert len(greeting) == 3
    writer = open_journal(tmp_path, ID)
    tape = JournalStream(writer, source)
    tape.keep_bytes(b"one")
    source.identify("A")
    tape.keep_bytes(b"two")
    tape.keep_bytes(b"three")
    source.close()
    source.open()
    tape.come_back()
    tape.keep_bytes(b"four")
    summary = writer.stop()
    strobe = command("strobe")
    assert channel.written == [*greeting, strobe, *greeting]
    assert kept(summary.path) == [
        *sent(*greeting),
        (RecordKind.BYTES, b"one"),
        *sent(strobe),
        (RecordKind.BYTES, b"two"),
        (RecordKind.BYTES, b"three"),
        *sent(*greeting),
        (RecordKind.BYTES, b"four"),
    ]
