"""Timeline of a walk's steps alone. Where a log opens, since the viewer opens each timeline at its first value.

Rows between the first contact and the last have both times, that of the walk and that of its steps; none is written
twice but what was already so when the first step began.
"""

from collections.abc import Iterator, Mapping

import numpy as np
import pyarrow as pa

from core.results import RecordingAnalysis

LASTING = ("/answer", "/phases")  # these hold from their row on, until the next


def steps_name(timeline: str) -> str:
    """The name of the timeline of a walk's steps, beside the walk's own."""
    return f"{timeline}_steps"


def steps_of(recording: RecordingAnalysis) -> tuple[float, float] | None:
    """First contact of the first used stride to the end of the last; None where none is used."""
    used = [(gait.strides, gait.strides.is_used) for gait in recording.gait.values()]
    starts_s = [float(strides.start_s[is_used].min()) for strides, is_used in used if is_used.any()]
    ends_s = [float(strides.end_s[is_used].max()) for strides, is_used in used if is_used.any()]
    return (min(starts_s), max(ends_s)) if starts_s else None


def with_steps(
    entity: str, batch: pa.RecordBatch, steps: Mapping[str, tuple[float, float]]
) -> Iterator[pa.RecordBatch]:
    """Yield rows, those during the steps of their walk with their time twice; `steps` by the walk's timeline."""
    timeline = next((name for name in batch.schema.names if name in steps), None)
    if timeline is None:
        yield batch
        return
    time_ns = batch.column(timeline).cast("int64").to_numpy()
    start_ns, end_ns = (round(time_s * 1e9) for time_s in steps[timeline])
    first, behind = np.searchsorted(time_ns, start_ns), np.searchsorted(time_ns, end_ns, side="right")
    for begin, end in ((0, first), (behind, len(time_ns))):
        if begin < end:
            yield batch.slice(begin, end - begin)
    if first < behind:
        yield _timed(batch.slice(first, behind - first), timeline, is_both=True)
    if first and entity.startswith(LASTING) and (first == len(time_ns) or time_ns[first] > start_ns):
        lasting = _timed(batch.slice(first - 1, 1), timeline, is_both=False)
        at = lasting.schema.get_field_index(steps_name(timeline))
        start = pa.array([start_ns], pa.int64()).cast(lasting.schema.field(at).type)
        yield lasting.set_column(at, lasting.schema.field(at), start)


def _timed(batch: pa.RecordBatch, timeline: str, *, is_both: bool) -> pa.RecordBatch:
    """Give the same rows with the steps' timeline, beside their own or in its place."""
    at, name = batch.schema.get_field_index(timeline), steps_name(timeline)
    own = batch.schema.field(at)
    field = own.with_name(name).with_metadata(dict(own.metadata) | {b"rerun:index_name": name.encode()})
    if not is_both:
        return batch.set_column(at, field, batch.column(at))
    columns, fields = list(batch.columns), list(batch.schema)
    columns.insert(at + 1, batch.column(at))
    fields.insert(at + 1, field)
    return pa.RecordBatch.from_arrays(columns, schema=pa.schema(fields, batch.schema.metadata))
