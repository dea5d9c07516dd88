"""At how many phases plane waves of a batch are asked."""

from __future__ import annotations

import numpy as np
import pytest

from microswim.models.rft.batch_numbers import blank
from microswim.models.rft.batch_of_waves import of_waves


def asked_of(answers, bk):
    """Phases at which each design was asked, and the results; ``answers[i](phase)`` is its u_s."""
    asked, out = [[] for _ in answers], blank(len(answers))

    def solved(rows, phase):
        V = np.zeros((len(rows), phase.size, 6))
        for k, i in enumerate(rows):
            asked[i].append(phase.size)
            V[k, :, 0] = answers[i](phase)
        return V, np.ones(V.shape[:2])

    n = len(answers)
    of_waves(out, solved, np.full(n, bk), np.full(n, True), np.ones((n, 6)), np.ones(n), 0.0)
    return asked, out


def test_more_phases_are_asked_of_what_is_not_resolved_and_none_of_what_has_no_answer():
    """A design outside an atlas stays NaN however many phases it is asked at."""

    def narrow(phase):
        return 1.0 / (1.05 + np.cos(2.0 * phase))  # mean 1 / sqrt(1.05^2 - 1), a closed form

    asked, out = asked_of([np.ones_like, lambda phase: np.nan * phase, narrow], 0.1)
    assert len(asked[0]) == len(asked[1]) == 1
    assert len(asked[2]) > 1
    assert np.isnan(out["mean_velocity"][1]).all()
    assert out["mean_velocity"][2, 0] == pytest.approx(1.0 / np.sqrt(1.05**2 - 1.0), rel=1e-9)
