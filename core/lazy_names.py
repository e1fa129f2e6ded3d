"""Names that a package offers and imports when the first of them is asked for.

`core` and `devices` offer functions that need SciPy, whose import takes seconds. The window and the command line import
modules of both packages long before anything is computed, so their openings import nothing themselves.
"""

from collections.abc import Callable, Collection
from importlib import import_module


def lazily(package: str, names: Collection[str]) -> Callable[[str], object]:
    """The `__getattr__` (PEP 562) of `package`, which offers `names` of its module `public`."""

    def get(name: str) -> object:
        if name not in names:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(f"{package}.public"), name)

    return get
