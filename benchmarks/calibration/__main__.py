"""Calibrate and write the report: ``python -m benchmarks.calibration``."""

import sys

from benchmarks.calibration.report import main

if __name__ == '__main__':
    sys.exit(main())
