"""Tests that what is packed is listed with its licence. The package asks for what it leaves to the system."""

import configparser
import importlib
import json
import re
import shutil
import subprocess
import sysconfig
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
PACKAGING = ROOT / "packaging"
PACKAGES = Path(sysconfig.get_path("purelib"))


@pytest.fixture
def parts() -> ModuleType:
    return importlib.import_module("bundle_parts")


@pytest.fixture
def packages() -> ModuleType:
    return importlib.import_module("linux_packages")


@pytest.fixture
def build() -> ModuleType:
    return importlib.import_module("build")


def pins(lock: str) -> dict[str, str]:
    return dict(re.findall(r"^([\w.-]+)==(\S+)", (PACKAGING / lock).read_text(encoding="utf-8"), re.MULTILINE))


def test_what_is_packed_is_what_was_tested() -> None:
    tested, packed = pins("requirements.lock"), pins("bundle.lock")
    assert {name: version for name, version in packed.items() if tested.get(name, version) != version} == {}


def test_a_start_installs_what_was_tested_and_nothing_for_tests() -> None:
    tested, started = pins("requirements.lock"), pins("runtime.lock")
    assert {name: version for name, version in started.items() if tested.get(name, version) != version} == {}
    assert {
        "pytest",
        "hypothesis",
        "pandas",
        "xarray",
        "matplotlib",
        "mypy",
        "pgserver",
        "moto",
        "ruff",
        "psycopg",
        "dask",
    } & started.keys() == set()
    assert {"setuptools", "tomli-w", "pyside6-essentials", "vqf", "openpyxl"} <= started.keys()


def test_the_bundle_has_every_extra_and_what_builds_it_and_nothing_for_tests() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    required = project["dependencies"] + [
        one for name, asked in extras.items() if name not in ("dev", "frames", "opensim", "video") for one in asked
    ]
    names = {re.split(r"[^\w.-]", requirement)[0].lower() for requirement in required}
    packed = pins("bundle.lock").keys()
    assert names <= packed
    assert {"pytest", "hypothesis", "pandas", "mypy", "pgserver", "moto"} & packed == set()
    assert "av" not in packed  # its wheel carries encoders under the GPL


def test_the_lock_of_the_bundle_holds_hashes_and_no_addresses() -> None:
    lock = (PACKAGING / "bundle.lock").read_text(encoding="utf-8")
    assert re.search(r"://|--index|--extra-index|--find-links|--trusted-host", lock) is None
    assert len(re.findall(r"--hash=sha256:[0-9a-f]{64}", lock)) >= len(pins("bundle.lock"))


def test_the_sources_are_those_that_pyinstaller_wrote_down(parts: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "COLLECT-00.toc").write_text(
        "([('a.so', '/x/a.so', 'BINARY'), ('b.so', 'a.so', 'SYMLINK'), ('c', '/x/c', 'DATA')],)"
    )
    (tmp_path / "PYZ-00.toc").write_text("('/x/PYZ-00.pyz', [('m', '/x/m.py', 'PYMODULE'), ('n', '-', 'PYMODULE')])")
    (tmp_path / "EXE-00.toc").write_text("not read")
    assert [str(file) for file in parts.sources(tmp_path)] == ["/x/a.so", "/x/c", "/x/m.py"]


def test_a_file_is_a_distributions_or_pythons_or_ours_or_the_systems(parts: ModuleType) -> None:
    stdlib = Path(sysconfig.get_path("stdlib"))
    numpy = PACKAGES / "numpy" / "__init__.py"
    owned = {str(numpy.resolve()): "numpy"}
    files = [numpy, stdlib / "json" / "__init__.py", ROOT / "app" / "cli" / "main.py", Path("/usr/lib/libssl.so.3")]
    assert parts.sorted_out(files, owned, stdlib) == ({"numpy"}, {Path("/usr/lib/libssl.so.3")})


def test_a_file_that_nobody_owns_stops_the_build(parts: ModuleType) -> None:
    stranger = PACKAGES / "nobody" / "knows.py"
    with pytest.raises(parts.PartsError, match="belongs to no distribution"):
        parts.sorted_out([stranger], {}, Path(sysconfig.get_path("stdlib")))


def test_a_part_brings_its_licence_and_the_text_of_it(parts: ModuleType) -> None:
    numpy = parts.part_of("numpy")
    assert "BSD" in numpy.licence
    assert any("Redistribution" in text.read_text(encoding="utf-8") for text in numpy.texts)


def test_qt_has_its_texts_from_us_since_it_brings_none(parts: ModuleType) -> None:
    qt = parts.part_of("PySide6_Essentials")
    assert qt.licence.startswith("LGPL-3.0-only")
    assert {"LGPL-3.0.txt", "GPL-3.0.txt"} <= {text.name for text in qt.texts}


def test_a_part_without_a_text_stops_the_build(
    parts: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(parts, "TEXTS_OF_OURS", tmp_path)
    with pytest.raises(parts.PartsError, match="no licence or no text"):
        parts.part_of("PySide6_Essentials")


def test_licences_of_one_name_do_not_overwrite_each_other(parts: ModuleType, tmp_path: Path) -> None:
    texts = []
    for name in ("a", "b", "c"):
        (tmp_path / name).mkdir()
        texts += [tmp_path / name / "LICENSE.txt"]
        texts[-1].write_text("same" if name == "c" else name)
    texts += [tmp_path / "d.txt"]
    (tmp_path / "d.txt").write_text("d")
    part = parts.Part("lib", "1", "MIT", "", tuple(texts))
    parts.write_licences([part], tmp_path / "licences")
    found = sorted(file.name for file in (tmp_path / "licences" / "lib-1").iterdir())
    assert found == ["LICENSE-2.txt", "LICENSE-3.txt", "LICENSE.txt", "d.txt"]
    assert "lib,1,MIT," in (tmp_path / "licences" / "parts.csv").read_text()


def whole_bill() -> dict[str, Any]:
    return {
        "metadata": {"component": {"bom-ref": "ours", "name": "gaitwright"}},
        "components": [
            {"bom-ref": "numpy", "name": "numpy", "version": "1"},
            {"bom-ref": "lxml", "name": "lxml", "version": "1"},
        ],
        "dependencies": [{"ref": "ours", "dependsOn": ["numpy", "lxml"]}, {"ref": "lxml"}, {"ref": "numpy"}],
    }


def test_the_bill_leaves_out_what_built_and_adds_what_is_no_distribution(parts: ModuleType) -> None:
    inside = [parts.Part("NumPy", "1", "BSD", "", ()), parts.Part("libssl3", "3+1", "", "", (), "deb/debian")]
    bill = parts.bill_of_materials(whole_bill(), inside)
    assert [one["name"] for one in bill["components"]] == ["numpy", "libssl3"]
    assert bill["components"][1]["purl"] == "pkg:deb/debian/libssl3@3%2B1"
    assert bill["dependencies"] == [{"ref": "ours", "dependsOn": ["numpy"]}, {"ref": "numpy"}]


def test_the_package_asks_for_every_library_that_the_set_up_asks_for(packages: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(bytes(3000))
    reported = packages.control("1.2.3", "amd64", tmp_path)
    fields = dict(line.split(": ", 1) for line in reported.splitlines() if re.match(r"[A-Z]", line))
    asked = {name.strip() for names in fields["Depends"].split(",") for name in names.split("|")}
    assert set(packages.QT_LIBRARIES.values()) <= asked
    assert fields["Version"] == "1.2.3"
    assert fields["Installed-Size"] == "3"
    assert "Not a medical device." in reported


def test_the_package_puts_a_program_a_menu_entry_and_an_icon_and_nothing_else_outside_opt(
    packages: ModuleType, tmp_path: Path
) -> None:
    folder = tmp_path / "folder"
    (folder / "_internal").mkdir(parents=True)
    (folder / "gaitwright").write_text("program")
    (folder / "_internal" / "library").write_text("library")
    packages.lay_out(folder, tmp_path / "root")
    there = {file.relative_to(tmp_path / "root").as_posix() for file in (tmp_path / "root").rglob("*.*")}
    outside = {name for name in there if not name.startswith("opt/")}
    assert outside == {
        "usr/share/applications/gaitwright.desktop",
        "usr/share/icons/hicolor/scalable/apps/gaitwright.svg",
    }
    assert (tmp_path / "root/opt/gaitwright/_internal/library").read_text() == "library"
    assert str((tmp_path / "root/usr/bin/gaitwright").readlink()) == "/opt/gaitwright/gaitwright"


def test_rerun_is_a_package_and_an_archive_of_its_own_for_the_same_place(packages: ModuleType, tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    for name in (
        "gaitwright",
        "_internal/library",
        "_internal/rerun_bindings/rerun_bindings.abi3.so",
        "_internal/rerun_cli/rerun",
    ):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(name)
    packages.lay_out(folder, tmp_path / "first")
    packages.lay_out_rerun(folder, tmp_path / "second")
    parts = [
        {
            one.relative_to(tmp_path / root / "opt/gaitwright").as_posix()
            for one in (tmp_path / root).rglob("opt/gaitwright/**/*")
            if one.is_file()
        }
        for root in ("first", "second")
    ]
    assert parts == [
        {"gaitwright", "_internal/library"},
        {"_internal/rerun_bindings/rerun_bindings.abi3.so", "_internal/rerun_cli/rerun"},
    ]
    first, second = (make("1.2.3", "amd64", tmp_path) for make in (packages.control, packages.control_of_rerun))
    assert "Recommends: gaitwright-rerun (= 1.2.3)" in first
    for line in ("Depends: gaitwright (= 1.2.3)", "Breaks: gaitwright (<< 1.2.3)", "Replaces: gaitwright (<< 1.2.3)"):
        assert line in second.splitlines()
    if shutil.which("zstd"):
        kept = [tarred(archive) for archive in packages.make_archives(folder, "1.2.3", tmp_path)]
        assert kept[0] & kept[1] == set()
        assert {name for names in kept for name in names} == {
            f"gaitwright-1.2.3/{name}" for name in (*parts[0], *parts[1], "README.txt")
        }


def tarred(archive: Path) -> set[str]:
    listed = subprocess.run(["tar", "--list", "--zstd", "--file", archive], capture_output=True, text=True, check=True)
    return {name for name in listed.stdout.splitlines() if not name.endswith("/")}


def test_the_menu_entry_starts_what_the_package_installs() -> None:
    entry = configparser.ConfigParser(interpolation=None)
    entry.read(PACKAGING / "installers" / "gaitwright.desktop", encoding="utf-8")
    reported = entry["Desktop Entry"]
    assert reported["Exec"] == "/usr/bin/gaitwright"
    assert "not a medical device" in reported["Comment"].lower()
    assert reported["Categories"].endswith(";")


def test_the_archive_states_which_libraries_a_bare_system_lacks(packages: ModuleType) -> None:
    text = packages.readme()
    (line,) = re.findall(r"apt-get install (.+)", text)
    assert set(packages.QT_LIBRARIES.values()) <= set(line.split())
    assert "|" not in line
    assert "Not a medical device" in text


def test_the_version_is_that_of_the_project(build: ModuleType) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["version"] == build.VERSION


def test_an_environment_of_the_same_lock_is_used_again(
    build: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    steps: list[str] = []
    monkeypatch.setattr(build, "run", lambda command, _environment=None: steps.append(" ".join(map(str, command))))
    monkeypatch.setattr(build.shutil, "rmtree", lambda *_, **__: None)
    python = tmp_path / ("Scripts/python.exe" if build.os.name == "nt" else "bin/python")
    python.parent.mkdir()
    python.touch()
    build.make_environment(tmp_path)
    assert sum("--require-hashes" in step for step in steps) == 1
    steps.clear()
    build.make_environment(tmp_path)
    assert steps == []
    monkeypatch.setattr(build, "fingerprint", lambda: "another")
    build.make_environment(tmp_path)
    assert len(steps) == 3


def test_a_bill_that_does_not_follow_the_schema_is_none(parts: ModuleType) -> None:
    pytest.importorskip("cyclonedx", reason="it is of the environment that builds the bundle")
    with pytest.raises(parts.PartsError, match="schema"):
        parts.check_bill(json.dumps({"bomFormat": "CycloneDX", "specVersion": "1.6", "components": 3}))
