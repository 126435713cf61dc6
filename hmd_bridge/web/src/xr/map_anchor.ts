/** Holds the map in its place in the room: T_own_map, corrected by what the device learns about an anchor near by. */
import type { Pose } from "../../generated/messages";
import { composed, inverse, poseFromXr } from "../base/vec";
import type { Standing } from "./own_frame";

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
  /** The same as corrected last. */
  private shown: Pose | null = null;
  /** What `wanted` came from. */
  private placed: string | null = null;
  private asked = false;

  /**
   * Where the device stands, as often as it is said: an anchor lasts until the map is placed elsewhere, or the frame is another.
   * One that lost its tracking finds the map where it left it. Null: the map has no place here.
   */
  stand(standing: Standing | null, frameId: string): void {
    if (standing?.state === "lost") return;
    const T_map_own = standing?.state === "aligned" ? standing.T_map_own : null;
    const placed = T_map_own && JSON.stringify([frameId, T_map_own.position, T_map_own.rotation]);
    if (placed === this.placed) return;
    this.placed = placed;
    this.wanted = this.shown = T_map_own && inverse(T_map_own);
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
    if (!now) return this.shown;
    const pose = poseFromXr(poseOfTransform(now.transform));
    this.then ??= pose;
    return (this.shown = corrected(this.wanted, this.then, pose));
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
