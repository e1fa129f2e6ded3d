"""Whether Rerun is installed, which has no wheel for Windows on ARM and for Macs with an Intel processor."""

from importlib.util import find_spec


def has_rerun() -> bool:
    """Whether logs can be written; found without loading the library, which takes long."""
    return find_spec("rerun") is not None
