"""What every harness shares: its options, a child that is killed, what was found, how it reports and how it ends.

A harness is a module that tries something often: `python -m tests.safety.journal_kills --help` names its options.
"""

import argparse
import os
import signal
import tempfile
import time
import traceback
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

import numpy as np

HIDDEN = argparse.SUPPRESS
KILLED = -9  # how a child ended that was killed
MOST_SHOWN = 20  # faults of each kind of case


@dataclass(slots=True)
class Found:
    """What came of many cases: how often what came, figures by name, and the faults in words."""

    count: Counter[str] = field(default_factory=Counter)
    figures: defaultdict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    faults: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        counted = ", ".join(f"{number} {what}" for what, number in self.count.items())
        measured = (
            f"{name}: {values[0]:.3g}"
            if len(values) == 1
            else f"{name}: median {np.median(values):.3g}, p99 {np.quantile(values, 0.99):.3g}, most {max(values):.3g}"
            for name, values in self.figures.items()
            if values
        )
        return "; ".join([*filter(None, [counted]), *measured, f"{len(self.faults)} faults"])


def options(opening: str | None, **known: object) -> argparse.Namespace:
    """Read the command line: each keyword is an option, by its default, by (default, help), or as argparse takes it.

    A type alone is an argument that has to be given.
    """
    parser = argparse.ArgumentParser(description=opening, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, given in known.items():
        flag = f"--{name.replace('_', '-')}"
        default, about = given if isinstance(given, tuple) else (given, None)
        if isinstance(default, dict):
            parser.add_argument(flag, **default)
        elif isinstance(default, type):
            parser.add_argument(name, type=default, help=about)
        elif isinstance(default, bool):
            parser.add_argument(flag, action="store_true", help=about)
        elif isinstance(default, list):
            parser.add_argument(flag, nargs="*", type=type(default[0]), default=default, help=about)
        else:
            parser.add_argument(flag, type=type(default), default=default, help=about)
    return parser.parse_args()


Harness = Callable[[argparse.Namespace, Path], Found | Iterable[tuple[str, Found]]]
"""Tries what was asked for in a folder of its own; gives what was found, or that of each kind of case in turn."""


def drive(opening: str | None, harness: Harness, **known: object) -> NoReturn:
    """Be a harness's command line: print what is found, and end with 1 where there are faults."""
    asked, began_s = options(opening, **known), time.monotonic()
    is_right = True
    # a short name: a server's socket has 107 letters at most
    with tempfile.TemporaryDirectory(prefix="gw-", ignore_cleanup_errors=True) as folder:
        found = harness(asked, Path(folder))
        for name, one in [("", found)] if isinstance(found, Found) else found:
            print(f"{name or 'found'}: {one}; after {time.monotonic() - began_s:.0f} s")
            print(*(f"- {fault}\n" for fault in one.faults[:MOST_SHOWN]), sep="", end="", flush=True)
            is_right &= not one.faults
    raise SystemExit(0 if is_right else 1)


def end_of_child(work: Callable[[], object], killed_after_s: float | None = None) -> int:
    """Work in a child that may be killed after a while: `KILLED` where it was, 0 where it was done before."""
    if (child := os.fork()) == 0:
        status = 1
        try:
            work()
            status = 0
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(status)  # without what a process does at its end, which is the parent's
    if killed_after_s is not None:
        time.sleep(killed_after_s)
        os.kill(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
