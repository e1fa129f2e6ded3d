"""Under the lock the data key is nowhere in the program's memory, while a recording goes on."""

import sys
from pathlib import Path

import pytest

from tests.safety.key_in_memory import measured


@pytest.mark.endurance
@pytest.mark.skipif(sys.platform != "linux", reason="another program's memory is read through /proc")
def test_the_key_leaves_memory_at_the_lock_and_comes_back(tmp_path: Path) -> None:
    found = measured(tmp_path, locks=2)
    assert [state for state, _ in found] == ["open", "locked", "open", "locked", "written closed"]
    assert all(copies.raw for state, copies in found if state == "open")  # else it would be looked for in vain
    assert not any(copies.all for state, copies in found if state == "locked")
    assert not any(copies.lower_hex or copies.upper_hex for _, copies in found)
