"""T16: whom does a whole session call? It is led in a network of its own that has nobody else in it, under strace.

python -m tests.safety.no_network
"""

import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
NEEDED = ("unshare", "ip", "strace", "Xvfb", "openbox", "xdotool")
ALONE = ("unshare", "--map-root-user", "--net", "sh", "-c", 'ip link set lo up && exec "$@"', "sh")
FAMILY = re.compile(r"sa_family=(AF_\w+)")
LOOPBACK = re.compile(r'inet_addr\("127\.|inet_pton\(AF_INET6, "::1"')
LONGEST_S = 900.0


@dataclass(frozen=True, slots=True)
class Calls:
    """What was called: how often each family, and every line that went to neither AF_UNIX nor loopback."""

    families: Counter[str]
    outside: tuple[str, ...]
    told: str


def why_not() -> str:
    """Why it cannot be tried on this machine; empty where it can."""
    missing = [program for program in NEEDED if shutil.which(program) is None]
    if missing:
        return f"{', '.join(missing)} is not there"
    tried = subprocess.run([*ALONE, "strace", "-f", "-o", "/dev/null", "true"], capture_output=True, text=True)
    return "" if tried.returncode == 0 else f"not permitted here: {tried.stderr.strip()}"


def lead_session(tour: str = "keyboard") -> Calls:
    """Lead a session from the first start to the saved results, and give whom it called.

    Raises
    ------
    RuntimeError
        The session could not be led to its end.
    """
    with tempfile.TemporaryDirectory(prefix="gaitwright-alone-") as folder:
        trace = Path(folder) / "calls"
        command = [sys.executable, "packaging/tour.py", folder, f"--{tour}", "--theme", "light", "--trace", str(trace)]
        done = subprocess.run([*ALONE, *command], cwd=ROOT, capture_output=True, text=True, timeout=LONGEST_S)
        if done.returncode != 0:
            raise RuntimeError(f"{done.stdout}{done.stderr}")
        return calls_in(trace.read_text(), done.stdout.strip())


def calls_in(trace: str, told: str = "") -> Calls:
    """Read what strace noted. A call without an address goes to where its socket was connected before."""
    families: Counter[str] = Counter()
    outside = []
    for line in trace.splitlines():
        for family in FAMILY.findall(line):
            families[family] += 1
            if family != "AF_UNIX" and not LOOPBACK.search(line):
                outside.append(line)
    return Calls(families, tuple(outside), told)


def main() -> None:
    if reason := why_not():
        sys.exit(reason)
    calls = lead_session()
    print(calls.told)
    print(f"addresses called: {', '.join(f'{family} {count}' for family, count in calls.families.items()) or 'none'}")
    for line in calls.outside:
        print(line)
    sys.exit(1 if calls.outside else 0)


if __name__ == "__main__":
    main()
