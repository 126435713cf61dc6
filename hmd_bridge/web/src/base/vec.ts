/** Vectors and rigid transforms as they are on the wire: numbers in lists, metres, quaternions x y z w. */
import type { Pose } from "../../generated/messages";

export type Vec3 = [number, number, number];
export type Quat = [number, number, number, number];

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vec3, s: number): Vec3 => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec3, b: Vec3): Vec3 => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a: Vec3): number => Math.hypot(...a);
export const distance = (a: Vec3, b: Vec3): number => length(sub(a, b));
export const normalized = (a: Vec3): Vec3 => scale(a, 1 / (length(a) || 1));

export const kIdentity: Pose = { position: [0, 0, 0], rotation: [0, 0, 0, 1] };

export function multiplied(a: Quat, b: Quat): Quat {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
}

export function rotated(q: Quat, p: Vec3): Vec3 {
  const u: Vec3 = [q[0], q[1], q[2]];
  const t = scale(cross(u, p), 2);
  return add(add(p, scale(t, q[3])), cross(u, t));
}

/** p_a of p_b, given T_a_b. */
export const transformed = (T: Pose, p: Vec3): Vec3 => add(rotated(T.rotation, p), T.position);

/** T_a_c of T_a_b and T_b_c. */
export function composed(a: Pose, b: Pose): Pose {
  return { position: transformed(a, b.position), rotation: unit(multiplied(a.rotation, b.rotation)) };
}

export function inverse(T: Pose): Pose {
  const back: Quat = [-T.rotation[0], -T.rotation[1], -T.rotation[2], T.rotation[3]];
  return { position: scale(rotated(back, T.position), -1), rotation: back };
}

export function unit(q: Quat): Quat {
  const norm = Math.hypot(...q) || 1;
  return [q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm];
}

/** A turn about the vertical axis of a z-up frame. */
export const fromYaw = (yaw: number): Quat => [0, 0, Math.sin(yaw / 2), Math.cos(yaw / 2)];
export const yawOf = (q: Quat): number => Math.atan2(2 * (q[3] * q[2] + q[0] * q[1]), 1 - 2 * (q[1] ** 2 + q[2] ** 2));

/** The same turn without its tilt: what stands upright stays upright. */
export const levelled = (T: Pose): Pose => ({ position: T.position, rotation: fromYaw(yawOf(T.rotation)) });

/** From WebXR's y-up frame to z up, and back. */
export const fromXr = (p: Vec3): Vec3 => [p[0], -p[2], p[1]];
export const toXr = (p: Vec3): Vec3 => [p[0], p[2], -p[1]];
export const poseFromXr = (T: Pose): Pose => ({
  position: fromXr(T.position),
  rotation: [T.rotation[0], -T.rotation[2], T.rotation[1], T.rotation[3]],
});
