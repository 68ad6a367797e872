"""The catalogue lists every study once, in the order of the thesis."""

from helpers.study_outcomes import chosen_values, outcome_of, values_of
import pytest
from studies import catalogue
from studies.framework.study import Study
from studies.maps import object_map, stable_regions


def test_studies_are_in_the_order_of_the_thesis_and_those_beyond_it_follow():
    figures = [study.figure for study in catalogue.studies()]
    assert len(set(figures)) == len(figures)
    beyond = [study.figure for study in catalogue.select(['primitives'])]
    assert beyond == [f'P.{number}' for number in range(1, len(beyond) + 1)]
    assert figures[-len(beyond):] == beyond
    assert [study.figure for study in catalogue.select(['beyond'])] == [
        'rolling-plan', 'four-goals', 'disturbed-objects', 'side-push-experiment']
    # The tables of a chapter come after its figures.
    thesis = [study.figure for study in catalogue.select(['chapter2', 'chapter3', 'chapter4'])]
    assert figures[:len(thesis)] == thesis
    assert thesis == sorted(thesis, key=lambda text: (
        int(text.lstrip('T').split('.')[0]), text[0] == 'T', int(text.split('.')[1])))


def test_studies_are_selected_by_number_chapter_or_all_of_them():
    assert [study.figure for study in catalogue.select(['2.13', '2.11'])] == ['2.11', '2.13']
    assert {study.chapter for study in catalogue.select(['chapter4'])} == {'chapter4'}
    assert catalogue.select(['all']) == catalogue.studies()
    with pytest.raises(ValueError, match='2.99.*expected all, chapter2'):
        catalogue.select(['2.99'])


def test_titles_and_captions_change_with_the_values():
    by_figure = {study.figure: study for study in catalogue.select(['2.11', '2.15', '2.16'])}
    for figure, overrides, words in (
            ('2.15', {}, 'at 0.5 m/s'), ('2.15', {'speed': 2.0}, 'at 2 m/s'),
            ('2.11', {}, ': stable'), ('2.11', {'ahead': 0.7}, ': unstable')):
        study = by_figure[figure]
        assert words in study.title_of(study.values(chosen_values(), overrides))
    for figure, overrides, words in (
            ('2.11', {}, 'nearer to the contact'), ('2.11', {'ahead': 0.7}, 'further away'),
            ('2.16', {}, 'overshoots'), ('2.16', {'speed': 0.3}, 'without overshoot')):
        study = by_figure[figure]
        assert words in study.caption(outcome_of(study, **overrides).findings)


def test_every_value_of_the_table_is_used():
    """Nothing in studies/values.yaml is for a figure or a parameter that does not exist."""
    known = {study.figure: {parameter.name for parameter in study.parameters
                            if parameter.captioned is None} for study in catalogue.studies()}
    known[object_map.NAME] = {parameter.name for parameter in stable_regions.PARAMETERS}
    for figure, section in chosen_values().items():
        names = set().union(*known.values()) if figure == 'all' else known[figure]
        assert set(section) <= names, figure


@pytest.mark.parametrize('study', catalogue.studies(), ids=lambda study: study.figure)
def test_every_parameter_of_a_study_has_a_value(study: Study) -> None:
    assert [value.parameter for value in values_of(study)] == list(study.parameters)
