"""A simulated session, and references made of its truth."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from core.body import LEG_JOINTS, Joint
from devices.simulation.walker import FreeMotion, SessionTruth, Standing, Walk, WalkerSettings
from tests.simulated import simulation_of

SETTINGS = WalkerSettings(
    seed=3,
    recordings=(Standing(), FreeMotion(), Walk("walk 1", strides=6), Walk("walk 2", strides=6, speed_m_s=1.05)),
)
PPM = 150e-6


def made() -> tuple[object, SessionTruth]:
    simulated = simulation_of(SETTINGS)
    return simulated.session, simulated.truth


def rows_of(
    truth: SessionTruth,
    walk: str,
    joints: Sequence[Joint] = LEG_JOINTS,
    later_s: float = 7.3,
    turned: Sequence[Joint] = (),
    hz: float = 120.0,
) -> list[str]:
    """Times and angles in degrees as an optical system would have them, whose clock is late and runs fast."""
    reported = truth.recordings[walk].joints
    own_s = reported[joints[0]].time_s
    at_s = np.arange(own_s[0] + 0.2, own_s[-1] - 0.2, 1 / hz)
    columns = [
        np.rad2deg(np.interp(at_s, reported[joint].time_s, reported[joint].angle_rad)) * (-1 if joint in turned else 1)
        for joint in joints
    ]
    rows = zip(at_s * (1 + PPM) + later_s, *columns, strict=True)
    return [",".join(f"{value:.6f}" for value in row) for row in rows]


def write_reference(path: Path, rows: Sequence[str], joints: Sequence[Joint] = LEG_JOINTS, first: str = "") -> Path:
    path.write_text("\n".join([f"{first}time_s,{','.join(joints)}", *rows, ""]), encoding="utf-8")
    return path
