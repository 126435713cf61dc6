/**
 * The scene: a y-up world as WebXR has it; in it the own frame, z up; in that the map under one T_own_map, which is the
 * identity on a desk. Draws only when something changed, but each frame in an immersive session.
 */
import { Color, Group, Matrix4, PerspectiveCamera, Ray, Scene, Vector3, WebGLRenderer } from "three";
import type { Pose } from "../../generated/messages";
import { kIdentity, type Vec3 } from "../base/vec";
import { kBackground } from "./colours";
import { place, vec } from "./three_pose";

export interface MapRay {
  /** In the map's frame, metres. */
  origin: Vec3;
  direction: Vec3;
}

export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(55, 1, 0.05, 500);
  readonly renderer: WebGLRenderer;
  /** This device's own frame, z up. */
  readonly own = new Group();
  /** The map's frame, in the own one. */
  readonly map = new Group();
  readonly mapFromWorld = new Matrix4();
  /** Called before each frame, drawn or not. @param seconds since the one before */
  readonly onFrame = new Set<(seconds: number, frame: XRFrame | undefined) => void>();
  private changed = true;
  private last = 0;

  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.xr.enabled = true;
    this.scene.background = new Color(kBackground);
    this.own.rotation.x = -Math.PI / 2;
    this.scene.add(this.own);
    this.own.add(this.map);
    this.setMapPose(kIdentity);
    this.renderer.setAnimationLoop((time: number, frame?: XRFrame) => this.frame(time, frame));
  }

  /** T_own_map */
  setMapPose(T: Pose): void {
    place(this.map, T);
    this.scene.updateMatrixWorld(true);
    this.mapFromWorld.copy(this.map.matrixWorld).invert();
    this.invalidate();
  }

  invalidate(): void {
    this.changed = true;
  }

  resize(width: number, height: number): void {
    if (this.renderer.xr.isPresenting) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  /** A ray of the world in the map's frame. */
  toMap(ray: Ray): MapRay {
    const inMap = ray.clone().applyMatrix4(this.mapFromWorld);
    return { origin: vec(inMap.origin), direction: vec(inMap.direction.normalize()) };
  }

  fromMap(p: Vec3): Vector3 {
    return new Vector3(...p).applyMatrix4(this.map.matrixWorld);
  }

  private frame(time: number, frame?: XRFrame): void {
    const seconds = Math.min(0.1, (time - this.last) / 1000);
    this.last = time;
    for (const watcher of this.onFrame) watcher(seconds, frame);
    if (!this.changed && !this.renderer.xr.isPresenting) return;
    this.changed = false;
    this.renderer.render(this.scene, this.camera);
  }
}
