/** Holds the map in its place in the room: T_own_map, corrected by what the device learns about an anchor near by. */
import type { Pose } from "../../generated/messages";
import { composed, inverse, poseFromXr } from "../base/vec";

/** A pose of WebXR, y up. */
export function poseOfTransform({ position: p, orientation: q }: XRRigidTransform): Pose {
  return { position: [p.x, p.y, p.z], rotation: [q.x, q.y, q.z, q.w] };
}

/** Where the map is now, given where the anchor is now and was when the map was placed. All z up. */
export function corrected(T_own_map: Pose, anchorThen: Pose, anchorNow: Pose): Pose {
  return composed(composed(anchorNow, inverse(anchorThen)), T_own_map);
}

export class MapAnchor {
  private anchor: XRAnchor | null = null;
  private then: Pose | null = null;
  private wanted: Pose | null = null;
  private asked = false;

  /** The map was placed here; null: it has no place. */
  set(T_own_map: Pose | null): void {
    this.wanted = T_own_map;
    this.anchor?.delete();
    this.anchor = null;
    this.then = null;
    this.asked = false;
  }

  /** T_own_map for this frame; null while it has no place. Makes the anchor where the person stands. */
  update(frame: XRFrame, space: XRReferenceSpace, viewer: XRRigidTransform): Pose | null {
    if (!this.wanted) return null;
    if (!this.asked) this.ask(frame, space, viewer);
    const now = this.anchor && frame.getPose(this.anchor.anchorSpace, space);
    if (!now) return this.wanted;
    const pose = poseFromXr(poseOfTransform(now.transform));
    this.then ??= pose;
    return corrected(this.wanted, this.then, pose);
  }

  private ask(frame: XRFrame, space: XRReferenceSpace, viewer: XRRigidTransform): void {
    this.asked = true;
    const placed = this.wanted;
    const { x, z } = viewer.position;
    frame.createAnchor?.(new XRRigidTransform({ x, y: 0, z }), space).then(
      (anchor) => {
        if (this.wanted === placed) this.anchor = anchor;
        else anchor.delete();
      },
      () => {}, // without anchors the map stays where it was placed
    );
  }
}
