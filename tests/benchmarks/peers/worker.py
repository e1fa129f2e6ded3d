"""Worker through which a peer is asked.

A script, run by the peers' Python, that answers one line of JSON to every line of JSON.
"""

import json
import subprocess
from pathlib import Path
from typing import Any

from tests.benchmarks.peers.environment import peers_python


class PeerWorker:
    """A running script beside this file. It works while we wait, so the two never compete for a core."""

    def __init__(self, script: str) -> None:
        command = [str(peers_python()), "-W", "ignore", str(Path(__file__).with_name(script))]
        self._script = script
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def close(self) -> None:
        """Let it end; it does when there is nothing more to read."""
        self._process.communicate()

    def ask(self, question: dict[str, Any]) -> dict[str, Any]:
        """Its answer to one question."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps(question) + "\n")
        self._process.stdin.flush()
        answer = self._process.stdout.readline()
        if not answer:
            raise RuntimeError(f"{self._script} ended; what it said stands above")
        return dict(json.loads(answer))
