/** Poses of the wire as three.js has them, and back. */
import { Matrix4, Quaternion, Vector3, type Object3D } from "three";
import type { Pose } from "../../generated/messages";
import type { Vec3 } from "../base/vec";

export function place(object: Object3D, T: Pose): void {
  object.position.set(...T.position);
  object.quaternion.set(...T.rotation);
  object.updateMatrixWorld(true);
}

export function poseOf(matrix: Matrix4): Pose {
  const position = new Vector3();
  const rotation = new Quaternion();
  matrix.decompose(position, rotation, new Vector3());
  return { position: position.toArray(), rotation: [rotation.x, rotation.y, rotation.z, rotation.w] };
}

export const vec = (v: Vector3): Vec3 => [v.x, v.y, v.z];
