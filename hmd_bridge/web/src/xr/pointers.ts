/** Controllers and hands: each a ray with two buttons. A pinch selects as a trigger does. */
import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial, Raycaster, SphereGeometry, Vector3 } from "three";
import { kSelection } from "../scene/colours";
import type { Stage } from "../scene/stage";

export type PointerAct = "select" | "squeeze";

const kRayMetres = 4;
const kTipMetres = 0.08;

export class Pointer {
  readonly caster = new Raycaster();
  connected = false;
  private readonly line: Line;
  private readonly dot: Mesh;

  constructor(
    readonly space: Group,
    readonly index: number,
  ) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.of(0, 0, 0, 0, 0, -1), 3));
    this.line = new Line(geometry, new LineBasicMaterial({ color: 0xffffff, transparent: true, opacity: 0.7 }));
    this.dot = new Mesh(new SphereGeometry(0.012, 12, 8), new MeshBasicMaterial({ color: kSelection, depthTest: false, transparent: true }));
    this.dot.renderOrder = 21;
    space.add(this.line, this.dot);
  }

  /** Takes up where the hand is now. */
  update(): void {
    this.space.updateWorldMatrix(true, false);
    this.caster.ray.origin.setFromMatrixPosition(this.space.matrixWorld);
    this.caster.ray.direction.set(0, 0, -1).transformDirection(this.space.matrixWorld);
  }

  /** A little ahead of the hand. */
  tip(): Vector3 {
    return this.caster.ray.at(kTipMetres, new Vector3());
  }

  /** Draws the ray as far as what it meets; null: it meets nothing. */
  showReach(distance: number | null): void {
    this.space.visible = this.connected;
    this.line.scale.z = distance ?? kRayMetres;
    this.dot.visible = distance !== null;
    this.dot.position.z = -(distance ?? 0);
  }
}

export class Pointers {
  readonly all: readonly Pointer[];
  onStart: (pointer: Pointer, act: PointerAct) => void = () => {};
  onEnd: (pointer: Pointer, act: PointerAct) => void = () => {};

  constructor(stage: Stage) {
    this.all = [0, 1].map((index) => {
      const space = stage.renderer.xr.getController(index);
      const pointer = new Pointer(space, index);
      stage.scene.add(space);
      space.addEventListener("connected", () => (pointer.connected = true));
      space.addEventListener("disconnected", () => (pointer.connected = false));
      for (const act of ["select", "squeeze"] as const) {
        space.addEventListener(`${act}start`, () => this.began(pointer, act));
        space.addEventListener(`${act}end`, () => this.onEnd(pointer, act));
      }
      return pointer;
    });
  }

  update(): void {
    for (const pointer of this.all) pointer.update();
  }

  hide(): void {
    for (const pointer of this.all) pointer.space.visible = false;
  }

  private began(pointer: Pointer, act: PointerAct): void {
    pointer.update();
    this.onStart(pointer, act);
  }
}
