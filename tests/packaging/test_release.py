"""What is written for a place to build and publish that is not at hand: held to what can be held here."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
OTHERWISE_NAMED = {"pyside6-essentials": "pyside6"}  # by conda


def test_every_action_is_one_commit_and_no_checkout_keeps_its_credentials() -> None:
    text = "\n".join(path.read_text(encoding="utf-8") for path in WORKFLOWS)
    used = re.findall(r"uses: (.*)", text)
    assert len(used) > 20
    assert [one for one in used if not re.fullmatch(r"[\w./-]+@[0-9a-f]{40} # v[\d.]+", one)] == []
    assert text.count("uses: actions/checkout@") == text.count("persist-credentials: false") > 5


def test_the_conda_recipe_needs_what_the_project_needs() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    required = {one.name.lower(): one.specifier for one in map(Requirement, project["dependencies"])}
    recipe = (ROOT / "packaging" / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    given = {
        name: Requirement(f"{name} {limits}").specifier for name, limits in re.findall(r"  - ([\w-]+) (>=\S+)", recipe)
    }
    assert given.pop("python") == Requirement(f"python {project['requires-python']}").specifier
    assert given == {OTHERWISE_NAMED.get(name, name): limits for name, limits in required.items()}
    assert f'version: "{project["version"]}"' in recipe


@pytest.mark.parametrize(
    ("system", "machine", "python", "missing"),
    [
        ("linux", "x86_64", "3.13", set()),
        ("win32", "AMD64", "3.11", set()),
        ("darwin", "arm64", "3.12", set()),
        ("linux", "x86_64", "3.14", {"vqf"}),
        ("linux", "aarch64", "3.12", {"vqf"}),
        ("win32", "ARM64", "3.13", {"vqf", "rerun-sdk"}),
        ("darwin", "arm64", "3.14", {"vqf"}),
        ("darwin", "x86_64", "3.13", {"rerun-sdk"}),
    ],
)
def test_a_part_without_a_wheel_for_a_computer_is_not_asked_for_there(
    system: str, machine: str, python: str, missing: set[str]
) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    place = {"sys_platform": system, "platform_machine": machine, "python_version": python}
    needs = [Requirement(one) for one in project["dependencies"]]
    assert {one.name for one in needs if one.marker is not None and not one.marker.evaluate(place)} == missing
