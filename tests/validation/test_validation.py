"""Tests that the public recordings and the paper's experiment reach their figures through `gaitwright agree`."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from core.body import LEG_JOINTS, Joint
from devices.files.references.reading import read_reference
from devices.files.session_folder import write_session
from devices.simulation.walker import Tissue, simulate
from tests.validation.__main__ import ACCURACY, EXPERIMENT, RECORDINGS, SIMULATED, WHY, agreed, row_of, with_table
from tests.validation.paper_experiment import FASTER, LATER_S, experiment, settings
from tests.validation.recordings_with_references import HINGES, feet, hinge

TestData = Callable[[str], Path]


@pytest.mark.parametrize("name", HINGES)
def test_a_mechanical_hinge_is_within_seven_tenths_of_a_degree(name: str, test_data: TestData, tmp_path: Path) -> None:
    data = test_data(f"hinge_mechanical/{name}.npz").parents[1]
    one = hinge(data, tmp_path, name)
    row = row_of(agreed(one.session, one.references, tmp_path / "out"), "hinge", "left_knee")
    assert row["m_rmse_deg"] < 0.7
    assert row["within_2_sd"] >= 0.9
    assert row["z_rmse_deg"] is None  # nobody stood
    assert 80 < abs(row["clock_rate_ppm"]) < 170
    assert -0.9 / 50 < row["offset_s"] < -0.7 / 50 + 0.0005  # the sensors lag by 0.7 to 0.9 sample


def test_all_events_of_a_walk_are_found_and_strides_are_as_long(test_data: TestData, tmp_path: Path) -> None:
    data = test_data("feet_mocap_events/healthy_feet.npz").parents[1]
    one = feet(data, tmp_path)
    found = agreed(one.session, one.references, tmp_path / "out")
    for kind in ("initial_contact", "toe_off"):
        events = found["events"][kind]
        assert (events["found"], events["in_reference"]) == (57, 57)
        assert events["sd_s"] < 0.010
    assert abs(found["stride_length"]["bias_percent"]) < 1.0
    assert found["stride_length"]["sd_m"] < 0.03
    assert found["stride_length"]["strides"] >= 50


@pytest.mark.endurance
def test_the_papers_experiment_has_the_pattern_of_table_1(tmp_path: Path) -> None:
    session, optics = experiment(1, tmp_path, walks=2)
    write_session(session, tmp_path / "session")
    found = agreed(tmp_path / "session", [optics], tmp_path / "out")
    m_deg = {joint: row_of(found, "over walks", joint)["m_rmse_deg"] for joint in LEG_JOINTS}
    assert m_deg[Joint.LEFT_KNEE] < 1.0
    assert m_deg[Joint.LEFT_ANKLE] < 1.0
    assert 2.0 < m_deg[Joint.RIGHT_KNEE] < 5.0
    assert 1.0 < m_deg[Joint.RIGHT_ANKLE] < m_deg[Joint.RIGHT_KNEE]
    for number, walk in ((2, "walk 1"), (3, "walk 2")):
        row = row_of(found, walk, Joint.LEFT_KNEE)
        assert row["clock_rate_ppm"] == pytest.approx(1e6 * FASTER, abs=max(60.0, 3 * row["clock_rate_sd_ppm"]))
        assert row["offset_s"] == pytest.approx(LATER_S * number, abs=0.008)


@pytest.mark.endurance
def test_without_skin_the_optical_system_sees_the_bones(tmp_path: Path) -> None:
    _, path = experiment(2, tmp_path, Tissue.RIGID, walks=1)
    truth = simulate(settings(2, Tissue.RIGID, walks=1)).truth.recordings["walk 1"]
    (trial,) = read_reference(path).trials
    for joint, (shown_s, angle_rad) in trial.angles.items():
        at_s = (shown_s - 2 * LATER_S) / (1 + FASTER)
        reported = truth.joints[joint]
        error = angle_rad - np.interp(at_s, reported.time_s, reported.angle_rad)
        assert np.rad2deg(np.abs(np.median(error))) < 0.5  # the ankle turns beside its axis, too
        assert np.rad2deg(np.std(error)) < (0.2 if joint.is_knee else 0.4)


def test_a_table_takes_the_place_of_the_one_under_its_heading_alone() -> None:
    page = "# A\n## B\ntext\n\n| old |\n|---|\n| 1 |\n\nmore\n## C\n\n| kept |\n|---|\n"
    assert with_table(page, "## B", ["| new |", "|---|", "| 2 |"]) == page.replace("old", "new").replace("1", "2")
    with pytest.raises(ValueError, match="there is no '## D'"):
        with_table(page, "## D", ["| new |"])


def test_the_pages_have_a_table_under_each_heading_that_the_command_fills() -> None:
    for place, title in ((ACCURACY, RECORDINGS), (SIMULATED, EXPERIMENT), (SIMULATED, WHY)):
        after = place.read_text(encoding="utf-8").partition(f"{title}\n")[2].partition("\n## ")[0]
        assert "| - | - |" not in after
        assert after.count("\n|") >= 4
