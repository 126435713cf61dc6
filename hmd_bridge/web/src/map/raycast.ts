/** What a ray through the voxels meets first (Amanatides and Woo, A fast voxel traversal algorithm, 1987). */
import type { Triple } from "../protocol/frames";
import type { Vec3 } from "../base/vec";
import { add, scale } from "../base/vec";

export interface VoxelHit {
  voxel: Triple;
  /** Of the face that was met; zero where the ray began inside. */
  normal: Triple;
  /** Metres. */
  point: Vec3;
  distance: number;
}

/**
 * @param origin, direction in the lattice's frame, metres; the direction is a unit vector
 * @param resolution edge of a voxel, metres
 * @param reach metres
 */
export function raycast(occupied: (voxel: Triple) => boolean, origin: Vec3, direction: Vec3, resolution: number, reach: number): VoxelHit | null {
  const voxel = origin.map((p) => Math.floor(p / resolution)) as Triple;
  const step = direction.map(Math.sign) as Triple;
  const perCell = direction.map((d) => (d === 0 ? Infinity : Math.abs(resolution / d))) as Vec3;
  const next = direction.map((d, i) => {
    if (d === 0) return Infinity;
    return ((voxel[i]! + (d > 0 ? 1 : 0)) * resolution - origin[i]!) / d;
  }) as Vec3;
  const normal: Triple = [0, 0, 0];
  let at = 0;
  while (at <= reach) {
    if (occupied(voxel)) return { voxel: [...voxel], normal: [...normal], point: add(origin, scale(direction, at)), distance: at };
    const axis = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : next[1] <= next[2] ? 1 : 2;
    at = next[axis];
    next[axis] += perCell[axis];
    voxel[axis] += step[axis];
    normal.fill(0);
    normal[axis] = -step[axis] || 0;
  }
  return null;
}
