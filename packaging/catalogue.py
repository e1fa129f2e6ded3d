"""Gather every sentence of the screen for the translators: `python packaging/catalogue.py`.

Writes `resources/locale/gaitwright.pot`, the template of all catalogues, and compiles the catalogue of each language.
The template names the file of a sentence and not its line, so that it changes only when a sentence does.
"""

import ast
import io
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from functools import cache
from importlib import import_module
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po

ROOT = Path(__file__).resolve().parents[1]
TEMPLATE = ROOT / "resources" / "locale" / "gaitwright.pot"
TAKERS = {"tr": 1, "tr_n": 2, "later": 1}  # of app.wording.translation, with the number of sentences each takes
# which are put into the user's language where they are shown: what, remedy; of some the first is the place
REFUSALS = {
    "SourceRefusedError": 0,
    "DotRefusedError": 0,
    "MemoryFullError": 0,
    "OwnClockError": 0,
    "BluetoothMissingError": 0,
    "OtherStreamError": 0,
    "CameraLostError": 0,
    "FileRefusedError": 1,
    "ExpectedError": 0,
    "LibraryError": 0,
    "ClipRefusedError": 0,
    "LibraryBusyError": 0,
    "LibraryFaultError": 0,
    "ChangedMeanwhileError": 0,
    "NotAllowedError": 0,
    "KeyRefusedError": 0,
    "JournalRefusedError": 1,
}

UNDATED = datetime(2026, 1, 1, tzinfo=UTC)  # the same sentences give the same file
HEAD = b"""\
# Every sentence that Gaitwright shows. Made by packaging/catalogue.py; change the sentences in the code.
msgid ""
msgstr ""
"Project-Id-Version: gaitwright\\n"
"MIME-Version: 1.0\\n"
"Content-Type: text/plain; charset=utf-8\\n"
"Content-Transfer-Encoding: 8bit\\n"

"""


def sentences(file: Path) -> Iterator[str | tuple[str, ...]]:
    """Find what is passed to the functions of `app.wording`, in the order of reading; one and many as a pair."""
    calls = [node for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))) if isinstance(node, ast.Call)]
    for call in sorted(calls, key=lambda call: (call.lineno, call.col_offset)):
        function = call.func.id if isinstance(call.func, ast.Name) else ""
        taken = call.args[: TAKERS.get(function, 0)]
        stated = [one.value for one in taken if isinstance(one, ast.Constant) and isinstance(one.value, str)]
        if stated and len(stated) == len(taken):
            yield stated[0] if len(stated) == 1 else tuple(stated)
        if function in REFUSALS:
            reported = call.args[REFUSALS[function] :]
            yield from (one.value for one in reported if isinstance(one, ast.Constant) and isinstance(one.value, str))


def refused(file: Path) -> Iterator[tuple[ast.Call, list[str]]]:
    """Find what a module of `devices` refuses, and the sentences for that: in place, or by a constant's name."""
    module = import_module(".".join(file.relative_to(ROOT).with_suffix("").parts))
    for call in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in REFUSALS:
            at = REFUSALS[call.func.id]
            reported = [one.value if isinstance(one, ast.Constant) else one for one in call.args[at:]]
            named = [getattr(module, one.id, None) if isinstance(one, ast.Name) else one for one in reported]
            yield call, [one for one in named if isinstance(one, str)]


def stated_in_part(file: Path) -> Iterator[str]:
    """Find what a module of `devices` writes out of a refusal whose other words somebody else has."""
    for call in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute) and call.func.attr == "stated_elsewhere":
            yield from (one.value for one in call.args if isinstance(one, ast.Constant) and isinstance(one.value, str))


@cache
def gathered() -> Catalog:
    """Return every sentence of `app`, those of findings, and the refusals and drivers of `devices`."""
    catalogue = Catalog(charset="utf-8")
    for file in sorted((ROOT / "app").rglob("*.py")):
        for message in sentences(file):
            catalogue.add(message, locations=[(file.relative_to(ROOT).as_posix(), 0)])
    sys.path.insert(0, str(ROOT))  # a script sees its own folder only
    for file in sorted((ROOT / "devices").rglob("*.py")):
        for message in (*(stated for _, both in refused(file) for stated in both), *stated_in_part(file)):
            catalogue.add(message, locations=[(file.relative_to(ROOT).as_posix(), 0)])
    from app.wording.findings import NAMES, SENTENCES
    from devices.catalogue import DRIVERS

    words = [word for names in NAMES.values() for word in names.values()]
    for message in (*SENTENCES.values(), *words):
        catalogue.add(message, locations=[("app/wording/findings.py", 0)])
    for driver in DRIVERS:
        catalogue.add(driver.name, locations=[("devices/catalogue.py", 0)])
    return catalogue


def template() -> bytes:
    """Give what the file holds, without the time it was made: the same sentences give the same file."""
    text = io.BytesIO()
    write_po(text, gathered(), omit_header=True, include_lineno=False, sort_by_file=True)
    return HEAD + text.getvalue()


def translations() -> list[Path]:
    """Give the catalogues that translators write."""
    return sorted(TEMPLATE.parent.glob("*/LC_MESSAGES/*.po"))


def compiled(catalogue: Path) -> bytes:
    """Give a catalogue as the program reads it."""
    with catalogue.open("rb") as file:
        found = read_po(file, abort_invalid=True)
    found.creation_date = found.revision_date = UNDATED
    text = io.BytesIO()
    write_mo(text, found)
    return text.getvalue()


if __name__ == "__main__":
    TEMPLATE.parent.mkdir(exist_ok=True)
    TEMPLATE.write_bytes(template())
    print(TEMPLATE.relative_to(ROOT))
    for one in translations():
        one.with_suffix(".mo").write_bytes(compiled(one))
        print(one.with_suffix(".mo").relative_to(ROOT))
