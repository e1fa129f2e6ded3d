"""Count a passphrase and a patient's code in the memory of the window, open and locked.

    QT_QPA_PLATFORM=offscreen python -m tests.safety.passphrase_in_memory --locks 3

The passphrase is typed by keys. Neither text is written out here, nor made whole in the window's process by the test:
a child counts them through /proc, so that what it looks for is not what it finds. Python and Qt copy text as they like;
this is a measurement, not a control.
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QSettings, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.main_window import MainWindow
from app.system.settings import Settings
from app.theme.current import load_fonts
from tests.driver import options

SHIFTED = {"passphrase": "gnts!rinsu!vnser!idsd", "code": "Q,1056,YX["}  # each letter is its adjacent one
MAKE = """
import json, sys
from pathlib import Path
from app.storage.keys import KeySlots
from app.storage.layout import KEYS
from app.storage.library import Library
from app.storage.slots import Cost
from app.storage.stored import Operator, Role
from core.session import Patient
texts = {name: "".join(chr(ord(c) ^ 1) for c in text) for name, text in json.loads(sys.argv[2]).items()}
folder = Path(sys.argv[1])
slots = KeySlots(folder / KEYS, Cost(passes=1, memory_kib=64))
data_key, recovery = slots.create("hk", texts["passphrase"])
slots.confirm_recovery_key(recovery)
with Library.create(folder, data_key, Operator("hk", "H. Keller", Role.ADMINISTRATOR)) as library:
    library.patients.create(Patient(code=texts["code"]))
"""
COUNT = """
import json, sys
from pathlib import Path
process, found = Path("/proc", sys.argv[1]), []
texts = ["".join(chr(ord(c) ^ 1) for c in text) for text in json.loads(sys.argv[2]).values()]
forms = [text.encode(form) for text in texts for form in ("utf-8", "utf-16-le")]
counts = [0] * len(forms)
with (process / "mem").open("rb", buffering=0) as memory:
    for line in (process / "maps").read_text().splitlines():
        place, mode = line.split()[:2]
        if mode.startswith("rw"):
            start, end = (int(one, 16) for one in place.split("-"))
            try:
                memory.seek(start)
                content = memory.read(end - start)
            except (OSError, OverflowError):
                continue
            counts = [count + content.count(form) for count, form in zip(counts, forms)]
print("passphrase {} as bytes, {} as Qt's text; code {} and {}".format(*counts))
"""


def count(own: int) -> str:
    command = [sys.executable, "-c", COUNT, str(own), json.dumps(SHIFTED)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def main() -> int:
    args = options(__doc__, locks=3)
    app = QApplication([])
    load_fonts()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place, "library")
        folder.mkdir()
        subprocess.run([sys.executable, "-c", MAKE, str(folder), json.dumps(SHIFTED)], check=True)
        settings = Settings(QSettings(str(Path(place, "settings.ini")), QSettings.Format.IniFormat))
        window = MainWindow(settings, folder)
        window.show()
        _follow(app, window, args.locks)
        window.close()
        window.finish()
    return 0


def _follow(app: QApplication, window: MainWindow, locks: int) -> None:
    """Log in, lock and come back, and count at each stop."""
    own = app.applicationPid()
    assert window.entry is not None
    page = window.entry.log_in

    def until(is_so: Callable[[], bool]) -> None:
        while not is_so():
            app.processEvents()
            time.sleep(0.01)

    def type_it() -> None:
        for letter in SHIFTED["passphrase"]:
            QTest.keyClicks(page.passphrase.line_edit, chr(ord(letter) ^ 1))
        QTest.keyClick(page.passphrase.line_edit, Qt.Key.Key_Return)

    until(lambda: page.operator.count() == 1)
    type_it()
    until(lambda: window.home is not None and window.home.page.patients.line is not None)
    sys.stdout.write(f"open: {count(own)}\n")
    for _ in range(locks):
        window.lock()
        end_s = time.monotonic() + 1.0
        until(lambda end_s=end_s: time.monotonic() > end_s)  # type: ignore[misc]  # mypy takes no default here
        sys.stdout.write(f"locked: {count(own)}\n")
        type_it()
        until(lambda: not window.is_covered)


if __name__ == "__main__":
    sys.exit(main())
