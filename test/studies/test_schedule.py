"""Whole studies run in several processes give what they give one after the other."""

from studies import __main__ as cli, catalogue, schedule


def test_every_study_is_in_one_job_and_long_jobs_begin_first():
    jobs = schedule.study_jobs(catalogue.studies())
    figures = [figure for job in jobs for figure in job.figures]
    assert sorted(figures) == sorted(study.figure for study in catalogue.studies())
    times = [job.time for job in jobs]
    assert times == sorted(times, reverse=True)
    listed = [figure for job in schedule.LONG_JOBS for figure in job.figures]
    assert len(listed) == len(set(listed)) and set(listed) <= set(figures)


def test_processes_write_the_same_files(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(schedule, 'MIN_TIME', 0.0)
    outputs = []
    for name, count in (('one', '1'), ('two', '2')):
        folder = tmp_path / name
        assert cli.main(['run', '2.11', '2.12', '2.16', '--set', 'robot_radius=0.6', '--out',
                         str(folder), '--jobs', count]) == 0
        outputs.append(capsys.readouterr().out.replace(str(folder), ''))
    assert outputs[0] == outputs[1] and 'up to date' not in outputs[1]
    for path in (tmp_path / 'one').iterdir():
        assert path.read_bytes() == (tmp_path / 'two' / path.name).read_bytes(), path.name


def test_studies_that_fail_are_left_to_the_caller(tmp_path, monkeypatch):
    """One that fails does not keep the others from being run."""
    monkeypatch.setattr(schedule, 'MIN_TIME', 0.0)
    counts = []
    schedule.run_in_processes(catalogue.select(['2.11', '2.12']), tmp_path,
                              {'robot_radius': -1.0}, 2, counts.append)
    assert not any(tmp_path.iterdir()) and counts[-1] == 2
