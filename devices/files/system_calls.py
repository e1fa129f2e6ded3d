"""Let Linux refuse the system calls that reading a file does not need (seccomp, a filter in classic BPF).

Refused as not permitted: sockets of every kind, starting a process or a program, signals to others, modes, owners,
times and attributes of files, queues and memory shared between processes, and what looks into other processes or the
kernel.
A new thread is allowed, which is a clone of a kind. Numbers of calls: the kernel's `syscall_64.tbl` and `unistd.h`.
"""

import ctypes
import errno
import os
import platform
import struct

PR_SET_NO_NEW_PRIVS, PR_SET_SECCOMP, SECCOMP_MODE_FILTER = 38, 22, 2
ALLOW, REFUSE, KILL = 0x7FFF0000, 0x00050000 | errno.EPERM, 0x80000000
UNKNOWN_CALL = 0x00050000 | errno.ENOSYS
LOAD, EQUAL, AT_LEAST, ANY_OF, RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
NUMBER, ARCHITECTURE, FIRST_ARGUMENT = 0, 4, 16  # offsets in what the filter sees; little-endian
CLONE_THREAD = 0x00010000
X32 = 0x40000000  # calls of another kind with the same architecture
CLONE3 = 435  # its flags lie in memory, where no filter looks: glibc then takes clone

# pidfd_send_signal, io_uring (3), open_tree to fspick, pidfd_open, pidfd_getfd, process_madvise, mount_setattr,
# fchmodat2, setxattrat, removexattrat: the same on both
LATER = (424, 425, 426, 427, *range(428, 434), 434, 438, 440, 442, 452, 463, 466)
ARCHITECTURES = {
    "x86_64": (
        0xC000003E,
        (
            *(*range(41, 51), *range(52, 56), 288, 299, 307),  # sockets; 51 asks for a socket's own name
            *(57, 58, 59, 322, 101, 310, 311, 272, 308),  # fork, vfork, execve, execveat, ptrace, memory, namespaces
            *(90, 91, 268, 92, 93, 94, 260),  # modes and owners
            *(132, 235, 261, 280),  # times
            *(188, 189, 190, 197, 198, 199),  # attributes
            *(133, 259, 161, 165, 166, 155, 179),  # devices, roots, mounts, quotas
            *(29, 30, 31, 64, 65, 66, 220, *range(68, 72), 240, 241),  # shared memory, semaphores, queues
            *(248, 249, 250, 298, 319, 321, 323, 317),  # keys, perf, memfd, bpf, userfaultfd, seccomp
            *(141, 142, 144, 203, 251, 314, 302, 160),  # priorities and limits, of others too
        ),
        56,
        (62, 200, 234),  # kill, tkill, tgkill
    ),
    "aarch64": (
        0xC00000B7,
        (
            *(*range(198, 204), *range(205, 213), 242, 243, 269),
            *(221, 281, 117, 270, 271, 97, 268),
            *(52, 53, 54, 55),
            *(88,),
            *(5, 6, 7, 14, 15, 16),
            *(33, 51, 40, 39, 41, 60),
            *(*range(186, 198), 180, 181),
            *(217, 218, 219, 241, 279, 280, 282, 277),
            *(140, 118, 119, 122, 30, 274, 261, 164),
        ),
        220,
        (129, 130, 131),
    ),
}


class _Program(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("filter", ctypes.c_char_p))


def refuse_system_calls() -> bool:
    """Give them up for good in this process, with all threads that it begins; whether this system can."""
    known = ARCHITECTURES.get(platform.machine())
    if known is None or struct.calcsize("P") != 8:
        return False
    content = _filter(*known)
    program = _Program(len(content) // 8, content)
    system = ctypes.CDLL(None, use_errno=True)
    if system.prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0:
        return False
    return bool(system.prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, ctypes.byref(program), 0, 0) == 0)


def _filter(architecture: int, refused: tuple[int, ...], clone: int, signals: tuple[int, ...]) -> bytes:
    steps = [
        (LOAD, 0, 0, ARCHITECTURE),
        (EQUAL, 1, 0, architecture),
        (RETURN, 0, 0, KILL),
        (LOAD, 0, 0, NUMBER),
        (AT_LEAST, 0, 1, X32),
        (RETURN, 0, 0, REFUSE),
        (EQUAL, 0, 1, CLONE3),
        (RETURN, 0, 0, UNKNOWN_CALL),
        (EQUAL, 0, 4, clone),
        (LOAD, 0, 0, FIRST_ARGUMENT),
        (ANY_OF, 0, 1, CLONE_THREAD),
        (RETURN, 0, 0, ALLOW),
        (RETURN, 0, 0, REFUSE),
    ]
    for number in signals:  # a process may end itself
        steps += [
            (EQUAL, 0, 4, number),
            (LOAD, 0, 0, FIRST_ARGUMENT),
            (EQUAL, 0, 1, os.getpid()),
            (RETURN, 0, 0, ALLOW),
            (RETURN, 0, 0, REFUSE),
        ]
    for number in (*refused, *LATER):
        steps += [(EQUAL, 0, 1, number), (RETURN, 0, 0, REFUSE)]
    steps.append((RETURN, 0, 0, ALLOW))
    return b"".join(struct.pack("<HBBI", *step) for step in steps)
