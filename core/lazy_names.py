"""Names that a package offers, each of which imports its own module when it is asked for.

`core` and `devices` offer functions that need SciPy, whose import takes seconds. The window and the command line import
modules of both packages long before anything is computed, so their openings import nothing themselves.
"""

from collections.abc import Callable, Mapping
from importlib import import_module


def lazily(package: str, modules: Mapping[str, str]) -> Callable[[str], object]:
    """The `__getattr__` (PEP 562) of `package`, which offers the names of `modules`, each from its module."""

    def get(name: str) -> object:
        if name not in modules:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(modules[name]), name)

    return get
