"""Values of parameters: which source counts first, and what is refused."""

import pytest
from studies.framework.parameters import check_known, Parameter, read_overrides, resolve, Source

CHOSEN = {'all': {'count': 3, 'shared': 1.0}, '9.2': {'shared': 2.0}}
PARAMETERS = (Parameter('count', '', 'how many'), Parameter('shared', 'm', 'of all'),
              Parameter('given', 'm', 'of the caption', 0.5))


def test_caption_counts_then_the_section_of_the_figure_then_the_shared_one():
    values = resolve('9.1', PARAMETERS, CHOSEN, {})
    assert [(value.value, value.source) for value in values] == [
        (3, Source.CHOSEN), (1.0, Source.CHOSEN), (0.5, Source.CAPTION)]
    assert resolve('9.2', PARAMETERS, CHOSEN, {}).shared == 2.0


def test_an_override_counts_before_all_others():
    values = resolve('9.2', PARAMETERS, CHOSEN, {'given': 0.7, 'elsewhere': 1})
    assert values.given == 0.7
    assert [value.source for value in values] == [Source.CHOSEN, Source.CHOSEN, Source.OVERRIDE]
    with pytest.raises(AttributeError, match='elsewhere'):
        values.elsewhere


@pytest.mark.parametrize('new', ['a', [1.0], True, float('nan'), float('inf'), None])
def test_an_override_of_another_type_is_refused(new):
    with pytest.raises(ValueError, match=r'--set shared: got .*expected a finite number \[m\]'):
        resolve('9.1', PARAMETERS, CHOSEN, {'shared': new})


def test_a_missing_value_is_named():
    with pytest.raises(ValueError, match='got no count for 9.1'):
        resolve('9.1', PARAMETERS, {'all': {}}, {})


def test_overrides_are_read_as_yaml():
    assert read_overrides(['mass=1e-3', 'radii=[0.1, 0.2]']) == {'mass': 1e-3,
                                                                 'radii': [0.1, 0.2]}
    for word in ('mass', 'mass=', '=3', 'a b=3'):
        with pytest.raises(ValueError, match='NAME=VALUE'):
            read_overrides([word])


def test_unknown_overrides_are_named():
    with pytest.raises(ValueError, match='got weight, expected some of count, given, shared'):
        check_known({'weight': 1.0, 'count': 2}, PARAMETERS)
