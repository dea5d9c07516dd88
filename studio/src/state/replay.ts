// A path that the server followed: where each swimmer is at a time, and the clock that runs along it.

import type { PathAnswer, Rows } from "./types";
import type { Pose } from "./motion";

/** Times of the path that the whole of it takes to watch, at the usual pace. */
export class Replay {
  /** along the path, in its own time */
  time = 0;

  constructor(readonly made: PathAnswer) {}

  get end(): number {
    return this.made.time[this.made.time.length - 1];
  }

  /** Go on by a time; at its end the path begins again. Whether it did. */
  advance(time: number): boolean {
    this.time += time;
    if (this.time < this.end) return false;
    this.time = 0;
    return true;
  }

  /** Row before the time, and the share of the way to the next. */
  private get place(): [number, number] {
    const { time } = this.made;
    const f = Math.min(1, this.time / this.end) * (time.length - 1);
    const i = Math.min(time.length - 2, Math.floor(f));
    return [i, f - i];
  }

  /** Rows that lie behind. */
  get behind(): number {
    return this.place[0] + 1;
  }

  /** Put a swimmer where the path has it now. */
  put(rows: Rows, pose: Pose): void {
    const [i, f] = this.place;
    const between = (v: number[], n: number, k: number): number => v[n * i + k] + f * (v[n * (i + 1) + k] - v[n * i + k]);
    for (let k = 0; k < 3; k++) pose.x[k] = between(rows.x, 3, k);
    const side = [0, 1, 2, 3].reduce((sum, k) => sum + rows.q[4 * i + k] * rows.q[4 * (i + 1) + k], 0) < 0 ? -1 : 1;
    for (let k = 0; k < 4; k++) pose.q[k] = (1 - f) * rows.q[4 * i + k] + f * side * rows.q[4 * (i + 1) + k];
    const size = Math.hypot(...pose.q);
    for (let k = 0; k < 4; k++) pose.q[k] /= size;
    pose.phase = between(rows.phase, 1, 0);
    pose.time = this.time;
  }
}

/** Middle of all places, and how far from it the farthest lies. */
export function extent(made: PathAnswer): { middle: [number, number, number]; reach: number } {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const { x } of made.swimmers) {
    x.forEach((v, i) => {
      low[i % 3] = Math.min(low[i % 3], v);
      high[i % 3] = Math.max(high[i % 3], v);
    });
  }
  const middle = low.map((v, k) => 0.5 * (v + high[k])) as [number, number, number];
  return { middle, reach: 0.5 * Math.hypot(...low.map((v, k) => high[k] - v)) };
}
