"""A motion file has the names, signs and limits of the model that its head names."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.exports.opensim_motion import Model, write_motion
from core.body import Joint
from core.results import RecordingAnalysis
from core.samples import FloatArray
from devices.files.references.reading import read_reference
from tests.app.exports.test_parts import table_of

KNEE, ANKLE = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
# what both models' files give, in degrees, written out here
RANGES = {
    Model.RAJAGOPAL2016: {"knee_angle_l": (0.0, 120.0), "ankle_angle_l": (-40.0, 30.0)},
    Model.GAIT2392: {"knee_angle_l": (-120.0, 10.0), "ankle_angle_l": (-90.0, 90.0)},
}


def bent(walk: RecordingAnalysis, knee_deg: FloatArray, ankle_deg: FloatArray) -> RecordingAnalysis:
    joints = {
        joint: replace(walk.joints[joint], angle_rad=np.deg2rad(np.resize(values, len(walk.time_s))))
        for joint, values in ((KNEE, knee_deg), (ANKLE, ankle_deg))
    }
    return replace(walk, joints=joints)


@pytest.mark.parametrize("model", Model)
def test_what_a_model_cannot_take_is_kept_at_its_limit_and_stated(
    walk: RecordingAnalysis, tmp_path: Path, model: Model
) -> None:
    """Somebody whose knee goes 14 degrees beyond straight, and who squats."""
    knee_deg, ankle_deg = np.array([-14.0, 5.0, 131.5, 60.0]), np.array([-48.0, 0.0, 33.0, 10.0])
    write_motion(bent(walk, knee_deg, ankle_deg), False, tmp_path / "angles.mot", model)
    head, table = table_of(tmp_path / "angles.mot")
    names = (tmp_path / "angles.mot").read_text().split("endheader\n")[1].splitlines()[0].split("\t")
    sign = -1.0 if model is Model.GAIT2392 else 1.0
    for name, asked_deg in (("knee_angle_l", sign * knee_deg), ("ankle_angle_l", ankle_deg)):
        low, high = RANGES[model][name]
        expected_deg = np.resize(np.clip(asked_deg, low, high), len(table))
        np.testing.assert_allclose(table[:, names.index(name)], expected_deg, atol=1e-5)
        for limit, beyond in ((low, low - asked_deg), (high, asked_deg - high)):
            line = f"Kept at the model's limit of {limit:g} deg: {name}, "
            assert (line in head) == bool((beyond > 0).any())
            if line in head:
                count = int(np.count_nonzero(np.resize(beyond > 0, len(table))))
                assert f"{line}{count} rows, up to {beyond.max():.1f} deg beyond.\n" in head


@pytest.mark.parametrize(
    ("model", "named"), [(Model.RAJAGOPAL2016, "Rajagopal2016.osim"), (Model.GAIT2392, "gait2392")]
)
def test_the_head_names_the_model_and_what_is_positive(
    walk: RecordingAnalysis, tmp_path: Path, model: Model, named: str
) -> None:
    write_motion(walk, False, tmp_path / "angles.mot", model)
    head, _ = table_of(tmp_path / "angles.mot")
    (line,) = (line for line in head.splitlines() if line.startswith("For models with the coordinates of "))
    assert named in line
    assert ("knee flexion is negative" in line) == (model is Model.GAIT2392)
    assert line.endswith("ankle dorsiflexion positive.")


def test_a_walk_within_all_limits_is_kept_at_none(walk: RecordingAnalysis, tmp_path: Path) -> None:
    write_motion(bent(walk, np.array([0.0, 120.0]), np.array([-40.0, 30.0])), False, tmp_path / "angles.mot")
    assert "limit" not in table_of(tmp_path / "angles.mot")[0]


@pytest.mark.parametrize("model", Model)
def test_our_reader_of_references_gives_the_same_figures_back(
    walk: RecordingAnalysis, tmp_path: Path, model: Model
) -> None:
    """Of gait2392 with its own sign: `agree` finds signs itself."""
    write_motion(walk, False, tmp_path / "angles.mot", model)
    (trial,) = read_reference(tmp_path / "angles.mot").trials
    assert set(trial.angles) == set(walk.joints)
    for joint, (time_s, angle_rad) in trial.angles.items():
        np.testing.assert_array_equal(time_s, walk.time_s)
        known = walk.joints[joint].angle_rad
        known = -known if model is Model.GAIT2392 and joint.is_knee else known
        if model is Model.RAJAGOPAL2016 and joint.is_knee:
            known = np.maximum(known, 0.0)
        np.testing.assert_allclose(angle_rad, known, atol=np.deg2rad(0.00001))
