"""The longest files and functions and the most repeated lines of the product: `python -m tests.sizes`.

CI prints it after the checks and refuses nothing: a long table may be clear, and a short function may not be.
"""

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PRODUCT = ("app", "core", "devices", "packaging")
SHOWN = 10
RUN = 6  # lines in a row that are the same elsewhere


def modules() -> Iterator[tuple[str, str]]:
    """Give the name and the text of each module of the product but the steps between versions of the database."""
    for package in PRODUCT:
        for file in sorted((ROOT / package).rglob("*.py")):
            if "migrations" not in file.parts:
                yield file.relative_to(ROOT).as_posix(), file.read_text(encoding="utf-8")


def functions(name: str, text: str) -> Iterator[tuple[int, str]]:
    """Give the lines of each function of a module, without its docstring."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            first = node.body[1] if ast.get_docstring(node) and len(node.body) > 1 else node.body[0]
            yield (node.end_lineno or node.lineno) - first.lineno + 1, f"{name}:{node.lineno} {node.name}"


def repeated(texts: dict[str, str]) -> list[tuple[int, list[str]]]:
    """Give the runs of RUN lines that stand in several places, and where, the most frequent first."""
    places = defaultdict(list)
    for name, text in texts.items():
        code = re.sub(r'"""[\s\S]*?"""', lambda found: "\n" * found[0].count("\n"), text)
        lines = [
            (number, line.strip())
            for number, line in enumerate(code.splitlines(), 1)
            if len(line.strip()) > 3 and not re.match(r"\s*(from|import) |\s{4,}[\w]+,$", line)
        ]
        for at in range(len(lines) - RUN + 1):
            places["\n".join(line for _, line in lines[at : at + RUN])].append((name, lines[at][0]))
    runs = [where for where in places.values() if len(where) > 1]
    seen: set[tuple[str, int]] = set()
    found = []
    for where in sorted(runs, key=len, reverse=True):  # a longer run is many of RUN lines: it is listed once
        if not any((name, line - step) in seen for name, line in where for step in range(-2 * RUN, 2 * RUN)):
            found.append((len(where), [f"{name}:{line}" for name, line in where]))
        seen.update(where)
    return found


def main() -> None:
    texts = dict(modules())
    lines = {name: text.count("\n") for name, text in texts.items()}
    print(f"{sum(lines.values())} lines in {len(lines)} modules. The longest files:")
    for name, length in sorted(lines.items(), key=lambda item: -item[1])[:SHOWN]:
        print(f"  {length:5} {name}")
    print("The longest functions:")
    for length, name in sorted((one for item in texts.items() for one in functions(*item)), reverse=True)[:SHOWN]:
        print(f"  {length:5} {name}")
    print(f"Runs of {RUN} lines and more that stand in several places:")
    for number, where in repeated(texts)[:SHOWN]:
        print(f"  {number:5} {', '.join(where[:3])}")


if __name__ == "__main__":
    main()
