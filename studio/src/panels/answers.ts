// The right panel, upper half: the numbers, and how far they can be trusted.

import { digits, el, reading } from "../state/dom";
import { called } from "../state/words";
import type { Design, Store } from "../state/store";
import type { Answer, PathAnswer } from "../state/types";

const LISTED = ["swimming_speed", "forward_velocity", "path_speed", "body_rate_hz", "lateral_amplitude", "path_radius", "efficiency", "mean_torque", "mean_power"];

export class Answers {
  readonly node = el("section", { class: "answers" });

  /** the path on show, where it was solved along its way: what answered it leads here */
  private went: PathAnswer | null = null;

  constructor(private store: Store) {
    for (const event of ["answer", "designs", "structure"] as const) store.on(event, () => this.show());
  }

  /** A path that is on show; null: its own gait again. */
  follow(made: PathAnswer | null): void {
    this.went = made && this.store.designs.length === 1 && this.store.design.answer.around ? made : null;
    this.show();
  }

  show(): void {
    const { store } = this;
    const many = store.designs.length > 1;
    this.node.replaceChildren(
      many ? this.heads() : this.hero(),
      ...this.store.designs.flatMap((d, i) => [
        this.trust(d, i === this.store.active ? "trust" : undefined, many ? `${"AB"[i]}: ` : ""), ...(many ? this.missed(d, `${"AB"[i]}: `) : this.missed(d, "", "missed")),
      ]),
      ...(this.went ? [this.line(this.answered(this.store.design), "gait-trust", "Its gait, below. ")] : []),
      ...this.better(),
      this.remarks(),
      el("dl", { class: many ? "list two" : "list" }, ...this.listed(many).flatMap((n) => this.row(n))),
    );
  }

  /** What stands in the list: all of two designs, of one what does not stand above it. */
  private listed(many: boolean): string[] {
    if (many || this.went) return [LISTED[0], "body_lengths_per_time", ...LISTED.slice(1)];
    const first = leading(this.store.shown(this.store.design));
    return LISTED.filter((n) => n !== first);
  }

  /** Speed along the path on show, as a number and its unit. */
  private speed(made: PathAnswer): string[] {
    return reading("path_speed", made.numbers.speed as number, this.store.design.answer.dimensional);
  }

  private hero(): HTMLElement {
    if (this.went) {
      const [n, unit] = this.speed(this.went);
      return el("div", { class: "hero", id: "went-speed", title: "Of the path on show, by the poses solved along it" },
        el("div", { class: "caption" }, "Speed along its path"), el("div", { class: "figure" }, el("span", {}, n), el("small", {}, unit)));
    }
    const answer = this.store.shown(this.store.design);
    const r = answer.readings;
    const first = leading(answer);
    const [n, unit] = reading(first, r[first], answer.dimensional);
    const [l] = reading("body_lengths_per_time", r.body_lengths_per_time, answer.dimensional);
    const caption = el("div", { class: "caption" }, called(first).label);
    if (answer.shape.length === 0) {
      return el("div", { class: "hero" }, el("div", { class: "caption" }, "Nothing propels it: a field can, in Drive"));
    }
    const figure = el("div", { class: "figure" },
      el("span", { "data-reading": first, "data-value": String(r[first]) }, n),
      el("small", {}, unit, answer === this.store.design.answer ? this.off(answer, first) : null));
    if (first !== "swimming_speed") return el("div", { class: "hero", title: called(first).meaning }, caption, figure);
    return el("div", { class: "hero", title: called(first).meaning }, caption, figure,
      el("div", { class: "under" },
        el("b", { "data-reading": "body_lengths_per_time", "data-value": String(r.body_lengths_per_time) }, l),
        answer.dimensional ? " body lengths per second" : " body lengths per unit time",
        answer.leading_end === "tail" ? el("span", { id: "backwards" }, ", tail first") : null));
  }

  private heads(): HTMLElement {
    const heads = this.store.designs.map((d, i) =>
      el("button", {
        class: `head design${i}`, "aria-pressed": String(i === this.store.active), title: "Edit this one",
        onclick: () => {
          this.store.active = i;
          this.store.tell("designs", "structure", "tables", "answer", "problem", "rest");
        },
      }, el("i"), `${"AB"[i]}  ${d.name}`));
    return el("div", { class: "heads" }, el("span", { class: "caption" }, "Compare"), ...heads);
  }

  /** Expected error of a reading, where it is as far off as a velocity. */
  private off(answer: Answer, name: string): HTMLElement | null {
    const error = answer.readings[name] ? answer.errors[name] : null;
    return error ? el("small", { class: "off", title: answer.how }, ` ± ${digits(100 * error, 2)} %`) : null;
  }

  private row(name: string): HTMLElement[] {
    const cells = this.store.designs.map((d) => {
      const answer = this.store.shown(d);
      const value = answer.readings[name];
      const [n, unit] = reading(name, value, answer.dimensional);
      const beside = answer === d.answer ? this.off(answer, name) : null;
      return el("dd", { "data-reading": name, "data-value": String(value) }, n, unit ? el("small", {}, ` ${unit}`) : null, beside);
    });
    return [el("dt", { title: called(name).meaning }, called(name).label), ...cells];
  }

  /** What the answer on show says of its swimmer, in physical words. */
  private remarks(): HTMLElement {
    const { remarks, notes } = this.store.shown(this.store.design);
    const { calibration } = this.store.design.answer;
    const whence = this.store.model === "bem" ? [] : (calibration?.lines.slice(0, 1) ?? []);
    const said = [...new Set([...whence, ...remarks, ...notes])];
    return el("ul", { class: "remarks", id: "remarks", hidden: said.length === 0 }, ...said.map((r) => el("li", {}, r)));
  }

  /** Speed and trust in a line, for a screen that has no room for more. */
  glance(): HTMLElement[] {
    const { store } = this;
    if (this.went) return [el("b", {}, this.speed(this.went).join(" ")), this.trust(store.design)];
    const many = store.designs.length > 1;
    return store.designs.flatMap((d, i) => {
      const answer = store.shown(d);
      const first = leading(answer);
      const [n, unit] = reading(first, answer.readings[first], answer.dimensional);
      const back = first === "swimming_speed" && answer.leading_end === "tail" ? "tail first" : "";
      const name = many ? back : [called(first).label.toLowerCase(), back].filter(Boolean).join(", ");
      return [el("b", {}, many ? el("small", {}, `${"AB"[i]} `) : null, n, unit ? el("small", {}, ` ${unit}`) : null), name ? el("small", {}, name) : null, this.trust(d), ...this.missed(d, "")];
    }).filter((e) => e !== null);
  }

  /** Which model answered a design, how far off it is and whether it is asked where it holds, in colour. */
  trust(design: Design, id?: string, before = ""): HTMLElement {
    return this.line(this.trusted(design), id, before);
  }

  private line({ grade, text, title }: Trust, id?: string, before = ""): HTMLElement {
    return el("div", { class: `trust ${grade}`, id, title }, el("i"), before + text);
  }

  /** What its calibration did not make agree, where that was at this design: as plain as what it did. */
  missed(design: Design, before: string, id?: string): HTMLElement[] {
    const { calibration } = design.answer;
    if (this.store.model === "bem" || !calibration?.here) return [];
    const off = Object.entries(calibration.missed);
    if (!off.length) return [];
    const said = off.map(([what, by]) => `${what} ${by < 0 ? "−" : "+"}${digits(Math.abs(100 * by), 2)} %`);
    const worst = Math.max(...off.map(([, by]) => Math.abs(by)));
    return [el("div", { class: `trust ${worst < 0.2 ? "fair" : "poor"}`, id }, el("i"), `${before}Not matched: ${said.join(", ")}`)];
  }

  /** The atlas, one click away, where a law or coefficients of the spec answer what it knows. */
  private better(): HTMLElement[] {
    const { store } = this;
    const { answer } = store.design;
    if (!answer.atlas_knows || store.model === "bem" || store.snapshot || this.went) return [];
    const take = (): void => {
      const { coefficients, interaction, calibration, ...bare } = store.design.tables;
      store.replace(bare);
    };
    return [el("button", { class: "wide", id: "by-atlas", title: "Takes the law and the coefficients out of this design; undo puts them back", onclick: take }, "Answer by the atlas instead")];
  }

  /** A design in two lines: how fast by what, by its motor or as a field drives it, and how sure that is. */
  told(design: Design, driven: string | null = null): { text: string; trust: string } {
    if (this.went) return { text: `${design.name}: speed along its path ${this.speed(this.went).join(" ")}`, trust: this.trusted(design).text };
    if (driven) return { text: `${design.name}: ${driven}`, trust: this.trusted(design).text };
    const answer = this.store.shown(design);
    const first = leading(answer);
    const value = reading(first, answer.readings[first], answer.dimensional).filter(Boolean).join(" ");
    return { text: `${design.name}: ${called(first).label.toLowerCase()} ${value}`, trust: this.trusted(design).text };
  }

  private trusted(design: Design): Trust {
    if (!this.went) return this.answered(design);
    const off = Math.max(...Object.values(this.went.expected_error));
    return {
      grade: off < 0.05 ? "good" : off < 0.2 ? "fair" : "poor", text: `Boundary elements at poses${off > 0 ? `: ± ${digits(100 * off, 2)} % between` : ""}`,
      title: "Of velocities in free fluid; 95 % of poses that were left out lie within.",
    };
  }

  /** The same of its gait, by what answers here without a path. */
  private answered(design: Design): Trust {
    const { store } = this;
    if (store.model === "bem") {
      const method = store.methodOf(design);
      if (store.shown(design) === design.answer) return { grade: "open", text: `${method}: asking the judge …` };
      return { grade: "good", text: `${method}${design.answer.around ? " at the starting pose" : ""}` };
    }
    const { around, expected_error: error, how, region, calibration: made } = design.answer;
    const who = store.oursOf(design);
    if (around && !made?.here) {
      const what = around.kind === "wall" ? "wall" : "channel";
      return {
        grade: "poor", text: `${who}: knows nothing of the ${what}`,
        title: "Local resistance is that of free fluid; ask the judge, then calibrate here.",
      };
    }
    if (error === null && region) return { grade: "fair", text: `${who}, outside its calibrated region` };
    const where = region || !made ? "" : `, calibrated at ${made.here ? "this" : "another"} design`;
    const title = [...(made?.lines ?? []), how].join("\n") || "No reference has been asked; ask the judge, then calibrate here.";
    if (design.answer.shape.length === 0) return { grade: "good", text: "A body alone: its own resistance", title };
    if (error === null) {
      const grade = !made ? "open" : made.here ? "good" : "fair";
      return { grade, text: `${who}${where || ", error not known here"}`, title };
    }
    const inside = region ? ", inside its region" : who === "Atlas" ? ", inside its range" : where;
    return { grade: error < 0.05 ? "good" : error < 0.2 ? "fair" : "poor", text: `${who}${inside}: expected error ${digits(100 * error, 2)} %`, title };
  }
}

type Grade = "good" | "fair" | "poor" | "open";

interface Trust {
  grade: Grade;
  text: string;
  title?: string;
}

/** The speed that says most: along the axis of its path; on a circle, where that is zero, along the path itself; beside
 * a wall, where no path is followed, that at the start. */
function leading({ readings: r }: Answer): string {
  if (r.swimming_speed === null || r.swimming_speed === undefined) return "forward_velocity";
  return r.swimming_speed < 1e-6 * (r.path_speed ?? 0) ? "path_speed" : "swimming_speed";
}
