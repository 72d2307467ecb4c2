#!/usr/bin/env python3
"""The optimum against two public solvers: ten problems, energies and residuals.

Usage:  cargo build --release --example export_qp
        python tools/bars/optimum.py [--export target/release/examples/export_qp] [--data ../shared/data] [--only NAME ...]
Needs:  pip install numpy==2.4.6 scipy==1.17.1 vtk==9.7.2 pyvista==0.49.1 cvxopt==1.3.3 clarabel==0.11.1

Ten fields, orders 1 to 4, extrema selected on the data and on the smooth field, in one and two dimensions and on a closed
surface. export_qp writes each quadratic problem with the matrix P formed, and our solution; cvxopt (fixed unknowns
eliminated) and clarabel (fixed unknowns as equations) solve the same files to tolerances of 1e-11; ours stops at its own 1e-8.

All that is compared is computed here, in extended precision (80 bits), with P as the product of its factors: entries of the
formed P have lost digits at orders 3 and 4.
  energy       E(x) = 1/2 x'Px + q'x + c with the constant, so that nothing large hides a difference. Ours, and each peer's
               relative to ours. Peers stop at points that violate rows by what the column says.
  residuals    of our point and duals z: stationarity Px + q - A'z at free unknowns over the largest force in that balance (an
               entry of A'z, or the reaction at a fixed unknown), violation of rows, negative duals, and the gap z'(Ax + b) over E
Bars: at least one peer solves each problem, every peer that does agrees to 1e-6; residuals at most 1e-8. Exit code 1 if one is
missed. A peer counts as having solved a problem if it says so, or if it violates no row by more than 1e-9.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

import clarabel
import cvxopt
import numpy as np
import pyvista as pv
import scipy.io
import scipy.sparse as sp

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tools", "quality"))
import planted  # noqa: E402

AGREEMENT, RESIDUAL = 1e-6, 1e-8
JET = ("flow/jet_pivmat.vti", "vorticity_magnitude", "valid")
SOAP = ("flow/soap_film.vti", "vorticity_magnitude", "valid")
# name: (file, array, mask), part of the points [i, j], options
PROBLEMS = {
    "soap film, k = 1": (SOAP, None, dict(order=1, persistence=0.2, select="data", length=0.01)),
    "soap film, k = 2": (SOAP, None, dict(order=2, persistence=0.2, select="data", length=0.01)),
    "soap film, k = 3": (SOAP, None, dict(order=3, persistence=0.4, select="data", length=0.01)),
    "soap film, k = 4": (SOAP, None, dict(order=4, persistence=0.4, select="data", length=0.01)),
    "jet, middle": (JET, np.s_[30:90, 30:90], dict(order=2, persistence=0.1, select="data", length=0.02)),
    "jet, middle, smooth": (JET, np.s_[30:90, 30:90], dict(order=2, persistence=0.1, select="smooth", length=0.02)),
    "planted, every 2nd": (("planted", "noisy", None), np.s_[::2, ::2],
                           dict(order=2, persistence=0.1, select="smooth", length=0.02)),
    "planted, every 3rd, k = 3": (("planted", "noisy", None), np.s_[::3, ::3],
                                  dict(order=3, persistence=0.3, select="data", length=0.02)),
    "microwave sky": (("datasets/cmb.vtp", "temperature", "valid"), None,
                      dict(order=2, persistence=0.2, select="smooth", length=0.01)),
    "carbon dioxide, 1-D": (("datasets/co2.vtp", "co2", None), None, dict(order=2, persistence=0.05, select="data", length=0.01)),
}


def prepare(source, part, data, folder):
    """The file to read, cut if asked."""
    path, array, mask = source
    if path == "planted":
        mesh = planted.grid(0, 5.0)
    elif part is None:
        return os.path.join(ROOT if path.startswith("datasets") else data, path)
    else:
        mesh = pv.read(os.path.join(data, path))
    number = np.arange(mesh.n_points).reshape(mesh.dimensions[1::-1])[part]
    step = [s * (p.step or 1) for s, p in zip(mesh.spacing, part[::-1])]
    cut = pv.ImageData(dimensions=(*number.shape[::-1], 1), spacing=(*step, 1.0))
    for name in filter(None, (array, mask)):
        cut.point_data[name] = np.asarray(mesh.point_data[name])[number.ravel()]
    cut.save(os.path.join(folder, "cut.vti"))
    return os.path.join(folder, "cut.vti")


class Problem:
    """One exported problem; products in extended precision."""

    def __init__(self, folder):
        self.P, self.L, self.A = (scipy.io.mmread(os.path.join(folder, f"{name}.mtx"), spmatrix=False).tocsr()
                                  for name in "PLA")
        with open(os.path.join(folder, "problem.json")) as text:
            given = json.load(text)
        self.q, self.b, self.diagonal, self.weights = (np.array(given[name], float)
                                                       for name in ("linear", "offset", "diagonal", "weights"))
        self.constant, self.scale, self.order = given["constant"], given["scale"], given["order"]
        self.fixed = np.array([np.nan if value is None else value for value in given["fixed"]])
        self.free = np.isnan(self.fixed)
        self.ours = given["solution"]

    def difference(self, x):
        """L x, as rows sum to zero, by differences."""
        L = self.L
        row = np.repeat(np.arange(L.shape[0]), np.diff(L.indptr))
        return np.add.reduceat(L.data.astype(np.longdouble) * (x[L.indices] - x[row]), L.indptr[:-1])

    def product(self, x):
        """P x through the factors."""
        y = self.difference(x)
        for _ in range(self.order - 1):
            y = self.difference(self.weights * y)
        return np.longdouble(self.scale) * y + self.diagonal * x

    def energy(self, x):
        x = np.asarray(x, np.longdouble)
        return float(0.5 * x @ self.product(x) + self.q.astype(np.longdouble) @ x + np.longdouble(self.constant))

    def rows(self, x):
        """A x + b."""
        A, x = self.A, np.asarray(x, np.longdouble)
        return np.add.reduceat(A.data * x[A.indices], A.indptr[:-1]) + self.b

    def residuals(self, x, z):
        x, z = np.asarray(x, np.longdouble), np.asarray(z, np.longdouble)
        slack, force = self.rows(x), np.zeros(len(x), np.longdouble)
        np.add.at(force, self.A.indices, self.A.data * np.repeat(z, np.diff(self.A.indptr)))
        balance = self.product(x) + self.q - force
        most = max(abs(force).max(), abs(balance[~self.free]).max(initial=0), 1e-3 * abs(self.q).max())
        size = abs(self.A).dot(abs(np.asarray(x, float))) + abs(self.b)
        return {"stationarity": float(abs(balance[self.free]).max() / most),
                "violation": float(max(0, -slack.min()) / size.max()),
                "negative dual": float(max(0, -z.min()) / z.max()),
                "fixed": float(abs(x[~self.free] - self.fixed[~self.free]).max(initial=0)),
                "gap": float(abs(z @ slack) / self.energy(x))}


def by_cvxopt(problem):
    free, inner = problem.free, np.flatnonzero(problem.free)
    known = np.where(free, 0, problem.fixed)

    def convert(matrix):
        matrix = matrix.tocoo()
        return cvxopt.spmatrix(matrix.data.tolist(), matrix.row.tolist(), matrix.col.tolist(), matrix.shape)

    cvxopt.solvers.options.update(show_progress=False, abstol=1e-13, reltol=1e-11, feastol=1e-11, maxiters=100, refinement=2)
    q = (problem.P @ known + problem.q)[inner]
    answer = cvxopt.solvers.qp(convert(problem.P[inner][:, inner]), cvxopt.matrix(q), convert(-problem.A[:, inner]),
                               cvxopt.matrix(problem.A @ known + problem.b))
    x = known.copy()
    x[inner] = np.array(answer["x"]).ravel()
    return x, answer["status"] == "optimal", answer["iterations"]


def by_clarabel(problem):
    fixed = np.flatnonzero(~problem.free)
    choose = sp.csc_array((np.ones(len(fixed)), (np.arange(len(fixed)), fixed)), (len(fixed), len(problem.fixed)))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs, settings.tol_gap_rel, settings.tol_feas = 1e-14, 1e-11, 1e-11
    settings.reduced_tol_gap_abs, settings.reduced_tol_gap_rel, settings.reduced_tol_feas = 1e-10, 1e-9, 1e-9
    solver = clarabel.DefaultSolver(
        sp.csc_matrix(sp.triu(problem.P)), problem.q, sp.csc_matrix(sp.vstack([choose, -problem.A])),
        np.r_[problem.fixed[fixed], problem.b],
        [clarabel.ZeroConeT(len(fixed)), clarabel.NonnegativeConeT(len(problem.b))], settings)
    answer = solver.solve()
    return np.array(answer.x), str(answer.status) in ("Solved", "AlmostSolved"), answer.iterations


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--export", default=os.path.join(ROOT, "target/release/examples/export_qp"))
    parser.add_argument("--data", default=os.path.join(ROOT, "../shared/data"))
    parser.add_argument("--only", nargs="+", choices=PROBLEMS, metavar="NAME", default=list(PROBLEMS))
    given = parser.parse_args()
    missed = 0
    print("| problem | n, fixed, rows | E | stationarity | violation | gap | cvxopt | clarabel |\n|---|---|---|---|---|---|---|---|")
    for name in given.only:
        source, part, options = PROBLEMS[name]
        with tempfile.TemporaryDirectory() as folder:
            path = prepare(source, part, given.data, folder)
            call = [given.export, path, folder, f"array={source[1]}", *([f"mask={source[2]}"] if source[2] else []),
                    *(f"{key}={value}" for key, value in options.items())]
            done = subprocess.run(call, capture_output=True, text=True)
            if done.returncode:
                raise SystemExit(f"{name}: {done.stderr.strip()}")
            problem = Problem(folder)
        ours = problem.ours
        energy, residuals = problem.energy(ours["x"]), problem.residuals(ours["x"], ours["dual"])
        good = ours["status"] == "solved" and max(residuals.values()) <= RESIDUAL
        agreed, cells = 0, []
        for solve in (by_cvxopt, by_clarabel):
            begin = time.perf_counter()
            try:
                x, solved, iterations = solve(problem)
            except (ArithmeticError, ValueError) as error:
                cells.append(f"failed: {error}")
                continue
            seconds = time.perf_counter() - begin
            off, violation = problem.energy(x) / energy - 1, float(max(0, -problem.rows(x).min()))
            counts = solved or violation <= 1e-9
            agreed += counts and abs(off) <= AGREEMENT
            good &= not counts or abs(off) <= AGREEMENT
            cells.append(f"{off:+.1e} (violation {violation:.0e}, {iterations} iterations, {seconds:.1f} s"
                         f"{'' if solved else ', not to its tolerance'})")
        good &= agreed > 0
        missed += not good
        print(f"| {name}{'' if good else ' MISSED'} | {len(problem.q)}, {(~problem.free).sum()}, {len(problem.b)} | {energy:.9e} | "
              f"{residuals['stationarity']:.0e} | {max(residuals['violation'], residuals['negative dual'], residuals['fixed']):.0e} | "
              f"{residuals['gap']:.0e} | {' | '.join(cells)} |", flush=True)
    print(f"\n{len(given.only)} problems, {missed} missed: energies to {AGREEMENT:g}, residuals to {RESIDUAL:g}")
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
