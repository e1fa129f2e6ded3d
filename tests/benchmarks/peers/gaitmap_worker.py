"""Report what gaitmap makes of two feet. Run by the peers' Python: one line of JSON in, one line of JSON out.

gaitmap and gaitmap_mad (Kuderle et al. 2024, doi 10.1109/OJEMB.2024.3356791) with default settings throughout. The
question names an archive of both feet in gaitmap's sensor frame, or in any where the heading is to be aligned too, and
a second archive to write; the answer reports the CPU seconds of every stage and the versions. Keys are joined by "|".
"""

import json
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

import numpy as np
import pandas as pd
from gaitmap.event_detection import HerzerEventDetection, RamppEventDetection
from gaitmap.parameters import SpatialParameterCalculation, TemporalParameterCalculation
from gaitmap.preprocessing.sensor_alignment import (
    ForwardDirectionSignAlignment,
    PcaAlignment,
    align_dataset_to_gravity,
)
from gaitmap.stride_segmentation import BarthDtw, ConstrainedBarthDtw
from gaitmap.trajectory_reconstruction import (
    ForwardBackwardIntegration,
    MadgwickAHRS,
    RegionLevelTrajectory,
    RtsKalman,
    StrideLevelTrajectory,
)
from gaitmap.utils.coordinate_conversion import convert_to_fbf

SIDES = ("left", "right")
AXES = ["acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z"]
SEGMENTATIONS = {"BarthDtw": BarthDtw(), "ConstrainedBarthDtw": ConstrainedBarthDtw()}
DETECTORS = {"Rampp": RamppEventDetection(), "Herzer": HerzerEventDetection()}
TRAJECTORIES = {
    "stride, gyroscope": StrideLevelTrajectory(),
    "stride, Madgwick": StrideLevelTrajectory(ori_method=MadgwickAHRS(), pos_method=ForwardBackwardIntegration()),
    "stride, RtsKalman": StrideLevelTrajectory(trajectory_method=RtsKalman()),
    "region, RtsKalman": RegionLevelTrajectory(trajectory_method=RtsKalman()),
}

Feet = dict[str, pd.DataFrame]


class Run:
    """One question: what was found, and what each stage took."""

    def __init__(self, archive: str) -> None:
        self.found: dict[str, Any] = {}
        self.cpu_s: dict[str, float] = {}
        with np.load(archive) as arrays:
            self._reported = dict(arrays)
        self._rate_hz = float(self._reported["rate_hz"])

    def alone(self, alignments: list[str]) -> None:
        """Everything, with every alignment that is asked for."""
        columns = {s: [self._reported[f"{s}_acc_m_s2"], np.rad2deg(self._reported[f"{s}_gyr_rad_s"])] for s in SIDES}
        mounted = {f"{s}_sensor": pd.DataFrame(np.hstack(columns[s]), columns=AXES) for s in SIDES}
        gravity = self._timed("gravity", align_dataset_to_gravity, mounted, self._rate_hz)
        if "gravity" in alignments:
            self._analyse("gravity", gravity)
        if "heading" in alignments:
            self._analyse("heading", self._timed("heading", self._with_heading, gravity))

    def _with_heading(self, feet: Feet) -> Feet:
        turned = PcaAlignment(target_axis="y", pca_plane_axis=("gyr_x", "gyr_y")).align(feet).aligned_data_
        return ForwardDirectionSignAlignment().align(turned, sampling_rate_hz=self._rate_hz).aligned_data_

    def _analyse(self, alignment: str, feet: Feet) -> None:
        body = self._timed(f"{alignment}|body", convert_to_fbf, feet, left_like="left_", right_like="right_")
        borders = {}
        for name, method in SEGMENTATIONS.items():
            cut = self._timed(f"{alignment}|{name}", method.clone().segment, body, self._rate_hz)
            borders[name] = cut.stride_list_
        if "left_borders" in self._reported:
            borders["by hand"] = self._listed("borders", ["s_id", "start", "end"])
        for name, cuts in borders.items():
            for detector, method in DETECTORS.items():
                key = f"{alignment}|{name}|{detector}"
                done = self._timed(key, method.clone().detect, body, cuts, sampling_rate_hz=self._rate_hz)
                for side in SIDES:
                    events = done.annotated_original_event_list_[f"{side}_sensor"]
                    self.found[f"events|{key}|{side}"] = events[["ic", "tc"]].to_numpy(dtype=float)
                if detector == "Rampp":
                    self._reconstruct(f"{alignment}|{name}", feet, done.min_vel_event_list_)
        if "left_stances" in self._reported:
            stances = self._listed("stances", ["s_id", "start", "end", "ic", "tc", "min_vel", "pre_ic"])
            self._reconstruct(f"{alignment}|optical stances", feet, stances)

    def _reconstruct(self, origin: str, feet: Feet, strides: Feet) -> None:
        strides = {foot: rows.reset_index().astype({"start": int, "end": int}) for foot, rows in strides.items()}
        for name, method in TRAJECTORIES.items():
            key = f"{origin}|{name}"
            done = self._timed(key, self._trajectory, method.clone(), feet, strides)
            reported = self._timed(f"{key}|parameters", self._parameters, strides, done)
            for side in SIDES:
                foot = f"{side}_sensor"
                rows, turned = strides[foot].set_index("s_id"), done.orientation_[foot]
                each = turned.groupby(level="s_id", sort=False)
                here = list(each.indices)
                self.found[f"strides|{key}|{side}|contact"] = rows.loc[here, "ic"].to_numpy(dtype=float)
                self.found[f"strides|{key}|{side}|length_m"] = (
                    reported.loc[foot].loc[here, "stride_length"].to_numpy(float)
                )
                self.found[f"strides|{key}|{side}|start"] = rows.loc[here, "start"].to_numpy(dtype=float)
                self.found[f"strides|{key}|{side}|count"] = each.size().loc[here].to_numpy()
                self.found[f"strides|{key}|{side}|q_xyzw"] = turned[["q_x", "q_y", "q_z", "q_w"]].to_numpy()

    def _trajectory(self, method: Any, feet: Feet, strides: Feet) -> Any:
        if isinstance(method, StrideLevelTrajectory):
            return method.estimate(feet, strides, sampling_rate_hz=self._rate_hz)
        whole = {foot: pd.DataFrame({"roi_id": [0], "start": [0], "end": [len(feet[foot]) - 1]}) for foot in feet}
        return method.estimate_intersect(
            feet, stride_event_list=strides, regions_of_interest=whole, sampling_rate_hz=self._rate_hz
        )

    def _parameters(self, strides: Feet, done: Any) -> pd.DataFrame:
        TemporalParameterCalculation().calculate(strides, sampling_rate_hz=self._rate_hz)
        reported = SpatialParameterCalculation().calculate(strides, done.position_, done.orientation_, self._rate_hz)
        return pd.concat(reported.parameters_)

    def _listed(self, name: str, columns: list[str]) -> Feet:
        rows = {f"{s}_sensor": pd.DataFrame(self._reported[f"{s}_{name}"], columns=columns) for s in SIDES}
        return {foot: row.astype({"s_id": int, "start": int, "end": int}) for foot, row in rows.items()}

    def _timed(self, name: str, work: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
        start_s = time.process_time()
        done = work(*arguments, **options)
        self.cpu_s[name] = time.process_time() - start_s
        return done


for line in sys.stdin:
    question = json.loads(line)
    run = Run(question["archive"])
    run.alone(question["alignments"])
    np.savez(question["answer"], **run.found)
    versions = {name: version(name) for name in ("gaitmap", "gaitmap_mad", "numpy", "numba", "pandas")}
    print(json.dumps({"cpu_s": run.cpu_s, "versions": versions}), flush=True)
