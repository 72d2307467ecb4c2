#!/usr/bin/env python3
"""The engine against public solvers on the public test set, and against one factorization plus one solve.

Usage:  cargo build --release --example test_set
        python tools/bars/solvers.py [--only NAME ...] [--solvers NAME ...] [--large] [--limit SECONDS] [--keep FOLDER]
Needs:  pip install numpy==2.4.6 scipy==1.17.1 cvxopt==1.3.3 clarabel==0.11.1 piqp==0.7.0 scs==3.3.1 osqp==1.1.3 qpalm==1.3.0

The generator writes each problem (tools/test_set/README.md); our engine regenerates and solves it with one thread, then with
two; every peer gets the formed files, a tolerance of 1e-8 and one thread. Each solve runs in a process of its own, whose
peak memory is taken; seconds are those of the solver's set-up and solve, without reading files. A peer that exceeds the limit
of time is stopped. Peers that know no matrix cones are left out of the deformations.

All that is compared is computed here, in extended precision (80 bits), with P as the product of its factors.
  residual     of a point and its multipliers: largest of stationarity (over the largest force in the balance), violation of rows and
               blocks (over the largest row), their duals' (over the largest), and of the gap z'(Ax + b) over the energy
  energy, x    difference to ours: relative, and absolute over the range of x
  ratio        our seconds over our own floor, one factorization plus one solve of P
Bars: ours is solved, residual at most 1e-8; at least 3 times faster, one thread against one, than the fastest peer with a residual as
good as ours or below 1e-7; energies of such peers agree to 1e-6 and x to 1e-5; ratio at most 15 with data, 20 without (fields); the same bits of
ours for one and two threads. Exit code 1 if one is missed.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np
import scipy.io
import scipy.sparse as sp

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
NAMES = ["grid-5041-data-k2", "series-1000-data-k3", "grid-7396-nodata-k3", "deform-quad-40", "deform-swirl-180",
         "grid-15129-data-k2", "grid-15129-nodata-k2", "deform-bar-170", "volume-13824-data-k2", "torus-20000-data-k2",
         "grid-58081-data-k2", "grid-58081-nodata-k4"]
LARGE = ["grid-250000-data-k2", "grid-1000000-data-k2"]
PEERS = ["cvxopt", "clarabel", "piqp", "scs", "osqp", "qpalm"]
MATRICES = {"cvxopt", "clarabel", "scs"}  # solvers with matrix cones
SIZE = {"nonnegative": 1, "psd2": 2, "psd3": 3}
RESIDUAL, GOOD, ENERGY, PLACE, FASTER = 1e-8, 1e-7, 1e-6, 1e-5, 3.0
TOLERANCE = 1e-8
EXTENDED = np.longdouble


class Problem:
    """One exported problem; products in extended precision."""

    def __init__(self, folder):
        def matrix(name):
            path = os.path.join(folder, name + ".mtx")
            return scipy.io.mmread(path, spmatrix=False).tocsr() if os.path.exists(path) else None

        with open(os.path.join(folder, "problem.json")) as text:
            given = json.load(text)
        self.P, self.L, self.Q, self.A = (matrix(name) for name in "PLQA")
        self.q, self.b, self.diagonal, self.weights = (np.array(given[name], float)
                                                       for name in ("linear", "offset", "diagonal", "weights"))
        self.constant, self.scale, self.order, self.cones = (given[name] for name in ("constant", "scale", "order", "cones"))
        self.fixed = np.array([np.nan if value is None else value for value in given["fixed"]])
        self.free = np.isnan(self.fixed)
        self.has_matrices = any(SIZE[cone["cone"]] > 1 for cone in self.cones)
        self.has_data = self.diagonal.any()

    def formed(self):
        if self.P is None:
            product = self.L
            for _ in range(self.order - 1):
                product = self.L @ sp.diags_array(self.weights) @ product
            self.P = (self.scale * product + sp.diags_array(self.diagonal) + (0 if self.Q is None else self.Q)).tocsr()
        return self.P

    def difference(self, x):
        """L x, as rows sum to zero, by differences."""
        row = np.repeat(np.arange(self.L.shape[0]), np.diff(self.L.indptr))
        return sums(self.L, self.L.data.astype(EXTENDED) * (x[self.L.indices] - x[row]))

    def product(self, x):
        """P x through the factors."""
        y = self.diagonal * x
        if self.L.nnz:
            part = self.difference(x)
            for _ in range(self.order - 1):
                part = self.difference(self.weights * part)
            y = y + EXTENDED(self.scale) * part
        return y if self.Q is None else y + sums(self.Q, self.Q.data * x[self.Q.indices])

    def energy(self, x):
        x = np.asarray(x, EXTENDED)
        return float(x @ self.product(x) / 2 + self.q.astype(EXTENDED) @ x + EXTENDED(self.constant))

    def rows(self, x):
        """A x + b."""
        x = np.asarray(x, EXTENDED)
        return sums(self.A, self.A.data * x[self.A.indices]) + self.b

    def least(self, rows):
        """The deepest negative row, or eigenvalue of a block; 0 if there is none."""
        worst, first = 0.0, 0
        for cone in self.cones:
            size = SIZE[cone["cone"]]
            length = size * (size + 1) // 2
            part = np.asarray(rows[first:first + cone["count"] * length], float).reshape(-1, length)
            first += part.size
            if part.size:
                worst = min(worst, part.min() if size == 1 else np.linalg.eigvalsh(unpacked(part, size)).min())
        return worst

    def residual(self, x, z):
        x, z = np.asarray(x, EXTENDED), np.asarray(z, EXTENDED)
        slack, force = self.rows(x), np.zeros(len(x), EXTENDED)
        np.add.at(force, self.A.indices, self.A.data * np.repeat(z, np.diff(self.A.indptr)))
        balance = self.product(x) + self.q - force
        most = max(abs(force[self.free]).max(), abs(balance[~self.free]).max(initial=0), 1e-3 * abs(self.q).max())
        size = (abs(self.A).dot(abs(np.asarray(x, float))) + abs(self.b)).max()
        return float(max(abs(balance[self.free]).max() / most, -self.least(slack) / size,
                         -self.least(z) / max(abs(z).max(), 1e-300), abs(x[~self.free] - self.fixed[~self.free]).max(initial=0) / size,
                         abs(z @ slack) / abs(self.energy(x))))


def sums(matrix, values):
    """Sums of the values of each row, rows without any included."""
    total = np.zeros(matrix.shape[0], EXTENDED)
    filled = np.diff(matrix.indptr) > 0
    total[filled] = np.add.reduceat(values, matrix.indptr[:-1][filled])
    return total


def unpacked(part, size):
    """Symmetric matrices from scaled lower triangles by rows."""
    full = np.zeros((len(part), size, size))
    for place, (row, column) in enumerate((a, b) for a in range(size) for b in range(a + 1)):
        full[:, row, column] = full[:, column, row] = part[:, place] / (1 if row == column else np.sqrt(2))
    return full


def eliminated(problem):
    """P, q, A, b over the free unknowns, and how to put a point together again."""
    inner, known = np.flatnonzero(problem.free), np.where(problem.free, 0, problem.fixed)
    P = problem.formed()

    def whole(x):
        point = known.copy()
        point[inner] = x
        return point

    return sp.csc_array(P[inner][:, inner]), (P @ known + problem.q)[inner], sp.csc_array(problem.A[:, inner]), \
        problem.A @ known + problem.b, whole


def by_cvxopt(problem, limit):
    import cvxopt
    P, q, A, b, whole = eliminated(problem)
    # Blocks as full matrices by columns, after all order rows.
    pieces, sizes, first, orders = [], [], 0, []
    for cone in problem.cones:
        size, length = SIZE[cone["cone"]], SIZE[cone["cone"]] * (SIZE[cone["cone"]] + 1) // 2
        if size == 1:
            orders.extend(range(first, first + cone["count"]))
        for block in range(cone["count"] if size > 1 else 0):
            place = {(a, c): first + block * length + a * (a + 1) // 2 + c for a in range(size) for c in range(a + 1)}
            pieces.extend((place[max(a, c), min(a, c)], 1 if a == c else np.sqrt(0.5)) for c in range(size) for a in range(size))
            sizes.append(size)
        first += cone["count"] * length
    chosen = [(row, 1) for row in orders] + pieces
    rows, scales = np.array([row for row, _ in chosen]), np.array([scale for _, scale in chosen])
    lift = sp.csr_array((scales, (np.arange(len(rows)), rows)), (len(rows), problem.A.shape[0]))
    G, h = -(lift @ A), lift @ b

    def convert(matrix):
        matrix = matrix.tocoo()
        return cvxopt.spmatrix(matrix.data.tolist(), matrix.row.tolist(), matrix.col.tolist(), matrix.shape)

    cvxopt.solvers.options.update(show_progress=False, abstol=1e-14, reltol=TOLERANCE, feastol=TOLERANCE, maxiters=200)
    arguments = convert(P), cvxopt.matrix(q), convert(G), cvxopt.matrix(h)
    begin = time.perf_counter()
    answer = cvxopt.solvers.coneqp(*arguments, {"l": len(orders), "q": [], "s": sizes})
    seconds = time.perf_counter() - begin
    return whole(np.array(answer["x"]).ravel()), lift.T @ np.array(answer["z"]).ravel(), seconds, answer["iterations"]


def by_clarabel(problem, limit):
    import clarabel
    P, q, A, b, whole = eliminated(problem)
    cones = []
    for cone in problem.cones:
        size, count = SIZE[cone["cone"]], cone["count"]
        cones += [clarabel.NonnegativeConeT(count)] if size == 1 else [clarabel.PSDTriangleConeT(size)] * count
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads, settings.time_limit = False, 1, limit
    # Its absolute gap stops it early where objectives are small.
    settings.tol_gap_abs, settings.tol_gap_rel, settings.tol_feas = 1e-14, TOLERANCE, TOLERANCE
    upper = sp.csc_matrix(sp.triu(P))
    begin = time.perf_counter()
    answer = clarabel.DefaultSolver(upper, q, sp.csc_matrix(-A), b, cones, settings).solve()
    seconds = time.perf_counter() - begin
    return whole(np.array(answer.x)), np.array(answer.z), seconds, answer.iterations


def by_scs(problem, limit):
    import scs
    P, q, A, b, whole = eliminated(problem)
    orders = sum(cone["count"] for cone in problem.cones if cone["cone"] == "nonnegative")
    # Its triangles go by columns of the lower part: for 3 x 3 matrices places 2 and 3 of ours change.
    order = []
    first = 0
    for cone in problem.cones:
        length = SIZE[cone["cone"]] * (SIZE[cone["cone"]] + 1) // 2
        local = [0, 1, 3, 2, 4, 5] if length == 6 else list(range(length))
        order.extend((first + np.arange(cone["count"])[:, None] * length + local).ravel())
        first += cone["count"] * length
    sizes = [SIZE[cone["cone"]] for cone in problem.cones for _ in range(cone["count"] if cone["cone"] != "nonnegative" else 0)]
    data = {"P": sp.csc_matrix(sp.triu(P)), "A": sp.csc_matrix(-A[order]), "b": b[order], "c": q}
    begin = time.perf_counter()
    solver = scs.SCS(data, {"l": orders, "s": sizes}, eps_abs=TOLERANCE, eps_rel=TOLERANCE, eps_infeas=1e-12,
                     time_limit_secs=limit, max_iters=10**7, verbose=False)
    answer = solver.solve()
    seconds = time.perf_counter() - begin
    z = np.zeros(len(b))
    z[order] = answer["y"]
    return whole(answer["x"]), z, seconds, answer["info"]["iter"]


def by_piqp(problem, limit):
    import piqp
    P, q, A, b, whole = eliminated(problem)
    solver = piqp.SparseSolver()
    solver.settings.eps_abs, solver.settings.eps_rel, solver.settings.eps_duality_gap_rel = 1e-14, TOLERANCE, TOLERANCE
    solver.settings.eps_duality_gap_abs, solver.settings.max_iter = 1e-14, 200
    G, P = sp.csc_matrix(A), sp.csc_matrix(P)
    begin = time.perf_counter()
    solver.setup(P, q, None, None, G, -b, None, None, None)
    solver.solve()
    seconds = time.perf_counter() - begin
    result = solver.result
    return whole(result.x), result.z_l - result.z_u, seconds, result.info.iter


def by_osqp(problem, limit):
    import osqp
    P, q, A, b, whole = eliminated(problem)
    solver = osqp.OSQP()
    upper, rows = sp.csc_matrix(sp.triu(P)), sp.csc_matrix(A)
    begin = time.perf_counter()
    solver.setup(P=upper, q=q, A=rows, l=-b, u=np.full(len(b), np.inf), eps_abs=1e-12, eps_rel=TOLERANCE, max_iter=10**7,
                 time_limit=limit, polishing=True, verbose=False)
    answer = solver.solve()
    seconds = time.perf_counter() - begin
    return whole(answer.x), -np.array(answer.y), seconds, answer.info.iter


def by_qpalm(problem, limit):
    import qpalm
    P, q, A, b, whole = eliminated(problem)
    data = qpalm.Data(len(q), len(b))
    data.Q, data.A, data.q = sp.csc_matrix(P), sp.csc_matrix(A), q
    data.bmin, data.bmax = -b, np.full(len(b), np.inf)
    settings = qpalm.Settings()
    settings.eps_abs, settings.eps_rel, settings.max_iter, settings.verbose = 1e-12, TOLERANCE, 10**6, False
    settings.time_limit = limit
    begin = time.perf_counter()
    solver = qpalm.Solver(data, settings)
    solver.solve()
    seconds = time.perf_counter() - begin
    return whole(np.array(solver.solution.x)), -np.array(solver.solution.y), seconds, solver.info.iter


def worker(name, folder, out, limit):
    """One solve by one peer, in this process."""
    problem = Problem(folder)
    x, z, seconds, iterations = globals()["by_" + name](problem, limit)
    np.savez(out, x=x, z=z, seconds=seconds, iterations=iterations)


def run(command, threads, limit):
    """Runs a command; peak memory in MiB, or None if it failed or took too long."""
    environment = dict(os.environ, RAYON_NUM_THREADS=str(threads), OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")
    child = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 30, int(limit) + 60)))
    error = child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    return usage.ru_maxrss / 1024 if status == 0 else None, error.decode(errors="replace").strip().splitlines()[-1:]


def ours(given, name, folder, threads, limit):
    out = os.path.join(folder, f"ours-{threads}.json")
    memory, error = run([given.program, "run", name, out, f"repeats={given.repeats}"], threads, limit)
    if memory is None:
        return None, error
    with open(out) as text:
        answer = json.load(text)
    answer["memory"] = memory
    return answer, None


def compare(given, name, folder):
    """One problem: prints its rows, returns the bars that it misses."""
    made = subprocess.run([given.program, folder, f"only={name}", "solve=no"], capture_output=True, text=True)
    if made.returncode:
        raise SystemExit(f"{name}: {made.stderr.strip()}")
    folder = os.path.join(folder, name)
    problem = Problem(folder)
    missed, energies = [], None
    answers = {}
    for threads in (1, 2):
        answer, error = ours(given, name, folder, threads, given.limit)
        if answer is None:
            return [f"{name}: ours failed: {error}"]
        answers[threads] = answer
        x, z = np.array(answer["x"]), np.array(answer["dual"])
        residual, energy = problem.residual(x, z), problem.energy(x)
        energies = energy if energies is None else energies
        ratio = answer["seconds_processor"] / max(answer["floor_processor"], 1e-9)
        row(name, f"ours, {threads} thread{'s' * (threads > 1)}", answer["seconds"], answer["iterations"], answer["factorizations"],
            residual, energy / energies - 1, None, answer["memory"], f"{ratio:.1f}", None)
    one = answers[1]
    x, z = np.array(one["x"]), np.array(one["dual"])
    residual, energy = problem.residual(x, z), problem.energy(x)
    if one["status"] != "solved" or residual > RESIDUAL * max(1, one["kkt"]["rounding"] / RESIDUAL):
        missed.append(f"{name}: ours {one['status']}, residual {residual:.1e}")
    if one["x"] != answers[2]["x"] or one["dual"] != answers[2]["dual"]:
        missed.append(f"{name}: other bits with two threads")
    ratio = one["seconds_processor"] / max(one["floor_processor"], 1e-9)
    most = None if problem.has_matrices else 15 if problem.has_data else 20
    if most and ratio > most:
        missed.append(f"{name}: {ratio:.1f} times one factorization plus solve; at most {most}")
    fastest = None
    for peer in given.solvers:
        if problem.has_matrices and peer not in MATRICES:
            continue
        out = os.path.join(folder, peer + ".npz")
        memory, error = run([sys.executable, os.path.abspath(__file__), "--worker", peer, folder, out, str(given.limit)], 1, given.limit)
        if memory is None:
            print(f"| {name} | {peer} | failed or over {given.limit:g} s: {' '.join(error)[:80]} |", flush=True)
            continue
        answer = np.load(out)
        off = problem.energy(answer["x"]) / energy - 1
        apart = abs(answer["x"] - x).max() / np.ptp(x)
        theirs = problem.residual(answer["x"], answer["z"])
        seconds = float(answer["seconds"])
        counts = theirs <= max(GOOD, residual)
        row(name, peer + ("" if counts else " (not solved)"), seconds, int(answer["iterations"]), None, theirs, off, apart, memory,
            None, seconds / one["seconds"])
        if counts:
            fastest = min(filter(None, (fastest, (seconds, peer))))
            if abs(off) > ENERGY or apart > PLACE:
                missed.append(f"{name}: {peer} is off by {off:.1e} in energy, {apart:.1e} in x")
    if fastest and fastest[0] < FASTER * one["seconds"]:
        missed.append(f"{name}: {fastest[1]} takes {fastest[0] / one['seconds']:.2f} times our seconds; at least {FASTER:g}")
    return missed


def row(name, solver, seconds, iterations, factorizations, residual, off, apart, memory, ratio, against):
    def text(value, form):
        return "" if value is None else format(value, form)

    print(f"| {name} | {solver} | {seconds:.3f} | {iterations} | {text(factorizations, 'd')} | {residual:.1e} | {off:+.1e} | "
          f"{text(apart, '.1e')} | {memory:.0f} | {ratio or ''} | {text(against, '.2f')} |", flush=True)


def main():
    if sys.argv[1:2] == ["--worker"]:
        worker(*sys.argv[2:5], float(sys.argv[5]))
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.path.join(ROOT, "target/release/examples/test_set"))
    parser.add_argument("--only", nargs="+", choices=NAMES + LARGE, metavar="NAME", default=None)
    parser.add_argument("--solvers", nargs="+", choices=PEERS, metavar="NAME", default=PEERS)
    parser.add_argument("--large", action="store_true", help="also 250,000 and 1,000,000 unknowns")
    parser.add_argument("--limit", type=float, default=30, metavar="SECONDS", help="of processor time for each solve (default 30)")
    parser.add_argument("--repeats", type=int, default=3, help="of ours; the best counts")
    parser.add_argument("--keep", metavar="FOLDER", help="where the problems and answers stay")
    given = parser.parse_args()
    names = given.only or NAMES + (LARGE if given.large else [])
    missed = []
    print("| problem | solver | seconds | iterations | factorizations | residual | energy | x | MiB | ratio | theirs / ours |\n"
          "|---|---|---|---|---|---|---|---|---|---|---|")
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            missed += compare(given, name, given.keep or folder)
    print(f"\n{len(names)} problems, {len(missed)} bars missed")
    for line in missed:
        print("missed:", line)
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
