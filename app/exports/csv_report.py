"""Numbers behind the plotted curves. One table per recording, in degrees."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv

from core.body import LEG_JOINTS, Joint, Side
from core.gait.phases import PHASES
from core.results import JointAngle, RecordingAnalysis
from core.samples import FloatArray
from core.verdicts.status import NOT_REPORTED, is_slipped, joint_status

ROWS_PER_BLOCK = 100_000  # some 20 MB of table: ten hours pass through without ever being in memory as text
DECIMALS = 5
DIGITS = 18  # what fits into the 64 bits below; an angle of a million turns needs 14


def write_angles(recording: RecordingAnalysis, path: Path) -> None:
    """Write one recording's angles in degrees, gaps empty, unreported ones kept with their status."""
    blocks = _angle_blocks(recording)
    first = next(blocks)
    with path.open("wb") as file:
        file.write((",".join(first.schema.names) + "\n").encode())
        # pyarrow quotes every heading of its own, so the line above is ours
        options = pa.csv.WriteOptions(include_header=False, quoting_style="none")
        with pa.csv.CSVWriter(file, first.schema, write_options=options) as writer:
            writer.write_batch(first)
            for block in blocks:
                writer.write_batch(block)


def _angle_blocks(recording: RecordingAnalysis) -> Iterator[pa.RecordBatch]:
    """Yield the table in blocks of rows, at least one, which may be empty."""
    joints = [joint for joint in LEG_JOINTS if joint in recording.joints]
    for start in range(0, max(len(recording.time_s), 1), ROWS_PER_BLOCK):
        rows = slice(start, start + ROWS_PER_BLOCK)
        columns = {"time_s": pa.array(recording.time_s[rows])}
        for joint in joints:
            columns |= _joint_columns(joint, recording.joints[joint], rows)
        n = len(columns["time_s"])
        columns |= {f"{side}_phase": _phases(recording, side, rows, n) for side in Side}
        columns |= {f"{joint}_status": _status(recording, joint, rows) for joint in joints}
        columns |= _of_pelvis(recording, rows)
        yield pa.RecordBatch.from_pydict(columns)


def _of_pelvis(recording: RecordingAnalysis, rows: slice) -> dict[str, pa.Array]:
    """Give the columns that a sensor on the pelvis adds; none without one."""
    columns = {}
    for joint, hip in sorted(recording.hips.items()):
        columns[f"{joint}_deg"] = _degrees(hip.angle_rad[rows])
        columns[f"{joint}_sd_deg"] = _degrees(hip.sd_rad[rows])
        columns[f"{joint}_abduction_deg"] = _degrees(hip.abduction_rad[rows])
        columns[f"{joint}_status"] = _status(recording, joint, rows)
    if recording.pelvis is not None:
        columns["pelvis_tilt_deg"] = _degrees(recording.pelvis.tilt_rad[rows])
        columns["pelvis_obliquity_deg"] = _degrees(recording.pelvis.obliquity_rad[rows])
        columns["pelvis_rotation_deg"] = _degrees(recording.pelvis.rotation_rad[rows])
    return columns


def _phases(recording: RecordingAnalysis, side: Side, rows: slice, n: int) -> pa.Array:
    """Give the phase of each row in words, empty where it is unknown."""
    if side not in recording.gait:
        return pa.nulls(n, pa.string())
    words = pa.array([str(phase) or None for phase in PHASES])
    return words.take(pa.array(recording.gait[side].phase[rows]))


def _status(recording: RecordingAnalysis, joint: Joint, rows: slice) -> pa.Array:
    """Give the joint's status in each row, not reported after a strap of its leg slipped."""
    words = pa.array([joint_status(recording, joint) or None, NOT_REPORTED])
    return words.take(pa.array(is_slipped(recording, joint.side, rows).astype(np.int64)))


def _joint_columns(joint: Joint, angle: JointAngle, rows: slice) -> dict[str, pa.Array]:
    result = angle.angle_rad[rows]
    orientation = np.full(len(result), np.nan) if angle.orientation_rad is None else angle.orientation_rad[rows]
    return {
        f"{joint}_deg": _degrees(result),
        f"{joint}_sd_deg": _degrees(angle.sd_rad[rows]),
        f"{joint}_published_deg": _degrees(angle.published_rad[rows]),
        f"{joint}_orientation_deg": _degrees(orientation),
    }


def _degrees(angle_rad: FloatArray) -> pa.Array:
    """Give angles as decimals of fixed length, which pyarrow writes ten times as fast as Python formats floats."""
    is_known = np.isfinite(angle_rad)
    units = np.rint(np.rad2deg(np.where(is_known, angle_rad, 0.0)) * 10**DECIMALS).astype(np.int64)
    # a 128 bit decimal is its number of last digits, low half first, the high half carrying the sign
    halves = np.stack([units, units >> 63], axis=1)
    validity = np.packbits(is_known, bitorder="little")
    kind = pa.decimal128(DIGITS, DECIMALS)
    return pa.Array.from_buffers(kind, len(units), [pa.py_buffer(validity), pa.py_buffer(halves)])
