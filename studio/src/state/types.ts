// What travels between server and page; see src/microswim/studio/answers.py.

import type { Nearby } from "./nearby";
import type { Words } from "./words";

export type Value = string | number | boolean | Value[];
export type Tables = Record<string, Record<string, Value>>;

/** What the scene draws; src/microswim/studio/drawing.py says how. */
export interface Shape {
  semi_axes: [number, number, number];
  body: string;
  /** corners of a body that is no ellipsoid, and faces of four of them */
  mesh: { points: number[]; faces: number[] } | null;
  kind: string;
  /** whether the phase turns the tail as a whole */
  rigid: boolean;
  length: number;
  /** farthest that a tail comes from the axis */
  reach: number;
  ramp: number;
  radius: number;
  sign: number;
  tails: Filament[];
}

/** One tail in its own axes, and where those stand. */
export interface Filament {
  kind: string;
  rigid: boolean;
  /** of its phase before that of the motor */
  ahead: number;
  root: [number, number, number];
  /** row by row, its own axes to the body's */
  rotation: number[];
  length: number;
  amplitude: number;
  amplitude_end: number;
  wavenumber: number;
  ramp: number;
  radius: number;
  /** radius at the tip over that at the root */
  narrowing: number;
  /** half axes of a cross-section that is not round */
  section: [number, number] | null;
  sign: number;
  sheared: boolean;
  /** centreline of a tail that is no wave: rows of a series in the phase, of s, q, r at each point */
  line: number[][] | null;
}

/** Wall or channel, from the body's centre in its axes at the start. */
export interface Around {
  kind: "wall" | "cylinder" | "box";
  distance?: number;
  normal?: [number, number, number];
  diameter?: number;
  length?: number;
  middle?: [number, number, number];
  tilt?: number;
  azimuth?: number;
  open?: boolean;
}

export interface Magnet {
  /** in the body, without a field; and moment per field row by row, of a soft magnet */
  moment: [number, number, number] | null;
  softness: number[] | null;
  /** strength and turns per time of a rotating field */
  field: number | null;
  frequency: number | null;
  /** axis of the body frame along which the robot is long */
  long: 0 | 1 | 2;
  /** times by which a rate of turning gives the Reynolds number, about the long axis and across it; and the largest that the models hold for */
  inertia: { across: number; along: number; most: number };
  /** the field about the start, where it is more than one that turns a hard magnet */
  own: Nearby | null;
  /** quantities of a robot in its rotating field, which a map can show; none where nothing turns it */
  driven: string[];
}

export interface GaitData {
  model: string;
  rate: number;
  free: boolean[];
  /** what would turn with the swimmer along a path: "wall", "channel" or nothing */
  one_pose: string;
  series: number[][];
  body: number[][] | null;
}

export type Readings = Record<string, number | null>;

export interface Answer {
  units: Record<string, string>;
  dimensional: boolean;
  shape: Shape;
  around: Around | null;
  magnet: Magnet;
  gait: GaitData;
  readings: Readings;
  /** which end goes first over a period; empty: neither */
  leading_end: "body" | "tail" | "";
  /** of u_s, relative; null: not known; and how it is known */
  expected_error: number | null;
  /** the same of readings that are as far off as a velocity */
  errors: Record<string, number | null>;
  how: string;
  /** where the coefficients come from, whether this is the design they were found at, and what they miss there */
  /** whether the atlas would answer, had the spec chosen no law and no coefficients */
  atlas_knows: boolean;
  calibration: { here: boolean; lines: string[]; missed: Record<string, number> } | null;
  /** whether the spec holds a region calibration */
  region: boolean;
  tables: Tables;
  toml: string;
  /** what is odd about the swimmer or its answer, in physical words; and warnings of the solve */
  remarks: string[];
  notes: string[];
  milliseconds: number;
}

export interface Axis {
  field: string;
  from: number;
  to: number;
  count: number;
}

export interface MapAsk {
  x: Axis;
  y: Axis;
  output: string;
}

export interface MapAnswer {
  x: number[];
  y: number[];
  values: Record<string, (number | null)[]>;
  /** where the surrogate was calibrated; null: everywhere along this side */
  inside: { x: [number, number] | null; y: [number, number] | null } | null;
  milliseconds: number;
}

export interface Row {
  name: string;
  surrogate: number;
  reference: number;
  error: number | null;
}

export interface JudgeAnswer {
  answer: Answer;
  rows: Row[];
  unknowns: number;
  phases: number;
  level: string;
  /** along the wall, while the pose is kept; from the body's centre in its axes */
  circle: Circle | null;
  calibration: {
    error?: string;
    tables: Tables;
    coefficients: Record<string, number>;
    rows: Row[];
    warnings: string[];
  };
}

export interface Circle {
  radius: number;
  centre: [number, number, number];
  normal: [number, number, number];
  sense: string;
  /** velocity towards the wall */
  towards: number;
}

/** Places of a swimmer one after the other: three, four (wxyz) and one number each. */
export interface Rows {
  x: number[];
  q: number[];
  phase: number[];
}

/** Where swimmers went, in the axes of the first one at the start. */
export interface PathAnswer {
  time: number[];
  swimmers: Rows[];
  numbers: Record<string, number | string | number[] | null>;
  /** of velocities, by name */
  expected_error: Record<string, number>;
}

/** Two swimmers in one fluid. */
export interface Scene {
  designs: { name: string; answer: Answer }[];
  places: Place[];
}

/** Where a swimmer is put, in the axes of the first about its body's centre. */
export interface Place {
  position: [number, number, number];
  direction: [number, number, number];
  roll: number;
  phase: number;
}

export interface FlowAnswer {
  s: [number, number];
  q: [number, number];
  shape: [number, number];
  /** in the phase; a single term is the flow of one moment */
  series: number[][];
  scale: number;
  /** where the plane of a slice through two swimmers lies in the scene (its x, y, z to s, q and the normal) */
  frame?: { origin: [number, number, number]; quaternion: [number, number, number, number] };
}

export interface Snapshot {
  designs: { name: string; answer: Answer }[];
  view: Record<string, unknown>;
  words: Words;
  map?: { ask: MapAsk } & MapAnswer;
}

/** What a new page shows first. */
export interface Start {
  name: string;
  answer: Answer;
  words: Words;
}
