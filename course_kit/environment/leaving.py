"""A repair, in memory, of the wheels' middleware: without it a program that leaves the graph may hang for ever.

A participant that leaves waits for the discovery callback that may be running: rmw_fastrtps's `destroy_participant`
calls Fast DDS's `DomainParticipant::set_listener(nullptr)`, whose last argument, how long to wait, is for ever. The
wheels are built for a glibc without `pthread_cond_clockwait`. There libstdc++ converts that end of time to another
clock, which overflows; the wait fails at once and is tried again, and the mutex that the callback wants is never free.
So whoever leaves while somebody else comes or goes takes all of a CPU and never ends, and neither Ctrl-C nor another
thread of Python helps. On a busy machine it was 12 of 8500 times; with the repair, of 6300 times it was none.

Where rmw_fastrtps looks for that function it finds ours instead: three instructions that say an hour, and go on there.
"""

from __future__ import annotations

import ctypes
import mmap
import os
import struct
import sys
from pathlib import Path

# DomainParticipant::set_listener(DomainParticipantListener*), and the one with a std::chrono::seconds besides
_FUNCTION = b"_ZN8eprosima7fastdds3dds17DomainParticipant12set_listenerEPNS1_25DomainParticipantListenerE"
_WITH_A_LIMIT = _FUNCTION + b"NSt6chrono8durationIlSt5ratioILl1ELl1EEEE"
_AN_HOUR = struct.Struct("<ci2sQ2s")  # mov edx, 3600; mov rax, address; jmp rax
_LINK_MAP = struct.Struct("Q8xQ")  # l_addr, l_name, l_ld of dlfcn's and link.h's struct link_map
_DYNAMIC, _RELOCATION, _SYMBOL = struct.Struct("qQ"), struct.Struct("QQq"), struct.Struct("I20x")  # elf.h, 64 bits
_END, _SIZE, _STRINGS, _SYMBOLS, _JUMPS = 0, 2, 5, 6, 23  # DT_NULL, DT_PLTRELSZ, DT_STRTAB, DT_SYMTAB, DT_JMPREL

_SYSTEM = ctypes.CDLL(None, use_errno=True)
_SYSTEM.dlopen.restype = _SYSTEM.dlsym.restype = _SYSTEM.mmap.restype = ctypes.c_void_p


def repair() -> bool:
    """Repair this process's middleware, before it is used; whether that was possible, and wanted.

    A real ROS 2 has no such fault, and its libraries lie elsewhere.
    """
    if os.uname().machine != "x86_64" or not _library().exists():
        return False
    try:
        library = opened()
        wanted = _SYSTEM.dlsym(ctypes.c_void_p(library), _WITH_A_LIMIT)
        if wanted is None:
            return False
        code = _executable(_AN_HOUR.pack(b"\xba", 3600, b"\x48\xb8", wanted, b"\xff\xe0"))
        where = slot(library)
        _allow(ctypes.addressof(where), mmap.PROT_READ | mmap.PROT_WRITE)  # a build with full RELRO forbids that
        where.value = code
    except (OSError, KeyError):  # a system where no program may make code, or another build
        return False
    return True


def slot(library: int) -> ctypes.c_void_p:
    """Where a library keeps the address of the function, as System V's ABI for x86-64 has it."""
    base, dynamic = _LINK_MAP.unpack(ctypes.string_at(library, _LINK_MAP.size))
    entries: dict[int, int] = {}
    while (entry := _DYNAMIC.unpack(ctypes.string_at(dynamic, _DYNAMIC.size)))[0] != _END:
        entries[entry[0]] = entry[1]
        dynamic += _DYNAMIC.size
    for offset, info, _ in _RELOCATION.iter_unpack(ctypes.string_at(entries[_JUMPS], entries[_SIZE])):
        symbol = ctypes.string_at(entries[_SYMBOLS] + (info >> 32) * _SYMBOL.size, _SYMBOL.size)
        if ctypes.string_at(entries[_STRINGS] + _SYMBOL.unpack(symbol)[0]) == _FUNCTION:
            return ctypes.c_void_p.from_address(base + offset)
    raise KeyError(_FUNCTION)


def opened() -> int:
    """The wheels' rmw_fastrtps, loaded."""
    handle = _SYSTEM.dlopen(os.fsencode(_library()), os.RTLD_LAZY)
    if handle is None:
        raise OSError(f"{_library()} cannot be loaded")
    return int(handle)


def _library() -> Path:
    return Path(sys.prefix, "lib", "librmw_fastrtps_shared_cpp.so")


def _executable(code: bytes) -> int:
    """Where such code lies, for as long as the process lives."""
    flags = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS
    page = _SYSTEM.mmap(None, ctypes.c_size_t(mmap.PAGESIZE), mmap.PROT_READ | mmap.PROT_WRITE, flags, -1, 0)
    if page in (None, ctypes.c_void_p(-1).value):
        raise OSError(ctypes.get_errno(), "no memory for code")
    ctypes.memmove(page, code, len(code))
    _allow(page, mmap.PROT_READ | mmap.PROT_EXEC)
    return int(page)


def _allow(address: int, rights: int) -> None:
    """Say what may be done with the page of an address."""
    page = address - address % mmap.PAGESIZE
    if _SYSTEM.mprotect(ctypes.c_void_p(page), ctypes.c_size_t(mmap.PAGESIZE), rights):
        raise OSError(ctypes.get_errno(), "programs may not make code here")
