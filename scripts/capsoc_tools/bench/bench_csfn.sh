#!/usr/bin/env bash
# The speeds of the CSFN identifier, NumPy and PyTorch (optional: python3-torch), with the ratios, in one run.
# BUILD (default: build) is a configured build directory. Exit 1 when a figure misses its bound.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../.."
build=${1:-build}
cmake --build "$build" --target csfn_benchmark >/dev/null
# Debian's packages belong to this interpreter, whatever else is on the path.
python=/usr/bin/python3
if ! "$python" -c 'import numpy' 2>/dev/null; then
  echo "bench_csfn: NumPy is missing; run: apt-get install -y python3-numpy" >&2
  exit 2
fi
exec "$python" tests/benchmarks/csfn_benchmark.py "$build/tests/benchmarks/csfn_benchmark"
