"""Tests that an analysis without the package of VQF is the one with it."""

import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from core.body import LEG_SITES, Side
from core.signal.filters import FILTER
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.simulated import analysis_of, session_of

ROOT = Path(__file__).parents[3]
LEFT = tuple(site for site in LEG_SITES if site.side is Side.LEFT)
SETTINGS = WalkerSettings(seed=1, sites=LEFT, recordings=(Standing(), FreeMotion(duration_s=6.0), Walk(strides=5)))
WITHOUT = """
import pickle, sys
sys.modules["vqf"] = None  # importing it raises, as where it is not installed
from core.analysis import analyse
from core.signal.filters import FILTER
from app.storage.kept_analyses import algorithm
with open(sys.argv[1], "rb") as file:
    found = analyse(pickle.load(file))
print(pickle.dumps((FILTER, algorithm(), found)).hex())
"""


def test_an_analysis_without_the_package_is_the_same_and_names_its_filter(tmp_path: Path) -> None:
    """To a millionth of a degree, and by another name: what is kept of one is not taken for the other's."""
    session = session_of(SETTINGS)
    (tmp_path / "session").write_bytes(pickle.dumps(session))
    program = [sys.executable, "-c", WITHOUT, str(tmp_path / "session")]
    ran = subprocess.run(program, cwd=ROOT, capture_output=True, text=True, check=True)
    name, algorithm, found = pickle.loads(bytes.fromhex(ran.stdout))
    assert name == "vqf own port"
    assert f", {name}, core " in algorithm
    if name == FILTER:
        pytest.skip("vqf has no wheel here: there is nothing to compare with")
    usual = analysis_of(session)
    assert [one.key for one in found.findings] == [one.key for one in usual.findings]
    for one, other in zip(found.recordings, usual.recordings, strict=True):
        assert one.joints.keys() == other.joints.keys() != set()
        for joint, curve in one.joints.items():
            np.testing.assert_allclose(
                np.rad2deg(curve.angle_rad), np.rad2deg(other.joints[joint].angle_rad), rtol=0.0, atol=1e-6
            )
