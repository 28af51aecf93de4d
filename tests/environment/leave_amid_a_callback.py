"""A program: a participant leaves while a discovery callback runs, as rmw_fastrtps has it do. Writes what became of it.

The participant is a stand-in: memory that is laid out as Fast DDS 2.14.5's. The function that leaves is the real one.
"""

from __future__ import annotations

import ctypes
import os
import sys
import threading
import time

import rclpy

from course_kit.environment import leaving

assert rclpy  # its import has the middleware repaired
IMPL, MUTEX, CONDITION, CALLBACKS = 0x48, 0x510, 0x538, 0xCE8
DEADLINE = 30.0

libc = ctypes.CDLL(None)
set_listener = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(
    leaving.slot(leaving.opened()).value or 0
)

impl = ctypes.create_string_buffer(0x1000)
participant = ctypes.create_string_buffer(0x100)
address = ctypes.addressof(impl)
ctypes.c_void_p.from_buffer(participant, IMPL).value = address
running = ctypes.c_int.from_buffer(impl, CALLBACKS)
waits_begun = ctypes.c_uint64.from_buffer(impl, CONDITION)

running.value = 1
leaves = threading.Thread(target=set_listener, args=(ctypes.addressof(participant), None), daemon=True)
leaves.start()
deadline = time.monotonic() + DEADLINE
while not waits_begun.value and time.monotonic() < deadline:
    time.sleep(0.001)
sys.stdout.write("waits\n" if waits_begun.value else "tries again and again\n")
if waits_begun.value:
    libc.pthread_mutex_lock(ctypes.c_void_p(address + MUTEX))  # what the callback does at its end
    running.value = 0
    libc.pthread_mutex_unlock(ctypes.c_void_p(address + MUTEX))
    libc.pthread_cond_broadcast(ctypes.c_void_p(address + CONDITION))
    leaves.join(DEADLINE)
    sys.stdout.write("still waits\n" if leaves.is_alive() else "leaves\n")
sys.stdout.flush()
os._exit(0)  # a thread that tries again and again never ends
