"""What `pip wheel .` and `pip install .` call (PEP 517): two wheels with one top-level name, `gaitwright`.

In the repository the packages are `app`, `core`, `devices` and `resources`, names that anybody may have. A wheel is
built from a copy in which they lie inside `gaitwright` and their imports say so; the repository and editable
installations stay as they are. The source archive holds them as they are, and this file to build them with.
`gaitwright-core` holds `core` and what reads and writes files, with what they import; `gaitwright` holds everything
else and depends on it, so that no file is in both:

    pip wheel . --no-deps -w dist
    pip wheel . --no-deps -w dist --config-settings distribution=core
"""

import ast
import re
import shutil
import tempfile
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import chdir
from pathlib import Path
from typing import Any

import tomli_w
from setuptools import build_meta  # type: ignore[import-untyped]  # its stubs are of another version

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("app", "core", "devices", "resources")
OF_SOURCES = ("LICENSE", "README.md", "pyproject.toml", "packaging/wheel_backend.py")
NAME, CORE_NAME = "gaitwright", "gaitwright-core"
CORE_NEEDS = ("numpy", "scipy", "vqf")
CORE_FILES = ("pyarrow", "tomli-w", "duckdb")  # for session folders; an extra, as it doubles what is installed
CORE_BEGINS = ("core", "devices.files", "devices.simulation", "devices.public")
"""What the core's wheel is for; whatever these import is in it too. Live sensors, which `devices` offers beside, come
with the application."""
MODULE = re.compile(r"(app|core|devices|resources)(\.[a-z_][a-z0-9_]*)*")

build_editable = build_meta.build_editable
get_requires_for_build_editable = build_meta.get_requires_for_build_editable
get_requires_for_build_sdist = build_meta.get_requires_for_build_sdist
get_requires_for_build_wheel = build_meta.get_requires_for_build_wheel
prepare_metadata_for_build_editable = build_meta.prepare_metadata_for_build_editable

Settings = Mapping[str, Any] | None


def build_wheel(wheel_directory: str, config_settings: Settings = None, metadata_directory: str | None = None) -> str:
    """Build the application's wheel, or with the setting `distribution=core` that of `gaitwright-core`."""
    is_core = (config_settings or {}).get("distribution") == "core"
    place = Path(wheel_directory).resolve()
    with tempfile.TemporaryDirectory() as folder:
        stage(Path(folder), is_core=is_core)
        with chdir(folder):
            return build_meta.build_wheel(str(place), None, None)


def build_sdist(sdist_directory: str, _config_settings: Settings = None) -> str:
    """Build the source archive, from a copy too: a list of files of its own would be one more file to keep."""
    place = Path(sdist_directory).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path in [*_files(), *map(Path, OF_SOURCES)]:
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / path, folder / path)
        listed = [*(f"graft {package}" for package in PACKAGES), *(f"include {one}" for one in OF_SOURCES)]
        (folder / "MANIFEST.in").write_text("\n".join(listed), encoding="utf-8")
        with chdir(folder):
            return build_meta.build_sdist(str(place), None)


def stage(folder: Path, *, is_core: bool) -> None:
    """Copy what one of both wheels holds into `folder`, with the imports of a package inside `gaitwright`."""
    of_core = files_of_core()
    for path in sorted(_files()):
        if (path in of_core) == is_core:
            target = folder / NAME / path
            target.parent.mkdir(parents=True, exist_ok=True)
            if path.suffix == ".py":
                target.write_text(moved((ROOT / path).read_text(encoding="utf-8"), str(path)), encoding="utf-8")
            else:
                shutil.copyfile(ROOT / path, target)
    if is_core:
        words = f'"""{_project()["description"]}."""\n'
        (folder / NAME / "__init__.py").write_text(words, encoding="utf-8")
        (folder / NAME / "py.typed").write_bytes(b"")
    for name in ("LICENSE", "README.md"):
        shutil.copyfile(ROOT / name, folder / name)
    (folder / "pyproject.toml").write_text(tomli_w.dumps(_metadata(is_core=is_core)), encoding="utf-8")


def moved(source: str, name: str) -> str:
    """Give a module's text with every import, and every name of a module in a text, as it is inside `gaitwright`.

    Raises SyntaxError for an import of another form than `from X import Y`.
    """
    lines = source.encode().splitlines(keepends=True)  # a tree counts bytes
    places: list[tuple[int, int]] = []
    for node in ast.walk(ast.parse(source, name)):
        if isinstance(node, ast.Import) and any(_is_ours(one.name) for one in node.names):
            raise SyntaxError(f"{name}, line {node.lineno}: write `from X import Y`")
        if isinstance(node, ast.ImportFrom) and not node.level and _is_ours(node.module or ""):
            at = lines[node.lineno - 1].index(b"from ", node.col_offset) + len("from ")
            places.append((node.lineno, at))
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and _is_module(node.value.rstrip(".")):
            at = lines[node.lineno - 1].find(node.value.encode(), node.col_offset)
            if at >= 0:
                places.append((node.lineno, at))
    for number, at in sorted(set(places), reverse=True):
        line = lines[number - 1]
        lines[number - 1] = line[:at] + f"{NAME}.".encode() + line[at:]
    return b"".join(lines).decode()


def files_of_core() -> frozenset[Path]:
    """The files of the core's wheel: its packages, and every module that they import."""
    modules = {path: name for path in _files() if path.suffix == ".py" for name in [_module_of(path)]}
    paths = {name: path for path, name in modules.items()}
    waiting = [n for n in paths if any(n == begin or n.startswith(f"{begin}.") for begin in CORE_BEGINS)]
    found: set[str] = set()
    while waiting:
        name = waiting.pop()
        if name not in found and name in paths:
            found.add(name)
            waiting += [*_imported(paths[name]), name.rpartition(".")[0]]
    return frozenset(paths[name] for name in found)


def _imported(path: Path) -> Iterator[str]:
    """What a module imports when it is imported, or later, but not for type checkers alone."""
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    for_checkers = [node for node in ast.walk(tree) if isinstance(node, ast.If) and _is_for_checkers(node.test)]
    skipped = {id(inner) for node in for_checkers for inner in ast.walk(node)}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and id(node) not in skipped:
            yield node.module
            yield from (f"{node.module}.{one.name}" for one in node.names)


def _is_for_checkers(test: ast.expr) -> bool:
    return isinstance(test, ast.Name) and test.id == "TYPE_CHECKING"


def _is_ours(module: str) -> bool:
    return module.partition(".")[0] in PACKAGES


def _is_module(text: str) -> bool:
    """Whether a text is the name of one of ours, as `app.home.home` is; `core` and `app` are words, too."""
    if not MODULE.fullmatch(text):
        return False
    place = ROOT.joinpath(*text.split("."))
    return text == "resources" or ("." in text and (place.is_dir() or place.with_suffix(".py").is_file()))


def _module_of(path: Path) -> str:
    return ".".join(path.with_suffix("").parts).removesuffix(".__init__")


def _files() -> list[Path]:
    found = [path for package in PACKAGES for path in (ROOT / package).rglob("*") if path.is_file()]
    return [path.relative_to(ROOT) for path in found if "__pycache__" not in path.parts]


def _project() -> dict[str, Any]:
    read: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return read


def _metadata(*, is_core: bool) -> dict[str, Any]:
    project = _project()
    extras = {name: needs for name, needs in project["optional-dependencies"].items() if name not in ("dev", "bundle")}
    needs = {re.split(r"[<>=!~\[; ]", one)[0]: one for one in project["dependencies"]}
    files = [needs[name] for name in CORE_FILES]
    if is_core:
        of_core = {"files": files, "imports": files + extras["imports"], "frames": extras["frames"]}
        project = {k: v for k, v in project.items() if k != "scripts"}
        project |= {"name": CORE_NAME, "optional-dependencies": of_core}
        required = [needs[name] for name in CORE_NEEDS]
    else:
        scripts = {name: f"{NAME}.{target}" for name, target in project["scripts"].items()}
        project |= {"scripts": scripts, "optional-dependencies": extras}
        required = [f"{CORE_NAME}[files]=={project['version']}"]
        required += [one for name, one in needs.items() if name not in CORE_NEEDS + CORE_FILES]
    packages = {"find": {"include": [f"{NAME}*"], "namespaces": True}}
    return {
        "build-system": {"requires": ["setuptools>=77"], "build-backend": "setuptools.build_meta"},
        "project": project | {"dependencies": required},
        "tool": {"setuptools": {"packages": packages, "package-data": {"*": ["**/*"]}}},
    }
