// One swimmer on the stage: body, tail, path behind it, arrows, and its pose in time.

import * as THREE from "three";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { bodyWrench, load, momentIn, rotate, start, stay, step, twist, type Drive, type Pose } from "../state/motion";
import { Bounds } from "./bounds";
import { Hull, plain } from "./hull";
import { TailMesh } from "./tube";
import type { Replay } from "../state/replay";
import type { Answer, Circle, Rows } from "../state/types";
import { words } from "../state/words";

const SHOWN = 900;
const KEPT = 20000;
/** what the path fades into */
const DARK = new THREE.Color("#16212e");

export interface Look {
  body: string;
  tail: string;
  path: string;
}

/** Colours of the first or of the second swimmer. */
export function look(i: number): Look {
  const [body, tail, path] = words().palette.swimmers[i];
  return { body, tail, path };
}

/** arrows along a side of the square of those of the field */
const LATTICE = 5;

/** Colours of the arrows. */
export const ARROWS: Record<string, string> = { thrust: "#5fd0a0", drag: "#ff8a70", velocity: "#ffffff", field: "#6fa8ff", moment: "#e58cff" };

export class Actor {
  readonly root = new THREE.Group();
  readonly pose: Pose = start();
  readonly offset = new THREE.Vector3();
  answer!: Answer;
  /** time, position, quaternion and phase, one row after the other */
  record: number[][] = [];
  readonly sqr = new THREE.Group();
  readonly around = new Bounds();
  private home = new THREE.Group();
  private hull: Hull;
  private tails: TailMesh[] = [];
  private skin: THREE.Material;
  private path: Line2;
  /** a whole path that is followed, or the circle of a pose */
  private whole: Line2;
  private rows: Rows | null = null;
  private trail: number[] = [];
  private arrows: Record<string, THREE.Group> = {};
  private lattice: THREE.Group[] = [];
  private since = 0;
  private colour: THREE.Color;

  constructor(private scene: THREE.Object3D, public look: Look) {
    this.hull = new Hull(look.body);
    this.skin = new THREE.MeshStandardMaterial({ map: plain(), color: look.tail, roughness: 0.34 });
    this.colour = new THREE.Color(look.path);
    const drawn = { linewidth: 2, transparent: true, depthWrite: false, toneMapped: false };
    this.path = new Line2(new LineGeometry(), new LineMaterial({ ...drawn, vertexColors: true }));
    this.whole = new Line2(new LineGeometry(), new LineMaterial({ ...drawn, color: look.path, opacity: 0.42 }));
    for (const line of [this.path, this.whole]) line.frustumCulled = false;
    this.whole.visible = false;
    this.root.add(this.hull.mesh, this.sqr);
    this.home.add(this.around.group, this.whole);
    scene.add(this.root, this.path, this.home);
    for (const [name, tint] of Object.entries(ARROWS)) {
      this.arrows[name] = arrow(tint, name === "field" || name === "moment");
      scene.add(this.arrows[name]);
    }
  }

  dispose(): void {
    this.around.dispose();
    this.hull.dispose();
    this.scene.remove(this.root, this.path, this.home, ...Object.values(this.arrows), ...this.lattice);
  }

  update(answer: Answer): void {
    this.answer = answer;
    if (answer.gait.one_pose) Object.assign(this.pose, start(), { phase: this.pose.phase });
    const { shape } = answer;
    this.hull.update(shape);
    this.sqr.position.set(shape.semi_axes[0], 0, 0);
    this.tails.splice(shape.tails.length).forEach((tail) => {
      this.sqr.remove(tail.group);
      tail.dispose();
    });
    shape.tails.forEach((filament, i) => {
      if (!this.tails[i]) this.sqr.add((this.tails[i] = new TailMesh(this.skin)).group);
      this.tails[i].update(filament);
    });
    this.around.update(answer.around, answer.shape);
    this.pose_();
  }

  /** Go along a path that was followed elsewhere; null: swim by the gait again. */
  go(rows: Rows | null): void {
    this.rows = rows;
    this.offset.set(0, 0, 0);
    this.ring(null);
    if (rows) this.line(rows.x);
    const { around, shape } = this.answer;
    this.around.update(around, shape);
    if (rows && around?.length) this.around.update(this.around.endless(around, rows.x, shape), shape);
    this.restart();
  }

  /** Put it where the path has it now, with what lies behind; its tail an angle on, as its motor turns. */
  along(replay: Replay, on = 0): void {
    const { rows } = this;
    if (!rows) return;
    replay.put(rows, this.pose);
    this.pose.phase += Math.sign(this.answer.gait.rate) * on;
    this.trail = rows.x.slice(3 * Math.max(0, replay.behind - SHOWN), 3 * replay.behind);
    this.trail.push(...this.pose.x);
    this.pose_();
  }

  /** The circle that a pose beside a wall leads to. */
  ring(circle: Circle | null): void {
    this.whole.visible = false;
    if (!circle) return;
    const [c, n] = [new THREE.Vector3(...circle.centre), new THREE.Vector3(...circle.normal)];
    const start = c.clone().negate();
    this.line(Array.from({ length: 129 }, (_, i) => start.clone().applyAxisAngle(n, (i * Math.PI) / 64).add(c).toArray()).flat());
  }

  private line(places: number[]): void {
    this.whole.geometry.dispose();
    this.whole.geometry = new LineGeometry();
    this.whole.geometry.setPositions(places);
    this.whole.visible = true;
  }

  restart(): void {
    Object.assign(this.pose, start());
    this.forget();
    this.pose_();
  }

  /** The record of a new design begins; the path behind stays. */
  begin(): void {
    this.record = [];
  }

  forget(): void {
    this.trail = [];
    this.record = [];
    this.path.visible = false;
    this.since = 0;
  }

  /** Advance in steps short against the period of the motor and of the field; not along a path
   * on which a wall would turn with the swimmer. */
  advance(time: number, drive: Drive, fastest: number): void {
    if (this.answer.gait.one_pose) {
      this.forget();
      stay(this.pose, drive.rate, time);
      return this.pose_();
    }
    const steps = Math.min(4000, Math.max(1, Math.ceil((Math.abs(time) * fastest * 48) / (2 * Math.PI))));
    for (let i = 0; i < steps; i++) {
      if (drive.known && !drive.known(this.pose.time, this.pose.x)) break; // of the field no more is known yet
      step(this.answer.gait, drive, this.pose, time / steps);
      this.since += Math.abs((time / steps) * fastest);
      if (this.since >= (2 * Math.PI) / 24) {
        this.since = 0;
        this.remember();
      }
    }
    this.pose_();
  }

  /** Whether it has come to the wall or an end of the channel since it started. */
  get touches(): boolean {
    const room = this.around.room(this.pose, this.answer.shape);
    return room <= 0 && room < this.around.room(start(), this.answer.shape);
  }

  private remember(): void {
    const { x, q, phase, time } = this.pose;
    this.record.push([time, ...x, ...q, phase]);
    if (this.record.length > KEPT) this.record.shift();
    this.trail.push(x[0] + this.offset.x, x[1] + this.offset.y, x[2] + this.offset.z);
    if (this.trail.length > 3 * SHOWN) this.trail.splice(0, 3);
  }

  /** Put meshes where the pose says. */
  private pose_(): void {
    const { x, q, phase } = this.pose;
    this.home.position.copy(this.offset);
    this.root.position.set(x[0], x[1], x[2]).add(this.offset);
    this.root.quaternion.set(q[1], q[2], q[3], q[0]);
    for (const tail of this.tails) tail.pose(phase);
  }

  draw(drive: Drive, arrows: boolean, height: number): void {
    const n = this.trail.length / 3;
    this.path.visible = n > 2;
    if (n > 2) {
      const shades = new Array<number>(3 * n);
      for (let i = 0; i < n; i++) {
        const f = (i / n) ** 1.3;
        shades[3 * i] = DARK.r + f * (this.colour.r - DARK.r);
        shades[3 * i + 1] = DARK.g + f * (this.colour.g - DARK.g);
        shades[3 * i + 2] = DARK.b + f * (this.colour.b - DARK.b);
      }
      this.path.geometry.dispose();
      this.path.geometry = new LineGeometry();
      this.path.geometry.setPositions(this.trail);
      this.path.geometry.setColors(shades);
    }
    for (const a of Object.values(this.arrows)) a.visible = arrows;
    if (arrows) this.point(drive, height);
    this.magnetise(drive, height);
  }

  /** Arrows of the field and of the moment, from the body's centre, where a field drives. */
  private magnetise(drive: Drive, size: number): void {
    const { x, q, time } = this.pose;
    const at = [x[0] + this.offset.x, x[1] + this.offset.y, x[2] + this.offset.z];
    const reach = drive.magnet ? Math.max(0.3 * size, 1.7 * Math.max(...this.answer.shape.semi_axes)) : 0;
    const { B } = drive.field(time, x);
    const moment = drive.magnet ? momentIn(drive.magnet, rotate(q, B, true)) : [0, 0, 0];
    aim(this.arrows.field, at, B, reach);
    aim(this.arrows.moment, at, rotate(q, moment), 0.8 * reach);
    this.surround(drive, size, Math.hypot(...B));
  }

  /** Arrows of the field about it, as long as it is strong, where it depends on place. */
  private surround(drive: Drive, size: number, here: number): void {
    const { x, time } = this.pose;
    if (drive.known && !this.lattice.length) {
      for (let i = 0; i < LATTICE ** 2; i++) this.lattice.push(arrow(ARROWS.field));
      this.scene.add(...this.lattice);
    }
    const step = 0.3 * size;
    this.lattice.forEach((one, n) => {
      const [i, j] = [n % LATTICE, Math.floor(n / LATTICE)].map((k) => k - (LATTICE - 1) / 2);
      const place = [x[0] + i * step, x[1] + j * step, x[2]];
      one.visible = false;
      if (!drive.known || (i === 0 && j === 0) || !drive.known(time, place)) return;
      const { B } = drive.field(time, place);
      aim(one, place.map((c, k) => c + this.offset.getComponent(k)), B, (0.55 * step * Math.hypot(...B)) / (here || 1));
    });
  }

  /** Arrows: drag on the body, thrust on the tail (to one scale), velocity of the body. */
  private point(drive: Drive, size: number): void {
    const { gait, shape } = this.answer;
    const wrench = load(drive, this.pose.x, this.pose.q, this.pose.time);
    const V = twist(gait, this.pose.phase, drive.rate, wrench);
    const F = bodyWrench(gait, this.pose.phase, drive.rate, V);
    const { q, x } = this.pose;
    const speed = Math.hypot(V[0], V[1], V[2]);
    const [a, b] = shape.semi_axes;
    const reach = 0.24 * size;
    const up = 1.3 * Math.max(b, shape.reach + shape.radius);
    const middle = rotate(q, [a + 0.5 * shape.length, 0, 0]);
    const place = (from: number[], lift: number): number[] =>
      [x[0] + from[0] + this.offset.x, x[1] + from[1] + this.offset.y, x[2] + from[2] + this.offset.z + lift];
    const lab = (v: number[]): number[] => rotate(q, v.slice(0, 3));
    aim(this.arrows.velocity, place([0, 0, 0], up), lab(V), speed > 0 ? reach : 0);
    const force = F ? Math.hypot(F[0], F[1], F[2]) : 0;
    aim(this.arrows.drag, place([0, 0, 0], -up), lab(F ?? [0, 0, 0]), force > 0 ? reach : 0);
    const back = F ? [-F[0], -F[1], -F[2]] : [0, 0, 0];
    aim(this.arrows.thrust, place(middle, -up), lab(back), force > 0 ? reach : 0);
  }
}

/** An arrow; one that begins within the body is seen through it. */
function arrow(colour: string, through = false): THREE.Group {
  const material = new THREE.MeshStandardMaterial({ color: colour, emissive: colour, emissiveIntensity: 0.45, roughness: 0.5, depthTest: !through, transparent: through });
  const shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.022, 0.022, 0.78, 12), material);
  shaft.position.y = 0.39;
  const head = new THREE.Mesh(new THREE.ConeGeometry(0.07, 0.22, 20), material);
  head.position.y = 0.89;
  const group = new THREE.Group();
  group.add(shaft, head);
  if (through) group.traverse((part) => (part.renderOrder = 5));
  return group;
}

function aim(group: THREE.Group, at: number[], direction: number[], length: number): void {
  const d = new THREE.Vector3(direction[0], direction[1], direction[2]);
  group.visible = length > 0 && d.lengthSq() > 0;
  if (!group.visible) return;
  group.position.set(at[0], at[1], at[2]);
  group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), d.normalize());
  group.scale.setScalar(length);
}
