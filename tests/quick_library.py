"""A new encrypted library that opens at once: its keys cost next to nothing to derive."""

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
