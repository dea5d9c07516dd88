// On a narrow screen the scene comes first: one panel at a time rises over it, the number stays in sight.

import { el } from "../state/dom";
import type { Answers } from "./answers";
import type { Stage } from "../scene/stage";
import type { Store } from "../state/store";

/** Where panels become sheets; as in style.css. */
export const NARROW = "(max-width: 900px), (max-height: 480px)";

/** Pixels that the panels of a wide screen cover at the left and at the right; as in style.css. */
const PANELS = [278, 314];

/** Pixels at the top of a narrow screen that the bar and the number cover. */
const ABOVE = 96;

export class Sheets {
  readonly glance = el("button", { class: "glance", id: "glance", title: "All numbers", onclick: () => this.open("numbers") });
  readonly node = el("nav", { class: "dock", "aria-label": "Panels" });
  private narrow = window.matchMedia(NARROW);

  /** `tabs` opens the part of the right panel of that name. */
  constructor(private store: Store, private answers: Answers, private driven: () => HTMLElement | null, private stage: Stage, private tabs: { open: (key: string) => void; keys: string[] }) {
    const names: Record<string, string> = { design: "Design", numbers: "Numbers", map: "Map", judge: "Judge", path: "Path", drive: "Drive" };
    for (const key of ["design", "numbers", ...tabs.keys]) {
      this.node.append(el("button", { id: `sheet-${key}`, "aria-pressed": "false", onclick: () => this.open(key) }, names[key]));
    }
    for (const event of ["answer", "designs", "structure"] as const) {
      store.on(event, () => this.tell());
    }
    this.narrow.addEventListener("change", () => this.beside());
    this.beside();
    document.addEventListener("keydown", (e) => {
      if (e.key === "Escape") this.open("");
    });
    stage.onTouch(() => this.open(""));
  }

  /** Panels beside the scene on a wide screen, none over it on a narrow one. */
  private beside(): void {
    this.open("");
    const [left, right] = this.narrow.matches ? [0, 0] : PANELS;
    this.stage.between(left, right);
  }

  /** Speed and trust in sight: of what swims by its motor, or of what a field drives. */
  tell(): void {
    const by = this.driven();
    this.glance.replaceChildren(...(by ? [by, this.answers.trust(this.store.design), ...this.answers.missed(this.store.design, "")] : this.answers.glance()));
  }

  /** Raise one sheet; the one that is up, or none by name, goes down. */
  open(key: string): void {
    const { body } = document;
    const up = key && this.narrow.matches && body.dataset.sheet !== key;
    if (up) body.dataset.sheet = key;
    else delete body.dataset.sheet;
    if (up && this.tabs.keys.includes(key)) this.tabs.open(key);
    for (const b of this.node.children) b.setAttribute("aria-pressed", String(Boolean(up) && b.id === `sheet-${key}`));
    const tall = window.innerHeight > window.innerWidth;
    this.stage.uncover(up && !tall ? 0.6 : 1, up && tall ? 0.48 + ABOVE / window.innerHeight : 1);
  }
}
