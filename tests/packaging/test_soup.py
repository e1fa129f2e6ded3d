"""Each locked part is listed with why it is there, under the licence that it reports itself."""

import importlib
import re
from importlib import metadata
from pathlib import Path
from types import ModuleType

import pytest
from packaging.requirements import Requirement

PACKAGING = Path(__file__).parents[2] / "packaging"
PROJECT = "gaitwright"


@pytest.fixture
def soup() -> ModuleType:
    return importlib.import_module("soup")


def name_of(part: str) -> str:
    return re.sub(r"[-_.]+", "-", part).lower()


def needed() -> set[str]:
    """Everything that the program needs with any of its extras; what builds and tests it is none."""
    extras = set(metadata.metadata(PROJECT).get_all("Provides-Extra") or ()) - {"dev", "build", "bundle", "opensim"}
    found: set[tuple[str, frozenset[str]]] = set()
    waiting = [(PROJECT, frozenset(extras))]
    while waiting:
        name, asked = waiting.pop()
        if (name, asked) in found:
            continue
        found.add((name, asked))
        try:
            requires = metadata.requires(name) or []
        except metadata.PackageNotFoundError:  # of another system, or of an extra that is not in the lock
            continue
        for one in map(Requirement, requires):
            if one.marker is None or any(one.marker.evaluate({"extra": extra}) for extra in {"", *asked}):
                waiting.append((name_of(one.name), frozenset(one.extras)))
    return {name for name, _ in found} - {PROJECT}


def test_every_locked_part_is_listed_once_and_no_other(soup: ModuleType) -> None:
    assert list(soup.faults()) == []


def test_the_list_is_that_of_what_was_written_by_hand(soup: ModuleType) -> None:
    assert (soup.SAFETY / "soup.md").read_text(encoding="utf-8") == soup.page(), "run packaging/soup.py"


def test_what_runs_with_the_program_is_not_called_a_tool(soup: ModuleType) -> None:
    listed = {name for part in soup.parts() for name in part.names}
    assert len(needed()) > 50
    assert sorted((needed() & soup.locked().keys()) - listed) == []
    assert sorted(needed() - soup.locked().keys() - listed) == []


def test_what_only_the_application_installs_is_listed_too(soup: ModuleType) -> None:
    assert soup.locked()["keyring"]
    assert "keyring" in {name for part in soup.parts() for name in part.names}


def test_a_licence_is_the_one_that_the_part_shows_of_itself(soup: ModuleType) -> None:
    differing = {}
    for part in soup.parts():
        for name, licence in part.names.items():
            try:
                stated = metadata.metadata(name).get_all("License-Expression")
            except metadata.PackageNotFoundError:
                continue
            if stated and stated != [licence]:
                differing[name] = (licence, stated)
    assert differing == {}


def test_what_is_missing_or_there_twice_is_named(soup: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(soup, "locked", lambda: {"numpy": "2.0", "new-part": "1.0", "pytest": "9.0"})
    twice = soup.Soup({"numpy": "BSD", "gone": "MIT", "pytest": "MIT"}, "Figures", "", "", "")
    monkeypatch.setattr(soup, "parts", lambda: [twice])
    monkeypatch.setattr(soup, "reported", lambda: {"development": {"names": ["pytest"]}})
    assert list(soup.faults()) == [
        "pytest is there twice",
        "new-part is locked, and nothing states why",
        "gone is not in the lock",
    ]
