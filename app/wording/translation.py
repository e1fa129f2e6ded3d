"""Translation of every message to the clinician: what happened, then what to do or what follows.

English is the source; other languages come from the gettext catalogues in `resources/locale`, which
`packaging/catalogue.py` gathers from the code: whatever is shown is as it is inside `tr` or `tr_n`, or inside `later`
where it is written down before it is shown.
"""

import gettext
from collections.abc import Callable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from string import Formatter
from typing import Any

from app.wording.pseudo_language import PseudoLanguage

DOMAIN = "gaitwright"
LOCALE = Path(str(files("resources") / "locale"))
_catalogue = gettext.NullTranslations()
_language = "en"
# each in its own words, for who does not understand those in sight
LANGUAGES = {"en": "English", "de": "Deutsch"}
WITH_COMMAS = {"de"}  # languages that write fractions so


class _CommaFormatter(Formatter):
    """Gives fractions a decimal comma; what only looks like one, as a version, keeps its point."""

    def format_field(self, value: Any, format_spec: str) -> str:
        text: str = super().format_field(value, format_spec)
        return text.replace(".", ",") if isinstance(value, float) else text


_COMMAS = _CommaFormatter()


class _CommaSentence(str):
    """A sentence of a language that writes fractions with a comma."""

    __slots__ = ()

    def format(self, *args: object, **values: object) -> str:
        return _COMMAS.vformat(self, args, values)

    def format_map(self, values: Mapping[str, object], /) -> str:  # type: ignore[override]  # as the built-in one is called
        return _COMMAS.vformat(self, (), values)


def _spoken(message: str, language: str) -> str:
    return _CommaSentence(message) if language in WITH_COMMAS else message


def use_language(language: str) -> None:
    """Use `language`, as "de", where a catalogue exists, else English; "pseudo": lengthened English for tests."""
    global _catalogue, _language
    _language = language if gettext.find(DOMAIN, LOCALE, languages=[language]) else "en"
    if language == "pseudo":
        _catalogue = PseudoLanguage()
    else:
        _catalogue = gettext.translation(DOMAIN, LOCALE, languages=[language], fallback=True)


def languages() -> tuple[str, ...]:
    """Give the languages there are, English first, as "de"."""
    return ("en", *sorted(file.parts[-3] for file in LOCALE.glob(f"*/LC_MESSAGES/{DOMAIN}.mo")))


def spoken_in(language: str) -> Callable[[str], str]:
    """Return what gives messages in another language than the user's, as a page for somebody else; else English."""
    catalogue = gettext.translation(DOMAIN, LOCALE, languages=[language], fallback=True)
    return lambda message: _spoken(catalogue.gettext(message), language)


def spoken_language() -> str:
    """Give the language that is spoken now, as "de"."""
    return _language


def tr(message: str) -> str:
    """Give the message in the user's language."""
    return (
        _spoken(_catalogue.gettext(message), _language) if message else ""
    )  # gettext's answer to nothing is the catalogue's head


def tr_n(one: str, many: str, count: int) -> str:
    """Give the message in the user's language, in the form that belongs to `count`, as `{count} strides`."""
    return _spoken(_catalogue.ngettext(one, many, count), _language)


def figure_text(value: float, spec: str, language: str = "") -> str:
    """Write a number by a format of Python's, as ".1f", with the decimal mark of the user's language or of another."""
    text = format(value, spec)
    return text.replace(".", ",") if (language or _language) in WITH_COMMAS else text


def short_figure(value: float, decimals: int) -> str:
    """Write a number without noughts that say nothing: 15, 82.5."""
    written = figure_text(value, f".{decimals}f")
    return written.rstrip("0").rstrip(".,") if decimals else written


def later(message: str) -> str:
    """Mark for the catalogue a message that is written here but shown, through `tr`, later: as a constant is."""
    return message


PURPOSE = later("Research use. Not a medical device.")  # stays on every screen, page and export


def filled(message: str, values: Mapping[str, object]) -> str:
    """Give what was refused elsewhere in the user's language, its braces filled; none are looked for without values."""
    stated = tr(message)
    return stated.format(**values) if values else stated


def capitalised(text: str) -> str:
    """Begin as a sentence begins; the rest keeps its letters, as a sensor's name must."""
    return text[:1].upper() + text[1:]


def within_sentence(name: str) -> str:
    """Give a name that begins with a capital as it is written inside a sentence; German nouns keep theirs."""
    return name if _language == "de" else name[:1].lower() + name[1:]


def joined(names: Sequence[str]) -> str:
    """Put names into a row as a sentence has them: "L thigh, L shank and R foot"."""
    if len(names) < 2:
        return "".join(names)
    return tr("{first} and {last}").format(first=", ".join(names[:-1]), last=names[-1])
