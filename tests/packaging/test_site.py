"""Tests of the site's pages, without its builder.

They are all there, listed, linked to what exists, and true of the code.
"""

import importlib
import re
import tomllib
from pathlib import Path

import pytest

from app.exports.columns import KNOWN
from app.exports.result_folder import OWN_SESSION, TAKEN
from app.films.film import Film
from app.help.help_topics import Topic, TopicGroup, group_title
from app.wording.translation import use_language
from devices.files.session_toml import PATIENT, RECORDING, SENSOR, SESSION
from devices.files.site_files import NUMERIC

ROOT = Path(__file__).parents[2]
RECIPES = {"en": "mkdocs.yml", "de": "mkdocs.de.yml"}
FORMATS = ROOT / "packaging" / "site" / "pages" / "en" / "formats.md"


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The pages of both languages, as the site is built of them; but for the films, which are drawn later."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT / "packaging")
        into = tmp_path_factory.mktemp("site")
        importlib.import_module("site_pages").assemble(into)
    return into


def recipe(language: str) -> str:
    return (ROOT / "packaging" / "site" / RECIPES[language]).read_text(encoding="utf-8")


@pytest.mark.parametrize("language", RECIPES)
def test_every_page_is_once_in_the_list_of_its_site(language: str, pages: Path) -> None:
    listed = re.findall(r"[\w/-]+\.md", recipe(language).partition("nav:\n")[2])
    there = [page.relative_to(pages / language).as_posix() for page in (pages / language).rglob("*.md")]
    assert sorted(listed) == sorted(there)


@pytest.mark.parametrize("language", RECIPES)
def test_the_manual_has_the_order_and_the_groups_of_the_application(language: str) -> None:
    nav = recipe(language).partition("nav:\n")[2]
    assert re.findall(r"manual/([\w-]+)\.md", nav) == [str(topic) for topic in Topic]
    use_language(language)
    try:
        required = [group_title(group) for group in TopicGroup]
    finally:
        use_language("en")
    assert re.findall(r"(?m)^ {6}- ([^:\n]+):", nav.partition("  - Reference")[0]) == required


@pytest.mark.parametrize("language", RECIPES)
def test_every_link_and_picture_leads_somewhere(language: str, pages: Path) -> None:
    films = {f"{film}{kind}" for film in Film for kind in (".webp", "-dark.webp", "-stills.png", "-dark-stills.png")}
    lost, counted = [], 0
    for page in (pages / language).rglob("*.md"):
        text = re.sub(r"(?s)```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"))
        for link in re.findall(r'\]\(([^)]+)\)|src="([^"]+)"', text):
            target = "".join(link).partition("#")[0]
            if target.startswith("https://doi.org/"):
                continue
            counted += 1
            is_film = target.startswith("films/") and target.removeprefix("films/") in films
            if not is_film and not (page.parent / target).resolve().is_file():
                lost.append((page.name, target))
    assert counted > 50
    assert lost == []


def test_each_example_is_a_page_with_its_words_and_all_of_its_code(pages: Path) -> None:
    scripts = [
        one for one in (ROOT / "tests" / "examples").glob("*.py") if not one.stem.startswith(("conftest", "test_"))
    ]
    assert len(scripts) == 17
    listed = (pages / "en" / "examples" / "index.md").read_text(encoding="utf-8")
    for script in scripts:
        page = (pages / "en" / "examples" / f"{script.stem}.md").read_text(encoding="utf-8")
        source = script.read_text(encoding="utf-8")
        assert source.rstrip().endswith(page.partition("```python\n")[2].removesuffix("\n```\n"))
        assert f"python -m tests.examples.{script.stem} " in page.partition("```python\n")[0]
        assert f"({script.stem}.md)" in listed


def test_every_column_is_explained(pages: Path) -> None:
    page = (pages / "en" / "reference" / "columns.md").read_text(encoding="utf-8")
    lacking = [
        (file, name)
        for file, columns in KNOWN.items()
        for name in columns
        if f"| `{re.sub('^right_', 'left_', name)}` |" not in page and f"| `{name}` |" not in page
    ]
    assert lacking == []


def test_the_page_of_file_formats_names_every_key_column_and_file() -> None:
    page = FORMATS.read_text(encoding="utf-8")
    tables = {"session": SESSION, "patient": PATIENT, "sensors.left_thigh": SENSOR, "recordings": RECORDING}
    for table, known in tables.items():
        block = re.search(rf"(?s)    \[+{re.escape(table)}\]+.*?\n(.*?)\n\n", page)
        assert block is not None, table
        assert set(re.findall(r"(?m)^    (\w+) = ", block[1])) == set(known), table
    assert [name for name in NUMERIC if f"`{name}`" not in page] == []
    files = {name for (name,) in TAKEN} - {OWN_SESSION}
    assert [name for name in files if name not in page] == []


def test_who_cites_the_project_names_its_version_and_licence() -> None:
    cited = dict(re.findall(r"(?m)^(\w[\w-]*): (\S.*)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8")))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert (cited["cff-version"], cited["version"], cited["license"]) == (
        "1.2.0",
        project["version"],
        project["license"],
    )


def test_the_lock_of_the_site_holds_hashes_and_no_addresses() -> None:
    lock = (ROOT / "packaging" / "site" / "requirements.lock").read_text(encoding="utf-8")
    assert re.search(r"://|@ |--index|--extra-index|--find-links|--trusted-host", lock) is None
    entries = re.split(r"\n(?=[a-z])", lock.strip())
    assert {entry.partition("==")[0] for entry in entries} >= {"mkdocs", "mkdocs-material"}
    assert [entry for entry in entries if "--hash=sha256:" not in entry] == []


def test_a_picture_is_shown_in_the_theme_in_force_and_a_film_where_it_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.syspath_prepend(ROOT / "packaging")
    shown = importlib.import_module("site_pages").with_both_themes
    picture = shown("![Words](pictures/a.png)", "Play")
    assert picture == "![Words](pictures/a.png#only-light)![Words](pictures/a-dark.png#only-dark)"
    film = shown("![Words](films/a.webp)", "Play")
    assert "(films/a-stills.png#only-light)" in film
    assert '<details><summary>Play</summary><img alt="Words" src="films/a.webp#only-light"' in film
    assert shown("no picture", "Play") == "no picture"
