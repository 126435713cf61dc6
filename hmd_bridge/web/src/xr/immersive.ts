/** The immersive session: the map over the real room, in one's hands. On the same modules as the desk. */
import { Color, Group, Matrix4, Vector3 } from "three";
import type { App } from "../app";
import type { Vec3 } from "../base/vec";
import { kIdentity, poseFromXr } from "../base/vec";
import { kBackground } from "../scene/colours";
import { vec } from "../scene/three_pose";
import { MapAnchor, poseOfTransform } from "./map_anchor";
import { Menu } from "./menu";
import { MiniTable } from "./mini_table";
import { blockedWords, type OwnFrame } from "./own_frame";
import { Pointers, type Pointer, type PointerAct } from "./pointers";
import { RoomUploader } from "./room_uploader";
import { RoomView } from "./room_view";
import { ScenePanel } from "./scene_panel";

const kTrackingMs = 66;
const kAimMs = 80;
const kInAir = 1.5;
const kReach = 30;
const kDragMetres = 0.15;

export async function immersiveSupported(): Promise<boolean> {
  return (await navigator.xr?.isSessionSupported("immersive-ar")) ?? false;
}

export class Immersive {
  readonly room: RoomView;
  readonly menu: Menu;
  readonly panel = new ScenePanel();
  readonly table: MiniTable;
  readonly uploader: RoomUploader;
  private readonly pointers: Pointers;
  private readonly anchor = new MapAnchor();
  private session: XRSession | null = null;
  private space: XRReferenceSpace | null = null;
  private saidWhere = -Infinity;
  private pressedAt: Vec3 | null = null;
  private pointed: Vec3 | null = null;
  private placePanel = false;
  /** Of the head in the world, which is the reference space; as of this frame, before three.js has it. */
  private readonly viewer = new Matrix4();
  private aimedAt = -Infinity;
  /** The hand that pressed last. */
  private leading: Pointer;

  constructor(
    private readonly app: App,
    readonly own: OwnFrame,
  ) {
    const { stage } = app;
    this.uploader = new RoomUploader(app.link, app.news, { forget: () => this.room.forget(), repeat: () => this.room.repeat() }, () => own.reset());
    this.room = new RoomView(this.uploader);
    this.menu = new Menu(app, own, this.room);
    this.table = new MiniTable(app.align, (table) => this.putAhead(table, 0.75, -0.35));
    this.pointers = new Pointers(stage);
    this.leading = this.pointers.all[0]!;
    this.pointers.hide();
    this.menu.page.watch((page) => this.panel.show(page));
    this.menu.onLeave = () => void this.session?.end();
    this.pointers.onStart = (pointer, act) => this.began(pointer, act);
    this.pointers.onEnd = (pointer, act) => this.ended(pointer, act);
    app.world.agents.watch(() => own.hear(app.world.agent(own.agent)));
    own.standing.watch(() => this.stand());
    own.frameId.onChange(() => {
      this.uploader.restart();
      this.saidWhere = -Infinity;
    });
    stage.onFrame.add((_, frame) => frame && this.frame(frame));
  }

  get presenting(): boolean {
    return this.session !== null;
  }

  /** Rejects where the device or the person refuses. */
  async enter(): Promise<void> {
    const session = await navigator.xr!.requestSession("immersive-ar", {
      requiredFeatures: ["local-floor"],
      optionalFeatures: ["anchors", "hand-tracking", "mesh-detection", "plane-detection"],
    });
    const { stage } = this.app;
    session.addEventListener("end", () => this.left());
    stage.renderer.xr.setReferenceSpaceType("local-floor");
    await stage.renderer.xr.setSession(session);
    this.session = session;
    this.space = stage.renderer.xr.getReferenceSpace();
    // The origin of a new session is another one.
    this.own.reset();
    this.space?.addEventListener("reset", () => this.own.reset());
    stage.scene.background = null;
    stage.own.add(this.room.group);
    stage.scene.add(this.panel.mesh, this.table.group);
    this.app.editOverlay.setMinimapShown(false);
    this.app.eyes = { here: () => this.head(), lookAt: () => this.app.news.done("It is drawn in the map around you.") };
    this.placePanel = true;
    this.stand();
  }

  private left(): void {
    const { stage } = this.app;
    this.session = null;
    this.space = null;
    this.pointers.hide();
    stage.scene.background = new Color(kBackground);
    for (const object of [this.room.group, this.panel.mesh, this.table.group]) object.removeFromParent();
    this.app.editOverlay.setMinimapShown(true);
    this.app.align.cancel();
    this.stand();
    this.onLeft();
  }
  /** The desk takes over. */
  onLeft: () => void = () => {};

  /** What follows from where this device stands: the map's place, and whether it may be changed. */
  private stand(): void {
    const { stage, layers, editor } = this.app;
    const standing = this.own.standing.value;
    const aligned = standing.state === "aligned";
    if (!this.session) {
      editor.blocked.set(null);
      this.anchor.stand(null, this.own.frameId.value);
      stage.setMapPose(kIdentity);
      stage.map.visible = true;
      return;
    }
    editor.blocked.set(blockedWords(standing));
    this.anchor.stand(standing, this.own.frameId.value);
    stage.map.visible = aligned;
    if (aligned) layers.setCentre(this.head());
  }

  private frame(frame: XRFrame): void {
    if (!this.session || !this.space) return;
    const viewer = frame.getViewerPose(this.space);
    this.own.setTracked(viewer !== undefined && !viewer.emulatedPosition && this.session.visibilityState !== "hidden");
    const now = performance.now();
    if (viewer) {
      this.viewer.fromArray(viewer.transform.matrix);
      const T_own_map = this.anchor.update(frame, this.space, viewer.transform);
      if (T_own_map) this.app.stage.setMapPose(T_own_map);
      if (this.placePanel) this.putPanelAhead();
    }
    this.pointers.update();
    for (const pointer of this.pointers.all) this.aim(pointer, now);
    this.table.update();
    // A new frame is said before the first look in it: the server takes a look to be in the frame that was said last.
    if (now - this.saidWhere > kTrackingMs) this.sayWhere(viewer?.transform, now);
    if (viewer && this.own.standing.value.state !== "lost") this.room.look(frame, this.space, viewer.transform, now);
  }

  private sayWhere(viewer: XRRigidTransform | undefined, now: number): void {
    this.saidWhere = now;
    const lost = this.own.standing.value.state === "lost";
    const pointer = this.pointed && vec(this.app.stage.own.worldToLocal(this.app.stage.fromMap(this.pointed)));
    this.app.link.notice("tracking", {
      state: lost ? "lost" : "ok",
      frame_id: this.own.frameId.value,
      ...(viewer && !lost ? { T_own_head: poseFromXr(poseOfTransform(viewer)) } : {}),
      ...(pointer && !lost ? { pointer } : {}),
    });
  }

  /** Shows what a ray meets. */
  private aim(pointer: Pointer, now: number): void {
    if (!pointer.connected) return pointer.showReach(null);
    const panel = this.panel.aim(pointer.caster);
    if (pointer === this.leading) this.panel.setHovered(panel?.button ?? null);
    if (panel) return pointer.showReach(panel.distance);
    if (pointer !== this.leading) return pointer.showReach(null);
    // Meeting a room of many triangles costs time: often enough for an eye will do.
    if (now - this.aimedAt < kAimMs) return;
    this.aimedAt = now;
    const target = this.target(pointer);
    pointer.showReach(target.distance);
    this.pointed = target.p;
    this.app.editOverlay.setHover(target.p);
  }

  /** Where a pointer's point would be, in the map: at the hand, on the map, on the room, or in the air. */
  private target(pointer: Pointer): { p: Vec3; distance: number | null } {
    const { stage, layers } = this.app;
    const inMap = (world: Vector3): Vec3 => vec(world.applyMatrix4(stage.mapFromWorld));
    if (this.menu.atHand.value) return { p: inMap(pointer.tip()), distance: null };
    const ray = pointer.caster.ray;
    const voxel = stage.map.visible ? layers.pick(stage.toMap(ray)) : null;
    const floor = ray.direction.y < 0 ? -ray.origin.y / ray.direction.y : Infinity;
    const distance = Math.min(voxel?.distance ?? Infinity, this.room.hit(pointer.caster) ?? Infinity, floor);
    const met = distance < kReach;
    return { p: inMap(ray.at(met ? distance : kInAir, new Vector3())), distance: met ? distance : null };
  }

  private began(pointer: Pointer, act: PointerAct): void {
    this.leading = pointer;
    const panel = this.panel.aim(pointer.caster);
    if (panel) {
      if (act === "select" && panel.button) this.menu.press(panel.button);
      return;
    }
    if (this.table.grab(pointer)) return;
    if (act === "squeeze") {
      this.putPanelAhead();
      return;
    }
    const { p } = this.target(pointer);
    this.pressedAt = p;
    this.app.editor.point(p);
  }

  /** A box can be drawn in one go: pressed at one corner, let go at the other. */
  private ended(pointer: Pointer, act: PointerAct): void {
    this.table.letGo(pointer);
    const from = this.pressedAt;
    if (act !== "select" || !from) return;
    this.pressedAt = null;
    const selection = this.app.editor.selection.value;
    const { p } = this.target(pointer);
    if (selection?.tool === "box" && !selection.closed && Math.hypot(p[0] - from[0], p[1] - from[1], p[2] - from[2]) > kDragMetres) this.app.editor.point(p);
  }

  private head(): Vec3 {
    return vec(new Vector3().setFromMatrixPosition(this.viewer).applyMatrix4(this.app.stage.mapFromWorld));
  }

  private putPanelAhead(): void {
    this.placePanel = false;
    this.putAhead(this.panel.mesh, 0.8, -0.05);
    this.panel.mesh.lookAt(new Vector3().setFromMatrixPosition(this.viewer));
    this.panel.mesh.updateMatrixWorld(true);
  }

  /** Before the person's eyes, upright. */
  private putAhead(object: Group | ScenePanel["mesh"], ahead: number, up: number): void {
    const forward = new Vector3(0, 0, -1).transformDirection(this.viewer).setY(0).normalize();
    object.position.setFromMatrixPosition(this.viewer).addScaledVector(forward, ahead).add(new Vector3(0, up, 0));
    object.rotation.set(object instanceof Group ? -Math.PI / 2 : 0, 0, 0);
    object.updateMatrixWorld(true);
  }
}
