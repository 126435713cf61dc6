/**
 * A double of the bridge for what the real one does not do on demand: it holds a small office, keeps a log of what was asked,
 * and refuses what a test tells it to.
 */
import { createReadStream, existsSync } from "node:fs";
import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import { extname, join, normalize } from "node:path";
import { WebSocketServer, type WebSocket } from "ws";
import type { Agent, Answers, Code, Events, Instance, Operation, Path, Pose, Refusal, Requests, RobotPose, Shape } from "../../../hmd_bridge/web/generated/messages";
import { checkNotice, checkRequest } from "../../../hmd_bridge/web/generated/messages";
import { readHeaderOf } from "./upload";
import { office, pointsFrame, type VoxelMap } from "./voxel_map";
import type { Triple } from "../../../hmd_bridge/web/src/protocol/frames";

const kTypes: Record<string, string> = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml", ".map": "application/json" };
const kResolution = 0.05;
const at = (x: number, y: number, z = 0): Pose => ({ position: [x, y, z], rotation: [0, 0, 0, 1] });

interface Asked { name: string; body: unknown }
type Done = { [K in keyof Requests]?: (body: Requests[K], socket: WebSocket, id: number) => Answers[K] };

export class FakeServer {
  readonly asked: Asked[] = [];
  readonly notices: Asked[] = [];
  readonly uploads: { sequence: number; meshes: number; frameId: string | undefined }[] = [];
  readonly map: VoxelMap = office();
  token: string | null = null;
  role: "view" | "edit" | "robot" = "robot";
  agents: Agent[] = [
    { agent: "robot1", type: "lidar", frame_id: "a", aligned: true, T_map_agent: at(0, 0), weight: 100, revision: 5, known: 90000, occupied: 31000 },
    { agent: "robot2", type: "lidar", frame_id: "b", aligned: false, weight: 100, revision: 3, known: 40000, occupied: 12000 },
  ];
  poses: RobotPose[] = [{ agent: "robot1", T_map_base: at(-2, -0.5), utime: 1, stale: false }];
  private readonly refusals = new Map<string, Refusal>();
  private readonly operations: Operation[] = [];
  private readonly undone = new Map<string, { voxels: Triple[]; occupied: boolean }>();
  private readonly sockets = new Set<WebSocket>();
  private revision = 1;
  private tickets = 0;
  private readonly http: Server;

  constructor(private readonly folder: string) {
    this.http = createServer((request, response) => {
      const url = request.url ?? "/";
      if (url === "/api/info") {
        response.setHeader("Content-Type", "application/json").end(JSON.stringify({ protocol: "hmd.v1", ticket_needed: this.token !== null }));
      } else if (url === "/api/ticket") {
        const good = request.headers.authorization === `Bearer ${this.token}`;
        response.writeHead(good ? 200 : 401).end(good ? JSON.stringify({ ticket: `t${++this.tickets}`, seconds: 10 }) : "");
      } else {
        const file = join(this.folder, normalize(url === "/" ? "/index.html" : url));
        if (!existsSync(file)) return void response.writeHead(404).end();
        response.setHeader("Content-Type", kTypes[extname(file)] ?? "text/plain");
        createReadStream(file).pipe(response);
      }
    });
    new WebSocketServer({ server: this.http, path: "/ws" }).on("connection", (socket) => this.connected(socket));
  }

  /** Its address. */
  async start(): Promise<string> {
    await new Promise<void>((resolve) => this.http.listen(0, "127.0.0.1", resolve));
    return `http://127.0.0.1:${(this.http.address() as AddressInfo).port}`;
  }

  stop(): void {
    this.dropConnections();
    this.http.close();
  }

  dropConnections(): void {
    for (const socket of this.sockets) socket.terminate();
  }

  /** The next request of this name is refused. */
  refuseNext(name: keyof Answers, code: Code, message: string): void {
    this.refusals.set(name, { code, message, retry: false });
  }

  lastAsked<K extends keyof Requests>(name: K): Requests[K] | undefined {
    return this.asked.findLast((each) => each.name === name)?.body as Requests[K] | undefined;
  }

  tellAll<K extends keyof Events>(event: K, body: Events[K]): void {
    for (const socket of this.sockets) this.say(socket, event, body);
  }

  private connected(socket: WebSocket): void {
    this.sockets.add(socket);
    socket.on("close", () => this.sockets.delete(socket));
    socket.on("message", (data: Buffer, binary: boolean) => (binary ? this.upload(socket, data) : this.text(socket, data.toString())));
  }

  private text(socket: WebSocket, text: string): void {
    const { id, request, notice, body } = JSON.parse(text) as { id: number; request?: keyof Requests; notice?: string; body: never };
    const problem = request ? checkRequest(request, body) : checkNotice(notice!, body);
    if (problem) throw new Error(problem);
    if (!request) return void this.notices.push({ name: notice!, body });
    this.asked.push({ name: request, body });
    const refusal = this.refusals.get(request);
    this.refusals.delete(request);
    const done = this.does[request] as ((body: unknown, socket: WebSocket, id: number) => unknown) | undefined;
    const answer = refusal ?? !done ? { id, error: refusal ?? { code: "UNAVAILABLE", message: `${request} is not tried here.`, retry: false } } : { id, answer: done(body, socket, id) };
    socket.send(JSON.stringify(answer));
    if (request === "hello" && !refusal) this.begin(socket);
    if (request === "view") this.sendView(socket, body as Requests["view"]);
  }

  private upload(socket: WebSocket, data: Buffer): void {
    const { id, sequence, meshes } = readHeaderOf(data);
    const refusal = this.refusals.get("upload_mesh");
    this.refusals.delete("upload_mesh");
    if (refusal) return void socket.send(JSON.stringify({ id, error: refusal }));
    const where = this.notices.findLast(({ name }) => name === "tracking")?.body as { frame_id: string } | undefined;
    this.uploads.push({ sequence, meshes, frameId: where?.frame_id });
    socket.send(JSON.stringify({ id, answer: { sequence, occupied: 100 * this.uploads.length } }));
  }

  private begin(socket: WebSocket): void {
    this.say(socket, "agents", { agents: this.agents });
    this.say(socket, "poses", { poses: this.poses });
    this.say(socket, "people", { people: [{ person: 9, name: "Bo", device: "HoloLens 2", T_map_head: at(-3, 0.6, 1.65), p_map_pointer: [-1.6, 3.5, 0.9] }] });
    this.say(socket, "zones", { zones: [{ name: "lift", zone_kind: "no_go", volume: { kind: "box", min: [3.2, -3.8, 0], max: [4.8, -2.4, 1] }, T_map_zone: at(0, 0), author: "Bo", revision: 1 }] });
    this.say(socket, "leases", { leases: [] });
  }

  private sendView(socket: WebSocket, { layer }: Requests["view"]): void {
    const stream = streamOf(layer);
    if (layer === "map") for (const frame of this.map.frames(stream, this.revision)) socket.send(frame);
    this.complete(socket, stream);
  }

  private complete(socket: WebSocket, stream: number): void {
    this.say(socket, "complete", { stream, epoch: "e", revision: this.revision, map_revision: this.revision, synced: true });
  }

  private say<K extends keyof Events>(socket: WebSocket, event: K, body: Events[K]): void {
    socket.send(JSON.stringify({ event, body }));
  }

  private change(voxels: Triple[]): void {
    ++this.revision;
    for (const socket of this.sockets) {
      for (const frame of this.map.frames(0, this.revision, voxels)) socket.send(frame);
      this.complete(socket, 0);
    }
  }

  private turn(edit: string, active: boolean): { revision: number; voxels: number } {
    if (edit.startsWith("label/") || edit.startsWith("asset-")) return { revision: this.revision, voxels: 640 };
    const { voxels, occupied } = this.undone.get(edit)!;
    for (const voxel of voxels) this.map.set(voxel, active ? occupied : !occupied);
    this.operations.find(({ operation }) => operation === edit)!.active = active;
    this.change(voxels);
    return { revision: this.revision, voxels: voxels.length };
  }

  private edit(shape: Shape, occupied: boolean): { edit: string; revision: number; voxels: number } {
    const [low, high] = boundsOf(shape);
    const voxels = this.map.fill(low, high, occupied);
    const edit = `edit-${this.operations.length + 1}`;
    this.undone.set(edit, { voxels, occupied });
    this.operations.push({ revision: this.revision, operation: edit, author: "Ana", utime: 1_790_000_000_000_000, what: occupied ? "add" : "delete", subject: "", count: voxels.length, active: true });
    this.change(voxels);
    return { edit, revision: this.revision, voxels: voxels.length };
  }

  /** Round the end of the wall, or, once something stands in the opening, along the other side. */
  private path(robot: string): Path {
    const blocked = this.map.has([1, 12, 4]);
    const corners: Triple[] = blocked ? [[-2, -0.5, 0], [-1, -0.75, 0], [2, -0.8, 0], [4, 0, 0]] : [[-2, -0.5, 0], [0, 0.6, 0], [4, 0, 0]];
    const points = corners.map((p, i) => ({ p, clearance: i === 0 ? 1 : blocked ? 0.2 : 0.7 }));
    return { robot, status: "OK", message: "", frame: "map", points, length: blocked ? 7.2 : 6.3, clearance: blocked ? 0.2 : 0.7, plan: "p", plan_number: blocked ? 2 : 1, map_revision: this.revision, active: true, seconds: blocked ? 14 : 12, zones: [] };
  }

  /** What is labelled. */
  things: Instance[] = [];

  /** Something was seen, and waits for somebody's word. */
  propose(detection: string): void {
    this.tellAll("detection", { detection, class_name: "chair", T_map_object: at(1, 0), score: 0.83, by: "robot1", open: true });
  }

  private decide(detection: string): void {
    this.tellAll("detection", { detection, class_name: "chair", T_map_object: at(1, 0), score: 0.83, by: "robot1", open: false });
  }

  private readonly does: Done = {
    hello: ({ resume }) => ({
      session: "s", person: 1, role: this.role, name: "Ana", resumed: resume !== undefined, resolution: kResolution, epoch: "e", utime: 1_790_000_000_000_000,
      limits: { text_bytes: 1 << 20, binary_bytes: 4 << 20, requests_per_second: 50, upload_bytes_per_second: 1e6, burst_requests: 100, burst_upload_bytes: 4e6, idle_seconds: 30 },
    }),
    clock: ({ t0 }) => ({ t0, t1: 1_790_000_000_000_000, t2: 1_790_000_000_000_000 }),
    agents: () => ({ agents: this.agents }),
    view: ({ layer }) => ({ stream: streamOf(layer), blocks: 12, lacking: 12 }),
    view_close: () => ({}),
    edit: ({ op, shape }) => this.edit(shape, op === "add"),
    undo: ({ edit }) => this.turn(edit, false),
    redo: ({ edit }) => this.turn(edit, true),
    history: () => ({ operations: this.operations }),
    instances: () => ({ instances: this.things, in_all: this.things.length }),
    label: () => ({ label: 3, instance: 1, voxels: 640, undo: "label/1" }),
    label_touch: () => ({ label: 4, instance: 1, voxels: 120, min: [0, 0, 0], max: [0.5, 0.5, 0.9], undo: "label/2" }),
    labels: () => {
      const labels = this.things.length > 0 ? [{ label: 3, name: "desk", instances: this.things.length, voxels: 640 }] : [];
      return { labels, in_all: labels.length };
    },
    label_rename: () => ({ undo: "label/3" }),
    instance_reassign: ({ label }) => ({ label: label + 1, instance: 1, voxels: 640, undo: "label/4" }),
    instance_delete: ({ label, instance }) => {
      this.things = this.things.filter((thing) => thing.label !== label || thing.instance !== instance);
      return { voxels: 640, undo: "label/5" };
    },
    asset_add: () => ({ label: 5, instance: 1, voxels: 99, revision: 9, undo: "asset-1" }),
    asset_move: () => ({ voxels: 99, revision: 10, undo: "asset-2" }),
    asset_delete: ({ label, instance }) => {
      this.things = this.things.filter((thing) => thing.label !== label || thing.instance !== instance);
      return { revision: 11 };
    },
    detection_confirm: ({ detection }) => {
      this.decide(detection);
      return { label: 5, instance: 2, voxels: 99, revision: 12, undo: "asset-3", message: "chair 2 is put in, 64 % of its surface within a voxel of the map's" };
    },
    detection_reject: ({ detection }) => {
      this.decide(detection);
      return {};
    },
    lease_hold: () => ({}),
    lease_free: () => ({}),
    place: () => ({ revision: 2 }),
    send_map: () => ({ occupied: 4711, free: 9000, revision: 2 }),
    maps: () => ({ maps: [{ file: "ground-floor.concord", bytes: 1_830_000 }] }),
    conflicts: () => ({ regions: [{ low: [0, -20, 0], high: [2, 44, 40], voxels: 640, claims: [{ agent: "robot1", occupied: 0, free: 640 }, { agent: "robot2", occupied: 640, free: 0 }] }], regions_in_all: 1, voxels_in_all: 640 }),
    assets: () => ({ assets: [{ asset: "chair-1", class_name: "chair", size: [0.5, 0.5, 0.9], gltf: "/models/s/chair-1.glb" }] }),
    path: ({ robot }) => ({ path: this.path(robot) }),
    goal: ({ robot }) => ({ path: this.path(robot) }),
    plan: ({ robot }) => ({ path: this.path(robot) }),
    obstacle_add: ({ volume }) => {
      const { edit, revision, voxels } = this.edit(volume, true);
      this.tellAll("path", { robot: "robot1", path: this.path("robot1") });
      return { obstacle: edit, revision, voxels, paths: [{ robot: "robot1", status: "OK", replanned: true, plan_number: 2 }] };
    },
    minimap: ({ agent }, socket, id) => {
      const cells = new Set(this.map.all().filter(([x, , z]) => x > -70 && z >= 0).map((voxel) => voxel.map((v) => Math.floor(v / 10)).join(",")));
      const points = [...cells].flatMap((cell) => cell.split(",").map((c) => Number(c) * 0.5 + 0.25));
      socket.send(pointsFrame(id, points));
      return { agent, frame_id: "b", points: cells.size };
    },
    align: () => ({ align: "al1", T_target_source: at(0, 0), evidence: { overlap: 0.71, rms: 0.031, free_space_violation: 0.01, iterations: 18, ms: 240, loose: [] }, message: "" }),
    align_accept: () => {
      this.agents = this.agents.map((agent) => (agent.agent === "robot1" ? agent : { ...agent, aligned: true, T_map_agent: at(0, 0) }));
      this.tellAll("agents", { agents: this.agents });
      return { agent: "robot2", T_map_agent: at(0, 0), revision: 2 };
    },
    align_drop: () => ({}),
  };
}

const streamOf = (layer: string): number => ["map", "conflicts", "grid_occupied", "grid_free", "labels", "agent"].indexOf(layer);

/** The voxels of the box around a shape. */
function boundsOf(shape: Shape): [Triple, Triple] {
  const points = shape.kind === "box" ? [shape.min, shape.max]
    : shape.kind === "prism" ? shape.points.flatMap(([x, y]) => [[x, y, shape.low], [x, y, shape.high]])
    : shape.kind === "line" || shape.kind === "area" ? shape.points : [];
  const along = (axis: number): number[] => points.map((p) => p[axis]! / kResolution);
  return [[0, 1, 2].map((axis) => Math.floor(Math.min(...along(axis)))) as Triple, [0, 1, 2].map((axis) => Math.ceil(Math.max(...along(axis))) - 1) as Triple];
}
