"""README, changelog and contributing page: short, linked to what exists, and true of the code."""

import re
import runpy
import tomllib
from pathlib import Path

import pytest

from core.body import Site
from devices.files.session_folder import write_session
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings, simulate

ROOT = Path(__file__).parents[1]
README, CHANGELOG, CONTRIBUTING = (ROOT / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md"))
PLACE = re.compile(r"`((?:app|core|devices|packaging|resources|tests)/[\w./-]+)`")
RELEASE = re.compile(r"(?m)^## \[(\d+\.\d+\.\d+)\] - (\d{4}-\d\d-\d\d)$")


MADE = ("requirements.md", "risks.md", "use_errors.md")  # by packaging/safety_tables.py, where somebody made them


def written_pages() -> list[Path]:
    """Give the pages that are committed, but for those of the site alone, whose links lead into the site."""
    folders = ("packaging", "resources", "tests", ".github")
    below = [page for folder in folders for page in (ROOT / folder).rglob("*.md")]
    return [
        *ROOT.glob("*.md"),
        *(page for page in below if "site" not in page.relative_to(ROOT).parts and page.name not in MADE),
    ]


def lost_links(page: Path, text: str) -> list[str]:
    """Give the links of a page that lead to no file; addresses are not asked."""
    prose = re.sub(r"(?s)```.*?```|`[^`\n]*`", "", text)
    targets = {link.partition("#")[0] for link in re.findall(r"\]\(([^)\s]+)\)", prose)}
    return sorted(
        target for target in targets if target and "://" not in target and not (page.parent / target).resolve().exists()
    )


def test_every_link_of_a_committed_page_leads_to_a_file() -> None:
    pages = written_pages()
    lost = [
        (page.relative_to(ROOT).as_posix(), target)
        for page in pages
        for target in lost_links(page, page.read_text(encoding="utf-8"))
        if not target.startswith("films/")  # drawn by the window
    ]
    assert len(pages) > 60
    assert lost == []


def test_a_link_that_leads_nowhere_is_found() -> None:
    text = "[here](README.md#install), [gone](docs/nowhere.md), `[code](x.md)`, [far](https://example.org/x.md)"
    assert lost_links(README, text) == ["docs/nowhere.md"]


def test_a_file_or_folder_that_a_page_names_is_there() -> None:
    architecture = ROOT / "packaging" / "site" / "pages" / "en" / "architecture.md"
    lost = [
        (page.name, place)
        for page in (README, CONTRIBUTING, architecture)
        for place in PLACE.findall(page.read_text(encoding="utf-8"))
        if "LANGUAGE" not in place and not (ROOT / place).exists()
    ]
    assert lost == []


def test_readme_has_the_usual_titles_and_fits_on_a_page() -> None:
    text = README.read_text(encoding="utf-8")
    titles = re.findall(r"(?m)^## (.+)$", text)
    usual = [
        "Install",
        "Quick start",
        "Accuracy",
        "Supported sensors",
        "Python",
        "Architecture",
        "Test",
        "Contributing",
    ]
    assert titles == usual
    assert len(README.read_bytes()) < 6200
    assert "**Research use. Not a medical device.**" in text


def test_contributing_is_one_page() -> None:
    assert CONTRIBUTING.read_text(encoding="utf-8").count("\n") <= 80


def test_each_release_has_its_date_and_at_most_twenty_changes() -> None:
    text = CHANGELOG.read_text(encoding="utf-8")
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    releases = RELEASE.split(text)[1:]
    assert releases[0] == version
    assert f"Tag `v{version}`" in releases[2]
    assert [number for number, body in zip(releases[::3], releases[2::3], strict=True) if body.count("\n- ") > 20] == []
    assert len(CHANGELOG.read_bytes()) < 12_000


def demonstration(folder: Path, strides: int) -> Path:
    """Make the folder that `gaitwright demo` makes, as far as README's lines read it."""
    recordings = (Standing(duration_s=2.0), FreeMotion(duration_s=5.0), Walk(strides=strides))
    sites = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)
    simulated = simulate(WalkerSettings(seed=3, sites=sites, recordings=recordings))
    write_session(simulated.session, folder / "gaitwright-demo" / "session")
    return folder


def printed_by_readme(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> str:
    (lines,) = re.findall(r"(?s)```python\n(.*?)```", README.read_text(encoding="utf-8"))
    assert len([line for line in lines.splitlines() if line]) == 10
    assert set(re.findall(r"(?m)^from ((?:core|devices|app)\S*)", lines)) == {"core", "devices"}
    script = folder / "lines.py"
    script.write_text(lines, encoding="utf-8")
    monkeypatch.chdir(folder)
    runpy.run_path(str(script))
    return capsys.readouterr().out


def test_the_python_of_the_readme_runs_as_printed_and_uses_public_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = printed_by_readme(demonstration(tmp_path, strides=5), monkeypatch, capsys)
    printed = re.findall(r"(?m)^walk 1, (\w+): (\d+)°, SD ([\d.]+)°$", text)
    assert {name for name, _, _ in printed} == {"left_knee", "left_ankle"}
    assert all(50 < int(range_deg) < 80 for name, range_deg, _ in printed if name.endswith("knee"))


def test_the_python_of_the_readme_prints_no_joint_that_is_not_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert printed_by_readme(demonstration(tmp_path, strides=3), monkeypatch, capsys) == ""
