import assert from "node:assert/strict";
import { test } from "node:test";
import type { Agent, Pose } from "../../../hmd_bridge/web/generated/messages";
import { composed, distance, fromYaw, kIdentity, transformed, type Vec3 } from "../../../hmd_bridge/web/src/base/vec";
import { keyboardPage, typed } from "../../../hmd_bridge/web/src/xr/keyboard";
import { corrected, MapAnchor } from "../../../hmd_bridge/web/src/xr/map_anchor";
import { blockedWords, OwnFrame } from "../../../hmd_bridge/web/src/xr/own_frame";
import { buttonAt, kPanelWidth, panelHeight, placed } from "../../../hmd_bridge/web/src/xr/panel_layout";
import { fanTriangles, payloads, RoomScan, type Seen } from "../../../hmd_bridge/web/src/xr/room_scan";
import { commandIn } from "../../../hmd_bridge/web/src/xr/voice";

function agentIn(frameId: string): Agent {
  return { agent: "headset-1", type: "headset", frame_id: frameId, aligned: true, T_map_agent: kIdentity, weight: 1, revision: 1, known: 1, occupied: 1 };
}

test("a device is aligned only in the frame that was placed; a reset unaligns it, lost tracking blocks it for a while", () => {
  let ids = 0;
  const own = new OwnFrame("headset-1", () => `f${++ids}`);
  const state = (): string => own.standing.value.state;
  assert.equal(state(), "unaligned");
  own.hear(agentIn("f1"));
  assert.equal(state(), "aligned");
  assert.equal(blockedWords(own.standing.value), null);
  own.setTracked(false);
  assert.equal(state(), "lost");
  assert.match(blockedWords(own.standing.value)!, /does not know where it is/);
  own.setTracked(true);
  assert.equal(state(), "aligned");
  own.reset();
  assert.equal(state(), "unaligned");
  own.hear(agentIn("f1"));
  assert.equal(state(), "unaligned", "that was another frame");
  own.hear(agentIn("f2"));
  assert.equal(state(), "aligned");
  own.hear(undefined);
  assert.equal(state(), "unaligned");
});

const mesh = (key: object, changed: number, T_ref_mesh: Pose | null = kIdentity): Seen => ({ key, changed, T_ref_mesh, vertices: () => [0, 1, 0, 1, 1, 0, 0, 1, 1], triangles: () => [0, 1, 2] });

test("a look sends what changed, moved or went, z up, under lasting numbers", () => {
  const scan = new RoomScan();
  const [a, b] = [{}, {}];
  assert.deepEqual(scan.look([mesh(a, 1), mesh(b, 1)]).map(({ number }) => number), [0, 1]);
  assert.deepEqual(scan.look([mesh(a, 1), mesh(b, 1)]), []);
  assert.deepEqual(scan.look([mesh(a, 2), mesh(b, 1)]).map(({ number }) => number), [0]);
  const moved = scan.look([mesh(a, 2), mesh(b, 1, { position: [0, 0, 2], rotation: [0, 0, 0, 1] })]);
  assert.deepEqual([...moved[0]!.vertices.slice(0, 3)], [0, -2, 1], "y up came in, z up goes out");
  assert.deepEqual(scan.look([mesh(b, 1, null)]).map(({ number, vertices }) => [number, vertices.length]), [[0, 0]], "gone; the other's place is not known now");
  const sent = (): number[][] => scan.look([mesh(b, 1)]).map(({ number, vertices }) => [number, vertices.length]);
  for (let time = 0; time < 2; ++time) {
    scan.repeat();
    assert.deepEqual(sent(), [[1, 9], [0, 0]], "under its number, and what was gone is gone");
    assert.deepEqual(sent(), []);
  }
  scan.forget();
  assert.deepEqual(sent(), [[0, 9]]);
});

test("a large room goes in several frames, nothing new in an empty one", () => {
  const big = { number: 1, vertices: new Float32Array(600_000), triangles: new Uint32Array(3) };
  assert.deepEqual(payloads(kIdentity, [big, { ...big, number: 2 }, { ...big, number: 3 }]).map(({ meshes }) => meshes), [1, 1, 1]);
  const many = Array.from({ length: 2500 }, (_, number) => ({ number, vertices: new Float32Array(), triangles: new Uint32Array() }));
  assert.deepEqual(payloads(kIdentity, many).map(({ meshes }) => meshes), [1024, 1024, 452]);
  assert.deepEqual(payloads(kIdentity, []).map(({ meshes, payload }) => [meshes, payload.length]), [[0, 28]]);
  assert.deepEqual(fanTriangles(4), [0, 1, 2, 0, 2, 3]);
  assert.deepEqual(fanTriangles(2), []);
});

test("what the device learns of its anchor moves the map with it", () => {
  const T_own_map: Pose = { position: [1, 2, 0], rotation: fromYaw(0.3) };
  const then: Pose = { position: [4, 0, 0], rotation: fromYaw(1) };
  const step: Pose = { position: [0.02, -0.01, 0], rotation: fromYaw(0.01) };
  const p: Vec3 = [3, 1, 1];
  const now = corrected(T_own_map, then, composed(step, then));
  assert(distance(transformed(now, p), transformed(step, transformed(T_own_map, p))) < 1e-9);
  assert(distance(corrected(T_own_map, then, then).position, T_own_map.position) < 1e-9);
});

/** A device's frames with one anchor, which it moves. In WebXR's y-up space. */
class AnchoringDevice {
  readonly anchors: { deleted: boolean }[] = [];
  at: { x: number; y: number; z: number } | null = { x: 0, y: 0, z: 0 };
  readonly space = {} as XRReferenceSpace;
  readonly viewer = { position: { x: 0, y: 1.6, z: 0 } } as XRRigidTransform;
  readonly frame = {
    createAnchor: () => {
      const anchor = { deleted: false, anchorSpace: {}, delete: () => void (anchor.deleted = true) };
      this.anchors.push(anchor);
      return Promise.resolve(anchor);
    },
    getPose: () => this.at && { transform: { position: this.at, orientation: { x: 0, y: 0, z: 0, w: 1 } } },
  } as unknown as XRFrame;
}

test("an anchor lasts while the server says the same place again and while tracking is lost for a moment", async () => {
  Object.assign(globalThis, { XRRigidTransform: class {} });
  const device = new AnchoringDevice();
  let ids = 0;
  const own = new OwnFrame("headset-1", () => `f${++ids}`);
  const anchor = new MapAnchor();
  own.standing.watch((standing) => anchor.stand(standing, own.frameId.value));
  const x = async (): Promise<number | undefined> => {
    anchor.update(device.frame, device.space, device.viewer);
    await Promise.resolve();
    return anchor.update(device.frame, device.space, device.viewer)?.position[0];
  };
  assert.equal(await x(), undefined);
  own.hear(agentIn(own.frameId.value));
  assert.equal(await x(), 0);
  device.at = { x: 0.03, y: 0, z: 0 };
  assert.equal(await x(), 0.03);
  for (let second = 0; second < 3; ++second) own.hear(agentIn(own.frameId.value));
  assert.equal(await x(), 0.03, "the same was said again");
  own.setTracked(false);
  device.at = null;
  assert.equal(await x(), 0.03, "tracking is lost");
  own.setTracked(true);
  device.at = { x: 0.04, y: 0, z: 0 };
  assert.equal(await x(), 0.04);
  assert.deepEqual(device.anchors.map(({ deleted }) => deleted), [false]);
  own.hear({ ...agentIn(own.frameId.value), T_map_agent: { position: [-1, 0, 0], rotation: [0, 0, 0, 1] } });
  assert.equal(await x(), 1, "placed elsewhere");
  own.reset();
  assert.equal(await x(), undefined, "another frame has no place yet");
  assert.deepEqual(device.anchors.map(({ deleted }) => deleted), [true, true]);
});

test("buttons of a panel lie inside it, do not overlap, and are found where they are", () => {
  const page = keyboardPage("What is it?", "des");
  const buttons = placed(page);
  for (const [i, b] of buttons.entries()) {
    assert(b.x >= 0 && b.x + b.width <= kPanelWidth && b.y + b.height <= panelHeight(page));
    for (const other of buttons.slice(i + 1)) assert(b.x + b.width <= other.x || other.x + other.width <= b.x || b.y + b.height <= other.y || other.y + other.height <= b.y);
    assert.equal(buttonAt(buttons, b.x + b.width / 2, b.y + b.height / 2)?.id, b.id);
  }
  assert.equal(buttonAt(buttons, 5, 5), undefined);
  const empty = placed(keyboardPage("What is it?", ""));
  const done = empty.find(({ id }) => id === "text done")!;
  assert.equal(buttonAt(empty, done.x + 1, done.y + 1), undefined, "an empty text is not done");
});

test("keys write, the last takes back, and a text ends at 40", () => {
  assert.equal(["key d", "key e", "key e", "key back", "key  ", "key 2"].reduce(typed, ""), "de 2");
  assert.equal(Array.from({ length: 60 }, () => "key a").reduce(typed, "").length, 40);
  assert.equal(typed("", "key back"), "");
});

test("a command is heard among other words", () => {
  const commands = { "send map": 1, "send scene": 2 };
  assert.equal(commandIn("Okay, send map now!", commands), 1);
  assert.equal(commandIn("SEND  SCENE", commands), 2);
  assert.equal(commandIn("send it", commands), undefined);
});
