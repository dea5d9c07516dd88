// Tracks of filmed cells: where they went, to scale, and what each holds with its 95 % interval.

import { digits, el, withPrefix } from "../state/dom";
import { card } from "./drop";

interface Cell {
  name: string;
  x: number[];
  y: number[];
  duration: number;
  /** value and ends of its 95 % interval, of what the track holds */
  numbers: Record<string, [number, number, number] | null>;
}

export interface TracksAnswer {
  kind: "tracks";
  cells: Cell[];
  notes: string[];
}

const COLUMNS: [string, string, string, string][] = [
  ["speed", "Speed", "m/s", "along its path, the wobble taken away"],
  ["curvilinear_velocity", "VCL", "m/s", "along the track, frame by frame"],
  ["straight_line_velocity", "VSL", "m/s", "from the first to the last position"],
  ["linearity", "LIN", "", "straight-line over curvilinear velocity"],
  ["turning_rate", "Turning", "rad/s", "of the direction of the path"],
];
const HUES = 7;

export class Tracks {
  private canvas = el("canvas", { width: 1040, height: 560, role: "img", "aria-label": "Tracks, to scale" });

  constructor(private name: string, private made: TracksAnswer) {}

  show(): void {
    const { cells, notes } = this.made;
    const head = el("tr", {}, el("th", {}, "cell"), ...COLUMNS.map(([, text, unit, title]) => el("th", { title }, text, unit ? el("small", {}, unit === "m/s" ? " µm/s" : ` ${unit}`) : null)));
    const rows = cells.map((cell, i) => el("tr", {}, el("td", {}, el("i", { style: `background: ${hue(i)}` }), cell.name),
      ...COLUMNS.map(([key, , unit]) => el("td", {}, ...said(cell.numbers[key], unit === "m/s" ? 1e-6 : 1)))));
    card(`${this.name}: ${cells.length} ${cells.length === 1 ? "cell" : "cells"}`, [
      this.canvas,
      el("div", { class: "cells", tabindex: 0 }, el("table", { id: "tracks" }, el("thead", {}, head), el("tbody", {}, ...rows))),
      ...notes.map((n) => el("p", { class: "fine" }, n)),
      el("p", { class: "fine" }, "± is half a 95 % interval; a dash: this track does not hold it. microswim identify writes the same with pictures, and finds the swimmer behind a track."),
    ], "Close", null);
    this.draw();
  }

  private draw(): void {
    const { cells } = this.made;
    const { width: w, height: h } = this.canvas;
    const g = this.canvas.getContext("2d")!;
    const ends = (key: "x" | "y"): [number, number] => {
      const all = cells.flatMap((c) => c[key]);
      return all.length ? [all.reduce((a, b) => Math.min(a, b)), all.reduce((a, b) => Math.max(a, b))] : [0, 1];
    };
    const [x0, x1] = ends("x");
    const [y0, y1] = ends("y");
    const scale = Math.min((w - 60) / (x1 - x0 || 1), (h - 90) / (y1 - y0 || 1));
    const X = (x: number): number => w / 2 + (x - (x0 + x1) / 2) * scale;
    const Y = (y: number): number => (h - 30) / 2 - (y - (y0 + y1) / 2) * scale;
    cells.forEach((cell, i) => {
      g.strokeStyle = g.fillStyle = hue(i);
      g.lineWidth = 3;
      g.lineJoin = "round";
      g.beginPath();
      cell.x.forEach((x, k) => (k ? g.lineTo(X(x), Y(cell.y[k])) : g.moveTo(X(x), Y(cell.y[k]))));
      g.stroke();
      g.beginPath();
      g.arc(X(cell.x[cell.x.length - 1]), Y(cell.y[cell.y.length - 1]), 6, 0, 7);
      g.fill();
    });
    const ten = 10 ** Math.floor(Math.log10(200 / scale));
    const bar = ten * (200 / scale / ten >= 5 ? 5 : 200 / scale / ten >= 2 ? 2 : 1);
    g.fillStyle = g.strokeStyle = "#e8eef4";
    g.lineWidth = 3;
    g.beginPath();
    g.moveTo(30, h - 24);
    g.lineTo(30 + bar * scale, h - 24);
    g.stroke();
    g.font = "22px 'Inter Variable', sans-serif";
    g.fillText(withPrefix(bar, "m", 1).join(" "), 42 + bar * scale, h - 17);
  }
}

const hue = (i: number): string => `hsl(${(170 + (360 / HUES) * (i % HUES)) % 360} 60% ${i % (2 * HUES) < HUES ? 66 : 52}%)`;

function said(found: [number, number, number] | null, unit: number): (string | HTMLElement)[] {
  if (!found) return ["–"];
  const [value, low, high] = found.map((v) => v / unit);
  return [digits(value), el("span", { class: "off" }, ` ± ${digits((high - low) / 2, 2)}`)];
}
