/** Looks at the map from a desk: orbiting it, or straight from above. */
import { MOUSE, Ray, Vector2, Vector3, Raycaster, TOUCH } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Stage } from "./stage";
import type { Vec3 } from "../base/vec";

const kFromAbove = 0.001;

export class DeskCamera {
  readonly controls: OrbitControls;
  private fromAbove = false;

  constructor(
    private readonly stage: Stage,
    private readonly canvas: HTMLCanvasElement,
  ) {
    this.controls = new OrbitControls(stage.camera, canvas);
    this.controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
    this.controls.touches = { ONE: TOUCH.ROTATE, TWO: TOUCH.DOLLY_PAN };
    this.controls.minDistance = 0.5;
    this.controls.maxDistance = 300;
    this.controls.keyPanSpeed = 24;
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener("change", () => stage.invalidate());
    this.frameBox([-5, -5, 0], [5, 5, 2.5]);
  }

  get above(): boolean {
    return this.fromAbove;
  }

  /** The point that is looked at, in the map. */
  get centre(): Vec3 {
    const p = this.controls.target.clone().applyMatrix4(this.stage.mapFromWorld);
    return [p.x, p.y, p.z];
  }

  /** Shows all of a box of the map. */
  frameBox(low: Vec3, high: Vec3): void {
    const middle = low.map((l, i) => (l + high[i]!) / 2) as Vec3;
    const radius = Math.max(2, Math.hypot(high[0] - low[0], high[1] - low[1]) / 2);
    const target = this.stage.fromMap(middle);
    this.controls.target.copy(target);
    const away = this.fromAbove ? new Vector3(0, 1, kFromAbove) : new Vector3(0.55, 0.75, 0.85);
    this.stage.camera.position.copy(target).addScaledVector(away.normalize(), radius * 2);
    this.controls.update();
    this.stage.invalidate();
  }

  setAbove(above: boolean): void {
    if (above === this.fromAbove) return;
    this.fromAbove = above;
    const { camera } = this.stage;
    const distance = camera.position.distanceTo(this.controls.target);
    const away = above ? new Vector3(0, 1, kFromAbove) : new Vector3(0.55, 0.75, 0.85);
    camera.position.copy(this.controls.target).addScaledVector(away.normalize(), distance);
    this.controls.maxPolarAngle = above ? 0.01 : Math.PI * 0.92;
    this.controls.mouseButtons.LEFT = above ? MOUSE.PAN : MOUSE.ROTATE;
    this.controls.touches.ONE = above ? TOUCH.PAN : TOUCH.ROTATE;
    this.controls.update();
    this.stage.invalidate();
  }

  /** Through a point of the canvas, in the world. */
  ray(event: { clientX: number; clientY: number }): Ray {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const caster = new Raycaster();
    caster.setFromCamera(at, this.stage.camera);
    return caster.ray;
  }
}
