"""Make the tables of requirements, risks and use errors: `python packaging/safety_tables.py`.

`packaging/safety/*.toml` is written by hand: each requirement with the tests that hold it, each risk with the
requirements that control it, each use error with the message it meets. From these come the tables beside them, in
which every control leads to its tests. They are made for reading and with every build, and are not committed. What
does not fit together is printed, nothing is written then, and a test fails: a requirement without a test, a test,
script or message that is not there, a risk without a control, a promise of the threat model or of SECURITY.md that no
test holds.
"""

import ast
import re
import sys
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
SAFETY = ROOT / "packaging" / "safety"
TEMPLATE = ROOT / "resources" / "locale" / "gaitwright.pot"
ID = re.compile(r"R-[A-Z]{2,3}-\d\d")
TABLES = ("requirements.md", "risks.md", "use_errors.md")  # made here, and ignored by git
MESSAGE = re.compile(r'(?m)^msgid(?:_plural)? ((?:".*"\n)+)')
NODE = re.compile(r"tests/[\w/]+\.py::test_\w+")
SCRIPT = re.compile(r"`python -m (tests[\w.]+)")
NOTE = re.compile(r"\[\^([\w-]+)\]")  # beside a promise: which tests hold it
NOTES = re.compile(r"^\[\^([\w-]+)\]: (.+(?:\n    .+)*)", re.MULTILINE)
PROMISED = ("threat_model.md", "SECURITY.md")
FILE = re.compile(r"\b(?:app|core|devices|packaging|resources|tests)/[\w/-]+\.(?:py|toml|md)\b")
TO_COME = {"packaging/build.py"}  # of the installers
MADE = "Made by `python packaging/safety_tables.py` from `{source}`, which is what to change.\n"
LONG = " (long)"
RECORDINGS = "test_data"  # the fixture that skips where the shared recordings are not at hand
SEVERITIES = (1, 2, 3, 4)
PROBABILITIES = (1, 2, 3, 4)
ACCEPTED, REDUCED = 4, 6  # severity times probability: up to here accepted; up to here if nothing more can be done


@dataclass(frozen=True, slots=True)
class Requirement:
    """One sentence that can be false, its tests, and the source that asks for it."""

    id: str
    states: str
    source: str
    tests: tuple[str, ...]
    runs: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Risk:
    """A hazard and how it leads to harm; `before` and `after` the controls are severity and probability."""

    id: str
    hazard: str
    sequence: str
    harm: str
    before: tuple[int, int]
    after: tuple[int, int]
    controls: tuple[str, ...]
    residual: str


@dataclass(frozen=True, slots=True)
class UseError:
    """What somebody may do wrong, how it is noticed, which message follows, and the tests of both.

    `messages` are keys of findings in `app.wording`'s SENTENCES, or sentences of the catalogue as the code has them.
    """

    id: str
    error: str
    scenario: str
    detection: str
    messages: tuple[str, ...]
    tests: tuple[str, ...]
    left: str


@dataclass(frozen=True, slots=True)
class FoundTest:
    """A test as its file has it."""

    is_long: bool
    needs_recordings: bool


def read(name: str) -> dict[str, Any]:
    return tomllib.loads((SAFETY / name).read_text(encoding="utf-8"))


def requirements() -> list[Requirement]:
    return [Requirement(**_tuples(entry)) for entry in read("requirements.toml")["requirement"]]


def risks() -> list[Risk]:
    return [Risk(**_tuples(entry)) for entry in read("risks.toml")["risk"]]


def use_errors() -> list[UseError]:
    return [UseError(**_tuples(entry)) for entry in read("use_errors.toml")["use_error"]]


def _tuples(entry: Mapping[str, Any]) -> dict[str, Any]:
    return {name: tuple(value) if isinstance(value, list) else value for name, value in entry.items()}


@cache
def tests_of(file: str) -> dict[str, FoundTest]:
    """Give the tests of a file by name, without running or importing it; none where there is no such file."""
    path = ROOT / file
    if not path.is_file():
        return {}
    body = ast.parse(path.read_text(encoding="utf-8")).body
    functions = {node.name: node for node in body if isinstance(node, ast.FunctionDef)}
    asked = {name: {argument.arg for argument in one.args.args} for name, one in functions.items()}
    recorded = {RECORDINGS}
    while more := {name for name, arguments in asked.items() if arguments & recorded} - recorded:
        recorded |= more  # tests, and the file's fixtures that stand between
    marks = [node.value for node in body if isinstance(node, ast.Assign) and _names(node) == {"pytestmark"}]
    is_all_long = any("endurance" in ast.unparse(mark) for mark in marks)
    return {  # of a parametrised test some cases may be long: it is not
        name: FoundTest(
            is_all_long or any(ast.unparse(mark) == "pytest.mark.endurance" for mark in one.decorator_list),
            name in recorded,
        )
        for name, one in functions.items()
        if name.startswith("test_")
    }


def _names(node: ast.Assign) -> set[str]:
    return {target.id for target in node.targets if isinstance(target, ast.Name)}


def find_test(node: str) -> FoundTest | None:
    file, _, name = node.partition("::")
    return tests_of(file).get(name)


def faults() -> list[str]:
    """Say what does not fit together."""
    known = requirements()
    ids = {one.id for one in known}
    return [
        *faults_of_requirements(known, set(read("requirements.toml")["sources"])),
        *faults_of_risks(risks(), ids),
        *faults_of_use_errors(use_errors()),
        *faults_of_pages(ids),
    ]


def faults_of_requirements(known: Sequence[Requirement], sources: set[str]) -> Iterator[str]:
    yield from _twice(one.id for one in known)
    for one in known:
        if ID.fullmatch(one.id) is None:
            yield f"{one.id} is no id, such as R-REC-01"
        if one.source not in sources:
            yield f"{one.id}: the source {one.source!r} is not among the sources"
        yield from _missing(one.id, one.tests)
        tests = [found for test in one.tests if (found := find_test(test)) is not None]
        if all(test.needs_recordings or test.is_long for test in tests):
            yield f"{one.id}: no test of the default run holds it where the shared recordings are not at hand"
        yield from _missing_scripts(one.id, one.runs)


def faults_of_risks(entries: Sequence[Risk], known: set[str]) -> Iterator[str]:
    yield from _twice(one.id for one in entries)
    for one in entries:
        if not one.controls:
            yield f"{one.id} has no control"
        yield from (f"{one.id}: there is no requirement {name}" for name in one.controls if name not in known)
        for severity, probability in (one.before, one.after):
            if severity not in SEVERITIES or probability not in PROBABILITIES:
                yield f"{one.id}: {severity} x {probability} is not on the scale"
        if level(one.after) > level(one.before) or level(one.after) > REDUCED:
            yield f"{one.id}: the controls leave {level(one.after)} of {level(one.before)}"


def faults_of_use_errors(entries: Sequence[UseError]) -> Iterator[str]:
    yield from _twice(one.id for one in entries)
    sentences = sentences_of_screen()
    for one in entries:
        yield from _missing(one.id, one.tests)
        if not one.messages:
            yield f"{one.id} meets no message"
        yield from (f"{one.id}: no message reads {text!r}" for text in one.messages if text not in sentences)


def faults_of_pages(known: set[str]) -> Iterator[str]:
    """Tests, files and requirements that the pages written by hand name."""
    by_hand = [page for page in sorted(SAFETY.glob("*.md")) if page.name not in TABLES]
    for page in [*by_hand, ROOT / "SECURITY.md"]:
        text = page.read_text(encoding="utf-8")
        yield from _missing_ones(page.name, NODE.findall(text))
        gone = {file for file in FILE.findall(text) if not (ROOT / file).is_file()} - TO_COME
        yield from (f"{page.name}: there is no file {file}" for file in sorted(gone))
        yield from (f"{page.name}: there is no requirement {name}" for name in ID.findall(text) if name not in known)
        if page.name in PROMISED:
            yield from faults_of_promises(page.name, text)


def faults_of_promises(page: str, text: str) -> Iterator[str]:
    """What is promised in a table or list without a note of its tests, and notes without a test or a promise."""
    body = NOTES.sub("", text)
    notes, named = dict(NOTES.findall(text)), set(NOTE.findall(body))
    yield from (f"{page}: no test holds: {promise}" for promise in promises(body) if NOTE.search(promise) is None)
    yield from (f"{page}: there is no note {name}" for name in sorted(named - notes.keys()))
    yield from (f"{page}: nothing is promised by the note {name}" for name in sorted(notes.keys() - named))
    for name, note in notes.items():
        tests = [found for test in NODE.findall(note) if (found := find_test(test)) is not None]
        if all(test.needs_recordings or test.is_long for test in tests) is not note.endswith(LONG):
            yield f"{page}: {name} is held by long tests alone where its note ends with{LONG}, and only there"
        yield from _missing_scripts(page, SCRIPT.findall(note))


def promises(body: str) -> Iterator[str]:
    """Rows of tables with a column "held by", and the list of what is defended."""
    for table in re.findall(r"^\|.+\| held by \|\n\|[-|]+\|\n((?:\|.+\n)+)", body, re.MULTILINE):
        yield from table.splitlines()
    _, _, after = body.partition("## What is defended\n")
    defended, _, _ = after.partition("\n## ")
    yield from (" ".join(item.split()) for item in re.split(r"^- ", defended, flags=re.MULTILINE)[1:])


def _missing_scripts(whose: str, runs: Iterable[str]) -> Iterator[str]:
    for run in runs:
        place = ROOT / run.replace(".", "/")
        if not place.with_suffix(".py").is_file() and not (place / "__main__.py").is_file():
            yield f"{whose}: there is no script {run}"


def _missing(whose: str, tests: Sequence[str]) -> Iterator[str]:
    if not tests:
        yield f"{whose} has no test"
    yield from _missing_ones(whose, tests)


def _missing_ones(whose: str, tests: Iterable[str]) -> Iterator[str]:
    yield from (f"{whose}: there is no test {test}" for test in tests if find_test(test) is None)


def _twice(ids: Iterable[str]) -> Iterator[str]:
    seen: set[str] = set()
    for one in ids:
        if one in seen:
            yield f"{one} is there twice"
        seen.add(one)


@cache
def sentences_of_screen() -> dict[str, str]:
    """Give every sentence of the screen as the code has it; a finding's by its key, too."""
    if str(ROOT) not in sys.path:
        sys.path.insert(0, str(ROOT))  # a script sees its own folder only
    from app.wording.findings import SENTENCES

    template = TEMPLATE.read_text(encoding="utf-8")  # which tests/app/test_translation.py keeps current
    every: list[str] = [ast.literal_eval(f"({quoted})") for quoted in MESSAGE.findall(template)]
    return {text: text for text in every if text} | SENTENCES


def level(risk: tuple[int, int]) -> int:
    """Severity times probability."""
    severity, probability = risk
    return severity * probability


def pages() -> dict[str, str]:
    """Give the tables by their file's name."""
    known = {one.id: one for one in requirements()}
    made = _requirements_page(list(known.values())), _risks_page(risks(), known), _use_errors_page(use_errors())
    return dict(zip(TABLES, made, strict=True))


def _requirements_page(known: Sequence[Requirement]) -> str:
    texts = read("requirements.toml")
    tests = {test for one in known for test in one.tests}
    long = sum(found.is_long for test in tests if (found := find_test(test)))
    lines = [
        "# Requirements and the tests that hold them",
        "",
        MADE.format(source="requirements.toml"),
        f"{len(known)} requirements, {len(tests)} tests, of which {long} are long: they run with `python3 "
        "packaging/test.py -m endurance`. The tests of one requirement run with `python3 packaging/test.py -m "
        "\"requirement(id='R-REC-01')\"`. Scripts are started by hand; their last results stand in "
        "[evidence.md](evidence.md).",
        "",
        "Where they come from:",
        "",
        *(f"- **{name}**: {what}" for name, what in texts["sources"].items()),
        "",
    ]
    for prefix, title in texts["groups"].items():
        lines += [f"## {title}", "", "| id | what must hold | from | shown by |", "|---|---|---|---|"]
        for one in known:
            if one.id.startswith(f"R-{prefix}-"):
                shown = [_test(test) for test in one.tests] + [f"script `python -m {run}`" for run in one.runs]
                lines.append(f"| {one.id} | {one.states} | {one.source} | {'<br>'.join(shown)} |")
        lines.append("")
    return "\n".join(lines)


def _risks_page(entries: Sequence[Risk], known: Mapping[str, Requirement]) -> str:
    lines = [
        "# Risks and their controls",
        "",
        MADE.format(source="risks.toml"),
        *read("risks.toml")["introduction"].strip().splitlines(),
        "",
        "| id | hazard | harm | before | controls | after |",
        "|---|---|---|---|---|---|",
        *(
            f"| {one.id} | {one.hazard} | {one.harm} | {_level(one.before)} | {', '.join(one.controls)} "
            f"| {_level(one.after)} |"
            for one in entries
        ),
    ]
    for one in entries:
        lines += ["", f"## {one.id} {one.hazard}", "", f"- **How it comes about**: {one.sequence}"]
        lines += [f"- **Harm**: {one.harm}. Before {_level(one.before)}, after {_level(one.after)}.", "- **Controls**:"]
        for control in (known[name] for name in one.controls):
            lines += [f"    - {control.id}: {control.states}", *(f"        - {_test(test)}" for test in control.tests)]
        lines.append(f"- **What is left**: {one.residual}")
    return "\n".join([*lines, ""])


def _use_errors_page(entries: Sequence[UseError]) -> str:
    sentences = sentences_of_screen()
    lines = ["# Use errors", "", MADE.format(source="use_errors.toml")]
    lines += read("use_errors.toml")["introduction"].strip().splitlines()
    for one in entries:
        lines += [
            "",
            f"## {one.id} {one.error}",
            "",
            f"- **Scenario**: {one.scenario}",
            f"- **Noticed**: {one.detection}",
        ]
        for text in one.messages:
            key = "" if sentences[text] == text else f"`{text}`: "
            lines.append(f"- **Message**: {key}{sentences[text]}")
        lines += [f"- **Tests**: {', '.join(map(_test, one.tests))}", f"- **What is left**: {one.left}"]
    return "\n".join([*lines, ""])


def _level(risk: tuple[int, int]) -> str:
    return f"{risk[0]} × {risk[1]} = {level(risk)}"


def _test(node: str) -> str:
    found = find_test(node)
    return f"`{node}`{LONG if found is not None and found.is_long else ''}"


if __name__ == "__main__":
    if wrong := faults():
        sys.exit("\n".join(wrong))
    for name, text in pages().items():
        (SAFETY / name).write_text(text, encoding="utf-8", newline="\n")
        print(SAFETY / name)
