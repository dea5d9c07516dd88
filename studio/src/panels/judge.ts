// Ask the judge: boundary elements in the background, surrogate against reference, calibrate here.

import { Refusal, call } from "../state/api";
import { digits, el, reading, withPrefix } from "../state/dom";
import { called, words } from "../state/words";
import { METHODS, attempt, notice, type Design, type Store } from "../state/store";
import type { Pose } from "../state/motion";
import type { Circle, FlowAnswer, JudgeAnswer, Row } from "../state/types";

export interface Status {
  state: "running" | "done" | "failed" | "cancelled";
  done: number;
  total: number;
  seconds: number;
  answer?: unknown;
  error?: string;
}

/** A job in the background; `told` hears of its progress. */
export async function job<T>(ask: Record<string, unknown>, told: (s: Status) => void, stop: AbortSignal): Promise<T | null> {
  const { token } = await call<{ token: string }>("/api/jobs", ask);
  for (;;) {
    if (stop.aborted) {
      await call(`/api/jobs/${token}`, undefined, "DELETE");
      return null;
    }
    const status = await call<Status>(`/api/jobs/${token}`);
    told(status);
    if (status.state === "done") return status.answer as T;
    if (status.state === "cancelled") return null;
    if (status.state === "failed") throw new Refusal(status.error);
    await new Promise((resolve) => setTimeout(resolve, 200));
  }
}

export class Judge {
  readonly node = el("div", { class: "judge" });
  private stop: AbortController | null = null;
  private level = "standard";
  private results = new WeakMap<Design, { of: string; made: JudgeAnswer }>();
  private progress = el("div", { class: "progress" }, el("i"));
  private says = el("span");
  private waiting = 0;

  constructor(private store: Store) {
    for (const event of ["structure", "answer", "designs"] as const) store.on(event, () => this.build());
    store.on("rest", () => this.again());
  }

  /** What was said of the active design, or of what it was before it changed. */
  private get result(): { of: string; made: JudgeAnswer } | undefined {
    return this.results.get(this.store.design);
  }

  private get here(): string {
    return JSON.stringify(this.store.design.answer.tables);
  }

  build(): void {
    if (this.stop) return;
    const levels = el("select", { "aria-label": "Resolution", id: "level" }, ...words().levels.map((l) => el("option", { value: l }, l)));
    levels.value = this.level;
    levels.addEventListener("change", () => (this.level = levels.value));
    const children = [
      this.result ? null : el("p", {}, this.store.method === METHODS.fem
        ? "Finite elements solve the Stokes equations in this very channel. They take a minute or more, and they judge the surrogate."
        : "Boundary elements solve the Stokes equations about this very design. They take seconds, and they judge the surrogate."),
      el("div", { class: "ask" }, levels, el("button", { class: "primary", id: "ask-judge", onclick: () => this.ask() }, "Ask the judge")),
      ...(this.result ? this.table(this.result.made, this.result.of === this.here) : []),
    ];
    this.node.replaceChildren(...children.filter((c) => c !== null));
  }

  /** With the reference as the model that swims, a new design is judged when the hand rests. */
  private again(): void {
    window.clearTimeout(this.waiting);
    const { design, model } = this.store;
    if (model !== "bem" || this.store.snapshot || design.reference?.of === this.here) return;
    this.waiting = window.setTimeout(() => {
      this.stop?.abort();
      this.level = "coarse";
      void this.ask();
    }, 350);
  }

  async ask(): Promise<void> {
    const { design } = this.store;
    const of = this.here;
    const stop = (this.stop = new AbortController());
    const bar = this.progress.firstElementChild as HTMLElement;
    bar.style.width = "4%";
    this.says.textContent = "meshing …";
    this.node.replaceChildren(
      el("div", { class: "working" }, this.progress, this.says,
        el("button", { id: "cancel-judge", onclick: () => stop.abort() }, "Cancel")));
    const told = (s: Status): void => {
      bar.style.width = `${Math.max(4, (100 * s.done) / s.total)}%`;
      this.says.textContent = `${s.done} of ${s.total} steps, ${s.seconds.toFixed(1)} s`;
    };
    const made = await attempt(() => job<JudgeAnswer>({ kind: "judge", tables: JSON.parse(of), level: this.level }, told, stop.signal));
    if (this.stop !== stop) return;
    this.stop = null;
    if (made) {
      this.results.set(design, { of, made });
      design.reference = { answer: made.answer, of, circle: made.circle };
    } else if (stop.signal.aborted) notice("The judge was sent away.");
    this.store.tell("answer");
    this.build();
  }

  private table(made: JudgeAnswer, fresh: boolean): HTMLElement[] {
    const { dimensional } = this.store.design.answer;
    // both in the unit that suits the surrogate's number
    const cells = (r: Row): [string, string, string] => {
      const [n, unit] = reading(r.name, r.surrogate, dimensional);
      if (r.surrogate === 0) return [n, ...reading(r.name, r.reference, dimensional)];
      const shown = Number(n.replace("−", "-"));
      return [n, Number.isFinite(shown) ? digits((shown * r.reference) / r.surrogate) : digits(r.reference), unit];
    };
    const grade = (e: number | null): string =>
      e === null ? "" : Math.abs(e) < 0.05 ? "good" : Math.abs(e) < 0.2 ? "fair" : "poor";
    const percent = (e: number | null): string =>
      e === null ? "–" : Math.abs(e) < 5e-5 ? "0 %" : `${e >= 0 ? "+" : "−"}${digits(Math.abs(100 * e), 2)} %`;
    const rows = made.rows.filter((r) => r.name !== "forward_velocity").map((r) =>
      el("tr", { "data-row": r.name },
        el("td", {}, called(r.name).label, el("small", {}, ` ${cells(r)[2]}`)), el("td", {}, cells(r)[0]), el("td", {}, cells(r)[1]),
        el("td", { class: grade(r.error) }, percent(r.error))));
    const fit = made.calibration;
    const phases = made.phases === 0 ? "finite elements" : made.phases === 1 ? "one phase" : `${made.phases} phases`;
    const about = `${made.unknowns} unknowns, ${phases}, ${made.level}`;
    const parts: HTMLElement[] = [
      el("table", { id: "verdict", class: fresh ? "" : "stale" },
        el("thead", {}, el("tr", {}, ...["", "surrogate", "judge", "error"].map((h) => (h ? el("th", {}, h) : el("td"))))),
        el("tbody", {}, ...rows)),
    ];
    if (fit.error) parts.push(el("p", { class: "fine" }, `No calibration here: ${fit.error}`));
    else if (fresh) {
      const names = Object.entries(fit.coefficients).map(([k, v]) => `${k} ${digits(v)}`).join(",  ");
      parts.push(
        el("button", { class: "primary wide", id: "calibrate", title: names, onclick: () => this.calibrate(made) }, "Calibrate the surrogate here"),
        el("p", { class: "fine" }, `Sets ${names}.`),
        ...fit.warnings.map((w) => el("p", { class: "fine warn" }, w)));
    }
    if (made.circle && fresh) parts.push(el("p", { class: "fine", id: "circle" }, this.circle(made.circle)));
    parts.push(el("p", { class: "fine" }, fresh ? about : "The design has changed since the judge was asked."));
    return parts;
  }

  /** Where the pose leads beside a wall. */
  private circle({ radius, sense, towards }: Circle): string {
    const { dimensional } = this.store.design.answer;
    const r = dimensional ? withPrefix(radius, "m").join(" ") : digits(radius);
    const way = towards > 0 ? "It is drawn to the wall" : "It is driven from the wall";
    return `While it keeps this pose it goes round a circle of radius ${r}, ${sense} seen from above the wall: the ring in the scene. ${way}; Path says where that ends.`;
  }

  private calibrate(made: JudgeAnswer): void {
    const { store } = this;
    store.replace(made.calibration.tables);
    const marked = store.design;
    const of = JSON.stringify(made.calibration.tables);
    this.results.set(marked, { of, made: { ...made, rows: made.calibration.rows } });
    marked.reference = { answer: made.answer, of, circle: made.circle };
    notice("Calibrated at this design; the table says what agrees with the judge and what does not.");
  }
}

/** The flow about two swimmers where they are now on a path of theirs, each in that of the other. */
export function askFlowOfBoth(store: Store, poses: Pose[], told: (s: Status) => void, stop: AbortSignal): Promise<FlowAnswer | null> {
  const members = store.designs.map(({ answer: { tables } }, i) => ({ tables, position: poses[i].x, quaternion: poses[i].q, phase: poses[i].phase }));
  return job<FlowAnswer>({ kind: "pair_flow", members, time: poses[0].time }, told, stop);
}

/** The flow about the design, from boundary elements. */
export function askFlow(store: Store, told: (s: Status) => void, stop: AbortSignal): Promise<FlowAnswer | null> {
  return job<FlowAnswer>({ kind: "flow", tables: store.design.answer.tables }, told, stop);
}
