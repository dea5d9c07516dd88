// Values of a spec by dotted name: names for people, numbers with units, where sliders run.

import { field, plain, size } from "./words";
import type { Answer, Tables, Value } from "./types";

export function label(named: string): string {
  const path = plain(named);
  const known = field(path);
  const entry = /^[^[]+\[(\d+)\]$/.exec(path);
  const name = entry ? known?.entries[Number(entry[1])] : path.includes("[") ? undefined : known?.label;
  return name ?? path.replace(/^[a-z]+\./, "").replace(/_/g, " ");
}

/** The table that a path lies in, its name there and places in a list; of several tables of a name each has a number. */
function parts(tables: Tables, path: string): [Record<string, Value> | undefined, string, string[]] {
  const [, part, number, name, index] = /^(\w*)(?:\[(\d+)\])?\.([^[]+)(.*)$/.exec(path)!;
  const tableOrTables: unknown = tables[part];
  const table = number === undefined ? tableOrTables : (tableOrTables as unknown[] | undefined)?.[Number(number)];
  return [table as Record<string, Value> | undefined, name, index.replace(/\]/g, "").split("[").slice(1)];
}

/** Names of the tables of a part: itself, or each of several by its number. */
export function several(tables: Tables, part: string): string[] {
  const found: unknown = tables[part];
  if (found === undefined) return [];
  return Array.isArray(found) ? found.map((_, i) => `${part}[${i}]`) : [part];
}

export const tableOf = (tables: Tables, part: string): Record<string, Value> => parts(tables, `${part}.x`)[0] ?? {};

export function read(tables: Tables, path: string): Value | undefined {
  const [table, name, index] = parts(tables, path);
  let value: Value | undefined = table?.[name];
  for (const i of index) value = Array.isArray(value) ? value[Number(i)] : undefined;
  return value;
}

export function write(tables: Tables, path: string, value: Value): void {
  if (!path.split(".")[0].includes("[")) tables[path.split(".")[0]] ??= {};
  const [table, name, index] = parts(tables, path);
  if (index.length === 0) {
    table![name] = value;
    return;
  }
  let list = table![name] as Value[];
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
  return q && q.n * size(q.unit);
}

/** Dotted names of all numbers of a spec. */
export function numbers(tables: Tables): string[] {
  const found: string[] = [];
  const visit = (path: string, value: Value): void => {
    if (Array.isArray(value)) value.forEach((v, i) => visit(`${path}[${i}]`, v));
    else if (quantity(value)) found.push(path);
  };
  for (const part of Object.keys(tables).flatMap((p) => several(tables, p))) {
    for (const [name, value] of Object.entries(tableOf(tables, part))) visit(`${part}.${name}`, value);
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
  const usual = field(path)?.usual;
  if (usual) return linear(...usual);
  const unit = size(q.unit);
  const { shape } = answer;
  const wide = (2 * Math.max(...shape.semi_axes) || shape.length / 2) / unit;
  if (path.startsWith("body.")) return linear(nice(wide) / 20, nice(1.5 * wide));
  if (path.startsWith("channel.position")) return linear(-nice(wide), nice(wide));
  switch (plain(path)) {
    case "tail.length": return linear(nice(q.n) / 10, nice(2.5 * q.n));
    case "tail.amplitude": return linear(0, nice(Math.max(1.6 * q.n, (0.06 * shape.length) / unit)));
    case "tail.wavelength": return linear(nice(q.n / 4), nice(3 * q.n));
    case "tail.radius": return linear(nice(q.n / 5), nice(2.5 * q.n));
    case "tail.bending": return linear(nice(q.n / 20), nice(4 * q.n));
    case "tail.frequency": return linear(q.n < 0 ? -nice(-2 * q.n) : 0, nice(2 * Math.abs(q.n || 1)));
    case "wall.distance": return linear(nice(wide / 2), nice(4 * wide));
    case "channel.diameter": return linear(nice(wide), nice(8 * wide));
    case "channel.length": return linear(nice(wide), nice((4 * (shape.length + 2 * shape.semi_axes[0])) / unit));
    case "fluid.viscosity": return { low: nice(q.n / 20), high: nice(20 * q.n), log: true };
    case "fluid.density": return linear(0, nice(Math.max(2 * q.n, 1)));
  }
  return linear(Math.min(0, 2 * q.n), nice(2.5 * Math.abs(q.n) || 1));
}
