"""How far a shank's sensor tilts in walking: by its accelerometer, by its gyroscope, and by the filter of both."""

import numpy as np
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation
from site_material import WALK, down, sensor

from core.body import Site
from core.samples import FloatArray
from devices.simulation.walker import Tissue

SITE = Site.LEFT_SHANK
BIAS_RAD_S = np.deg2rad(1.5)
MOST_DEG = 110.0


def draw(figure: Figure) -> None:
    one = sensor(Tissue.RIGID, WALK, SITE)
    upright = down(Tissue.RIGID, SITE)
    upright = upright / np.linalg.norm(upright)
    track = one.track
    up = one.earth_from_sensor[:, 2]
    axes = figure.subplots()
    by_force_deg = np.minimum(_tilt_deg(track.acc_m_s2, upright), MOST_DEG)
    axes.plot(track.time_s, by_force_deg, "C2", linewidth=0.8, label="accelerometer alone, up to 110°")
    drifting = _turned(track.gyr_rad_s + BIAS_RAD_S * np.array([1.0, 1.0, 1.0]) / np.sqrt(3), track.step_s, up[0])
    axes.plot(track.time_s, _tilt_deg(drifting, upright), "C1--", label="gyroscope alone, 1.5°/s off")
    axes.plot(track.time_s, _tilt_deg(up, upright), "C0", label="filter")
    axes.set(xlabel="time (s)", ylabel="tilt from standing (°)", ylim=(0.0, 140.0))
    axes.legend(loc="upper left", ncols=3)


def _tilt_deg(up: FloatArray, upright: FloatArray) -> FloatArray:
    cosine = up @ upright / np.linalg.norm(up, axis=1)
    return np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _turned(gyr_rad_s: FloatArray, step_s: float, start: FloatArray) -> FloatArray:
    """The vertical (n, 3) in sensor axes as rates alone carry it on."""
    up = np.empty_like(gyr_rad_s)
    up[0] = start
    for k, turn in enumerate(Rotation.from_rotvec(-step_s * gyr_rad_s[1:])):
        up[k + 1] = turn.apply(up[k])
    return up
