"""The site's pages, put together from the manual, from what is written for the site alone, and from the code itself.

Used by `build_site.py`. Nothing here needs the site's builder.
"""

import ast
import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
HELP = ROOT / "resources" / "help"
WRITTEN = ROOT / "packaging" / "site" / "pages"
EXAMPLES = ROOT / "tests" / "examples"
LANGUAGES = ("en", "de")
IMAGE = re.compile(r"!\[([^\]]*)\]\(([\w/-]+)\.(png|webp)\)")
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
            text = with_both_themes(page.read_text(encoding="utf-8"), FILM_WORDS[language])
            (folder / "manual" / page.name).write_text(text, encoding="utf-8")
        (folder / "reference").mkdir()
        shutil.copyfile(WRITTEN / "extra.css", folder / "extra.css")
        for page in (WRITTEN / language).glob("*.md"):
            text = with_both_themes(page.read_text(encoding="utf-8"), FILM_WORDS[language])
            place = folder if page.stem == "index" else folder / "reference"
            (place / page.name).write_text(text, encoding="utf-8")
    (into / "en" / "reference" / "columns.md").write_text(columns_page(), encoding="utf-8")
    (into / "en" / "examples").mkdir()
    for name, text in example_pages().items():
        (into / "en" / "examples" / f"{name}.md").write_text(text, encoding="utf-8")


def with_both_themes(page: str, film_words: str) -> str:
    """Show the picture of the theme in force; of a film its scenes side by side, and itself where it is asked for."""

    def shown(found: re.Match[str]) -> str:
        alt, name, kind = found.groups()
        stills = "".join(
            f"![{alt}]({name}{dark}{'-stills' if kind == 'webp' else ''}.png#only-{theme})"
            for theme, dark in (("light", ""), ("dark", "-dark"))
        )
        if kind == "png":
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
