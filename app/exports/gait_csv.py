"""Strides behind the averages. Events, strides and mean cycles of one recording, and when strides peak.

What may be stated about each figure is beside it, in the columns of status; the cells of what is not reported are
empty. A curve without a zero keeps its shape: the column of its shape is the curve less its mean.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from app.summary.events import events_of
from app.system.tables import figure_cell, write_table
from core.body import Joint, Side, ankle_of, hip_of, knee_of
from core.gait.cycles import POINTS
from core.results import RecordingAnalysis
from core.verdicts.model import Assessment, together
from core.verdicts.quantities import (
    EXCURSIONS_BY_COLUMN,
    OF_HIPS,
    PARAMETERS,
    WINDOWS,
    abduction_curve,
    assessment_of,
    hip_peaks_percent,
    mean_curve,
    peak_percent,
    values_of,
)
from core.verdicts.status import joint_status

TIMES = ("start_s", "full_contact_s", "heel_rise_s", "toe_off_s", "end_s")
PEAK_TIMES = tuple(f"{window.name}_percent" for window in WINDOWS.values())
STRIDE_STATUS = (  # of the columns that each represents
    *("timing_status", "between_status", "distance_status"),
    *("knee_shape_status", "knee_height_status", "ankle_shape_status", "ankle_height_status"),
)

HIP_STATUS = (
    *("hip_shape_status", "hip_height_status", "pelvis_status"),
    *("hip_abduction_status", "pelvis_tilt_status"),
)
HIP_PEAKS = ("hip_flexion_peak_percent", "hip_extension_peak_percent")


def write_gait(recording: RecordingAnalysis, folder: Path) -> None:
    """Write `events.csv`, `strides.csv` and `cycles.csv`; without gait, their headings only; raises OSError."""
    for name, (header, rows) in gait_tables(recording).items():
        write_table(header, rows, folder / f"{name}.csv")


def peak_table(recordings: Sequence[RecordingAnalysis]) -> tuple[list[str], list[list[str]]]:
    """Give heading and rows of `peaks.csv`: when each stride of any recording peaks, and its excursions."""
    rows = []
    has_hips = any(recording.hips for recording in recordings)
    for recording in recordings:
        for side in Side:
            if side in recording.gait:
                strides = recording.gait[side].strides
                columns = [strides.start_s, *(peak_percent(recording, side, column) for column in WINDOWS)]
                columns += [values_of(recording, side, column) for column in EXCURSIONS_BY_COLUMN]
                status = [_peak_status(recording, joint) for joint in (knee_of(side), ankle_of(side))]
                of_hip = hip_peaks_percent(recording, side) if has_hips else []
                of_hip_status = [_peak_status(recording, hip_of(side))] if has_hips else []
                for k, reason in enumerate(strides.reason):
                    cells = [figure_cell(float(column[k])) for column in columns]
                    more = [*(figure_cell(float(column[k])) for column in of_hip), *of_hip_status]
                    rows.append([recording.folder, str(side), *cells, "false" if reason else "true", *status, *more])
    figures = [*PEAK_TIMES, *EXCURSIONS_BY_COLUMN]
    header = ["recording", "side", "start_s", *figures, "used", "knee_status", "ankle_status"]
    return [*header, *((*HIP_PEAKS, "hip_status") if has_hips else ())], rows


def _peak_status(recording: RecordingAnalysis, joint: Joint) -> str:
    found = recording.verdicts.joint(joint)
    return str(together((found.shape, found.sign)).verdict)


def gait_tables(recording: RecordingAnalysis) -> dict[str, tuple[list[str], Iterator[list[str]]]]:
    """Give headings and rows of `events`, `strides` and `cycles`, every cell as it is in the file."""
    joints = [joint for joint in Joint if joint.side in recording.gait and joint in recording.gait[joint.side].cycles]
    of_cycles = ["percent"]
    for joint in joints:
        of_cycles += [f"{joint}_{what}" for what in ("mean_deg", "stride_sd_deg", "n", "shape_deg", "status")]
        of_abduction = ("mean_deg", "stride_sd_deg", "n", "status") if joint.is_hip else ()
        of_cycles += [f"{joint}_abduction_{what}" for what in of_abduction]
    events = ([figure_cell(time_s), str(side), event] for time_s, side, event in events_of(recording))
    return {
        "events": (["time_s", "side", "event"], events),
        "strides": (
            ["side", *TIMES, *PARAMETERS, "used", "reason", *STRIDE_STATUS, *_more_of_strides(recording)],
            _strides(recording),
        ),
        "cycles": (of_cycles, _cycles(recording, joints)),
    }


def _strides(recording: RecordingAnalysis) -> Iterator[list[str]]:
    for side in Side:
        if side not in recording.gait:
            continue
        strides = recording.gait[side].strides
        columns = [getattr(strides, name) for name in TIMES]
        columns += [values_of(recording, side, name) for name in PARAMETERS]
        status = [str(found.verdict) for found in _assessments(recording, side)]
        more = [values_of(recording, side, name) for name in OF_HIPS] if recording.pelvis is not None else []
        of_more = [str(found.verdict) for found in _assessments_of_hips(recording, side)] if more else []
        for k, reason in enumerate(strides.reason):
            used = "false" if reason else "true"
            cells = [*(figure_cell(float(column[k])) for column in columns), used, str(reason), *status]
            yield [str(side), *cells, *(figure_cell(float(column[k])) for column in more), *of_more]


def _more_of_strides(recording: RecordingAnalysis) -> tuple[str, ...]:
    """The columns that a sensor on the pelvis adds."""
    return (*OF_HIPS, *HIP_STATUS) if recording.pelvis is not None else ()


def _assessments_of_hips(recording: RecordingAnalysis, side: Side) -> list[Assessment]:
    """Of each column of `HIP_STATUS`."""
    hip = recording.verdicts.joint(hip_of(side))
    abduction, tilt = (
        assessment_of(recording.verdicts, side, name) for name in ("hip_abduction_range_deg", "pelvis_tilt_range_deg")
    )
    return [hip.shape, together((hip.height, hip.sign)), recording.verdicts.pelvis, abduction, tilt]


def _assessments(recording: RecordingAnalysis, side: Side) -> list[Assessment]:
    """Of each column of `STRIDE_STATUS`."""
    leg, joints = recording.verdicts.leg(side), [recording.verdicts.joint(j) for j in (knee_of(side), ankle_of(side))]
    of_joints = [each for found in joints for each in (found.shape, together((found.height, found.sign)))]
    return [leg.timing, together((recording.verdicts.between, leg.timing)), leg.distance, *of_joints]


def _cycles(recording: RecordingAnalysis, joints: list[Joint]) -> Iterator[list[str]]:
    curves = []
    for joint in joints:
        found, has_height = mean_curve(recording, joint), recording.verdicts.joint(joint).height.is_reported
        mean = np.rad2deg(found.mean)
        shape = mean - mean.mean()
        height = mean if has_height else np.full(POINTS, np.nan)
        curves.append((height, np.rad2deg(found.sd), found.n, shape, joint_status(recording, joint)))
    abductions = {joint: _abduction_cells(recording, joint.side) for joint in joints if joint.is_hip}
    for percent in range(POINTS if joints else 0):
        row = [str(percent)]
        for joint, (height, sd, n, shape, status) in zip(joints, curves, strict=True):
            row += [figure_cell(float(height[percent])), figure_cell(float(sd[percent])), str(n)]
            row += [figure_cell(float(shape[percent])), status]
            row += abductions[joint][percent] if joint in abductions else []
        yield row


def _abduction_cells(recording: RecordingAnalysis, side: Side) -> list[list[str]]:
    """Of each percent of the stride mean, spread, count and status."""
    found, stated = abduction_curve(recording, side), assessment_of(recording.verdicts, side, "hip_abduction_peak_deg")
    mean_deg, sd_deg = np.rad2deg(found.mean), np.rad2deg(found.sd)
    tail = [str(found.n), str(stated.verdict)]
    return [[figure_cell(float(mean_deg[k])), figure_cell(float(sd_deg[k])), *tail] for k in range(POINTS)]
