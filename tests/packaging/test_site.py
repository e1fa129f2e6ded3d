"""Tests of the site's pages: all there, listed, linked to what exists, and true of the code.

But for the long test, which builds the site, they need no builder.
"""

import argparse
import importlib
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from types import ModuleType

import pytest

from app.cli.parser import SUBCOMMANDS
from app.exports.columns import KNOWN
from app.exports.result_folder import OWN_SESSION, TAKEN
from app.films.film import Film, captions
from app.help.help_topics import Topic, TopicGroup, group_title
from app.wording.translation import use_language
from devices.files.session_toml import PATIENT, RECORDING, SENSOR, SESSION
from devices.files.site_files import NUMERIC

ROOT = Path(__file__).parents[2]
RECIPES = {"en": "mkdocs.yml", "de": "mkdocs.de.yml"}
METHODS = sorted((ROOT / "packaging" / "site" / "pages" / "en" / "methods").glob("[!i]*.md"))
FIGURES = ROOT / "packaging" / "site" / "figures"
LEAST_PAGES = 100
FORMATS = ROOT / "packaging" / "site" / "pages" / "en" / "formats.md"


@pytest.fixture(scope="module")
def pages(site_pages: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The pages of both languages, as the site is built of them; but for the films, which are drawn later."""
    into = tmp_path_factory.mktemp("site")
    site_pages.assemble(into)
    return into


@pytest.fixture(params=RECIPES)
def language(request: pytest.FixtureRequest) -> Iterator[str]:
    """Each language of the site, which is spoken meanwhile."""
    use_language(request.param)
    yield request.param
    use_language("en")


@pytest.fixture(scope="module")
def site_pages() -> ModuleType:
    return importlib.import_module("site_pages")


def recipe(language: str) -> str:
    return (ROOT / "packaging" / "site" / RECIPES[language]).read_text(encoding="utf-8")


def test_every_page_is_once_in_the_list_of_its_site(language: str, pages: Path) -> None:
    listed = re.findall(r"[\w/-]+\.md", recipe(language).partition("nav:\n")[2])
    there = [page.relative_to(pages / language).as_posix() for page in (pages / language).rglob("*.md")]
    assert sorted(listed) == sorted(there)


def test_the_manual_has_the_order_and_the_groups_of_the_application(language: str) -> None:
    nav = recipe(language).partition("nav:\n")[2]
    assert re.findall(r"manual/([\w-]+)\.md", nav) == [str(topic) for topic in Topic]
    required = [group_title(group) for group in TopicGroup]
    assert re.findall(r"(?m)^ {6}- ([^:\n]+):", nav.partition("  - Reference")[0]) == required


def test_every_link_and_picture_leads_somewhere(language: str, pages: Path) -> None:
    films = {f"{film}{kind}" for film in Film for kind in (".webp", "-dark.webp", "-stills.png", "-dark-stills.png")}
    figures = {f"{script.stem}{dark}.svg" for script in FIGURES.glob("*.py") for dark in ("", "-dark")}
    lost, counted = [], 0
    for page in (pages / language).rglob("*.md"):
        text = re.sub(r"(?s)```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"))
        for link in re.findall(r'\]\(([^)]+)\)|src="([^"]+)"', text):
            target = "".join(link).partition("#")[0]
            if target.startswith("https://doi.org/"):
                continue
            counted += 1
            is_film = target.startswith("films/") and target.removeprefix("films/") in films
            is_figure = target.startswith("figures/") and target.removeprefix("figures/") in figures
            if target and not is_film and not is_figure and not (page.parent / target).resolve().is_file():
                lost.append((page.name, target))
    assert counted > 50
    assert lost == []


def test_what_the_scenes_of_a_film_show_is_in_words_below_it(language: str, pages: Path) -> None:
    for film in Film:
        (page,) = (
            text
            for file in (pages / language / "manual").glob("*.md")
            if f"films/{film}" in (text := file.read_text(encoding="utf-8"))
        )
        below = page.partition("</details>")[2]
        assert below.lstrip().startswith(captions(film))


def test_each_example_is_a_page_with_its_words_and_all_of_its_code(pages: Path) -> None:
    scripts = [
        one for one in (ROOT / "tests" / "examples").glob("*.py") if not one.stem.startswith(("conftest", "test_"))
    ]
    assert len(scripts) == 17
    listed = (pages / "en" / "examples" / "index.md").read_text(encoding="utf-8")
    for script in scripts:
        page = (pages / "en" / "examples" / f"{script.stem}.md").read_text(encoding="utf-8")
        source = script.read_text(encoding="utf-8")
        assert source.rstrip().endswith(page.partition("```python\n")[2].partition("\n```\n")[0])
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


def test_every_name_that_the_drawing_shows_is_a_package_and_no_folder_is_missing() -> None:
    drawing = (ROOT / "packaging" / "site" / "pages" / "drawings" / "architecture.svg").read_text(encoding="utf-8")
    boxes = re.split(r'<text class="name"[^>]*>(\w+)</text>', drawing)[1:]
    drawn = {
        package: set(" ".join(re.findall(r'class="packages"[^>]*>([^<]+)<', box)).split())
        for package, box in zip(boxes[::2], boxes[1::2], strict=True)
    }
    assert list(drawn) == ["devices", "core", "app"]
    for package, names in drawn.items():
        folders = {file.parent.name for file in (ROOT / package).glob("*/__init__.py")}
        assert folders <= names
        assert {name for name in names - folders if not (ROOT / package / f"{name}.py").is_file()} == set()


def taken_by(parser: argparse.ArgumentParser) -> set[str]:
    """The options of a parser and the subcommands below it, read off its help."""
    found = re.findall(r"(?m)^  (--[\w-]+)|^    ([a-z]+) ", parser.format_help())
    return {option or subcommand for option, subcommand in found}


def test_the_page_of_commands_has_every_subcommand_and_option(pages: Path) -> None:
    page = (pages / "en" / "reference" / "commands.md").read_text(encoding="utf-8")
    sections = dict(re.findall(r"(?ms)^## ([a-z]+)$(.*?)(?=^## |\Z)", page))
    assert set(sections) == set(SUBCOMMANDS)
    for name, (_, add_arguments) in SUBCOMMANDS.items():
        parser = argparse.ArgumentParser(prog=name, add_help=False)
        add_arguments(parser)
        assert " ".join((parser.description or "").split()) in " ".join(sections[name].split())
        below = sections[name].replace(f"### {name} ", "`")
        assert [word for word in taken_by(parser) if f"`{word}" not in below] == [], name


def test_what_is_typed_is_shown_as_it_is_typed(pages: Path) -> None:
    page = (pages / "en" / "reference" / "commands.md").read_text(encoding="utf-8")
    for typed in (
        "`SESSION|OUT`",
        "| `xlsx`, `c3d`",
        "| `utf-8`, `utf-16`",
        "`m/s2`",
        "| `postgresql://USER@SERVER/DATABASE`",
    ):
        assert typed in page
    assert re.findall(r"`[^`\n]*\\[^`\n]*`", page) == []
    usages = re.findall(r"(?s)```text\n(.*?)\n```", page)
    assert len(usages) > len(SUBCOMMANDS)
    assert [line for usage in usages for line in usage.splitlines() if len(line) > 72] == []


def test_readme_and_benchmarks_are_in_the_site_as_they_are_written(pages: Path) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    for page, title in (("quick-start", "Quick start"), ("python", "Python"), ("accuracy/index", "Accuracy")):
        text = (pages / "en" / f"{page}.md").read_text(encoding="utf-8")
        section = readme.partition(f"\n## {title}\n")[2].partition("\n## ")[0]
        lines = [line for line in section.splitlines() if "](" not in line]
        assert [line for line in lines if line not in text] == []
        assert "<!-- README" not in text
    written = (ROOT / "tests" / "benchmarks" / "README.md").read_text(encoding="utf-8")
    shown = (pages / "en" / "accuracy" / "benchmarks.md").read_text(encoding="utf-8")
    assert [line for line in written.splitlines()[1:] if "](" not in line and line not in shown] == []


def test_a_link_of_the_sources_leads_to_its_page_or_names_its_file(site_pages: ModuleType) -> None:
    turned = site_pages.with_links_of_site
    text = "[a](resources/help/accuracy.md#x), [b](CONTRIBUTING.md), [c](https://example.org/), [d](tests/examples)"
    assert turned(text, PurePosixPath(), PurePosixPath("accuracy/index.md")) == (
        "[a](../manual/accuracy.md#x), b (`CONTRIBUTING.md` in the sources), [c](https://example.org/), "
        "[d](../examples/index.md)"
    )
    assert turned("[e](../../resources/help/files.md)", PurePosixPath("tests/benchmarks"), PurePosixPath("a.md")) == (
        "[e](manual/files.md)"
    )


def test_a_sentence_and_a_row_are_taken_from_their_page_and_from_no_other_place(site_pages: ModuleType) -> None:
    page = "- Zero is known to 3.5°. It moves.\n\n"
    page += "| Between | Knee | Stance | Speed |\n|---|---|---|---|\n| legs | 7.9° | 3 % | |\n"
    assert site_pages.sentence_of(page, "Zero is") == "Zero is known to 3.5°."
    assert site_pages.sentence_of(page, "It") == "It moves."
    assert site_pages.row_of(page, "legs") == "knee 7.9°, stance 3 %"
    for take, lacking in ((site_pages.sentence_of, "known"), (site_pages.row_of, "visits")):
        with pytest.raises(ValueError, match=lacking):
            take(page, lacking)


def test_a_page_of_the_site_that_the_manual_names_is_linked(language: str, pages: Path) -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in (pages / language / "manual").glob("*.md"))
    assert re.search("project's site|Website des Projekts", text) is None
    for name in ("limits", "validation", "formats"):
        assert f"reference/{name}." in text
        assert (pages / language / "reference" / f"{name}.md").is_file() or name == "formats"


def test_the_first_page_has_version_and_licence(language: str, pages: Path) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    end = (pages / language / "index.md").read_text(encoding="utf-8").rpartition("\n## ")[2]
    assert f"Version {project['version']}" in end
    assert str(project["license"]) in end
    assert f"version {project['version']}, 20" in end


def test_nothing_of_another_page_is_left_to_be_put_in(pages: Path) -> None:
    asked = re.compile(r"<!-- (?!output)[\w]+(?::| -->)")
    assert [page.name for page in pages.rglob("*.md") if asked.search(page.read_text(encoding="utf-8"))] == []


@pytest.mark.parametrize("page", METHODS, ids=lambda page: page.stem)
def test_a_page_of_a_method_has_equation_figure_code_and_source(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert "\n```math\n" in text
    (figure,) = re.findall(r"!\[[^\]]{30,}\]\(figures/(\w+)\.svg\)", text)
    assert (FIGURES / f"{figure}.py").is_file()
    assert "\n## Source\n" in text
    named = re.findall(r"\[`(\w+)`\]\[([\w.]+)\.(\w+)\]", text.partition("\n## Code\n")[2])
    assert named
    for shown, module, name in named:
        assert shown == name
        assert callable(getattr(importlib.import_module(module), name))


def test_every_figure_is_on_a_page() -> None:
    shown = {name for page in METHODS for name in re.findall(r"figures/(\w+)\.svg", page.read_text(encoding="utf-8"))}
    assert shown == {script.stem for script in FIGURES.glob("*.py")}


@pytest.mark.parametrize("package", ["core", "devices"])
def test_every_public_name_has_its_place(package: str, pages: Path) -> None:
    page = (pages / "en" / "reference" / f"api-{package}.md").read_text(encoding="utf-8")
    modules = importlib.import_module(f"{package}.public").MODULES
    assert re.findall(r"(?m)^::: (\S+)$", page) == [
        f"{modules[name]}.{name}" for name in importlib.import_module(package).__all__
    ]


def test_german_pages_link_to_english_ones_that_are_there(pages: Path) -> None:
    text = (pages / "de" / "index.md").read_text(encoding="utf-8")
    linked = re.findall(r'<a href="\.\./([\w/-]+)\.html" hreflang="en">', text)
    assert len(linked) > 3
    assert [page for page in linked if not (pages / "en" / f"{page}.md").is_file()] == []


def test_a_lost_link_and_what_is_loaded_from_elsewhere_are_found(tmp_path: Path) -> None:
    links = importlib.import_module("site_links")
    (tmp_path / "b.html").write_text('<h1 id="here">B</h1>')
    (tmp_path / "a.html").write_text(
        '<a href="b.html#here">1</a><a href="b.html#gone">2</a><a href="c.html">3</a><a href="https://example.org">4</a>'
        '<img src="https://example.org/a.png"><a id="x" href="#x">5</a>'
    )
    assert {why for _, why in links.lost_links(links.read_site(tmp_path))} == {
        "b.html#gone leads to no place of its page",
        "c.html leads to no file",
        "https://example.org/a.png is loaded from elsewhere",
    }


def test_each_example_is_run_for_its_page_or_states_why_not() -> None:
    runs = importlib.import_module("site_examples")
    scripts = {one.stem for one in (ROOT / "tests" / "examples").glob("*.py")}
    assert {name for name in scripts if not name.startswith(("conftest", "test_"))} == {*runs.RUNS, *runs.WITHOUT}


@pytest.mark.endurance
def test_the_site_is_built_strictly(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    builder = importlib.import_module("build_site")
    try:
        builder.builder()
    except subprocess.CalledProcessError:
        pytest.skip("the site's builder cannot be installed here: no registry of packages is reached")
    out = tmp_path / "site"
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    builder.build(Path(sys.executable), out)
    written = {file.relative_to(out).as_posix(): file.read_text(encoding="utf-8") for file in out.rglob("*.html")}
    assert len(written) > LEAST_PAGES
    for page in METHODS:
        html = written[f"methods/{page.stem}.html"]
        assert "<math" in html
        assert "```" not in html
        assert re.search(r"\\(?:frac|times|lVert|theta)", html) is None
    assert "Functions behind the methods" in written["reference/methods-api.html"]
    for name in importlib.import_module("site_examples").RUNS:
        printed = written[f"examples/{name}.html"].partition('id="output"')[2]
        assert "<code>" in printed, name
        assert os.fspath(tmp_path.parent) not in printed


def test_the_lock_of_the_site_holds_hashes_and_no_addresses() -> None:
    lock = (ROOT / "packaging" / "site" / "requirements.lock").read_text(encoding="utf-8")
    assert re.search(r"://|@ |--index|--extra-index|--find-links|--trusted-host", lock) is None
    entries = re.split(r"\n(?=[a-z])", lock.strip())
    assert {entry.partition("==")[0] for entry in entries} >= {"mkdocs", "mkdocs-material"}
    assert [entry for entry in entries if "--hash=sha256:" not in entry] == []


def test_a_picture_is_shown_in_the_theme_in_force_and_a_film_where_it_is_asked_for(site_pages: ModuleType) -> None:
    shown = site_pages.with_both_themes
    assert shown("![Words](a.svg)", "Play") == "![Words](a.svg#only-light)![Words](a-dark.svg#only-dark)"
    picture = shown("![Words](pictures/a.png)", "Play")
    assert picture == "![Words](pictures/a.png#only-light)![Words](pictures/a-dark.png#only-dark)"
    film = shown("![Words](films/a.webp)", "Play")
    assert "(films/a-stills.png#only-light)" in film
    assert '<details><summary>Play</summary><img alt="Words" src="films/a.webp#only-light"' in film
    assert shown("no picture", "Play") == "no picture"
