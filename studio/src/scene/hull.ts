// The body as what it is: an ellipsoid from its semi-axes, anything else from its own surface.

import * as THREE from "three";
import { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import type { Shape } from "../state/types";

/** faces that meet at more than this angle (rad) show an edge */
const CREASE = 0.9;
const STRIPES = 6;

export class Hull {
  readonly mesh: THREE.Mesh;
  private ball = ball();
  private now: Shape["mesh"] = null;

  constructor(colour: string) {
    this.mesh = new THREE.Mesh(this.ball, new THREE.MeshStandardMaterial({ map: stripes(colour), roughness: 0.42 }));
  }

  update(shape: Shape): void {
    const [a, b, c] = shape.semi_axes;
    this.mesh.visible = a > 0;
    if (!a) return;
    if (shape.mesh) this.mesh.scale.setScalar(1);
    else this.mesh.scale.set(a, b, c);
    if (JSON.stringify(shape.mesh) === JSON.stringify(this.now)) return;
    this.now = shape.mesh;
    if (this.mesh.geometry !== this.ball) this.mesh.geometry.dispose();
    this.mesh.geometry = shape.mesh ? surface(shape.mesh) : this.ball;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.ball.dispose();
  }
}

/** A texture that changes nothing: with one, tails and bodies share a program on the graphics, which takes long to compile. */
export function plain(): THREE.Texture {
  const white = new THREE.DataTexture(new Uint8Array([255, 255, 255, 255]), 1, 1);
  white.needsUpdate = true;
  return white;
}

function ball(): THREE.BufferGeometry {
  return new THREE.SphereGeometry(1, 64, 48).rotateZ(Math.PI / 2);
}

function surface({ points, faces }: { points: number[]; faces: number[] }): THREE.BufferGeometry {
  const index: number[] = [];
  for (let i = 0; i < faces.length; i += 4) {
    const [a, b, c, d] = faces.slice(i, i + 4);
    for (const corners of [[a, b, c], [a, c, d]]) if (new Set(corners).size === 3) index.push(...corners);
  }
  const whole = new THREE.BufferGeometry();
  whole.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  whole.setIndex(index);
  const made = toCreasedNormals(whole, CREASE);
  made.setAttribute("uv", new THREE.Float32BufferAttribute(around(made.attributes.position.array), 2));
  return made;
}

/** Angle about s, a turn being one; the corners of a triangle lie on the same side of the seam. */
function around(points: ArrayLike<number>): number[] {
  const uv: number[] = [];
  for (let t = 0; t < points.length; t += 9) {
    const u = [0, 3, 6].map((k) => Math.atan2(points[t + k + 2], points[t + k + 1]) / (2 * Math.PI));
    const top = Math.max(...u);
    for (const v of u) uv.push(top - v > 0.5 ? v + 1 : v, 0.5);
  }
  return uv;
}

/** Meridians on the body, so that one sees it turn. */
function stripes(colour: string): THREE.CanvasTexture {
  const canvas = document.createElement("canvas");
  canvas.width = 512;
  canvas.height = 64;
  const g = canvas.getContext("2d")!;
  g.fillStyle = colour;
  g.fillRect(0, 0, 512, 64);
  for (let i = 0; i < STRIPES; i++) {
    g.fillStyle = i === 0 ? "rgba(20,40,60,.42)" : "rgba(20,40,60,.14)";
    g.fillRect((i * 512) / STRIPES + 20, 0, i === 0 ? 26 : 12, 64);
  }
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.wrapS = THREE.RepeatWrapping;
  texture.anisotropy = 4;
  return texture;
}
