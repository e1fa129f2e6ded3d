"""Tests that the estimator still reaches its targets on the project's own patient.

A few sessions here, two dozen as endurance.

The conditions, their targets and the scoring are those of `tests/benchmarks/accuracy.py`, which runs all of them, and
five hundred sessions of each.
"""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

SLACK = 1.5  # the 90th percentile of a few sessions scatters more than that of five hundred


@pytest.fixture(scope="module")
def accuracy() -> ModuleType:
    path = Path(__file__).parents[1] / "benchmarks" / "accuracy.py"
    spec = importlib.util.spec_from_file_location("accuracy", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["accuracy"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def assert_reached(accuracy: ModuleType, name: str, seeds: range, slack: float) -> None:
    found = accuracy.run(name, seeds, workers=1)
    assert "missing" not in found
    for quantity, target in accuracy.CONDITIONS[name].targets.items():
        p90 = float(np.quantile(found[quantity], 0.9)) if target else float(np.sum(found[quantity]))
        assert p90 <= target * slack, f"{name}, {quantity}: {p90:.2f}, wanted {target}"


@pytest.mark.parametrize(
    "name",
    [
        "soft tissue",
        *(
            pytest.param(name, marks=pytest.mark.endurance)
            for name in ("rigid", "rigid, biased sensors", "walk only, no standing")
        ),
    ],
)
def test_a_few_sessions_reach_the_targets(accuracy: ModuleType, name: str) -> None:
    assert_reached(accuracy, name, range(1000, 1003), SLACK)


@pytest.mark.endurance
@pytest.mark.parametrize(
    "name", ["rigid", "rigid 3 s", "rigid 60 Hz", "rigid 200 Hz", "rigid, biased sensors", "soft tissue", "lag 30 ms"]
)
def test_two_dozen_sessions_reach_the_targets(accuracy: ModuleType, name: str) -> None:
    assert_reached(accuracy, name, range(2000, 2024), 1.1)
