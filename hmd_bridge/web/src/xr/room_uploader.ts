/** Sends the room to the bridge, look by look, one under way at a time. */
import type { Pose } from "../../generated/messages";
import type { News } from "../base/news";
import { Signal } from "../base/signal";
import { RefusedError } from "../link/failures";
import type { Link } from "../link/link";
import { meshFrame, packPayload, type PackedPayload, type RoomMesh } from "../protocol/frames";
import { payloads, type RoomScan } from "./room_scan";

const kLookMs = 500;
/** A large room takes more looks at once than the server does: so often is one offered again. */
const kMostOffers = 60;

export class RoomUploader {
  /** Occupied voxels of the own submap so far. */
  readonly occupied = new Signal(0);
  readonly looks = new Signal(0);
  private sequence = 0;
  private restarts = 0;
  private busy = false;
  private last = -Infinity;

  constructor(
    private readonly link: Link,
    private readonly news: News,
    /** Which of the room's meshes are new. */
    private readonly scan: Pick<RoomScan, "forget" | "repeat">,
    /** Called when the server takes nothing more in this frame: another is to begin. */
    private readonly reframe: () => void,
    private readonly pause = (milliseconds: number) => new Promise<void>((done) => setTimeout(done, milliseconds)),
  ) {
    // To a new session the server knows no look: what it is sent first must be the whole room, or it takes it that the rest is gone.
    link.state.onChange((state) => {
      if (state.state === "ready" && !state.hello.resumed) this.restart();
    });
  }

  /** Whether a look can be taken now. @param now milliseconds */
  due(now: number): boolean {
    return !this.busy && now - this.last >= kLookMs && this.link.state.value.state === "ready";
  }

  /** @param sensor T_own_sensor, z up */
  async send(sensor: Pose, meshes: readonly RoomMesh[], now: number): Promise<void> {
    this.busy = true;
    this.last = now;
    const { restarts } = this;
    try {
      for (const part of payloads(sensor, meshes)) {
        const packed = await packPayload(part.payload);
        const taken = await this.offer(part.meshes, packed, restarts);
        if (!taken) return; // it was seen in another frame
        this.occupied.set(taken.occupied);
        this.looks.set(this.looks.value + 1);
      }
    } catch (error) {
      this.failed(error);
    } finally {
      this.busy = false;
    }
  }

  /** @return nothing once the frame is another than it was seen in. */
  private async offer(meshes: number, packed: PackedPayload, restarts: number): Promise<{ occupied: number } | null> {
    for (let offers = 1; restarts === this.restarts; ++offers) {
      const sequence = this.sequence++;
      try {
        return await this.link.upload((id) => meshFrame(id, sequence, meshes, packed));
      } catch (error) {
        const code = error instanceof RefusedError ? error.refusal.code : null;
        if (code !== null && code !== "DUP_SEQ" && restarts === this.restarts) this.sequence = sequence; // it was not taken
        if (code !== "RATE" || offers >= kMostOffers) throw error;
      }
      await this.pause(kLookMs);
    }
    return null;
  }

  /** The own frame is another. */
  restart(): void {
    this.sequence = 0;
    ++this.restarts;
    this.occupied.set(0);
    this.scan.forget();
  }

  private failed(error: unknown): void {
    const code = error instanceof RefusedError ? error.refusal.code : null;
    if (code === "DUP_SEQ") return; // it came before: the next number is a new one
    if (code === "BAD_FRAME") this.reframe();
    else this.scan.repeat();
    // While tracking is lost, or the connection, the person is told elsewhere.
    if (code !== null && code !== "TRACKING_LOST") this.news.failed((error as RefusedError).message);
  }
}
