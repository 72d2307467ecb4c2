"""What a call is towards the interpreter: signals, its lock, progress, errors, threads."""

import multiprocessing
import os
import pickle
import subprocess
import sys
import threading

import numpy as np
import pytest

import morsmooth

VALUES = np.random.default_rng(6).standard_normal((60, 50))


def test_progress_rises_from_0_to_1():
    steps = []
    morsmooth.smooth(array=VALUES, extrema=4, progress=lambda text, part: steps.append((text, part)))
    parts = [part for _, part in steps]
    assert parts == sorted(parts) and parts[0] == 0 and parts[-1] == 1 and len(steps) > 10
    assert any("relative gap" in text for text, _ in steps)


def test_what_progress_raises_ends_the_call():
    class Enough(Exception):
        pass

    def progress(text, part):
        raise Enough(text)

    with pytest.raises(Enough, match="reading"):
        morsmooth.smooth(array=VALUES, extrema=4, progress=progress)


def interrupted(program):
    """Runs a program that is interrupted from within; the last line of its output."""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=600)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.strip().splitlines()[-1]


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_control_c_ends_a_call_in_the_middle():
    # The signal comes from another thread in the middle of one long stage that says nothing of its progress.
    program = """
import os, signal, sys, threading, traceback
import numpy as np, morsmooth
# A shell that starts commands in the background has them ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)
count = 500
u, v = np.meshgrid(np.arange(float(count)), np.arange(float(count)), indexing="ij")
points = np.column_stack([u.ravel(), v.ravel(), np.zeros(count * count)])
number = np.arange(count * count).reshape(count, count)
a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
cells = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
steps = []
def told(text, part):
    steps.append(text)
    if text.startswith("weights of"):
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    morsmooth.weights((points, cells), {"a": [0], "b": [number[-1, -1]]}, order=3, progress=told)
    print("finished")
except KeyboardInterrupt as error:
    frames = [frame.name for frame in traceback.extract_tb(error.__traceback__)]
    print("interrupted in", frames[-1], "during", steps[-1])
# The process ends although the work may still be in a factorisation.
"""
    assert interrupted(program) == "interrupted in weights during weights of 2 handles"


def test_the_lock_of_the_interpreter_is_released():
    # With the lock held throughout, the other thread would not move between the stages of the call.
    count, stop = [0], threading.Event()

    def turn():
        while not stop.is_set():
            count[0] += 1

    thread = threading.Thread(target=turn)
    thread.start()
    try:
        before = count[0]
        morsmooth.smooth(array=VALUES, extrema=4)
        after = count[0]
    finally:
        stop.set()
        thread.join()
    assert after > before


def test_calls_from_several_threads_at_once(equal):
    expected = morsmooth.smooth(array=VALUES, extrema=4)
    found = [None] * 4

    def work(place):
        found[place] = morsmooth.smooth(array=VALUES, extrema=4)

    threads = [threading.Thread(target=work, args=(place,)) for place in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(equal(one, expected) for one in found)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
def test_a_child_made_by_fork_works_as_well(equal):
    # The threads that the parent has used are not there in the child.
    expected = morsmooth.smooth(array=VALUES, extrema=4)
    with multiprocessing.get_context("fork").Pool(1) as pool:
        found = pool.apply_async(in_child).get(timeout=300)
    assert equal(found, expected)


def in_child():
    return morsmooth.smooth(array=VALUES, extrema=4)


def test_errors_are_of_one_family():
    assert issubclass(morsmooth.InputError, morsmooth.Error) and issubclass(morsmooth.InputError, ValueError)
    assert issubclass(morsmooth.ContradictionError, morsmooth.GuaranteeError) and issubclass(morsmooth.GuaranteeError, morsmooth.Error)
    with pytest.raises(morsmooth.Error) as raised:
        morsmooth.smooth(array=[0.0, np.inf, 1.0], extrema=2)
    error = raised.value
    assert error.message == "array values is inf at point 1; expected a finite number"
    assert error.hints == ["NaN marks a hole; an infinite value must be masked or repaired"]
    assert str(error) == f"{error.message}\nhint: {error.hints[0]}"
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error) and str(again) == str(error) and again.hints == error.hints


@pytest.mark.parametrize(
    "options, text",
    [
        ({}, "found no wanted extrema; expected one of persistence, persistence_abs, extrema, keep"),
        ({"persistence": 1.5}, "persistence is 1.5; expected a part of the range from 0 to 1"),
        ({"persistence": "x%"}, "found 'x%'; expected a part such as 10% or 0.1"),
        ({"keep": []}, "found no point number in keep"),
        ({"keep": [-1]}, "keep has something else than point numbers"),
        ({"keep": [3000]}, "found point 3000; the mesh has points 0 to 2999"),
        ({"extrema": 3, "order": 7}, "order is 7.*; expected 1, 2, 3 or 4"),
        ({"extrema": 3, "select": "noise"}, "select is 'noise'; expected one of: data, smooth"),
        ({"extrema": 3, "length": 0.1, "length_abs": 1.0}, "found length and length_abs; expected one"),
        ({"extrema": 3, "threads": 0}, "found threads=0; expected at least 1"),
        ({"extrema": 3, "confidence": "name"}, "found the name 'name'; expected an array"),
        ({"extrema": 3, "confidence": -np.ones((60, 50))}, "confidence is -1.0 at vertex 0"),
        ({"extrema": 3, "mask": np.zeros((60, 50))}, "the domain is empty"),
    ],
)
def test_bad_options_are_refused(options, text):
    with pytest.raises(morsmooth.InputError, match=text):
        morsmooth.smooth(array=VALUES, **options)


@pytest.mark.parametrize(
    "mesh",
    [
        (np.zeros((4, 3)), [[0, 1, 9]]),
        (np.zeros((4, 3)), [[0, 1, -1]]),
        (np.zeros((4, 3)), [[0.0, 1.0, 2.0]]),
        (np.zeros((4, 3)), [[0, 1, 2, 3, 0]]),
        (np.zeros((4, 4)), [[0, 1, 2]]),
        (np.full((4, 3), np.nan), [[0, 1, 2]]),
        (np.zeros((4, 3)), np.zeros((0, 3), int)),
        (np.zeros((4, 3)), ([9, 0, 1], [5])),
    ],
)
def test_bad_meshes_are_refused(mesh):
    with pytest.raises(morsmooth.InputError):
        morsmooth.smooth(mesh, np.arange(4.0), extrema=2)


def test_doubts_are_warnings(triangles):
    points, cells, values = triangles
    with pytest.warns(morsmooth.NotOptimalWarning):
        morsmooth.smooth((points, cells), values, extrema=6, gap=1e-30)


def test_help_says_what_goes_in_and_what_comes_out():
    for name in ("smooth", "simplify", "persistence_pairs", "persistence_diagram", "weights", "deform", "geodesic"):
        function = getattr(morsmooth, name)
        assert "Args:" in function.__doc__ and "Returns:" in function.__doc__ and "Raises:" in function.__doc__
        assert all(word in function.__annotations__ for word in ("mesh", "return"))
