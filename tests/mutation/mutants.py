"""Small changes of a source file, each of which a test should notice.

A mutant replaces one node of the syntax tree by another and leaves the rest of the text as it is. Annotations,
decorators, docstrings and the words of errors are left alone: no behaviour hangs on them.
"""

import ast
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

COMPARISONS: dict[type[ast.cmpop], tuple[str, ...]] = {
    ast.Lt: ("<=", ">="),
    ast.LtE: ("<", ">"),
    ast.Gt: (">=", "<="),
    ast.GtE: (">", "<"),
    ast.Eq: ("!=",),
    ast.NotEq: ("==",),
    ast.Is: ("is not",),
    ast.IsNot: ("is",),
    ast.In: ("not in",),
    ast.NotIn: ("in",),
}
ARITHMETIC: dict[type[ast.operator], str] = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.FloorDiv: "/",
    ast.Mod: "*",
    ast.Pow: "*",
    ast.BitAnd: "|",
    ast.BitOr: "&",
    ast.LShift: ">>",
    ast.RShift: "<<",
}
SYMMETRIC = {"min", "max", "np.minimum", "np.maximum"}  # whose arguments may change places


@dataclass(frozen=True, slots=True)
class Mutant:
    """A source file with one node replaced: lines and columns of the node as `ast` counts them, in bytes."""

    file: str
    line: int
    end_line: int
    start: int
    end: int
    replacement: str
    before: str
    after: str
    number: int = 0

    @property
    def name(self) -> str:
        """The same for the same change of the same line of code, wherever the line is."""
        reported = "\0".join([self.file, self.before, self.after, str(self.number)])
        return hashlib.sha256(reported.encode()).hexdigest()[:12]

    def applied(self, source: str) -> str:
        """The source with the node replaced."""
        lines = source.encode().splitlines(keepends=True)
        head = b"".join(lines[: self.line - 1]) + lines[self.line - 1][: self.start]
        tail = lines[self.end_line - 1][self.end :] + b"".join(lines[self.end_line :])
        return (head + self.replacement.encode() + tail).decode()


def mutants_of(source: str, file: str) -> list[Mutant]:
    """Every mutant of a module, in the order of its text; some are no Python."""
    lines = source.encode().splitlines()
    found: dict[tuple[int, int, int, str], Mutant] = {}
    seen: dict[tuple[str, str], int] = {}
    for node, replacement in _changes(ast.parse(source)):
        line, end_line = node.lineno, node.end_lineno or node.lineno
        start, end = node.col_offset, node.end_col_offset or 0
        was = source_of(lines, line, end_line, start, end)
        key = (line, start, end, replacement)
        if replacement == was or key in found:
            continue
        first, last = lines[line - 1][:start].decode(), lines[end_line - 1][end:].decode()
        before = " ".join(f"{first}{was}{last}".split())
        after = " ".join(f"{first}{replacement}{last}".split())
        mutant = Mutant(file, line, end_line, start, end, replacement, before, after, seen.get((before, after), 0))
        if before == after:
            continue
        seen[before, after] = mutant.number + 1
        found[key] = mutant
    return sorted(found.values(), key=lambda one: (one.line, one.start, one.replacement))


def source_of(lines: list[bytes], line: int, end_line: int, start: int, end: int) -> str:
    if line == end_line:
        return lines[line - 1][start:end].decode()
    parts = [lines[line - 1][start:], *lines[line : end_line - 1], lines[end_line - 1][:end]]
    return b"\n".join(parts).decode()


def compiles(source: str) -> bool:
    """Whether this is Python."""
    try:
        compile(source, "mutant", "exec", dont_inherit=True)
    except (SyntaxError, ValueError):
        return False
    return True


Change = tuple[ast.stmt | ast.expr, str]


def _changes(tree: ast.Module) -> Iterator[Change]:
    for node in _behaving(tree):
        if isinstance(node, ast.stmt):
            yield from _of_statement(node)
        elif isinstance(node, ast.expr):
            yield from _of_expression(node)


def _behaving(node: ast.AST) -> Iterator[ast.AST]:
    """The node and all below it on which behaviour hangs."""
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "type_params") or isinstance(node, ast.Raise):
            continue
        children = value if isinstance(value, list) else [value]
        for child in children:
            if isinstance(child, ast.JoinedStr | ast.Import | ast.ImportFrom):
                continue
            if isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant):
                continue  # a docstring
            if isinstance(child, ast.AST):
                yield from _behaving(child)


def _of_statement(node: ast.stmt) -> Iterator[Change]:
    match node:
        case ast.Expr(value=ast.Call()):
            yield node, "pass"
        case ast.AugAssign(target=target, op=op, value=value):
            yield node, "pass"
            if other := ARITHMETIC.get(type(op)):
                yield node, f"{ast.unparse(target)} {other}= {ast.unparse(value)}"
        case ast.Return(value=ast.expr() as value) if not isinstance(value, ast.Constant):
            yield node, "return None"
        case ast.If(test=test) | ast.While(test=test) if not isinstance(test, ast.Compare | ast.Constant):
            yield test, f"not ({ast.unparse(test)})"
        case ast.Break():
            yield node, "continue"
        case ast.Continue():
            yield node, "break"


def _of_expression(node: ast.expr) -> Iterator[Change]:
    match node:
        case ast.Compare(ops=[op], left=left, comparators=[right]):
            for other in COMPARISONS[type(op)]:
                yield node, f"{ast.unparse(left)} {other} {ast.unparse(right)}"
        case ast.Compare(ops=[op, *_]):
            for other in COMPARISONS[type(op)]:
                yield node, _with_operator(node, other)
        case ast.BinOp(op=ast.MatMult(), left=left, right=right):
            yield node, f"{_in_brackets(right)} @ {_in_brackets(left)}"
        case ast.BinOp(op=op, left=left, right=right) if type(op) in ARITHMETIC:
            yield node, f"({_in_brackets(left)} {ARITHMETIC[type(op)]} {_in_brackets(right)})"
        case ast.BoolOp(op=op, values=values):
            joint = " or " if isinstance(op, ast.And) else " and "
            yield node, f"({joint.join(_in_brackets(value) for value in values)})"
        case ast.UnaryOp(op=ast.Not() | ast.USub() | ast.Invert(), operand=operand):
            yield node, _in_brackets(operand)
        case ast.IfExp(test=test, body=body, orelse=orelse):
            yield node, f"({ast.unparse(orelse)} if {ast.unparse(test)} else {ast.unparse(body)})"
        case ast.Constant(value=value):
            yield from ((node, other) for other in _other_constants(value))
        case ast.Call(func=called, args=[first, second, *_]) if ast.unparse(called) not in SYMMETRIC:
            if not isinstance(first, ast.Starred) and not isinstance(second, ast.Starred):
                yield from _exchanged(node, first, second)
        case ast.Dict(values=values):
            for one, next_one in pairwise(values):
                yield from _exchanged(node, one, next_one)
        case ast.Tuple(elts=elements, ctx=ast.Load()) | ast.List(elts=elements, ctx=ast.Load()):
            for one, next_one in pairwise(elements):
                yield from _exchanged(node, one, next_one)


def _other_constants(value: object) -> Iterator[str]:
    match value:
        case bool():
            yield str(not value)
        case int():
            yield str(value + 1)
        case float():
            yield repr(2.0 * value if value else 1.0)
        case str() if value:
            yield repr(value + value[:1])
        case bytes() if value:
            yield repr(value + value[:1])


def _in_brackets(node: ast.expr) -> str:
    text = ast.unparse(node)
    return text if isinstance(node, ast.Name | ast.Attribute | ast.Call | ast.Subscript | ast.Constant) else f"({text})"


def _with_operator(node: ast.Compare, other: str) -> str:
    """A chain of comparisons with another first operator."""
    rest = ast.Compare(node.comparators[0], node.ops[1:], node.comparators[1:])
    return f"{ast.unparse(node.left)} {other} {ast.unparse(rest)}"


def _exchanged(node: ast.expr, one: ast.expr, other: ast.expr) -> Iterator[Change]:
    """The node with two of its children in each other's place."""
    if ast.unparse(one) == ast.unparse(other):
        return

    class Exchange(ast.NodeTransformer):
        def visit(self, child: ast.AST) -> ast.AST:
            if child is one:
                return other
            return one if child is other else self.generic_visit(child)

    # the transformer changes what it visits, so that it visits twice: there and back
    changed = ast.unparse(Exchange().visit(node))
    Exchange().visit(node)
    yield node, changed


def all_mutants(root: Path, package: str) -> list[Mutant]:
    """Mutants of all modules in a folder and below it, or of one module."""
    place = root / package
    files = [place] if place.is_file() else sorted(f for f in place.rglob("*.py") if f.name != "__init__.py")
    found: list[Mutant] = []
    for path in files:
        found += mutants_of(path.read_text(encoding="utf-8"), path.relative_to(root).as_posix())
    return found


def chosen(root: Path, mutants: list[Mutant], count: int, seed: int) -> list[Mutant]:
    """`count` mutants as if at random; a change of one line of code changes the choice of that line only."""
    found: list[Mutant] = []
    for one in sorted(mutants, key=lambda one: hashlib.sha256(f"{seed} {one.name}".encode()).digest()):
        if len(found) < count and compiles(one.applied((root / one.file).read_text(encoding="utf-8"))):
            found.append(one)
    return found
