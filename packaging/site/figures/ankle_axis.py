"""The ankle's axis in the shank that a walk alone shows, its knee's, and their middle, beside the true one."""

import numpy as np
from matplotlib.figure import Figure
from site_material import ANKLE, KNEE, WALK, analysis_of, down, moving, session_of

from core.body import Site
from core.calibration.identify import decide
from core.samples import FloatArray
from devices.simulation.walker import Tissue


def draw(figure: Figure) -> None:
    joints = analysis_of(Tissue.REAL, is_walk_alone=True).calibrations[-1].joints
    shank, foot = (down(Tissue.REAL, site) for site in (Site.LEFT_SHANK, Site.LEFT_FOOT))
    truth = session_of(Tissue.REAL).truth.recordings[WALK].joints[ANKLE].functional_proximal
    own = decide(moving(Tissue.REAL, WALK, ANKLE), (shank, foot)).best.axis_1[0]
    across = shank - truth * (shank @ truth)
    across = across / np.linalg.norm(across)
    frame = np.stack([np.cross(truth, across), across], axis=1)
    axes = figure.subplots()
    marks = {
        "by the ankle's motion": (own, "o"),
        "the knee's axis": (joints[KNEE].axis_distal, "s"),
        "their middle, used": (joints[ANKLE].axis_proximal, "D"),
        "true": (truth, "+"),
    }
    for number, (label, (axis, mark)) in enumerate(marks.items()):
        x_deg, y_deg = _apart_deg(axis * np.sign(axis @ truth), truth, frame)
        axes.plot(x_deg, y_deg, mark, color=f"C{min(number, 2)}", markersize=10, label=label)
    axes.set(xlabel="turned about the vertical (°)", ylabel="tilted (°)", aspect="equal")
    axes.margins(0.25)
    axes.legend(loc="center left", bbox_to_anchor=(1.05, 0.5))


def _apart_deg(axis: FloatArray, truth: FloatArray, frame: FloatArray) -> FloatArray:
    angle = np.arccos(np.clip(axis @ truth, -1.0, 1.0))
    flat = axis @ frame
    return np.rad2deg(angle * flat / max(float(np.linalg.norm(flat)), 1e-12))
