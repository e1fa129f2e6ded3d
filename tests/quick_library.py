"""A new encrypted library that opens at once: its keys cost next to nothing to derive."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from app.storage.keys import KeySlots
from app.storage.layout import KEYS
from app.storage.library import Library
from app.storage.opened import OpenedLibrary
from app.storage.slots import Cost
from app.storage.stored import Operator, Role

PASSPHRASE = "four short words here"
CHEAP = Cost(passes=1, memory_kib=64)


def quick_library(folder: Path, passphrase: str = PASSPHRASE) -> OpenedLibrary:
    """Open, of one administrator, `hk`, who has put the recovery key away."""
    folder.mkdir(exist_ok=True)
    slots = KeySlots(folder / KEYS, CHEAP)
    data_key, recovery_key = slots.create("hk", passphrase)
    slots.confirm_recovery_key(recovery_key)
    library = Library.create(folder, data_key, Operator("hk", "H. Keller", Role.ADMINISTRATOR))
    return OpenedLibrary(library, folder, data_key)


@contextmanager
def copy_of(untouched: OpenedLibrary, folder: Path) -> Iterator[OpenedLibrary]:
    """The same library in a folder of the test's own, with `hk` logged in."""
    shutil.copytree(untouched.folder, folder)
    library = Library.open(folder, untouched.data_key)
    library.log_in("hk")
    with OpenedLibrary(library, folder, untouched.data_key) as opened:
        yield opened
