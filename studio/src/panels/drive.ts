// What drives the swimmer: its motor, a rotating magnetic field on the moment of its magnet, or the field of its spec.

import { digits, el, withPrefix } from "../state/dom";
import { cross, dot, load, momentIn, rotate, spinMobility, turnMobility, twist, type Drive, type Pose, type Vec } from "../state/motion";
import type { Store } from "../state/store";
import type { Answer } from "../state/types";
import { called, words } from "../state/words";
import { Own } from "./own";

const AXES: Vec[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const HISTORY = 240;
/** T, of a spec that names no field */
const USUAL = 5e-3;
type Slider = "share" | "strength" | "size" | "azimuth" | "elevation";

export class Driver {
  readonly node = el("div", { class: "drive" });
  magnetic = false;
  /** field: rate as a share of the step-out at the start; logarithms (to 10) of strength and moment over theirs; heading in degrees */
  share = 0.6;
  strength = 0;
  size = 0;
  azimuth = 0;
  elevation = 0;
  private chart = el("canvas", { width: 536, height: 170, id: "stepout" });
  private state = el("div", { class: "trust open", id: "step" }, el("i"), "");
  /** where its Reynolds number is beyond what the model holds for; and the same in few words */
  private inertia = el("div", { class: "trust poor", id: "inertia", hidden: true }, el("i"), "");
  private beyond = el("small", { class: "poor" });
  private figure = el("div", { class: "figure", id: "driven-speed" });
  private caption = el("div", { class: "caption" });
  private sure = el("div", { id: "drive-trust" });
  /** the speed, for a screen that has no room for more */
  readonly glance = el("b", {}, "–");
  private went: Vec[] = [];
  private turned: [number, number][] = [];
  private leans: number[] = [];
  private before: Vec | null = null;
  private angle = 0;
  private shows: (() => void)[] = [];
  private phase = 0;
  private clock = 0;
  measured = 0;

  constructor(private store: Store, private changed: () => void, private trust: () => HTMLElement[]) {
    store.on("opened", () => this.release());
    store.on("structure", () => this.renew(true));
    store.on("answer", () => this.renew(false));
    for (const event of ["answer", "designs"] as const) {
      store.on(event, () => {
        this.sure.replaceChildren(...this.trust());
        this.entitle();
      });
    }
    this.build();
  }

  /** fields of specs that the sliders of a rotating one do not describe */
  readonly specs = new Own();
  private built = false;

  /** Whether such a field of the spec drives the active design. */
  get bySpec(): boolean {
    return Boolean(this.store.design) && this.specs.has(this.store.design.answer);
  }

  /** A design without a magnet begins with its motor, whatever drove the one before. */
  private release(): void {
    if (this.magnetic && !this.store.design.answer.magnet.moment) this.choose(false);
  }

  /** Other sliders where another kind of field drives it. */
  private renew(anew: boolean): void {
    const other = this.built !== this.bySpec;
    if (other) {
      this.shows = [];
      this.build();
    }
    if (anew || other) this.calibrate();
    if (other) this.changed();
  }

  /** Magnet and field of the spec; without a magnet one across its long axis that steps out at the motor's own frequency. */
  private calibrate(): void {
    const { gait, magnet, dimensional } = this.store.design.answer;
    const rate = Math.abs(gait.rate) || 1;
    this.first = magnet.field ?? (dimensional ? USUAL : 1);
    this.own = magnet.moment ?? [0, 0, 0];
    if (!magnet.moment) this.own[(magnet.long + 1) % 3] = rate / Math.max(spinMobility(gait, magnet.long), 1e-300) / this.first;
    this.strength = this.size = 0;
    if (magnet.frequency !== null) this.share = Math.min(2, (2 * Math.PI * magnet.frequency) / this.usualStepOut);
    for (const show of this.shows) show();
    if (this.magnetic && !this.built) this.plot();
  }

  /** strength and moment at the start */
  private first = 1;
  private own: Vec = [0, 1, 0];

  /** Size of B. */
  get B(): number {
    return this.first * 10 ** this.strength;
  }

  get moment(): Vec {
    return this.own.map((m) => m * 10 ** this.size) as Vec;
  }

  private get usualStepOut(): number {
    const { gait, magnet } = this.store.design.answer;
    const across = Math.hypot(...this.own.filter((_, i) => i !== magnet.long)) || Math.hypot(...this.own);
    return this.first * across * spinMobility(gait, magnet.long);
  }

  /** Rate at which a swimmer on a rail along the field's axis can no longer follow. */
  get stepOut(): number {
    return this.usualStepOut * 10 ** (this.strength + this.size);
  }

  get rate(): number {
    return this.share * this.usualStepOut;
  }

  get drive(): Drive {
    return this.driveOf(this.store.design.answer);
  }

  driveOf(answer: Answer): Drive {
    const { rate } = answer.gait;
    if (!this.magnetic) return { rate, magnet: null, field: () => ({ B: [0, 0, 0], J: null }), known: null };
    if (!this.specs.has(answer)) {
      return { rate: 0, magnet: { moment: this.moment, softness: null }, field: (t) => ({ B: this.field(t).map((b) => b * this.B) as Vec, J: null }), known: null };
    }
    const [more, larger] = [10 ** this.strength, 10 ** this.size];
    const { moment, softness } = answer.magnet;
    return {
      rate, magnet: { moment: moment!.map((m) => m * larger) as Vec, softness: softness && softness.map((c) => c * larger) },
      field: (t, x) => {
        const { B, J } = this.specs.felt(answer, t, x);
        return { B: B.map((b) => b * more) as Vec, J: J && J.map((j) => j * more) };
      },
      known: answer.magnet.own!.half === null && answer.magnet.own!.span === null ? null : (t, x) => this.specs.knows(answer, t, x),
    };
  }

  /** Rate (rad per time) at which the field of the spec can turn the swimmer, at its start. */
  private get pull(): number {
    const { answer } = this.store.design;
    const { magnet, field } = this.driveOf(answer);
    const B = Math.hypot(...field(0, [0, 0, 0]).B);
    const soft = magnet!.softness ? Math.hypot(...magnet!.softness) * B : 0;
    return (Math.hypot(...magnet!.moment) + soft) * B * turnMobility(answer.gait);
  }

  /** Rate of turns in each of which the field's gradient drags the swimmer over two of its lengths, at its start. */
  private get drift(): number {
    const { answer } = this.store.design;
    const { gait, shape } = answer;
    const wrench = load(this.driveOf(answer), [0, 0, 0], [1, 0, 0, 0], 0)!;
    const size = Math.hypot(...wrench.slice(0, 3)) * twist(gait, 0, 0, [1, 0, 0, 0, 0, 0])[0];
    return (Math.PI * size) / (shape.length + 2 * shape.semi_axes[0]);
  }

  /** Fastest angle rate there is, which the time step must resolve. */
  get fastest(): number {
    const { gait } = this.store.design.answer;
    if (!this.magnetic) return Math.abs(gait.rate) || 1;
    if (this.bySpec) return Math.max(Math.abs(gait.rate), this.specs.rate(this.store.design.answer), this.pull) || 1;
    return Math.max(Math.abs(this.rate), this.stepOut);
  }

  /** Rate whose periods the eye follows: the field's, unless it hardly turns. */
  get shownRate(): number {
    const { answer } = this.store.design;
    if (this.bySpec) return Math.max(Math.abs(answer.gait.rate), this.specs.rate(answer)) || Math.max(this.pull / 100, this.drift) || 1;
    return Math.max(Math.abs(this.rate), this.stepOut / 200) || 1;
  }

  /** Whether the field is not known yet where the swimmer has come to. */
  waits(answer: Answer, pose: Pose): boolean {
    const why = this.magnetic && !answer.gait.one_pose ? this.specs.waits(answer, pose, this.store.snapshot === null) : "";
    if (!why) return false;
    this.state.className = "trust open";
    this.state.lastChild!.textContent = why;
    return true;
  }

  get heading(): Vec {
    const a = (this.azimuth * Math.PI) / 180;
    const e = (this.elevation * Math.PI) / 180;
    return [-Math.cos(a) * Math.cos(e), -Math.sin(a) * Math.cos(e), Math.sin(e)];
  }

  /** Unit field in the plane across the heading; it turns so that the tail pushes along it. */
  field(time: number): Vec {
    const d = this.heading;
    const across: Vec = Math.abs(d[2]) < 0.95 ? [0, 0, 1] : [0, 1, 0];
    const unit = (v: Vec): Vec => v.map((x) => x / Math.hypot(...v)) as Vec;
    const e1 = unit(cross(d, across)); // along the moment at the start
    const e2 = cross(d, e1);
    const sense = -(this.store.design.answer.shape.sign || 1);
    const a = this.phase + this.rate * (time - this.clock);
    const [c, s] = [Math.cos(a), sense * Math.sin(a)];
    return [c * e1[0] + s * e2[0], c * e1[1] + s * e2[1], c * e1[2] + s * e2[2]];
  }

  private build(): void {
    const modes: [string, string][] = [["motor", "Motor"], ["field", "Magnetic field"]];
    const buttons = modes.map(([mode, text]) =>
      el("button", { id: `drive-${mode}`, "aria-pressed": String((mode === "field") === this.magnetic), onclick: () => this.choose(mode === "field") }, text));
    this.built = this.bySpec;
    this.entitle();
    const sliders = el("div", { hidden: !this.magnetic },
      el("div", { class: "hero" }, this.caption, this.figure),
      this.state, this.inertia, this.sure, ...(this.built ? [] : [this.chart, this.slider("Field frequency", "share", 0, 2, () => this.frequency(this.rate))]),
      this.slider(this.built ? "Field, times" : "Field strength", "strength", -1, 1, () => this.built ? digits(10 ** this.strength, 2) : this.said(this.B, "T")),
      this.slider(this.built ? "Magnet, times" : "Moment of the magnet", "size", -1, 1, () => this.built ? digits(10 ** this.size, 2) : this.said(Math.hypot(...this.moment), "A m²")),
      ...(this.built ? [el("p", { class: "fine" }, "The field is that of the spec at the swimmer's place: torque m × B, force from its gradient. The motor turns as the spec says.")] : [
        this.slider("Heading, sideways", "azimuth", -180, 180, () => `${Math.round(this.azimuth)}°`),
        this.slider("Heading, up", "elevation", -80, 80, () => `${Math.round(this.elevation)}°`),
        el("p", { class: "fine" }, "Arrow keys steer, + and − change the frequency. The tail is rigid; without a [magnet] in the spec the moment lies across the body.")]));
    this.node.replaceChildren(el("div", { class: "segments" }, ...buttons), sliders,
      el("p", { class: "fine", hidden: this.magnetic }, "The motor turns the tail against the body. Choose the field to drive a rigid, magnetised swimmer from outside and see it step out."));
  }

  private frequency(rate: number): string {
    return this.store.design?.answer.dimensional ? withPrefix(rate / (2 * Math.PI), called("frequency").unit).join(" ") : digits(rate / (2 * Math.PI));
  }

  private said(value: number, unit: string): string {
    return this.store.design.answer.dimensional ? withPrefix(value, unit, 2).join(" ") : digits(value, 2);
  }

  private slider(text: string, name: Slider, low: number, high: number, says: () => string): HTMLElement {
    const track = el("input", { type: "range", min: low, max: high, step: (high - low) / 400, "aria-label": text, id: `drive-${name}` });
    const value = el("span", { class: "value plain" });
    const show = (): void => {
      track.value = String(this[name]);
      track.style.setProperty("--at", `${(100 * (this[name] - low)) / (high - low)}%`);
      if (this.store.design) value.textContent = says();
    };
    track.addEventListener("input", () => {
      this.set(name, Number(track.value));
    });
    this.shows.push(show);
    show();
    return el("div", { class: "row" }, el("label", {}, text), value, track);
  }

  private set(name: Slider, value: number): void {
    this.hold();
    this[name] = value;
    this.turned = [];
    this.leans = [];
    this.went = [];
    for (const show of this.shows) show();
  }

  /** Keep the field's angle when its frequency changes. */
  private hold(): void {
    this.phase += this.rate * (this.time - this.clock);
    this.clock = this.time;
  }

  private time = 0;

  choose(magnetic: boolean): void {
    this.magnetic = magnetic;
    document.body.classList.toggle("magnetic", magnetic);
    this.restart();
    this.shows = [];
    this.build();
    this.calibrate();
    this.changed();
  }

  restart(): void {
    this.phase = this.clock = this.time = this.angle = this.measured = 0;
    this.before = null;
    this.turned = [];
    this.leans = [];
    this.went = [];
    this.state.className = "trust open";
    this.state.lastChild!.textContent = "Not measured yet";
    this.felt(0);
    this.tell("–");
    for (const design of this.store.designs) this.specs.restart(design.answer);
  }

  key(name: string): boolean {
    if (!this.magnetic || this.bySpec) return false;
    const turn: Record<string, [("azimuth" | "elevation" | "share"), number]> = {
      ArrowLeft: ["azimuth", -5], ArrowRight: ["azimuth", 5], ArrowUp: ["elevation", 5], ArrowDown: ["elevation", -5],
      "+": ["share", 0.05], "=": ["share", 0.05], "-": ["share", -0.05],
    };
    if (!(name in turn)) return false;
    const [what, by] = turn[name];
    const clamp = { azimuth: 180, elevation: 80, share: 2 }[what];
    this.set(what, Math.min(clamp, Math.max(what === "share" ? 0 : -clamp, this[what] + by)));
    return true;
  }

  /** Measure how fast the moment turns about the field's axis, and say whether it follows. */
  watch(pose: Pose): void {
    if (!this.magnetic) return;
    this.time = pose.time;
    const held = this.store.design.answer.gait.one_pose;
    if (held) {
      this.state.className = "trust open";
      this.state.lastChild!.textContent = `The answers hold at one pose of the ${held}: nothing turns`;
      this.tell("–");
      return;
    }
    if (this.bySpec) return this.feel(pose);
    const d = this.heading;
    const moment = rotate(pose.q, this.own);
    const m = moment.map((v, i) => v - dot(moment, d) * d[i]) as Vec; // across the field's axis
    const axis = rotate(pose.q, AXES[this.store.design.answer.magnet.long]);
    if (this.before) this.angle += Math.atan2(dot(cross(this.before, m), d), dot(this.before, m));
    this.before = m;
    this.turned.push([pose.time, this.angle]);
    this.went.push([...pose.x]);
    this.leans.push((180 / Math.PI) * Math.acos(Math.min(1, Math.abs(dot(axis, d)))));
    if (this.turned.length > HISTORY) {
      this.turned.shift();
      this.leans.shift();
    }
    if (this.went.length > this.turned.length) this.went.splice(0, this.went.length - this.turned.length);
    const [t0, a0] = this.turned[0];
    if (pose.time > t0) {
      this.measured = Math.abs((this.angle - a0) / (pose.time - t0));
      const speed = dot(d, pose.x.map((v, i) => v - this.went[0][i])) / (pose.time - t0);
      const [n, unit] = this.store.design.answer.dimensional ? withPrefix(speed, called("swimming_speed").unit) : [digits(speed), ""];
      this.tell(n, unit);
    }
    const follows = this.measured > 0.97 * this.rate;
    const early = (pose.time - t0) * this.rate < 2 * Math.PI;
    this.state.className = `trust ${this.rate === 0 || early ? "open" : follows ? "good" : "poor"}`;
    const { across, along } = this.store.design.answer.magnet.inertia;
    this.felt(Math.abs(this.rate) * (across + along * Math.sin((Math.PI * this.lean) / 180) ** 2));
    this.state.lastChild!.textContent = this.rate === 0 ? "The field stands still"
      : early ? "The field has not turned once yet"
      : follows ? `${this.regime()}: turns at ${this.frequency(this.rate)}`
      : `Stepped out: turns at ${this.frequency(this.measured)} of ${this.frequency(this.rate)}`;
    this.plot();
  }

  /** The speed, in the panel and where it stays in sight. */
  private tell(n: string, unit = ""): void {
    this.figure.replaceChildren(n, el("small", {}, unit));
    this.glance.replaceChildren(this.whose, n, el("small", {}, ` ${unit} `), this.beyond);
  }

  private entitle(): void {
    this.caption.textContent = `${this.whose}${this.built ? "Speed" : "Speed along the field's axis"}`;
  }

  /** Which of two designs the numbers are of. */
  private get whose(): string {
    return this.store.designs.length > 1 ? `${"AB"[this.store.active]}: ` : "";
  }

  /** How a field drives it, in words. */
  get told(): string {
    return `${this.built ? "speed in its field" : "speed along the field's axis"} ${this.figure.textContent}`;
  }

  /** Speed in the field of the spec, and what the field is and does where the swimmer is. */
  private feel(pose: Pose): void {
    const { answer } = this.store.design;
    const { dimensional, gait } = answer;
    const { magnet, field } = this.drive;
    const wrench = load(this.drive, pose.x, pose.q, pose.time)!;
    this.turned.push([pose.time, 0]);
    this.went.push([...pose.x]);
    if (this.turned.length > HISTORY) this.turned.shift();
    if (this.went.length > this.turned.length) this.went.splice(0, this.went.length - this.turned.length);
    const passed = pose.time - this.turned[0][0];
    const speed = passed > 0 ? Math.hypot(...pose.x.map((v, i) => v - this.went[0][i])) / passed : Math.hypot(...twist(gait, pose.phase, gait.rate, wrench).slice(0, 3));
    const [n, unit] = dimensional ? withPrefix(speed, called("swimming_speed").unit) : [digits(speed), ""];
    this.tell(n, unit);
    const { B } = field(pose.time, pose.x);
    const b = rotate(pose.q, B, true);
    const m = momentIn(magnet!, b);
    const off = (180 / Math.PI) * Math.acos(Math.min(1, Math.max(-1, dot(m, b) / (Math.hypot(...m) * Math.hypot(...b) || 1))));
    const force = Math.hypot(...wrench.slice(0, 3));
    const turning = twist(gait, pose.phase, gait.rate, wrench).slice(3);
    const spin = Math.abs(turning[answer.magnet.long]);
    const { across, along } = answer.magnet.inertia;
    this.felt(spin * across + Math.sqrt(Math.max(dot(turning, turning) - spin ** 2, 0)) * (across + along));
    this.state.className = "trust good";
    this.state.lastChild!.textContent = `Field ${this.said(Math.hypot(...B), "T")} here, ${Math.round(off)}° off the moment`
      + (force > 0 ? `; its gradient pulls with ${this.said(force, "N")}` : "");
  }

  /** Mean angle (degrees) between its axis and the field's. */
  private get lean(): number {
    return this.leans.reduce((a, b) => a + b, 0) / this.leans.length;
  }

  /** Say where it turns so fast that inertia, which is left out, is felt. */
  private felt(number: number): void {
    const told = number > this.store.design.answer.magnet.inertia.most ? `Reynolds number of the turning ${digits(number, 2)}: inertia, which is left out, is felt` : "";
    this.inertia.hidden = !told;
    if (this.inertia.lastChild!.textContent !== told) this.inertia.lastChild!.textContent = told;
    this.beyond.textContent = told && "inertia is felt";
  }

  /** How it turns in step, by the mean angle between its axis and the field's. */
  private regime(): string {
    const { lean } = this;
    const [straight, steep] = words().lean;
    const name = lean < straight ? "Synchronous" : lean < steep ? "Wobbling" : "Tumbling";
    return lean < straight ? name : `${name}, ${Math.round(lean)}° off the axis`;
  }

  /** Rate of turning over rate of the field; beyond step-out it falls as w - sqrt(w^2 - w_c^2). */
  private plot(): void {
    const { width: w, height: h } = this.chart;
    const g = this.chart.getContext("2d")!;
    const top = Math.max(2 * this.usualStepOut, 1.2 * this.stepOut);
    const X = (v: number): number => 14 + (v / top) * (w - 28);
    const Y = (v: number): number => h - 30 - (v / (1.12 * this.stepOut)) * (h - 46);
    g.clearRect(0, 0, w, h);
    g.strokeStyle = "rgba(255,255,255,.10)";
    g.lineWidth = 1.5;
    g.strokeRect(14, 12, w - 28, h - 42);
    g.setLineDash([5, 6]);
    g.beginPath();
    g.moveTo(X(this.stepOut), 12);
    g.lineTo(X(this.stepOut), h - 30);
    g.stroke();
    g.setLineDash([]);
    g.beginPath();
    for (let i = 0; i <= 200; i++) {
      const f = (top * i) / 200;
      const y = f <= this.stepOut ? f : f - Math.sqrt(f * f - this.stepOut ** 2);
      if (i === 0) g.moveTo(X(f), Y(y));
      else g.lineTo(X(f), Y(y));
    }
    g.strokeStyle = "#4fc3b8";
    g.lineWidth = 3;
    g.stroke();
    g.fillStyle = "#fff";
    g.beginPath();
    g.arc(X(Math.min(this.rate, top)), Y(Math.min(this.measured, 1.1 * this.stepOut)), 7, 0, 7);
    g.fill();
    g.fillStyle = "#8997a8";
    g.font = "20px 'Inter Variable', sans-serif";
    g.fillText("field frequency", 14, h - 8);
    g.fillText("turns of the body", 22, 34);
    g.textAlign = "right";
    g.fillText(`step-out ${this.frequency(this.stepOut)}`, w - 14, h - 8);
    g.textAlign = "left";
  }
}
