// Fields of a spec: names for people, sensible ranges, choices, values with units.

import type { Answer, Tables, Value } from "./types";

export const SIZE: Record<string, number> = {
  nm: 1e-9, um: 1e-6, mm: 1e-3, m: 1, "mPa s": 1e-3, "Pa s": 1, "kg/m^3": 1, Hz: 1, deg: Math.PI / 180,
};

export const LABELS: Record<string, string> = {
  "fluid.viscosity": "Viscosity", "fluid.density": "Density",
  "body.radius": "Radius", "body.semi_axes[0]": "Semi-axis along", "body.semi_axes[1]": "Semi-axis across",
  "body.semi_axes[2]": "Semi-axis across, r", "body.shape": "Shape", "body.drag": "Drag",
  "tail.kind": "Kind", "tail.length": "Length", "tail.length_measure": "Length is", "tail.amplitude": "Amplitude",
  "tail.waves": "Waves", "tail.wavelength": "Wavelength", "tail.radius": "Filament radius",
  "tail.frequency": "Frequency", "tail.ramp": "Ramp", "tail.handedness": "Hand",
  "tail.sections": "Sections", "tail.surface_motion": "Surface motion",
  "coefficients.law": "Law", "coefficients.spin": "Filament spin", "coefficients.normal": "Normal",
  "coefficients.tangential": "Tangential",
  "interaction.translation[0]": "γ along s", "interaction.translation[1]": "γ along q", "interaction.translation[2]": "γ along r",
  "interaction.rotation[0]": "γ about s", "interaction.rotation[1]": "γ about q", "interaction.rotation[2]": "γ about r",
  "interaction.tail[0]": "Tail, tangential", "interaction.tail[1]": "Tail, normal", "interaction.tail[2]": "Tail, spin",
  "wall.distance": "Distance", "wall.tilt": "Tilt", "wall.azimuth": "Side, about s",
  "channel.shape": "Shape", "channel.diameter": "Diameter", "channel.length": "Length", "channel.tilt": "Tilt", "channel.ends": "Ends",
  "channel.position[0]": "Place along", "channel.position[1]": "Place across, q", "channel.position[2]": "Place across, r",
  "motion.free": "Free", "motion.frequency_frame": "Frequency in", "motion.line_element": "Line element",
};

export const CHOICES: Record<string, [string, string][]> = {
  "body.shape": [["sphere", "Sphere"], ["spheroid", "Spheroid"], ["ellipsoid", "Ellipsoid"], ["none", "None"]],
  "body.drag": [["exact", "Exact"], ["slender", "Slender"]],
  "tail.kind": [["helix", "Helix"], ["plane_wave", "Plane wave"]],
  "tail.handedness": [["left", "Left"], ["right", "Right"]],
  "tail.length_measure": [["apparent", "Apparent"], ["arc", "Arc"]],
  "tail.sections": [["perpendicular", "Normal"], ["sheared", "Sheared"]],
  "tail.surface_motion": [["rigid", "Rigid"], ["translating", "Translating"], ["bending", "Bending"]],
  "coefficients.law": [["lighthill", "Lighthill"], ["gray_hancock", "Gray–Hancock"], ["cox", "Cox"], ["constant", "Constant"]],
  "channel.shape": [["cylinder", "Tube"], ["box", "Box"]],
  "channel.ends": [["closed", "Closed"], ["open", "Open"]],
  "motion.frequency_frame": [["body", "Body"], ["lab", "Lab"]],
  "motion.line_element": [["arc", "Arc"], ["apparent", "Apparent"]],
};

export function label(path: string): string {
  return LABELS[path] ?? path.replace(/^[a-z]+\./, "").replace(/_/g, " ");
}

export function read(tables: Tables, path: string): Value | undefined {
  const [part, name, ...index] = path.replace(/\]/g, "").split(/[.[]/);
  let value: Value | undefined = tables[part]?.[name];
  for (const i of index) value = Array.isArray(value) ? value[Number(i)] : undefined;
  return value;
}

export function write(tables: Tables, path: string, value: Value): void {
  const [part, name, ...index] = path.replace(/\]/g, "").split(/[.[]/);
  tables[part] ??= {};
  if (index.length === 0) {
    tables[part][name] = value;
    return;
  }
  let list = tables[part][name] as Value[];
  for (const i of index.slice(0, -1)) list = list[Number(i)] as Value[];
  list[Number(index[index.length - 1])] = value;
}

export interface Quantity {
  n: number;
  unit: string;
}

export function quantity(value: Value | undefined): Quantity | null {
  if (typeof value === "number") return { n: value, unit: "" };
  const match = typeof value === "string" ? /^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s+(.+?)\s*$/i.exec(value) : null;
  return match ? { n: Number(match[1]), unit: match[2] } : null;
}

export function spoken(n: number, unit: string): Value {
  return unit ? `${n} ${unit}` : n;
}

/** The number of a field in SI, or bare. */
export function si(tables: Tables, path: string): number | null {
  const q = quantity(read(tables, path));
  return q && q.n * (SIZE[q.unit] ?? 1);
}

/** Dotted names of all numbers of a spec. */
export function numbers(tables: Tables): string[] {
  const found: string[] = [];
  const visit = (path: string, value: Value): void => {
    if (Array.isArray(value)) value.forEach((v, i) => visit(`${path}[${i}]`, v));
    else if (quantity(value)) found.push(path);
  };
  for (const [part, table] of Object.entries(tables)) {
    for (const [name, value] of Object.entries(table)) visit(`${part}.${name}`, value);
  }
  return found;
}

export interface Range {
  low: number;
  high: number;
  log: boolean;
}

const nice = (x: number): number => {
  const ten = 10 ** Math.floor(Math.log10(x));
  return ten * (x / ten <= 1 ? 1 : x / ten <= 2 ? 2 : x / ten <= 5 ? 5 : 10);
};

/** Where a slider runs, in the unit of the value. */
export function sensible(path: string, q: Quantity, answer: Answer): Range {
  const linear = (low: number, high: number): Range => ({
    low: Math.min(low, q.n), high: Math.max(high, q.n), log: false,
  });
  const unit = SIZE[q.unit] ?? 1;
  const { shape } = answer;
  const size = (2 * Math.max(...shape.semi_axes) || shape.length / 2) / unit;
  if (path.startsWith("body.")) return linear(nice(size) / 20, nice(1.5 * size));
  if (path.startsWith("interaction.coupling")) return linear(-1, 1);
  if (path.startsWith("interaction.tail")) return linear(0.2, 3);
  if (path.startsWith("interaction.")) return linear(0.2, 6);
  if (path.startsWith("channel.position")) return linear(-nice(size), nice(size));
  switch (path) {
    case "tail.length": return linear(nice(q.n) / 10, nice(2.5 * q.n));
    case "tail.amplitude": return linear(0, nice(Math.max(1.6 * q.n, (0.06 * shape.length) / unit)));
    case "tail.waves": return linear(0.5, 8);
    case "tail.wavelength": return linear(nice(q.n / 4), nice(3 * q.n));
    case "tail.radius": return linear(nice(q.n / 5), nice(2.5 * q.n));
    case "tail.frequency": return linear(q.n < 0 ? -nice(-2 * q.n) : 0, nice(2 * Math.abs(q.n || 1)));
    case "tail.ramp": return linear(0, 1);
    case "wall.distance": return linear(nice(size / 2), nice(4 * size));
    case "wall.tilt": case "channel.tilt": return linear(-45, 45);
    case "wall.azimuth": return linear(-180, 180);
    case "channel.diameter": return linear(nice(size), nice(8 * size));
    case "channel.length": return linear(nice(size), nice((4 * (shape.length + 2 * shape.semi_axes[0])) / unit));
    case "fluid.viscosity": return { low: nice(q.n / 20), high: nice(20 * q.n), log: true };
    case "fluid.density": return linear(0, nice(Math.max(2 * q.n, 1)));
  }
  return linear(Math.min(0, 2 * q.n), Math.max(nice(2.5 * Math.abs(q.n) || 1), 1e-12));
}
