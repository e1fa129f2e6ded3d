"""Tests that a visit kept on the disk is the one that would be made, and that any change of the code makes it again."""

import os
import shutil
from dataclasses import replace
from pathlib import Path

from core.analysis import analyse
from core.body import Site
from devices.simulation.walker import Standing, Walk, WalkerSettings, simulate
from tests.simulated import OTHERS, ROOT, Store, analysis_of, code_digest, digest, simulation_of

SETTINGS = WalkerSettings(sites=(Site.LEFT_THIGH, Site.LEFT_SHANK), recordings=(Standing(), Walk(strides=5)))


def test_what_is_kept_is_what_is_computed() -> None:
    made = simulate(SETTINGS)
    for _ in range(2):  # made or found, and found
        kept = simulation_of(SETTINGS)
        assert (digest(kept.session), digest(kept.truth)) == (digest(made.session), digest(made.truth))
        assert digest(analysis_of(kept.session)) == digest(analyse(made.session))


def test_any_change_of_a_source_makes_all_again_and_old_code_s_is_removed(tmp_path: Path) -> None:
    for folder in ("core", "devices"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    assert code_digest(tmp_path) == code_digest(ROOT)
    source = tmp_path / "core" / "gait" / "events.py"
    source.write_text(source.read_text(encoding="utf-8") + "#", encoding="utf-8")
    assert code_digest(tmp_path) != code_digest(ROOT)
    for number in range(OTHERS + 2):
        (tmp_path / "kept" / str(number)).mkdir(parents=True)
        os.utime(tmp_path / "kept" / str(number), (number, number))
    Store().open(tmp_path / "kept")
    assert {one.name for one in (tmp_path / "kept").iterdir()} == {"2", "3", code_digest(ROOT)}


def test_what_somebody_changes_is_not_changed_for_the_next(tmp_path: Path) -> None:
    store, asked = Store(), []
    store.open(tmp_path)

    def double(numbers: list[int]) -> list[int]:
        asked.append(numbers)
        return [2 * number for number in numbers]

    store.get(double, [1, 2]).clear()
    assert store.get(double, [1, 2]) == [2, 4]
    assert store.get(double, [2, 1]) == [4, 2]
    assert asked == [[1, 2], [2, 1]]


def test_every_setting_is_part_of_the_name() -> None:
    assert digest(SETTINGS) == digest(replace(SETTINGS))
    assert digest(SETTINGS) != digest(replace(SETTINGS, seed=2))
    assert digest(1, 2) != digest((1, 2))
    assert digest("1") != digest(1)
