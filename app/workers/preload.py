"""What the first session would wait for is imported beside the screen, once the window is there: two seconds' worth.

The window, log in and what they import bring neither numpy nor the library's storage; so main_window, entry and the
controller of the library import what does inside functions. Home and the wizard import at their top whatever they need,
apart from the pages of results, and what brings Typst, Arrow or the formats of exports: a page that nobody has come to
is not waited for. What stays inside functions states there what that buys (`tests/test_house_rules.py`).
"""

import gc
import sys
from importlib import import_module

from app.system.progress import Report

# in the order in which they are needed
MODULES = (
    "app.home.home",
    "app.storage.opened",
    "app.wizard.wizard",
    "app.wizard.patient.page",
    "app.wizard.sensors.page",
    "app.acquisition.acquisition",
    "app.wizard.sensors.estimator",
    "devices.simulation.replay",
    "app.acquisition.recorder",
    "app.wizard.standing.page",
    "app.wizard.standing.estimator",
    "app.wizard.free_motion.page",
    "app.wizard.free_motion.estimator",
    "core.analysis",
    "app.wizard.walking.page",
    "app.wizard.walking.estimator",
    "app.results.result_page",
    "app.help.help_page",
)


def is_preloaded() -> bool:
    """Whether nothing of it is left to be imported."""
    return MODULES[-1] in sys.modules


def preload(report: Report) -> None:
    """Import modules as work of a `Background`, stoppable between two; without collection on this thread."""
    was_collecting = gc.isenabled()
    gc.disable()
    try:
        for number, name in enumerate(MODULES):
            report(number / len(MODULES), name)
            import_module(name)
    finally:
        if was_collecting:
            gc.enable()
