/** The room as the device sees it: drawn while scanning, met by rays, and sent to the bridge. */
import { BufferAttribute, BufferGeometry, Group, Mesh, MeshBasicMaterial, type Raycaster } from "three";
import type { Pose } from "../../generated/messages";
import { poseFromXr } from "../base/vec";
import { Signal } from "../base/signal";
import type { RoomMesh } from "../protocol/frames";
import { kRoom } from "../scene/colours";
import { discard } from "../scene/shapes";
import { poseOfTransform } from "./map_anchor";
import { fanTriangles, RoomScan, type Seen } from "./room_scan";
import type { RoomUploader } from "./room_uploader";

export class RoomView {
  /** In the own frame. */
  readonly group = new Group();
  readonly scanning = new Signal(true);
  private readonly scan = new RoomScan();
  private readonly meshes = new Map<number, Mesh>();

  constructor(private readonly uploader: RoomUploader) {
    this.scanning.watch((scanning) => (this.group.visible = scanning));
  }

  /** All is sent again at the next look, under the same numbers. */
  repeat(): void {
    this.scan.repeat();
  }

  /** All is new at the next look. */
  forget(): void {
    this.scan.forget();
    for (const mesh of this.meshes.values()) discard(mesh);
    this.meshes.clear();
  }

  /** @param now milliseconds */
  look(frame: XRFrame, space: XRReferenceSpace, viewer: XRRigidTransform, now: number): void {
    if (!this.scanning.value || !this.uploader.due(now)) return;
    const changed = this.scan.look(seenIn(frame, space));
    for (const mesh of changed) this.draw(mesh);
    const sensor: Pose = poseFromXr(poseOfTransform(viewer));
    void this.uploader.send(sensor, changed, now);
  }

  /** How far away a ray meets the room. */
  hit(caster: Raycaster): number | null {
    return caster.intersectObject(this.group, true)[0]?.distance ?? null;
  }

  private draw({ number, vertices, triangles }: RoomMesh): void {
    const before = this.meshes.get(number);
    if (before) discard(before);
    this.meshes.delete(number);
    if (vertices.length === 0) return;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(vertices, 3));
    geometry.setIndex(new BufferAttribute(triangles, 1));
    const mesh = new Mesh(geometry, new MeshBasicMaterial({ color: kRoom, wireframe: true, transparent: true, opacity: 0.25, depthWrite: false }));
    this.meshes.set(number, mesh);
    this.group.add(mesh);
  }
}

function seenIn(frame: XRFrame, space: XRReferenceSpace): Seen[] {
  const poseIn = (of: XRSpace): Pose | null => {
    const pose = frame.getPose(of, space);
    return pose ? poseOfTransform(pose.transform) : null;
  };
  const meshes = [...(frame.detectedMeshes ?? [])].map((mesh): Seen => ({
    key: mesh,
    changed: mesh.lastChangedTime,
    T_ref_mesh: poseIn(mesh.meshSpace),
    vertices: () => mesh.vertices,
    triangles: () => mesh.indices,
  }));
  const planes = [...(frame.detectedPlanes ?? [])].map((plane): Seen => ({
    key: plane,
    changed: plane.lastChangedTime,
    T_ref_mesh: poseIn(plane.planeSpace),
    vertices: () => plane.polygon.flatMap(({ x, y, z }) => [x, y, z]),
    triangles: () => fanTriangles(plane.polygon.length),
  }));
  return [...meshes, ...planes];
}
