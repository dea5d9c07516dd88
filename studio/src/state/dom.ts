// Small helpers for elements and numbers.

import { called, words } from "./words";

type Child = Node | string | null | undefined;

export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  props: Record<string, unknown> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === false) continue;
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value as EventListener);
    else if (key === "class") node.className = String(value);
    else if (key === "value") (node as HTMLInputElement).value = String(value);
    else node.setAttribute(key, value === true ? "" : String(value));
  }
  node.append(...children.filter((c): c is Node | string => c !== null && c !== undefined));
  return node;
}

const PREFIX: [number, string][] = [
  [1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"],
  [1e-9, "n"], [1e-12, "p"], [1e-15, "f"], [1e-18, "a"], [1e-21, "z"], [1e-24, "y"],
];

export function digits(value: number, n = 3): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-4) {
    const [m, e] = value.toExponential(n - 1).split("e");
    return `${minus(m)} × 10${superscript(Number(e))}`;
  }
  const places = Math.max(0, n - 1 - Math.floor(Math.log10(size)));
  return minus(value.toFixed(Math.min(places, 8)));
}

const minus = (text: string): string => text.replace("-", "−");
const superscript = (n: number): string =>
  [...String(n)].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)] ?? "⁻").join("");

/** Number and unit apart: in a unit that people read, else with an SI prefix. */
export function withPrefix(value: number, unit: string, n = 3): [string, string] {
  if (value === 0) return ["0", ""];
  const read = words().read_in[unit];
  if (read) {
    const [name, scale] = read.find(([, , least]) => Math.abs(value) >= 0.9995 * least) ?? read[read.length - 1];
    return [digits(value / scale, n), name];
  }
  const [size, prefix] = PREFIX.find(([s]) => Math.abs(value) >= 0.9995 * s) ?? PREFIX[PREFIX.length - 1];
  return [digits(value / size, n), prefix + unit];
}

export function reading(name: string, value: number | null | undefined, dimensional: boolean, n = 3): [string, string] {
  if (value === null || value === undefined) return ["–", ""];
  if (name === "efficiency") return [digits(100 * value, n), "%"];
  if (name === "body_lengths_per_time") return [digits(value, n), dimensional ? "/s" : ""];
  return dimensional ? withPrefix(value, called(name).unit, n) : [digits(value, n), ""];
}

export function pretty(unit: string): string {
  return unit.replace("um", "µm").replace("deg", "°").replace(/\^(-?\d+)/g, (_, n) => superscript(Number(n)));
}

export const clone = <T>(value: T): T => structuredClone(value);
