"""All that the clinician sees and keeps."""

import os

# PySide6 makes each class when it is first asked for, and two threads that ask at once get two classes or wait for each
# other for ever: what a session needs is imported beside the screen. Made at once they take a tenth of a second.
os.environ["PYSIDE6_OPTION_LAZY"] = "0"
