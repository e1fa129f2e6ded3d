"""Tests that every sentence on the screen passes the catalogue. Every page has the room for a longer language."""

import ast
import importlib
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from string import Formatter

import pytest

from app.wording.body import name_of
from app.wording.findings import SENTENCES, sentence
from app.wording.pseudo_language import lengthened
from app.wording.translation import later, tr, tr_n, use_language
from core.body import Joint
from core.findings import Finding, Severity

ROOT = Path(__file__).parents[2]
ROOMS = (
    *("main_window.py", "home", "widgets", "results", "editing", "help", "plots", "wizard", "workers"),
    "summary/walk_figures.py",
)

SPOKEN = {"tr", "tr_n", "later"}
# what takes strings that nobody sees: logs, keys, signals, names of attributes and threads
UNSEEN = re.compile(
    r"(^|\.)(_log\.\w+|QKeySequence|QShortcut|Signal|Thread|getattr|import_module|TypeVar|strftime"
    r"|setObjectName|setStyle|setStyleSheet|recordings\.mark)$"  # a mark is data
)
UNSEEN_ERRORS = re.compile(
    r"^(ValueError|TypeError|RuntimeError|KeyError|LookupError|AssertionError|NotImplementedError)"
)
UNSEEN_ARGUMENTS = {"tone"}
REFUSALS = re.compile(r"(Library|Refused|Busy|Fault|Allowed|Meanwhile)\w*Error$")
SAME_EVERYWHERE = {"Gaitwright"}
AS_IN_FILES = {"free motion", "parallel bars"}  # data, which are put into words where they are shown

WORDS = re.compile(r"[^\W\d_]{2,}[.,:;]? [^\W\d_]{2,}|^[A-Z][a-z]{2,}[.,:]?$")
WORD_BESIDE_FIELD = re.compile(r"\b[^\W\d_]{2,}\b")
NO_WORDS = {"gaitwright", "replay", "ms", "mm", "Hz", "kHz", "MB", "GB", "SD", "min", "rad", "dB", "px"}


def is_words(text: str) -> bool:
    return text not in SAME_EVERYWHERE | AS_IN_FILES and WORDS.search(text) is not None


def is_sentence_with_fields(node: ast.JoinedStr) -> bool:
    stated = [part.value for part in node.values if isinstance(part, ast.Constant) and isinstance(part.value, str)]
    words = [word for piece in stated if " " in piece for word in WORD_BESIDE_FIELD.findall(piece)]
    return any(word not in NO_WORDS for word in words)


def untranslated(tree: ast.Module) -> Iterator[int]:
    """Find the lines where words are written that reach the screen past the catalogue."""
    for node in ast.iter_child_nodes(tree):
        yield from _untranslated(node)


def _untranslated(node: ast.AST) -> Iterator[int]:
    match node:
        case ast.Expr(value=ast.Constant()) | ast.Assert() | ast.MatchValue() | ast.Compare():
            return
        case ast.Call(func=func) if ast.unparse(func) in SPOKEN or UNSEEN.search(ast.unparse(func)):
            return
        case ast.Raise(exc=ast.Call(func=func)) if UNSEEN_ERRORS.match(ast.unparse(func)):
            return
        case ast.keyword(arg=name) if name in UNSEEN_ARGUMENTS:
            return
        case ast.Constant(value=str(text)) if is_words(text):
            yield node.lineno
        case ast.JoinedStr() if is_sentence_with_fields(node):
            yield node.lineno
        case ast.Dict(values=values):
            for value in values:
                yield from _untranslated(value)
        case ast.Subscript(value=value):
            yield from _untranslated(value)
        case ast.arg() | ast.AnnAssign(value=None):
            return  # a type may be written as text
        case ast.AnnAssign(value=ast.expr() as value):
            yield from _untranslated(value)
        case ast.FunctionDef(body=body, args=arguments):
            for part in (*body, *arguments.defaults):
                yield from _untranslated(part)
        case _:
            for part in ast.iter_child_nodes(node):
                yield from _untranslated(part)


def test_words_that_pass_the_catalogue_by_are_found() -> None:
    shown = [
        'Text(look, "Joints")',
        'button.setAccessibleName(f"{side} leg")',
        'banner.tell("This is not one folder.", tr("Drop the folder."))',
        'HINT = "Pale: certainty."',
        'tr("Joints"), Text(look, f"{count} strides")',
        'words = {"no strides": "no strides at all"}["no strides"]',
    ]
    assert all(list(untranslated(ast.parse(line))) == [1] for line in shown)
    unseen = [
        'Text(look, tr("Joints"), tone="ink2")',
        'tr("{side} leg").format(side=side)',
        'HINT = later("Pale: certainty.")',
        '_log.info("the work ended early")',
        'raise ValueError("shape is wrong here")',
        'QShortcut(QKeySequence("Ctrl+D"), self)',
        'said = f"{speed:.2f} m/s, {lag} ms"',
        'choices: "list[QWidget] | None" = None',
    ]
    assert all(list(untranslated(ast.parse(line))) == [] for line in unseen)


@cache
def parsed(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


@pytest.fixture(autouse=True, scope="module")
def _let_go_of_files() -> Iterator[None]:
    """Looking through all of them for garbage before the next module takes a second."""
    yield
    parsed.cache_clear()


def screen_files() -> list[Path]:
    rooms = [ROOT / "app" / room for room in ROOMS]
    return sorted(file for room in rooms for file in ([room] if room.suffix else room.rglob("*.py")))


def test_every_sentence_on_the_screen_passes_the_catalogue() -> None:
    found = [
        f"{file.relative_to(ROOT).as_posix()}:{line}" for file in screen_files() for line in untranslated(parsed(file))
    ]
    assert found == [], "write tr(...) round what is shown, later(...) round a constant that is shown later"


def test_what_is_to_be_translated_is_written_out() -> None:
    # of an f-string, or of a sentence put together, the catalogue could not know the parts
    found = []
    for file in sorted((ROOT / "app").rglob("*.py")):
        for node in ast.walk(parsed(file)):
            if isinstance(node, ast.Call) and ast.unparse(node.func) in SPOKEN:
                count = 2 if ast.unparse(node.func) == "tr_n" else 1
                if any(isinstance(part, ast.JoinedStr | ast.BinOp) for part in node.args[:count]):
                    found.append(f"{file.relative_to(ROOT).as_posix()}:{node.lineno}")
    assert found == []


def test_no_refusal_of_the_library_is_put_together_past_the_catalogue() -> None:
    """Constants are gathered where they are raised; what has fields goes through tr(...) there."""
    found = []
    for file in sorted((ROOT / "app" / "storage").rglob("*.py")):
        for node in ast.walk(parsed(file)):
            if isinstance(node, ast.Call) and REFUSALS.search(ast.unparse(node.func)):
                stated = node.args
            elif isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) in ("what", "remedy", "problem"):
                stated = [node.value]
            else:
                continue
            found += [
                f"{file.relative_to(ROOT).as_posix()}:{one.lineno}"
                for one in stated
                if isinstance(one, ast.JoinedStr) and is_sentence_with_fields(one)
            ]
    assert found == [], "write tr(...).format(...)"


def test_every_refusal_of_the_devices_is_a_sentence_of_the_catalogue(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is no f-string, and there is a value for each of its braces."""
    monkeypatch.syspath_prepend(ROOT / "packaging")
    catalogue = importlib.import_module("catalogue")
    gathered = {message.id for message in catalogue.gathered()}
    count, found = 0, []
    for file in sorted((ROOT / "devices").rglob("*.py")):
        for call, stated in catalogue.refused(file):
            fields = {field for text in stated for _, field, *_ in Formatter().parse(text) if field}
            count += 1
            if (
                len(stated) != (1 if ast.unparse(call.func) == "ExpectedError" else 2)
                or not gathered.issuperset(stated)
                or fields != {one.arg for one in call.keywords}
            ):
                found.append(f"{file.relative_to(ROOT).as_posix()}:{call.lineno}")
    assert count > 50
    assert found == []


def test_no_constant_is_translated_before_a_language_is_chosen() -> None:
    found = []
    for file in sorted((ROOT / "app").rglob("*.py")):
        tree = parsed(file)
        bodies = [tree.body, *(node.body for node in ast.walk(tree) if isinstance(node, ast.ClassDef))]
        for body in bodies:
            for statement in body:
                if isinstance(statement, ast.Assign | ast.AnnAssign) and statement.value is not None:
                    lambdas = {id(k) for n in ast.walk(statement) if isinstance(n, ast.Lambda) for k in ast.walk(n)}
                    found += [
                        f"{file.relative_to(ROOT).as_posix()}:{node.lineno}"
                        for node in ast.walk(statement.value)
                        if isinstance(node, ast.Call)
                        and ast.unparse(node.func) in ("tr", "tr_n")
                        and id(node) not in lambdas
                    ]
    assert found == [], "write later(...) here, and tr(...) where it is shown"


def test_the_template_of_the_catalogues_holds_the_sentences_of_the_code(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "packaging")
    catalogue = importlib.import_module("catalogue")
    assert catalogue.TEMPLATE.read_bytes() == catalogue.template(), "run packaging/catalogue.py"


def test_the_pseudo_language_is_as_much_longer_as_german() -> None:
    stated = {message: lengthened(message) for message in ("Stop", "Open a session folder", *SENTENCES.values())}
    assert [message for message, longer in stated.items() if len(longer) < 1.3 * len(message)] == []
    assert [longer for longer in stated.values() if not re.fullmatch(r"\[.*\]", longer)] == []


def test_the_pseudo_language_leaves_the_figures_alone() -> None:
    def figures(message: str) -> list[list[str | None]]:
        return [field for _, *field in Formatter().parse(message) if field[0]]

    assert [message for message in SENTENCES.values() if figures(lengthened(message)) != figures(message)] == []


@pytest.mark.usefixtures("pseudo_language")
def test_another_language_is_spoken_from_now_on() -> None:
    assert tr("Stop") == "[Sttöp]"
    assert tr_n("{count} stride", "{count} strides", 1).format(count=1) == "[1 ssttrrïïddé]"
    assert tr_n("{count} stride", "{count} strides", 2).format(count=2).endswith("és]")
    assert name_of(Joint.LEFT_KNEE).startswith("[")
    assert sentence(Finding("simulated", Severity.INFO, "")).startswith("[")


def test_without_a_catalogue_english_is_spoken() -> None:
    use_language("fr")
    assert tr("Stop") == later("Stop") == "Stop"
    assert tr_n("{count} stride", "{count} strides", 2) == "{count} strides"
    assert tr("") == ""


def test_each_compiled_catalogue_is_that_of_its_translator(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "packaging")
    catalogue = importlib.import_module("catalogue")
    found = catalogue.translations()
    assert [one.parts[-3] for one in found] == ["de"]
    for one in found:
        assert one.with_suffix(".mo").read_bytes() == catalogue.compiled(one), "run packaging/catalogue.py"
