"""Flow and twist of one step at once, by factors of this step or of a former one.

With K the matrix, x the free unknowns, V the free motions, M their boundary data (rows) and
``u = u_0 + x + M' V`` the flow, the fluid and the swimmer without force are one symmetric system:

    [ K    K M' ] [x]   [  g  ]
    [ M K  M K M'] [V] = [ M g ],       g = f - K u_0

Eliminating x takes one solve with the factors of K, and one flow for each motion, kept. While the
mesh has moved little, the same with former factors is a good first guess, and GMRES does the rest.
"""

from __future__ import annotations

import numpy as np

from microswim.models.fem.stokes import Stokes
from microswim.numerics.gmres import gmres

#: Residual left by GMRES over that of no motion at all, after the former factors.
TOLERANCE = 1e-9
MOST = 24  #: steps of GMRES, as dear as new factors
FEW = 12  #: steps from which on new factors pay


class Former:
    """The factors of a position of the mesh, and the flow of each rigid motion there.

    Parameters
    ----------
    flow
        The discretisation, assembled; it is factorised here.
    modes
        Boundary data of the free motions, shape (k, unknowns).
    """

    def __init__(self, flow: Stokes, modes: np.ndarray) -> None:
        flow.renew_factors()
        self.flow, self.free = flow, np.array(flow.free, dtype=bool)
        flows = np.array([flow.solve(mode) for mode in modes]).reshape(modes.shape)
        pulls = np.array([flow.apply(u) for u in flows]).reshape(modes.shape)
        self._within, self._resistance = flows - modes, modes @ pulls.T

    def solve(self, g: np.ndarray, wrench: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return x and V by these factors: exact where the mesh has not moved since."""
        g = np.where(self.free, g, 0.0)
        V = np.linalg.solve(self._resistance, wrench + self._within @ g)
        return self.flow.by_factors(g) + V @ self._within, V

    def refine(self, g: np.ndarray, modes: np.ndarray) -> tuple[np.ndarray, np.ndarray, int] | None:
        """Return x, V and the steps of GMRES where the mesh is now; None if it takes too many."""
        flow, n = self.flow, len(g)

        def pulled(z: np.ndarray) -> np.ndarray:
            r = flow.apply(z[:n, 0] + z[n:, 0] @ modes)
            return np.concatenate(self.solve(r, modes @ r))[:, None]

        z, steps, left = gmres(pulled, np.concatenate(self.solve(g, modes @ g))[:, None],
                               TOLERANCE, MOST)  # fmt: skip
        return None if left > TOLERANCE else (z[:n, 0], z[n:, 0], steps)
