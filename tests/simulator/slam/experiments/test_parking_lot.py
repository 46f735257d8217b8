from simulator.slam.experiments.parking_lot import run_once


def test_three_robots_share_one_frame() -> None:
    run = run_once(0)
    assert run.merged.alone == ()
    assert run.wrong == 0
    assert max(run.error_m.values()) < 0.2 < max(run.odometry_error_m.values())
    assert run.pole_error_m < 0.2
