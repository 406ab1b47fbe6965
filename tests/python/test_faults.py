# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory that runs out and threads that do not start, in calls from Python.

`tests/cpp/faults` fails every allocation of the core; here those of a call of it from Python
fail, with what the bindings and the solver of programs allocate. What NumPy does by itself is
left out: it reads from null where the buffer of an index is not there.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

import pytest

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="names of the C library"),
    pytest.mark.skipif(shutil.which("cc") is None, reason="needs a compiler"),
]

SHIM = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stddef.h>

void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);

static atomic_int armed;
static atomic_long made, first, number, threads = 1000000;

/* Allocations from this one on fail, so many of them. */
void arm(long from, long count) { made = 0; first = from; number = count; armed = 1; }
long disarm(void) { armed = 0; return made; }
void allow_threads(long count) { threads = count; }

static int fails(void) {
  if (!armed) return 0;
  long now = made++;
  int failed = now >= first && now < first + number;
  if (failed) errno = ENOMEM;
  return failed;
}
void* malloc(size_t size) { return fails() ? 0 : __libc_malloc(size); }
void* calloc(size_t count, size_t size) {
  return fails() ? 0 : __libc_calloc(count, size);
}
void* realloc(void* old, size_t size) {
  return size != 0 && fails() ? 0 : __libc_realloc(old, size);
}
int pthread_create(pthread_t* thread, const pthread_attr_t* how, void* (*run)(void*),
                   void* with) {
  static int (*real)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  if (threads-- <= 0) return EAGAIN;
  if (!real) real = dlsym(RTLD_NEXT, "pthread_create");
  return real(thread, how, run, with);
}
"""
PREPARED = """
import ctypes, sys, warnings
import numpy as np
import remanifold as rm
from remanifold import _core, datasets
from remanifold.method import programs

warnings.simplefilter("ignore")
shim = ctypes.CDLL(None)
shim.arm.argtypes = [ctypes.c_long, ctypes.c_long]
shim.disarm.restype = ctypes.c_long
torus = datasets.torus(300, random_state=0)
"""
MEMORY = (
    PREPARED
    + """
sphere = datasets.sphere(100, random_state=0)
gram = sphere @ sphere.T
rough = datasets.add_noise(torus[:150], 0.1, random_state=1)
CALLS = {
    "curve": lambda: rm.reconstruct(datasets.circle(60, random_state=0), 1, num_threads=1),
    "solid": lambda: rm.reconstruct(datasets.ball(60, random_state=0), 3, num_threads=2),
    "gram": lambda: rm.reconstruct(gram=gram, dim=2, num_threads=1),
    "solver": lambda: rm.reconstruct(
        rough, 2, smooth=False, outliers=False, num_threads=1
    ),
}
kind, count = sys.argv[1], int(sys.argv[2])
call = CALLS[kind]
given = [array.tobytes() for array in (torus, gram, rough)]

def under_faults(real, at):
    \"\"\"The function while allocations fail; nothing here may need one that does.\"\"\"
    def failing(*arguments, **options):
        found = error = None
        shim.arm(*at)
        try:
            found = real(*arguments, **options)
        except BaseException as one:
            error = one
        for _ in range(1000):
            try:
                shim.disarm()
                break
            except MemoryError:
                pass
        if error is not None:
            raise error
        return found
    return failing

class Solver:
    \"\"\"The solver, of which only `run` is under faults.\"\"\"
    def __init__(self, inner, at):
        self.inner, self.at = inner, at
    def run(self):
        return under_faults(self.inner.run, self.at)()
    def __getattr__(self, name):
        return getattr(self.inner, name)

core, solver = _core.reconstruct, programs._silent_solver
def attempt(at):
    if kind == "solver":
        programs._silent_solver = lambda highspy: Solver(solver(highspy), at)
    else:
        _core.reconstruct = under_faults(core, at)
    try:
        return call().simplices.tobytes()
    except MemoryError:
        return None
    finally:
        _core.reconstruct, programs._silent_solver = core, solver

for _ in range(2):
    expected = call().simplices.tobytes()
assert attempt((2**40, 1)) == expected
total = shim.disarm()  # of the last call
assert total > 100, total
thrown = 0
for first in np.linspace(0, total - 1, count).astype(int).tolist():
    for number in (1, 20):
        found = attempt((first, number))
        assert found in (None, expected), (first, number)
        thrown += found is None
    assert call().simplices.tobytes() == expected, first
assert given == [array.tobytes() for array in (torus, gram, rough)]
assert thrown > count / 2, thrown
print("all")
"""
)
THREADS = (
    PREPARED
    + """
before = torus.tobytes()
for allowed in (0, 1):
    shim.allow_threads(allowed)
    try:
        rm.reconstruct(torus, 2, num_threads=4)
    except RuntimeError as error:
        print(error)
    shim.allow_threads(10**6)
rec = rm.reconstruct(torus, 2, num_threads=4)
one = rm.reconstruct(torus, 2, num_threads=1)
assert rec.simplices.tobytes() == one.simplices.tobytes()
assert torus.tobytes() == before
"""
)


@pytest.fixture(scope="module")
def shim(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shim")
    (folder / "shim.c").write_text(SHIM)
    command = ["cc", "-shared", "-fPIC", "-o", folder / "shim.so", folder / "shim.c"]
    subprocess.run([*command, "-ldl"], check=True)
    return folder / "shim.so"


def run(shim, script, *arguments):
    return subprocess.run(
        [sys.executable, "-X", "faulthandler", "-c", script, *map(str, arguments)],
        # Its threads allocate by themselves, and end the program where they cannot.
        env={**os.environ, "LD_PRELOAD": str(shim), "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("kind", ["curve", "solid", "gram", "solver"])
def test_memory_that_runs_out_is_an_error(shim, kind):
    """The solver took it for a program without a solution, and the result was another."""
    done = run(shim, MEMORY, kind, 12)
    assert (done.stdout, done.returncode) == ("all\n", 0), done.stderr[-3000:]


def test_threads_that_do_not_start_are_an_error(shim):
    done = run(shim, THREADS)
    assert done.returncode == 0, done.stderr[-3000:]
    assert done.stdout.count("a thread cannot be started (") == 2
    assert done.stdout.count("num_threads=1 takes fewest") == 2
