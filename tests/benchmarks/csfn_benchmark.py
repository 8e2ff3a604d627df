#!/usr/bin/env python3
"""An iteration of the CSFN in C++, NumPy and PyTorch in one run, with the ratios.

An iteration is the gradient of the mean loss over one batch and Adam's update, in double precision
and on one thread. NumPy computes the gradient of the fused form by hand, PyTorch by autograd
through the paper's layers with its own Adam, which is how the paper's program worked. PyTorch is
optional. Exit code 1 when a figure misses its bound.

usage: csfn_benchmark.py PROGRAM   (the csfn_benchmark executable)
"""

import json
import math
import os
import subprocess
import sys
import time

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before NumPy is loaded

import numpy as np

NAMES = ("a1", "a2", "b1", "b2", "t")
A1, A2, B1, B2, BETA = 0.3428, 0.2537, 0.0485, -0.0224, 0.9032
RATE, DECAY1, DECAY2, EPSILON = 0.01, 0.9, 0.999, 1e-8
LIMITS_US = {100: 0.5, 1000: 2.0}
LEAST_RATIO = {"NumPy": 50, "PyTorch": 400}
IDENTIFICATION_MS = 20


def samples(count=10000):
    theta = np.random.default_rng(2018).uniform(0, 2 * math.pi, count)
    return A1 * np.sin(theta) + B1, A2 * np.cos(theta + BETA) + B2


def start(u, v):
    return np.array([np.abs(u).max(), np.abs(v).max(), 0.0, 0.0, 0.0])


def numpy_gradient(nodes, u, v):
    a1, a2, b1, b2, t = nodes
    x = (u - b1) / a1
    y = (v - b2) / a2
    inverse_l2 = (1 + t * t) / (1 + t) ** 2
    inverse_s2 = (1 + t * t) / (1 - t) ** 2
    a = (inverse_l2 + inverse_s2) / 2
    b = (inverse_s2 - inverse_l2) / 2
    a_by_t = (t - 1) / (1 + t) ** 3 + (t + 1) / (1 - t) ** 3
    b_by_t = (t + 1) / (1 - t) ** 3 - (t - 1) / (1 + t) ** 3
    xx, yy, xy = x * x, y * y, x * y
    w = 1 - 1 / np.sqrt(a * (xx + yy) + 2 * b * xy)
    wx, wy, wxx, wyy, wxy = (np.dot(w, s) / len(u) for s in (x, y, xx, yy, xy))
    return np.array(
        [
            -2 * (a * wxx + b * wxy) / a1,
            -2 * (a * wyy + b * wxy) / a2,
            -2 * (a * wx + b * wy) / a1,
            -2 * (a * wy + b * wx) / a2,
            (wxx + wyy) * a_by_t + 2 * wxy * b_by_t,
        ]
    )


class NumpyAdam:
    def __init__(self):
        self.m, self.v, self.k = np.zeros(5), np.zeros(5), 0

    def update(self, nodes, gradient):
        self.k += 1
        self.m = DECAY1 * self.m + (1 - DECAY1) * gradient
        self.v = DECAY2 * self.v + (1 - DECAY2) * gradient**2
        step = RATE / (1 - DECAY1**self.k)
        nodes -= step * self.m / (np.sqrt(self.v / (1 - DECAY2**self.k)) + EPSILON)


def best_of(runs, iterations, run):
    """Processor time, as for the C++ program: other work on the machine is not counted."""
    times = []
    for _ in range(runs):
        begin = time.process_time()
        run(iterations)
        times.append((time.process_time() - begin) / iterations)
    return min(times) * 1e6


def time_numpy(batch):
    u, v = samples()

    def run(iterations):
        nodes, adam, at = start(u, v), NumpyAdam(), 0
        for _ in range(iterations):
            adam.update(nodes, numpy_gradient(nodes, u[at : at + batch], v[at : at + batch]))
            at = at + batch if at + 2 * batch <= len(u) else 0
        error = abs(nodes[:4] - (A1, A2, B1, B2)).max()
        assert iterations < 1000 or error < 0.05, "the NumPy network does not converge"

    return best_of(5, 2000, run)


def time_torch(torch, batch):
    torch.set_num_threads(1)
    u, v = (torch.from_numpy(channel) for channel in samples())
    first = torch.from_numpy(start(u.numpy(), v.numpy()))

    def run(iterations):
        nodes = [value.clone().requires_grad_() for value in first]
        a1, a2, b1, b2, t = nodes
        optimizer = torch.optim.Adam(nodes, lr=RATE)
        at = 0
        for _ in range(iterations):
            u1 = (u[at : at + batch] - b1) / a1  # Eq (5)
            v1 = (v[at : at + batch] - b2) / a2
            v2 = (v1 - u1) * math.sqrt(0.5)  # Eq (8)
            u2 = (v1 + u1) * math.sqrt(0.5)
            root = torch.sqrt(1 + t * t)  # Eq (23)
            y = torch.sqrt((root / (1 + t) * v2) ** 2 + (root / (1 - t) * u2) ** 2)
            loss = ((1 - y) ** 2).mean()  # Eq (15)
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            at = at + batch if at + 2 * batch <= len(u) else 0
        error = max(abs(node.item() - true) for node, true in zip(nodes, (A1, A2, B1, B2)))
        assert iterations < 1000 or error < 0.05, "the PyTorch network does not converge"

    return best_of(3, 1000, run)


def time_cpp(program):
    text = subprocess.run(
        [program, "--benchmark_format=json", "--benchmark_repetitions=5", "--benchmark_min_time=0.1"],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    scale = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}
    best = {}
    for row in json.loads(text)["benchmarks"]:
        if row.get("run_type") == "aggregate" or "error_message" in row:
            continue
        name, microseconds = row["name"], row["cpu_time"] * scale[row["time_unit"]]
        best[name] = min(best.get(name, math.inf), microseconds)
    return best


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    try:
        import torch
    except ImportError:
        torch = None
        print("PyTorch is not installed (Debian: python3-torch), so its column is left out.\n")
    cpp = time_cpp(sys.argv[1])
    missed = []

    def judge(good, text):
        if not good:
            missed.append(text)
        return "" if good else "  MISSED"

    print("one iteration (gradient and Adam), microseconds")
    print(f"{'batch':>8} {'C++':>8} {'NumPy':>9} {'ratio':>7} {'PyTorch':>9} {'ratio':>7}")
    for batch, limit in LIMITS_US.items():
        ours = cpp[f"iteration/widest/{batch}"]
        line = f"{batch:8d} {ours:8.3f}"
        mark = judge(ours <= limit, f"batch {batch}: {ours:.3f} us, bound {limit}")
        others = {"NumPy": time_numpy(batch)}
        if torch is not None:
            others["PyTorch"] = time_torch(torch, batch)
        for name, microseconds in others.items():
            ratio = microseconds / ours
            line += f" {microseconds:9.1f} {ratio:7.0f}"
            # The ratios are stated for the paper's batch; Python's own cost, the same for every batch,
            # weighs less in a larger one.
            if batch == 100:
                mark += judge(ratio >= LEAST_RATIO[name], f"{name}: ratio {ratio:.0f}, bound {LEAST_RATIO[name]}")
        print(line + mark)
    print("\nthe rest of the C++ program")
    for name, microseconds in cpp.items():
        mark = ""
        if name == "identification/adam/100000":
            mark = judge(
                microseconds <= IDENTIFICATION_MS * 1e3,
                f"{name}: {microseconds / 1e3:.1f} ms, bound {IDENTIFICATION_MS}",
            )
        print(f"{name:42} {microseconds:12.3f} us{mark}")
    print("\nthe paper: 464 us an iteration of batch 100, 46.42 s for 100,000")
    for text in missed:
        print("missed: " + text)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
