"""Pin requirements.in, and all it pulls in, as requirements.txt; run by the oldest Python."""

import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADER = '# Made by `make lock` from requirements.in, for Python 3.10 to 3.13. Do not edit.\n'
ONLY_OLDEST = {'exceptiongroup', 'tomli'}


def resolve():
    """Ask pip what it would install into an environment that has only the build tools."""
    command = [sys.executable, '-m', 'pip', 'install', '--dry-run', '--quiet', '--report', '-',
               '--no-build-isolation', '-r', str(ROOT / 'requirements.in')]
    report = subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout
    for item in json.loads(report)['install']:
        yield item['metadata']['name'].lower().replace('_', '-'), item['metadata']['version']


def main():
    """Write requirements.txt."""
    if sys.version_info[:2] != (3, 10):
        raise SystemExit(f'pin with Python 3.10, the oldest supported, not {sys.version}')
    lines = []
    for name, version in sorted(resolve()):
        marker = "; python_version < '3.11'" if name in ONLY_OLDEST else ''
        lines.append(f'{name}=={version}{marker}\n')
    (ROOT / 'requirements.txt').write_text(HEADER + ''.join(lines))


if __name__ == '__main__':
    main()
