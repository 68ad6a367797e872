"""Run the benchmark: ``python -m benchmarks.chances``."""

import sys

from benchmarks.chances.benchmark import main

if __name__ == '__main__':
    sys.exit(main())
