// The tail as a tube about its centreline: P = [s, b_s cos(ks - phase), -sign b_s sin(ks - phase)].

import * as THREE from "three";
import type { Shape } from "../state/types";

const AROUND = 14;
const CAP = 5;

export class Tube {
  readonly geometry = new THREE.BufferGeometry();
  private rings = 0;
  private points = new Float32Array(0);
  private normals = new Float32Array(0);

  /** Positions in the frame sqr, origin at the joint; the same arrays are written again. */
  update(shape: Shape, phase: number): void {
    const waves = Math.max(1, (shape.wavenumber * shape.length) / (2 * Math.PI));
    const rings = Math.min(720, Math.ceil(26 * waves) + 8);
    if (rings !== this.rings) this.allocate(rings);
    const centre = this.centreline(shape, phase, rings);
    let normal = new THREE.Vector3(0, 1, 0);
    const tangent = new THREE.Vector3();
    const binormal = new THREE.Vector3();
    const tip = centre[rings - 1];
    for (let i = 0; i < rings + CAP; i++) {
      const here = i < rings ? centre[i] : tip;
      const [before, after] = i < rings ? [centre[Math.max(0, i - 1)], centre[Math.min(rings - 1, i + 1)]] : [centre[rings - 2], tip];
      if (shape.sheared) tangent.set(1, 0, 0);
      else tangent.subVectors(after, before).normalize();
      normal = normal.addScaledVector(tangent, -normal.dot(tangent)).normalize();
      binormal.crossVectors(tangent, normal);
      const lift = i < rings ? 0 : ((i - rings + 1) / CAP) * (Math.PI / 2);
      this.ring(i, here, normal, binormal, tangent, shape.radius, lift);
    }
    for (const name of ["position", "normal"]) this.geometry.attributes[name].needsUpdate = true;
    this.geometry.computeBoundingSphere();
  }

  private centreline(shape: Shape, phase: number, rings: number): THREE.Vector3[] {
    const out = shape.kind === "helix" ? -shape.sign : 0;
    const end = shape.ramp * shape.length;
    return Array.from({ length: rings }, (_, i) => {
      const s = (shape.length * i) / (rings - 1);
      const b = shape.amplitude * (s < end ? s / end : 1);
      const a = shape.wavenumber * s - phase;
      return new THREE.Vector3(s, b * Math.cos(a), out * b * Math.sin(a));
    });
  }

  private ring(i: number, p: THREE.Vector3, n: THREE.Vector3, b: THREE.Vector3, t: THREE.Vector3, r: number, lift: number): void {
    const flat = Math.cos(lift);
    const up = Math.sin(lift);
    for (let j = 0; j <= AROUND; j++) {
      const angle = (2 * Math.PI * j) / AROUND;
      const c = Math.cos(angle) * flat;
      const s = Math.sin(angle) * flat;
      const at = 3 * (i * (AROUND + 1) + j);
      const x = c * n.x + s * b.x + up * t.x;
      const y = c * n.y + s * b.y + up * t.y;
      const z = c * n.z + s * b.z + up * t.z;
      this.normals[at] = x;
      this.normals[at + 1] = y;
      this.normals[at + 2] = z;
      this.points[at] = p.x + r * x;
      this.points[at + 1] = p.y + r * y;
      this.points[at + 2] = p.z + r * z;
    }
  }

  private allocate(rings: number): void {
    this.rings = rings;
    const rows = rings + CAP;
    this.points = new Float32Array(3 * rows * (AROUND + 1));
    this.normals = new Float32Array(3 * rows * (AROUND + 1));
    const index: number[] = [];
    for (let i = 0; i < rows - 1; i++) {
      for (let j = 0; j < AROUND; j++) {
        const a = i * (AROUND + 1) + j;
        const b = a + AROUND + 1;
        index.push(a, a + 1, b, a + 1, b + 1, b);
      }
    }
    this.geometry.setIndex(index);
    this.geometry.setAttribute("position", new THREE.BufferAttribute(this.points, 3));
    this.geometry.setAttribute("normal", new THREE.BufferAttribute(this.normals, 3));
  }
}
