/** What of the room's mesh is new since the last look. Values in, values out: the frame's meshes and planes are handed in. */
import type { Pose } from "../../generated/messages";
import { fromXr, transformed } from "../base/vec";
import { meshPayload, type RoomMesh, type SensorPose } from "../protocol/frames";

/** A mesh or a plane as a frame of WebXR has it; vertices in its own space, y up. */
export interface Seen {
  key: object;
  /** When it last changed, as the device says. */
  changed: number;
  /** In the y-up reference space; null while it is not known. */
  T_ref_mesh: Pose | null;
  vertices: () => ArrayLike<number>;
  triangles: () => ArrayLike<number>;
}

interface Known {
  number: number;
  changed: number;
  pose: string;
}

/** A pose that moved by less than this, in metres and parts of a quaternion, is the same. */
const kStill = 0.005;

export class RoomScan {
  private readonly known = new Map<object, Known>();
  private gone: number[] = [];
  private numbers = 0;

  /** The meshes that changed, in the own frame, and those that are gone (without vertices). */
  look(seen: readonly Seen[]): RoomMesh[] {
    const out: RoomMesh[] = [];
    const present = new Set<object>();
    for (const each of seen) {
      present.add(each.key);
      if (!each.T_ref_mesh) continue;
      const pose = [...each.T_ref_mesh.position, ...each.T_ref_mesh.rotation].map((c) => Math.round(c / kStill)).join(",");
      const before = this.known.get(each.key);
      if (before?.changed === each.changed && before.pose === pose) continue;
      const number = before?.number ?? this.numbers++;
      this.known.set(each.key, { number, changed: each.changed, pose });
      out.push({ number, vertices: inOwnFrame(each.T_ref_mesh, each.vertices()), triangles: Uint32Array.from(each.triangles()) });
    }
    for (const [key, { number }] of this.known) {
      if (present.has(key)) continue;
      this.known.delete(key);
      out.push({ number, vertices: new Float32Array(), triangles: new Uint32Array() });
    }
    for (const number of this.gone.splice(0)) out.push({ number, vertices: new Float32Array(), triangles: new Uint32Array() });
    return out;
  }

  /** All meshes are new: the own frame is another, or the server begins anew with what it is sent next. */
  forget(): void {
    this.known.clear();
    this.gone = [];
    this.numbers = 0;
  }

  /** A look may not have arrived: all meshes are sent again under the numbers that they have, and what is gone is said to be gone again. */
  repeat(): void {
    const present = new Set([...this.known.values()].map(({ number }) => number));
    this.gone = Array.from({ length: this.numbers }, (_, number) => number).filter((number) => !present.has(number));
    for (const each of this.known.values()) each.changed = NaN;
  }
}

function inOwnFrame(T_ref_mesh: Pose, vertices: ArrayLike<number>): Float32Array {
  const out = new Float32Array(vertices.length);
  for (let i = 0; i + 2 < vertices.length; i += 3) out.set(fromXr(transformed(T_ref_mesh, [vertices[i]!, vertices[i + 1]!, vertices[i + 2]!])), i);
  return out;
}

/** A plane's corners lie around a convex or star-shaped outline: a fan about the first covers it. */
export const fanTriangles = (corners: number): number[] => Array.from({ length: Math.max(0, corners - 2) }, (_, i) => [0, i + 1, i + 2]).flat();

export function sensorOf({ position, rotation }: Pose): SensorPose {
  return [...position, ...rotation];
}

const kFrameBytes = 3_000_000;
const kFrameMeshes = 1024;
const bytesOf = ({ vertices, triangles }: RoomMesh): number => 12 + 4 * (vertices.length + triangles.length);

/** Splits what has changed into frames that a server takes; one empty frame if nothing has. */
export function payloads(sensor: Pose, meshes: readonly RoomMesh[]): { meshes: number; payload: Uint8Array<ArrayBuffer> }[] {
  const groups: RoomMesh[][] = [[]];
  let bytes = 0;
  for (const mesh of meshes) {
    if (bytes > 0 && (bytes + bytesOf(mesh) > kFrameBytes || groups.at(-1)!.length >= kFrameMeshes)) {
      groups.push([]);
      bytes = 0;
    }
    groups.at(-1)!.push(mesh);
    bytes += bytesOf(mesh);
  }
  return groups.map((group) => ({ meshes: group.length, payload: meshPayload(sensorOf(sensor), group) }));
}

