"""Objects by name: whose values count, and what is said of names that nobody knows."""

from helpers.objects import box
from push_model.files.data import config_file
from push_model.files.parameter_files import read_object
from push_ros.object_catalogue import ObjectCatalogue, UnknownObject
import pytest


def test_parameters_come_before_files_of_the_user_and_these_before_the_package(tmp_path):
    """Each is found by its name; files are read when they are asked for."""
    catalogue = ObjectCatalogue(str(tmp_path))
    catalogue.check_folder()
    bin_file = config_file('objects/bin.yaml')
    assert catalogue.find('bin') == read_object(bin_file)
    for name in ('bin', 'crate'):
        (tmp_path / f'{name}.yaml').write_text(bin_file.read_text().replace('mass: 3', 'mass: 4'))
    assert catalogue.find('bin').mass == catalogue.find('crate').mass == 4.0
    catalogue.remember('bin', box())
    catalogue.remember('', box(mass=7.0))
    assert catalogue.find('bin') == box() and catalogue.find('').mass == 7.0
    assert catalogue.names == ['bin', 'box_04', 'carton', 'coffee_table', 'crate']


def test_an_unknown_name_is_refused_with_those_there_are():
    with pytest.raises(UnknownObject,
                       match="object_name: got 'moon', expected one of bin, box_04"):
        ObjectCatalogue('').find('moon')
    with pytest.raises(UnknownObject, match="object_name: got 'mmm.*100000 char") as refusal:
        ObjectCatalogue('').find(100_000 * 'm')
    assert len(str(refusal.value)) < 300


def test_a_file_is_refused_by_its_key_and_a_folder_by_its_name(tmp_path):
    (tmp_path / 'crate.yaml').write_text('mass: heavy')
    with pytest.raises(ValueError, match="crate.yaml: mass: got 'heavy'"):
        ObjectCatalogue(str(tmp_path)).find('crate')
    with pytest.raises(ValueError, match='object_folder: got .*nowhere'):
        ObjectCatalogue(str(tmp_path / 'nowhere')).check_folder()
