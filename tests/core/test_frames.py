"""Tests for tables of results: their columns and axes, and the refusal where a library is missing."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.body import Joint
from core.results import Analysis, JointAngle
from tests.simulated import SHORT_WALK, analysis_of, session_of

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def found() -> Analysis:
    return analysis_of(session_of(SHORT_WALK))


def test_each_table_has_its_columns_also_without_a_recording(found: Analysis) -> None:
    columns = {
        "angles": ["recording", "side", "time_s", "quantity", "value", "sd", "status"],
        "cycles": ["recording", "side", "percent", "quantity", "value", "sd", "status", "n"],
        "strides": ["recording", "side", "time_s", "quantity", "value", "sd", "status", "used", "reason"],
    }
    empty = replace(found, recordings=())
    for table, names in columns.items():
        assert list(found.to_dataframe(table).columns) == names
        assert list(empty.to_dataframe(table).columns) == names
        assert len(empty.to_dataframe(table)) == 0
    assert found.to_dataframe().equals(found.to_dataframe("angles"))


def test_an_array_has_the_frames_values_by_quantity_side_and_place(found: Analysis) -> None:
    for table, at in (("angles", "time_s"), ("cycles", "percent")):
        frame, dataset = found.to_dataframe(table), found.to_xarray("walk 1", table)
        assert dict(dataset.sizes)["side"] == 2
        for (side, quantity), rows in frame[frame["recording"] == "walk 1"].groupby(["side", "quantity"]):
            one = dataset.sel(side=side, quantity=quantity)
            np.testing.assert_array_equal(one["value"], rows["value"])
            np.testing.assert_array_equal(one["sd"], rows["sd"])
            np.testing.assert_array_equal(one[at], rows[at])
            assert list(one["status"].to_numpy()) == list(rows["status"])
            if table == "cycles":
                assert set(rows["n"]) == {int(one["n"])}


def test_what_a_side_does_not_have_is_missing_in_an_array_without_a_status(found: Analysis) -> None:
    walk = found.recordings[-1]
    one_knee: dict[Joint, JointAngle] = {
        joint: angle for joint, angle in walk.joints.items() if joint is not Joint.RIGHT_KNEE
    }
    dataset = replace(found, recordings=(replace(walk, joints=one_knee),)).to_xarray(walk.name)
    knees = dataset.sel(quantity="knee_deg")
    assert np.isfinite(knees["value"].sel(side="left")).any()
    assert not np.isfinite(knees["value"].sel(side="right")).any()
    assert set(knees["status"].sel(side="right").to_numpy()) == {""}


def test_another_table_recording_or_axis_is_refused(found: Analysis) -> None:
    with pytest.raises(ValueError, match="kinematics"):
        found.to_dataframe("kinematics")
    with pytest.raises(ValueError, match="no common axis"):
        found.to_xarray("walk 1", "strides")
    with pytest.raises(KeyError, match="walk 7"):
        found.to_xarray("walk 7")


@pytest.mark.parametrize("missing", ["pandas", "xarray"])
def test_a_missing_library_is_named_with_what_to_install(
    found: Analysis, monkeypatch: pytest.MonkeyPatch, missing: str
) -> None:
    monkeypatch.setitem(sys.modules, missing, None)
    calls = {"pandas": found.to_dataframe, "xarray": lambda: found.to_xarray("walk 1")}
    with pytest.raises(ImportError, match=rf"{missing} is not installed.*pip install gaitwright-core\[frames\]"):
        calls[missing]()


def test_an_analysis_needs_neither_library() -> None:
    program = (
        "import sys; sys.modules['pandas'] = sys.modules['xarray'] = None\n"
        "import core, core.frames, devices\n"
        "short = devices.WalkerSettings(seed=1, recordings=(devices.Standing(), devices.Walk(strides=3)))\n"
        "print(len(core.analyse(devices.simulate(short).session).recordings))"
    )
    ran = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert ran.stdout.split() == ["1"]
