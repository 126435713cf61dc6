/**
 * This device's own frame, and whether it has a place in the map. A reset of its origin makes it another frame, which is
 * unaligned until somebody places it; while it is unaligned or lost nothing can be changed.
 */
import type { Agent, Pose } from "../../generated/messages";
import { Signal } from "../base/signal";

export type Standing = { state: "lost" } | { state: "unaligned" } | { state: "aligned"; T_map_own: Pose };

export function standingOf(agent: Agent | undefined, frameId: string, tracked: boolean): Standing {
  if (!tracked) return { state: "lost" };
  if (!agent?.aligned || !agent.T_map_agent || agent.frame_id !== frameId) return { state: "unaligned" };
  return { state: "aligned", T_map_own: agent.T_map_agent };
}

/** What to tell the person; null where they may edit. */
export function blockedWords({ state }: Standing): string | null {
  if (state === "aligned") return null;
  return state === "lost"
    ? "The headset does not know where it is. Look around slowly; edits wait until it does."
    : "Your room is not placed in the map yet: scan it, then open Align. Edits wait until then.";
}

export class OwnFrame {
  readonly frameId: Signal<string>;
  readonly standing = new Signal<Standing>({ state: "unaligned" });
  private agentNow: Agent | undefined;
  private tracked = true;

  /** @param newId makes an id that was never used before */
  constructor(
    readonly agent: string,
    private readonly newId: () => string,
  ) {
    this.frameId = new Signal(newId());
  }

  /** What the server says of the agent that this device is. */
  hear(agent: Agent | undefined): void {
    this.agentNow = agent;
    this.judge();
  }

  setTracked(tracked: boolean): void {
    if (tracked === this.tracked) return;
    this.tracked = tracked;
    this.judge();
  }

  /** The origin is another now. */
  reset(): void {
    this.frameId.set(this.newId());
    this.judge();
  }

  private judge(): void {
    this.standing.set(standingOf(this.agentNow, this.frameId.value, this.tracked));
  }
}
