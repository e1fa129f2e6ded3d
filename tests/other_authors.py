"""Packages of other authors for tests: written into a folder of packages, or built and installed there by pip."""

import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

PLUGIN = Path(__file__).parent / "examples" / "plugin"
ALIAS = """import sys

import core
import devices

sys.modules[__name__ + ".core"], sys.modules[__name__ + ".devices"] = core, devices
"""


def site_in(place: Path) -> Path:
    """An empty folder of packages, in which the names of our wheels lead to this repository."""
    site = place / "site-packages"  # the name by which the reading process knows such a folder
    (site / "gaitwright").mkdir(parents=True)
    (site / "gaitwright" / "__init__.py").write_text(ALIAS, encoding="utf-8")
    return site


def site_of_others(place: Path, patch: pytest.MonkeyPatch) -> Iterator[Path]:
    """For a fixture: such a folder, found by imports; what a test imports from it is forgotten after it."""
    site = site_in(place)
    patch.syspath_prepend(site)
    before = set(sys.modules)
    yield site
    for name in set(sys.modules) - before:
        if str(getattr(sys.modules[name], "__file__", None)).startswith(str(site)) or name.startswith("gaitwright."):
            del sys.modules[name]


def install_plugin(site: Path, place: Path) -> None:
    """Build the example package and install it into `site` alone; nothing is fetched."""
    source = shutil.copytree(PLUGIN, place / "plugin")  # setuptools writes into it
    pip = [sys.executable, "-m", "pip", "--quiet"]
    alone = ["--no-deps", "--no-build-isolation"]
    subprocess.run([*pip, "wheel", *alone, "-w", str(place), str(source)], check=True)
    (wheel,) = place.glob("*.whl")
    subprocess.run([*pip, "install", "--no-deps", "--no-index", "--target", str(site), str(wheel)], check=True)


def write_package(site: Path, name: str, group: str, offered: Mapping[str, str], version: str = "1.0") -> None:
    """Write a package: each name that it offers, with the source of the module whose `OFFER` it is."""
    about = site / f"{name.replace('-', '_')}-{version}.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n", encoding="utf-8")
    lines = [f"[{group}]"]
    for number, (key, source) in enumerate(offered.items()):
        module = f"{name.replace('-', '_')}_{number}"
        (site / f"{module}.py").write_text(source, encoding="utf-8")
        lines.append(f"{key} = {module}:OFFER")
    (about / "entry_points.txt").write_text("\n".join([*lines, ""]), encoding="utf-8")
