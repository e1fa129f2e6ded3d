"""Setup of every test: no screen, repeatable examples, the shared recordings, and a look at what was left."""

import gc
import os
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

os.environ["QT_QPA_PLATFORM"] = "offscreen"  # before anything imports Qt
os.environ["PYSIDE6_OPTION_LAZY"] = "0"  # as the application has it
os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before anything imports numpy: small matrices, two cores

import pytest
from hypothesis import settings
from PySide6.QtCore import QEvent, QThread, QTimer
from PySide6.QtWidgets import QApplication, QWidget

from tests.crashed import pytest_handlecrashitem as pytest_handlecrashitem  # noted for packaging/test.py
from tests.simulated import STORE
from tests.waiting import wait_patiently
from tests.wrappers import Wrappers

# a deadline fails tests on a busy machine; a new seed in every run of CI fails changes that are innocent of it
settings.register_profile("here", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "here")


REQUIREMENTS = Path(__file__).parents[1] / "packaging" / "safety" / "requirements.toml"
COLLECTIONS = 60  # of young objects, until the old ones are looked through: that takes a while
_BEGUN: set[Path] = set()
_WRAPPERS = Wrappers()
_WRAPPERS.watch()
wait_patiently()
gc.disable()  # for good: what is imported is there to stay, and the rest is collected between tests


def pytest_configure(config: pytest.Config) -> None:
    if cache := getattr(config, "cache", None):
        STORE.open(cache.mkdir("simulated"))


def pytest_unconfigure() -> None:
    """Let Python end what was passed over: DuckDB's binding states each of its objects that is left, on 45 lines."""
    gc.unfreeze()


@pytest.hookimpl(tryfirst=True)  # before tests are chosen by their marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put on each test the requirements that it holds: `pytest -m "requirement(id='R-REC-01')"`."""
    held: dict[str, list[str]] = {}
    for one in tomllib.loads(REQUIREMENTS.read_text(encoding="utf-8"))["requirement"]:
        for test in one["tests"]:
            held.setdefault(test, []).append(one["id"])
    for item in items:
        for requirement in held.get(item.nodeid.partition("[")[0], ()):
            item.add_marker(pytest.mark.requirement(id=requirement))


@pytest.fixture(scope="session")
def test_data() -> Callable[[str], Path]:
    """Find a file or folder of the shared recordings, as `test_data("hinge_mechanical")`, or skip the test."""
    reported = os.environ.get("GAITWRIGHT_TEST_DATA")

    def find(path: str) -> Path:
        if not reported:
            pytest.skip("GAITWRIGHT_TEST_DATA does not name the folder of shared recordings")
        found = Path(reported) / path
        if not found.exists():
            pytest.skip(f"the shared recordings hold no {path}")
        return found

    return find


@pytest.fixture(autouse=True, scope="session")
def _no_data_of_the_user(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep what the program keeps for its user, as the key of pseudonyms, out of the folders of whoever runs tests."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("XDG_DATA_HOME", str(tmp_path_factory.mktemp("data")))
        yield


@pytest.hookimpl(tryfirst=True)  # before the module's own fixtures, which are let go of with it
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Keep what is there when a module begins, and do not look through it again: that would take a minute in all."""
    if item.path not in _BEGUN:
        _BEGUN.add(item.path)
        gc.collect()
        gc.freeze()


@pytest.fixture(autouse=True)
def _garbage_on_one_thread() -> Iterator[None]:
    """Collect between tests only, as the application does between frames: what a thread freed of Qt would crash."""
    gc.disable()
    yield
    gc.collect() if gc.get_count()[2] > COLLECTIONS else gc.collect(1)


@pytest.fixture(autouse=True)
def wrappers() -> Iterator[Wrappers]:
    """Fail a test during which an object of Qt ended on another thread than the screen's: it would crash some day."""
    yield _WRAPPERS
    assert _WRAPPERS.taken() == [], "held last by another thread: let the screen's thread hold it longer"


@pytest.fixture(autouse=True)
def _nothing_left_behind(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Fail a test after which a thread or timer still runs or a widget still exists."""
    started: list[Any] = []
    for kind in (QThread, QTimer):
        monkeypatch.setattr(kind, "start", _noting(kind.start, started))
    before = set(_widgets())
    yield
    application = QApplication.instance()
    if application is None:
        return
    application.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    if set(_widgets()) - before:
        request.node.funcargs.clear()  # pytest lets go of a test's arguments only later
        gc.collect()  # widgets and their slots refer to each other
        application.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    widgets = [repr(widget) for widget in _widgets() if widget not in before]
    assert widgets == [], "widgets left: give them to qtbot.addWidget or to a parent"
    assert [repr(one) for one in started if _is_running(one)] == [], "threads or timers still running"


def _noting(start: Callable[..., None], started: list[Any]) -> Callable[..., None]:
    def noted(one: QThread | QTimer, *arguments: object) -> None:
        started.append(one)
        start(one, *arguments)

    return noted


def _is_running(one: QThread | QTimer) -> bool:
    try:
        return one.isRunning() if isinstance(one, QThread) else one.isActive()
    except RuntimeError:  # Qt has deleted it
        return False


def _widgets() -> list[QWidget]:
    return QApplication.topLevelWidgets() if QApplication.instance() else []
