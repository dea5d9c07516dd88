// The map: speed or efficiency over two numbers of the spec, the design as a dot that can be moved.

import { Latest, call } from "../state/api";
import { el, pretty, reading } from "../state/dom";
import { label, numbers, quantity, read, si, spoken } from "../state/fields";
import { called, plain, size, words } from "../state/words";
import type { Controls } from "./controls";
import { colour, gradient, ticks } from "./scales";
import { attempt, notice, type Store } from "../state/store";
import type { Axis, MapAnswer, MapAsk, Tables } from "../state/types";

/** of a key, across and up */
const STEPS: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** share of the largest value on a map that cannot be told from none by its colour */
const NOTHING = 1e-3;

export class SpeedMap {
  readonly node = el("div", { class: "map" });
  private canvas = el("canvas", { id: "map", width: 536, height: 290, tabindex: 0, role: "application", "aria-label": "Map; click, or arrow keys, to move the design there" });
  private tip = el("div", { class: "tip", hidden: true });
  private field = { x: "tail.amplitude", y: "tail.waves" };
  private output = "swimming_speed";
  /** what was last chosen to be shown, where a design has it */
  private wanted = this.output;
  /** whether somebody chose what it is drawn over; else each design has its usual two numbers */
  private chosen = false;
  private answer: MapAnswer | null = null;
  private asked: { tables: Tables; ask: MapAsk } | null = null;
  private picture: HTMLCanvasElement | null = null;
  private wish = "";
  private latest: Latest<{ tables: Tables; ask: MapAsk }, MapAnswer>;
  private selects: Record<string, HTMLSelectElement> = {};
  private foot = el("div", { class: "foot" });
  private bar = el("div", { class: "mapbar" });
  private plot = el("div", { class: "plot" });
  private nothing = el("p", { class: "fine" }, "Nothing propels it by itself: there is no map. A field can drive it.");
  /** whether the design has two numbers to draw over */
  private possible = true;
  visible = true;
  /** answers so far, for the tests */
  count = 0;

  constructor(private store: Store, private controls: Controls) {
    this.latest = new Latest(
      (a, signal) => call<MapAnswer>("/api/map", { tables: a.tables, ...a.ask }, "POST", signal),
      (made, a) => this.take(made, a),
      (error) => {
        this.forget();
        if (this.visible && !this.store.design.problem) notice(error.message, "error");
      },
    );
    const stored = store.snapshot?.map;
    if (stored) {
      this.field = { x: stored.ask.x.field, y: stored.ask.y.field };
      this.wanted = this.output = stored.ask.output ?? this.output;
      this.chosen = true;
    }
    // in this order: a new design has other numbers, and only then is a map of it asked
    if (!store.snapshot) store.on("designs", () => this.forget());
    store.on("structure", () => this.options());
    store.on("tables", () => this.draw());
    store.on("rest", () => this.refresh());
    this.build();
  }

  private build(): void {
    for (const key of ["y", "x", "output"] as const) {
      const select = el("select", { "aria-label": { x: "Across", y: "Up", output: "Shown" }[key], id: `map-${key}` });
      select.addEventListener("change", () => {
        if (key === "output") this.wanted = this.output = select.value;
        else {
          this.chosen = true;
          this.field[key] = select.value;
        }
        if (key === "output" && this.answer && !this.answer.values[this.output]) this.forget();
        if (key === "output" && this.answer) this.paint();
        else this.refresh();
      });
      this.selects[key] = select;
    }
    const best = el("button", { class: "primary", id: "optimum", title: "Move to the best design on this map", onclick: () => this.optimum() }, "Optimum");
    if (this.store.snapshot) best.hidden = this.selects.x.disabled = this.selects.y.disabled = true;
    this.canvas.addEventListener("pointerdown", (e) => {
      if (this.store.snapshot) return;
      this.canvas.setPointerCapture(e.pointerId);
      this.go(e, false);
    });
    this.canvas.addEventListener("pointermove", (e) => {
      this.hover(e);
      if (e.buttons & 1 && !this.store.snapshot) this.go(e, false);
    });
    this.canvas.addEventListener("pointerup", () => {
      this.store.commit();
    });
    this.canvas.addEventListener("keydown", (e) => {
      const [right, up] = STEPS[e.key] ?? [0, 0];
      if ((!right && !up) || this.store.snapshot) return;
      e.preventDefault();
      e.stopPropagation();
      this.nudge(right, up);
    });
    this.canvas.addEventListener("keyup", () => this.store.commit());
    this.canvas.addEventListener("pointerleave", () => (this.tip.hidden = true));
    this.bar.append(this.selects.output, best, this.selects.x, el("span", {}, "×"), this.selects.y);
    this.plot.append(this.canvas, this.tip);
    this.node.append(this.bar, this.plot, this.foot, this.nothing);
  }

  private options(): void {
    const { tables } = this.store.design;
    const { magnet: { driven }, gait } = this.store.design.answer;
    const outside = driven.length ? /coupling|\]\[|^(wall|channel)/ : /coupling|\]\[|^(wall|channel|magnet|field)/;
    const known = numbers(tables).filter((f) => f !== "fluid.density" && !outside.test(f));
    const usual = words().axes.flatMap((f) => known.find((k) => plain(k) === f) ?? []);
    this.possible = usual.length > 1;
    if (this.possible && !(this.chosen && this.over(known))) {
      [this.field.x, this.field.y] = usual;
      this.chosen = false;
    }
    this.bar.hidden = this.plot.hidden = !this.possible;
    this.nothing.hidden = this.possible;
    this.foot.hidden = !this.possible;
    for (const key of ["x", "y"] as const) {
      const part = (f: string): string => (f.startsWith("tail.") ? "" : `${f.split(".")[0].replace(/\[(\d+)\]/, (_, n) => ` ${Number(n) + 1}`)}: `);
      this.selects[key].replaceChildren(...known.map((f) => el("option", { value: f }, `${part(f)}${label(f).toLowerCase()}`)));
      this.selects[key].value = this.field[key];
    }
    const outputs = [...words().outputs, ...driven];
    this.output = outputs.includes(this.wanted) ? this.wanted : outputs[0];
    if (driven.length && !gait.rate && !driven.includes(this.output)) [this.output] = driven; // no motor turns it
    this.selects.output.replaceChildren(...outputs.map((o) => el("option", { value: o }, called(o).label)));
    this.selects.output.value = this.output;
  }

  /** Whether a design has both of the numbers that were chosen. */
  private over(known: string[]): boolean {
    return known.includes(this.field.x) && known.includes(this.field.y) && this.field.x !== this.field.y;
  }

  private axis(field: string, count: number): Axis | null {
    const span = this.controls.span(field);
    const q = quantity(read(this.store.design.tables, field));
    if (!span || !q) return null;
    const unit = size(q.unit);
    const low = span.low <= 0 && field !== "tail.frequency" ? span.high / 60 : span.low;
    return { field, from: low * unit, to: span.high * unit, count };
  }

  private ask(): MapAsk | null {
    const wave = !this.store.design.answer.shape.rigid;
    const x = this.axis(this.field.x, wave ? 48 : 72);
    const y = this.axis(this.field.y, wave ? 36 : 54);
    return x && y ? { x, y, output: this.output } : null;
  }

  refresh(): void {
    const stored = this.store.snapshot?.map;
    if (this.store.snapshot) {
      if (stored && !this.answer) this.take(stored, { tables: this.store.design.tables, ask: stored.ask });
      return;
    }
    if (!this.visible || !this.possible) return;
    const ask = this.ask();
    if (!ask) return;
    if (ask.x.field === ask.y.field) return notice("Choose two different numbers for the map.", "error");
    const wish = JSON.stringify([this.store.design.tables, ask]);
    if (wish === this.wish && (this.answer || !this.latest.idle)) return; // it is here, or coming
    this.wish = wish;
    if (!this.answer) this.foot.replaceChildren(el("span", {}, "The map is being computed …"));
    this.latest.send({ tables: structuredClone(this.store.design.tables), ask });
  }

  private take(made: MapAnswer, a: { tables: Tables; ask: MapAsk }): void {
    if (!made.values[this.output]) return; // another one was chosen since
    const { swimming_speed: net, path_speed: along } = this.store.design.answer.readings;
    if (this.output === "swimming_speed" && !net && along) this.round(made);
    this.answer = made;
    this.asked = a;
    this.count += 1;
    this.node.dataset.milliseconds = made.milliseconds.toFixed(0);
    this.paint();
  }

  /** Who goes round on a circle at each design of a map has no swimming speed there: show the efficiency. */
  private round({ values }: MapAnswer): void {
    const known = (output: string): number => Math.max(...values[output].map((v) => Math.abs(v ?? 0)));
    if (known("swimming_speed") < 1e-9 * (this.store.design.answer.readings.path_speed ?? 0)) this.selects.output.value = this.output = "efficiency";
  }

  get drawn(): boolean {
    return this.answer !== null;
  }

  /** What a snapshot takes along. */
  get current(): MapAsk | null {
    return this.asked && { ...this.asked.ask, output: this.output };
  }

  private values(): (number | null)[] {
    return this.answer!.values[this.output].map((v) => (v === null ? null : Math.abs(v)));
  }

  /** Colours, bilinear between the designs, and lines of equal value. */
  private paint(): void {
    if (!this.answer) return;
    const { width: w, height: h } = this.canvas;
    const v = this.values();
    const [nx, ny] = [this.answer.x.length, this.answer.y.length];
    const known = v.filter((z): z is number => z !== null);
    const top = Math.max(...known, 1e-300);
    const low = Math.min(...known, top);
    const picture = el("canvas", { width: w, height: h });
    const g = picture.getContext("2d")!;
    const image = g.createImageData(w, h);
    const level = new Int8Array(w * h);
    for (let py = 0; py < h; py++) {
      const b = ((h - 1 - py) / (h - 1)) * (ny - 1);
      const j = Math.min(ny - 2, Math.floor(b));
      for (let px = 0; px < w; px++) {
        const a = (px / (w - 1)) * (nx - 1);
        const i = Math.min(nx - 2, Math.floor(a));
        const c = [v[j * nx + i], v[j * nx + i + 1], v[(j + 1) * nx + i], v[(j + 1) * nx + i + 1]];
        const at = 4 * (py * w + px);
        if (c.some((z) => z === null)) {
          const s = (px + py) % 14 < 2 ? 40 : 22;
          image.data.set([s, s + 6, s + 14, 255], at);
          level[py * w + px] = -1;
          continue;
        }
        const z = c as number[];
        const [u, t] = [a - i, b - j];
        const value = (1 - t) * ((1 - u) * z[0] + u * z[1]) + t * ((1 - u) * z[2] + u * z[3]);
        const f = top > low ? (value - low) / (top - low) : 0;
        image.data.set([...colour(f), 255], at);
        level[py * w + px] = Math.floor(f * 9.999);
      }
    }
    for (let py = 0; py < h - 1; py++) {
      for (let px = 0; px < w - 1; px++) {
        const k = py * w + px;
        if (level[k] < 0 || (level[k] === level[k + 1] && level[k] === level[k + w])) continue;
        for (let n = 0; n < 3; n++) image.data[4 * k + n] = Math.min(255, image.data[4 * k + n] * 0.82 + 44);
      }
    }
    g.putImageData(image, 0, 0);
    this.region(g);
    this.picture = picture;
    this.legend(low, top);
    this.draw();
  }

  /** Dark where the surrogate was not calibrated, if it carries a region. */
  private region(g: CanvasRenderingContext2D): void {
    const { x, y, inside } = this.answer!;
    if (!inside) return;
    const { width: w, height: h } = this.canvas;
    const ends = (values: number[], range: [number, number] | null, size: number): [number, number] => {
      const [a, b] = [values[0], values[values.length - 1]];
      const at = (v: number): number => Math.min(1, Math.max(0, (v - a) / (b - a))) * size;
      return range ? [at(range[0]), Math.max(at(range[1]), at(range[0]) + 2)] : [0, size];
    };
    const [x0, x1] = ends(x, inside.x, w);
    const [y0, y1] = ends(y, inside.y, h);
    g.fillStyle = "rgba(12, 18, 27, 0.62)";
    g.fillRect(0, 0, x0, h);
    g.fillRect(x1, 0, w - x1, h);
    g.fillRect(x0, 0, x1 - x0, h - y1);
    g.fillRect(x0, h - y0, x1 - x0, y0);
    g.strokeStyle = "rgba(255, 255, 255, 0.55)";
    g.strokeRect(x0 + 0.5, h - y1 + 0.5, x1 - x0 - 1, y1 - y0 - 1);
  }

  private legend(low: number, top: number): void {
    const { dimensional } = this.store.design.answer;
    const say = (x: number): string => (x < NOTHING * top ? "0" : reading(this.output, x, dimensional, 2).join(" "));
    const named = (key: "x" | "y"): string => {
      const u = quantity(read(this.store.design.tables, this.field[key]))?.unit;
      return `${label(this.field[key]).toLowerCase()}${u ? ` (${pretty(u)})` : ""}`;
    };
    this.foot.replaceChildren(
      el("span", {}, `across: ${named("x")}; up: ${named("y")}`),
      el("span", { class: "legend" }, say(low), el("i", { style: `background: ${gradient()}` }), say(top)),
      ...(this.answer!.inside ? [el("span", { id: "inside" }, "Calibrated inside the frame.")] : []));
  }

  private place(): [number, number] | null {
    if (!this.answer) return null;
    const x = si(this.store.design.tables, this.field.x);
    const y = si(this.store.design.tables, this.field.y);
    if (x === null || y === null) return null;
    const part = (values: number[], value: number): number => (value - values[0]) / (values[values.length - 1] - values[0]);
    return [part(this.answer.x, x), part(this.answer.y, y)];
  }

  private draw(): void {
    const { width: w, height: h } = this.canvas;
    const g = this.canvas.getContext("2d")!;
    g.fillStyle = "#141c27";
    g.fillRect(0, 0, w, h);
    if (this.picture && this.answer) {
      g.drawImage(this.picture, 0, 0);
      for (const key of ["x", "y"] as const) {
        const unit = size(quantity(read(this.asked!.tables, this.field[key]))?.unit ?? "");
        const values = this.answer[key];
        ticks(g, key, values[0] / unit, values[values.length - 1] / unit);
      }
    }
    const at = this.place();
    if (!at) return;
    const within = (f: number, size: number): number => Math.min(size - 11, Math.max(11, f * size));
    const [x, y] = [within(at[0], w), within(1 - at[1], h)];
    g.strokeStyle = "rgba(255,255,255,.22)";
    g.lineWidth = 1.5;
    g.beginPath();
    g.moveTo(x, 0);
    g.lineTo(x, h);
    g.moveTo(0, y);
    g.lineTo(w, y);
    g.stroke();
    g.beginPath();
    g.arc(x, y, 9, 0, 7);
    g.fillStyle = "rgba(8,12,18,.75)";
    g.fill();
    g.lineWidth = 4;
    g.strokeStyle = "#fff";
    g.stroke();
  }

  private pick(e: PointerEvent): { x: number; y: number; value: number | null } | null {
    if (!this.answer) return null;
    const box = this.canvas.getBoundingClientRect();
    const u = Math.min(1, Math.max(0, (e.clientX - box.left) / box.width));
    const t = Math.min(1, Math.max(0, 1 - (e.clientY - box.top) / box.height));
    const { x, y } = this.answer;
    const i = Math.round(u * (x.length - 1));
    const j = Math.round(t * (y.length - 1));
    const along = (values: number[], f: number): number => values[0] + f * (values[values.length - 1] - values[0]);
    return { x: along(x, u), y: along(y, t), value: this.values()[j * x.length + i] };
  }

  private hover(e: PointerEvent): void {
    const p = this.pick(e);
    this.tip.hidden = !p;
    if (!p) return;
    const { dimensional } = this.store.design.answer;
    const box = this.canvas.getBoundingClientRect();
    this.tip.textContent = p.value === null ? "not possible" : reading(this.output, p.value, dimensional).join(" ");
    this.tip.style.left = `${e.clientX - box.left}px`;
    this.tip.style.top = `${e.clientY - box.top}px`;
  }

  private go(e: PointerEvent, commit: boolean): void {
    const p = this.pick(e);
    if (p) this.move(p.x, p.y, commit);
  }

  /** Move the design by steps of a fiftieth of the map. */
  private nudge(right: number, up: number): void {
    const at = this.place();
    if (!at) return;
    const along = (values: number[], f: number): number => values[0] + Math.min(1, Math.max(0, f)) * (values[values.length - 1] - values[0]);
    this.move(along(this.answer!.x, at[0] + right / 50), along(this.answer!.y, at[1] + up / 50), false);
  }

  private move(x: number, y: number, commit: boolean): void {
    const { tables } = this.store.design;
    const say = (field: string, value: number) => {
      const q = quantity(read(tables, field))!;
      return spoken(Number((value / size(q.unit)).toPrecision(4)), q.unit);
    };
    this.store.edit({ [this.field.x]: say(this.field.x, x), [this.field.y]: say(this.field.y, y) }, commit);
  }

  private async optimum(): Promise<void> {
    const ask = this.ask();
    if (!ask) return;
    const tables = structuredClone(this.store.design.tables);
    const best = await attempt(() => call<{ x: number; y: number; value: number }>("/api/optimum", { tables, ...ask }));
    if (!best) return;
    this.move(best.x, best.y, true);
    const { dimensional } = this.store.design.answer;
    notice(`Best on this map: ${called(this.output).label.toLowerCase()} ${reading(this.output, best.value, dimensional).join(" ")}`);
  }

  /** For a second design: nothing of the first may show. */
  forget(): void {
    this.answer = this.picture = null;
    this.foot.replaceChildren();
    this.draw();
  }
}
