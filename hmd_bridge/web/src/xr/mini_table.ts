/** Two small maps before the person: the other's stays, one's own is taken in the hand and put onto it. */
import { Group, InstancedMesh, Matrix4, MeshBasicMaterial, Sphere, Vector3, type Raycaster } from "three";
import { middleOf, type AlignSession, type Aligning } from "../edit/align_session";
import { kMinimap } from "../scene/colours";
import { minimapObject } from "../scene/edit_overlay";
import { discard, nameSprite } from "../scene/shapes";
import { place, poseOf } from "../scene/three_pose";
import type { Pointer } from "./pointers";

const kScale = 1 / 16;
const kTarget = 0xd6d3d1;
const kReach = 2.2;

export class MiniTable {
  /** In the world; the frame of the target, small. */
  readonly group = new Group();
  private readonly frame = new Group();
  private readonly source = new Group();
  private shown: Float32Array | null = null;
  private grabbed: { pointer: Pointer; T_pointer_source: Matrix4 } | null = null;

  /** @param ahead puts the table where the person looks */
  constructor(
    private readonly align: AlignSession,
    private readonly ahead: (table: Group) => void,
  ) {
    this.group.scale.setScalar(kScale);
    this.group.add(this.frame);
    this.frame.add(this.source);
    align.current.watch((aligning) => this.show(aligning));
  }

  get open(): boolean {
    return this.shown !== null;
  }

  /** Takes the own small map into the hand, if the ray meets it. */
  grab(pointer: Pointer): boolean {
    if (!this.open || !this.met(pointer.caster)) return false;
    this.source.updateWorldMatrix(true, false);
    this.grabbed = { pointer, T_pointer_source: pointer.space.matrixWorld.clone().invert().multiply(this.source.matrixWorld) };
    return true;
  }

  letGo(pointer: Pointer): void {
    if (this.grabbed?.pointer === pointer) this.grabbed = null;
  }

  update(): void {
    if (!this.grabbed) return;
    const { pointer, T_pointer_source } = this.grabbed;
    const inWorld = pointer.space.matrixWorld.clone().multiply(T_pointer_source);
    this.frame.updateWorldMatrix(true, false);
    this.align.place(poseOf(this.frame.matrixWorld.clone().invert().multiply(inWorld)));
  }

  private met(caster: Raycaster): boolean {
    const bounds = new Sphere();
    for (const part of this.source.children) {
      if (!(part instanceof InstancedMesh)) continue;
      part.computeBoundingSphere();
      bounds.copy(part.boundingSphere!).applyMatrix4(part.matrixWorld);
    }
    const hit = caster.ray.intersectSphere(bounds, new Vector3());
    return hit !== null && hit.distanceTo(caster.ray.origin) < kReach;
  }

  private show(aligning: Aligning | null): void {
    if (!aligning || aligning.points !== this.shown) this.clear();
    this.group.visible = aligning !== null;
    if (!aligning) return;
    if (!this.shown) this.build(aligning);
    place(this.source, aligning.guess);
  }

  private build({ points, targetPoints, source, target }: Aligning): void {
    this.shown = points;
    this.source.add(minimapObject(points), named(source, kMinimap, points));
    const middle = middleOf(targetPoints ?? points);
    this.frame.position.set(-middle[0], -middle[1], -middle[2]);
    if (targetPoints) {
      const other = minimapObject(targetPoints);
      (other.material as MeshBasicMaterial).color.set(kTarget);
      this.frame.add(other, named(target ?? "the map", kTarget, targetPoints));
    }
    this.ahead(this.group);
  }

  private clear(): void {
    this.shown = null;
    this.grabbed = null;
    for (const child of [...this.source.children, ...this.frame.children]) if (child !== this.source) discard(child);
  }
}

function named(name: string, colour: number, points: Float32Array): ReturnType<typeof nameSprite> {
  const sprite = nameSprite(name, colour, 0.9);
  const [x, y, z] = middleOf(points);
  sprite.position.set(x, y, z + 3);
  return sprite;
}
