"""Every example with a figure prints what is true of a simulated patient, and draws it."""

import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from core.body import LEG_JOINTS, LEG_SITES, Joint, Side
from devices.files.session_folder import write_session
from devices.simulation.walker import SimulatedSession
from tests.example_sessions import TWO_WALKS, up_and_go, write_own_arrays
from tests.examples import (
    angles_as_a_frame,
    axes_of_a_joint,
    compare_walks,
    error_statistics,
    export_tables,
    look_at_a_session,
    mean_cycle,
    own_sensor_positions,
    simulate_and_compare,
    timed_test,
)
from tests.simulated import analysis_of, simulation_of

ANALYSES = (
    angles_as_a_frame,
    axes_of_a_joint,
    compare_walks,
    export_tables,
    mean_cycle,
    simulate_and_compare,
    timed_test,
)


@pytest.fixture(scope="module")
def walked() -> SimulatedSession:
    return simulation_of(TWO_WALKS)


@pytest.fixture(scope="module")
def session(walked: SimulatedSession, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("figures") / "session"
    write_session(walked.session, folder)
    return folder


@pytest.fixture(autouse=True)
def _one_analysis(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the session that most of these read, and of the others until the code changes."""
    for example in ANALYSES:
        monkeypatch.setattr(example, "analyse", analysis_of)


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "figure.png"


def assert_drawn(path: Path) -> None:
    picture = imread(path)
    assert min(picture.shape[:2]) > 200
    is_ink = (picture[..., :3] < 0.9).any(axis=-1)
    assert 0.005 < is_ink.mean() < 0.9
    assert np.isfinite(picture).all()


def test_a_session_is_read_and_looked_at(session: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    look_at_a_session.main(session, out)
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in lines] == ["standing", "free motion", "slow", "fast"]
    assert all(", ".join(LEG_SITES) in line for line in lines)
    assert_drawn(out)


def test_angles_are_a_frame(session: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    angles_as_a_frame.main(session, out)
    printed = capsys.readouterr().out
    counts = {match[0]: int(match[1]) for match in re.findall(r"(\w+_deg) +\w+ +(\d+)", printed)}
    assert counts["knee_deg"] == counts["ankle_deg"] > 1000
    assert_drawn(out)


def test_the_mean_cycle_has_a_band(session: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mean_cycle.main(session, out)
    counts = {int(found) for found in re.findall(r": (\d+) strides", capsys.readouterr().out)}
    assert counts <= set(range(4, 9))
    assert_drawn(out)


def test_walks_are_compared(
    session: Path, walked: SimulatedSession, out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    compare_walks.main(session, out)
    printed = capsys.readouterr().out
    for name in ("slow", "fast"):
        (speed,) = re.findall(rf"^(?:speed_m_s)? *{name} +left +([\d.]+)", printed.partition("stride_length")[0], re.M)
        assert float(speed) == pytest.approx(walked.truth.recordings[name].speed_m_s, rel=0.06)
    assert_drawn(out)


def test_a_timed_test_has_its_parts(tmp_path: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_session(up_and_go(), tmp_path / "session")
    timed_test.main(tmp_path / "session", out)
    head, *parts = capsys.readouterr().out.splitlines()
    (whole_s,) = map(float, re.findall(r"([\d.]+) s", head))
    lengths_s = [float(re.findall(r"([\d.]+) s", part)[0]) for part in parts]
    assert len(parts) == 6
    assert sum(lengths_s) == pytest.approx(whole_s, abs=0.05)
    assert_drawn(out)


def test_the_axes_are_the_true_ones(
    session: Path, walked: SimulatedSession, out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    axes_of_a_joint.main(session, out)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(LEG_JOINTS)
    for line in lines:
        joint = Joint(line.partition(":")[0])
        values = [float(text) for text in re.findall(r"-?\d\.\d+|-?\d\.", line)[:6]]
        truth = walked.truth.recordings["slow"].joints[joint]
        for found, true in ((values[:3], truth.axis_proximal), (values[3:], truth.axis_distal)):
            apart_deg = np.rad2deg(np.arccos(min(1.0, abs(float(np.dot(found, true))))))
            assert apart_deg < 6.0
    assert_drawn(out)


def test_arrays_of_ones_own_become_a_session(
    walked: SimulatedSession, tmp_path: Path, out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_own_arrays(walked, tmp_path / "samples.npz")
    own_sensor_positions.main(tmp_path / "samples.npz", out)
    printed = capsys.readouterr().out
    assert re.search(r"knee_shape_deg +no_zero +[4-8]\n", f"{printed}\n")
    assert_drawn(out)


def test_a_simulated_patient_is_compared_with_the_truth(out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    simulate_and_compare.main(out)
    printed = capsys.readouterr().out
    errors = {joint: float(rms) for joint, rms in re.findall(r"(\w+): rms ([\d.]+) deg", printed)}
    assert errors.keys() == set(LEG_JOINTS)
    assert max(errors.values()) < 3.0
    assert max(errors[f"{side}_knee"] for side in Side) < 2.0
    assert_drawn(out)


@pytest.mark.endurance
def test_errors_over_people_have_a_mean_and_limits(out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    error_statistics.main(out, 5)
    for line in capsys.readouterr().out.splitlines():
        mean, low, high = (float(text) for text in re.findall(r"-?\d+\.\d+", line))
        assert low < mean < high
        assert high - low < 6.0
    assert_drawn(out)


def test_tables_are_exported_and_read_again(session: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    export_tables.main(session, tmp_path / "tables")
    assert set(capsys.readouterr().out.split()) == {"strides.csv", "angles.parquet", "cycles.png", "slow.nc", "fast.nc"}
    assert_drawn(tmp_path / "tables" / "cycles.png")
