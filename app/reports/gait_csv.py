"""Which strides stand behind the averages? Events, strides and mean cycles of one recording, and when strides peak.

A joint whose clinical sign is in doubt may be mirrored, one without a zero stands at no height: of them the strides
hold the ranges, which are the same either way, and no angle. The mean cycle of a joint without zero shows its shape.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.reports.csv_report import write_table
from core.body import Joint, Side
from core.gait.cycles import ANKLE_WINDOWS, KNEE_WINDOWS, POINTS, MeanCycle, find_peak, mean_cycle
from core.results import RecordingAnalysis, SideGait
from core.samples import FloatArray

EVENTS = ("initial_contact", "full_contact", "heel_rise", "toe_off")
TIMES = ("start_s", "full_contact_s", "heel_rise_s", "toe_off_s", "end_s")
PARAMETERS = (  # as strides.csv has them; angles in degrees
    "stride_time_s",
    "step_time_s",
    "stance_percent",
    "swing_percent",
    "stride_length_m",
    "speed_m_s",
    "clearance_m",
    "knee_at_initial_contact_deg",
    "knee_loading_peak_deg",
    "knee_stance_minimum_deg",
    "knee_swing_peak_deg",
    "knee_swing_peak_percent",
    "knee_range_deg",
    "ankle_at_initial_contact_deg",
    "ankle_loading_plantarflexion_deg",
    "ankle_stance_dorsiflexion_deg",
    "ankle_push_off_plantarflexion_deg",
    "ankle_swing_dorsiflexion_deg",
    "ankle_range_deg",
)
WINDOWS = {f"{window.name}_deg": window for window in (*KNEE_WINDOWS, *ANKLE_WINDOWS)}
PEAK_TIMES = tuple(f"{window.name}_percent" for window in WINDOWS.values())


def write_gait(recording: RecordingAnalysis, folder: Path) -> None:
    """Write `events.csv`, `strides.csv` and `cycles.csv`; without gait they hold their headings only.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    for name, (header, rows) in gait_tables(recording).items():
        write_table(header, rows, folder / f"{name}.csv")


def peak_table(recordings: Sequence[RecordingAnalysis]) -> tuple[list[str], list[list[str]]]:
    """Give heading and rows of `peaks.csv`: when each stride of any recording peaks, % of the stride."""
    rows = []
    for recording in recordings:
        for side in Side:
            if side in recording.gait:
                gait = recording.gait[side]
                columns = [gait.strides.start_s, *(peak_percent(gait, column) for column in WINDOWS)]
                for k, reason in enumerate(gait.strides.reason):
                    cells = [_cell(float(column[k])) for column in columns]
                    rows.append([recording.folder, str(side), *cells, "false" if reason else "true"])
    return ["recording", "side", "start_s", *PEAK_TIMES, "used"], rows


def gait_tables(recording: RecordingAnalysis) -> dict[str, tuple[list[str], Iterator[list[str]]]]:
    """Give headings and rows of `events`, `strides` and `cycles`, every cell as it stands in the file."""
    joints = [joint for joint in Joint if joint.side in recording.gait and joint in recording.gait[joint.side].cycles]
    of_cycles = ["percent"]
    for joint in joints:
        of_cycles += [f"{joint}_mean_deg", f"{joint}_stride_sd_deg", f"{joint}_n"]
    events = ([_cell(time_s), str(side), event] for time_s, side, event in events_of(recording))
    return {
        "events": (["time_s", "side", "event"], events),
        "strides": (["side", *TIMES, *PARAMETERS, "used", "reason"], _strides(recording)),
        "cycles": (of_cycles, _cycles(recording, joints)),
    }


def events_of(recording: RecordingAnalysis) -> list[tuple[float, Side, str]]:
    """Time, side and kind of every event that is known, ascending."""
    found = [
        (float(time_s), side, event)
        for side, gait in recording.gait.items()
        for events in gait.events
        for event in EVENTS
        for time_s in getattr(events, f"{event}_s")
        if math.isfinite(time_s)
    ]
    return sorted(found, key=lambda event: (event[0], event[1], EVENTS.index(event[2])))


def parameter(gait: SideGait, name: str) -> FloatArray:
    """One column of strides.csv (k,), angles in degrees; NaN where there is no angle, or one that does not hold."""
    values = gait.parameters.get(name.removesuffix("_deg") + "_rad" if name.endswith("_deg") else name)
    if values is None or not _holds(gait, name):
        return np.full(len(gait.strides), np.nan)
    return np.rad2deg(values) if name.endswith("_deg") else values


def peak_percent(gait: SideGait, column: str) -> FloatArray:
    """When in each stride (k,) the peak of `column` comes, percent; NaN where there is none, or it may be mirrored."""
    window = WINDOWS[column]
    joint = next((joint for joint in gait.cycles if column.startswith(_kind(joint))), None)
    if joint is None or joint in gait.sign_in_doubt:
        return np.full(len(gait.strides), np.nan)
    return find_peak(gait.cycles[joint], window).percent


def used_cycles(gait: SideGait, joint: Joint) -> FloatArray:
    """The joint's angle over the strides used, (k, 101), radians; mirrored or not where the sign is in doubt."""
    return gait.cycles[joint][gait.strides.is_used]


def mean_of_used(gait: SideGait, joint: Joint) -> MeanCycle:
    """The joint's mean over the strides used, radians, NaN where it may be mirrored; and its spread."""
    found = mean_cycle(used_cycles(gait, joint)) if joint in gait.cycles else mean_cycle(np.empty((0, POINTS)))
    return replace(found, mean=np.full(POINTS, np.nan)) if joint in gait.sign_in_doubt else found


def _holds(gait: SideGait, name: str) -> bool:
    """Whether a column says something true: when a joint peaks needs no zero, how far it bends no sign either."""
    if name.endswith("_range_deg"):
        return True
    doubted = gait.sign_in_doubt | gait.without_zero if name.endswith("_deg") else gait.sign_in_doubt
    return not any(name.startswith(_kind(joint)) for joint in doubted)


def _kind(joint: Joint) -> str:
    return "knee_" if joint.is_knee else "ankle_"


def _strides(recording: RecordingAnalysis) -> Iterator[list[str]]:
    for side in Side:
        if side not in recording.gait:
            continue
        gait = recording.gait[side]
        columns = [getattr(gait.strides, name) for name in TIMES] + [parameter(gait, name) for name in PARAMETERS]
        for k, reason in enumerate(gait.strides.reason):
            used = "false" if reason else "true"
            yield [str(side), *(_cell(float(column[k])) for column in columns), used, str(reason)]


def _cycles(recording: RecordingAnalysis, joints: list[Joint]) -> Iterator[list[str]]:
    means = [mean_of_used(recording.gait[joint.side], joint) for joint in joints]
    for percent in range(POINTS if joints else 0):
        row = [str(percent)]
        for mean in means:
            row += [_cell(math.degrees(mean.mean[percent])), _cell(math.degrees(mean.sd[percent])), str(mean.n)]
        yield row


def _cell(value: float) -> str:
    return f"{value:.5f}" if math.isfinite(value) else ""
