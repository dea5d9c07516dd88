// Colours and ticks of the map.

import { digits } from "../state/dom";
import { words } from "../state/words";

/** Round numbers along the lower or the left edge of a picture whose axis runs from low to high. */
export function ticks(g: CanvasRenderingContext2D, edge: "x" | "y", low: number, high: number): void {
  const { width: w, height: h } = g.canvas;
  g.save();
  g.font = "19px 'Inter Variable', sans-serif";
  g.fillStyle = g.strokeStyle = "#fff";
  g.shadowColor = "rgba(0, 0, 0, 0.9)";
  g.shadowBlur = 5;
  g.lineWidth = 2;
  g.textAlign = edge === "x" ? "center" : "left";
  g.textBaseline = edge === "x" ? "bottom" : "middle";
  for (const value of round(low, high, edge === "x" ? 5 : 4)) {
    const f = (value - low) / (high - low);
    if (f < 0.06 || f > 0.94) continue;
    const [x, y] = edge === "x" ? [f * w, h] : [0, (1 - f) * h];
    g.beginPath();
    g.moveTo(x, y);
    g.lineTo(edge === "x" ? x : 9, edge === "x" ? h - 9 : y);
    g.stroke();
    g.fillText(digits(value, 2).replace(/\.0+$/, ""), edge === "x" ? x : 14, edge === "x" ? h - 12 : y);
  }
  g.restore();
}

/** Multiples of 1, 2 or 5 times a power of ten between two numbers, about `count` of them. */
function round(low: number, high: number, count: number): number[] {
  const ten = 10 ** Math.floor(Math.log10((high - low) / count));
  const step = [1, 2, 5, 10].map((m) => m * ten).find((s) => (high - low) / s <= count) ?? 10 * ten;
  const first = Math.ceil(low / step);
  return Array.from({ length: Math.max(0, Math.floor(high / step) - first + 1) }, (_, i) => (first + i) * step);
}

/** Colour of a share of the range: red, green, blue. */
export function colour(f: number): [number, number, number] {
  stops ??= words().palette.map.map((hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16)));
  const x = Math.min(1, Math.max(0, f)) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(x));
  return [0, 1, 2].map((k) => stops![i][k] + (x - i) * (stops![i + 1][k] - stops![i][k])) as [number, number, number];
}

let stops: number[][] | null = null;

/** The range as a gradient from left to right. */
export const gradient = (): string => `linear-gradient(90deg, ${words().palette.map.join(", ")})`;
