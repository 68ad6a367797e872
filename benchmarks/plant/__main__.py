"""Run the benchmark: ``python -m benchmarks.plant``."""

import sys

from benchmarks.plant.benchmark import main

if __name__ == '__main__':
    sys.exit(main())
