"""Each sentence has a German text, with the figures, spaces and marks of the English one."""

import ast
import importlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from string import Formatter

import numpy as np
import pytest
from babel.messages.pofile import read_po

from app.results.compared_words import unit_behind
from app.summary.measures import MEASURES
from app.summary.numbers_in_words import fixed, signed
from app.wording.body import name_of
from app.wording.findings import SENTENCES, sentence
from app.wording.translation import (
    capitalised,
    figure_text,
    languages,
    spoken_in,
    spoken_language,
    tr,
    tr_n,
    use_language,
    within_sentence,
)
from core.body import Joint
from core.findings import Finding, Severity

ROOT = Path(__file__).parents[2]
GERMAN = ROOT / "resources" / "locale" / "de" / "LC_MESSAGES" / "gaitwright.po"
TEMPLATE = ROOT / "resources" / "locale" / "gaitwright.pot"

# written alike in both, looked at one by one
ALIKE = {
    *("plantar", "dorsal", "April", "August", "September", "November", "Goniometer, {joint}", "Software", "Name"),
    *("Video", "Video: {what}"),
    *("Parquet", "Patient", "Passphrase", "Esc", "Xsens MTi", "Lab Streaming Layer", "Bias, °", "Band", "Band [1]"),
    *(
        "Band [2]",
        "Reference: {count} {group}, {speed_m_s:.2f} m/s, {source}.",
        "still",
        "CSV",
        "XLSX",
        "OpenSim",
        "FHIR",
        "WebSocket",
        "SACH",
    ),
    *(
        "Rerun",
        "Letter",
        "Rate",
        "Sensor",
        "x-io x-IMU3",
        "x-IMU (CSV)",
        "Shimmer3, LogAndStream",
        "Timed-up-and-go-Test",
        "Movella DOT",
        "Movella DOT, Bluetooth LE",
        "WitMotion, Bluetooth LE",
        "{words}, {dbm} dBm",
        "Live",
        "Filter",
        "Signal",
        "Firmware",
    ),
    *("ROM", "Ref. [1]", "Ref. [2]", "Details", "optional", "Status", "Position", "in {part}"),
    "{movement} ({high} minus {low})",
    "{count}\N{NO-BREAK SPACE}in\N{NO-BREAK SPACE}{part}",
}
UNITS = {"mm", "cm", "kg", "Hz", "SD", "min"}
ENGLISH = re.compile(r"\b(the|of|is|are|and|not|with|from|that|it|to|by|for|has|which|this|your|left|right)\b")
NAMED_ALIKE = {"rate of turn", "Timed-up-and-go"}  # a setting of other programs; a test, in German clinics too
# no word of this kind is stated about a person or a change; of two answers to the same data it may be
JUDGES = re.compile(r"\b(ab)?normal|\bsignificant|\bimprov|\bdeteriorat|\bpatholog|\bmostly\b", re.IGNORECASE)
URTEILT = re.compile(r"\b(ab)?normal|\bsignifikant|verbesser|verschlechter|patholog|\bauffällig", re.IGNORECASE)
COMPARES = re.compile(r"\b(better|worse)\b|\b(besser|schlechter)", re.IGNORECASE)
OF_DATA = re.compile(r"\bfits?\b|^As good as it gets$", re.IGNORECASE)
SHORTENED = {"Jan", "Feb", "Apr", "Aug", "Sep", "Oct", "Nov", "Dec"}  # with a point behind them


@dataclass(frozen=True, slots=True)
class Reported:
    english: str
    german: str


@cache
def read(file: Path) -> dict[tuple[str, ...], tuple[str, ...]]:
    """Give the messages of a catalogue, each with one form or two."""
    with file.open("rb") as content:
        found = read_po(content, abort_invalid=True)
    return {as_forms(one.id): as_forms(one.string) for one in found if one.id}


def as_forms(text: str | tuple[str, ...] | list[str] | None) -> tuple[str, ...]:
    return (text,) if isinstance(text, str) else tuple(text or ())


def pairs() -> Iterator[Reported]:
    for english, german in read(GERMAN).items():
        yield from (Reported(one, other) for one, other in zip(english, german, strict=True))


def fields(message: str) -> list[tuple[str, str | None]]:
    return sorted((field, form) for _, field, form, _ in Formatter().parse(message) if field)


def outer_spaces(message: str) -> tuple[str, str]:
    return message[: len(message) - len(message.lstrip())], message[len(message.rstrip()) :]


def last_mark(message: str) -> str:
    last = message.rstrip()[-1:]
    return last if last in ".?:,;!" else ""


def words_of(message: str) -> set[str]:
    without = re.sub(r"\{[^}]*\}", "", message)
    return set(re.findall(r"[^\W\d_]{2,}", without)) - UNITS


@pytest.fixture
def german() -> Iterator[None]:
    use_language("de")
    yield
    use_language("en")


def test_every_sentence_is_there_and_no_other() -> None:
    assert read(GERMAN).keys() ^ read(TEMPLATE).keys() == set()
    assert [pair for pair in pairs() if not pair.german.strip()] == []


def test_one_and_many_keep_their_two_forms() -> None:
    assert [english for english, german in read(GERMAN).items() if len(english) != len(german)] == []
    assert max(map(len, read(GERMAN))) == 2


def test_its_figures_are_those_of_the_english_sentence() -> None:
    assert [pair for pair in pairs() if fields(pair.english) != fields(pair.german)] == []


def test_no_sentence_of_the_catalogue_judges() -> None:
    judging = [pair for pair in pairs() if JUDGES.search(pair.english) or URTEILT.search(pair.german)]
    assert judging == []
    comparing = [pair for pair in pairs() if COMPARES.search(pair.english) or COMPARES.search(pair.german)]
    assert len(comparing) > 5
    assert [pair for pair in comparing if not OF_DATA.search(pair.english)] == []


def test_its_outer_spaces_and_last_marks_are_kept() -> None:
    reported = [pair for pair in pairs() if pair.english not in SHORTENED]
    assert [pair for pair in reported if outer_spaces(pair.english) != outer_spaces(pair.german)] == []
    assert [pair for pair in reported if last_mark(pair.english) != last_mark(pair.german)] == []


def test_what_must_not_be_broken_is_not_in_either() -> None:
    assert [p for p in pairs() if p.english.count("\N{NO-BREAK SPACE}") != p.german.count("\N{NO-BREAK SPACE}")] == []
    assert [pair for pair in pairs() if pair.english.count("\n") != pair.german.count("\n")] == []


def test_quotation_marks_are_german_and_closed() -> None:
    low, high = "\N{DOUBLE LOW-9 QUOTATION MARK}", "\N{LEFT DOUBLE QUOTATION MARK}"
    wrong = "\N{RIGHT DOUBLE QUOTATION MARK}"
    assert [pair for pair in pairs() if pair.german.count(low) != pair.german.count(high) or wrong in pair.german] == []
    assert [p for p in pairs() if p.english.count(high) != p.german.count(low) and low not in p.german] == []


def test_nothing_is_left_in_english() -> None:
    assert [p.german for p in pairs() if p.english == p.german and words_of(p.english) and p.english not in ALIKE] == []
    reported = [re.sub("|".join(NAMED_ALIKE), "", re.sub(r"\{[^}]*\}", "", pair.german)) for pair in pairs()]
    assert [german for german in reported if ENGLISH.search(german)] == []


def test_figures_written_in_a_sentence_have_a_comma() -> None:
    in_german = re.compile(r"(?<![\d.{:/])\d+\.\d+(?![\d.]*[}\d/])")
    assert [pair.german for pair in pairs() if in_german.search(pair.german)] == []


def test_a_key_that_is_shown_is_the_one_that_is_pressed() -> None:
    """Letters that also are shortcuts stay; names of keys are those on a German keyboard."""
    stated = {pair.english: pair.german for pair in pairs()}
    assert {key: stated[key] for key in ("Q", "F", "G", "E", "F1", "Esc")} == {
        key: key for key in ("Q", "F", "G", "E", "F1", "Esc")
    }
    keys = {english: german for english, german in stated.items() if re.fullmatch(r"Ctrl [A-Z]", english)}
    assert keys
    assert {english.replace("Ctrl", "Strg") for english in keys} == set(keys.values())


@pytest.mark.usefixtures("german")
def test_german_is_spoken_once_it_is_chosen() -> None:
    assert languages() == ("en", "de")
    assert spoken_language() == "de"
    assert name_of(Joint.LEFT_KNEE) == "Knie links"
    assert tr_n("{count} stride", "{count} strides", 1).format(count=1) == "1 Doppelschritt"
    assert tr_n("{count} stride", "{count} strides", 2).format(count=2) == "2 Doppelschritte"
    assert sentence(Finding("simulated", Severity.INFO, "")).startswith("Diese Daten sind simuliert.")


@pytest.mark.usefixtures("german")
def test_a_noun_keeps_its_capital_inside_a_sentence() -> None:
    assert within_sentence("Knie, Bewegungsumfang") == "Knie, Bewegungsumfang"
    use_language("en")
    assert within_sentence("Knee range") == "knee range"
    assert capitalised(within_sentence("Knee range")) == "Knee range"


def test_every_finding_has_its_german_sentence() -> None:
    stated = {pair.english: pair.german for pair in pairs()}
    assert [key for key, english in SENTENCES.items() if stated.get(english, english) == english] == []


def test_the_catalogue_is_compiled_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "packaging")
    catalogue = importlib.import_module("catalogue")
    assert GERMAN.with_suffix(".mo").read_bytes() == catalogue.compiled(GERMAN), "run packaging/catalogue.py"


@pytest.mark.usefixtures("german")
def test_a_fraction_has_a_comma_and_what_only_looks_like_one_its_point() -> None:
    stated = tr("Walking speeds: {first} and {second} m/s.")
    assert stated.format(first=1.05, second="1.2.3") == "Gehgeschwindigkeiten: 1,05 und 1.2.3 m/s."
    assert stated.format_map({"first": np.float64(0.5), "second": 2}) == "Gehgeschwindigkeiten: 0,5 und 2 m/s."
    assert (figure_text(-1.25, "+.1f"), figure_text(1.25, ".2f", "en")) == ("-1,2", "1.25")
    assert (fixed(-0.04, 1), signed(0.0, 1), signed(2.5, 1)) == ("0,0", "0,0", "+2,5")
    use_language("en")
    assert (figure_text(1.25, ".2f"), figure_text(1.25, ".2f", "de")) == ("1.25", "1,25")
    assert (
        tr("Walking speeds: {first} and {second} m/s.").format(first=1.05, second=1.1)
        == "Walking speeds: 1.05 and 1.1 m/s."
    )
    assert spoken_in("de")("{value} degrees").format(value=1.5) == "1,5 Grad"


WITH_POINTS = (  # files, drawings and what a terminal prints: read by programs, or English throughout
    *("app/cohort/", "app/exports/", "app/review/", "app/charts/drawing.py", "app/charts/on_paper.py"),
    *(
        "app/reports/patient/trend_chart.py",
        "app/reports/agreement/printed.py",
        "app/reports/agreement/tables.py",
    ),
    *("app/exports/csv_report.py", "app/summary/targets.py", "app/cli/compare.py", "app/cli/import_files.py"),
    *("app/summary/alignments.py", "app/cohort/study/groups.py", "app/summary/drawn_legs.py", "app/system/tables.py"),
)


def fractions_in(source: str) -> Iterator[int]:
    """Find the lines on which a text takes a fraction in without `figure_text`; an SVG's attributes need the point."""
    parts = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.JoinedStr)]
    for text in parts:
        stated = "".join(str(part.value) for part in text.values if isinstance(part, ast.Constant))
        is_svg = '="' in stated or stated.startswith("M")
        for part in text.values:
            spec = ast.unparse(part.format_spec) if isinstance(part, ast.FormattedValue) and part.format_spec else ""
            if re.search(r"\.([1-9]|\{.*\})[fg]|^f?['\"]g", spec) and not is_svg:
                yield part.lineno


def test_a_fraction_that_goes_round_the_language_is_found() -> None:
    assert list(fractions_in("f'{a:.1f}'\nf'{a:+.{n}f} s'\nf'{a:.0f}'\nf'x=\"{a:.1f}\"'\nf'{a:g} mm'\nf'{a}'")) == [
        1,
        2,
        5,
    ]


@pytest.mark.endurance
def test_every_fraction_on_a_screen_or_page_has_the_mark_of_its_language() -> None:
    files = [file for file in sorted((ROOT / "app").rglob("*.py")) if "_csv" not in file.name]
    named = {file.relative_to(ROOT).as_posix(): file for file in files}
    shown = {name: file.read_text(encoding="utf-8") for name, file in named.items() if not name.startswith(WITH_POINTS)}
    assert len(shown) > 300
    assert [f"{name}:{line}" for name, source in shown.items() for line in fractions_in(source)] == []


def test_a_unit_in_a_sentence_of_compare_is_german() -> None:
    cadence = next(one for one in MEASURES if one.unit == "steps/min")
    assert unit_behind(cadence) == "\N{NO-BREAK SPACE}steps/min"
    use_language("de")
    try:
        assert unit_behind(cadence) == "\N{NO-BREAK SPACE}Schritte/min"
    finally:
        use_language("en")
