"""Test that every interval that is written follows from the tables beside it, by a script that knows nothing of us."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from app.exports.result_folder import write_results
from devices.simulation.walker import GaitChange
from tests.benchmarks.null_differences import left_on, strapped_again

SCRIPT = Path(__file__).parents[3] / "tests" / "safety" / "recompute_intervals.py"


def recompute(folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-I", SCRIPT, folder], capture_output=True, text=True, check=False)


@pytest.mark.endurance
def test_intervals_are_recomputed_from_the_tables_and_a_changed_cell_is_found(tmp_path: Path) -> None:
    for name, visits in (("left on", left_on(3, GaitChange(stance_percent=4.0))), ("again", strapped_again(5))):
        folder = tmp_path / name
        folder.mkdir()
        write_results(*visits[0], folder)
        done = recompute(folder)
        assert done.returncode == 0, done.stdout
        found = re.search(r"(\d+) rows, (\d+) recomputed", done.stdout)
        assert found is not None
        assert int(found[2]) > 0.8 * int(found[1]) > 100
    table = tmp_path / "left on" / "differences.csv"
    table.write_text(table.read_text(encoding="utf-8").replace("exceeds_error", "inside_error", 1), encoding="utf-8")
    done = recompute(tmp_path / "left on")
    assert done.returncode == 1
    assert "0 is not within, the verdict is inside_error" in done.stdout
