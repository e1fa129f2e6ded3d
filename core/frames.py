"""Results as tables of other libraries: a tidy pandas DataFrame, and an xarray Dataset of one recording.

Both libraries are imported when a table is asked for, and by nothing else in `core`. Values, gaps and status are those
of the files: angles.csv, cycles.csv and strides.csv.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from core.body import Joint, Side
from core.gait.cycles import POINTS, MeanCycle
from core.results import Analysis, RecordingAnalysis
from core.samples import FloatArray, IntArray
from core.verdicts.quantities import (
    OF_HIPS,
    PARAMETERS,
    abduction_curve,
    assessment_of,
    mean_curve,
    values_of,
)
from core.verdicts.status import NOT_REPORTED, is_slipped, joint_status

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

ABDUCTION = "hip_abduction_peak_deg"  # the figure that decides whether a hip's abduction is reported


class FrameTable(StrEnum):
    """What a table holds: each sample's angles, the mean gait cycles, or a line for each stride's figure."""

    ANGLES = "angles"
    CYCLES = "cycles"
    STRIDES = "strides"


@dataclass(frozen=True, slots=True)
class _FramedCurve:
    """One quantity over a recording or a gait cycle; `side` is empty for the pelvis. All arrays (n,)."""

    side: str
    quantity: str
    value: FloatArray
    sd: FloatArray
    status: Sequence[str]
    n: int = 0


def to_dataframe(analysis: Analysis, table: str) -> "pd.DataFrame":
    """Give one table of all recordings; see `Analysis.to_dataframe`."""
    pandas, kind = _library("pandas"), FrameTable(table)
    if kind is FrameTable.STRIDES:
        parts = [pandas.DataFrame(one) for recording in analysis.recordings for one in _strides(recording)]
        return pandas.concat(parts or [pandas.DataFrame(columns=STRIDE_COLUMNS)], ignore_index=True)
    at = "time_s" if kind is FrameTable.ANGLES else "percent"
    columns = ["recording", "side", at, "quantity", "value", "sd", "status", *(["n"] if at == "percent" else [])]
    parts = []
    for recording in analysis.recordings:
        places = _places(recording, kind)
        for curve in _curves(recording, kind):
            of_all = {"recording": recording.name, "side": curve.side, "quantity": curve.quantity, "n": curve.n}
            rows = {at: places, "value": curve.value, "sd": curve.sd, "status": curve.status}
            parts.append(pandas.DataFrame({**rows, **of_all})[columns])
    return pandas.concat(parts or [pandas.DataFrame(columns=columns)], ignore_index=True)


def to_xarray(analysis: Analysis, recording: str, table: str) -> "xr.Dataset":
    """Give angles or cycles of one recording; see `Analysis.to_xarray`."""
    xarray, kind = _library("xarray"), FrameTable(table)
    if kind is FrameTable.STRIDES:
        raise ValueError("strides have no common axis: take to_dataframe")
    one = next((one for one in analysis.recordings if one.name == recording), None)
    if one is None:
        raise KeyError(recording)
    curves, places = list(_curves(one, kind)), _places(one, kind)
    sides = list(dict.fromkeys(curve.side for curve in curves))
    quantities = list(dict.fromkeys(curve.quantity for curve in curves))
    shape = (len(quantities), len(sides), len(places))
    value, sd, status = np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, "", dtype=object)
    n = np.zeros(shape[:2], dtype=int)
    for curve in curves:
        place = quantities.index(curve.quantity), sides.index(curve.side)
        value[place], sd[place], status[place], n[place] = curve.value, curve.sd, curve.status, curve.n
    at = "time_s" if kind is FrameTable.ANGLES else "percent"
    dims = ("quantity", "side", at)
    found = {"value": (dims, value), "sd": (dims, sd), "status": (dims, status.astype(str))}
    counts = {"n": (dims[:2], n)} if kind is FrameTable.CYCLES else {}
    return xarray.Dataset({**found, **counts}, dict(zip(dims, (quantities, sides, places), strict=True)))


def _library(name: str) -> ModuleType:
    try:
        return import_module(name)
    except ImportError as problem:
        raise ImportError(f"{name} is not installed. Install it with: pip install gaitwright-core[frames]") from problem


def _places(recording: RecordingAnalysis, kind: FrameTable) -> FloatArray | IntArray:
    return recording.time_s if kind is FrameTable.ANGLES else np.arange(POINTS)


def _curves(recording: RecordingAnalysis, kind: FrameTable) -> Iterator[_FramedCurve]:
    return _angles(recording) if kind is FrameTable.ANGLES else _cycles(recording)


def _angles(recording: RecordingAnalysis) -> Iterator[_FramedCurve]:
    unknown = np.full(len(recording.time_s), np.nan)
    for joint, found in recording.joints.items():
        status = _until_slipped(recording, joint, joint_status(recording, joint))
        orientation = unknown if found.orientation_rad is None else np.rad2deg(found.orientation_rad)
        kind, side, sd = joint.kind, str(joint.side), np.rad2deg(found.sd_rad)
        yield _FramedCurve(side, f"{kind}_deg", np.rad2deg(found.angle_rad), sd, status)
        yield _FramedCurve(side, f"{kind}_published_deg", np.rad2deg(found.published_rad), unknown, status)
        yield _FramedCurve(side, f"{kind}_orientation_deg", orientation, unknown, status)
    for joint, hip in sorted(recording.hips.items()):
        status = _until_slipped(recording, joint, joint_status(recording, joint))
        yield _FramedCurve(str(joint.side), "hip_deg", np.rad2deg(hip.angle_rad), np.rad2deg(hip.sd_rad), status)
        stated = str(assessment_of(recording.verdicts, joint.side, ABDUCTION).verdict)
        status = _until_slipped(recording, joint, stated)
        yield _FramedCurve(str(joint.side), "hip_abduction_deg", np.rad2deg(hip.abduction_rad), unknown, status)
    if recording.pelvis is not None:
        words = [str(recording.verdicts.pelvis.verdict)] * len(unknown)
        for name in ("tilt", "obliquity", "rotation"):
            angle_rad = getattr(recording.pelvis, f"{name}_rad")
            yield _FramedCurve("", f"pelvis_{name}_deg", np.rad2deg(angle_rad), unknown, words)


def _until_slipped(recording: RecordingAnalysis, joint: Joint, word: str) -> list[str]:
    return list(np.where(is_slipped(recording, joint.side), NOT_REPORTED, word))


def _cycles(recording: RecordingAnalysis) -> Iterator[_FramedCurve]:
    unknown = np.full(POINTS, np.nan)
    for joint in Joint:
        if joint.side not in recording.gait or joint not in recording.gait[joint.side].cycles:
            continue
        found, side, kind = mean_curve(recording, joint), str(joint.side), joint.kind
        words = [joint_status(recording, joint)] * POINTS
        mean, sd = np.rad2deg(found.mean), np.rad2deg(found.sd)
        height = mean if recording.verdicts.joint(joint).height.is_reported else unknown
        yield _FramedCurve(side, f"{kind}_deg", height, sd, words, found.n)
        yield _FramedCurve(side, f"{kind}_shape_deg", mean - mean.mean(), sd, words, found.n)
        if joint.is_hip:
            yield _abduction(recording, joint.side, abduction_curve(recording, joint.side))


def _abduction(recording: RecordingAnalysis, side: Side, found: MeanCycle) -> _FramedCurve:
    words = [str(assessment_of(recording.verdicts, side, ABDUCTION).verdict)] * POINTS
    return _FramedCurve(str(side), "hip_abduction_deg", np.rad2deg(found.mean), np.rad2deg(found.sd), words, found.n)


STRIDE_COLUMNS = ["recording", "side", "time_s", "quantity", "value", "sd", "status", "used", "reason"]


def _strides(recording: RecordingAnalysis) -> Iterator[dict[str, object]]:
    """The columns of each figure; of a single stride there is no sd."""
    for side, gait in recording.gait.items():
        strides = gait.strides
        reasons = [str(reason) for reason in strides.reason]
        for name in (*PARAMETERS, *(OF_HIPS if recording.pelvis is not None else ())):
            stated = str(assessment_of(recording.verdicts, side, name).verdict)
            of_all = (recording.name, str(side), strides.start_s, name, values_of(recording, side, name), np.nan)
            yield dict(zip(STRIDE_COLUMNS, (*of_all, stated, strides.is_used, reasons), strict=True))
