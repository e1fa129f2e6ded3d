"""The site's pages of public names, and of the functions behind its pages of methods.

A page only names what it shows: the site's builder reads signatures and docstrings out of the sources and imports
nothing.
"""

import re
from collections.abc import Mapping, Sequence
from enum import Enum
from importlib import import_module
from typing import Protocol

METHOD_LINK = re.compile(r"\]\[((?:core|devices)(?:\.\w+)+)\]")
HEADS = {
    "core": "What the samples mean: a session goes in, joint angles, gait events and their certainty come out.",
    "devices": "Where samples come from: session folders, sensors, files of other programs and simulated patients.",
}


def public_pages() -> Mapping[str, str]:
    """A page of each package's public names, in the order of its `__all__`."""
    import core.public
    import devices.public

    packages = ((core.__all__, core.public.MODULES), (devices.__all__, devices.public.MODULES))
    return {
        f"api-{package}": _public_page(package, names, modules)
        for package, (names, modules) in zip(HEADS, packages, strict=True)
    }


def _public_page(package: str, names: Sequence[str], modules: Mapping[str, str]) -> str:
    listed = ", ".join(f"[`{name}`][{modules[name]}.{name}]" for name in names)
    head = (
        f"# Public names of {package}\n\n{HEADS[package]}\n\n`from {package} import` what you need. These names keep "
        "their meaning, every other one may change. Units end names: `_s`, `_hz`, `_rad_s`, `_m_s2`, `_deg`. Shapes "
        "are given where the type is: `(n, 3)` is n samples of three axes. Scripts for each task: "
        f"[examples](../examples/index.md).\n\n{listed}.\n\n"
    )
    return head + "\n".join(_shown(modules[name], name) for name in names)


def _shown(module: str, name: str) -> str:
    """One name; of words and protocols all that they hold, of others what has a docstring beside their signature."""
    thing = getattr(import_module(module), name)
    is_all_shown = isinstance(thing, type) and (issubclass(thing, Enum) or Protocol in thing.__bases__)
    options = "    options: {show_if_no_docstring: true}\n" if is_all_shown else ""
    return f"::: {module}.{name}\n{options}"


def method_functions_page(methods: Sequence[str]) -> str:
    """The functions that pages of methods link to, but for the public ones, which have their own page."""
    import core.public

    public = {f"{module}.{name}" for name, module in core.public.MODULES.items()}
    named = sorted({found for page in methods for found in METHOD_LINK.findall(page)} - public)
    head = (
        "# Functions behind the methods\n\nWhat the pages of [methods](../methods/index.md) name, beside the "
        "[public names](api-core.md). These functions may change with any version.\n\n"
    )
    return head + "\n".join(f"::: {name}\n" for name in named)
