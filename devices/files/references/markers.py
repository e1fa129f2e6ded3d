"""Knee flexion and ankle dorsiflexion from markers of hip, knee, ankle, heel and toe, in the plane of walking.

The plane holds the vertical and the mean direction of the feet, so it is right for straight walks only. Zero is where
thigh and shank lie in line, and where the shank is upright on a level line from heel to toe.
"""

import re
from collections.abc import Mapping
from enum import StrEnum

import numpy as np

from core.body import Joint, Side, ankle_of, knee_of
from core.samples import FloatArray


class Landmark(StrEnum):
    """Where a marker sits."""

    HIP = "hip"
    KNEE = "knee"
    ANKLE = "ankle"
    HEEL = "heel"
    TOE = "toe"


NAMES = {
    Landmark.HIP: ("HIP", "HJC", "GTR", "TRO", "TROC", "TROCHANTER"),
    Landmark.KNEE: ("KNE", "KNEE", "KJC", "LFC", "LEP"),
    Landmark.ANKLE: ("ANK", "ANKLE", "AJC", "LM", "LMAL"),
    Landmark.HEEL: ("HEE", "HEEL", "CAL"),
    Landmark.TOE: ("TOE", "MT2", "TOES"),
}

Markers = Mapping[tuple[Side, Landmark], FloatArray]


def landmark_of(label: str) -> tuple[Side, Landmark] | None:
    """The landmark that a marker's label names: LKNE, subject:RToe, L_ANK, R.Heel, left knee."""
    plain = re.sub(r"[\W_]+", "", label.split(":")[-1]).upper()
    found = re.fullmatch(r"(LEFT|RIGHT|L|R)(\w+?)|(\w+?)(LEFT|RIGHT)", plain)
    if found is None:
        return None
    side, name = (found[1], found[2]) if found[1] else (found[4], found[3])
    for landmark, names in NAMES.items():
        if name in names:
            return (Side.LEFT if side.startswith("L") else Side.RIGHT), landmark
    return None


def angles_of_markers(markers: Markers) -> dict[Joint, FloatArray]:
    """Compute the angles (n,), rad, of joints whose markers (n, 3) are all there; NaN where one is not seen."""
    angles: dict[Joint, FloatArray] = {}
    up = _vertical(markers)
    if up is None:
        return angles
    forward = _forward(markers, up)
    if forward is None:
        return angles
    for side in Side:
        hip, knee, ankle, heel, toe = (markers.get((side, landmark)) for landmark in Landmark)
        if knee is None or ankle is None:
            continue
        shank = _swung(ankle - knee, forward, -up)
        if hip is not None:
            angles[knee_of(side)] = _wrapped(_swung(knee - hip, forward, -up) - shank)
        if heel is not None and toe is not None:
            angles[ankle_of(side)] = _wrapped(_swung(toe - heel, up, forward) - shank)
    return angles


def _vertical(markers: Markers) -> FloatArray | None:
    """The axis of the laboratory that legs stand along, (3,)."""
    pairs = ((Landmark.HIP, Landmark.ANKLE), (Landmark.KNEE, Landmark.ANKLE), (Landmark.KNEE, Landmark.HEEL))
    for upper, lower in pairs:
        legs = [markers[s, upper] - markers[s, lower] for s in Side if (s, upper) in markers and (s, lower) in markers]
        if legs and np.isfinite(np.concatenate(legs)).all(axis=1).any():
            mean = np.nanmean(np.concatenate(legs), axis=0)
            axis = int(np.argmax(np.abs(mean)))
            return np.eye(3)[axis] * np.sign(mean[axis])
    return None


def _forward(markers: Markers, up: FloatArray) -> FloatArray | None:
    """The level direction of the feet, else of the way of the ankles (3,); None where neither shows one."""
    feet = [
        markers[side, Landmark.TOE] - markers[side, Landmark.HEEL]
        for side in Side
        if (side, Landmark.TOE) in markers and (side, Landmark.HEEL) in markers
    ]
    ways = [np.diff(markers[side, Landmark.ANKLE], axis=0) for side in Side if (side, Landmark.ANKLE) in markers]
    for vectors in (feet, ways):
        level = [vector - np.outer(vector @ up, up) for vector in vectors]
        if level and np.isfinite(np.concatenate(level)).all(axis=1).any():
            mean = np.nanmean(np.concatenate(level), axis=0)
            if np.linalg.norm(mean) > 0:
                return np.asarray(mean / np.linalg.norm(mean))
    return None


def _swung(vectors: FloatArray, towards: FloatArray, origin: FloatArray) -> FloatArray:
    """Angles (n,) of vectors (n, 3) from `origin` to `towards`, unit vectors at right angles."""
    return np.asarray(np.arctan2(vectors @ towards, vectors @ origin))


def _wrapped(angle_rad: FloatArray) -> FloatArray:
    return np.asarray(np.angle(np.exp(1j * angle_rad)))
