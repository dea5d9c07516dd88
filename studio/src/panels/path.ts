// Where it goes: the path of a design under all that its spec says, or two designs in one flow.

import { digits, el, reading, withPrefix } from "../state/dom";
import { attempt, notice, type Store } from "../state/store";
import type { PathAnswer, Place, Tables } from "../state/types";
import { job, type Status } from "./judge";

const TURNS = [100, 300, 1000, 3000];
const TURNS_OF_TWO = [10, 20, 40, 100, 200];
/** tables whose change leaves the poses beside a wall as they are */
const LOADS = ["wall", "flow", "field", "gravity", "noise", "magnet"];
const ENDS: Record<string, string> = {
  free: "never comes near", touched: "touches", escaped: "swims away", orbits: "stays, goes round", trapped: "stays",
};

export class Paths {
  readonly node = el("div", { class: "judge", id: "path" });
  made: PathAnswer | null = null;
  /** how two designs are put into one flow; the first at the origin of its own axes */
  private place = { ahead: 0, apart: 1.2, phase: 0, first: 0, against: false, turned: null as Place | null };
  private of = "";
  private stop: AbortController | null = null;
  private progress = el("div", { class: "progress" }, el("i"));
  private says = el("span");
  /** of the motor; 0: as many as suit the design */
  private turns = { one: 0, two: 20 };
  private some = true;
  private waiting = 0;

  constructor(private store: Store, private show: (made: PathAnswer | null) => void) {
    store.on("designs", () => { // first, since what is on show is of other designs
      this.stop?.abort();
      this.leave();
    });
    for (const event of ["structure", "designs"] as const) store.on(event, () => this.build());
    store.on("answer", () => this.changed());
    store.on("rest", () => this.again());
  }

  private get two(): boolean {
    return this.store.designs.length > 1;
  }

  /** What a path is of. */
  private get here(): string {
    return JSON.stringify(this.store.designs.map((d) => d.answer.tables));
  }

  /** What its poses are of: minutes, where that is beside a wall or in a tube. */
  private get poses(): string {
    const { around, tables } = this.store.design.answer;
    if (!around) return "";
    const kept = Object.entries(tables as Record<string, unknown>).filter(([part]) => !LOADS.includes(part));
    return JSON.stringify([this.some, ...kept.map(([part, t]) => (part === "channel" ? (t as Tables[string]).diameter : t))]);
  }

  private solved = "";

  /** Put two designs as a scene has them. */
  put(places: Place[]): void {
    const [a, b] = places;
    const [x, y, z] = b.position;
    const size = this.length;
    this.place = { ahead: -x / size, first: a.phase, apart: Math.hypot(y, z) / size, phase: (b.phase * 180) / Math.PI, against: b.direction[0] < 0, turned: b };
    this.build();
  }

  private get length(): number {
    return Math.max(...this.store.designs.map(({ answer: { shape } }) => shape.length + 2 * shape.semi_axes[0]));
  }

  build(): void {
    if (this.stop) return;
    const { two, store } = this;
    const { around } = store.design.answer;
    const many = el("select", { id: "turns", "aria-label": "For how long" },
      ...(two ? TURNS_OF_TWO : TURNS).map((n) => el("option", { value: n }, `${n} turns`)));
    many.value = String(two ? this.turns.two : this.longest);
    many.addEventListener("change", () => (this.turns[two ? "two" : "one"] = Number(many.value)));
    const poses = el("select", { id: "poses", "aria-label": "How many poses are solved" }, el("option", { value: "some" }, "some 170 poses"), el("option", { value: "all" }, around?.kind === "wall" ? "1,100 poses" : "620 poses"));
    poses.value = this.some ? "some" : "all";
    poses.addEventListener("change", () => (this.some = poses.value === "some"));
    const what = two ? "Both designs in one fluid: each swims in the flow of the other, by the point forces that its boundary elements have alone."
      : around ? `Where it goes ${around.kind === "wall" ? "beside the wall" : "in the tube"}. First poses are solved by boundary elements, which takes minutes, once: they are kept, and another distance or tilt costs none.`
      : "Where it goes under all that its spec says: motor, field, gravity, flow and noise.";
    this.node.replaceChildren(
      ...(this.made ? [] : [el("p", {}, what)]),
      ...(two ? this.placing() : []),
      el("div", { class: "ask" }, many, around && !two ? poses : null, el("button", { class: "primary", id: "ask-path", onclick: () => this.ask() }, two ? "Follow both" : "Follow it")),
      ...(this.made ? this.told(this.made) : []));
  }

  private get longest(): number {
    return this.turns.one || (this.store.design.answer.around ? 1000 : 300);
  }

  private placing(): HTMLElement[] {
    const row = (id: "ahead" | "apart" | "phase", text: string, low: number, high: number, unit: string): HTMLElement => {
      const track = el("input", { type: "range", min: low, max: high, step: (high - low) / 200, id: `place-${id}`, "aria-label": text });
      const value = el("span", { class: "value plain" });
      const say = (): void => {
        track.value = String(this.place[id]);
        track.style.setProperty("--at", `${(100 * (this.place[id] - low)) / (high - low)}%`);
        value.textContent = `${digits(this.place[id], 2)}${unit}`;
      };
      track.addEventListener("input", () => {
        this.place[id] = Number(track.value);
        say();
      });
      track.addEventListener("change", () => this.changed(true));
      say();
      return el("div", { class: "row" }, el("label", {}, text), value, track);
    };
    const way = (against: boolean, text: string): HTMLElement => el("button", {
      type: "button", "aria-pressed": String(this.place.against === against), onclick: () => {
        if (this.place.against !== against) Object.assign(this.place, { against, turned: null });
        this.build();
        this.changed(true);
      },
    }, text);
    return [
      row("apart", "B apart from A", 0.8, 4, " lengths"), row("ahead", "B ahead of A", -2, 2, " lengths"), row("phase", "B's tail before A's", 0, 360, "°"),
      el("div", { class: "row choice" }, el("label", {}, "B swims"), el("div", { class: "segments" }, way(false, "with A"), way(true, "against A"))),
    ];
  }

  /** Where each of the two is put. */
  private get members(): Record<string, unknown>[] {
    const { ahead, apart, phase, first, against, turned } = this.place;
    const [, y, z] = turned?.position ?? [0, 0, -1];
    const far = Math.hypot(y, z) || 1;
    const side = turned && Math.hypot(y, z) ? [y / far, z / far] : [0, -1];
    const size = this.length;
    const direction = turned?.direction ?? [against ? -1 : 1, 0, 0];
    const b = { position: [-ahead * size, apart * side[0] * size, apart * side[1] * size], direction, roll: turned?.roll ?? 0, phase: (phase * Math.PI) / 180 };
    return this.store.designs.map(({ answer: { tables } }, i) => (i ? { tables, ...b } : { tables, phase: first }));
  }

  /** The path on show belongs to another design, or to another place. */
  private changed(moved = false): void {
    if (!this.made || (!moved && this.of === this.here)) return;
    this.leave(true);
    this.again(moved); // the hand may have rested before the answer came
  }

  /** Back to swimming by the gait. */
  leave(again = false): void {
    this.wanted = again;
    if (!this.made) return;
    this.made = null;
    this.show(null);
    this.build();
  }

  /** whether a path was on show before the design changed */
  private wanted = false;

  /** Another path as the hand rests, where its poses are there already. */
  private again(now = false): void {
    window.clearTimeout(this.waiting);
    if (!this.wanted || (!this.two && this.solved !== this.poses)) return;
    this.waiting = window.setTimeout(() => {
      this.stop?.abort();
      void this.ask();
    }, now ? 0 : 350);
  }

  async ask(): Promise<void> {
    const { store, two } = this;
    const [of, poses] = [this.here, this.poses];
    const stop = (this.stop = new AbortController());
    const bar = this.progress.firstElementChild as HTMLElement;
    bar.style.width = "2%";
    this.says.textContent = "starting …";
    this.node.replaceChildren(el("div", { class: "working" }, this.progress, this.says,
      el("button", { id: "cancel-path", onclick: () => stop.abort() }, "Cancel")));
    const told = (s: Status): void => {
      const share = s.done / s.total;
      bar.style.width = `${Math.max(2, 100 * share)}%`;
      const left = s.seconds > 5 && share > 0.01 && share < 1 ? `, about ${time((s.seconds * (1 - share)) / share)} left` : "";
      const counted = two ? `${Math.round(100 * share)} %` : s.total > 1 ? `${s.done} of ${s.total} poses` : "following it";
      this.says.textContent = `${share >= 1 ? "following it" : counted}, ${time(s.seconds)}${left}`;
    };
    const question = two ? { kind: "together", members: this.members, turns: this.turns.two } : { kind: "path", tables: store.design.answer.tables, turns: this.longest, poses: this.some ? "some" : "all" };
    const made = await attempt(() => job<PathAnswer>(question, told, stop.signal));
    if (this.stop !== stop) return;
    this.stop = null;
    if (made && of === this.here) {
      Object.assign(this, { made, of, solved: poses, wanted: true });
      this.show(made);
      window.setTimeout(() => this.node.querySelector("#went")?.scrollIntoView({ block: "nearest" }));
    } else if (stop.signal.aborted && of === this.here) notice("Stopped. What was solved is kept: asked again it goes on from there.");
    this.build();
    if (of !== this.here) this.again(); // the answer to the last change came after the path was asked for
  }

  private told({ numbers: n, expected_error: errors }: PathAnswer): HTMLElement[] {
    const { dimensional, around } = this.store.design.answer;
    const length = (v: unknown): string => (typeof v !== "number" ? "–" : dimensional ? withPrefix(v, "m").join(" ") : digits(v));
    const speed = (v: unknown): string => reading("swimming_speed", v as number | null, dimensional).join(" ");
    const error = (e: number | undefined): string => (e === undefined ? "" : ` ± ${digits(100 * e, 2)} %`);
    const rows: [string, string, string][] = [];
    const row = (key: string, text: string, value: string): number => rows.push([key, text, value]);
    if (this.two) {
      const [speeds, alone] = [n.speeds as number[], n.alone as number[]];
      speeds.forEach((v, i) => row(`speed-${i}`, `${"AB"[i]} in company`, `${speed(v)}${error(errors.us)}`));
      alone.forEach((v, i) => row(`alone-${i}`, `${"AB"[i]} alone`, speed(v)));
      row("apart", "Apart at the end", length(n.apart));
    } else {
      row("speed", "Speed along its path", speed(n.speed));
      if (around) row("outcome", around.kind === "wall" ? "Beside the wall it" : "In the tube it", ENDS[String(n.outcome)] ?? String(n.outcome));
      if (typeof n.circle_radius === "number") {
        row("circle", around && around.kind !== "wall" ? "Winds about the axis at" : "Circle of radius", length(n.circle_radius));
        row("sense", around?.kind === "wall" ? "Seen from above the wall" : "Seen against the axis", String(n.circle_sense));
      }
      if (around) row("gap", "Gap to it, mean", length(n.gap_mean));
    }
    const sure = this.two ? "± is what the estimate leaves out: the flow that comes back from the other."
      : errors.us !== undefined ? `Between the poses solved velocities are off, in 95 % of poses that were left out, by no more than ${missed(errors)} of those in free fluid.`
      : "By the same gait as the numbers above, with its error.";
    return [
      el("dl", { class: "list", id: "went" }, ...rows.flatMap(([key, text, value]) => [el("dt", {}, text), el("dd", { "data-went": key }, value)])),
      el("p", { class: "fine" }, `${n.turns} turns of the ${this.store.design.answer.gait.rate ? "motor" : "field"}. ${sure}`),
      el("button", { class: "wide", id: "leave-path", onclick: () => this.leave() }, "Leave the path"),
    ];
  }
}

/** Errors of velocities as a sentence has them: along the axis, across it, of turning. */
const missed = (e: Record<string, number>): string =>
  `${digits(100 * e.us, 2)} % along its axis, ${digits(100 * Math.max(e.uq, e.ur), 2)} % across, ${digits(100 * Math.max(e.os, e.oq, e.or), 2)} % in turning`;

/** Seconds as people say them. */
const time = (s: number): string => (s < 90 ? `${Math.round(s)} s` : `${Math.round(s / 60)} min`);
