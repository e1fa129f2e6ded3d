"""Write one source into a recording's journal.

Its sensors follow one by one, each announced before its first sample.
"""

from dataclasses import replace

from app.storage.journal.payloads import SampleLayout, layout_of
from app.storage.journal.writer import JournalWriter
from core.samples import ImuBlock
from devices.live import LiveSource
from devices.source import SourceInfo

Shape = tuple[bool, bool, bool, tuple[str, ...]]
BYTES = ""  # the name by which a source's bytes are announced


class JournalStream:
    """Puts what one source sends into a journal; waits for nothing. Not for two threads at once."""

    def __init__(self, writer: JournalWriter, source: LiveSource) -> None:
        self._writer, self._source = writer, source
        self._begin_s = writer.header.opened_ns / 1e9
        self._reported: dict[str, tuple[int, SourceInfo, SampleLayout | None]] = {}
        self._shapes: dict[str, Shape] = {}
        self._sent = 0  # how much of what was written to the source is kept

    def keep_bytes(self, data: bytes) -> None:
        if BYTES not in self._reported:
            self._show_message(BYTES, self._source.info, None)
        number, sent = self._reported[BYTES][0], self._source.sent
        for written in sent[self._sent :]:
            self._writer.sent(number, written)
        self._sent = len(sent)
        self._writer.received(number, data)

    def keep_samples(self, block: ImuBlock, rate_hz: float | None = None) -> None:
        """Keep samples stamped in seconds of the host's clock, from the recording's beginning on."""
        block = _from(block, self._begin_s)
        if len(block):
            self._writer.samples(self._number(block, rate_hz), 0, block)

    def come_back(self) -> None:
        """The source was lost and is there again: its settings may be others, and bytes do not join those before."""
        self._shapes.clear()
        self._sent = 0
        if BYTES in self._reported:
            self._show_message(BYTES, self._source.info, None, is_cut=True)

    def _number(self, block: ImuBlock, rate_hz: float | None) -> int:
        """What the journal calls the block's sensor."""
        name = block.sensor
        shape = block.q_earth_from_sensor is None, block.mag is None, block.is_rate_derived, tuple(block.unknown)
        if self._shapes.get(name) != shape:
            self._show_message(name, replace(self._source.info, sensors=(name,)), layout_of(block, rate_hz))
            self._shapes[name] = shape
        return self._reported[name][0]

    def _show_message(self, name: str, info: SourceInfo, layout: SampleLayout | None, is_cut: bool = False) -> None:
        if name not in self._reported:
            number = self._writer.source(info, layout)
        else:
            number, *before = self._reported[name]
            if is_cut or before != [info, layout]:
                self._writer.change(number, info, layout)
        self._reported[name] = number, info, layout


def _from(block: ImuBlock, begin_s: float) -> ImuBlock:
    """The samples that are not older than `begin_s`, stamped in seconds since then; those without a stamp, too."""
    moved = replace(block, time_s=block.time_s - begin_s)
    if len(moved) and not moved.time_s.min() >= 0:  # the recording has just begun, or a stamp is missing
        return moved.select(~(moved.time_s < 0))
    return moved
