// The flow on a slice through the swimmer: speed as colour, drifting specks show where it goes.

import * as THREE from "three";
import { colour } from "../panels/scales";
import type { FlowAnswer } from "../state/types";

const SPECKS = 700;
const TAIL = 9;

/** Where a share of the largest speed stands on the scale of colours: slow flow is to be seen too. */
const seen = (share: number): number => Math.min(1, share) ** 0.55;

/** Colours of even steps of speed, from rest to the largest. */
export const speeds = (count: number): string[] =>
  Array.from({ length: count }, (_, i) => `rgb(${colour(seen(i / (count - 1))).map(Math.round).join(" ")})`);

export class Flow {
  readonly group = new THREE.Group();
  private flow: FlowAnswer | null = null;
  private field = new Float32Array(0);
  private pixels = new Uint8Array(4);
  private texture: THREE.DataTexture;
  private plane: THREE.Mesh;
  private specks: THREE.LineSegments;
  private ways: number[][] = [];

  constructor() {
    this.texture = new THREE.DataTexture(this.pixels, 1, 1);
    this.plane = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), new THREE.MeshBasicMaterial({
      map: this.texture, transparent: true, side: THREE.DoubleSide, depthWrite: false, toneMapped: false,
    }));
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(6 * SPECKS * (TAIL - 1)), 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(6 * SPECKS * (TAIL - 1)), 3));
    this.specks = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({
      vertexColors: true, transparent: true, opacity: 0.9, blending: THREE.AdditiveBlending, depthWrite: false, toneMapped: false,
    }));
    this.specks.frustumCulled = false;
    this.group.add(this.plane, this.specks);
    this.group.visible = false;
  }

  get shown(): boolean {
    return this.group.visible;
  }

  get answer(): FlowAnswer | null {
    return this.flow;
  }

  /** Whether it is that of two swimmers, which stay where they are meanwhile. */
  get ofBoth(): boolean {
    return this.shown && Boolean(this.flow?.frame);
  }

  /** Let the motors of both go round by an angle; in the flow of a moment they stand. */
  turn(angle: number): void {
    if (this.flow && this.flow.series.length > 1) this.turned += angle;
  }

  /** angle that the motors of both have gone round since it was asked for */
  turned = 0;

  /** s, q, r of the velocity at the points of the slice, now. */
  get velocities(): Float32Array {
    return this.field;
  }

  clear(): void {
    this.flow = null;
    this.group.visible = false;
  }

  show(flow: FlowAnswer): void {
    this.flow = flow;
    const [rows, columns] = flow.shape;
    this.field = new Float32Array(3 * rows * columns);
    this.pixels = new Uint8Array(4 * rows * columns);
    this.texture.dispose();
    this.texture = new THREE.DataTexture(this.pixels, columns, rows);
    this.texture.magFilter = this.texture.minFilter = THREE.LinearFilter;
    this.texture.colorSpace = THREE.SRGBColorSpace;
    (this.plane.material as THREE.MeshBasicMaterial).map = this.texture;
    (this.plane.material as THREE.MeshBasicMaterial).needsUpdate = true;
    const [s0, s1] = flow.s;
    const [q0, q1] = flow.q;
    this.plane.scale.set(s1 - s0, q1 - q0, 1);
    this.plane.position.set((s0 + s1) / 2, (q0 + q1) / 2, 0);
    const { origin, quaternion } = flow.frame ?? { origin: [0, 0, 0], quaternion: [1, 0, 0, 0] };
    const [w, x, y, z] = quaternion;
    this.group.position.set(origin[0], origin[1], origin[2]);
    this.group.quaternion.set(x, y, z, w);
    this.turned = 0;
    this.ways = Array.from({ length: SPECKS }, () => this.born());
    this.group.visible = true;
  }

  /** The field at a phase; specks drift for a time. */
  update(phase: number, time: number): void {
    const { flow } = this;
    if (!flow || !this.shown) return;
    this.field.set(flow.series[0]);
    for (let h = 1; h < flow.series.length; h += 2) {
      const c = Math.cos(((h + 1) / 2) * phase);
      const s = Math.sin(((h + 1) / 2) * phase);
      const a = flow.series[h];
      const b = flow.series[h + 1];
      for (let i = 0; i < this.field.length; i++) this.field[i] += c * a[i] + s * b[i];
    }
    this.paint(flow);
    this.drift(flow, time);
  }

  private paint(flow: FlowAnswer): void {
    const [rows, columns] = flow.shape;
    for (let i = 0; i < rows * columns; i++) {
      const v = Math.hypot(this.field[3 * i], this.field[3 * i + 1], this.field[3 * i + 2]) / flow.scale;
      const t = seen(v);
      const [red, green, blue] = colour(t);
      const x = Math.abs((2 * (i % columns)) / (columns - 1) - 1);
      const y = Math.abs((2 * Math.floor(i / columns)) / (rows - 1) - 1);
      const edge = (1 - x ** 6) * (1 - y ** 6);
      this.pixels.set([red, green, blue, 175 * t * edge], 4 * i);
    }
    this.texture.needsUpdate = true;
  }

  private born(): number[] {
    const { s, q } = this.flow!;
    const x = s[0] + Math.random() * (s[1] - s[0]);
    const y = q[0] + Math.random() * (q[1] - q[0]);
    const way = [Math.random() * 120];
    for (let i = 0; i < TAIL; i++) way.push(x, y);
    return way;
  }

  private velocity(flow: FlowAnswer, x: number, y: number): [number, number] {
    const [rows, columns] = flow.shape;
    const u = ((x - flow.s[0]) / (flow.s[1] - flow.s[0])) * (columns - 1);
    const v = ((y - flow.q[0]) / (flow.q[1] - flow.q[0])) * (rows - 1);
    const i = Math.min(columns - 2, Math.max(0, Math.floor(u)));
    const j = Math.min(rows - 2, Math.max(0, Math.floor(v)));
    const [a, b] = [u - i, v - j];
    const at = (m: number, n: number, k: number): number => this.field[3 * (n * columns + m) + k];
    const mix = (k: number): number =>
      (1 - b) * ((1 - a) * at(i, j, k) + a * at(i + 1, j, k)) + b * ((1 - a) * at(i, j + 1, k) + a * at(i + 1, j + 1, k));
    return [mix(0), mix(1)];
  }

  private drift(flow: FlowAnswer, time: number): void {
    const points = this.specks.geometry.attributes.position.array as Float32Array;
    const shades = this.specks.geometry.attributes.color.array as Float32Array;
    let at = 0;
    for (let n = 0; n < SPECKS; n++) {
      let way = this.ways[n];
      const [vx, vy] = this.velocity(flow, way[1], way[2]);
      way[0] += 1;
      const x = way[1] + time * vx;
      const y = way[2] + time * vy;
      const out = x < flow.s[0] || x > flow.s[1] || y < flow.q[0] || y > flow.q[1];
      if (out || way[0] > 160) way = this.ways[n] = this.born();
      else {
        way.splice(1, 0, x, y);
        way.length = 1 + 2 * TAIL;
      }
      const glow = Math.min(1, way[0] / 20, (160 - way[0]) / 30) * 0.75;
      for (let k = 0; k < TAIL - 1; k++) {
        for (const m of [k, k + 1]) {
          points[at] = way[1 + 2 * m];
          points[at + 1] = way[2 + 2 * m];
          points[at + 2] = 0;
          const f = glow * (1 - m / TAIL);
          shades[at] = 0.62 * f;
          shades[at + 1] = 0.85 * f;
          shades[at + 2] = 0.95 * f;
          at += 3;
        }
      }
    }
    this.specks.geometry.attributes.position.needsUpdate = true;
    this.specks.geometry.attributes.color.needsUpdate = true;
  }
}
