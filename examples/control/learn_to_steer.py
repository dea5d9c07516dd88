"""A robot learns to follow paths from its camera alone, by evolution of a small policy.

    python examples/control/learn_to_steer.py              # docs/learning.png

The policy has eight numbers: the field's axis is a weighted sum of the five vectors that are seen,
so it knows no north, and the frequency depends on how far the heading is off that axis and on what
remains of the path. CMA-ES (package cma, extra ``learn``) finds them. All candidates of a
generation swim at once in one vector environment, all on the same paths. Nothing is told of
helices, fields or step-out.
"""

import sys
from pathlib import Path

import cma
import gymnasium
import numpy as np

from microswim.control import environments

gymnasium.register_envs(environments)

PATHS, STEPS, POPULATION, NUMBERS = 32, 400, 12, 8


def acted(policies, seen):
    """Actions (n, paths, 4) of the policies (n, 8) on what is seen (n, paths, 17)."""
    w = policies[:, :, None, None]
    vectors = [seen[..., 3 * j : 3 * j + 3] for j in range(5)]
    aim = sum(w[:, j] * v for j, v in enumerate(vectors))
    aim = aim / (np.linalg.norm(aim, axis=-1, keepdims=True) + 1e-9)
    off = np.sum(aim * vectors[3], axis=-1, keepdims=True)
    frequency = np.tanh(w[:, 5] + w[:, 6] * off + w[:, 7] * seen[..., 16:])
    return np.concatenate([aim, frequency], axis=-1)


def returns(envs, policies, seed):
    """Mean return over the paths of each policy, shape (len(policies),)."""
    n = len(policies)
    seen, _ = envs.reset(seed=[seed + i % PATHS for i in range(n * PATHS)])
    policies = np.asarray(policies)
    total, running = np.zeros(n * PATHS), np.ones(n * PATHS, bool)
    for _ in range(STEPS):
        actions = acted(policies, seen.reshape(n, PATHS, -1))
        seen, rewards, over, cut, _ = envs.step(actions.reshape(n * PATHS, 4))
        total += running * rewards
        running &= ~(over | cut)
    return total.reshape(n, PATHS).mean(axis=1)


def train(generations, seed=1):
    """Learning curve: generation, best, median and worst return; and the mean policy found."""
    envs = gymnasium.make_vec("microswim/Steer-v0", num_envs=POPULATION * PATHS)
    options = {"popsize": POPULATION, "seed": seed, "verbose": -9}
    search = cma.CMAEvolutionStrategy(np.zeros(NUMBERS), 0.5, options)
    curve = []
    for generation in range(generations):
        policies = search.ask()
        scores = returns(envs, policies, seed=1000 * (generation % 8))
        search.tell(policies, -scores)
        curve.append((generation, scores.max(), np.median(scores), scores.min()))
    return np.array(curve), search.result.xfavorite


def scored(policy, seed=900_000):
    """Mean return of a policy on paths that training has not seen."""
    envs = gymnasium.make_vec("microswim/Steer-v0", num_envs=PATHS)
    return float(returns(envs, [policy], seed)[0])


def plot(curve, path):
    """The learning curve as a picture."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    ax = figure.add_subplot()
    steps = (curve[:, 0] + 1) * POPULATION * PATHS * STEPS / 1e6
    ax.fill_between(steps, curve[:, 3], curve[:, 1], alpha=0.25, label="worst to best candidate")
    ax.plot(steps, curve[:, 2], label="median candidate")
    ax.axhline(0.0, color="0.6", linewidth=0.8)
    ax.set(xlabel="environment steps (million)", ylabel=f"return in {STEPS} steps")
    ax.set_title("CMA-ES learns to steer a magnetised helix along paths in space", fontsize=10)
    ax.legend(loc="lower right")
    figure.savefig(path, dpi=150)


def main(generations=30, picture=None):
    """Returns before and after learning, on paths that training has not seen."""
    curve, policy = train(generations)
    before, after = scored(np.zeros_like(policy)), scored(policy)
    print(f"return on new paths: {before:.2f} before, {after:.2f} after {generations} generations")
    if picture is not None:
        plot(curve, picture)
        print(f"learning curve: {picture}")
    return {"before": before, "after": after, "curve": curve}


if __name__ == "__main__":
    docs = Path(__file__).parents[2] / "docs"
    main(picture=sys.argv[1] if len(sys.argv) > 1 else docs / "learning.png")
