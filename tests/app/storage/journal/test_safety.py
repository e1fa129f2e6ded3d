"""T1, T2, T3 and the journal's share of T10 of the reliability targets: small here, as endurance at the size of CI.

The full size is what the scripts of `tests/safety` run.
"""

import os
import random
from pathlib import Path

import numpy as np
import pytest

from tests.safety.journal_full_disk import fill_often
from tests.safety.journal_kills import kill_often
from tests.safety.journal_material import KEY
from tests.safety.journal_tails import DAMAGES, Original, tear_often, unnoticed_flips

needs_posix = pytest.mark.skipif(os.name == "nt", reason="SIGKILL, fork and limits of files are POSIX's")


@pytest.mark.endurance
@needs_posix
def test_a_kill_leaves_a_journal_that_is_whole_up_to_its_last_record(tmp_path: Path) -> None:
    kills = kill_often(tmp_path, 3, seed=1)
    assert kills.faults == []
    assert max(kills.figures["loss, ms"]) <= 250.0


@needs_posix
@pytest.mark.endurance
def test_fifty_kills_cost_little(tmp_path: Path) -> None:
    kills = kill_often(tmp_path, 50, seed=2)
    assert kills.faults == []
    assert np.quantile(kills.figures["loss, ms"], 0.99) <= 100.0
    assert max(kills.figures["loss, ms"]) <= 250.0


def check_tails(folder: Path, count: int) -> None:
    tails = tear_often(folder, count, seed=3)
    assert tails.faults == []
    assert tails.count["tails"] == count
    assert tails.count["synced records"] > 0
    assert tails.count["untouched records after damage"] > 0


@pytest.mark.endurance
def test_a_torn_tail_costs_no_synced_record(tmp_path: Path) -> None:
    check_tails(tmp_path, 20 * len(DAMAGES))


@pytest.mark.endurance
def test_two_thousand_torn_tails_cost_no_synced_record(tmp_path: Path) -> None:
    check_tails(tmp_path, 2000)


def test_every_damage_does_damage(tmp_path: Path) -> None:
    original, rng = Original.recorded(tmp_path, KEY), random.Random(5)
    for damage in DAMAGES:
        changed = 0
        for _ in range(10):
            content = bytearray(original.content)
            damage(content, original.ends[20], original, rng)
            assert content[: original.ends[20]] == original.content[: original.ends[20]]
            changed += content != original.content
        assert changed >= 5, damage.__name__


@pytest.mark.parametrize("key", [KEY, None], ids=["sealed", "open"])
def test_a_flipped_bit_is_noticed(tmp_path: Path, key: bytes | None) -> None:
    assert unnoticed_flips(tmp_path, 300, 4, key) == []


@pytest.mark.endurance
@pytest.mark.parametrize("key", [KEY, None], ids=["sealed", "open"])
def test_ten_thousand_flipped_bits_are_noticed(tmp_path: Path, key: bytes | None) -> None:
    assert unnoticed_flips(tmp_path, 10_000, 5, key) == []


@needs_posix
def test_a_full_disk_closes_the_journal_and_is_stated() -> None:
    fills = fill_often(2, seed=6)
    assert fills.faults == []


@needs_posix
@pytest.mark.endurance
def test_twenty_full_disks_close_their_journals() -> None:
    fills = fill_often(20, seed=7)
    assert fills.faults == []
    assert len(fills.figures["reported after, ms"]) == 20
