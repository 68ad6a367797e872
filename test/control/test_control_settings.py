"""Settings of the controller refuse what is out of range."""

from push_control.settings import ControlSettings
import pytest


@pytest.mark.parametrize('field, value', [('lateral_gain', -1.0), ('pose_timeout', 0.0),
                                          ('control_law', 'magic'), ('replan_cone_fraction', 1.5),
                                          ('max_reapproaches', 1.5), ('pose_gate', float('nan'))])
def test_settings_out_of_range_are_refused_by_name(field, value):
    """The error names the field."""
    with pytest.raises(ValueError, match=f'ControlSettings.{field}'):
        ControlSettings(**{field: value})
