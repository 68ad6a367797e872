"""Run the benchmark: ``python -m benchmarks.controller``."""

import sys

from benchmarks.controller.benchmark import main

if __name__ == '__main__':
    sys.exit(main())
