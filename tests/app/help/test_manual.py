"""Tests of the manual:

every page is there in both languages. It has the names, keys, sentences and limits of the application.
"""

import math
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from babel.messages.pofile import read_po

from app.cli.parser import SUBCOMMANDS
from app.films.film import Film
from app.help.help_topics import Topic, help_file, topic_title
from app.summary.numbers_in_words import MARKS
from app.wording.translation import use_language
from core.signal.tracks import MAX_REPORTED_GAP_S
from core.verdicts.gates import LIMITS
from core.verdicts.measurement_error import SENTENCE_FACTORS, Mark, least_error
from core.verdicts.sigmas import ComparisonKind
from devices.catalogue import DRIVERS

ROOT = Path(__file__).parents[3]
HELP = ROOT / "resources" / "help"
FOLDERS = {"en": HELP, "de": HELP / "de"}
LANGUAGES = tuple(FOLDERS)
SITE = ROOT / "packaging" / "site" / "pages"  # of the project: its reference has the long tables of the manual

REFERENCE = ("limits", "validation")

# what is on keyboards and in no catalogue; figures, letters and signs are keys as they are
KEYS = {
    "en": {
        "Space",
        "Enter",
        "Esc",
        "Tab",
        "Shift",
        "Alt Left",
        "Ctrl Plus",
        "Ctrl Minus",
        "Ctrl 0",
        "Ctrl 1",
        "Ctrl 7",
    },
    "de": {
        *("Leertaste", "Eingabe", "Esc", "Tab", "Umschalt", "Alt Links"),
        *("Strg Plus", "Strg Minus", "Strg 0", "Strg 1", "Strg 7"),
    },
}
SIGN_OR_FUNCTION = re.compile(r"[A-Z0-9+−←→\[\],.]|F\d{1,2}")
FORBIDDEN_IN_GERMAN = re.compile(
    r"\b(bitte|ungültig\w*|fehlgeschlagen|fehlerhaft\w*|Normband|du|dein\w*|Befund\w*|Gangzyklus)\b|!", re.IGNORECASE
)


def text_of(language: str, topic: str) -> str:
    return (FOLDERS[language] / f"{topic}.md").read_text(encoding="utf-8")


def reference_of(language: str, page: str) -> str:
    return (SITE / language / f"{page}.md").read_text(encoding="utf-8")


def prose_of(language: str, topic: str) -> str:
    """Without commands and the names of files, which are alike in every language."""
    return re.sub(r"(?m)^    .*$|`[^`\n]*`", "", text_of(language, topic))


def plain(stated: str) -> str:
    """As a reader compares: hyphens and spaces of any kind alike."""
    return re.sub(
        r"\s+", " ", stated.replace("\N{NON-BREAKING HYPHEN}", "-").replace("\N{NO-BREAK SPACE}", " ")
    ).strip()


@cache
def sentences(language: str) -> tuple[str, ...]:
    """All that the application states in a language."""
    with (ROOT / "resources" / "locale" / "de" / "LC_MESSAGES" / "gaitwright.po").open("rb") as file:
        found = [(one.id, one.string) for one in read_po(file) if one.id]
    stated = [pair[language == "de"] for pair in found]
    return tuple(plain(form) for one in stated for form in ((one,) if isinstance(one, str) else one or ()))


@cache
def names(language: str) -> re.Pattern[str]:
    """What a control may be called: a whole message, its fields as anything, where more than fields is stated."""
    reported = {one for one in sentences(language) if "{" in one and re.search(r"\w{4,}", re.sub(r"\{.*?\}", " ", one))}
    return re.compile("|".join(re.sub(r"\\\{\w+\\\}", ".+", re.escape(one)) for one in reported if len(one) < 60))


def bold_of(language: str, topic: str) -> Iterator[str]:
    for found in re.findall(r"\*\*(.+?)\*\*", prose_of(language, topic), re.DOTALL):
        yield plain(found)


def is_known(language: str, name: str) -> bool:
    if name in KEYS[language] or name in sentences(language) or SIGN_OR_FUNCTION.fullmatch(name):
        return True
    return names(language).fullmatch(name) is not None


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_page_is_there_and_nothing_else(language: str) -> None:
    assert {file.stem for file in FOLDERS[language].glob("*.md")} == set(Topic)


def test_both_languages_have_the_same_headings_lists_tables_pictures_and_links() -> None:
    def shape(text: str) -> list[tuple[str, ...]]:
        return [
            *((one,) for one in re.findall(r"(?m)^(#+|- |\d\. )", text)),
            *(("|" * line.count("|"),) for line in re.findall(r"(?m)^\|.*$", text)),
            *(("(", one) for one in re.findall(r"\]\(([^)]+)\)", text)),
        ]

    for topic in Topic:
        assert shape(text_of("de", topic)) == shape(text_of("en", topic)), topic
    for page in REFERENCE:
        assert shape(reference_of("de", page)) == shape(reference_of("en", page)), page


def test_both_languages_name_the_same_files_and_commands() -> None:
    for topic in Topic:
        found = [set(re.findall(r"`([^`\n]+)`", text_of(language, topic))) for language in LANGUAGES]
        assert found[0] ^ found[1] == set(), topic


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_page_begins_with_its_title(language: str) -> None:
    use_language(language)
    try:
        wrong = [topic for topic in Topic if not text_of(language, topic).startswith(f"# {topic_title(topic)}\n")]
    finally:
        use_language("en")
    assert wrong == []


@pytest.mark.parametrize("language", LANGUAGES)
def test_what_is_bold_is_a_control_or_a_key_of_the_application(language: str) -> None:
    bold = [(topic, name) for topic in Topic for name in bold_of(language, topic)]
    assert len(bold) > 200
    assert [(topic, name) for topic, name in bold if not is_known(language, name)] == []


def test_a_name_that_is_on_no_control_is_found() -> None:
    assert not is_known("en", "Press me")
    assert not is_known("de", "New patient")
    assert is_known("en", "Include 13 strides")
    assert is_known("de", "13 Doppelschritte einbeziehen")


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_message_that_is_explained_is_one_of_the_application(language: str) -> None:
    def reported(words: str) -> str:
        return re.sub(r"\{[^}]*\}|\d+(?:[.,]\d+)?", "#", plain(words)).casefold()

    stated = "\n".join(reported(one) for one in sentences(language))
    rows = re.findall(r"(?m)^\| ([^|]+?) \|", text_of(language, Topic.MESSAGES))
    explained = [row for row in rows if not re.fullmatch(r"-+|Message|Meldung", row)]
    assert len(explained) > 50
    assert [row for row in explained if reported(row) not in stated] == []


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_link_leads_to_a_page_and_a_picture_is_there(language: str) -> None:
    text = "".join(text_of(language, topic) for topic in Topic)
    pictures = set(re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text))
    films = {f"films/{film}.webp" for film in Film}
    assert films <= pictures
    assert [name for name in pictures - films if not (FOLDERS[language] / name).is_file()] == []
    assert set(re.findall(r"\]\(([^)]+)\)", text)) - pictures <= {f"{topic}.md" for topic in Topic}
    shown = {name.removeprefix("pictures/").removesuffix(".png") for name in pictures - films}
    there = {file.stem.removesuffix("-dark") for file in (FOLDERS[language] / "pictures").glob("*.png")}
    assert there == shown


def test_german_keeps_to_the_words_of_the_clinic_and_writes_figures_with_a_comma() -> None:
    text = "".join(prose_of("de", topic) for topic in Topic)
    prose = re.sub(r"„[^“]*“", "", text.replace("![", "["))  # what is quoted is on the screen
    assert FORBIDDEN_IN_GERMAN.findall(prose) == []
    programs = "Python|LogAndStream|Bluetooth|Version|doi|OpenSim|ezc3d|c3d|kineticstoolkit|pyomeca"
    programs += "|fhir-resources|fhir|openpyxl|calamine|LibreOffice|deno"
    without_versions = re.sub(rf"({programs}) [\d./s-]+|(\d+\.){{3}}\d+", "", prose)
    assert re.findall(r"\d\.\d", without_versions) == []


def test_the_tables_of_accuracy_have_the_same_figures_in_both_languages() -> None:
    def figures(text: str) -> list[str]:
        rows = re.findall(r"(?m)^\|.*$", text)
        return [figure.replace(",", ".") for row in rows for figure in re.findall(r"[+-]?\d+(?:[.,]\d+)?", row)]

    assert figures(text_of("de", Topic.ACCURACY)) == figures(text_of("en", Topic.ACCURACY))
    for page in REFERENCE:
        assert figures(reference_of("de", page)) == figures(reference_of("en", page)), page


def limits() -> dict[str, str]:
    """Rows of the table of verdicts by their figures, which `core.verdicts.gates` has."""
    care, most = LIMITS.axis_sd_deg
    clock_care, clock_most = LIMITS.lag_sd_ms
    lost_care, lost_most = LIMITS.lost_percent
    return {
        "neighbours": f"{LIMITS.pairing_margin:g}",
        "axis": f"{care:g}° {most:g}°",
        "axis halves": "{:g}° {:g}°".format(*LIMITS.axis_halves_deg),
        "axis motions": "{:g}° {:g}°".format(*LIMITS.axis_motions_deg),
        "clock": f"{clock_care:g} ms {clock_most:g} ms",
        "lost": f"{1000 * MAX_REPORTED_GAP_S:g} ms {lost_care:g} % {lost_most:g} %",
        "clipped": f"{LIMITS.clipped_percent[1]:g} % {LIMITS.clipped_percent[1]:g} %",
        "rate": f"{LIMITS.rate_percent[0]:g} % {LIMITS.rate_percent[1]:g} %",
        "halves": f"{LIMITS.halves_deg:g}°, {LIMITS.halves_stance_points:g} {LIMITS.halves_time_percent:g} %",
        "thirds": f"{LIMITS.thirds_deg:g}°",
        "every second": f"{LIMITS.odd_even_ratio:g} ",
        "range": f"{LIMITS.knee_range_deg[0]:g} {LIMITS.knee_range_deg[1]:g}° {LIMITS.ankle_range_deg[0]:g} "
        f"{LIMITS.ankle_range_deg[1]:g}°",
        "stance": f"{LIMITS.stance_percent[0]:g} {LIMITS.stance_percent[1]:g} %",
        "lengths": f"{LIMITS.stride_length_percent:g} %",
        "speed": f"{LIMITS.speed_m_s[0]:g} {LIMITS.speed_m_s[1]:g} m/s",
    }


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_limits_of_the_verdicts_are_those_in_force(language: str) -> None:
    rows = re.findall(r"(?m)^\|.*$", reference_of(language, "limits"))
    reported = [re.findall(r"\d+(?:\.\d+)?", row.replace("1 SD", "").replace(",", ".")) for row in rows]
    required = {reason: re.findall(r"\d+(?:\.\d+)?", figures) for reason, figures in limits().items()}
    assert {reason: figures for reason, figures in required.items() if figures not in reported} == {}


USUAL = (  # means that the page names, with the unit and decimals of its table
    ("knee_range_deg", 60.0, "°", 1),
    ("ankle_range_deg", 28.0, "°", 1),
    ("stance_percent", 61.0, " points", 1),
    ("stride_length_m", 1.3, " cm", 0),
    ("speed_m_s", 1.2, " m/s", 2),
)


def least_difference(kind: ComparisonKind, column: str, mean: float, unit: str, digits: int) -> str:
    """What two means have to differ by at least, as the page writes it, with its dagger."""
    error, is_verified = least_error(column, kind, mean)
    if math.isnan(error):
        return ""
    size = 100 * error if unit == " cm" else error
    return f"{size:.{digits}f}{unit}{'' if is_verified else ' †'}"


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_least_differences_are_those_that_errors_are_made_of(language: str) -> None:
    kinds = (ComparisonKind.ATTACHED, ComparisonKind.LEGS, ComparisonKind.STRAPPINGS, ComparisonKind.VISITS)
    table = text_of(language, Topic.NUMBERS).partition("| Between |" if language == "en" else "| Zwischen |")[2]
    rows = re.findall(r"(?m)^\| ([^-].*) \|$", table)[: len(kinds)]
    for kind, row in zip(kinds, rows, strict=True):
        cells = [cell.strip().replace(",", ".").replace("Punkte", "points") for cell in row.split(" |")]
        assert cells[1:] == [least_difference(kind, *usual) for usual in USUAL], kind


def found_in_nine_of_ten() -> list[list[str]]:
    """The figures of each measure that `tests.benchmarks.power` has measured, as its README has them."""
    measured = (ROOT / "tests" / "benchmarks" / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"(?m)^\| (\w+) \| (.* % false.*) \|$", measured)
    figures = {
        column: [re.sub(r",.*| \(.*?\)", "", cell).strip(" -") for cell in row.split(" | ")] for column, row in rows
    }
    return list(figures.values())


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_changes_found_in_nine_of_ten_are_those_that_were_measured(language: str) -> None:
    head = "| Found in nine of ten |" if language == "en" else "| In neun von zehn gefunden |"
    table = reference_of(language, "limits").partition(head)[2].partition("\n\n")[0]
    rows = [re.sub(r"°| points| Punkte| m/s| s\b| m\b", "", row).replace(",", ".") for row in table.splitlines()[2:]]
    stated = sorted([cell.strip() for cell in row.strip("| ").split(" |")][1:] for row in rows)
    found = found_in_nine_of_ten()
    assert len(found) > 12
    assert stated == sorted(found)


@pytest.mark.parametrize("language", LANGUAGES)
def test_what_page_one_needs_is_what_is_in_force(language: str) -> None:
    text = reference_of(language, "limits").replace("\n", " ")
    tables_mark = text.partition("Tables mark" if language == "en" else "Tabellen markieren")[2].replace(",", ".")
    factors = dict.fromkeys(f"{SENTENCE_FACTORS[kind]:g}" for kind in SENTENCE_FACTORS)
    pattern = r"(\d\.\d+) times" if language == "en" else r"(\d\.\d+)-Fache"
    assert sorted(re.findall(pattern, tables_mark.partition("## ")[0])) == sorted(factors)


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_means_and_marks_of_the_least_differences_are_explained(language: str) -> None:
    text = text_of(language, Topic.NUMBERS)
    means = ("60°", "28°", "61 %", "1.3 m", "1.2 m/s")
    stated = (
        text.replace(",", ".").replace("\n", " ").partition("| Between |" if language == "en" else "| Zwischen |")[0]
    )
    assert [mean for mean in means if mean not in stated] == []
    for mark in (Mark.HEALTHY, Mark.ERROR):
        assert f"{MARKS[mark]} " in text
        assert f"{MARKS[mark]} " in reference_of(language, "limits")


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_driver_has_a_page_and_a_row_that_states_whether_it_was_tried(language: str) -> None:
    table = re.findall(
        r"(?m)^\| \[[^\]]+\]\((sensors-[\w-]+)\.md\) \|.*\| ([^|]+) \|$", text_of(language, Topic.SENSORS)
    )
    assert len(table) == len(DRIVERS)
    assert {page for page, _ in table} == {topic for topic in Topic if topic.startswith("sensors-")}
    untried = [tried for _, tried in table if tried in ("no", "nein")]
    stated = [
        driver for driver in DRIVERS if re.search(r"[Nn]o (?:recorded stream and no )?hardware|Not tried", driver.proof)
    ]
    assert len(untried) >= len(stated)


def test_a_page_that_a_language_lacks_is_shown_in_english() -> None:
    use_language("de")
    try:
        assert help_file("keys.md") == HELP / "de" / "keys.md"
        assert help_file("films.md") == HELP / "films.md"
    finally:
        use_language("en")
    assert help_file("keys.md") == HELP / "keys.md"


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_subcommand_has_its_row_on_the_page_of_the_command_line(language: str) -> None:
    rows = re.findall(r"(?m)^\| `([a-z]+)\b[^`]*` \|", text_of(language, Topic.COMMAND_LINE))
    assert sorted(rows) == sorted(SUBCOMMANDS)
