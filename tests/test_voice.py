"""The words that the voice of Gaitwright does not use: in sentences, docstrings and names."""

import ast
import inspect
import re
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import pytest
from babel.messages.pofile import read_po

ROOT = Path(__file__).parents[1]
TEMPLATE = ROOT / "resources" / "locale" / "gaitwright.pot"
BANNED = {
    *("told", "tell", "tells", "said", "says", "heard", "hears", "anew", "upon", "wished", "wanted"),
    *("stands", "withheld", "neighbour", "neighbours"),
}
# keys and columns of files, and what other libraries call so
ALLOWED_NAMES = frozenset({"withheld", "tell"})
# of people, who may stand and tell
ALLOWED_SENTENCES = re.compile(r"The patient stands near this computer meanwhile")
# people and feet, and the words of files' columns
ALLOWED_TEXTS = re.compile(r"patient stands|foot as it stands|\bwithheld\b")
WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
CODE = re.compile(r"`[^`]*`|\"[^\"]*\"|{\w*[^{}]*}")


def banned_in_text(text: str) -> set[str]:
    return set(re.findall(r"[a-z]+", CODE.sub(" ", text).lower())) & BANNED


@cache
def banned_in_name(name: str) -> set[str]:
    return {word.lower() for word in WORD.findall(name)} & BANNED if name not in ALLOWED_NAMES else set()


def python_files() -> list[Path]:
    folders = ("app", "core", "devices", "packaging", "tests")
    return sorted(file for folder in folders for file in (ROOT / folder).rglob("*.py"))


@dataclass(slots=True)
class Words:
    """What a file calls things and writes out, with the lines."""

    statement: str
    names: list[tuple[str, int]] = field(default_factory=list)
    docstrings: list[tuple[str, int]] = field(default_factory=list)
    texts: list[tuple[str, int]] = field(default_factory=list)  # help of the command line, definitions, refusals


@cache  # walking through a file takes longer than reading it
def words_of(file: Path) -> Words:
    tree = ast.parse(file.read_text(encoding="utf-8"))
    words = Words(ast.get_docstring(tree) or "")
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name) | ast.Attribute(attr=name):
                words.names.append((name, node.lineno))
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
                words.names.append((name, node.lineno))
            case ast.arg(arg=name):
                words.names.append((name, node.lineno))
            case ast.keyword(arg=str(name)):
                words.names.append((name, node.lineno))
            case ast.Constant(value=str(text)) if " " in text:
                words.texts.append((text, node.lineno))
        match node:
            case ast.Module() | ast.ClassDef() | ast.FunctionDef() | ast.AsyncFunctionDef():
                if stated := ast.get_docstring(node):
                    words.docstrings.append((stated, node.body[0].lineno))
    docstrings = {text for text, _ in words.docstrings}
    words.texts = [(text, line) for text, line in words.texts if inspect.cleandoc(text) not in docstrings]
    return words


@pytest.mark.parametrize("folder", ["app", "core", "devices", "packaging", "tests"])
def test_names_and_docstrings_use_the_words_of_the_field(folder: str) -> None:
    found = []
    for file in (file for file in python_files() if file.is_relative_to(ROOT / folder)):
        of_file, place = words_of(file), file.relative_to(ROOT).as_posix()
        found += [f"{place}:{line} {name}" for name, line in of_file.names if banned_in_name(name)]
        found += [
            f"{place}:{line} {sorted(words)}" for text, line in of_file.docstrings if (words := banned_in_text(text))
        ]
    assert found == []


def test_a_module_opens_with_a_statement() -> None:
    opened = {file: words_of(file).statement.split("\n\n")[0] for file in python_files()}
    assert [str(file.relative_to(ROOT)) for file, text in opened.items() if "?" in text] == []


def test_sentences_use_the_words_of_the_clinic() -> None:
    with TEMPLATE.open("rb") as file:
        messages = [message.id for message in read_po(file) if message.id]
    texts = [text for one in messages for text in ((one,) if isinstance(one, str) else one)]
    found = [text for text in texts if banned_in_text(ALLOWED_SENTENCES.sub("", text))]
    assert found == []
    assert [text for text in texts if text.endswith("!") or re.search(r"\bplease\b", text, re.IGNORECASE)] == []


@pytest.mark.parametrize("folder", ["app", "core", "devices", "packaging"])
def test_what_is_printed_uses_the_words_of_the_field(folder: str) -> None:
    found = []
    for file in sorted((ROOT / folder).rglob("*.py")):
        place = file.relative_to(ROOT).as_posix()
        for text, line in words_of(file).texts:
            if words := banned_in_text(ALLOWED_TEXTS.sub("", text)):
                found.append(f"{place}:{line} {sorted(words)} {text}")
    assert found == []


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("What is told of a walk.", {"told"}),
        ('Sensors that are `heard` stay, as "withheld" in a file does, and {wanted}.', set()),
        ("Begin anew, says Neighbours.", {"anew", "says", "neighbours"}),
    ],
)
def test_a_banned_word_is_found(text: str, words: set[str]) -> None:
    assert banned_in_text(text) == words


def test_a_banned_name_is_found() -> None:
    names = ("is_told", "HeardSensor", "unheard", "NOT_HEARD", "withheld", "told_s", "foretell", "understands")
    assert [name for name in names if banned_in_name(name)] == ["is_told", "HeardSensor", "NOT_HEARD", "told_s"]
