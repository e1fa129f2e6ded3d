"""Tests that the bands come out of the package, from wherever it is run."""

from pathlib import Path

import pytest

from app.summary.reference_bands import reference_curves, time_distance_classes


def test_the_bands_are_read_from_any_folder_and_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert reference_curves().knee_mean_deg.shape == (101,)
    assert [found.speed_class for found in time_distance_classes()] == ["slow", "comfortable", "fast"]
    assert reference_curves() is reference_curves()
