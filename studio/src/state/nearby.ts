// The field about a place as the server tells it, src/microswim/studio/nearby_field.py:
// B(t, x) = sum a_n(t) T_i(u) T_j(v) T_k(w) B_nijk, (u, v, w) = (x - centre) / half.

import type { Vec } from "./motion";

export interface Nearby {
  kind: "wave" | "samples";
  /** rad per time */
  rate: number;
  from: number;
  /** how long from there on; null: always */
  span: number | null;
  centre: Vec;
  /** half of the box; null: the same everywhere */
  half: number | null;
  nodes: number;
  values: number[];
}

export interface Felt {
  B: Vec;
  /** dB_i/dx_j row by row; null where B is the same everywhere */
  J: number[] | null;
}

/** Whether a place and a time are in the box and the while, or in the first share of them. */
export function holds(near: Nearby, time: number, x: readonly number[], share = 1): boolean {
  const { half, span, from, centre } = near;
  if (span !== null && (time < from || time > from + share * span)) return false;
  return half === null || x.every((c, i) => Math.abs(c - centre[i]) <= share * half);
}

/** Chebyshev polynomials and their slopes at u. */
function polynomials(u: number, n: number): [number[], number[]] {
  const T = [1, u], D = [0, 1];
  for (let k = 2; k < n; k++) {
    T.push(2 * u * T[k - 1] - T[k - 2]);
    D.push(2 * T[k - 1] + 2 * u * D[k - 1] - D[k - 2]);
  }
  return [T, D];
}

/** What the parts in time count at a time: [part, weight]. */
function weights(near: Nearby, time: number, parts: number): [number, number][] {
  if (near.kind === "wave") {
    const a = near.rate * time;
    const all: [number, number][] = [[0, 1], [1, Math.cos(a)], [2, Math.sin(a)]];
    return all.slice(0, parts);
  }
  const s = Math.min(1, Math.max(0, (time - near.from) / near.span!)) * (parts - 1);
  const i = Math.min(parts - 2, Math.floor(s));
  return [[i, i + 1 - s], [i + 1, s - i]];
}

export function fieldAt(near: Nearby, time: number, x: readonly number[]): Felt {
  const { nodes: n, half, values, centre } = near;
  const block = 3 * n ** 3;
  const shares = weights(near, time, values.length / block);
  const B: Vec = [0, 0, 0];
  if (half === null) {
    for (const [p, a] of shares) for (let c = 0; c < 3; c++) B[c] += a * values[p * block + c];
    return { B, J: null };
  }
  const [X, Y, Z] = centre.map((m, i) => polynomials((x[i] - m) / half, n));
  const J = new Array<number>(9).fill(0);
  for (let i = 0, at = 0; i < n; i++) {
    for (let j = 0; j < n; j++) {
      for (let k = 0; k < n; k++) {
        const whole = X[0][i] * Y[0][j] * Z[0][k];
        const dx = X[1][i] * Y[0][j] * Z[0][k], dy = X[0][i] * Y[1][j] * Z[0][k], dz = X[0][i] * Y[0][j] * Z[1][k];
        for (let c = 0; c < 3; c++, at++) {
          let b = 0;
          for (const [p, a] of shares) b += a * values[p * block + at];
          B[c] += whole * b;
          J[3 * c] += (dx * b) / half;
          J[3 * c + 1] += (dy * b) / half;
          J[3 * c + 2] += (dz * b) / half;
        }
      }
    }
  }
  return { B, J };
}
