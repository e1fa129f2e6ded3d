"""Tests that the code keeps the rules of the house that no linter knows."""

import ast
import io
import re
import subprocess
import sys
import tokenize
import tomllib
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

import core
import devices

ROOT = Path(__file__).parents[1]
PACKAGES = ("app", "core", "devices")
FOLDERS = (*PACKAGES, "resources", "packaging", "tests", ".ci", ".github")
LOCK = (ROOT / "packaging" / "requirements.lock").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def python_files(*folders: str) -> list[Path]:
    return sorted(file for folder in folders for file in (ROOT / folder).rglob("*.py"))


def text_files() -> Iterator[tuple[Path, str]]:
    """Read every file of the project that is text."""
    files = [file for folder in FOLDERS for file in (ROOT / folder).rglob("*") if file.is_file()]
    files += [file for file in ROOT.iterdir() if file.is_file()]
    for file in files:
        if "__pycache__" not in file.parts:
            try:
                yield file, file.read_text(encoding="utf-8")
            except UnicodeDecodeError:
                continue


@cache
def parse(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


@cache
def nodes(file: Path) -> tuple[ast.AST, ...]:
    """All parts of a file: walking through it takes longer than reading it."""
    return tuple(ast.walk(parse(file)))


@pytest.fixture(autouse=True, scope="module")
def _let_go_of_files() -> Iterator[None]:
    """Millions of parts: looking through them for garbage before the next module takes seconds."""
    yield
    parse.cache_clear()
    nodes.cache_clear()


def place(file: Path, line: int) -> str:
    return f"{file.relative_to(ROOT).as_posix()}:{line}"


def imports(file: Path) -> Iterator[tuple[str, int]]:
    for node in nodes(file):
        if isinstance(node, ast.Import):
            yield from ((alias.name, node.lineno) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or "", node.lineno


@pytest.mark.parametrize(
    ("library", "only"), [("serial", "devices/transport/ports.py"), ("rerun", "app/review/rerun_log.py")]
)
def test_a_library_of_one_purpose_is_imported_by_one_file(library: str, only: str) -> None:
    found = [
        place(file, line)
        for file in python_files(*PACKAGES)
        for name, line in imports(file)
        if name.split(".")[0] == library and file != ROOT / only
    ]
    assert found == []


MOST_LATE_IMPORTS = (
    60  # each costs a reader a second place to look; what is left buys a start, or does without an extra
)


def late_imports(node: ast.AST, is_in_function: bool = False) -> Iterator[ast.stmt]:
    """The imports inside functions; what a type checker alone reads is none."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            continue
        if is_in_function and isinstance(child, ast.Import | ast.ImportFrom):
            yield child
        is_function = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef)
        yield from late_imports(child, is_in_function or is_function)


def test_imports_inside_functions_are_few_and_each_states_what_it_buys() -> None:
    found = [(file, one.lineno) for file in python_files(*PACKAGES) for one in late_imports(parse(file))]
    assert len(found) <= MOST_LATE_IMPORTS
    lines = {file: file.read_text(encoding="utf-8").splitlines() for file, _ in found}
    assert [place(file, line) for file, line in found if "  # " not in lines[file][line - 1]] == []


def test_the_opening_of_a_package_states_what_belongs_there_and_does_nothing() -> None:
    # core and devices offer their public names, the test below; app sets one switch of PySide6 and states why
    tops = {ROOT / package / "__init__.py" for package in PACKAGES}
    assert all(ast.get_docstring(parse(opening)) for opening in tops)
    for opening in {file for file in python_files(*PACKAGES) if file.name == "__init__.py"} - tops:
        (only,) = parse(opening).body
        assert isinstance(only, ast.Expr), opening
        assert isinstance(only.value, ast.Constant), opening


@pytest.mark.parametrize("package", ["core", "devices"])
def test_what_a_package_offers_is_there_and_its_opening_loads_nothing(package: str) -> None:
    program = f"import sys, {package}; print(*{{'numpy', 'scipy', 'serial'}} & set(sys.modules))"
    ran = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == ""
    offered, public = import_module(package), import_module(f"{package}.public")
    imports = [node for node in ast.walk(parse(ROOT / package / "public.py")) if isinstance(node, ast.ImportFrom)]
    for_checkers = {one.asname: node.module for node in imports for one in node.names if one.asname}
    assert for_checkers == public.MODULES
    assert set(offered.__all__) == set(public.MODULES)
    assert all(getattr(offered, name) is not None for name in offered.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = offered.nothing


def test_every_module_opens_with_what_it_is_about() -> None:
    assert [file for file in python_files(*PACKAGES, "packaging", "tests") if not ast.get_docstring(parse(file))] == []


def test_scripts_and_tests_are_no_packages_and_hide_none() -> None:
    # ours would stand before the library `packaging`, and before our own `core` in `tests/core`
    assert [file for file in python_files("packaging", "tests") if file.name == "__init__.py"] == []


COLOUR = re.compile(r"#(?:[0-9a-f]{3,4}|[0-9a-f]{6}|[0-9a-f]{8})\b|\brgba?\(", re.IGNORECASE)
COLOUR_MAKERS = {"QColor", "mkColor", "mkPen", "mkBrush", "QPen", "QBrush"}


def is_colour(node: ast.AST) -> bool:
    """Return whether this names a colour: in a string, as a constant of Qt, or as what makes one is given first."""
    match node:
        case ast.Constant(value=str(text)):
            return COLOUR.search(text) is not None
        case ast.Attribute(attr=name):
            return name == "GlobalColor"
        case ast.Call(func=maker, args=[ast.Constant(value=first), *_]) if first is not None:
            return ast.unparse(maker).split(".")[-1] in COLOUR_MAKERS
    return False


def colours(tree: ast.Module) -> list[int]:
    return colours_among(ast.walk(tree))


def colours_among(parts: Iterable[ast.AST]) -> list[int]:
    return [node.lineno for node in parts if isinstance(node, ast.expr) and is_colour(node)]


def test_a_colour_is_found_however_it_is_named() -> None:
    named = [
        '"#D55E00"',
        '"color: #fff;"',
        "QColor(0, 114, 178)",
        "pg.mkPen('r')",
        "Qt.GlobalColor.red",
        '"rgb(1, 2, 3)"',
    ]
    assert all(colours(ast.parse(line)) == [1] for line in named)
    assert colours(ast.parse('pen = QPen(theme.left, 1); none = pg.mkPen(None); anchor = "#12"')) == []


def test_only_one_file_names_a_colour() -> None:
    files = [file for file in python_files(*PACKAGES) if file != ROOT / "app" / "theme" / "colours.py"]
    assert [place(file, line) for file in files for line in colours_among(nodes(file))] == []


EXCEPTION = re.compile(r"#\s*(?:type: ignore|noqa)")
NAMED_EXCEPTION = re.compile(r"#\s*(?:type: ignore\[[\w-]+(?:, ?[\w-]+)*\]|noqa: ?[A-Z]+\d+(?:, ?[A-Z]+\d+)*)")


def unexplained(source: str) -> Iterator[int]:
    """Find the lines with an exception from a rule that name no rule or give no reason."""
    if not EXCEPTION.search(source):  # looked for first: taking a file apart takes long
        return
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT and EXCEPTION.search(token.string):
            reason, named = NAMED_EXCEPTION.subn("", token.string)
            if named != len(EXCEPTION.findall(token.string)) or len(re.findall(r"\w+", reason)) < 3:
                yield token.start[0]


def test_an_exception_without_rule_or_reason_is_found() -> None:
    bare = [
        "x = 1  # noqa",
        "x = 1  # noqa: E501",
        "x = 1  # type: ignore[arg-type]",
        "x = 1  # type: ignore  # stubs are wrong",
    ]
    assert all(list(unexplained(line)) == [1] for line in bare)
    assert list(unexplained("x = 1  # type: ignore[arg-type]  # the stubs lack QThread.start\n")) == []
    assert list(unexplained("x = 1  # noqa: N802 - the name is Qt's\n")) == []


def test_an_exception_from_a_rule_names_the_rule_and_its_reason() -> None:
    files = python_files(*PACKAGES, "packaging", "tests")
    assert [place(file, line) for file in files for line in unexplained(file.read_text(encoding="utf-8"))] == []


def test_no_file_states_where_packages_are_fetched_from() -> None:
    # in two parts, so that this file does not name them either
    hosts = [f"{name}.{end}" for name, end in (("pypi", "org"), ("pythonhosted", "org"), ("anaconda", "org"))]
    assert [str(file) for file, text in text_files() if any(host in text for host in hosts)] == []


def test_no_file_names_a_folder_of_one_machine() -> None:
    somebody = re.compile(r"(?<![\w.])/(?:home|Users)/\w")
    assert [str(file) for file, text in text_files() if somebody.search(text)] == []


def test_the_lock_holds_hashes_and_no_addresses() -> None:
    assert re.search(r"://|@ |--index|--extra-index|--find-links|--trusted-host", LOCK) is None
    entries = re.split(r"\n(?=[a-z])", LOCK[LOCK.index("\n", LOCK.rindex("# ")) :].strip())
    assert len(entries) > 10
    assert [
        entry
        for entry in entries
        if not re.match(r"[\w.-]+==[\w.]+[^\n]*(?: \\\n    --hash=sha256:[0-9a-f]{64})+$", entry)
    ] == []


def test_the_lock_holds_everything_the_project_asks_for() -> None:
    asked = PROJECT["project"]["dependencies"] + PROJECT["project"]["optional-dependencies"]["dev"]
    names = {re.split(r"[^\w.-]", requirement)[0].lower() for requirement in asked}
    assert names - set(re.findall(r"^([\w.-]+)==", LOCK, re.MULTILINE)) == set()


# what turns bytes of a file into running code, or a name inside of it into a path
UNSAFE_MODULES = {"pickle", "shelve", "marshal", "dill", "joblib", "cloudpickle", "yaml", "runpy", "code"}
UNSAFE_CALLS = {"eval", "exec", "extract", "extractall", "unpack_archive", "system", "popen"}
UNSAFE_ARGUMENTS = {"allow_pickle", "shell"}
FROM_THE_ASKING_PROCESS = "app/cohort/batch/executors.py"  # through a pipe that only the two have; no file is in it


def unsafe(parts: Iterable[ast.AST]) -> Iterator[int]:
    """Find the lines with what would run or unpack what is in a file."""
    for node in parts:
        match node:
            case ast.Import(names=names):
                named = {alias.name.split(".")[0] for alias in names}
            case ast.ImportFrom(module=str(module)):
                named = {module.split(".")[0]}
            case ast.Call(func=ast.Name(id="exec"), args=[ast.Constant()]):
                continue  # of our own words
            case ast.Call(func=ast.Name(id=name)) if name in UNSAFE_CALLS:
                named = UNSAFE_MODULES
            case ast.Call(func=ast.Attribute(value=ast.Name(id="os" | "shutil" | "archive" | "zipped"), attr=name)):
                named = UNSAFE_MODULES if name in UNSAFE_CALLS else set()
            case ast.Call(func=ast.Attribute(attr="extractall")):
                named = UNSAFE_MODULES
            case ast.keyword(arg=str(name), value=ast.Constant(value=True)) if name in UNSAFE_ARGUMENTS:
                named = UNSAFE_MODULES
            case _:
                continue
        if named & UNSAFE_MODULES:
            yield getattr(node, "lineno", 0)


def test_what_would_run_or_unpack_a_file_is_found() -> None:
    bad = [
        "import pickle",
        "from yaml import load",
        "eval(text)",
        "exec(text)",
        "archive.extractall(folder)",
        "shutil.unpack_archive(name)",
        "np.load(path, allow_pickle=True)",
        "subprocess.run(line, shell=True)",
    ]
    assert all(list(unsafe(ast.walk(ast.parse(line)))) == [1] for line in bad)
    good = [
        "dialog.exec()",
        "np.load(path, allow_pickle=False)",
        "archive.read(name)",
        "ast.literal_eval(text)",
        "exec('')",
    ]
    assert [line for line in good if list(unsafe(ast.walk(ast.parse(line))))] == []


def test_nothing_from_a_file_is_unpickled_run_or_unpacked() -> None:
    files = [file for file in python_files(*PACKAGES) if file != ROOT / FROM_THE_ASKING_PROCESS]
    assert [place(file, line) for file in files for line in unsafe(nodes(file))] == []


# what can call another computer, and the files that may: sensors, a clinic's server, workers of a batch
NETWORKS = re.compile(
    r"(socket|ssl|http|urllib\.request|ftplib|smtplib|webbrowser|requests|urllib3|httpx|aiohttp|websockets?|psycopg"
    r"|fsspec|s3fs|boto3|distributed|bleak|pylsl|zeroconf|PySide6\.Qt(Network|WebSockets|WebEngine)\w*)(\.|$)"
)
CALLERS = {
    *("bluetooth.py", "channels.py", "dot.py", "lsl.py", "networks.py", "search.py", "transports.py"),  # sensors
    *("engine.py", "journal_store.py", "logins.py"),  # the clinic's server and shared place
    *("cluster.py", "task.py"),  # a batch's workers, by --dask
    "web_socket.py",  # the live output: this computer alone
}


def test_what_can_call_another_computer_is_imported_by_known_files_only() -> None:
    found = {file.name for file in python_files(*PACKAGES) for name, _ in imports(file) if NETWORKS.match(name)}
    assert found == CALLERS


ARRAYS = {"FloatArray", "IntArray", "BoolArray", "ComplexArray"}
GIVES_NUMBERS = re.compile(r"\b(float|FloatArray|IntArray|BoolArray|ComplexArray)\b")


def section(docstring: str, title: str) -> str:
    """The text below a heading of a docstring, up to the next one; empty without it."""
    found = re.search(rf"^{title}\n-+\n(.*?)(?=^\w+\n-+\n|\Z)", docstring, re.MULTILINE | re.DOTALL)
    return found[1] if found else ""


def undocumented(function: ast.FunctionDef) -> list[str]:
    """What a function lacks that takes or gives numbers: a docstring, the shape of an array, what is returned."""
    docstring = ast.get_docstring(function)
    if docstring is None:
        return ["docstring"]
    shaped = re.findall(r"^(\w[\w, ]*) : .*\(.*\)", section(docstring, "Parameters"), re.MULTILINE)
    named = {name.strip() for names in shaped for name in names.split(",")}
    arguments = [*function.args.args, *function.args.kwonlyargs]
    arrays = [one.arg for one in arguments if one.annotation is not None and ast.unparse(one.annotation) in ARRAYS]
    returns = ast.unparse(function.returns) if function.returns is not None else ""
    is_silent = GIVES_NUMBERS.search(returns) is not None and not section(docstring, "Returns")
    return [f"shape of {name}" for name in arrays if name not in named] + (["Returns"] if is_silent else [])


def test_a_docstring_that_lacks_a_shape_or_what_is_returned_is_found() -> None:
    bare = "def f(v: FloatArray, k: int) -> float:\n    '''Length.'''"
    half = "def f(v: FloatArray) -> float:\n    '''Length.\n\n    Returns\n    -------\n    float\n        m.\n    '''"
    whole = half.replace("    Returns", "    Parameters\n    ----------\n    v : (3,)\n        m.\n\n    Returns")
    sources = ("def f() -> None: ...", bare, half, whole)
    functions = [node for source in sources for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)]
    assert [undocumented(function) for function in functions] == [
        ["docstring"],
        ["shape of v", "Returns"],
        ["shape of v"],
        [],
    ]


def test_a_public_function_states_what_its_numbers_are() -> None:
    """Public is what `__all__` names, and the paper's method; other functions have a line or two."""
    public = {*core.__all__, *devices.__all__}
    assert [
        f"{place(file, node.lineno)} {node.name}: {', '.join(lacking)}"
        for file in python_files("core", "devices")
        for node in parse(file).body
        if isinstance(node, ast.FunctionDef)
        and not node.name.startswith("_")
        and (node.name in public or "published" in file.parts)
        and (lacking := undocumented(node))
    ] == []


def test_a_function_of_core_and_devices_states_what_it_does() -> None:
    assert [
        f"{place(file, node.lineno)} {node.name}"
        for file in python_files("core", "devices")
        for node in parse(file).body
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_") and ast.get_docstring(node) is None
    ] == []


def classes_of(*rooms: str) -> dict[str, list[Path]]:
    """Every class by its name, with the files that define one of that name."""
    defined: dict[str, list[Path]] = {}
    for file in python_files(*rooms):
        for node in nodes(file):
            if isinstance(node, ast.ClassDef):
                defined.setdefault(node.name, []).append(file.relative_to(ROOT))
    return defined


def test_a_class_of_the_product_has_its_name_for_itself() -> None:
    assert {name: files for name, files in classes_of("app", "core", "devices").items() if len(files) > 1} == {}


def test_a_class_of_core_and_devices_shares_its_name_with_no_test() -> None:
    defined = classes_of(*PACKAGES, "packaging", "tests")
    ours = {"core", "devices", "tests/core", "tests/devices", "tests/examples"}
    assert {
        name: sorted(map(str, files))
        for name, files in defined.items()
        if len(files) > 1 and any(file.as_posix().startswith(tuple(f"{room}/" for room in ours)) for file in files)
    } == {}


def test_modules_of_core_and_devices_open_with_a_statement() -> None:
    files = python_files("core", "devices")
    assert [file for file in files if "?" in (ast.get_docstring(parse(file)) or "").partition("\n")[0]] == []


def private_lines(tree: ast.Module) -> set[int]:
    """Find the lines that reach for a private member of something else than `self` or `cls`."""
    return private_lines_among(ast.walk(tree))


def private_lines_among(parts: Iterable[ast.AST]) -> set[int]:
    return {
        node.lineno
        for node in parts
        if isinstance(node, ast.Attribute)
        and re.match(r"_[a-z]", node.attr)
        and not (isinstance(node.value, ast.Name) and node.value.id in ("self", "cls"))
    }


def test_gravity_and_the_unit_g_are_figures_of_one_module() -> None:
    """The simulation has its own: what is measured from its samples is not held against the same constant."""
    own = [ROOT / "devices" / folder for folder in ("simulation", "emulators")]
    files = [file for file in python_files(*PACKAGES) if not any(folder in file.parents for folder in own)]
    naming = {
        file.relative_to(ROOT).as_posix()
        for file in files
        if any(isinstance(node, ast.Constant) and node.value in (9.81, 9.80665) for node in nodes(file))
    }
    assert naming == {"core/samples.py"}


def test_a_private_member_of_another_is_found() -> None:
    lines = [
        "step._stop()",
        "self._stop()",
        "self.wizard._steps[0]._page",
        "page.rows",
        "one.__class__",
        "import_module",
    ]
    assert private_lines(ast.parse("\n".join(lines))) == {1, 3}


def test_tests_ask_the_public_side() -> None:
    # the list may only shrink: whoever mends a file lowers its number, or takes its line away
    listed = (ROOT / "tests" / "private_members.txt").read_text(encoding="utf-8").splitlines()
    allowed = {name: int(count) for count, name in (line.split() for line in listed)}
    found = {file.relative_to(ROOT).as_posix(): len(private_lines_among(nodes(file))) for file in python_files("tests")}
    assert {name: count for name, count in found.items() if count} == allowed


def test_widgets_hear_of_another_theme_from_qt() -> None:
    # the window keeps the size, the settings' controller is no widget; the other two are still to come
    known = {
        "app/main_window.py",
        "app/home/settings/controller.py",
        "app/home/patients/home_page.py",
        "app/plots/angle_chart.py",
    }
    found = {
        file.relative_to(ROOT).as_posix()
        for file in python_files("app")
        if "look.changed.connect(" in file.read_text(encoding="utf-8")
    }
    assert found <= known
