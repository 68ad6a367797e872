"""Installation by colcon and by pip; name and version come from package.xml."""

from pathlib import Path
from xml.etree import ElementTree

from setuptools import find_packages, setup

ROOT = Path(__file__).resolve().parent
MANIFEST = ElementTree.parse(ROOT / 'package.xml').getroot()
NAME = MANIFEST.findtext('name')
SHARE = Path('share') / NAME


def data_below(directory):
    """List every folder below a directory with its files, as ``data_files`` wants them."""
    files = sorted(path for path in (ROOT / directory).rglob('*')
                   if path.is_file() and '__pycache__' not in path.parts)
    folders = sorted({path.parent for path in files})
    return [(str(SHARE / folder.relative_to(ROOT)),
             [str(path.relative_to(ROOT)) for path in files if path.parent == folder])
            for folder in folders]


setup(
    name=NAME,
    version=MANIFEST.findtext('version'),
    description=' '.join(MANIFEST.findtext('description').split()),
    url=MANIFEST.findtext('url'),
    author=MANIFEST.findtext('author'),
    maintainer=MANIFEST.findtext('maintainer'),
    maintainer_email=MANIFEST.find('maintainer').get('email'),
    license=MANIFEST.findtext('license'),
    keywords='robotics pushing manipulation planning control simulation ros2',
    classifiers=['Intended Audience :: Science/Research', 'Operating System :: POSIX :: Linux',
                 'Programming Language :: Python :: 3', 'Topic :: Scientific/Engineering'],
    python_requires='>=3.10',
    packages=find_packages(include=['push_*'], exclude=['push_control_msgs*']),
    package_data={'push_planner': ['outlook.json'], 'push_scenario': ['dds/*.xml'],
                  'push_view': ['page/*']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (str(SHARE), ['package.xml']),
        *data_below('config'),
        *data_below('launch'),
        (f'lib/{NAME}', sorted(str(path.relative_to(ROOT))
                               for path in (ROOT / 'scripts').iterdir())),
    ],
    # What tasks of straight pushes need besides ROS; all of it is in Ubuntu, too.
    install_requires=['setuptools', 'numpy', 'scipy', 'numba', 'PyYAML'],
    extras_require={
        # Solvers and buffers as casadi has them from 3.7.0 on.
        'steered': ['casadi>=3.7.0'],
        'cluster': ['distributed'],
        'completion': ['argcomplete'],
        'gym': ['gymnasium', 'matplotlib'],
        'mujoco': ['mujoco'],
        'play': ['aiohttp', 'segno'],
        'plot': ['matplotlib', 'pillow', 'tqdm'],
        'record': ['rosbags'],
        'table': ['pandas'],
        'trees': ['py_trees'],
        # Detector of tags as OpenCV has it from 4.7 on.
        'vision': ['opencv-python-headless>=4.7'],
        'test': ['catkin-pkg', 'colcon-core', 'colcon-ros', 'hypothesis', 'mcap', 'pytest',
                 'pytest-xdist', 'selenium'],
    },
    zip_safe=False,
    # What people type. What ros2 run and launch files start lies apart, as their names are those
    # of other commands, too.
    entry_points={'console_scripts': ['push = push_ros.start:push']},
)
