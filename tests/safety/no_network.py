"""T16: whom a whole session calls, and whom the search for sensors. Run in a network of its own, under strace.

    python -m tests.safety.no_network

The session is led where there is a network that has nobody else in it, so that the search for sensors, which begins
with it, may call whom it wants. Then sensors are searched for as `gaitwright devices` does, beside an emulated one at a
port: by itself, with streams asked for on this computer, and with streams asked for in the network. Somebody sends one
there. Waiting at a port of one's own (bind) is no call.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from tests.driver import HIDDEN, options

ROOT = Path(__file__).parents[2]
NEEDED = ("unshare", "ip", "strace", "Xvfb", "openbox", "xdotool")
OWN_ADDRESS = "192.0.2.9"  # of addresses that are nobody's: RFC 5737
NETWORK = (
    "ip link set lo up && ip link add near type veth peer name far && ip link set far up && "
    f"ip addr add {OWN_ADDRESS}/24 dev near && ip link set near up && ip route add default dev near"
)
ALONE = ("unshare", "--map-root-user", "--net", "sh", "-c", f'{NETWORK} && exec "$@"', "sh")
TRACED = ("strace", "-f", "--seccomp-bpf", "-e", "trace=connect,sendto,sendmsg,sendmmsg,bind", "-e", "signal=none")
WITHIN = ("AF_UNIX", "AF_NETLINK")  # programs of this computer and its kernel, which is asked for its own addresses
FAMILY = re.compile(r"sa_family=(AF_\w+)")
LOOPBACK = re.compile(r'inet_addr\("127\.|inet_pton\(AF_INET6, "::1"')
ADDRESS = re.compile(r'inet_addr\("([^"]+)"\)|inet_pton\(AF_INET6, "([^"]+)"')
WAITS = re.compile(r"^\d+ +bind\(|^bind\(")
LONGEST_S, SEARCH_S = 900.0, 120.0


@dataclass(frozen=True, slots=True)
class Calls:
    """What was called: how often each family, and every line that left this computer."""

    families: Counter[str]
    outside: tuple[str, ...]
    reported: str

    @property
    def addresses(self) -> frozenset[str]:
        """Who else was called."""
        return frozenset("".join(found) for line in self.outside for found in ADDRESS.findall(line))


def why_not() -> str:
    """Why it cannot be tried on this machine; empty where it can."""
    missing = [program for program in NEEDED if shutil.which(program) is None]
    if missing:
        return f"{', '.join(missing)} is not there"
    tried = subprocess.run([*ALONE, "strace", "-f", "-o", "/dev/null", "true"], capture_output=True, text=True)
    return "" if tried.returncode == 0 else f"not permitted here: {tried.stderr.strip()}"


def lead_session(tour: str = "keyboard") -> Calls:
    """Lead a session from the first start to the saved results, and give whom it called."""
    tail = ("-m", "tests.tours.tour", "{folder}", f"--{tour}", "--theme", "light", "--trace", "{trace}")
    return _called(tail, LONGEST_S)


def search_sensors(streams_in: str = "") -> Calls:
    """Search for sensors, for streams too where an address is given, and give whom that called; raises alike."""
    return _called(("-m", "tests.safety.no_network", "--inside", streams_in, "{trace}"), SEARCH_S)


def _called(arguments: tuple[str, ...], longest_s: float) -> Calls:
    with tempfile.TemporaryDirectory(prefix="gaitwright-alone-") as folder:
        trace = Path(folder) / "calls"
        filled = [argument.format(folder=folder, trace=trace) for argument in arguments]
        done = subprocess.run(
            [*ALONE, sys.executable, *filled], cwd=ROOT, capture_output=True, text=True, timeout=longest_s
        )
        if done.returncode != 0:
            raise RuntimeError(f"{done.stdout}{done.stderr}")
        return calls_in(trace.read_text(), done.stdout.strip())


def calls_in(trace: str, reported: str = "") -> Calls:
    """Read what strace noted. A call without an address goes to where its socket was connected before."""
    families: Counter[str] = Counter()
    outside = []
    for line in trace.splitlines():
        if WAITS.match(line):
            continue
        for family in FAMILY.findall(line):
            families[family] += 1
            if family not in WITHIN and not LOOPBACK.search(line):
                outside.append(line)
    return Calls(families, tuple(outside), reported)


# in the network


def _search(streams_in: str, trace: str) -> None:
    """Search, traced, beside a sensor at a port and a stream that are not."""
    with ExitStack() as stack:
        port = stack.enter_context(_beside("-m", "app", "devices", "--emulate", "ximu3", "--count", "1"))
        if streams_in:
            stack.enter_context(_beside("-m", "tests.safety.no_network", "--stream"))
        asked = ["--streams", streams_in] if streams_in else []
        command = [*TRACED, "-o", trace, sys.executable, "-m", "app", "devices", *asked]
        environment = {**os.environ, "GAITWRIGHT_PORTS": port}
        print(subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True).stdout)


@contextmanager
def _beside(*arguments: str) -> Iterator[str]:
    """Run Python beside; gives its first line."""
    process = subprocess.Popen([sys.executable, *arguments], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        yield process.stdout.readline().strip()
    finally:
        process.terminate()
        process.wait()


def _stream() -> None:
    """Send a stream of motion as another program does, until ended."""
    import pylsl

    labels = [f"{quantity}_{axis}" for quantity in ("gyr", "acc") for axis in "xyz"]
    info = pylsl.StreamInfo("a stream", "IMU", 6, 100.0, pylsl.cf_double64, "a stream")
    info.set_channel_labels(labels)
    info.set_channel_units(["deg/s"] * 3 + ["g"] * 3)
    outlet = pylsl.StreamOutlet(info)
    print("streaming", flush=True)
    while True:
        outlet.push_sample([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
        time.sleep(0.01)


def main() -> None:
    required = options(__doc__, inside={"nargs": 2, "help": HIDDEN}, stream=(False, HIDDEN))
    if required.inside:
        _search(*required.inside)
        return
    if required.stream:
        _stream()
        return
    if reason := why_not():
        sys.exit(reason)
    is_right = True
    for name, calls, expected in (
        ("the search for sensors", search_sensors(), set()),
        ("with streams on this computer", search_sensors("127.0.0.1"), set()),
        ("with streams in the network", search_sensors(OWN_ADDRESS), {"224.0.0.183", OWN_ADDRESS}),
        ("a whole session", lead_session(), set()),
    ):
        families = ", ".join(f"{family} {count}" for family, count in calls.families.items()) or "none"
        print(f"{name}: {families}; others: {', '.join(sorted(calls.addresses)) or 'none'}", flush=True)
        if calls.addresses != expected or bool(calls.outside) != bool(expected):
            print(calls.reported, *calls.outside, sep="\n")
            is_right = False
    sys.exit(0 if is_right else 1)


if __name__ == "__main__":
    main()
