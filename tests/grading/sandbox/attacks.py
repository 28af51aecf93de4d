"""Programs that attack the grader instead of solving an exercise; each prints a line that begins with WON if it gets there.

They are data: `test_attacks` runs each under several kinds of isolation.
"""

from __future__ import annotations

from dataclasses import dataclass

from tests.grading.conftest import EXERCISE, ROOT

SECRET_OF_A_STUDENT = "the-work-of-another"  # noqa: S105 - a text to look for; in a program that was graded before, and in a file
SEED = 918273645


@dataclass(frozen=True)
class Attack:
    """One of them.

    Attributes:
        source: the program; `{file}` stands for a file of the user's, `{socket}` for a server's socket, `{name}` for an
            abstract one and `%PORT%` for a port.
        admitted: names of what may be missing, in `Isolation`'s words, for it to succeed; LIMITS.md says so.
    """

    source: str
    admitted: tuple[str, ...] = ()


_SOLUTION = f"solutions/{EXERCISE}/{EXERCISE}.py"
_SYSCALL = """
import ctypes, os
libc = ctypes.CDLL(None, use_errno=True)
numbers = NUMBERS[os.uname().machine]
def call(name, *arguments):
    words = [ctypes.c_long(each) if isinstance(each, int) else each for each in arguments]
    return libc.syscall(ctypes.c_long(numbers[name]), *words)
""".replace(
    "NUMBERS",
    repr(
        {
            "x86_64": {
                "keyctl": 250,
                "add_key": 248,
                "shmget": 29,
                "semget": 64,
                "msgget": 68,
                "unshare": 272,
                "ptrace": 101,
                "pidfd_open": 434,
                "pidfd_getfd": 438,
                "process_vm_readv": 310,
                "mount": 165,
            },
            "aarch64": {
                "keyctl": 219,
                "add_key": 217,
                "shmget": 194,
                "semget": 190,
                "msgget": 186,
                "unshare": 97,
                "ptrace": 117,
                "pidfd_open": 434,
                "pidfd_getfd": 438,
                "process_vm_readv": 270,
                "mount": 40,
            },
        }
    ),
)

ATTACKS = {
    "reads_the_solution": Attack(
        f"""
try:
    source = open({str(ROOT / _SOLUTION)!r}).read()
    print("WON: it has read the solution", flush=True)
    exec(source)
except OSError:
    pass
""",
        ("files", "landlock"),
    ),
    "asks_git": Attack(
        f"""
import subprocess
command = ["git", "-c", "safe.directory=*", "-C", {str(ROOT)!r}, "show", "HEAD:{_SOLUTION}"]
try:
    source = subprocess.run(command, capture_output=True, text=True, timeout=10).stdout
except OSError:
    source = ""
if source:
    print("WON: git has shown the solution", flush=True)
    exec(source)
""",
        ("files", "landlock"),
    ),
    "reads_a_file": Attack(
        """
try:
    print("WON:", open(%FILE%).read())
except OSError:
    pass
""",
        ("files", "landlock"),
    ),
    "imports_the_grader": Attack(
        """
import importlib
for name in ("graders.temperature_service", "grading.checks.check", "grading.engine", "quiz.bank", "quiz", "cli.main", "lab"):
    try:
        print("WON:", importlib.import_module(f"course_kit.{name}"))
    except ImportError:
        pass
""",
        ("files", "landlock"),
    ),
    "searches_its_memory": Attack(
        f"""
import gc, re, sys
# Character classes keep the words themselves out of this program.
wanted = re.compile(rb"{SECRET_OF_A_STUDENT[:-1]}[{SECRET_OF_A_STUDENT[-1]}]|{str(SEED)[:-1]}[{str(SEED)[-1]}]")
with open("/proc/self/maps") as maps, open("/proc/self/mem", "rb", 0) as memory:
    for low, high in [[int(word, 16) for word in line.split()[0].split("-")] for line in maps if " rw" in line]:
        try:
            memory.seek(low)
            if found := wanted.search(memory.read(min(high - low, 2**26))):
                print("WON: memory holds", found[0])
        except (OSError, ValueError, OverflowError):
            pass
for thing in gc.get_objects():
    if type(thing).__name__ in ("Job", "Check", "Evidence", "Context") and "course_kit" in type(thing).__module__:
        print("WON: an object of the grader", type(thing))
frame = sys._getframe()
while frame:
    for name in frame.f_locals:
        if name in ("job", "seed", "task"):
            print("WON: a frame of", frame.f_code.co_name, "holds", name)
    frame = frame.f_back
""",
    ),
    "writes_to_the_terminal": Attack(
        """
import glob, os
for path in ("/dev/tty", "/dev/console", *glob.glob("/dev/pts/*"), *glob.glob("/dev/tty*"), *glob.glob("/dev/vcs*")):
    try:
        os.close(os.open(path, os.O_WRONLY | os.O_NOCTTY))
        print("WON: opened", path)
    except OSError:
        pass
""",
        ("files", "landlock"),
    ),
    "opens_devices": Attack(
        """
import glob, os, stat
for path in (*glob.glob("/dev/[svx]d[a-z]*"), *glob.glob("/dev/nvme*"), "/dev/mem", "/dev/kmsg", "/dev/fuse", "/dev/kvm"):
    try:
        os.close(os.open(path, os.O_RDONLY | os.O_NONBLOCK))
        print("WON: opened", path)
    except OSError:
        pass
try:
    os.mknod("disk", stat.S_IFBLK | 0o600, os.makedev(8, 0))
    os.close(os.open("disk", os.O_RDONLY))
    print("WON: made a device")
except OSError:
    pass
""",
        ("files", "landlock"),
    ),
    "changes_the_kernel": Attack(
        """
import os
mine = [name for name in os.listdir("/proc") if name.isdigit() or name in ("self", "thread-self", "net", "mounts")]
for folder, folders, files in os.walk("/proc"):
    folders[:] = [name for name in folders if folder != "/proc" or name not in mine]
    for path in [os.path.join(folder, name) for name in files if name not in mine]:
        try:
            os.close(os.open(path, os.O_WRONLY | os.O_NONBLOCK))
            print("WON: could write", path)
        except OSError:
            pass
""",
        ("files", "landlock"),
    ),
    "reads_the_machines_keys": Attack(
        """
import os
for folder in ("/etc/ssl/private", "/etc/ssh"):
    try:
        print("WON:", os.listdir(folder), "in", folder)
    except OSError:
        pass
""",
        ("files", "landlock"),
    ),
    "leaves_keys": Attack(
        _SYSCALL
        + """
if call("add_key", b"user", b"course-kit-attack", b"x", 1, -3) > 0:
    print("WON: added a key")
if call("keyctl", 0, -3, 0) > 0:
    print("WON: asked for the session keyring")
""",
        ("syscalls",),
    ),
    "leaves_shared_memory": Attack(
        _SYSCALL
        + """
if call("shmget", 0x50BABE, 4096, 0o1666) >= 0 or call("semget", 0x50BABE, 1, 0o1666) >= 0:
    print("WON: System V memory or semaphores")
if call("msgget", 0x50BABE, 0o1666) >= 0:
    print("WON: a System V queue")
""",
        ("syscalls",),
    ),
    "gains_capabilities": Attack(
        _SYSCALL
        + """
import subprocess
for flags in (0x10000000, 0x10000000 | 0x20000, 0x40000000):
    if call("unshare", flags) == 0:
        print("WON: unshare", hex(flags))
if call("mount", b"none", b"/", b"tmpfs", 0, None) == 0:
    print("WON: mounted")
caps = [line.split()[1] for line in open("/proc/self/status") if line.startswith("Cap")]
if any(int(word, 16) for word in caps[:3] + caps[4:]):
    print("WON: capabilities", caps)
try:
    import resource
    resource.setrlimit(resource.RLIMIT_NPROC, (100000, 100000))
    print("WON: raised a limit")
except (ValueError, OSError):
    pass
""",
        ("syscalls",),
    ),
    "takes_descriptors": Attack(
        _SYSCALL
        + """
for name in [name for name in os.listdir("/proc") if name.isdigit() and name != os.readlink("/proc/self")]:
    victim = int(name)
    handle = call("pidfd_open", victim, 0)
    if handle >= 0:
        for number in range(0, 40):
            if call("pidfd_getfd", handle, number, 0) >= 0:
                print("WON: a descriptor of", victim, open(f"/proc/{name}/comm").read())
                break
""",
        ("syscalls",),
    ),
    "reads_processes": Attack(
        _SYSCALL
        + """
for name in [name for name in os.listdir("/proc") if name.isdigit() and name != os.readlink("/proc/self")]:
    victim = int(name)
    if call("ptrace", 16, victim, 0, 0) == 0:
        print("WON: traces", victim)
        call("ptrace", 17, victim, 0, 0)
    for file in ("mem", "environ", "maps"):
        try:
            with open(f"/proc/{name}/{file}", "rb") as opened:
                if opened.read(1):
                    print("WON: read", file, "of", victim)
        except OSError:
            pass
""",
        ("processes", "landlock"),
    ),
    "connects": Attack(
        """
import socket
for family, address in ((socket.AF_UNIX, %SOCKET%), (socket.AF_UNIX, "\\0" + %NAME%), (socket.AF_INET, ("127.0.0.1", %PORT%))):
    with socket.socket(family) as line:
        line.settimeout(1)
        try:
            line.connect(address)
            print("WON: connected to", repr(address))
        except OSError:
            pass
""",
        ("network", "files"),
    ),
    "lends_its_output": Attack(
        """
import socket
for address in (%SOCKET%, "\\0" + %NAME%):
    line = socket.socket(socket.AF_UNIX)
    try:
        line.connect(address)
        socket.send_fds(line, [b"x"], [1, 2])  # they lie there as long as the server lives, which does not take them
    except OSError:
        pass
""",
    ),
    "plants_files": Attack(
        """
import os, sysconfig
folders = (sysconfig.get_path("purelib"), os.path.dirname(os.__file__), "/tmp", "/var/tmp", "/run", os.path.dirname(%FILE%))
for folder in folders:
    path = os.path.join(folder, "course_kit_planted.txt")
    try:
        open(path, "w").close()
        print("WON: wrote", path)
        os.unlink(path)
    except OSError:
        pass
""",
        ("files", "landlock"),
    ),
    "takes_memory_that_nothing_counts": Attack(
        """
import ctypes, mmap, os
taken = []
if ctypes.CDLL(None).vmsplice(os.pipe()[1], (ctypes.c_void_p * 2)(id(taken), 1), 1, 2) == 1:
    taken.append("a page in a pipe")
try:
    taken.append(os.memfd_create("x"))
except OSError:
    pass
for flags in (mmap.MAP_SHARED | mmap.MAP_ANONYMOUS, 3 | mmap.MAP_ANONYMOUS):
    try:
        taken.append(mmap.mmap(-1, 2**20, flags=flags))
    except OSError:
        pass
if taken:
    print("WON:", taken)
""",
        ("syscalls",),
    ),
    "maps_the_device_zero": Attack(
        """
import mmap, os
try:
    print("WON:", mmap.mmap(os.open("/dev/zero", os.O_RDWR), 2**20, flags=mmap.MAP_SHARED))
except OSError:
    pass
""",
        ("files", "landlock"),
    ),
    "fills_page_tables": Attack(
        """
import mmap, time
for _ in range(16):
    room = mmap.mmap(-1, 2**36, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | 0x4000, prot=mmap.PROT_READ)
    for place in range(0, 2**36, 2**21):
        room[place]
    time.sleep(0.02)
    globals().setdefault("rooms", []).append(room)
print("WON: 2 GB of tables")
time.sleep(2)
""",
    ),
    "floods_with_ended_children": Attack(
        """
import os, time
begun, started = time.monotonic(), 0
while time.monotonic() - begun < 8:
    if os.fork() == 0:
        os._exit(0)
    started += 1
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except OSError:
        pass
if started > 4000:
    print("WON:", started, "children")
""",
        ("processes",),
    ),
    "fills_sockets": Attack(
        """
import os, socket, time
def fill(line):
    line.setblocking(False)
    sent = 0
    try:
        while True:
            sent += line.send(bytes(32768))
    except OSError:
        return sent
total = 0
held = [socket.socket(socket.AF_UNIX)]
held[0].bind("listening")
held[0].listen(4096)
while total < 400 * 2**20:
    if len(held) < 100:
        line, other = socket.socketpair()
        line.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 2**22)
        held += [line, other]
    else:
        line = socket.socket(socket.AF_UNIX)
        try:
            line.connect("listening")
        except OSError:
            break
    total += fill(line)
    if line not in held:
        line.close()
print("WON:", total // 2**20, "MB")
time.sleep(2)
""",
        ("network",),
    ),
    "makes_strange_sockets": Attack(
        """
import socket
for family, kind, protocol in ((40, 1, 0), (38, 5, 0), (30, 5, 0), (17, 3, 3), (31, 3, 1), (2, 1, 262), (2, 5, 132), (2, 2, 136)):
    try:
        socket.socket(family, kind, protocol)
        print("WON: made", family, protocol)
    except OSError:
        pass
""",
        ("syscalls",),
    ),
    "fills_the_disk": Attack(
        """
written = 0
for number in range(1000):
    try:
        with open(f"file{number}", "wb") as file:
            file.write(bytes(2**20))
        written += 1
    except OSError:
        break
if written > 100:
    print("WON:", written, "MB")
""",
        ("files",),
    ),
    "closes_files": Attack(
        """
import os
before = os.stat(%FILE%) if os.path.exists(%FILE%) else None
for change in (lambda: os.utime(%FILE%, (1, 1)), lambda: os.setxattr(%FILE%, "user.x", b"1"), lambda: os.chmod(%FILE%, 0o604)):
    try:
        change()
    except OSError:
        pass
if before and (before.st_mode, before.st_mtime) != (os.stat(%FILE%).st_mode, os.stat(%FILE%).st_mtime):
    print("WON: changed the mode or the time of a file")
""",
        ("syscalls",),
    ),
    "leases_files": Attack(
        """
import ctypes, fcntl, os, signal, struct
signal.signal(signal.SIGIO, signal.SIG_IGN)
with open("own", "w") as own:
    for what, file, wanted in (("a lease", own.fileno(), fcntl.F_WRLCK), ("notices", os.open(".", os.O_RDONLY), fcntl.DN_CREATE)):
        try:
            fcntl.fcntl(file, fcntl.F_SETLEASE if what == "a lease" else fcntl.F_NOTIFY, wanted)
            print("WON:", what)
        except OSError:
            pass
    try:
        fcntl.ioctl(own.fileno(), 0x40086602, struct.pack("l", 0x80))
        print("WON: a file flag")
    except OSError:
        pass
libc = ctypes.CDLL(None)
if libc.inotify_add_watch(libc.inotify_init(), os.getcwd().encode(), 2) >= 0:
    print("WON: a watch")
""",
        ("syscalls",),
    ),
    "limits_others": Attack(
        """
import os, resource
for name in [name for name in os.listdir("/proc") if name.isdigit() and name != os.readlink("/proc/self")]:
    other = int(name)
    try:
        resource.prlimit(other, resource.RLIMIT_CORE, resource.prlimit(other, resource.RLIMIT_CORE))
        print("WON: the limits of", name)
    except OSError:
        pass
    if other == 1:
        continue
    try:
        before = os.getpriority(os.PRIO_PROCESS, other), os.sched_getaffinity(other)
        os.setpriority(os.PRIO_PROCESS, other, 19)
        os.sched_setaffinity(other, list(before[1])[:1])
        if before != (os.getpriority(os.PRIO_PROCESS, other), os.sched_getaffinity(other)):
            print("WON: priority or processors of", name)
    except OSError:
        pass
""",
        ("syscalls",),
    ),
    "kills_others": Attack(
        """
import os, signal
for name in os.listdir("/proc"):
    if name.isdigit() and name != os.readlink("/proc/self"):
        try:
            os.kill(int(name), 0)  # asks whether it could
            if open(f"/proc/{name}/stat").read().split(") ")[1].split()[1] != "0":
                print("WON: could kill", name)
        except OSError:
            pass
""",
        ("processes", "landlock"),
    ),
}
