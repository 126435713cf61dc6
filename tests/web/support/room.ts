/** A captured room (`@iwer/sem`), as a robot that went round in it would have mapped it. */
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { WebSocket } from "ws";
import "./raw_deflate";
import type { Pose } from "../../../hmd_bridge/web/generated/messages";
import { composed, fromXr, transformed, type Quat, type Vec3 } from "../../../hmd_bridge/web/src/base/vec";
import { Link, type Socket } from "../../../hmd_bridge/web/src/link/link";
import { meshFrame, meshPayload, packPayload, type RoomMesh } from "../../../hmd_bridge/web/src/protocol/frames";
import { sensorOf } from "../../../hmd_bridge/web/src/xr/room_scan";
import { capturesFolder } from "./paths";

interface Entity {
  locatable_META: { position: Record<"x" | "y" | "z", number>; orientation: Record<"x" | "y" | "z" | "w", number> };
  triangleMesh_META?: { vertices: string; indices: string };
}

const kPoseMs = 200;
/** A cell exists from its second look on. */
const kLooks = 2;

export const captureFile = (room: string): string => join(capturesFolder, `${room}.json`);

/** The mesh of the whole room, z up. */
export function meshOf(room: string): RoomMesh {
  const { spatialEntities } = JSON.parse(readFileSync(captureFile(room), "utf8")) as { spatialEntities: Entity[] };
  const { locatable_META: at, triangleMesh_META: mesh } = spatialEntities.find((entity) => entity.triangleMesh_META)!;
  const bytes = (text: string): ArrayBuffer => Uint8Array.from(Buffer.from(text, "base64")).buffer;
  const raw = new Float32Array(bytes(mesh!.vertices));
  const T = { position: [at.position.x, at.position.y, at.position.z] as Vec3, rotation: [at.orientation.x, at.orientation.y, at.orientation.z, at.orientation.w] as Quat };
  const vertices = new Float32Array(raw.length);
  for (let i = 0; i < raw.length; i += 3) vertices.set(fromXr(transformed(T, [raw[i]!, raw[i + 1]!, raw[i + 2]!])), i);
  return { number: 0, vertices, triangles: new Uint32Array(bytes(mesh!.indices)) };
}

/** What a robot is: where its frame begins in the room, where it stands, and from where it has looked. In the room, z up. */
export interface Robots {
  T_odom_room: Pose;
  base: Vec3;
  eyes: readonly Vec3[];
}

export class Robot {
  readonly link: Link;
  private readonly poses: NodeJS.Timeout;

  private constructor(
    url: string,
    private readonly name: string,
    private readonly T_odom_room: Pose,
    p_room_base: Vec3,
  ) {
    this.link = new Link({
      open: () => new WebSocket(`${url.replace("http", "ws")}ws`, "hmd.v1") as unknown as Socket,
      ticket: () => Promise.resolve(undefined),
      who: () => ({ name: this.name, device: "robot", agent: this.name, frame_id: "odom" }),
      now: () => Date.now(),
      later: (milliseconds, what) => void setTimeout(what, milliseconds).unref(),
    });
    const T_own_head = composed(T_odom_room, { position: p_room_base, rotation: [0, 0, 0, 1] });
    this.poses = setInterval(() => this.link.state.value.state === "ready" && this.link.notice("tracking", { state: "ok", frame_id: "odom", T_own_head }), kPoseMs);
  }

  /**
   * One that has looked at the room.
   * @returns once the bridge has taken all of it
   */
  static async map(url: string, name: string, room: RoomMesh, { T_odom_room, base, eyes }: Robots): Promise<Robot> {
    const robot = new Robot(url, name, T_odom_room, base);
    await new Promise<void>((ready, failed) => {
      robot.link.onReady = () => ready();
      robot.link.state.onChange((state) => state.state === "refused" && failed(new Error(`${name}: ${state.why}`)));
      robot.link.connect();
    });
    await robot.look(room, eyes);
    return robot;
  }

  stop(): void {
    clearInterval(this.poses);
    this.link.close();
  }

  private async look(room: RoomMesh, eyes: readonly Vec3[]): Promise<void> {
    const vertices = new Float32Array(room.vertices.length);
    for (let i = 0; i < vertices.length; i += 3) {
      vertices.set(transformed(this.T_odom_room, [room.vertices[i]!, room.vertices[i + 1]!, room.vertices[i + 2]!]), i);
    }
    let sequence = 0;
    for (const eye of Array.from({ length: kLooks }, () => eyes).flat()) {
      const sensor = sensorOf(composed(this.T_odom_room, { position: eye, rotation: [0, 0, 0, 1] }));
      const meshes = sequence === 0 ? [{ ...room, vertices }] : [];
      const packed = await packPayload(meshPayload(sensor, meshes));
      const number = sequence++;
      await this.link.upload((id) => meshFrame(id, number, meshes.length, packed));
    }
    await this.link.request("send_map", { final: false });
  }
}

