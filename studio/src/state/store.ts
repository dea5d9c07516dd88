// What the page holds: one or two designs with their histories, and who listens to changes.

import { Latest, Refusal, call } from "./api";
import { clone } from "./dom";
import { write, type Range } from "./fields";
import { learn } from "./words";
import type { Answer, Circle, Place, Scene, Snapshot, Tables, Value } from "./types";

export interface Reference {
  answer: Answer;
  /** the tables that were judged */
  of: string;
  circle: Circle | null;
}

export interface Design {
  name: string;
  tables: Tables;
  answer: Answer;
  committed: Tables;
  past: Tables[];
  future: Tables[];
  problem: string | null;
  reference: Reference | null;
  /** where its sliders run, by field */
  ranges: Map<string, Range>;
  latest: Latest<Ask, Answer>;
}

interface Ask {
  tables: Tables;
  adopt: boolean;
}

export type Event = "opened" | "tables" | "answer" | "structure" | "designs" | "problem" | "rest";

/** Who judges: boundary elements know a wall, finite elements a channel. */
export const METHODS = { bem: "Boundary elements", fem: "Finite elements" };

/** What answers by itself: the correction of many solves, resistive force theory, the same about a tail that bends. */
const OURS: Record<string, string> = { atlas: "Atlas", rft: "Surrogate", elastic: "Elastic tail" };

export class Store {
  designs: Design[] = [];
  active = 0;
  model: "rft" | "bem" = "rft";
  readonly snapshot: Snapshot | null;
  /** milliseconds from a slider's move to numbers on the page */
  lag = 0;
  private listeners: [Event, () => void][] = [];
  private resting = 0;

  constructor() {
    const data = document.getElementById("snapshot");
    this.snapshot = data ? (JSON.parse(data.textContent!) as Snapshot) : null;
    if (this.snapshot) learn(this.snapshot.words);
  }

  on(event: Event, listener: () => void): void {
    this.listeners.push([event, listener]);
  }

  tell(...events: Event[]): void {
    for (const [event, listener] of this.listeners) if (events.includes(event)) listener();
  }

  get design(): Design {
    return this.designs[this.active];
  }

  /** What answers the active design where the reference does not. */
  get ours(): string {
    return this.design ? this.oursOf(this.design) : OURS.rft;
  }

  oursOf(design: Design): string {
    return OURS[design.answer.gait.model] ?? OURS.rft;
  }

  /** The reference's method for the active design. */
  get method(): string {
    return this.design ? this.methodOf(this.design) : METHODS.bem;
  }

  methodOf({ answer: { around } }: Design): string {
    return around && around.kind !== "wall" ? METHODS.fem : METHODS.bem;
  }

  /** What is shown of a design: the surrogate's answer or the reference's. */
  shown(design: Design): Answer {
    const reference = this.judged(design);
    return this.model === "bem" && reference ? { ...design.answer, ...reference.answer, tables: design.answer.tables } : design.answer;
  }

  /** The reference's answer about a design as it is, if it was asked. */
  judged(design: Design): Reference | null {
    const { reference } = design;
    return reference && reference.of === JSON.stringify(design.answer.tables) ? reference : null;
  }

  make(name: string, answer: Answer): Design {
    const tables = clone(answer.tables);
    const design: Design = {
      name, answer, tables, committed: clone(tables), past: [], future: [],
      problem: null, reference: null, ranges: new Map(), latest: null as unknown as Design["latest"],
    };
    let sent = 0;
    design.latest = new Latest<Ask, Answer>(
      (ask) => {
        sent = performance.now();
        return call<Answer>("/api/solve", { tables: ask.tables, name: design.name });
      },
      (made, ask, newest) => {
        this.lag = performance.now() - sent;
        design.answer = made;
        design.problem = null;
        if (ask.adopt && newest) {
          design.tables = clone(made.tables);
          design.committed = clone(made.tables);
          this.tell("structure");
        }
        this.tell("answer", "problem");
      },
      (error) => {
        design.problem = error.message;
        this.tell("problem");
      },
    );
    return design;
  }

  /** Change one or more fields of the active design; `commit` ends the gesture. */
  edit(changes: Record<string, Value>, commit: boolean, adopt = false): void {
    const { design } = this;
    for (const [path, value] of Object.entries(changes)) write(design.tables, path, value);
    if (commit) this.commit();
    this.solve(adopt);
    this.tell("tables");
  }

  commit(): void {
    const { design } = this;
    if (JSON.stringify(design.tables) === JSON.stringify(design.committed)) return;
    design.past.push(design.committed);
    design.committed = clone(design.tables);
    design.future = [];
    this.tell("tables");
  }

  /** Put a value with a unit of its own into a field, as a spec file may have it. */
  async put(path: string, text: string): Promise<void> {
    const tables = clone(this.design.tables);
    write(tables, path, text);
    const made = await call<Answer>("/api/solve", { tables, name: this.design.name });
    this.replace(made.tables);
  }

  /** Another design in place of the active one, once it is solved; whether it can be is told by the promise. */
  async take(name: string, tables: Tables, signal?: AbortSignal): Promise<boolean> {
    const made = await call<Answer>("/api/solve", { tables, name }, undefined, signal).catch((error: Error) => {
      if (signal?.aborted) return null;
      throw error;
    });
    if (!made) return false;
    const old = this.design;
    this.open(name, made);
    this.design.past.push(old.committed);
    this.tell("tables");
    return true;
  }

  /** Put other tables in place of the active design's, as one step that can be undone. */
  replace(tables: Tables): void {
    const { design } = this;
    design.past.push(design.committed);
    design.committed = clone(tables);
    design.tables = clone(tables);
    design.future = [];
    this.solve(true);
    this.tell("structure", "tables");
  }

  undo(): void {
    this.travel("past", "future");
  }

  redo(): void {
    this.travel("future", "past");
  }

  private travel(from: "past" | "future", to: "past" | "future"): void {
    const { design } = this;
    const tables = design[from].pop();
    if (!tables) return;
    design[to].push(design.committed);
    design.committed = clone(tables);
    design.tables = clone(tables);
    this.solve();
    this.tell("structure", "tables");
  }

  solve(adopt = false): void {
    if (this.snapshot) return;
    const { design } = this;
    design.latest.send({ tables: clone(design.tables), adopt });
    window.clearTimeout(this.resting);
    this.resting = window.setTimeout(() => this.tell("rest"), 140);
  }

  /** Put a design in place of the active one; alone where it was put beside another, or cannot be compared with it. */
  open(name: string, answer: Answer): void {
    const others = this.designs.filter((_, i) => i !== this.active);
    const sizeless = others.some((d) => d.answer.dimensional !== answer.dimensional);
    if (sizeless) notice("One has units and the other none: they cannot be compared, so the new one stands alone.");
    if (sizeless || this.scene) {
      this.designs = [this.design];
      this.active = 0;
      this.scene = "";
    }
    this.designs[this.active] = this.make(name, answer);
    this.tell("designs", "structure", "answer", "tables", "problem", "rest", "opened");
  }

  /** A spec or a scene of two, as text. */
  async load(name: string, text: string): Promise<void> {
    if (!/^\s*\[\[\s*swimmer\s*\]\]/m.test(text)) {
      const made = await call<Answer>("/api/spec", text);
      return this.open(name, made);
    }
    const { designs, places } = await call<Scene>("/api/scene", text);
    this.designs = designs.map((d) => this.make(d.name, d.answer));
    this.active = 0;
    this.scene = name;
    this.tell("designs", "structure", "answer", "tables", "problem", "rest", "opened");
    for (const put of this.placed) put(places);
  }

  /** the scene that the designs were put into, if they are not compared by hand */
  scene = "";
  private placed: ((places: Place[]) => void)[] = [];

  /** Who is told where a scene puts its two designs. */
  onScene(put: (places: Place[]) => void): void {
    this.placed.push(put);
  }
}

let shelf: HTMLElement | null = null;

/** A readable notice that goes away by itself; errors stay longer. */
export function notice(message: string, kind: "info" | "error" = "info"): void {
  shelf ??= document.body.appendChild(Object.assign(document.createElement("div"), { id: "notices" }));
  const node = document.createElement("div");
  node.className = `notice ${kind}`;
  node.setAttribute("role", kind === "error" ? "alert" : "status");
  node.textContent = message;
  const close = document.createElement("button");
  close.textContent = "×";
  close.title = "Dismiss";
  close.onclick = () => node.remove();
  node.append(close);
  shelf.append(node);
  while (shelf.children.length > 3) shelf.firstElementChild!.remove();
  setTimeout(() => node.remove(), kind === "error" ? 12000 : 5000);
}

export async function attempt<T>(work: () => Promise<T>): Promise<T | undefined> {
  try {
    return await work();
  } catch (error) {
    const message = error instanceof Refusal || error instanceof Error ? error.message : String(error);
    notice(message, "error");
    return undefined;
  }
}
