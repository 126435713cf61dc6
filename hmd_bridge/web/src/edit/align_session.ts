/** Bringing one agent's map into another: a small map of it is moved by hand, refined by the server, and accepted or not. */
import type { Answers, Pose } from "../../generated/messages";
import type { PointsFrame } from "../protocol/frames";
import { composed, fromYaw, kIdentity, levelled, sub, type Vec3 } from "../base/vec";
import { type News } from "../base/news";
import { Signal } from "../base/signal";
import type { Ask } from "../link/link";

export interface Aligning {
  source: string;
  /** Undefined: the map. */
  target: string | undefined;
  /** x y z of each, metres, in the source's frame. */
  points: Float32Array;
  /** The same of the target; none of the map as a whole. */
  targetPoints: Float32Array | null;
  /** T_target_source as it is placed now. */
  guess: Pose;
  offer: Answers["align"] | null;
  busy: boolean;
}

export type AskMinimap = (agent: string, resolution: number) => Promise<PointsFrame>;

const kResolution = 0.5;

export class AlignSession {
  readonly current = new Signal<Aligning | null>(null);
  /** Where this device is, as found from a robot that it sees; it waits to be accepted. */
  readonly referred = new Signal<{ robot: string; offer: Answers["reference"] } | null>(null);

  constructor(
    private readonly ask: Ask,
    private readonly minimap: AskMinimap,
    private readonly news: News,
  ) {}

  /** Begins from where it is known to lie, or with the middle of one on the middle of the other; from there it is moved by hand. */
  async begin(source: string, target: string | undefined, known?: Pose): Promise<void> {
    const frame = await this.news.tell(this.minimap(source, kResolution), () => null);
    if (!frame) return;
    const targetFrame = target === undefined ? null : await this.news.tell(this.minimap(target, kResolution), () => null);
    if (target !== undefined && !targetFrame) return;
    const targetPoints = targetFrame?.points ?? null;
    const position: Vec3 = targetPoints ? sub(middleOf(targetPoints), middleOf(frame.points)) : [0, 0, 0];
    const guess = known ?? { position, rotation: kIdentity.rotation };
    this.current.set({ source, target, points: frame.points, targetPoints, guess, offer: null, busy: false });
  }

  /** Puts it elsewhere by hand; an offer for another place is withdrawn. It stays upright. */
  place(T_target_source: Pose): void {
    const now = this.current.value;
    if (!now || now.busy) return;
    if (now.offer) this.drop(now.offer.align);
    this.current.set({ ...now, guess: levelled(T_target_source), offer: null });
  }

  /** By metres in the target's frame and a turn about its own middle, radians. */
  nudge(by: Vec3, yaw: number): void {
    const now = this.current.value;
    if (!now) return;
    const pivot = middleOf(now.points);
    const turn: Pose = { position: pivot, rotation: fromYaw(yaw) };
    const moved = composed(composed(now.guess, turn), { position: pivot.map((c) => -c) as Vec3, rotation: kIdentity.rotation });
    this.place({ position: moved.position.map((c, i) => c + by[i]!) as Vec3, rotation: moved.rotation });
  }

  /** Asks for the best fit near where it is; @param anywhere without regard to that. */
  async refine(anywhere = false): Promise<void> {
    const now = this.current.value;
    if (!now) return;
    const asking = { ...now, busy: true };
    this.current.set(asking);
    const body = { source: now.source, ...(now.target === undefined ? {} : { target: now.target }), ...(anywhere ? {} : { T_target_source: now.guess }) };
    const offer = await this.news.tell(this.ask("align", body), ({ message }) => message || "A fit was found. Look whether it is right, then accept it.");
    if (this.current.value !== asking) {
      if (offer) this.drop(offer.align); // it was cancelled meanwhile
      return;
    }
    this.current.set(offer ? { ...now, guess: offer.T_target_source, offer, busy: false } : { ...now, busy: false });
  }

  async accept(): Promise<void> {
    const offer = this.current.value?.offer;
    if (!offer) return;
    if (await this.news.tell(this.ask("align_accept", { align: offer.align }), ({ agent }) => `${agent} is in the map now.`)) this.current.set(null);
  }

  /** Finds where this device is from where it sees a robot. @param T_own_base as seen */
  async refer(robot: string, T_own_base: Pose): Promise<void> {
    const offer = await this.news.tell(this.ask("reference", { robot, T_own_base }), ({ message }) => message || "A fit was found; accept it if the figures are good.");
    if (offer) this.referred.set({ robot, offer });
  }

  async acceptReferred(): Promise<void> {
    const offer = this.referred.value?.offer;
    if (!offer) return;
    await this.news.tell(this.ask("align_accept", { align: offer.align }), () => "Your room is in the map now.");
    this.referred.set(null);
  }

  dropReferred(): void {
    if (this.referred.value) this.drop(this.referred.value.offer.align);
    this.referred.set(null);
  }

  /** As it was placed by hand, unrefined. Only into the map. */
  async placeAsIs(): Promise<void> {
    const now = this.current.value;
    if (!now || now.target !== undefined) return;
    const asked = this.ask("place", { agent: now.source, T_map_agent: now.guess });
    if (await this.news.tell(asked, () => `${now.source} was put there as it is.`)) this.current.set(null);
  }

  async undo(agent: string): Promise<void> {
    await this.news.tell(this.ask("align_undo", { agent }), () => `${agent} is back where it was.`);
  }

  cancel(): void {
    const offer = this.current.value?.offer;
    if (offer) this.drop(offer.align);
    this.current.set(null);
  }

  private drop(align: string): void {
    this.ask("align_drop", { align }).catch(() => {}); // it expires by itself all the same
  }
}

export function middleOf(points: Float32Array): Vec3 {
  const low: Vec3 = [Infinity, Infinity, Infinity];
  const high: Vec3 = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; ++i) {
    low[i % 3] = Math.min(low[i % 3]!, points[i]!);
    high[i % 3] = Math.max(high[i % 3]!, points[i]!);
  }
  return points.length === 0 ? [0, 0, 0] : (low.map((l, i) => (l + high[i]!) / 2) as Vec3);
}

