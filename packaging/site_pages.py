"""The site's pages, put together from the manual, from what is written for the site alone, and from the code itself.

Used by `build_site.py`. Nothing here needs the site's builder. A page that is written for the site may hold
`<!-- README: Install -->`, in whose place that section of README is put, `<!-- benchmarks -->` for the measured figures
and `<!-- drawing: NAME -->` for `drawings/NAME.svg`: nothing is written twice. `<!-- sentence: PAGE, BEGINNING -->` is
the sentence of another page that so begins, `<!-- row: PAGE, FIRST CELL -->` the row of a table in words;
`<!-- version -->`, `<!-- licence -->` and `<!-- citation -->` are those of CITATION.cff.
"""

import ast
import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from posixpath import normpath

from site_commands import commands_page
from site_reference import method_functions_page, public_pages

ROOT = Path(__file__).resolve().parents[1]
HELP = ROOT / "resources" / "help"
WRITTEN = ROOT / "packaging" / "site" / "pages"
EXAMPLES = ROOT / "tests" / "examples"
BENCHMARKS = ROOT / "tests" / "benchmarks" / "README.md"
LANGUAGES = ("en", "de")
PLACE = re.compile(
    r"<!-- (README|drawing): ([\w -]+) -->|<!-- (sentence|row): ([\w-]+), (.+?) -->"
    r"|<!-- (benchmarks|version|licence|citation) -->"
)
ENGLISH_LINK = re.compile(r"\[([^\]]+)\]\((\.\./[\w/-]+)\.md\)")
OF_SITE = re.compile("(?:project's site|Website des Projekts), [“„](.+?)[”“]")
"""How the manual of the application, which has no such pages, names one of the site."""
SITE_PAGES = {
    "Limits and measurement errors": "limits",
    "Grenzen und Messfehler": "limits",
    "Validation": "validation",
    "Validierung": "validation",
    "File formats": "formats",
}
IN_ENGLISH_ONLY = ("formats",)
FIRST = ("index", "quick-start", "python")
LINK = re.compile(r"(?<!!)\[([^\]]+)\]\(([^)\s]+)\)")
IMAGE = re.compile(r"!\[([^\]]*)\]\(([\w/-]+)\.(png|svg|webp)\)")
FILM_WORDS = {"en": "Play the film", "de": "Film abspielen"}
NOT_EXAMPLES = ("conftest", "test_")


def assemble(into: Path) -> None:
    """Write the pages of each language into a folder of its own in `into`; films are drawn elsewhere."""
    for language in LANGUAGES:
        folder = into / language
        shutil.rmtree(folder, ignore_errors=True)
        manual = HELP if language == "en" else HELP / language
        shutil.copytree(manual / "pictures", folder / "manual" / "pictures")
        for page in manual.glob("*.md"):
            captioned = with_captions(page.read_text(encoding="utf-8"), language)
            text = with_both_themes(with_pages_of_site(captioned, language), FILM_WORDS[language])
            (folder / "manual" / page.name).write_text(text, encoding="utf-8")
        for name in ("extra.css", "extra.js"):
            shutil.copyfile(WRITTEN / name, folder / name)
        for page in (WRITTEN / language).rglob("*.md"):
            place = place_of(page.relative_to(WRITTEN / language))
            text = with_both_themes(filled(page.read_text(encoding="utf-8"), place), FILM_WORDS[language])
            _write(folder / place, text if language == "en" else with_english_pages(text))
    made = {"columns": columns_page(), "commands": commands_page(), **public_pages()}
    methods = [page.read_text(encoding="utf-8") for page in sorted((into / "en" / "methods").glob("*.md"))]
    made["methods-api"] = method_functions_page(methods)
    for name, text in made.items():
        _write(into / "en" / "reference" / f"{name}.md", text)
    for name, text in example_pages().items():
        _write(into / "en" / "examples" / f"{name}.md", text)


def with_pages_of_site(page: str, language: str) -> str:
    """Link to the pages of the site that the manual names; KeyError for one that is not known here."""

    def linked(found: re.Match[str]) -> str:
        name = SITE_PAGES[found[1]]
        if language != "en" and name in IN_ENGLISH_ONLY:
            return f'<a href="../../reference/{name}.html" hreflang="en">{found[1]}</a>'
        return f"[{found[1]}](../reference/{name}.md)"

    return OF_SITE.sub(linked, page)


def with_english_pages(page: str) -> str:
    """Link to English pages, which no list of the page's own language has, as they are in the finished site."""
    return ENGLISH_LINK.sub(r'<a href="\2.html" hreflang="en">\1</a>', page)


def place_of(page: Path) -> PurePosixPath:
    """Where the site has a page that is written for it; those in no folder are reference, but for the first."""
    return PurePosixPath(page.as_posix() if page.parent.name or page.stem in FIRST else f"reference/{page.name}")


def _write(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")


def filled(page: str, place: PurePosixPath) -> str:
    """The text of a page at `place` of the site, with what it takes from elsewhere."""

    def taken(found: re.Match[str]) -> str:
        kind, name, cut, page_name, beginning, word = found.groups()
        if cut:
            source = _english(page_name)
            return sentence_of(source, beginning) if cut == "sentence" else row_of(source, beginning)
        if kind == "README":
            return with_links_of_site(readme_section(name), PurePosixPath(), place)
        if kind == "drawing":
            drawing = (WRITTEN / "drawings" / f"{name}.svg").read_text(encoding="utf-8")
            return f'<div class="drawing" tabindex="0">\n{drawing.strip()}\n</div>'
        if word != "benchmarks":
            return cited()[word]
        text = BENCHMARKS.read_text(encoding="utf-8").partition("\n")[2].strip()  # the page has a title of its own
        return with_links_of_site(text, PurePosixPath("tests/benchmarks"), place)

    return PLACE.sub(taken, page)


def readme_section(title: str) -> str:
    """What README has below a heading, up to the next of its kind."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    found = re.search(rf"(?ms)^## {re.escape(title)}\n(.*?)(?=^## |\Z)", readme)
    if found is None:
        raise ValueError(f"README has no section {title}")
    return found[1].strip()


def cited() -> Mapping[str, str]:
    """What CITATION.cff has of the project itself: `version`, `licence` and a line to cite, `citation`."""
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    own = dict(re.findall(r"(?m)^(\w[\w-]*): (\S.*)$", text))
    (authors,) = re.findall(r"(?m)^  - name: (.+)$", text)
    line = f"{authors}: {own['title']}, version {own['version']}, {own['date-released'][:4]}."
    return {"version": own["version"], "licence": own["license"], "citation": line}


def _english(name: str) -> str:
    """A page of the manual, or one that is written for the site."""
    manual = HELP / f"{name}.md"
    return (manual if manual.is_file() else WRITTEN / "en" / f"{name}.md").read_text(encoding="utf-8")


def sentence_of(page: str, beginning: str) -> str:
    """The only sentence of a page with this beginning."""
    found = re.findall(rf"(?m)(?:^|(?<=[ -] )|(?<=\. ))({re.escape(beginning)}.*?[.])(?= |$)", page)
    if len(found) != 1:
        raise ValueError(f"{len(found)} sentences begin with {beginning}")
    return str(found[0])


def row_of(page: str, first: str) -> str:
    """The only row with this first cell, each other cell that is not empty after the title of its column."""
    tables = re.findall(r"(?m)^(\|.*)\n\|(?:---\|)+\n((?:\|.*(?:\n|$))+)", page)
    rows = [(head, row) for head, body in tables for row in body.splitlines() if row.startswith(f"| {first} |")]
    if len(rows) != 1:
        raise ValueError(f"{len(rows)} rows begin with {first}")
    titles, cells = ([cell.strip() for cell in line.strip("|").split("|")] for line in rows[0])
    return ", ".join(f"{title.lower()} {cell}" for title, cell in zip(titles[1:], cells[1:], strict=True) if cell)


def with_links_of_site(text: str, folder: PurePosixPath, place: PurePosixPath) -> str:
    """Turn links of a page in `folder` of the sources to those of a page at `place`; what the site lacks is named."""

    def turned(found: re.Match[str]) -> str:
        words, target = found.groups()
        if "://" in target or target.startswith("#"):
            return found[0]
        path, _, part = target.partition("#")
        source = PurePosixPath(normpath(folder / path))
        there = site_place(source)
        if there is None:
            return f"{words} (`{source}` in the sources)"
        up = "../" * len(place.parent.parts)
        return f"[{words}]({up}{there}{'#' + part if part else ''})"

    return LINK.sub(turned, text)


def site_place(source: PurePosixPath) -> PurePosixPath | None:
    """Where the site has a file or folder of the sources; None where it has not."""
    known = {"tests/benchmarks/README.md": "accuracy/benchmarks.md", "tests/examples": "examples/index.md"}
    if source.as_posix() in known:
        return PurePosixPath(known[source.as_posix()])
    if source.parent.as_posix() == "resources/help":
        return PurePosixPath("manual", source.name)
    pages = PurePosixPath("packaging/site/pages/en")
    return place_of(Path(source.relative_to(pages))) if source.is_relative_to(pages) else None


def with_captions(page: str, language: str) -> str:
    """Put the captions of the application below each film, in the language of the page."""
    from app.films import film
    from app.wording.translation import spoken_language, use_language

    before = spoken_language()
    use_language(language)
    try:
        return film.with_captions(page)
    finally:
        use_language(before)


def with_both_themes(page: str, film_words: str) -> str:
    """Show the picture of the theme in force; of a film its scenes side by side, and itself where it is asked for."""

    def shown(found: re.Match[str]) -> str:
        alt, name, kind = found.groups()
        still = "-stills.png" if kind == "webp" else f".{kind}"
        stills = "".join(
            f"![{alt}]({name}{dark}{still}#only-{theme})" for theme, dark in (("light", ""), ("dark", "-dark"))
        )
        if kind != "webp":
            return stills
        film = "".join(
            f'<img alt="{alt}" src="{name}{dark}.webp#only-{theme}" loading="lazy">'
            for theme, dark in (("light", ""), ("dark", "-dark"))
        )
        return f"{stills}\n\n<details><summary>{film_words}</summary>{film}</details>"

    return IMAGE.sub(shown, page)


def example_pages() -> Mapping[str, str]:
    """Each script of `tests/examples` as a page: what it does, then its code; and a page that lists them."""
    pages = {
        script.stem: example_page(script)
        for script in sorted(EXAMPLES.glob("*.py"))
        if not script.stem.startswith(NOT_EXAMPLES)
    }
    firsts = (f"- [{title_of(name)}]({name}.md): {_first_sentence(EXAMPLES / f'{name}.py')}" for name in pages)
    head = (
        "# Examples\n\nA script for each task. They use public names alone, run as their pages say, and "
        "are run with every test of the project.\n\n"
    )
    return pages | {"index": head + "\n".join(firsts) + "\n"}


def example_page(script: Path) -> str:
    source = script.read_text(encoding="utf-8")
    reported = ast.get_docstring(ast.parse(source)) or ""
    code = source[source.index('"""', 3) + 3 :].strip()
    return f"# {title_of(script.stem)}\n\n{reported}\n\n```python\n{code}\n```\n"


def title_of(name: str) -> str:
    return name.replace("_", " ").capitalize()


def _first_sentence(script: Path) -> str:
    reported = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or ""
    return " ".join(reported.partition("\n\n")[0].split())


def columns_page() -> str:
    """What each column of each table means, as `columns.csv` has it; of left and right the left one represents both."""
    from app.exports.columns import KNOWN

    head = (
        "# What every column means\n\nAs `columns.csv` has it beside the tables. A column that begins with `left_` "
        "has a twin `right_`. Needs: `zero`, `sign` of the joint, `both_clocks` of the two legs; `parameter`: as the "
        "figure of the row.\n"
    )
    return head + "".join(_table(file) for file in KNOWN)


def _table(file: str) -> str:
    from app.exports.columns import KNOWN
    from core.parameters import unit_of

    def rows() -> Iterator[str]:
        for name, meaning in KNOWN[file].items():
            if name.startswith("right_") and name.replace("right_", "left_", 1) in KNOWN[file]:
                continue
            ends_in = unit_of(name)
            unit = (ends_in.in_files if ends_in is not None else "") if meaning.unit is None else meaning.unit
            cells = (f"`{name}`", unit, meaning.definition, meaning.sign, meaning.needs)
            yield f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |"

    return (
        f"\n## {file}\n\n| Column | Unit | Meaning | Sign | Needs |\n|---|---|---|---|---|\n" + "\n".join(rows()) + "\n"
    )
