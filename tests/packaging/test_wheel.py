"""The two wheels: one name beside strangers' packages, no file in both, the same results, each goes without the other.

Nothing is fetched: the wheels are installed without what they need, which is taken from this environment.
"""

import ast
import importlib
import re
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path
from types import ModuleType

import pytest

from tests.other_authors import install_plugin

ROOT = Path(__file__).resolve().parents[2]
STRANGERS = ("app", "core", "devices")


@pytest.fixture(scope="module")
def backend() -> ModuleType:
    return importlib.import_module("wheel_backend")


def test_every_import_and_every_name_of_a_module_is_moved(backend: ModuleType) -> None:
    source = '''"""Says core.analysis; é."""
from core.body import Side
from core import parameters
from corelib import thing
import numpy as np
MODULES = ("app.home.home", "core.nothing", "app")
def late():
    from devices.files import formats; folder = files("resources")
    return import_module(f"app.cli.{folder}")
'''
    moved = backend.moved(source, "here")
    assert moved.splitlines()[1:] == [
        "from gaitwright.core.body import Side",
        "from gaitwright.core import parameters",
        "from corelib import thing",
        "import numpy as np",
        'MODULES = ("gaitwright.app.home.home", "core.nothing", "app")',
        "def late():",
        '    from gaitwright.devices.files import formats; folder = files("gaitwright.resources")',
        '    return import_module(f"gaitwright.app.cli.{folder}")',
    ]


def test_an_import_that_cannot_be_moved_stops_the_build(backend: ModuleType) -> None:
    with pytest.raises(SyntaxError, match="here, line 2"):
        backend.moved("\nimport core.body\n", "here")


def test_each_module_is_in_one_wheel_and_the_core_needs_nothing_of_the_application(backend: ModuleType) -> None:
    of_core = {path.as_posix() for path in backend.files_of_core()}
    assert "core/analysis.py" in of_core
    assert "devices/files/session_folder.py" in of_core
    assert not any(path.startswith(("app/", "resources/")) for path in of_core)
    for path in of_core:
        for node in ast.walk(ast.parse((ROOT / path).read_text(encoding="utf-8"))):
            module = node.module if isinstance(node, ast.ImportFrom) else None
            assert not (module or "").startswith(("app.", "PySide6", "rerun")), path


@pytest.fixture(scope="module")
def wheels(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    made = tmp_path_factory.mktemp("wheels")
    build = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "--quiet",
        "--no-deps",
        "--no-build-isolation",
        "-w",
        str(made),
        str(ROOT),
    ]
    for more in ([], ["--config-settings", "distribution=core"]):
        subprocess.run([*build, *more], check=True, cwd=made)
    return {path.name.split("-")[0]: path for path in made.glob("*.whl")}


@pytest.mark.endurance
def test_the_wheel_of_the_source_archive_is_that_of_the_repository(
    backend: ModuleType, wheels: dict[str, Path], tmp_path: Path
) -> None:
    archive = tmp_path / backend.build_sdist(str(tmp_path))
    command = [sys.executable, "-m", "pip", "wheel", archive, "--no-deps", "--no-build-isolation", "-q", "-w", tmp_path]
    subprocess.run(command, check=True)
    (made,) = tmp_path.glob("gaitwright-*.whl")
    with zipfile.ZipFile(made) as one, zipfile.ZipFile(wheels["gaitwright"]) as other:
        assert {a.filename: a.CRC for a in one.infolist()} == {b.filename: b.CRC for b in other.infolist()}


@pytest.fixture(scope="module")
def environment(wheels: dict[str, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment with both wheels, strangers' packages of our names, and the libraries of this one; its Python."""
    place = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", place], check=True)
    (site,) = place.glob("**/site-packages")
    (site / "others.pth").write_text(sysconfig.get_path("purelib"), encoding="utf-8")
    for stranger in STRANGERS:
        (site / stranger).mkdir()
        (site / stranger / "__init__.py").write_text("MINE = 1\n", encoding="utf-8")
    python = next(path for path in place.glob("*/python*") if path.is_file())
    # that of this environment is seen there too, and would be taken for it
    pip(python, "install", "--no-deps", "--no-index", "--ignore-installed", *map(str, wheels.values()))
    return python


def pip(python: Path, *arguments: str) -> None:
    subprocess.run([sys.executable, "-m", "pip", "--quiet", "--python", python, *arguments], check=True)


def run(python: Path, *arguments: str, cwd: Path) -> str:
    ran = subprocess.run([python, "-E", "-P", *arguments], cwd=cwd, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr[-2000:]
    return ran.stdout


@pytest.mark.endurance
def test_no_file_is_in_both_and_one_name_is_at_the_top(wheels: dict[str, Path]) -> None:
    names = {}
    for wheel, path in wheels.items():
        with zipfile.ZipFile(path) as archive:
            names[wheel] = set(archive.namelist())
        assert {name.split("/")[0] for name in names[wheel]} == {
            "gaitwright",
            f"{wheel}-{path.name.split('-')[1]}.dist-info",
        }
    assert names["gaitwright"].isdisjoint(names["gaitwright_core"])
    assert "gaitwright/py.typed" in names["gaitwright_core"]
    of_both = {name for found in names.values() for name in found if "dist-info" not in name}
    here = {f"gaitwright/{path}" for path in subprocess.run(
        ["git", "ls-files", "app", "core", "devices", "resources"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.splitlines()}  # fmt: skip
    assert of_both >= here


@pytest.mark.endurance
@pytest.mark.parametrize("needed", [("numpy", "scipy", "vqf"), ("numpy", "scipy")])  # vqf has not every wheel
def test_the_core_needs_numpy_scipy_and_vqf_alone(
    wheels: dict[str, Path], tmp_path: Path, needed: tuple[str, ...]
) -> None:
    with zipfile.ZipFile(wheels["gaitwright_core"]) as archive:
        archive.extractall(tmp_path / "core")
    libraries = tmp_path / "libraries"
    libraries.mkdir()
    for found in Path(sysconfig.get_path("platlib")).iterdir():
        if found.name.split(".")[0] in needed:
            (libraries / found.name).symlink_to(found)
    program = """
import sys
sys.path[:0] = sys.argv[1:]
from gaitwright import core, devices
session = devices.simulate(devices.WalkerSettings(seed=1)).session
analysis = core.analyse(session)
print(len(analysis.recordings), *(name for name in core.__all__ if getattr(core, name) is None))
"""
    stated = run(
        Path(sys.executable), "-S", "-c", program, str(tmp_path / "core"), str(libraries), cwd=tmp_path
    )  # without -S what this environment holds would be found
    assert stated.split() == ["2"]


@pytest.mark.endurance
def test_tables_are_an_extra_of_both_and_a_missing_library_is_named(
    wheels: dict[str, Path], environment: Path, tmp_path: Path
) -> None:
    for path in wheels.values():
        with zipfile.ZipFile(path) as archive:
            (about,) = (name for name in archive.namelist() if name.endswith("/METADATA"))
            stated = archive.read(about).decode()
        assert re.search(r"Requires-Dist: pandas.*; extra == [\"']frames", stated)
    program = (
        "import sys; sys.modules['pandas'] = None\n"
        "from gaitwright.core import Analysis, Method\n"
        "try: Analysis(Method.ROBUST, False, (), ()).to_dataframe()\n"
        "except ImportError as missing: print(missing)"
    )
    assert run(environment, "-c", program, cwd=tmp_path).startswith("pandas is not installed.")


@pytest.mark.endurance
def test_a_package_of_others_brings_its_driver_and_its_format(environment: Path, tmp_path: Path) -> None:
    (site,) = environment.parents[1].glob("**/site-packages")
    install_plugin(site, tmp_path)
    (tmp_path / "shank.bin").write_bytes(b"SUM1" + bytes(16) + bytes([1, *bytes(15)]))
    program = """
import sys
from pathlib import Path
from gaitwright.devices.files.limited_reader import LimitedReader, LimitedReading
from gaitwright.devices.other_drivers import load_drivers
print(*(driver.key for driver in load_drivers({("gaitwright-sum-sensor", "1.0")}).drivers))
reader = LimitedReader()
trial = LimitedReading(reader, lambda: None).read_trial("", [Path(sys.argv[1])], None)
reader.close()
print(trial.format, len(trial.sensors[0].block))
"""
    stated = run(environment, "-c", program, str(tmp_path / "shank.bin"), cwd=tmp_path)
    assert stated.split() == ["sum-sensor", "sum-card", "2"]


@pytest.mark.endurance
def test_a_wheel_gives_what_the_repository_gives(environment: Path, tmp_path: Path) -> None:
    demo = "from {}app.cli.main import main; import sys; sys.argv[1:] = ['demo', '--out', sys.argv[1]]; main()"
    run(environment, "-c", demo.format("gaitwright."), str(tmp_path / "wheel"), cwd=tmp_path)
    here = "import sys; sys.path.insert(0, sys.argv.pop()); " + demo.format("")
    run(Path(sys.executable), "-c", here, str(tmp_path / "here"), str(ROOT), cwd=tmp_path)
    files = {path.relative_to(tmp_path / "here") for path in (tmp_path / "here").rglob("*") if path.is_file()}
    assert files == {p.relative_to(tmp_path / "wheel") for p in (tmp_path / "wheel").rglob("*") if p.is_file()}
    differ = [f for f in files if (tmp_path / "here" / f).read_bytes() != (tmp_path / "wheel" / f).read_bytes()]
    assert [path.name for path in differ] in ([], ["report.pdf"])  # which states the minute it was made
    analyse = "from gaitwright.app.cli.main import main; import sys; sys.argv[1:] = ['analyse', *sys.argv[1:]]; main()"
    session = str(tmp_path / "wheel" / "session")
    run(
        environment, "-c", analyse, session, "--out", str(tmp_path / "again"), cwd=tmp_path
    )  # read by a process of its own
    angles = Path("walk_1") / "angles.csv"
    assert (tmp_path / "again" / angles).read_bytes() == (tmp_path / "wheel" / angles).read_bytes()


@pytest.mark.endurance
def test_strangers_stay_and_either_goes_without_the_other(environment: Path, tmp_path: Path) -> None:
    own = "import app, core, devices; print(app.MINE + core.MINE + devices.MINE)"
    pip(environment, "uninstall", "--yes", "gaitwright")
    assert run(
        environment, "-c", f"{own}; from gaitwright.core import Side; print(Side.LEFT)", cwd=tmp_path
    ).split() == ["3", "left"]
    pip(environment, "uninstall", "--yes", "gaitwright-core")
    assert run(environment, "-c", own, cwd=tmp_path).split() == ["3"]
