// The physics that the page does by itself: R(phi) V + F_p(phi) rate = W, and the pose in time.
// Rows of a series: [mean, cos 1, sin 1, cos 2, ...]; 21 columns lower triangle of R, 6 of F_p.

import type { Felt } from "./nearby";
import type { GaitData } from "./types";

export type Vec = [number, number, number];
export type Quat = [number, number, number, number]; // wxyz, body to lab

export interface Pose {
  x: Vec;
  q: Quat;
  phase: number;
  time: number;
}

export function start(): Pose {
  return { x: [0, 0, 0], q: [1, 0, 0, 0], phase: 0, time: 0 };
}

/** Value of all 27 columns of a series at a phase. */
export function evaluate(series: number[][], phase: number, out: Float64Array): Float64Array {
  out.set(series[0]);
  for (let h = 1; h < series.length; h += 2) {
    const n = (h + 1) / 2;
    const c = Math.cos(n * phase);
    const s = Math.sin(n * phase);
    const a = series[h];
    const b = series[h + 1];
    for (let i = 0; i < out.length; i++) out[i] += c * a[i] + s * b[i];
  }
  return out;
}

const at = (i: number, j: number): number => (i >= j ? (i * (i + 1)) / 2 + j : (j * (j + 1)) / 2 + i);
const packed = new Float64Array(27);
const L = new Float64Array(36);

/** Twist of the swimmer, body frame: V = R^-1 (W - F_p rate) on the free directions. */
export function twist(gait: GaitData, phase: number, rate: number, wrench: number[] | null): number[] {
  evaluate(gait.series, phase, packed);
  const free: number[] = [];
  for (let i = 0; i < 6; i++) if (gait.free[i]) free.push(i);
  const n = free.length;
  const y = new Array<number>(n);
  for (let i = 0; i < n; i++) {
    const I = free[i];
    let load = (wrench ? wrench[I] : 0) - packed[21 + I] * rate;
    for (let j = 0; j <= i; j++) {
      let sum = packed[at(I, free[j])];
      for (let k = 0; k < j; k++) sum -= L[6 * i + k] * L[6 * j + k];
      L[6 * i + j] = i === j ? Math.sqrt(sum) : sum / L[6 * j + j];
    }
    for (let k = 0; k < i; k++) load -= L[6 * i + k] * y[k];
    y[i] = load / L[6 * i + i];
  }
  const V = [0, 0, 0, 0, 0, 0];
  for (let i = n - 1; i >= 0; i--) {
    for (let k = i + 1; k < n; k++) y[i] -= L[6 * k + i] * y[k];
    y[i] /= L[6 * i + i];
    V[free[i]] = y[i];
  }
  return V;
}

/** Force and torque by the fluid on the body alone. */
export function bodyWrench(gait: GaitData, phase: number, rate: number, V: number[]): number[] | null {
  if (!gait.body) return null;
  evaluate(gait.body, phase, packed);
  const W = [0, 0, 0, 0, 0, 0];
  for (let i = 0; i < 6; i++) {
    W[i] = -packed[21 + i] * rate;
    for (let j = 0; j < 6; j++) W[i] -= packed[at(i, j)] * V[j];
  }
  return W;
}

export function rotate(q: Quat, v: readonly number[], inverse = false): Vec {
  const [w, a, b, c] = q;
  const s = inverse ? -1 : 1;
  const x = s * a, y = s * b, z = s * c;
  const tx = 2 * (y * v[2] - z * v[1]);
  const ty = 2 * (z * v[0] - x * v[2]);
  const tz = 2 * (x * v[1] - y * v[0]);
  return [
    v[0] + w * tx + y * tz - z * ty,
    v[1] + w * ty + z * tx - x * tz,
    v[2] + w * tz + x * ty - y * tx,
  ];
}

export const cross = (a: readonly number[], b: readonly number[]): Vec => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
];

export const dot = (a: readonly number[], b: readonly number[]): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** What drives the swimmer: its motor, and a field B(t, x) on a magnet in the body. */
export interface Drive {
  rate: number;
  /** moment without a field, and moment per field row by row, body frame */
  magnet: { moment: Vec; softness: number[] | null } | null;
  field: (time: number, x: readonly number[]) => Felt;
  /** whether the field is known at a place, of one that depends on it; null: the same everywhere */
  known: ((time: number, x: readonly number[]) => boolean) | null;
}

/** Moment of the magnet in the body's axes in a field b seen from there. */
export function momentIn(magnet: NonNullable<Drive["magnet"]>, b: readonly number[]): Vec {
  const { moment, softness: C } = magnet;
  return C ? (moment.map((m, i) => m + C[3 * i] * b[0] + C[3 * i + 1] * b[1] + C[3 * i + 2] * b[2]) as Vec) : moment;
}

/** Force J' m and torque m x B of the field, body frame. */
export function load(drive: Drive, x: readonly number[], q: Quat, time: number): number[] | null {
  if (!drive.magnet) return null;
  const { B, J } = drive.field(time, x);
  const b = rotate(q, B, true);
  const m = momentIn(drive.magnet, b);
  const torque = cross(m, b);
  if (!J) return [0, 0, 0, ...torque];
  const p = rotate(q, m);
  return [...rotate(q, [0, 1, 2].map((j) => J[j] * p[0] + J[3 + j] * p[1] + J[6 + j] * p[2]), true), ...torque];
}

function slope(gait: GaitData, drive: Drive, x: readonly number[], q: Quat, phase: number, time: number): [Vec, Quat] {
  const wrench = load(drive, x, q, time);
  const V = twist(gait, phase, drive.rate, wrench);
  const [w, a, b, c] = q;
  const [p, r, s] = [V[3] / 2, V[4] / 2, V[5] / 2];
  const turned: Quat = [
    -a * p - b * r - c * s, w * p + b * s - c * r, w * r + c * p - a * s, w * s + a * r - b * p,
  ];
  return [rotate(q, [V[0], V[1], V[2]]), turned];
}

/** The tail goes on while the swimmer stays where the gait holds. */
export function stay(pose: Pose, rate: number, h: number): void {
  pose.phase += h * rate;
  pose.time += h;
}

/** One step of the classical Runge-Kutta method; the quaternion is normalised. */
export function step(gait: GaitData, drive: Drive, pose: Pose, h: number): void {
  const add = <T extends number[]>(u: T, v: number[], f: number): T => u.map((e, i) => e + f * v[i]) as T;
  const { x, q, phase: p, time: t } = pose;
  const [x1, q1] = slope(gait, drive, x, q, p, t);
  const half = p + (h / 2) * drive.rate;
  const [x2, q2] = slope(gait, drive, add(x, x1, h / 2), add(q, q1, h / 2), half, t + h / 2);
  const [x3, q3] = slope(gait, drive, add(x, x2, h / 2), add(q, q2, h / 2), half, t + h / 2);
  const [x4, q4] = slope(gait, drive, add(x, x3, h), add(q, q3, h), p + h * drive.rate, t + h);
  for (let i = 0; i < 3; i++) x[i] += (h / 6) * (x1[i] + 2 * x2[i] + 2 * x3[i] + x4[i]);
  for (let i = 0; i < 4; i++) q[i] += (h / 6) * (q1[i] + 2 * q2[i] + 2 * q3[i] + q4[i]);
  const size = Math.hypot(...q);
  for (let i = 0; i < 4; i++) q[i] /= size;
  pose.phase = p + h * drive.rate;
  pose.time = t + h;
}

/** Largest rate of turning per torque about an axis of the body. */
export function turnMobility(gait: GaitData): number {
  const about = (i: number): number => twist(gait, 0, 0, [0, 1, 2, 3, 4, 5].map((k) => (k === i ? 1 : 0)))[i];
  return Math.max(about(3), about(4), about(5));
}

/** Rotational mobility about an axis, 0 of s, of the rigid swimmer: rate of turning per torque. */
export function spinMobility(gait: GaitData, axis: 0 | 1 | 2): number {
  const torque = [0, 0, 0, 0, 0, 0];
  torque[3 + axis] = 1;
  return twist(gait, 0, 0, torque)[3 + axis];
}
