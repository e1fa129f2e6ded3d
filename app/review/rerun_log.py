"""How can a session be looked at again, sample by sample? One Rerun log of what was measured and what was computed.

Every recording is a timeline of its own, named by its kind and number (`walking_1`); choosing another timeline shows
another recording in the same views. Nothing is left out between samples, and nobody's words are inside.

The same session gives the same bytes. Rerun numbers its chunks, rows and stores by the clock and by chance, so they
are numbered here; and it ends a file with a table of contents in random order, which is cut off: the viewer makes it
anew, as it does for a log that was never closed.
"""

import errno
import struct
import tempfile
import uuid
from collections.abc import Iterator
from itertools import count
from pathlib import Path

import numpy as np
import pyarrow as pa
import rerun as rr
import rerun.blueprint as rrb
from rerun.chunk import Chunk, RrdReader
from rerun_bindings import PyMemorySinkStorage, new_blueprint, save

from core.body import Joint, Site
from core.results import Analysis, JointAngle
from core.samples import FloatArray, ImuBlock, RecordingKind, Session

APPLICATION = "gaitwright"
RECORDING = "session"
BLUEPRINT = b"rec_" + b"0" * 32  # as long as the name that Rerun draws by chance, so it can take its place
ROWS_PER_CHUNK = 100_000  # 4 MB of three axes with their times
BAND_SD = 2.0

# What the log's file consists of: "RRF2" and its version, then messages, each with its kind and length before it
FILE_HEADER_BYTES = 12
MESSAGE_HEADER = struct.Struct("<QQ")
END, STORE_INFO = 0, 1
LONGEST_ENVELOPE = 128  # a message names its store within its first bytes
ROW_ID = slice(3, 20)  # in a store's info: eight bytes of time, a tag, eight bytes of chance
NO_ROW_ID = b"\0" * 8 + b"\x11" + b"\0" * 8


def write_log(session: Session, analysis: Analysis, path: Path) -> None:
    """Write raw signals, angles by each method and their certainty, with a layout for the viewer.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    path.touch()  # Rerun reports an unwritable file in its own words, and not always
    timelines = _timelines(session)
    layout, layout_name = _layout(session, analysis, next(iter(timelines.values()), None))
    log = rr.RecordingStream(APPLICATION, recording_id=RECORDING, send_properties=False)
    save(str(path), layout, log.to_native())
    for number, chunk in enumerate(_chunks(session, analysis, timelines), start=1):
        rr.send_chunks(_numbered(chunk, number), recording=log)
        log.flush()  # or the chunks would pile up in memory
    log.disconnect()
    _remove_chance(path, layout_name)


def _timelines(session: Session) -> dict[str, str]:
    """Name every kept recording's timeline by kind and number, because its own name may be anything."""
    numbers = {kind: count(1) for kind in RecordingKind}
    named = {r.name: f"{r.kind}_{next(numbers[r.kind])}" for r in session.recordings if r.is_kept}
    return dict(sorted(named.items(), key=lambda item: not item[1].startswith(RecordingKind.WALKING)))


def _chunks(session: Session, analysis: Analysis, timelines: dict[str, str]) -> Iterator[Chunk]:
    yield from _labels(session, analysis)
    for recording in session.recordings:
        for site in recording.imu if recording.is_kept else ():
            yield from _raw_chunks(timelines[recording.name], site, recording.imu[site])
    for analysed in analysis.recordings:
        for joint, angle in analysed.joints.items():
            yield from _angle_chunks(timelines[analysed.name], joint, analysed.time_s, angle)


def _labels(session: Session, analysis: Analysis) -> Iterator[Chunk]:
    for site in _sites(session):
        yield _label(f"/raw/{site}/angular_rate", [f"{axis} rad/s" for axis in "xyz"])
        yield _label(f"/raw/{site}/specific_force", [f"{axis} m/s²" for axis in "xyz"])
    for joint in _joints(analysis):
        for curve in ("result", "published", "orientation"):
            yield _label(f"/angles/{joint}/{curve}", [f"{curve} °"])
        yield _label(f"/angles/{joint}/certainty", ["2 sd below °", "2 sd above °"])


def _label(entity: str, names: list[str]) -> Chunk:
    return Chunk.from_columns(entity, indexes=[], columns=rr.SeriesLines.columns(names=names).partition([len(names)]))


def _raw_chunks(timeline: str, site: Site, block: ImuBlock) -> Iterator[Chunk]:
    yield from _series(f"/raw/{site}/angular_rate", timeline, block.time_s, block.gyr_rad_s)
    yield from _series(f"/raw/{site}/specific_force", timeline, block.time_s, block.acc_m_s2)


def _angle_chunks(timeline: str, joint: Joint, time_s: FloatArray, angle: JointAngle) -> Iterator[Chunk]:
    band_rad = angle.angle_rad[:, None] + BAND_SD * angle.sd_rad[:, None] * np.array([-1.0, 1.0])
    curves = {"result": angle.angle_rad, "published": angle.published_rad, "orientation": angle.orientation_rad}
    for curve, values_rad in (curves | {"certainty": band_rad}).items():
        if values_rad is not None:
            yield from _series(f"/angles/{joint}/{curve}", timeline, time_s, np.rad2deg(values_rad))


def _series(entity: str, timeline: str, time_s: FloatArray, values: FloatArray) -> Iterator[Chunk]:
    """Yield values (n,) or (n, k) over time in chunks; a gap stays NaN, at which a line breaks."""
    for start in range(0, len(time_s), ROWS_PER_CHUNK):
        rows = slice(start, start + ROWS_PER_CHUNK)
        yield Chunk.from_columns(
            entity,
            indexes=[rr.TimeColumn(timeline, duration=time_s[rows])],
            columns=rr.Scalars.columns(scalars=values[rows]),
        )


def _sites(session: Session) -> list[Site]:
    return [site for site in Site if any(r.is_kept and site in r.imu for r in session.recordings)]


def _joints(analysis: Analysis) -> list[Joint]:
    return [joint for joint in Joint if any(joint in recording.joints for recording in analysis.recordings)]


def _blueprint(session: Session, analysis: Analysis, timeline: str | None) -> rrb.Blueprint:
    angles = [rrb.TimeSeriesView(origin=f"/angles/{j}", name=j.replace("_", " ")) for j in _joints(analysis)]
    tabs = [rrb.Grid(*angles, name="Angles", grid_columns=2)] if angles else []
    for signal in ("angular_rate", "specific_force"):
        views = [rrb.TimeSeriesView(origin=f"/raw/{s}/{signal}", name=s.replace("_", " ")) for s in _sites(session)]
        tabs += [rrb.Grid(*views, name=signal.replace("_", " ").capitalize(), grid_columns=2)]
    layout = rrb.Tabs(*tabs)
    for number, part in enumerate(_parts(layout)):
        part.id = uuid.UUID(int=number + 1)
    return rrb.Blueprint(layout, rrb.TimePanel(timeline=timeline), collapse_panels=True)


def _parts(part: rrb.Container | rrb.View) -> Iterator[rrb.Container | rrb.View]:
    yield part
    for inner in part.contents if isinstance(part, rrb.Container) else ():
        yield from _parts(inner)


def _layout(session: Session, analysis: Analysis, timeline: str | None) -> tuple[PyMemorySinkStorage, bytes]:
    """Give the layout as messages that `save` puts before the log, and the name by which they call their store."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "layout.rbl"
        _blueprint(session, analysis, timeline).save(APPLICATION, file)
        reader = RrdReader(file)
        chunks = sorted(reader.stream(store=reader.blueprints()[0]), key=lambda chunk: chunk.entity_path)
    stream = rr.RecordingStream._from_native(new_blueprint(APPLICATION, make_default=False, make_thread_default=False))
    messages = rr.memory_recording(stream)
    rr.send_chunks([_numbered(chunk, number) for number, chunk in enumerate(chunks, start=1)], recording=stream)
    return messages.storage, str(stream.get_recording_id()).encode()


def _numbered(chunk: Chunk, number: int) -> Chunk:
    """Give the same chunk with its name and its rows' names made from `number`, and without the time of writing."""
    batch = chunk.to_record_batch()
    kept = [i for i, name in enumerate(batch.schema.names) if name not in ("log_time", "log_tick")]
    fields, columns = [batch.schema.field(i) for i in kept], [batch.column(i) for i in kept]
    rows = np.empty((batch.num_rows, 2), dtype=">u8")
    rows[:, 0], rows[:, 1] = number, np.arange(batch.num_rows)
    columns[0] = pa.Array.from_buffers(fields[0].type, batch.num_rows, [None, pa.py_buffer(rows)])
    metadata = dict(batch.schema.metadata) | {b"rerun:id": f"chunk_{number:032X}".encode()}
    same = pa.RecordBatch.from_arrays(columns, schema=pa.schema(fields, metadata))
    return Chunk.from_record_batch(same)[0]


def _remove_chance(path: Path, layout_name: bytes) -> None:
    """Overwrite in place what differs from one writing to the next, and cut off the table of contents.

    Raises
    ------
    OSError
        The log has no end, because Rerun could not write it whole.
    ValueError
        A file of another version of Rerun.
    """
    with path.open("r+b") as file:
        position = FILE_HEADER_BYTES
        while True:
            file.seek(position)
            header = file.read(MESSAGE_HEADER.size)
            if len(header) < MESSAGE_HEADER.size:
                raise OSError(errno.EIO, "the log ends too early", str(path))
            kind, length = MESSAGE_HEADER.unpack(header)
            if kind == END:
                file.truncate(position)
                return
            envelope = bytearray(file.read(min(length, LONGEST_ENVELOPE)))
            if kind == STORE_INFO:
                if envelope[:3] != b"\x0a\x12\x09" or envelope[11] != NO_ROW_ID[8]:
                    raise ValueError(f"store info begins with {bytes(envelope[:20])!r}, expected a row's name")
                envelope[ROW_ID] = NO_ROW_ID
            file.seek(position + MESSAGE_HEADER.size)
            file.write(envelope.replace(layout_name, BLUEPRINT))
            position += MESSAGE_HEADER.size + length
