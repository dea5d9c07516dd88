"""A robot learns to follow paths from its camera alone.

The best, the median and the worst candidate of each generation, over what a robot earns along
a path: a point for each millimetre, five at its end. CMA-ES looks for the eight numbers of a small
policy: the field's axis is a weighted sum of the five vectors that are seen, so it knows no north,
and the frequency depends on how far the heading is off that axis and on what remains of the path.
All candidates of a generation swim at once in one vector environment, on the same paths. Nothing is
told of helices, fields or step-out.
"""

import cma
import gymnasium
import numpy as np
from matplotlib.figure import Figure

from microswim.control import environments

gymnasium.register_envs(environments)

PATHS, STEPS, POPULATION, NUMBERS = 16, 400, 12, 8


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


def main(generations=20):
    curve, policy = train(generations)
    return {
        "return on new paths before": scored(np.zeros_like(policy)),
        "return on new paths after": scored(policy),
        "curve": curve,
    }


def figure(results):
    fig = Figure(figsize=(6.4, 3.2), layout="constrained")
    axes, curve = fig.subplots(), results["curve"]
    steps = (curve[:, 0] + 1) * POPULATION * PATHS * STEPS / 1e6
    axes.fill_between(steps, curve[:, 3], curve[:, 1], color="#0072B2", alpha=0.3, lw=0)
    axes.plot(steps, curve[:, 2], "o-", ms=4, color="#0072B2", label="median; best to worst")
    axes.axhline(0.0, color="#808080", lw=0.8)
    axes.axhline(15.0, color="#D55E00", lw=0.8, ls="--", label="a path of 10 mm to its end")
    axes.set(xlabel="environment steps (million)", ylabel=f"return in {STEPS} steps")
    axes.legend(frameon=False, fontsize=8, loc="lower right")
    return fig


if __name__ == "__main__":
    results = main(generations=30)
    print({k: v for k, v in results.items() if isinstance(v, float)})
    figure(results).savefig("learn_to_steer.svg")
