// The wall or the channel about a swimmer: glass with lines on it, still in the lab frame.

import * as THREE from "three";
import { rotate, type Pose, type Vec } from "../state/motion";
import type { Around, Shape } from "../state/types";

const FAR = 24;
const TINT = new THREE.Color("#9fc4e6");

const VERTEX = /* glsl */ `
  varying vec2 at;
  varying vec3 place, across, sight;
  void main() {
    at = uv;
    vec4 world = modelMatrix * vec4(position, 1.0);
    vec4 seen = viewMatrix * world;
    place = world.xyz;
    across = normalize(normalMatrix * normal);
    sight = -normalize(seen.xyz);
    gl_Position = projectionMatrix * seen;
  }`;

const GLASS = /* glsl */ `
  varying vec2 at;
  varying vec3 place, across, sight;
  uniform vec2 cells;
  uniform vec3 tint, middle;
  uniform float fill, reach;
  float lines(vec2 p) {
    vec2 d = abs(fract(p - 0.5) - 0.5) / fwidth(p);
    return 1.0 - min(min(d.x, d.y) / 1.1, 1.0);
  }
  void main() {
    float rim = pow(1.0 - abs(dot(normalize(across), normalize(sight))), 3.0);
    float far = reach > 0.0 ? 1.0 - smoothstep(0.1 * reach, reach, distance(place, middle)) : 1.0;
    float line = lines(at * cells);
    float strength = fill * (0.55 + 2.6 * rim) + 0.20 * line;
    gl_FragColor = vec4(mix(tint, vec3(1.0), 0.25 * line), min(strength, 0.6) * far * far);
  }`;

function glass(across: number, up: number, reach: number, fill: number): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({
    vertexShader: VERTEX, fragmentShader: GLASS, transparent: true, depthWrite: false, side: THREE.DoubleSide,
    uniforms: {
      cells: { value: new THREE.Vector2(across, up) }, tint: { value: TINT }, fill: { value: fill },
      middle: { value: new THREE.Vector3() }, reach: { value: reach },
    },
  });
}

export class Bounds {
  readonly group = new THREE.Group();
  private now = "";
  private bounds: Around | null = null;
  private glasses: THREE.ShaderMaterial[] = [];

  get kind(): string | null {
    return this.bounds?.kind ?? null;
  }

  update(bounds: Around | null, shape: Shape): void {
    const text = JSON.stringify([bounds, shape.length, shape.semi_axes]);
    if (text === this.now) return;
    this.now = text;
    this.bounds = bounds;
    this.dispose();
    if (!bounds) return;
    const cell = 2 * shape.semi_axes[1] || shape.length / 4;
    if (bounds.kind === "wall") this.wall(bounds, FAR * (shape.length + 2 * shape.semi_axes[0]), cell);
    else this.channel(bounds, cell);
  }

  /** A channel as long as a path in it, which takes it for endless; as it stands now. */
  endless(bounds: Around, places: number[], shape: Shape): Around {
    const along = new THREE.Vector3(1, 0, 0).applyQuaternion(this.group.quaternion);
    const [a, b, c] = bounds.middle!;
    const whole = shape.length + 2 * shape.semi_axes[0];
    let [low, high] = [-bounds.length! / 2, bounds.length! / 2];
    for (let i = 0; i < places.length; i += 3) {
      const s = along.x * (places[i] - a) + along.y * (places[i + 1] - b) + along.z * (places[i + 2] - c);
      [low, high] = [Math.min(low, s - whole), Math.max(high, s + whole)];
    }
    const middle = along.multiplyScalar((low + high) / 2).add(new THREE.Vector3(a, b, c));
    return { ...bounds, length: high - low, middle: [middle.x, middle.y, middle.z], open: true };
  }

  dispose(): void {
    for (const part of this.group.children as THREE.Mesh[]) {
      part.geometry.dispose();
      (part.material as THREE.Material).dispose();
    }
    this.group.clear();
    this.glasses = [];
  }

  private sheet(geometry: THREE.BufferGeometry, across: number, up: number, reach: number, fill: number): THREE.Mesh {
    const material = glass(across, up, reach, fill);
    this.glasses.push(material);
    const mesh = new THREE.Mesh(geometry, material);
    mesh.renderOrder = 2;
    this.group.add(mesh);
    return mesh;
  }

  /** A plane that faces the swimmer; it fades far away. */
  private wall(bounds: Around, size: number, cell: number): void {
    const n = new THREE.Vector3(...bounds.normal!);
    const mesh = this.sheet(new THREE.PlaneGeometry(size, size), size / cell, size / cell, 3.2, 0.34);
    mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), n);
    mesh.position.copy(n).multiplyScalar(-bounds.distance!);
    this.group.position.set(0, 0, 0);
    this.group.quaternion.identity();
  }

  private channel(bounds: Around, cell: number): void {
    const [d, l] = [bounds.diameter!, bounds.length!];
    const rings = Math.max(2, Math.round(l / cell));
    if (bounds.kind === "cylinder") {
      const tube = new THREE.CylinderGeometry(d / 2, d / 2, l, 96, 1, true).rotateZ(-Math.PI / 2);
      this.sheet(tube, 12, rings, 0, 0.075);
      this.rims([-l / 2, l / 2].map((s) => circle(d / 2, s)));
      if (!bounds.open) for (const s of [-1, 1]) this.sheet(new THREE.CircleGeometry(d / 2, 96).rotateY(Math.PI / 2).translate((s * l) / 2, 0, 0), 0.01, 0.01, 0, 0.05);
    } else {
      const sides = Math.max(2, Math.round(d / cell));
      for (let i = 0; i < 4; i++) {
        const side = new THREE.PlaneGeometry(l, d).translate(0, 0, d / 2).rotateX((i * Math.PI) / 2);
        this.sheet(side, rings, sides, 0, 0.075);
      }
      this.rims([-l / 2, l / 2].map((s) => square(d / 2, s)));
      if (!bounds.open) for (const s of [-1, 1]) this.sheet(new THREE.PlaneGeometry(d, d).rotateY(Math.PI / 2).translate((s * l) / 2, 0, 0), 0.01, 0.01, 0, 0.05);
    }
    this.group.position.set(...bounds.middle!);
    const about = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(1, 0, 0), bounds.azimuth!);
    this.group.quaternion.setFromAxisAngle(new THREE.Vector3(0, 0, 1), -bounds.tilt!).premultiply(about);
  }

  private rims(loops: THREE.Vector3[][]): void {
    for (const loop of loops) {
      const line = new THREE.LineLoop(new THREE.BufferGeometry().setFromPoints(loop), new THREE.LineBasicMaterial({ color: TINT, transparent: true, opacity: 0.5, toneMapped: false }));
      line.renderOrder = 2;
      this.group.add(line);
    }
  }

  /** Where the camera looks: what is far from there fades. */
  look(at: THREE.Vector3, reach: number): void {
    for (const g of this.glasses) {
      g.uniforms.middle.value.copy(at);
      if (g.uniforms.reach.value > 0) g.uniforms.reach.value = reach;
    }
  }

  /** Room between the swimmer at a pose and what bounds the fluid; infinite in free fluid. */
  room(pose: Pose, shape: Shape): number {
    const { bounds } = this;
    if (!bounds) return Infinity;
    const balls = surroundings(shape);
    return Math.min(...balls.map(([p, r]) => {
      const way = rotate(pose.q, p);
      return this.clear(bounds, [way[0] + pose.x[0], way[1] + pose.x[1], way[2] + pose.x[2]]) - r;
    }));
  }

  private clear(bounds: Around, p: Vec): number {
    if (bounds.kind === "wall") {
      const n = bounds.normal!;
      return bounds.distance! + n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
    }
    const away = new THREE.Vector3(...p).sub(this.group.position).applyQuaternion(this.group.quaternion.clone().invert());
    const out = bounds.kind === "cylinder" ? Math.hypot(away.y, away.z) : Math.max(Math.abs(away.y), Math.abs(away.z));
    const side = bounds.diameter! / 2 - out;
    return bounds.open ? side : Math.min(side, bounds.length! / 2 - Math.abs(away.x));
  }
}

/** Balls that hold the swimmer: centres from the body's, and radii. */
function surroundings(shape: Shape): [Vec, number][] {
  const [a, b, c] = shape.semi_axes;
  const balls: [Vec, number][] = [];
  const corners = shape.mesh?.points ?? [];
  for (let i = 0; i < corners.length; i += 3) balls.push([[corners[i], corners[i + 1], corners[i + 2]], 0]);
  for (let i = 0; a > 0 && !corners.length && i <= 8; i++) {
    const f = Math.cos((Math.PI * i) / 8);
    balls.push([[a * f, 0, 0], Math.max(b, c) * Math.sqrt(1 - f * f)]);
  }
  for (let i = 0; shape.length > 0 && i <= 16; i++) {
    const s = (shape.length * i) / 16;
    const grown = shape.ramp ? Math.min(1, s / (shape.ramp * shape.length)) : 1;
    balls.push([[a + s, 0, 0], shape.reach * grown + shape.radius]);
  }
  return balls;
}

const circle = (r: number, s: number): THREE.Vector3[] =>
  Array.from({ length: 96 }, (_, i) => new THREE.Vector3(s, r * Math.cos((i * Math.PI) / 48), r * Math.sin((i * Math.PI) / 48)));

const square = (h: number, s: number): THREE.Vector3[] =>
  [[-h, -h], [h, -h], [h, h], [-h, h]].map(([q, r]) => new THREE.Vector3(s, q, r));
