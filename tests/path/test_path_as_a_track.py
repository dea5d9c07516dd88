"""A path with noise, read as the track of a film: the diffusion that drives it comes out again."""

import numpy as np

import microswim as ms


def test_a_noisy_path_read_as_a_track_gives_speed_and_persistence():
    """``1 / (2 D_r)`` of the mobility lies in the interval of the persistence time, in space."""
    cell = ms.Swimmer.preset("goto/C", {"noise": {"temperature": "298 K"}, "motion.free": "all"})
    gait = cell.gait()
    found = ms.path(cell, 150.0, gait=gait, samples=3001, seed=6, step=float(gait.period) / 8.0)
    told = ms.describe_track(ms.Track(time=found.time.values, position=found.position.values))
    M = np.linalg.inv(gait.resistance(0.0))
    turning = cell.noise.energy("SI") * (M[4, 4] + M[5, 5]) / 2.0
    tau, speed = told.numbers["persistence_time"], told.numbers["speed"]
    assert tau.low <= 1.0 / (2.0 * turning) <= tau.high
    assert abs(speed.value / float(ms.screw(gait).speed) - 1.0) < 0.05
