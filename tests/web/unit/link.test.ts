import assert from "node:assert/strict";
import { test } from "node:test";
import type { EventMessage } from "../../../hmd_bridge/web/src/protocol/envelope";
import type { HelloAnswer, Pose } from "../../../hmd_bridge/web/generated/messages";
import { Link, type Socket } from "../../../hmd_bridge/web/src/link/link";
import { RefusedError, sayRefusal, wordsFor } from "../../../hmd_bridge/web/src/link/failures";
import { ServerClock } from "../../../hmd_bridge/web/src/link/clock";
import { World } from "../../../hmd_bridge/web/src/link/world";
import { pointsFrame } from "../support/voxel_map";

interface Said { id?: number; request?: string; notice?: string; body: Record<string, unknown> }

class FakeSocket implements Socket {
  binaryType = "";
  readyState = 1;
  onopen: (() => void) | null = null;
  onclose: (() => void) | null = null;
  onmessage: ((event: { data: string | ArrayBuffer }) => void) | null = null;
  readonly sent: Said[] = [];
  closedWith: number | undefined;
  send(data: string | Uint8Array): void {
    if (typeof data === "string") this.sent.push(JSON.parse(data) as Said);
  }
  /** As in browsers, which throw at other codes. */
  close(code?: number): void {
    assert(code === undefined || code === 1000 || (code >= 3000 && code < 5000), `close(${code})`);
    this.closedWith = code ?? 1005;
    this.onclose?.();
  }
  hear(message: unknown): void {
    const data = message instanceof Uint8Array ? Uint8Array.from(message).buffer : typeof message === "string" ? message : JSON.stringify(message);
    this.onmessage?.({ data });
  }
  asked(name: string): Said[] {
    return this.sent.filter(({ request }) => request === name);
  }
}

const hello: HelloAnswer = {
  session: "s", person: 1, role: "edit", name: "Ana", resumed: false, resolution: 0.05, epoch: "e1", utime: 1,
  limits: { text_bytes: 1, binary_bytes: 1, requests_per_second: 1, upload_bytes_per_second: 1, burst_requests: 1, burst_upload_bytes: 1, idle_seconds: 1 },
};
const turn = (): Promise<void> => new Promise((resolve) => setImmediate(resolve));

class Bench {
  readonly sockets: FakeSocket[] = [];
  readonly timers: { milliseconds: number; what: () => void }[] = [];
  now = 1000;
  readonly ready: boolean[] = [];
  readonly link = new Link({
    open: () => {
      const socket = new FakeSocket();
      this.sockets.push(socket);
      return socket;
    },
    ticket: () => Promise.resolve(undefined),
    who: () => ({ name: "Ana", device: "test" }),
    now: () => this.now,
    later: (milliseconds, what) => void this.timers.push({ milliseconds, what }),
  });
  get socket(): FakeSocket {
    return this.sockets.at(-1)!;
  }
  async enter(answer: Partial<HelloAnswer> = {}): Promise<void> {
    this.link.onReady = (_, keep) => void this.ready.push(keep);
    await turn();
    this.socket.onopen!();
    this.socket.hear({ id: this.socket.asked("hello").at(-1)!.id, answer: { ...hello, ...answer } });
    await turn();
    await turn();
  }
  /** Lets the last timer of this length pass. */
  pass(milliseconds: number): void {
    this.timers.findLast((timer) => timer.milliseconds === milliseconds)!.what();
  }
}

test("a refusal is said in words, and what the server adds beside them", () => {
  assert.equal(sayRefusal({ code: "NO_MAP", message: "" }), "There is no map yet.");
  assert.equal(sayRefusal({ code: "IO", message: "the disk is full" }), "The server could not write or read its disk. (the disk is full)");
});

test("hello comes first, then credit; answers find their requests in any order", async () => {
  const bench = new Bench();
  bench.link.connect();
  await bench.enter();
  assert.equal(bench.link.state.value.state, "ready");
  assert.deepEqual(bench.socket.sent.slice(0, 2).map(({ request, notice }) => request ?? notice), ["hello", "credit"]);
  const undo = bench.link.request("undo", { edit: "a" });
  const redo = bench.link.request("redo", { edit: "b" });
  bench.socket.hear({ id: bench.socket.asked("redo")[0]!.id, error: { code: "CONFLICT", message: "by Bo", retry: false } });
  bench.socket.hear({ id: bench.socket.asked("undo")[0]!.id, answer: { revision: 3, voxels: 8 } });
  assert.deepEqual(await undo, { revision: 3, voxels: 8 });
  await assert.rejects(redo, (error: unknown) => error instanceof RefusedError && error.refusal.code === "CONFLICT" && error.message.includes(wordsFor("CONFLICT")));
});

test("a lost connection is taken up: the answer that was lost is asked for again under its old id", async () => {
  const bench = new Bench();
  bench.link.connect();
  await bench.enter();
  bench.socket.hear({ event: "complete", body: { stream: 0, epoch: "e1", revision: 57, map_revision: 4, synced: true } });
  const undo = bench.link.request("undo", { edit: "a" });
  await turn();
  const id = bench.socket.asked("undo")[0]!.id;
  bench.socket.close();
  await turn();
  assert.equal(bench.link.state.value.state, "lost");
  await assert.rejects(bench.link.request("maps", {}), /no connection/);
  bench.pass(500);
  await bench.enter({ resumed: true });
  assert.deepEqual(bench.socket.asked("hello")[0]!.body["resume"], { session: "s", epoch: "e1", revision: 57 });
  assert.deepEqual(bench.ready, [false, true]);
  assert.equal(bench.socket.asked("undo")[0]!.id, id);
  bench.socket.hear({ id, answer: { revision: 3, voxels: 8 } });
  assert.equal((await undo).revision, 3);
});

test("blocks of the map are kept over a lost connection only while the view that they were complete for is still the last", async () => {
  const complete = (revision: number): unknown => ({ event: "complete", body: { stream: 0, epoch: "e1", revision, map_revision: 4, synced: true } });
  for (const [words, after, resume, keep] of [
    ["another view was asked for", [], { epoch: "", revision: 0 }, false],
    ["what was complete was the view before", [complete(58)], { epoch: "", revision: 0 }, false],
    ["it was granted and not yet complete", ["answer"], { epoch: "", revision: 0 }, false],
    ["it was complete", ["answer", complete(59)], { epoch: "e1", revision: 59 }, true],
  ] as const) {
    const bench = new Bench();
    bench.link.connect();
    await bench.enter();
    bench.socket.hear(complete(57));
    bench.link.request("view", { layer: "map", frame: "map", centre: [5, 0, 0], radii: [8] }).catch(() => {});
    for (const each of after) bench.socket.hear(each === "answer" ? { id: bench.socket.asked("view")[0]!.id, answer: { stream: 0, blocks: 3, lacking: 3 } } : each);
    await turn();
    bench.socket.close();
    await turn();
    bench.pass(500);
    await bench.enter({ resumed: true });
    assert.deepEqual(bench.socket.asked("hello")[0]!.body["resume"], { session: "s", ...resume }, words);
    assert.deepEqual(bench.ready, [false, keep], words);
  }
});

test("a connection at which the page fails again and again is tried ever less often, and the page says so", async () => {
  const bench = new Bench();
  bench.link.connect();
  const waits: number[] = [];
  for (let i = 0; i < 7; ++i) {
    await bench.enter();
    assert.equal(bench.ready.length, i + 1);
    bench.socket.hear("{");
    await turn();
    await turn();
    const state = bench.link.state.value;
    assert(state.state === "lost" && /does not understand/.test(state.why), JSON.stringify(state));
    waits.push(state.seconds);
    bench.pass(state.seconds * 1000);
  }
  assert.deepEqual(waits, [0.5, 1, 2, 4, 8, 10, 10]);
  await bench.enter();
  bench.pass(10_000); // it has lasted so long
  bench.socket.close();
  await turn();
  const state = bench.link.state.value;
  assert(state.state === "lost" && state.seconds === 0.5, "one that was good is tried soon");
});

test("who looked elsewhere, or away, while there was no connection keeps no blocks", async () => {
  for (const look of [
    (link: Link) => link.request("view", { layer: "map", frame: "map", centre: [5, 0, 0], radii: [8] }),
    (link: Link) => link.request("view_close", { stream: 0 }),
  ]) {
    const bench = new Bench();
    bench.link.connect();
    await bench.enter();
    bench.socket.hear({ event: "complete", body: { stream: 0, epoch: "e1", revision: 57, map_revision: 4, synced: true } });
    await turn();
    bench.socket.close();
    await turn();
    await assert.rejects(look(bench.link), /no connection/);
    bench.pass(500);
    await bench.enter({ resumed: true });
    assert.deepEqual(bench.ready, [false, false]);
  }
});

test("a frame comes with its answer; an answer whose frame was lost says to ask again", async () => {
  const bench = new Bench();
  bench.link.connect();
  await bench.enter();
  const ask = (): ReturnType<typeof bench.link.requestFrame<"minimap", "points">> => bench.link.requestFrame("minimap", { agent: "robot1", resolution: 0.5 }, "points");
  const answer = { agent: "robot1", frame_id: "a", points: 1 };
  const whole = ask();
  const lost = assert.rejects(ask(), /Ask again/);
  const [first, second] = bench.socket.asked("minimap");
  bench.socket.hear(pointsFrame(first!.id!, [1, 2, 3]));
  bench.socket.hear({ id: first!.id, answer });
  bench.socket.hear({ id: second!.id, answer });
  assert.deepEqual([...(await whole).frame.points], [1, 2, 3]);
  await lost;
});

test("a session that is gone says so to who waits, and keeps no blocks", async () => {
  const bench = new Bench();
  bench.link.connect();
  await bench.enter();
  const undo = bench.link.request("undo", { edit: "a" });
  bench.socket.close();
  await turn();
  bench.pass(500);
  const rejected = assert.rejects(undo, /History/);
  await bench.enter({ session: "t", epoch: "e2" });
  await rejected;
  assert.deepEqual(bench.ready, [false, false]);
  assert.equal(bench.socket.asked("undo").length, 0);
});

test("a refused hello ends it with clear words; one that may be granted later is tried again", async () => {
  for (const [code, retry, state] of [["BAD_TOKEN", false, "refused"], ["BUSY", true, "lost"]] as const) {
    const bench = new Bench();
    bench.link.connect();
    await turn();
    bench.socket.onopen!();
    bench.socket.hear({ id: 1, error: { code, message: "so it is", retry } });
    await turn();
    await turn();
    const now = bench.link.state.value;
    assert.equal(now.state, state);
    assert("why" in now && now.why.includes(wordsFor(code)) && now.why.includes("so it is"));
  }
});

test("credit is said again as frames are taken in, and a server that talks nonsense is left", async () => {
  const bench = new Bench();
  bench.link.connect();
  await bench.enter();
  const frame = new Uint8Array(24 + 12 * 100_000);
  const view = new DataView(frame.buffer);
  view.setUint8(0, 2);
  view.setUint32(8, 100_000, true);
  view.setUint32(12, 12 * 100_000, true);
  for (let i = 0; i < 2; ++i) bench.socket.onmessage!({ data: frame.buffer });
  await turn();
  await turn();
  const credits = bench.socket.sent.filter(({ notice }) => notice === "credit").map(({ body }) => body["bytes"]);
  assert.deepEqual(credits, [4_000_000, 4_000_000 + 2 * frame.length]);
  bench.socket.hear("nonsense");
  await turn();
  assert.equal(bench.socket.closedWith, 4002);
  await turn();
  assert.equal(bench.link.state.value.state, "lost");
});

test("a page that fails at a message connects again and hears the next ones", async () => {
  const bench = new Bench();
  bench.link.connect();
  await bench.enter();
  const heard: string[] = [];
  let failing = true;
  bench.link.onEvent = ({ event }) => {
    if (failing) throw new Error("a watcher failed");
    heard.push(event);
  };
  const { error } = console;
  console.error = (what: unknown) => void heard.push(String(what));
  bench.socket.hear({ event: "people", body: { people: [] } });
  await turn();
  console.error = error;
  assert.equal(bench.socket.closedWith, 4002);
  await turn();
  const now = bench.link.state.value;
  assert(now.state === "lost" && now.why.includes("a watcher failed"));
  failing = false;
  bench.pass(500);
  await bench.enter({ resumed: true });
  bench.socket.hear({ event: "people", body: { people: [] } });
  await turn();
  assert.deepEqual(heard, ["Error: a watcher failed", "people"]);
});

test("a network that went silent is noticed", async () => {
  const bench = new Bench();
  bench.link.connect();
  await bench.enter();
  bench.now += 30_000;
  bench.pass(10_000);
  await turn();
  assert.equal(bench.link.state.value.state, "lost");
});

test("the server's clock is told within half of the shortest way", () => {
  const clock = new ServerClock();
  clock.hear(1000, 7_000_000, 7_000_000, 1100); // 100 ms there and back
  assert.equal(clock.utime(1050), 7_000_000);
  clock.hear(2000, 8_050_000, 8_051_000, 2003); // 2 ms
  assert(Math.abs(clock.utime(2001.5) - 8_050_500) < 1);
  clock.hear(3000, 9_000_000, 9_000_000, 3900); // a slow one tells nothing
  assert(Math.abs(clock.utime(2001.5) - 8_050_500) < 1);
});

test("after a connection began only what is said to be open then waits for a decision", () => {
  const world = new World();
  const at: Pose = { position: [0, 0, 0], rotation: [0, 0, 0, 1] };
  const propose = (detection: string, open = true): void =>
    world.hear({ event: "detection", body: { detection, class_name: "chair", T_map_object: at, score: 0.8, by: "robot1", open } });
  const evidence = { overlap: 0.7, rms: 0.03, free_space_violation: 0, iterations: 9, ms: 9, loose: [] };
  propose("d1");
  propose("d2");
  propose("d1", false);
  world.hear({ event: "alignment", body: { agent: "robot1", align: "a1", T_target_source: at, slip: 0.4, slip_angle: 0.1, evidence, open: true } });
  const open = (): string[] => [...world.detections.value.map(({ detection }) => detection), ...world.slips.value.map(({ align }) => align)];
  assert.deepEqual(open(), ["d2", "a1"]);
  world.renew();
  propose("d3");
  assert.deepEqual(open(), ["d3"]);
});

test("a process that was heard and falls silent is named until it speaks again, or another connection begins", () => {
  const world = new World();
  const hear = (alive: string[]): void => world.hear({ event: "processes", body: { alive } } as EventMessage);
  hear(["merge", "planner"]);
  assert.deepEqual(world.silent.value, []);
  hear(["planner"]);
  assert.deepEqual(world.silent.value, ["merge"]);
  hear(["merge", "planner", "semantic"]);
  assert.deepEqual(world.silent.value, []);
  hear([]);
  world.renew();
  assert.deepEqual(world.silent.value, []);
});
