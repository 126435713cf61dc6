import assert from "node:assert/strict";
import { test } from "node:test";
import type { HelloAnswer, Refusal } from "../../../hmd_bridge/web/generated/messages";
import { News } from "../../../hmd_bridge/web/src/base/news";
import { Signal } from "../../../hmd_bridge/web/src/base/signal";
import { kIdentity } from "../../../hmd_bridge/web/src/base/vec";
import { RefusedError } from "../../../hmd_bridge/web/src/link/failures";
import type { Link, LinkState } from "../../../hmd_bridge/web/src/link/link";
import { RoomScan, type Seen } from "../../../hmd_bridge/web/src/xr/room_scan";
import { RoomUploader } from "../../../hmd_bridge/web/src/xr/room_uploader";
import { readHeaderOf } from "../support/upload";

/** A room of one mesh and its uploader, on a link that keeps what is uploaded and refuses what it is told to. */
class Bench {
  readonly state = new Signal<LinkState>({ state: "connecting" });
  readonly uploads: { sequence: number; meshes: number }[] = [];
  readonly refusals: Refusal[] = [];
  readonly news = new News();
  readonly scan = new RoomScan();
  private now = 0;
  private readonly mesh: Seen = { key: {}, changed: 1, T_ref_mesh: kIdentity, vertices: () => [0, 1, 0, 1, 1, 0, 0, 1, 1], triangles: () => [0, 1, 2] };
  private readonly link = {
    state: this.state,
    upload: (make: (id: number) => Uint8Array<ArrayBuffer>) => {
      const { sequence, meshes } = readHeaderOf(Buffer.from(make(1)));
      this.uploads.push({ sequence, meshes });
      const refusal = this.refusals.shift();
      return refusal ? Promise.reject(new RefusedError(refusal)) : Promise.resolve({ sequence, occupied: 7 });
    },
  };
  readonly uploader = new RoomUploader(this.link as unknown as Link, this.news, this.scan, () => this.reset(), () => { ++this.pauses; return Promise.resolve(); });
  pauses = 0;

  frames = 0;

  /** As the immersive session does: the own frame becomes another. */
  reset(): void {
    ++this.frames;
    this.uploader.restart();
  }
  hello(resumed: boolean): void {
    this.state.set({ state: "ready", hello: { resumed } as HelloAnswer });
  }
  /** Looks once more, and sends what is new. */
  async look(): Promise<void> {
    this.now += 1000;
    assert(this.uploader.due(this.now));
    await this.uploader.send(kIdentity, this.scan.look([this.mesh]), this.now);
  }
}

test("to a new session the whole room is sent again, to one that goes on only what is new", async () => {
  const bench = new Bench();
  bench.hello(false);
  await bench.look();
  await bench.look();
  bench.state.set({ state: "lost", why: "", seconds: 1 });
  bench.hello(true);
  await bench.look();
  bench.state.set({ state: "lost", why: "", seconds: 1 });
  bench.hello(false);
  await bench.look();
  assert.deepEqual(bench.uploads, [{ sequence: 0, meshes: 1 }, { sequence: 1, meshes: 0 }, { sequence: 2, meshes: 0 }, { sequence: 0, meshes: 1 }]);
});

test("a frame that the server takes no more becomes another, with one word to the person", async () => {
  const bench = new Bench();
  bench.hello(false);
  await bench.look();
  bench.refusals.push({ code: "BAD_FRAME", message: "this frame was reset", retry: false });
  await bench.look();
  assert.equal(bench.frames, 1);
  assert.match(bench.news.latest.value!.text, /began anew/);
  await bench.look();
  await bench.look();
  assert.equal(bench.frames, 1);
  assert.deepEqual(bench.uploads.slice(2), [{ sequence: 0, meshes: 1 }, { sequence: 1, meshes: 0 }]);
});

test("a look that comes too soon for the server is offered again, and nothing of the room is sent twice", async () => {
  const bench = new Bench();
  bench.hello(false);
  bench.refusals.push({ code: "RATE", message: "too many", retry: true }, { code: "RATE", message: "too many", retry: true });
  await bench.look();
  await bench.look();
  assert.equal(bench.pauses, 2);
  assert.deepEqual(bench.uploads.map((look) => look.meshes), [1, 1, 1, 0]);
  assert.equal(bench.news.latest.value, null);
});

test("a look that was under way when the frame became another is not sent in the new one", async () => {
  const bench = new Bench();
  bench.hello(false);
  const look = bench.look();
  bench.reset();
  await look;
  await bench.look();
  assert.deepEqual(bench.uploads, [{ sequence: 0, meshes: 1 }]);
});
