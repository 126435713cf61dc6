/** The page on a desk: pointer and keyboard on the canvas, the bar above, the tabs beside. */
import type { App } from "../app";
import { button, el } from "../base/dom";
import { Vector3 } from "three";
import { fromYaw, inverse, kIdentity, rotated, type Vec3 } from "../base/vec";
import { kTools } from "../edit/selection";
import { DeskCamera } from "../scene/desk_camera";
import { vec } from "../scene/three_pose";
import { alignPanel } from "./align_panel";
import { editPanel } from "./edit_panel";
import { historyPanel } from "./history_panel";
import { mapPanel } from "./map_panel";
import { robotsPanel } from "./robots_panel";
import { tabs } from "./tabs";
import { thingsPanel } from "./things_panel";

const kClickPixels = 4;
const kTrackingMs = 100;

export class Desk {
  readonly camera: DeskCamera;
  private pointer: Vec3 | null = null;
  private pressed: { x: number; y: number } | null = null;
  private dragged: Vec3 | null = null;

  constructor(
    private readonly app: App,
    private readonly canvas: HTMLCanvasElement,
    side: HTMLElement,
    /** Whether this device is an agent. */
    private readonly maps: boolean,
  ) {
    this.camera = new DeskCamera(app.stage, canvas);
    this.takeOver();
    side.replaceChildren(
      tabs([
        { title: "Map", make: () => mapPanel(app) },
        { title: "Edit", make: () => editPanel(app) },
        { title: "Robots", make: () => robotsPanel(app) },
        { title: "Things", make: () => thingsPanel(app) },
        { title: "Align", make: () => alignPanel(app) },
        { title: "History", make: () => historyPanel(app) },
      ]),
    );
    this.listen();
    this.frameFirstView();
    app.stage.onFrame.add(() => app.layers.setCentre(app.stage.renderer.xr.isPresenting ? app.eyes.here() : this.camera.centre));
    setInterval(() => this.sayWhere(), kTrackingMs);
  }

  /** The person is at the desk, or is back. */
  takeOver(): void {
    const { stage } = this.app;
    this.app.eyes = { here: () => this.camera.centre, lookAt: (low, high) => this.camera.frameBox(low, high) };
    stage.resize(this.canvas.parentElement!.clientWidth, this.canvas.parentElement!.clientHeight);
    this.showAll();
  }

  /** Buttons over the canvas. */
  viewButtons(): HTMLElement {
    const above = button("From above", () => {
      this.camera.setAbove(!this.camera.above);
      above.setAttribute("aria-pressed", String(this.camera.above));
    }, { id: "from-above", "aria-pressed": "false", title: "T" });
    return el("div", { class: "view-buttons", role: "group", "aria-label": "View" }, above, button("Show all", () => this.showAll(), { id: "show-all", title: "F" }));
  }

  private showAll(): void {
    const bounds = this.app.layers.mapView?.store.bounds();
    const r = this.app.layers.resolution;
    if (bounds) this.camera.frameBox(bounds.low.map((c) => c * r) as Vec3, bounds.high.map((c) => c * r) as Vec3);
  }

  private frameFirstView(): void {
    const stop = this.app.layers.mapView?.complete.onChange((complete) => {
      if (!complete || !this.app.layers.mapView?.store.size) return;
      stop?.();
      this.showAll();
    });
  }

  private listen(): void {
    const { canvas } = this;
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.release(event));
    canvas.addEventListener("pointerleave", () => this.setPointer(null));
    canvas.addEventListener("dblclick", () => this.app.editor.end());
    document.addEventListener("keydown", (event) => this.key(event));
  }

  private press(event: PointerEvent): void {
    this.canvas.focus({ preventScroll: true });
    this.pressed = { x: event.clientX, y: event.clientY };
    const aligning = this.app.align.current.value;
    this.dragged = aligning && !aligning.busy && event.button === 0 && this.app.mayEdit ? this.ground(event) : null;
    this.camera.controls.enabled = this.dragged === null;
  }

  private move(event: PointerEvent): void {
    if (this.dragged) this.dragMinimap(event);
    else this.setPointer(this.pick(event));
  }

  private release(event: PointerEvent): void {
    const still = this.pressed !== null && Math.hypot(event.clientX - this.pressed.x, event.clientY - this.pressed.y) < kClickPixels;
    this.pressed = null;
    this.dragged = null;
    this.camera.controls.enabled = true;
    const p = still && event.button === 0 ? this.pick(event) : null;
    if (p) this.app.editor.point(p);
  }

  private setPointer(p: Vec3 | null): void {
    this.pointer = p;
    this.app.editOverlay.setHover(p);
  }

  /** Drags the small map over the ground; with Shift it turns. */
  private dragMinimap(event: PointerEvent): void {
    const to = this.ground(event);
    const aligning = this.app.align.current.value;
    if (!to || !aligning || !this.dragged) return;
    if (event.shiftKey) {
      this.app.align.nudge([0, 0, 0], event.movementX * 0.01);
    } else {
      const target = aligning.target === undefined ? kIdentity : (this.app.world.agent(aligning.target)?.T_map_agent ?? kIdentity);
      const step: Vec3 = [to[0] - this.dragged[0], to[1] - this.dragged[1], 0];
      this.app.align.nudge(rotated(inverse(target).rotation, step), 0);
    }
    this.dragged = to;
  }

  /** What is under the pointer: a voxel's face, else the ground. */
  private pick(event: PointerEvent): Vec3 | null {
    return this.app.layers.pick(this.app.stage.toMap(this.camera.ray(event)))?.point ?? this.ground(event);
  }

  private ground(event: PointerEvent): Vec3 | null {
    const { origin, direction } = this.app.stage.toMap(this.camera.ray(event));
    const t = -origin[2] / direction[2];
    return t > 0 && t < 500 ? (origin.map((c, i) => c + t * direction[i]!) as Vec3) : null;
  }

  private key(event: KeyboardEvent): void {
    const { editor } = this.app;
    if (event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement) return;
    if (event.ctrlKey || event.metaKey) {
      if (event.key === "z") void editor.undo();
      else if (event.key === "y") void editor.redo();
      else return;
      event.preventDefault();
      return;
    }
    const acts: Record<string, () => void> = {
      Escape: () => editor.cancel(),
      Backspace: () => editor.back(),
      Delete: () => void editor.apply("delete"),
      a: () => void editor.apply("add"),
      t: () => document.getElementById("from-above")?.click(),
      f: () => this.showAll(),
      ...Object.fromEntries(kTools.map(({ tool }, i) => [String(i + 1), () => editor.begin(tool)])),
    };
    // Enter presses the button that has the focus; elsewhere it ends the selection.
    if (event.key === "Enter" && !(event.target instanceof HTMLButtonElement)) acts["Enter"] = () => this.enter();
    acts[event.key]?.();
  }

  /** From the keyboard alone: a point where the view is centred, or the end of the selection. */
  private enter(): void {
    const { editor } = this.app;
    if (document.activeElement === this.canvas && (editor.question.value || (editor.selection.value && !editor.selection.value.closed && this.pointer === null))) {
      editor.point(this.camera.centre);
    } else {
      editor.end();
    }
  }

  /** Where this person is and points, for the others. */
  private sayWhere(): void {
    // Of a device that maps the server takes poses in its own frame only.
    if (this.app.stage.renderer.xr.isPresenting || document.hidden || this.maps) return;
    const { camera } = this.app.stage;
    const eye = vec(camera.position.clone().applyMatrix4(this.app.stage.mapFromWorld));
    const ahead = camera.getWorldDirection(new Vector3());
    this.app.link.notice("tracking", {
      state: "ok",
      T_own_head: { position: eye, rotation: fromYaw(Math.atan2(-ahead.z, ahead.x)) },
      ...(this.pointer ? { pointer: this.pointer } : {}),
    });
  }
}
