// The left panel: every number of the spec as a slider with its unit, choices as segments.

import { call } from "../state/api";
import { digits, el, pretty } from "../state/dom";
import { label, quantity, read, sensible, several, spoken, tableOf, type Range } from "../state/fields";
import { field, size } from "../state/words";
import { attempt, type Design, type Store } from "../state/store";
import type { Tables, Value } from "../state/types";

const TITLES: [string, string, boolean][] = [
  ["tail", "Tail", true],
  ["body", "Body", true],
  ["fluid", "Fluid", true],
  ["coefficients", "Local resistance", false],
  ["interaction", "Body–tail interaction", false],
  ["motion", "Motion", false],
];
const FIRST: Record<string, string[]> = {
  tail: ["kind", "handedness", "length", "amplitude", "waves", "wavelength", "frequency", "radius", "radius_end", "ramp"],
  wall: ["distance", "tilt", "azimuth"],
  channel: ["shape", "diameter", "length", "ends", "tilt", "position"],
};
const BOUNDS: [string, string][] = [["wall", "Wall"], ["channel", "Channel"]];
const STEPS = 1000;

export class Controls {
  readonly node = el("aside", { class: "panel left", "aria-label": "Design" });
  private rows: (() => void)[] = [];
  private open = new Map(TITLES.map(([part, , open]) => [part, open]));

  constructor(private store: Store) {
    store.on("structure", () => this.build());
    store.on("tables", () => this.refresh());
    store.on("problem", () => this.showProblem());
  }

  build(): void {
    const { design } = this.store;
    const scroll = this.node.scrollTop;
    this.rows = [];
    this.node.replaceChildren();
    for (const [part, title] of TITLES) {
      const names = several(design.tables, part);
      names.forEach((name, i) => this.node.append(this.section(name, names.length > 1 ? `${title} ${i + 1}` : title)));
    }
    this.node.append(el("div", { class: "problem", id: "problem", hidden: true, role: "alert" }));
    this.node.scrollTop = scroll;
    this.refresh();
    this.showProblem();
  }

  /** Every field of a table, those that matter most first. */
  private fields(part: string): HTMLElement[] {
    const table = tableOf(this.store.design.tables, part);
    const first = FIRST[part.replace(/\[.*/, "")] ?? [];
    const open = part === "coefficients" && !("law" in table) ? ["law"] : []; // it can be chosen where none is
    const names = [...open, ...first.filter((n) => n in table), ...Object.keys(table).filter((n) => !first.includes(n))];
    return names.flatMap((name) => this.field(`${part}.${name}`, table[name]));
  }

  private section(part: string, title: string): HTMLElement {
    const body = this.fields(part);
    if (part === "fluid") body.push(...this.bounds());
    const box = el("details", { open: this.open.get(part) ?? true }, el("summary", {}, title), ...body);
    box.addEventListener("toggle", () => this.open.set(part, box.open));
    return box;
  }

  /** What bounds the fluid: nothing, a wall or a channel, and their numbers. */
  private bounds(): HTMLElement[] {
    const { store } = this;
    const now = (): string => BOUNDS.find(([b]) => b in store.design.tables)?.[0] ?? "";
    const all: [string, string][] = [["", "Nothing"], ...BOUNDS];
    const set = (kind: string): void => {
      const { wall, channel, ...free } = structuredClone(store.design.tables);
      const old = { wall, channel }[kind];
      if (kind !== now()) store.replace(kind ? { ...free, [kind]: old ?? boundOf(kind, store.design) } : free);
    };
    const buttons = all.map(([kind, text]) => {
      const b = el("button", { type: "button", "data-field": "bounds", "data-value": kind, onclick: () => set(kind) }, text);
      this.rows.push(() => b.setAttribute("aria-pressed", String(now() === kind)));
      return b;
    });
    return [
      el("div", { class: "row bounds" }, el("label", {}, "Bounded by"), el("div", { class: "segments six" }, ...buttons)),
      ...this.fields(now()),
    ];
  }

  private field(path: string, value: Value): HTMLElement[] {
    if (/^\w+\[\d+\]\.kind$/.test(path)) return [];
    if (path === "motion.free") return [this.freedom(path)];
    if (field(path)?.choices.length) return [this.choice(path)];
    if (typeof value === "boolean") return [this.toggle(path)];
    if (Array.isArray(value)) {
      const about = field(path);
      if (value.some(Array.isArray) || !about?.entries.length) return [this.folded(path, value)];
      const head = about?.kind === "number" && !path.includes("[") ? [el("h4", { title: about.help }, about.label)] : [];
      return [...head, ...value.flatMap((v, i) => this.field(`${path}[${i}]`, v))];
    }
    return quantity(value) ? [this.slider(path)] : [];
  }

  /** A table of numbers, closed until somebody wants it. */
  private folded(path: string, rows: Value[]): HTMLElement {
    const cells = rows.flatMap((row, i) => Array.isArray(row) ? row.flatMap((v, j) => this.field(`${path}[${i}][${j}]`, v)) : this.field(`${path}[${i}]`, row));
    const box = el("details", { class: "folded", open: this.open.get(path) }, el("summary", { title: field(path)?.help }, `${label(path)}, ${rows.length} ${rows.some(Array.isArray) ? "rows" : "numbers"}`), ...cells);
    box.addEventListener("toggle", () => this.open.set(path, box.open));
    return box;
  }

  private range(path: string): Range {
    const q = quantity(read(this.store.design.tables, path))!;
    const { ranges } = this.store.design;
    let range = ranges.get(path);
    if (!range) {
      range = sensible(path, q, this.store.design.answer);
      ranges.set(path, range);
    }
    if (q.n < range.low) range.low = q.n;
    if (q.n > range.high) range.high = q.n;
    return range;
  }

  /** Range of a field in its own unit, for the map as well. */
  span(path: string): Range | null {
    return quantity(read(this.store.design.tables, path)) ? this.range(path) : null;
  }

  private slider(path: string): HTMLElement {
    const { store } = this;
    const track = el("input", { type: "range", min: 0, max: STEPS, step: 1, "aria-label": label(path), "data-field": path });
    const box = el("input", { type: "text", inputmode: "decimal", class: "number", "aria-label": `${label(path)}, value`, spellcheck: "false" });
    const unit = el("span", { class: "unit" });
    const show = (): void => {
      const q = quantity(read(store.design.tables, path));
      if (!q) return;
      const { low, high, log } = this.range(path);
      const f = log ? Math.log(q.n / low) / Math.log(high / low) : (q.n - low) / (high - low);
      track.value = String(Math.round(f * STEPS));
      track.style.setProperty("--at", `${100 * f}%`);
      if (document.activeElement !== box) box.value = typed(q.n);
      box.style.minWidth = `${box.value.length + 2}ch`; // an exponent that is cut off is another number
      unit.textContent = pretty(q.unit);
    };
    const move = (commit: boolean): void => {
      const q = quantity(read(store.design.tables, path))!;
      const { low, high, log } = this.range(path);
      const f = Number(track.value) / STEPS;
      const n = log ? low * (high / low) ** f : low + f * (high - low);
      store.edit({ [path]: spoken(Number(n.toPrecision(4)), q.unit) }, commit);
    };
    track.addEventListener("input", () => move(false));
    track.addEventListener("change", () => store.commit());
    box.addEventListener("change", () => {
      const text = box.value.trim().replace(",", ".").replace("−", "-");
      const q = quantity(read(store.design.tables, path))!;
      if (text === "") return show();
      if (Number.isFinite(Number(text))) store.edit({ [path]: spoken(Number(text), q.unit) }, true);
      else void attempt(() => store.put(path, text)).then(show);
    });
    box.addEventListener("keydown", (event) => event.key === "Enter" && box.blur());
    box.addEventListener("blur", show);
    this.rows.push(show);
    return el("div", { class: "row" }, el("label", { title: field(path)?.help }, label(path)), el("span", { class: "value" }, box, unit), track);
  }

  private choice(path: string): HTMLElement {
    const none: [string, string][] = path === "coefficients.law" ? [["", "As it comes"]] : [];
    const { store } = this;
    const options = [...none, ...field(path)!.choices];
    const now = read(store.design.tables, path);
    if (typeof now === "string" && !options.some(([value]) => value === now)) options.push([now, field(path)!.called[now] ?? now]);
    const set = (value: string): void => this.choose(path, value);
    if (options.length > 2) {
      const select = el("select", { "data-field": path, "aria-label": label(path) }, ...options.map(([v, t]) => el("option", { value: v }, t)));
      select.addEventListener("change", () => set(select.value));
      this.rows.push(() => (select.value = String(read(store.design.tables, path) ?? "")));
      return el("div", { class: "row choice" }, el("label", { title: field(path)?.help }, label(path)), select);
    }
    const buttons = options.map(([value, text]) => {
      const b = el("button", { type: "button", "data-field": path, "data-value": value, onclick: () => set(value) }, text);
      this.rows.push(() => b.setAttribute("aria-pressed", String(read(store.design.tables, path) === value)));
      return b;
    });
    return el("div", { class: "row choice" }, el("label", { title: field(path)?.help }, label(path)), el("div", { class: "segments" }, ...buttons));
  }

  private toggle(path: string): HTMLElement {
    const { store } = this;
    const box = el("input", { type: "checkbox", class: "switch", "data-field": path, "aria-label": label(path) });
    box.addEventListener("change", () => store.edit({ [path]: box.checked }, true));
    this.rows.push(() => (box.checked = Boolean(read(store.design.tables, path))));
    return el("div", { class: "row choice" }, el("label", { title: field(path)?.help }, label(path)), box);
  }

  /** Which of the six directions are free. */
  private freedom(path: string): HTMLElement {
    const { store } = this;
    const all = ["us", "uq", "ur", "os", "oq", "or"];
    const free = (): string[] => {
      const value = read(store.design.tables, path);
      return Array.isArray(value) ? value.map(String) : all;
    };
    const buttons = all.map((name) => {
      const text = name[0] === "u" ? `u${name[1]}` : `ω${name[1]}`;
      const flip = (): void => {
        const now = free();
        const next = all.filter((n) => (n === name ? !now.includes(n) : now.includes(n)));
        if (next.length) store.edit({ [path]: next.length === 6 ? "all" : next }, true);
      };
      const b = el("button", { type: "button", title: name[0] === "u" ? "translation" : "rotation", onclick: flip }, text);
      this.rows.push(() => b.setAttribute("aria-pressed", String(free().includes(name))));
      return b;
    });
    return el("div", { class: "row" }, el("label", {}, "Free directions"), el("div", { class: "segments six" }, ...buttons));
  }

  /** Another body or tail, of about the same size. */
  private async exchange(path: string, value: string): Promise<void> {
    const { store } = this;
    const ask = { tables: store.design.tables, field: path, value };
    const tables = await attempt(() => call<Tables>("/api/exchange", ask));
    if (!tables) return this.refresh();
    if (path === "tail.kind" && value !== "helix" && tables.motion?.frequency_frame === "lab") tables.motion.frequency_frame = "body";
    store.replace(tables);
  }

  /** A choice that changes which numbers there are. */
  private choose(path: string, value: string): void {
    const { store } = this;
    if (path === "body.shape" || path === "tail.kind") return void this.exchange(path, value);
    const tables: Tables = structuredClone(store.design.tables);
    const [part, name] = path.split(".");
    if (value === "") delete tables[part][name];
    else tables[part][name] = value;
    if (path === "coefficients.law") {
      for (const k of ["normal", "tangential"]) delete tables.coefficients[k];
      if (value === "constant") Object.assign(tables.coefficients, constantOf(tables));
    }
    store.replace(tables);
  }

  refresh(): void {
    for (const show of this.rows) show();
  }

  private showProblem(): void {
    const node = this.node.querySelector<HTMLElement>("#problem");
    if (!node) return;
    const { problem } = this.store.design;
    node.hidden = !problem;
    node.textContent = problem ?? "";
    document.body.classList.toggle("refused", problem !== null);
  }
}

/** A number as one types it, four digits. */
function typed(n: number): string {
  const size = Math.abs(n);
  const text = size && (size >= 1e5 || size < 1e-4) ? n.toExponential(3) : digits(n, 4).replace("−", "-");
  return text.replace(/(\.\d*?)0+(?=e|$)/, "$1").replace(/\.(?=e|$)/, "").replace("e+", "e");
}

/** A wall below, or a channel three times as wide as the swimmer, as a first guess. */
function boundOf(kind: string, design: Design): Record<string, Value> {
  const unit = design.answer.units.length ?? "";
  const { semi_axes: [a, b, c], reach: out, radius, length } = design.answer.shape;
  const reach = Math.max(b, c, out + radius);
  const say = (x: number): Value => spoken(Number((x / size(unit)).toPrecision(3)), unit);
  if (kind === "wall") return { distance: say(2 * reach), tilt: "0 deg", azimuth: "90 deg" };
  const none = say(0);
  return {
    diameter: say(6 * reach), length: say(2 * (2 * a + length)), shape: "cylinder",
    position: [none, none, none], tilt: "0 deg", ends: "closed",
  };
}

/** Gray and Hancock's pair as a first guess of a constant one: c_n = 2 c_t. */
function constantOf(tables: Tables): Record<string, Value> {
  const { n, unit } = quantity(tables.fluid.viscosity)!;
  return {
    normal: spoken(Number((8 * n).toPrecision(4)), unit),
    tangential: spoken(Number((5 * n).toPrecision(4)), unit),
  };
}
