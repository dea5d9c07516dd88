// The right panel, upper half: the numbers, and how far they can be trusted.

import { digits, el, reading } from "../state/dom";
import { called } from "../state/words";
import type { Store } from "../state/store";
import type { Answer } from "../state/types";

const LISTED = ["forward_velocity", "body_rate_hz", "lateral_amplitude", "path_radius", "efficiency", "mean_torque", "mean_power"];

export class Answers {
  readonly node = el("section", { class: "answers" });

  constructor(private store: Store) {
    for (const event of ["answer", "designs", "structure"] as const) store.on(event, () => this.show());
  }

  show(): void {
    const { store } = this;
    const many = store.designs.length > 1;
    this.node.replaceChildren(
      many ? this.heads() : this.hero(),
      this.trust(),
      this.remarks(),
      el("dl", { class: many ? "list two" : "list" }, ...(many ? ["swimming_speed", "body_lengths_per_time", ...LISTED] : LISTED).flatMap((n) => this.row(n))),
    );
  }

  private hero(): HTMLElement {
    const answer = this.store.shown(this.store.design);
    const r = answer.readings;
    const [n, unit] = reading("swimming_speed", r.swimming_speed, answer.dimensional);
    const [l] = reading("body_lengths_per_time", r.body_lengths_per_time, answer.dimensional);
    return el("div", { class: "hero", title: called("swimming_speed").meaning },
      el("div", { class: "caption" }, called("swimming_speed").label),
      el("div", { class: "figure" },
        el("span", { "data-reading": "swimming_speed", "data-value": String(r.swimming_speed) }, n),
        el("small", {}, unit, answer === this.store.design.answer ? this.off(answer, "swimming_speed") : null)),
      el("div", { class: "under" },
        el("b", { "data-reading": "body_lengths_per_time", "data-value": String(r.body_lengths_per_time) }, l),
        answer.dimensional ? " body lengths per second" : " body lengths per unit time",
        (r.forward_velocity ?? 0) < 0 ? el("span", { id: "backwards" }, ", tail first") : null));
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
    const said = [...new Set([...remarks, ...notes])];
    return el("ul", { class: "remarks", id: "remarks", hidden: said.length === 0 }, ...said.map((r) => el("li", {}, r)));
  }

  /** Speed and trust in a line, for a screen that has no room for more. */
  glance(): HTMLElement[] {
    const { store } = this;
    const speeds = store.designs.map((d) => {
      const answer = store.shown(d);
      const [n, unit] = reading("swimming_speed", answer.readings.swimming_speed, answer.dimensional);
      return el("b", {}, n, unit ? el("small", {}, ` ${unit}`) : null);
    });
    const trust = this.trust();
    trust.removeAttribute("id");
    return [...speeds, trust];
  }

  /** Expected error of the surrogate here, in colour. */
  private trust(): HTMLElement {
    const { design, model } = this.store;
    if (model === "bem") {
      const fresh = this.store.shown(design) !== design.answer;
      const where = fresh && design.answer.around ? " at the starting pose" : "";
      const text = fresh ? `${this.store.method}${where}` : `${this.store.method}: asking the judge …`;
      return el("div", { class: `trust ${fresh ? "good" : "open"}`, id: "trust" }, el("i"), text);
    }
    const { around, expected_error: error, how, region, calibration: made } = design.answer;
    const who = this.store.ours;
    if (around && !made?.here) {
      const what = around.kind === "wall" ? "wall" : "channel";
      const title = "Local resistance is that of free fluid; ask the judge, then calibrate here.";
      return el("div", { class: "trust poor", id: "trust", title }, el("i"), `Surrogate: knows nothing of the ${what}`);
    }
    if (error === null && region) return el("div", { class: "trust fair", id: "trust" }, el("i"), "Surrogate, outside its calibrated region");
    const where = region || !made ? "" : `, calibrated at ${made.here ? "this" : "another"} design`;
    const title = [...(made?.lines ?? []), ...(error === null ? [] : [how])].join("\n")
      || "No reference has been asked; ask the judge, then calibrate here.";
    if (error === null) {
      const grade = !made ? "open" : made.here ? "good" : "fair";
      return el("div", { class: `trust ${grade}`, id: "trust", title }, el("i"), `${who}${where || ", not calibrated"}`);
    }
    const grade = error < 0.05 ? "good" : error < 0.2 ? "fair" : "poor";
    return el("div", { class: `trust ${grade}`, id: "trust", title }, el("i"), `${who}${where}: expected error ${digits(100 * error, 2)} %`);
  }
}
