// What is dropped onto the page: a spec, a surface as a body, a traced beat as a tail, tracks of cells to look at.

import { Refusal, call } from "../state/api";
import { digits, el, pretty } from "../state/dom";
import { attempt, notice, type Store } from "../state/store";
import type { Tables } from "../state/types";
import { words } from "../state/words";
import { Tracks, type TracksAnswer } from "./tracks";

interface SurfaceAnswer {
  file: string;
  size: number[];
  faces: number;
  notes: string[];
}

type FilmAnswer = TracksAnswer | { kind: "beat"; tables: Tables; notes: string[] };

/** The largest table or surface, bytes; the server says it again. */
const LARGEST = 16 * 1024 * 1024;

export class Drop {
  readonly accept: string;

  constructor(private store: Store) {
    const { surfaces, films } = words();
    this.accept = [".toml", ...surfaces, ...films].join(",");
    document.addEventListener("dragover", (e) => e.preventDefault());
    document.addEventListener("drop", (e) => {
      e.preventDefault();
      const dropped = e.dataTransfer?.files[0];
      if (dropped) void this.read(dropped);
    });
  }

  async read(file: File): Promise<void> {
    const { largest, surfaces, films } = words();
    const name = file.name.toLowerCase();
    const kib = (n: number): string => `${Math.round(n / 1024)} KiB`;
    const most = name.endsWith(".toml") ? largest : LARGEST;
    if (file.size > most) return notice(`${file.name} has ${kib(file.size)}; at most ${kib(most)} are read here.`, "error");
    if (surfaces.some((ending) => name.endsWith(ending))) return this.surface(file);
    if (films.some((ending) => name.endsWith(ending))) return this.film(file, {});
    if (/\.ya?ml$/.test(name)) return notice(`${file.name} is no spec: if it tells coils, a spec names it as file in its [field], and \`microswim studio SPEC\` opens both.`, "error");
    const text = await file.text();
    await attempt(() => this.store.load(file.name.replace(/\.toml$/, ""), text));
  }

  /** A file with its name, and what else is asked, on a line before it. */
  private send<T>(path: string, file: File, ask: Record<string, unknown>): Promise<T> {
    return call<T>(path, new Blob([`${JSON.stringify({ ...ask, name: file.name })}\n`, file], { type: "application/octet-stream" }));
  }

  private async surface(file: File): Promise<void> {
    const made = await attempt(() => this.send<SurfaceAnswer>("/api/surface", file, {}));
    if (!made) return;
    const { dimensional, units } = this.store.design.answer;
    const unit = el("select", { id: "drop-unit" }, ...words().lengths.filter((u) => u !== "µm").map((u) => el("option", { value: u }, pretty(u))));
    unit.value = units.length === "um" ? "um" : "mm";
    const alone = el("select", { id: "drop-as" },
      el("option", { value: "alone" }, "the whole robot, without a tail"), el("option", { value: "body" }, "the body of this design"));
    const sides = made.size.map((x) => digits(x, 3)).join(" × ");
    const use = async (signal: AbortSignal): Promise<void> => {
      const tables = structuredClone(this.store.design.tables);
      tables.body = { shape: "mesh", file: made.file, scale: dimensional ? `1 ${unit.value}` : 1 };
      if (alone.value === "alone") tables.tail = { kind: "none" };
      if (alone.value === "alone" && tables.motion) Object.assign(tables.motion, { free: "all", frequency_frame: "body" });
      await attempt(() => this.store.take(file.name.replace(/\.\w+$/, ""), tables, signal));
    };
    card(file.name, [
      el("p", {}, `${made.faces} triangles, ${sides} of the file's units.`),
      ...made.notes.map((n) => el("p", { class: "fine" }, n)),
      dimensional ? el("label", {}, "One unit of the file is 1", unit) : el("p", { class: "fine" }, "This design has no units: one unit of the file is its unit of length."),
      el("label", {}, "Take it as", alone),
    ], "Take it", use, "Its resistance is being solved: some seconds …");
  }

  private async film(file: File, known: Record<string, string>): Promise<void> {
    let made: FilmAnswer;
    try {
      made = await this.send<FilmAnswer>("/api/film", file, { ...known, tables: this.store.design.tables });
    } catch (error) {
      if (error instanceof Refusal) return this.ask(file, known, error.message);
      throw error;
    }
    if (made.kind === "tracks") return new Tracks(file.name, made).show();
    if (await attempt(() => this.store.take(file.name.replace(/\.\w+$/, ""), made.tables))) notice(`${file.name}: ${made.notes.join("; ")}.`);
  }

  /** What a table does not say: how long a pixel and a frame are. */
  private ask(file: File, known: Record<string, string>, why: string): void {
    const pixel = el("input", { type: "text", id: "drop-pixel", placeholder: "0.11 um", value: known.pixel ?? "" });
    const fps = el("input", { type: "text", id: "drop-fps", inputmode: "decimal", placeholder: "25", value: known.fps ?? "" });
    card(file.name, [
      el("p", { role: "alert" }, why),
      el("label", {}, "Size of a pixel", pixel), el("label", {}, "Frames per second", fps),
      el("p", { class: "fine" }, "Leave empty what the file says itself."),
    ], "Read again", () => this.film(file, { pixel: pixel.value.trim(), fps: fps.value.trim() }));
  }
}

/** A dialog over the page with one thing to do; Escape closes it. Work that takes long is said meanwhile, and can be left. */
export function card(title: string, inside: HTMLElement[], does: string, act: ((signal: AbortSignal) => unknown) | null, long = ""): HTMLDialogElement {
  const stop = new AbortController();
  const close = el("button", { type: "button", id: "card-close" }, act ? "Cancel" : does);
  const go = act ? el("button", { type: "button", class: "primary", id: "card-do" }, does) : null;
  const box = el("dialog", { class: "card", "aria-label": title }, el("h2", {}, title), ...inside, el("div", { class: "does" }, close, go));
  close.onclick = () => box.close();
  if (go) go.onclick = async () => {
    if (!long) box.close();
    else {
      go.disabled = true;
      box.lastElementChild!.before(el("p", { class: "busy", role: "status" }, el("i"), long));
    }
    await act!(stop.signal);
    box.close();
  };
  box.addEventListener("close", () => {
    stop.abort();
    box.remove();
  });
  document.body.append(box);
  box.showModal();
  return box;
}
