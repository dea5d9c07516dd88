// The tail as a tube about its centreline: that of a wave, P = [s, b_s cos(ks - phase), -sign b_s sin(ks - phase)],
// or a series in the phase of points along it.

import * as THREE from "three";
import type { Filament } from "../state/types";

const AROUND = 14;
const CAP = 5;

/** A tail on the stage, where it stands on its body. */
export class TailMesh {
  readonly group = new THREE.Group();
  private tube = new Tube();
  private mesh: THREE.Mesh;
  private shape: Filament | null = null;

  constructor(material: THREE.Material) {
    this.mesh = new THREE.Mesh(this.tube.geometry, material);
    const { color } = material as THREE.MeshStandardMaterial;
    this.mesh.add(new THREE.Line(this.tube.core, new THREE.LineBasicMaterial({ color })));
    for (const part of [this.mesh, ...this.mesh.children]) part.frustumCulled = false;
    this.group.matrixAutoUpdate = false;
    this.group.add(this.mesh);
  }

  update(shape: Filament): void {
    this.shape = shape;
    const [a, b, c, d, e, f, g, h, i] = shape.rotation;
    const [x, y, z] = shape.root;
    this.group.matrix.set(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
    this.tube.update(shape, 0);
  }

  /** Turn it, or bend it, to a phase of the motor. */
  pose(motor: number): void {
    const { shape } = this;
    if (!shape) return;
    const phase = motor + shape.ahead;
    this.mesh.rotation.x = shape.rigid ? shape.sign * phase : 0;
    if (!shape.rigid) this.tube.update(shape, phase);
  }

  dispose(): void {
    this.tube.geometry.dispose();
    this.tube.core.dispose();
  }
}

class Tube {
  readonly geometry = new THREE.BufferGeometry();
  /** its centreline, a pixel wide: what is seen of a filament that is thinner than that from afar */
  readonly core = new THREE.BufferGeometry();
  private rings = 0;
  private points = new Float32Array(0);
  private normals = new Float32Array(0);

  /** Positions in the frame sqr, origin at the joint; the same arrays are written again. */
  update(shape: Filament, phase: number): void {
    const waves = Math.max(1, (shape.wavenumber * shape.length) / (2 * Math.PI));
    const rings = shape.line ? shape.line[0].length / 3 : Math.min(720, Math.ceil(26 * waves) + 8);
    if (rings !== this.rings) this.allocate(rings);
    const centre = shape.line ? followed(shape.line, phase) : this.wave(shape, phase, rings);
    const half = shape.section ?? [shape.radius, shape.radius];
    let normal = new THREE.Vector3(0, 1, 0);
    const tangent = new THREE.Vector3();
    const binormal = new THREE.Vector3();
    const tip = centre[rings - 1];
    for (let i = 0; i < rings + CAP; i++) {
      const here = i < rings ? centre[i] : tip;
      const [before, after] = i < rings ? [centre[Math.max(0, i - 1)], centre[Math.min(rings - 1, i + 1)]] : [centre[rings - 2], tip];
      if (shape.sheared) tangent.set(1, 0, 0);
      else tangent.subVectors(after, before).normalize();
      if (shape.section) normal = this.outward(shape, phase, (shape.length * Math.min(i, rings - 1)) / (rings - 1));
      normal = normal.addScaledVector(tangent, -normal.dot(tangent)).normalize();
      binormal.crossVectors(tangent, normal);
      const lift = i < rings ? 0 : ((i - rings + 1) / CAP) * (Math.PI / 2);
      const thin = 1 + ((shape.narrowing - 1) * Math.min(i, rings - 1)) / (rings - 1);
      this.ring(i, here, normal, binormal, tangent, half.map((a) => a * thin), lift);
    }
    this.core.setFromPoints(centre);
    for (const name of ["position", "normal"]) this.geometry.attributes[name].needsUpdate = true;
    this.geometry.computeBoundingSphere();
  }

  private wave(shape: Filament, phase: number, rings: number): THREE.Vector3[] {
    const end = shape.ramp * shape.length;
    return Array.from({ length: rings }, (_, i) => {
      const s = (shape.length * i) / (rings - 1);
      const full = shape.amplitude + ((shape.amplitude_end - shape.amplitude) * s) / shape.length;
      const b = full * (s < end ? s / end : 1);
      const out = this.outward(shape, phase, s, true);
      return out.multiplyScalar(b).setX(s);
    });
  }

  /** Where the wave swings out at s: in the plane of a plane wave always to the same side, unless with its size. */
  private outward(shape: Filament, phase: number, s: number, signed = false): THREE.Vector3 {
    const a = shape.wavenumber * s - phase;
    if (shape.kind === "helix") return new THREE.Vector3(0, Math.cos(a), -shape.sign * Math.sin(a));
    return new THREE.Vector3(0, signed ? Math.cos(a) : 1, 0);
  }

  private ring(i: number, p: THREE.Vector3, n: THREE.Vector3, b: THREE.Vector3, t: THREE.Vector3, half: number[], lift: number): void {
    const flat = Math.cos(lift);
    const up = Math.sin(lift);
    const [A, B] = half;
    const C = Math.min(A, B);
    for (let j = 0; j <= AROUND; j++) {
      const angle = (2 * Math.PI * j) / AROUND;
      const c = Math.cos(angle) * flat;
      const s = Math.sin(angle) * flat;
      const at = 3 * (i * (AROUND + 1) + j);
      // of an ellipse the normal goes with the inverse half axes
      const [cn, sn, un] = [(c * C) / A, (s * C) / B, up];
      const size = Math.hypot(cn, sn, un);
      for (const [k, axis] of (["x", "y", "z"] as const).entries()) {
        this.normals[at + k] = (cn * n[axis] + sn * b[axis] + un * t[axis]) / size;
        this.points[at + k] = p[axis] + A * c * n[axis] + B * s * b[axis] + C * up * t[axis];
      }
    }
  }

  private allocate(rings: number): void {
    this.rings = rings;
    this.core.deleteAttribute("position");
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

/** Points of a centreline at a phase. */
function followed(series: number[][], phase: number): THREE.Vector3[] {
  const x = [...series[0]];
  for (let h = 1; h < series.length; h += 2) {
    const [c, s] = [Math.cos(((h + 1) / 2) * phase), Math.sin(((h + 1) / 2) * phase)];
    for (let i = 0; i < x.length; i++) x[i] += c * series[h][i] + s * series[h + 1][i];
  }
  return Array.from({ length: x.length / 3 }, (_, i) => new THREE.Vector3(x[3 * i], x[3 * i + 1], x[3 * i + 2]));
}
