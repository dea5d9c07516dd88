// The stage: light, floor of the lab frame, camera, scale bar. Lengths are those of the swimmer times `scale`.

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

import { captioned, type Caption } from "./picture";

const FLOOR = /* glsl */ `
  varying vec3 place;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    place = world.xyz;
    gl_Position = projectionMatrix * viewMatrix * world;
  }`;

const GRID = /* glsl */ `
  varying vec3 place;
  uniform float cell;
  uniform vec3 middle;
  uniform float reach;
  float lines(vec2 p, float width) {
    vec2 d = abs(fract(p - 0.5) - 0.5) / fwidth(p);
    return 1.0 - min(min(d.x, d.y) / width, 1.0);
  }
  void main() {
    vec2 p = place.xy / cell;
    float fine = lines(p, 1.1) * 0.30;
    float coarse = lines(p / 5.0, 1.3) * 0.75;
    float far = 1.0 - smoothstep(0.15 * reach, reach, distance(place.xy, middle.xy));
    gl_FragColor = vec4(vec3(0.42, 0.58, 0.72), max(fine, coarse) * far * far * 0.55);
  }`;

/** Lengths of the swimmer that the picture has room for, where the camera stands at first. */
const ROOM = 1.2;

export class Stage {
  readonly renderer: THREE.WebGLRenderer;
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(32, 1, 0.01, 400);
  readonly controls: OrbitControls;
  readonly world = new THREE.Group();
  follow = true;
  scale = 1;
  private floor: THREE.Mesh;
  /** how much farther off the camera stands because the swimmer has grown */
  private farther = 1;
  private slow = 0;
  /** share of the full resolution; less where the graphics are too slow for it */
  private quality = 1;
  /** share of width and height in whose middle the target is */
  private clear = [1, 1];
  /** pixels that panels cover at both sides, and the width over height at which what is free shows the swimmer whole */
  private sides = { left: 0, right: 0, whole: 1.15 };
  private aim = new THREE.Vector3();
  private size = new THREE.Vector2();

  constructor(private host: HTMLElement) {
    this.renderer = new THREE.WebGLRenderer({ antialias: true, powerPreference: "high-performance" });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.toneMapping = THREE.ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 1.0;
    host.append(this.renderer.domElement);
    this.scene.background = backdrop();
    const key = new THREE.DirectionalLight("#fff3df", 3.1);
    key.position.set(-3, 4, 6);
    const rim = new THREE.DirectionalLight("#6fb7ff", 3.2);
    rim.position.set(4, -6, 1.5);
    const fill = new THREE.DirectionalLight("#8fd6d0", 0.7);
    fill.position.set(-5, 3, -3);
    this.scene.add(key, rim, fill, new THREE.HemisphereLight("#b3c9e2", "#1b2430", 0.9), this.world);
    this.floor = new THREE.Mesh(new THREE.PlaneGeometry(80, 80), new THREE.ShaderMaterial({
      vertexShader: FLOOR, fragmentShader: GRID, transparent: true, depthWrite: false, side: THREE.DoubleSide,
      uniforms: { cell: { value: 0.2 }, middle: { value: new THREE.Vector3() }, reach: { value: 4.2 } },
    }));
    this.floor.position.z = -0.42;
    this.scene.add(this.floor);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.minDistance = 0.25;
    this.controls.maxDistance = 30;
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
    this.reset();
  }

  /** Share of the width, from the left, and of the height, from above, that no sheet covers. */
  uncover(width: number, height: number): void {
    this.clear = [width, height];
    this.resize();
  }

  /** Panels that stand at the sides all the time; zero where they are sheets. */
  between(left: number, right: number): void {
    this.sides = { left, right, whole: left || right ? 0.85 : 1.15 };
    this.resize();
  }

  /** How much farther off the camera must be for the swimmer to fit into what is free. */
  private get fits(): number {
    const { left, right, whole } = this.sides;
    const { clientWidth: w, clientHeight: h } = this.host;
    return Math.max(1, (whole * h) / Math.max(1, w - left - right));
  }

  /** Call when a finger touches the scene. */
  onTouch(act: () => void): void {
    this.renderer.domElement.addEventListener("pointerdown", (e) => {
      if (e.pointerType === "touch") act();
    });
  }

  /** Camera from ahead and above, farther off on a tall screen; the swimmer swims to the right. */
  reset(distance = 2.75): void {
    this.face(distance * this.fits);
  }

  /** The same from just so far, or as far as it is. */
  face(distance = this.camera.position.distanceTo(this.controls.target)): void {
    const way = new THREE.Vector3(-0.16, 0.9, 0.36).normalize().multiplyScalar(distance);
    this.controls.target.copy(this.aim);
    this.camera.position.copy(this.aim).add(way);
    this.controls.update();
  }

  /** Camera on a place and what lies within a reach of it, in units of the swimmer; from the side a normal points to. */
  see(middle: readonly number[], reach: number, normal: readonly number[] | null): void {
    const way = new THREE.Vector3(-0.16, 0.9, 0.36).normalize();
    if (normal) way.addScaledVector(new THREE.Vector3(...normal), 1.6);
    this.controls.target.set(middle[0], middle[1], middle[2]).multiplyScalar(this.scale);
    const distance = (1.7 * reach * this.scale) / Math.tan((this.camera.fov * Math.PI) / 360);
    this.camera.position.copy(this.controls.target).addScaledVector(way.normalize(), Math.min(distance * this.fits, 0.9 * this.controls.maxDistance));
    this.controls.update();
  }

  /** Longest length of the swimmer is one on the stage. */
  fit(length: number, diameter: number): void {
    this.scale = 1 / length;
    this.farther = 1;
    this.world.scale.setScalar(this.scale);
    (this.floor.material as THREE.ShaderMaterial).uniforms.cell.value = diameter * this.scale;
  }

  /** Hold a swimmer in the picture that has grown since it was fitted, nearer again as it shrinks. */
  hold(length: number): void {
    const farther = Math.max(1, length * this.scale / ROOM);
    const way = this.camera.position.clone().sub(this.controls.target);
    this.camera.position.copy(this.controls.target).addScaledVector(way, farther / this.farther);
    this.farther = farther;
  }

  /** Where the camera looks, in units of the swimmer. */
  look(centre: THREE.Vector3, now: boolean): void {
    const wanted = centre.clone().multiplyScalar(this.scale);
    const moved = wanted.sub(this.aim).multiplyScalar(now ? 1 : 0.12);
    this.aim.add(moved);
    if (!this.follow && !now) return;
    this.controls.target.add(moved);
    this.camera.position.add(moved);
  }

  render(): void {
    const at = this.controls.target;
    this.floor.position.set(at.x, at.y, this.floor.position.z);
    const material = this.floor.material as THREE.ShaderMaterial;
    material.uniforms.middle.value.copy(at);
    material.uniforms.reach.value = this.reach;
    this.controls.update();
    this.renderer.render(this.scene, this.camera);
  }

  /** The lab's grid; walls have their own lines. */
  set ground(shown: boolean) {
    this.floor.visible = shown;
  }

  /** How far one sees lines. */
  get reach(): number {
    return 2.2 + 0.8 * this.camera.position.distanceTo(this.controls.target);
  }

  /** Length on the stage of a pixel at the target. */
  get pixel(): number {
    const height = 2 * this.camera.position.distanceTo(this.controls.target) * Math.tan((this.camera.fov * Math.PI) / 360);
    return height / this.host.clientHeight / this.scale;
  }

  /** Draw fewer pixels where frames take long, as with graphics in software. */
  adapt(milliseconds: number): void {
    this.slow = milliseconds > 120 ? this.slow + 1 : Math.max(0, this.slow - 1);
    if (this.slow < 8 || this.quality <= 0.5) return;
    this.slow = 0;
    this.sharpen(this.quality * 0.7);
  }

  sharpen(quality: number): void {
    this.quality = quality;
    this.renderer.setPixelRatio(quality * Math.min(window.devicePixelRatio, 2));
  }

  /** In full resolution, whatever was shown, with its caption. */
  async picture(caption: Caption): Promise<Blob> {
    const shown = this.quality;
    this.sharpen(1);
    this.render();
    const scene = this.renderer.domElement;
    const made = captioned(scene, scene.width / this.host.clientWidth, caption);
    this.sharpen(shown);
    return made;
  }

  private resize(): void {
    const { clientWidth: w, clientHeight: h } = this.host;
    if (w !== this.size.x || h !== this.size.y) this.renderer.setSize(w, h); // which is slow
    this.renderer.getSize(this.size);
    this.camera.aspect = w / h;
    const [x, y] = this.clear.map((share) => 0.5 * (1 - share));
    const { left, right } = this.sides;
    this.camera.setViewOffset(w, h, x * w + 0.5 * (right - left), y * h, w, h);
    this.camera.updateProjectionMatrix();
  }
}

const WATER: [number, number[]][] = [[0, [28, 43, 59]], [0.45, [18, 28, 40]], [1, [8, 12, 18]]];

/** Dark water, a little lighter behind the swimmer; with grain, so that no steps show. */
function backdrop(): THREE.DataTexture {
  const n = 512;
  const pixels = new Uint8Array(4 * n * n);
  for (let at = 0; at < n * n; at++) {
    const far = Math.min(1, Math.hypot((at % n) / n - 0.5, Math.floor(at / n) / n - 0.55) / 0.74);
    const [[a, inner], [b, outer]] = far < WATER[1][0] ? WATER : WATER.slice(1);
    const share = (far - a) / (b - a);
    const grain = Math.random() * 3 - 1;
    for (let j = 0; j < 3; j++) pixels[4 * at + j] = inner[j] + share * (outer[j] - inner[j]) + grain;
    pixels[4 * at + 3] = 255;
  }
  const texture = new THREE.DataTexture(pixels, n, n);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}
