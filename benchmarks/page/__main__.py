"""Run the benchmark: ``python -m benchmarks.page``."""

import sys

from benchmarks.page.benchmark import main

if __name__ == '__main__':
    sys.exit(main())
