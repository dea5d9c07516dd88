// The top bar (specs, history, take away) and the bar below the scene (time, camera, what is shown).

import { call, download } from "../state/api";
import { digits, el } from "../state/dom";
import { link } from "../state/link";
import { attempt, notice, type Store } from "../state/store";
import { Drop } from "./drop";
import type { SpeedMap } from "./map";
import type { Stage } from "../scene/stage";
import type { Actor } from "../scene/actor";

interface Presets {
  specs: Record<string, string>;
  /** two swimmers each */
  scenes: Record<string, string>;
  /** files to read as if they were dropped */
  files: string[];
}

export interface View {
  paused: boolean;
  /** periods of the tail per second of ours */
  pace: number;
  arrows: boolean;
}

/** What the bar takes things away from. */
export interface Page {
  stage: Stage;
  map: SpeedMap;
  view: View;
  actors: () => Actor[];
  picture: () => Promise<Blob>;
}

export function icon(path: string): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 16 16");
  const p = document.createElementNS("http://www.w3.org/2000/svg", "path");
  p.setAttribute("d", path);
  svg.append(p);
  return svg;
}

const UNDO = "M6 3 2.5 6.5 6 10M2.5 6.5H10a3.5 3.5 0 0 1 0 7H7";
const REDO = "M10 3l3.5 3.5L10 10M13.5 6.5H6a3.5 3.5 0 0 0 0 7h3";
export const PLAY = "M4.5 2.8v10.4l8.5-5.2z";
export const PAUSE = "M4.5 3v10M11.5 3v10";

export class TopBar {
  readonly node = el("header", {});
  private presets = el("select", { id: "presets", "aria-label": "Presets" });
  private undo = el("button", { id: "undo", class: "icon", title: "Undo (Ctrl+Z)" });
  private redo = el("button", { id: "redo", class: "icon", title: "Redo (Ctrl+Shift+Z)" });
  private compare = el("button", { id: "compare", title: "Put a second design beside this one" }, "Compare");
  private specs: Record<string, string> = {};
  private drop: Drop | null = null;

  constructor(private store: Store, private page: Page) {
    this.undo.append(icon(UNDO));
    this.redo.append(icon(REDO));
    this.undo.onclick = () => store.undo();
    this.redo.onclick = () => store.redo();
    this.compare.onclick = () => this.toggle();
    this.presets.addEventListener("change", () => void attempt(() => this.take(this.presets.value)));
    const file = el("input", { type: "file", hidden: true, id: "file" });
    file.addEventListener("change", () => {
      if (file.files?.[0]) void this.drop?.read(file.files[0]);
      file.value = "";
    });
    const name = el("span", { class: "name" });
    const brand = el("div", { class: "brand" }, el("i"), el("b", {}, "microswim"), el("span", {}, "studio"));
    const actions = el("div", { class: "actions" });
    const more = el("button", { id: "more", "aria-expanded": "false", "aria-label": "More" }, "More");
    const unfold = (open: boolean): void => more.setAttribute("aria-expanded", String(actions.classList.toggle("open", open)));
    more.onclick = () => unfold(!actions.classList.contains("open"));
    const stays = "#undo, #redo, summary";
    actions.addEventListener("click", (e) => (e.target as Element).closest(stays) || (e.target as Element).closest("button") && unfold(false));
    document.addEventListener("pointerdown", (e) => actions.contains(e.target as Node) || e.target === more || unfold(false));
    document.addEventListener("keydown", (e) => e.key === "Escape" && unfold(false));
    if (store.snapshot) {
      actions.append(el("span", { class: "fine" }, "Snapshot: plays without a server"), this.menu());
      this.node.append(brand, name, el("span", { class: "grow" }), more, actions);
    } else {
      const load = el("button", { onclick: () => file.click(), title: "Load a spec, a surface (STL, PLY, OBJ), tracks or a beat (CSV); you can drop a file on the page" }, "Open…");
      actions.append(this.undo, this.redo, this.compare, this.menu());
      this.node.append(brand, this.presets, load, file, el("span", { class: "grow" }), more, actions);
      void attempt(async () => {
        const { specs, scenes, files } = await call<Presets>("/api/presets");
        this.specs = { ...specs, ...scenes };
        this.presets.append(el("option", { value: "", disabled: true, hidden: true }), ...families([...Object.keys(this.specs), ...files]));
        this.show();
      });
      store.on("designs", () => {
        this.drop ??= new Drop(store);
        file.accept = this.drop.accept;
      });
    }
    for (const event of ["structure", "answer", "tables", "designs"] as const) store.on(event, () => this.show());
    store.on("designs", () => (name.textContent = store.designs.map((d) => d.name).join("  and  ")));
  }

  private show(): void {
    const { design, designs } = this.store;
    if (!design) return;
    this.undo.disabled = design.past.length === 0;
    this.redo.disabled = design.future.length === 0;
    this.compare.textContent = designs.length > 1 ? "End comparison" : "Compare";
    const blank = this.presets.options[0];
    if (!blank) return;
    const shown = this.store.scene || design.name;
    blank.textContent = shown in this.specs ? "" : shown;
    this.presets.value = shown in this.specs ? shown : "";
  }

  /** A spec or a scene of the menu; or a file of it, read as if it were dropped. */
  private async take(name: string): Promise<void> {
    if (name in this.specs) return this.store.load(name, this.specs[name]);
    this.show();
    const answer = await fetch(`/api/${name}`);
    if (!answer.ok) throw new Error(((await answer.json()) as { error: string }).error);
    await this.drop?.read(new File([await answer.blob()], name.split("/")[1]));
  }

  private toggle(): void {
    const { store } = this;
    store.scene = "";
    if (store.designs.length > 1) store.designs = [store.design];
    else {
      const other = store.make(store.design.name, structuredClone(store.design.answer));
      store.design.ranges.forEach((range, path) => other.ranges.set(path, { ...range }));
      store.designs.push(other);
    }
    store.active = store.designs.length - 1;
    store.tell("designs", "structure", "tables", "answer", "problem", "rest");
  }

  private menu(): HTMLElement {
    const items: [string, string, () => unknown][] = [
      ["Picture (PNG)", "take-png", async () => download(`${this.file}.png`, await this.page.picture())],
      ["Spec (TOML)", "take-spec", () => download(`${this.file}.toml`, this.store.design.answer.toml)],
      ["Trajectory (CSV)", "take-csv", () => this.csv()],
    ];
    if (!this.store.snapshot) items.push(["Snapshot (HTML)", "take-html", () => this.html()], ["Link to this design", "take-link", () => this.link()]);
    const box = el("details", { class: "menu" }, el("summary", { id: "take" }, "Take away"),
      el("div", {}, ...items.map(([text, id, act]) => el("button", { id, onclick: () => {
        box.open = false;
        void attempt(async () => act());
      } }, text))));
    document.addEventListener("click", (e) => {
      if (!box.contains(e.target as Node)) box.open = false;
    });
    return box;
  }

  private get file(): string {
    return this.store.design.name.replace(/[^\w.-]+/g, "-");
  }

  /** The path recorded since the last change, in the lab frame. */
  private csv(): void {
    const { record, answer } = this.page.actors()[this.store.active];
    const held = answer.gait.one_pose;
    if (held) return notice(`No path is followed here: the ${held} would turn with the swimmer.`, "error");
    if (record.length === 0) return notice("Nothing is recorded yet; let it swim.", "error");
    const rows = record.map((r) => r.map((v) => v.toPrecision(10)).join(","));
    download(`${this.file}.csv`, ["time,x,y,z,qw,qx,qy,qz,phase", ...rows, ""].join("\n"));
  }

  private async link(): Promise<void> {
    const address = await link(this.store);
    if (!address) return notice("This design is too long for a link; take its spec (TOML).", "error");
    try {
      await navigator.clipboard.writeText(address);
      notice("The link is copied. It opens this design wherever a studio runs at this address.");
    } catch {
      notice("The address of this page is the link to this design: copy it from there.");
    }
  }

  private async html(): Promise<void> {
    const { store } = this;
    const { stage, map, view: seen } = this.page;
    const designs = store.designs.map((d) => ({ name: d.name, tables: d.answer.tables }));
    const way = stage.camera.position.clone().sub(stage.controls.target).toArray();
    const view = { camera: way, pace: seen.pace, arrows: seen.arrows };
    const html = await call<string>("/api/snapshot", { designs, map: map.current, view });
    download(`${this.file}.html`, new Blob([html], { type: "text/html" }));
    notice("The snapshot plays in any browser, without a server.");
  }
}

/** Presets by family, each under its own name. */
function families(names: string[]): HTMLElement[] {
  const groups = new Map<string, HTMLElement>();
  for (const name of names) {
    const [family, member] = name.split("/");
    if (!groups.has(family)) groups.set(family, el("optgroup", { label: family }));
    groups.get(family)!.append(el("option", { value: name }, member));
  }
  return [...groups.values()];
}

export class Transport {
  readonly node = el("div", { class: "transport" });
  readonly scale = el("div", { class: "scale" }, el("i"), el("span"));
  private play = el("button", { id: "play", class: "icon", title: "Play or pause (space)" });
  private says = el("span", { class: "pace" });

  constructor(private store: Store, private view: View, private parts: { toggles: HTMLElement[]; restart: () => void; resume: () => void }) {
    const pace = this.slider = el("input", { type: "range", min: -1.6, max: 1.6, step: 0.01, value: Math.log10(view.pace), id: "pace", "aria-label": "Pace" });
    pace.addEventListener("input", () => {
      view.pace = 10 ** Number(pace.value);
      this.showPace();
    });
    this.play.onclick = () => this.toggle();
    const again = el("button", { class: "icon", id: "restart", title: "Back to the start", onclick: parts.restart });
    again.append(icon("M3 3v4h4M3.4 7A5.3 5.3 0 1 1 3 9.6"));
    this.node.append(this.play, again, el("span", { class: "slow" }, pace, this.says), el("span", { class: "bar" }), ...parts.toggles);
    store.on("answer", () => this.tellPace());
    this.showPace();
    this.draw();
  }

  private slider: HTMLInputElement;

  /** Another pace than the hand has set, within the slider's ends. */
  setPace(pace: number): void {
    this.slider.value = String(Math.log10(pace));
    this.view.pace = 10 ** Number(this.slider.value);
    this.showPace();
  }

  private showPace(): void {
    this.slider.style.setProperty("--at", `${(100 * (Number(this.slider.value) + 1.6)) / 3.2}%`);
    this.tellPace();
  }

  toggle(): void {
    this.view.paused = !this.view.paused;
    if (!this.view.paused) this.parts.resume();
    this.draw();
  }

  pause(): void {
    this.view.paused = true;
    this.draw();
  }

  private draw(): void {
    this.play.replaceChildren(icon(this.view.paused ? PLAY : PAUSE));
    this.play.setAttribute("aria-pressed", String(!this.view.paused));
  }

  private tellPace(): void {
    const answer = this.store.design?.answer;
    if (!answer) return;
    const f = Math.abs(answer.gait.rate) / (2 * Math.PI) || 1;
    const slower = f / this.view.pace;
    if (!answer.dimensional) this.says.textContent = `${digits(this.view.pace, 2)} periods/s`;
    else this.says.textContent = slower > 1.05 ? `${digits(slower, 2)} × slowed` : slower < 0.95 ? `${digits(1 / slower, 2)} × faster` : "real time";
  }

  /** The bar that is shown. */
  get bar(): { pixels: number; text: string } {
    const [bar, text] = [this.scale.firstElementChild as HTMLElement, this.scale.lastElementChild as HTMLElement];
    return { pixels: parseFloat(bar.style.width), text: text.textContent! };
  }

  /** A bar of 1, 2 or 5 of some unit, about 90 pixels long. */
  measure(pixel: number): void {
    const { answer } = this.store.design;
    const wanted = 110 * pixel;
    const ten = 10 ** Math.floor(Math.log10(wanted));
    const length = ten * (wanted / ten >= 5 ? 5 : wanted / ten >= 2 ? 2 : 1);
    const [bar, text] = [this.scale.firstElementChild as HTMLElement, this.scale.lastElementChild as HTMLElement];
    bar.style.width = `${length / pixel}px`;
    const unit = answer.dimensional ? (length < 1e-6 ? [1e-9, "nm"] : length < 1e-3 ? [1e-6, "µm"] : length < 1 ? [1e-3, "mm"] : [1, "m"]) : [1, ""];
    text.textContent = answer.dimensional ? `${digits(length / Number(unit[0]), 1)} ${unit[1]}` : `${digits(length, 1)}`;
  }
}
