"""Samples of a Movella DOT out of a journal: what it streamed, or the file that was fetched from its memory."""

from collections.abc import Mapping
from dataclasses import replace

from devices.dot.memory import RECORD_HZ
from devices.dot.messages import RecordedFile
from devices.dot.samples import DRIVER, VERSION, DotFramer, FileFramer, Tie
from devices.source import DecodedSensor, SourceInfo
from devices.stream import Decoder, Heard, decoded


def file_settings(file: RecordedFile, tie: Tie, begun_s: float) -> dict[str, object]:
    """What a `SourceInfo` holds of a fetched file.

    Parameters
    ----------
    tie
        To seconds since the journal was opened.
    begun_s
        When its recording was begun, in the same seconds, roughly.

    Returns
    -------
    dict
        What JSON can hold.
    """
    return {
        "file": [file.number, file.started_utc_s, file.length_s],
        "tie": [tie.origin_s, tie.offset_s, tie.skew],
        "begun_s": begun_s,
        "recorded_hz": RECORD_HZ,
    }


class _Streamed:
    """See `devices.stream.Framing`."""

    driver, version = DRIVER, VERSION

    def framer(self, info: SourceInfo) -> DotFramer:
        return DotFramer(info)


class DotDecoder:
    """See `devices.source.StreamDecoder`. A file is one however often its link was lost while it was fetched."""

    def __init__(self) -> None:
        self._streamed = Decoder(_Streamed())
        self._file: FileFramer | None = None
        self._info: SourceInfo | None = None

    def begin(self, source: SourceInfo) -> None:
        if "file" not in source.settings:
            self._streamed.begin(source)
        elif self._info is None or self._info.settings["file"] != source.settings["file"]:
            self._file, self._info = FileFramer(), source
        else:
            self._file = self._file or FileFramer()
            self._file.cut()

    def feed(self, data: bytes, host_time_s: float) -> None:
        if self._file is not None:
            self._file.feed(data)
        else:
            self._streamed.feed(data, host_time_s)

    def finish(self) -> Mapping[str, DecodedSensor]:
        if self._file is None or self._info is None:
            return self._streamed.finish()
        return {self._info.sensors[0]: _fetched(self._info, self._file)}


def _fetched(info: SourceInfo, file: FileFramer) -> DecodedSensor:
    numbers, begun_s = info.settings["tie"], info.settings["begun_s"]
    if not isinstance(numbers, list) or not isinstance(begun_s, int | float):
        raise ValueError(f"a file of a {DRIVER} cannot be read without how its clock went")
    tie = Tie(*map(float, numbers))
    rows, orientations = file.rows(begun_s, tie)
    one = decoded(info.sensors[0], Heard(rows, orientations), [tie.host_s(row[0]) for row in rows])
    return replace(one, counts=replace(one.counts, lost=sum(map(len, file.missing()))))
