"""The package of the action: its manifest, and where build tools find it."""

from catkin_pkg.package import parse_package
from helpers.architecture import ROOT
from setuptools import find_packages

FOLDER = ROOT / 'push_control_msgs'


def test_its_manifest_is_one_of_an_interface_package():
    """ROS tools read it without a warning; it has the version of the package beside it."""
    warnings = []
    manifest = parse_package(str(FOLDER), warnings=warnings)
    assert warnings == []
    assert manifest.get_build_type() == 'ament_cmake'
    assert [group.name for group in manifest.member_of_groups] == ['rosidl_interface_packages']
    assert manifest.version == parse_package(str(ROOT)).version
    assert (FOLDER / 'LICENSE').read_text() == (ROOT / 'LICENSE').read_text()


def test_it_is_no_python_package_of_the_other_one():
    """Installing push_control installs no folder that hides the messages."""
    assert not [name for name in find_packages(str(ROOT), include=['push_*'])
                if name.startswith(FOLDER.name)]
