"""Output of subcommands on a terminal."""

import signal
import threading
from collections.abc import Iterator, Sequence
from typing import Any, TextIO

from app.wording.findings import place, sentence
from core.findings import Finding, Severity
from devices.files.refusal import one_line


class Progress:
    """A line that renews itself on a terminal, else a line for every tenth of the work."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._is_terminal = stream.isatty()
        self._next_percent = 0
        self._is_interrupted = False
        self._handler_before: Any = None

    def __enter__(self) -> "Progress":
        if threading.current_thread() is threading.main_thread():
            self._handler_before = signal.signal(signal.SIGINT, self._interrupt)
        return self

    def __exit__(self, *_: object) -> None:
        if self._handler_before is not None:
            signal.signal(signal.SIGINT, self._handler_before)
        if self._is_terminal:
            print("\r\x1b[K", end="", file=self._stream, flush=True)

    def _interrupt(self, *_: object) -> None:
        """Stop at once, or, where a library swallows the exception, at the next progress."""
        self._is_interrupted = True
        raise KeyboardInterrupt

    def __call__(self, share: float, what: str) -> None:
        if self._is_interrupted:
            raise KeyboardInterrupt
        percent = min(100, round(100 * share))
        text = f"{percent:3d} % {place(one_line(what))}"
        if self._is_terminal:
            print(f"\r\x1b[K{text[:78]}", end="", file=self._stream, flush=True)
        elif percent >= self._next_percent:
            print(text, file=self._stream, flush=True)
            self._next_percent = percent // 10 * 10 + 10


def finding_lines(findings: Sequence[Finding], lowest: str) -> Iterator[str]:
    """Give those that are at least as grave as `lowest`, each in a line."""
    severities = list(Severity)
    for finding in findings:
        if severities.index(finding.severity) >= severities.index(Severity(lowest)):
            yield f"- {one_line(sentence(finding))}"
