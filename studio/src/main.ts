// The studio's page: puts the parts together and lets the swimmers swim, sixty times a second.

import "./style.css";
import * as THREE from "three";
import { ARROWS, Actor, look } from "./scene/actor";
import { Answers } from "./panels/answers";
import { call } from "./state/api";
import { TopBar, Transport, type View } from "./panels/bars";
import { Controls } from "./panels/controls";
import { el, reading } from "./state/dom";
import { follow, show } from "./state/link";
import { Driver } from "./panels/drive";
import { Flow, speeds } from "./scene/flow";
import type { Caption } from "./scene/picture";
import { Judge, askFlow, askFlowOfBoth } from "./panels/judge";
import { SpeedMap } from "./panels/map";
import { Paths } from "./panels/path";
import { Sheets } from "./panels/sheets";
import { Stage } from "./scene/stage";
import { Replay, extent } from "./state/replay";
import { METHODS, Store, attempt, notice } from "./state/store";
import type { FlowAnswer, PathAnswer, Shape, Start } from "./state/types";
import { learn, words } from "./state/words";

const store = new Store();
/** asked at once, while the scene is being built */
const start = store.snapshot ? null : call<Start>("/api/start");
start?.catch(() => null); // told in begin
const view: View = { paused: false, pace: 0.6, arrows: false };
const stage = new Stage(document.getElementById("stage")!);
let actors: Actor[] = [];
const flow = new Flow();
let flowing: AbortController | null = null;
let fitted: unknown = null;

const controls = new Controls(store);
const answers = new Answers(store);
const map = new SpeedMap(store, controls);
const judge = new Judge(store);
const paths = new Paths(store, replayed);
const driver = new Driver(store, restart, () => [answers.trust(store.design), ...answers.missed(store.design, "")]);

/** stopped at a wall */
let touched = false;
/** a path that was followed, and the pace and view from before it was on show */
let replay: Replay | null = null;
let before = { pace: view.pace, follow: true };
/** seconds that a whole path takes to watch, at first */
const WATCHED = 24;

/** Show a path that was followed; null: swim by the gait again. */
function replayed(made: PathAnswer | null): void {
  if (Boolean(made) !== Boolean(replay)) {
    if (made) before = { pace: view.pace, follow: stage.follow };
    else transport.setPace(before.pace);
    following(made ? false : before.follow);
  }
  stopFlow();
  replay = made && new Replay(made);
  answers.follow(made);
  sheets.tell();
  actors.forEach((actor, i) => actor.go(made && made.swimmers[i]));
  if (!made) return cast(true);
  const turns = made.numbers.turns as number;
  transport.setPace(turns / WATCHED);
  if (view.paused) transport.toggle();
  const { middle, reach } = extent(made);
  const { around, shape } = store.designs[0].answer;
  stage.see(middle, Math.max(reach, 0.7 * (shape.length + 2 * shape.semi_axes[0])), around?.normal ?? null);
}

/** Whether the camera follows the swimmer. */
function following(on: boolean): void {
  stage.follow = on;
  toggles.follow.setAttribute("aria-pressed", String(on));
}

function restart(): void {
  touched = false;
  legends.magnet.hidden = !driver.magnetic;
  sheets.tell();
  driver.restart();
  for (const actor of actors) actor.restart();
  frame(true);
}

/** As many actors as designs, side by side. */
function cast(anew = false): void {
  for (const actor of actors.slice(store.designs.length)) actor.dispose();
  actors = actors.slice(0, store.designs.length);
  store.designs.forEach((design, i) => {
    actors[i] ??= new Actor(stage.world, look(i));
    actors[i].update(store.shown(design));
  });
  const { shape } = store.designs[0].answer;
  const length = shape.length + 2 * shape.semi_axes[0];
  actors.forEach((actor, i) => actor.offset.set(0, 0, store.designs.length > 1 ? (0.5 - i) * 0.46 * length : 0));
  if (anew || fitted !== store.designs[0]) {
    fitted = store.designs[0];
    stage.fit(room(shape), 2 * shape.semi_axes[1] || shape.length / 4);
    restart();
    stage.reset(store.designs.length > 1 ? 3.3 : 2.75);
  }
  if (store.designs.length > 1) restart();
}

/** How much room a swimmer takes in the picture. */
function room(shape: Shape): number {
  const wide = 2 * Math.max(shape.semi_axes[1], shape.semi_axes[2], shape.reach);
  return Math.max(shape.length + 2 * shape.semi_axes[0], 1.3 * wide);
}

function dress(): void {
  stage.hold(Math.max(...store.designs.map((design) => room(store.shown(design).shape))));
  store.designs.forEach((design, i) => actors[i]?.update(store.shown(design)));
  for (const actor of actors) actor.begin();
  stage.ground = !actors.some((actor) => actor.around.kind);
  if (!replay) store.designs.forEach((design, i) => actors[i]?.ring(store.designs.length > 1 ? null : store.judged(design)?.circle ?? null));
  stopFlow();
}

/** The answers hold at the start's pose: what comes to the wall stops. */
function halt(): void {
  touched = true;
  transport.pause();
  notice("It has come to the wall. The answers hold where it started; play begins there again.");
}

function stopFlow(): void {
  flowing?.abort();
  flowing = null;
  flow.clear();
  legends.flow.hidden = true;
  toggles.flow.setAttribute("aria-pressed", "false");
}

async function showFlow(): Promise<void> {
  if (flow.shown || flowing) return stopFlow();
  const stop = (flowing = new AbortController());
  toggles.flow.setAttribute("aria-pressed", "true");
  const text = toggles.flow.textContent!;
  const told = (s: { done: number; total: number }): void => {
    toggles.flow.textContent = `Flow ${Math.round((100 * s.done) / s.total)} %`;
  };
  const both = replay && actors.length > 1;
  const made = await attempt(() => (both ? askFlowOfBoth(store, actors.map((actor) => actor.pose), told, stop.signal) : askFlow(store, told, stop.signal)));
  toggles.flow.textContent = text;
  if (flowing !== stop) return;
  flowing = null;
  if (!made) return stopFlow();
  (both ? stage.world : actors[store.active].sqr).add(flow.group);
  flow.show(made);
  const [low, high] = flowEnds()!;
  legends.flow.replaceChildren(`${whose()} ${low}`, el("i", { style: `background: linear-gradient(90deg, ${speeds(16).join(", ")})` }), high);
  legends.flow.hidden = false;
  if (both) lookAt(made);
  else stage.face();
}

/** The camera to the side of a slice on which it is, all of it in the picture. */
function lookAt({ s, q }: FlowAnswer): void {
  const normal = new THREE.Vector3(0, 0, 1).applyQuaternion(flow.group.quaternion);
  if (normal.dot(stage.camera.position.clone().sub(stage.controls.target)) < 0) normal.negate();
  const middle = flow.group.localToWorld(new THREE.Vector3(0.5 * (s[0] + s[1]), 0.5 * (q[0] + q[1]), 0)).divideScalar(stage.scale);
  stage.see(middle.toArray(), 0.4 * Math.hypot(s[1] - s[0], q[1] - q[0]), normal.toArray());
}

/** Whose flow is shown: of two designs beside each other each swims in a fluid of its own. */
function whose(): string {
  if (flow.ofBoth) return flow.answer!.series.length > 1 ? "flow of both" : "flow of both now";
  return actors.length > 1 ? `flow of ${"AB"[store.active]} alone` : "flow";
}

/** Whether both swimmers stay where their path has brought them: their flow is asked for, or shown. */
const halted = (): boolean => Boolean(replay) && actors.length > 1 && (flow.ofBoth || flowing !== null);

/** Least and largest speed that the slice's colours show. */
function flowEnds(): [string, string] | null {
  if (!flow.answer || !flow.shown) return null;
  const { dimensional } = store.design.answer;
  return ["0", reading("swimming_speed", flow.answer.scale, dimensional, 2).join(" ")];
}

/** What stands on a picture that one takes away. */
function caption(): Caption {
  const texts = { forces: ["velocity", "drag", "thrust"], magnet: ["field", "moment"] };
  const shown = (["forces", "magnet"] as const).filter((key) => !legends[key].hidden).flatMap((key) => texts[key]);
  const ends = flowEnds();
  return {
    designs: store.designs.map((d, i) => ({ colour: look(i).tail, ...answers.told(d, !driver.magnetic ? null : d === store.design ? driver.told : "driven by the same field") })),
    arrows: shown.map((text) => ({ colour: ARROWS[text], text })),
    bar: transport.bar,
    flow: ends && { colours: speeds(40), low: `${whose()} ${ends[0]}`, high: ends[1] },
  };
}

function toggle(id: string, text: string, title: string, act: (on: boolean) => void, on = false): HTMLButtonElement {
  const b = el("button", { id, title, "aria-pressed": String(on) }, text);
  b.onclick = () => {
    const now = b.getAttribute("aria-pressed") !== "true";
    b.setAttribute("aria-pressed", String(now));
    act(now);
  };
  return b;
}

const arrows = (...names: string[]): HTMLElement =>
  el("span", { hidden: true }, ...names.map((n) => el("span", { class: n }, el("i", { style: `background: ${ARROWS[n]}` }), n)));
const legends = { forces: arrows("velocity", "drag", "thrust"), magnet: arrows("field", "moment"), flow: el("span", { class: "flowbar", id: "flowbar", hidden: true }) };
const legend = el("div", { class: "arrows" }, ...Object.values(legends));
const toggles = {
  follow: toggle("follow", "Follow", "The camera follows the swimmer", (on) => {
    stage.follow = on;
    if (on) frame(true);
  }, true),
  arrows: toggle("arrows", "Forces", "Drag on the body, thrust of the tail, velocity", (on) => {
    view.arrows = on;
    legends.forces.hidden = !on;
  }),
  flow: el("button", { id: "flow", "aria-pressed": "false", title: "Flow on a slice, by boundary elements", onclick: () => void showFlow() }, "Flow"),
};
toggles.flow.hidden = store.snapshot !== null;

const transport = new Transport(store, view, {
  toggles: Object.values(toggles), restart: () => {
    if (replay) {
      if (halted()) stopFlow();
      replay.time = 0;
    } else if (touched) transport.toggle();
    else restart();
  },
  resume: () => {
    if (touched) restart();
  },
});
const top = new TopBar(store, { stage, map, view, actors: () => actors, picture: () => stage.picture(caption()) });

/** Surrogate or reference: which gait swims. */
function models(): HTMLElement {
  const all: ["rft" | "bem", string][] = [["rft", "Surrogate"], ["bem", METHODS.bem]];
  const buttons = all.map(([model, text]) => el("button", { id: `model-${model}`, "aria-pressed": String(model === store.model), onclick: () => {
    store.model = model;
    buttons.forEach((b, i) => b.setAttribute("aria-pressed", String(all[i][0] === model)));
    store.tell("answer", "rest");
    if (model === "bem") tabs.open("judge");
  } }, text));
  for (const event of ["answer", "designs"] as const) store.on(event, () => buttons.forEach((b, i) => (b.textContent = i ? store.method : store.ours)));
  return el("div", { class: "segments", "aria-label": "Model" }, ...buttons);
}

const tabs = (() => {
  const parts: Record<string, HTMLElement> = store.snapshot ? { map: map.node, drive: driver.node } : { map: map.node, judge: judge.node, path: paths.node, drive: driver.node };
  if (store.snapshot && !store.snapshot.map) delete parts.map;
  const names: Record<string, string> = { map: "Map", judge: "Judge", path: "Path", drive: "Drive" };
  const heads = Object.keys(parts).map((key) => el("button", { id: `tab-${key}`, role: "tab", onclick: () => open(key) }, names[key]));
  const body = el("div", { class: "tabbody" });
  const open = (key: string): void => {
    Object.keys(parts).forEach((k, i) => heads[i].setAttribute("aria-selected", String(k === key)));
    body.replaceChildren(parts[key]);
    document.body.dataset.tab = key;
    map.visible = key === "map";
    if (map.visible && store.designs.length) map.refresh();
  };
  return { node: el("div", { class: "tabs" }, el("nav", { role: "tablist" }, ...heads), body), open, keys: Object.keys(parts) };
})();

function frame(now: boolean): void {
  if (!actors.length) return;
  const centre = new THREE.Vector3();
  for (const actor of actors) {
    const { shape } = actor.answer;
    const middle = new THREE.Vector3(0.5 * shape.length, 0, 0).applyQuaternion(actor.root.quaternion);
    centre.addScaledVector(middle.add(actor.root.position), 1 / actors.length);
  }
  stage.look(centre, now);
}

/** The first frame: it waits for the graphics, which compile meanwhile. */
function appear(): void {
  stage.renderer.compile(stage.scene, stage.camera);
  stage.render();
  performance.mark("drawn");
  last = performance.now();
  requestAnimationFrame(tick);
}

let last = performance.now();
let frames = 0;
function tick(now: number): void {
  stage.adapt(now - last);
  const passed = Math.min(0.1, (now - last) / 1000);
  last = now;
  frames += 1;
  if (actors.length) {
    const { gait } = actors[0].answer;
    const rate = driver.magnetic ? driver.shownRate : Math.abs(gait.rate) || 1;
    const turns = view.paused ? 0 : passed * view.pace;
    const time = replay ? (turns * replay.end) / (replay.made.numbers.turns as number) : (turns * 2 * Math.PI) / rate;
    if (replay && time && !halted()) replay.advance(time);
    if (flow.ofBoth) flow.turn(turns * 2 * Math.PI);
    for (const actor of actors) {
      const drive = driver.driveOf(actor.answer);
      if (replay) actor.along(replay, flow.ofBoth ? flow.turned : 0);
      else if (time && !driver.waits(actor.answer, actor.pose)) actor.advance(time, drive, driver.magnetic ? driver.fastest : Math.abs(actor.answer.gait.rate) || 1);
      actor.draw(drive, view.arrows, 1 / stage.scale);
      actor.around.look(stage.controls.target, stage.reach);
    }
    if (time && !replay && actors.some((actor) => actor.touches)) halt();
    if (time && !replay && !driver.waits(actors[store.active].answer, actors[store.active].pose)) driver.watch(actors[store.active].pose);
    flow.update(flow.ofBoth ? flow.turned : actors[store.active].pose.phase, time || 0);
    frame(false);
    transport.measure(stage.pixel);
  }
  stage.render();
  requestAnimationFrame(tick);
}

document.addEventListener("keydown", (e) => {
  const typing = e.target instanceof HTMLInputElement || e.target instanceof HTMLSelectElement;
  if ((e.ctrlKey || e.metaKey) && e.key.toLowerCase() === "z") {
    e.preventDefault();
    if (e.shiftKey) store.redo();
    else store.undo();
  } else if ((e.ctrlKey || e.metaKey) && e.key.toLowerCase() === "y") store.redo();
  else if (!typing && e.key === " ") {
    e.preventDefault();
    transport.toggle();
  } else if (!typing && driver.key(e.key)) e.preventDefault();
});

window.addEventListener("error", (e) => notice(`The page stumbled: ${e.message}`, "error"));
window.addEventListener("unhandledrejection", (e) => notice(`The page stumbled: ${e.reason}`, "error"));

store.onScene((places) => {
  paths.put(places);
  tabs.open("path");
  void paths.ask();
});
/** Bring a swimmer that has outgrown the view, or all but vanished in it, back to its size. */
function outgrown(): void {
  const { shape } = store.designs[0].answer;
  const shown = (shape.length + 2 * shape.semi_axes[0]) * stage.scale;
  if (!replay && (shown > 2 || shown < 0.4)) cast(true);
}

store.on("designs", () => cast());
store.on("answer", () => store.designs.length === 1 && outgrown());
store.on("answer", dress);
if (!store.snapshot) for (const event of ["answer", "designs"] as const) store.on(event, () => void show(store));

const sheets = new Sheets(store, answers, () => (driver.magnetic ? driver.glance : null), stage, tabs);
const left = el("div", { class: "side left" }, controls.node);
const right = el("aside", { class: "panel right", "aria-label": "Answers" }, ...(store.snapshot ? [] : [models()]), answers.node, tabs.node);
document.getElementById("app")!.append(top.node, left, right, legend,
  el("div", { class: "below" }, transport.scale, transport.node), sheets.glance, sheets.node);

/** The swimmers' colours for what names them beside the scene. */
function dye(): void {
  words().palette.swimmers.forEach(([, tail], i) => document.documentElement.style.setProperty(i ? `--tail${i}` : "--tail", tail));
}

async function begin(): Promise<void> {
  if (store.snapshot) {
    document.body.classList.add("snapshot");
    store.designs = store.snapshot.designs.map((d) => store.make(d.name, d.answer));
    view.pace = Number(store.snapshot.view.pace ?? view.pace);
  } else {
    const { name, answer, words } = await start!;
    learn(words);
    const linked = await attempt(() => follow(store));
    if (!linked) store.designs = [store.make(name, answer)];
  }
  dye();
  store.tell("designs", "structure", "tables", "answer", "rest");
  if (tabs.keys.length) tabs.open(tabs.keys[0]);
  map.refresh();
  for (const input of document.querySelectorAll<HTMLInputElement>(".panel.left :is(input, select, button)")) {
    if (store.snapshot) input.disabled = true;
  }
  document.body.dataset.ready = "yes";
  performance.mark("ready");
  requestAnimationFrame(() => setTimeout(appear)); // the numbers are painted first
  if (!store.snapshot) void warming();
}

async function warming(): Promise<void> {
  for (let i = 0; ; i++) {
    const { warm, doing } = await call<{ warm: boolean; doing: string }>("/api/status");
    if (warm) {
      document.body.dataset.warm = "yes";
      if (!map.drawn) map.refresh(); // the first one may have come too early
      return;
    }
    if (i === 1) notice(`Getting ready (${doing}); the first numbers may take a few seconds.`);
    await new Promise((resolve) => setTimeout(resolve, 500));
  }
}

window.addEventListener("hashchange", () => window.location.reload()); // another link in the same tab

void begin().catch((error: Error) => notice(error.message, "error"));

// For tests and the curious.
Object.assign(window, { studio: { store, stage, map, driver, flow, actors: () => actors, paths, replay: () => replay, frames: () => frames, view, picture: () => stage.picture(caption()) } });
