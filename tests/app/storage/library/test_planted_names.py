"""T10 for a whole library, as endurance at the size of CI; at full size in `tests.safety.planted_names`."""

import os
from pathlib import Path

import pytest

from tests.driver import Found
from tests.safety.planted_names import ENCODINGS, NAMES, PASSPHRASE, kill_and_search, search_files


@pytest.mark.skipif(os.name == "nt", reason="SIGKILL is POSIX's")
@pytest.mark.endurance
def test_no_name_and_no_secret_is_found_after_a_kill(tmp_path: Path) -> None:
    search = kill_and_search(tmp_path, 6, seed=2)
    assert search.faults == []
    assert search.count["files searched"] >= 30


def test_the_search_finds_what_is_there(tmp_path: Path) -> None:
    secrets = ["5a" * 32, "ABCD-EFGH"]
    planted = [NAMES[7].upper().encode(encoding) for encoding in ENCODINGS]
    planted += [PASSPHRASE.encode(), b"\x5a" * 32, b"5A" * 32, b"abcdefgh", b"abcd-efgh"]
    for number, content in enumerate(planted):
        (tmp_path / str(number)).write_bytes(b"\0" * number + content + b"\0")
    (tmp_path / NAMES[3]).write_bytes(b"")
    (tmp_path / "innocent").write_bytes(b"nobody")
    search = Found()
    search_files(tmp_path, secrets, search)
    assert len(search.faults) == len(planted) + 1
