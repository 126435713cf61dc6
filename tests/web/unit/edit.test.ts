import assert from "node:assert/strict";
import { test } from "node:test";
import { checkStruct, type ConflictRegion, type Operation, type Path, type Requests, type Volume } from "../../../hmd_bridge/web/generated/messages";
import { composed, distance, fromXr, fromYaw, inverse, kIdentity, levelled, poseFromXr, rotated, toXr, transformed, unit, yawOf, type Vec3 } from "../../../hmd_bridge/web/src/base/vec";
import type { Store } from "../../../hmd_bridge/web/src/base/kept";
import { News } from "../../../hmd_bridge/web/src/base/news";
import { AlignSession } from "../../../hmd_bridge/web/src/edit/align_session";
import { keptTurnAt } from "../../../hmd_bridge/web/src/edit/asset_pose";
import { conflictWords, ConflictTour, cornersOf } from "../../../hmd_bridge/web/src/edit/conflict_tour";
import { Editor } from "../../../hmd_bridge/web/src/edit/editor";
import { Obstacles } from "../../../hmd_bridge/web/src/edit/obstacles";
import { outline } from "../../../hmd_bridge/web/src/edit/outline";
import { pathWords } from "../../../hmd_bridge/web/src/edit/robot_acts";
import { SceneDraft } from "../../../hmd_bridge/web/src/edit/scene_draft";
import { begun, boundsOf, ended, flattened, shapeOf, volumeOf, withoutLast, withPoint, type Selection, type Tool } from "../../../hmd_bridge/web/src/edit/selection";
import type { Ask } from "../../../hmd_bridge/web/src/link/link";
import { operationWords } from "../../../hmd_bridge/web/src/panels/history_panel";
import { clearanceColour, ribbon } from "../../../hmd_bridge/web/src/scene/ribbon";
import { random } from "../support/random";

function store(): Store {
  const values = new Map<string, string>();
  return { getItem: (key) => values.get(key) ?? null, setItem: (key, value) => void values.set(key, value) };
}

const select = (tool: Tool, points: Vec3[], height: number | null = 2): Selection => points.reduce(withPoint, begun(tool, 0.05, height));
const near = (a: Vec3, b: Vec3): void => assert(distance(a, b) < 1e-9, `${a} is not ${b}`);

test("an asset that is moved keeps its turn", () => {
  const turned = fromYaw(1.2);
  assert.deepEqual(keptTurnAt({ T_map_asset: { position: [1, 2, 3], rotation: turned } }, [4, 5, 0]), { position: [4, 5, 0], rotation: turned });
  assert.deepEqual(keptTurnAt({}, [4, 5, 0]), { position: [4, 5, 0], rotation: kIdentity.rotation });
});

test("a box is closed by its second corner and stands on the lower one", () => {
  const box = select("box", [[3, 1, 0.1], [1, 2, 0.3], [9, 9, 9]]);
  assert(box.closed);
  assert.deepEqual(shapeOf(box), { kind: "box", min: [1, 1, 0.1], max: [3, 2, 2.1] });
  assert.deepEqual(volumeOf({ ...box, height: null }), { kind: "box", min: [1, 1, 0.1], max: [3, 2, 0.3] });
  assert.equal(shapeOf(select("box", [[3, 1, 0], [3, 2, 0]])), null, "without width");
  assert.equal(shapeOf(select("box", [[3, 1, 0], [1, 2, 0]], null)), null, "without height");
});

test("lines, areas and prisms end when they have points enough", () => {
  const line = select("line", [[0, 0, 0]]);
  assert(!ended(line).closed && shapeOf(line) === null);
  const two = withPoint(line, [1, 0, 0]);
  assert(ended(two).closed && !two.closed);
  assert.deepEqual(withPoint(two, [1, 0, 0]), two, "a double click adds nothing");
  assert.deepEqual(withPoint(ended(two), [5, 5, 5]), ended(two), "nothing comes after the end");
  assert.deepEqual(withoutLast(ended(two)), line);
  assert.equal(shapeOf(select("area", [[0, 0, 0], [1, 0, 0]])), null);
  assert.deepEqual(shapeOf(select("prism", [[0, 0, 0.5], [1, 0, 0], [0, 1, 0]])), { kind: "prism", points: [[0, 0], [1, 0], [0, 1]], low: 0, high: 2 });
});

test("every shape that a tool makes is one that the schema knows, with edges and bounds", () => {
  const next = random(1);
  for (const tool of ["line", "area", "box", "prism"] as const) {
    for (let run = 0; run < 50; ++run) {
      const points = Array.from({ length: 2 + Math.floor(next() * 6) }, (): Vec3 => [next() * 10, next() * 10, next() * 2]);
      const shape = shapeOf(select(tool, points));
      if (!shape) continue;
      assert.equal(checkStruct("Shape", shape), null);
      const bounds = boundsOf(shape, 0.2);
      assert(bounds?.kind === "box");
      for (const [a, b] of outline(shape, 0.05)) {
        for (const p of [a, b]) assert(p.every((c, i) => c > bounds.min[i]! && c < bounds.max[i]!));
      }
    }
  }
});

test("an area's corners come to lie in one plane, each moved as little as can be", () => {
  const pane: Vec3[] = [[0, 0, 0], [2, 0.02, 0], [2, -0.02, 2], [0, 0.02, 2]];
  const flat = flattened(pane);
  const [a, b, c, d] = flat as [Vec3, Vec3, Vec3, Vec3];
  const u = b.map((x, i) => x - a[i]!) as Vec3;
  const v = c.map((x, i) => x - a[i]!) as Vec3;
  const w = d.map((x, i) => x - a[i]!) as Vec3;
  const volume = u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
  assert(Math.abs(volume) < 1e-9);
  flat.forEach((p, i) => assert(distance(p, pane[i]!) < 0.04));
});

test("a turned box has twelve edges of its sizes", () => {
  const edges = outline({ kind: "oriented_box", T_frame_box: { position: [1, 2, 3], rotation: fromYaw(0.7) }, size: [1, 2, 3] }, 0.05);
  const lengths = edges.map(([a, b]) => Math.round(distance(a, b) * 1e6) / 1e6).sort();
  assert.deepEqual(lengths, [1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3]);
  assert.equal(outline({ kind: "voxels", resolution: 0.1, boxes: [[0, 0, 0, 1, 1, 1]] }, 0.1).length, 12);
});

test("transforms go there and back, and levelling keeps the heading", () => {
  const next = random(2);
  for (let run = 0; run < 100; ++run) {
    const T = { position: [next(), next(), next()] as Vec3, rotation: unit([next() - 0.5, next() - 0.5, next() - 0.5, next() - 0.5]) };
    const p: Vec3 = [next(), next(), next()];
    near(transformed(inverse(T), transformed(T, p)), p);
    near(transformed(composed(T, inverse(T)), p), transformed(kIdentity, p));
    near(toXr(fromXr(p)), p);
    const xr = { position: p, rotation: T.rotation };
    near(transformed(poseFromXr(xr), fromXr([1, 2, 3])), fromXr(transformed(xr, [1, 2, 3])));
    const yaw = (next() - 0.5) * 6;
    assert(Math.abs(yawOf(levelled({ position: p, rotation: fromYaw(yaw) }).rotation) - yaw) < 1e-9);
  }
  near(rotated(fromYaw(Math.PI / 2), [1, 0, 0]), [0, 1, 0]);
});

test("a ribbon is as wide as asked, and red where it is tight", () => {
  const band = ribbon([{ p: [0, 0, 0], clearance: 0.1 }, { p: [1, 0, 0], clearance: 2 }], 0.4, 0.05);
  assert.deepEqual([...band.positions].map((x) => Math.round(x * 100) / 100), [0, 0.2, 0.05, 0, -0.2, 0.05, 1, 0.2, 0.05, 1, -0.2, 0.05]);
  assert.equal(band.indices.length, 6);
  assert(clearanceColour(0)[0] > clearanceColour(0)[1] && clearanceColour(2)[1] > clearanceColour(2)[0]);
  assert.equal(ribbon([{ p: [0, 0, 0], clearance: 1 }], 0.4, 0).indices.length, 0);
});

test("voxels are moved by two points that the person shows; one that is not shown moves nothing", async (t) => {
  t.mock.method(globalThis, "setInterval", () => 0);
  const edits: Requests["edit"][] = [];
  const ask = ((name: string, body: Requests["edit"]) => {
    if (name === "edit") edits.push(body);
    return Promise.resolve({ edit: "e1", revision: 1, voxels: 8 });
  }) as unknown as Ask;
  const news = new News();
  const editor = new Editor(ask, news, new SceneDraft(ask, news, store()));
  const turn = (): Promise<void> => new Promise((resolve) => setImmediate(resolve));
  await editor.move();
  assert.match(news.latest.value!.text, /Select something first/);
  const shape = { kind: "box", min: [0, 0, 0], max: [1, 1, 2] } as const;
  const show = async (...points: (Vec3 | null)[]): Promise<void> => {
    editor.begin("box");
    editor.point([0, 0, 0]);
    editor.point([1, 1, 0]);
    const moved = editor.move();
    for (const p of points) {
      if (p) editor.point(p);
      else editor.cancel();
      await turn();
    }
    await moved;
  };
  await show([1, 1, 0], [3, 1, 0.5]);
  assert.deepEqual(edits, [{ op: "move", frame: "map", shape, move: [2, 0, 0.5] }]);
  assert.deepEqual(editor.undoable.value, ["e1"]);
  assert.equal(editor.selection.value, null);
  await show([1, 1, 0], null);
  await show(null);
  assert.equal(edits.length, 1);
});

test("places where agents disagree are looked at one after the other, round and round", async () => {
  const place = (x: number): ConflictRegion => ({ low: [x, 0, 0], high: [x + 1, 3, 0], voxels: 8, claims: [{ agent: "robot1", occupied: 0, free: 8 }] });
  let regions = [place(1), place(2), place(3)];
  const asked = (() => Promise.resolve({ regions, regions_in_all: regions.length, voxels_in_all: 24 })) as unknown as Ask;
  const tour = new ConflictTour(asked, new News());
  tour.step(1);
  assert.equal(tour.region, undefined, "nothing was asked for");
  await tour.refresh();
  assert.equal(tour.region, undefined);
  const steps = ([1, 1, 1, 1, -1] as const).map((by) => {
    tour.step(by);
    return tour.region?.low[0];
  });
  assert.deepEqual(steps, [1, 2, 3, 1, 3]);
  assert.deepEqual(cornersOf(place(2), 0.5), [[1, 0, 0], [2, 2, 0.5]]);
  assert.equal(conflictWords(place(2)), "8 voxels. robot1: 0 occupied, 8 free");
  regions = [];
  await tour.refresh();
  tour.step(-1);
  assert.equal(tour.region, undefined, "they agree by now");
});

test("of a path its reason and the planner's message are said, also of one that is there", () => {
  const path: Path = { robot: "robot1", status: "OK", message: "", frame: "map", points: [], length: 6.32, clearance: 0.254, plan: "p", plan_number: 1, map_revision: 3, active: true, zones: [] };
  assert.equal(pathWords(path), "6.3 m, at least 0.25 m of room");
  assert.equal(pathWords({ ...path, active: false, plan_number: 3 }), "6.3 m, at least 0.25 m of room, planned 3 times, a plan only");
  assert.equal(pathWords({ ...path, message: "nothing was heard of the map for 12 s" }), "6.3 m, at least 0.25 m of room; nothing was heard of the map for 12 s");
  assert.equal(pathWords({ ...path, status: "NO_VALID_PATH", message: "the nearest place is 1.2 0.4" }), "No path (NO_VALID_PATH): the nearest place is 1.2 0.4");
  assert.equal(pathWords({ ...path, status: "NO_PATH" }), "No path (NO_PATH)");
  assert.equal(pathWords({ ...path, seconds: 75.4, zones: ["dock", "gate"] }), "6.3 m, 1 min 15 s, at least 0.25 m of room, keeps away from dock, gate");
  assert.equal(pathWords({ ...path, status: "NO_VALID_PATH", failed_leg: 1, nearest: [1, 2, 0] }), "No path (NO_VALID_PATH); leg 2 cannot be gone; the nearest place it can reach is marked");
});

test("what waits in a scene is taken back before anything that was sent", async (t) => {
  t.mock.method(globalThis, "setInterval", () => 0);
  const asked: string[] = [];
  const ask = ((name: string) => {
    asked.push(name);
    return Promise.resolve({ revision: 1, voxels: { boxes: [] }, zones: [] });
  }) as unknown as Ask;
  const news = new News();
  const draft = new SceneDraft(ask, news, store());
  const editor = new Editor(ask, news, draft);
  editor.did("sent");
  await draft.get([0, 0, 0], 1);
  const volume: Volume = { kind: "box", min: [0, 0, 0], max: [1, 1, 1] };
  draft.addEdit({ op: "add", shape: volume });
  draft.addZone({ name: "dock", zone_kind: "no_go", volume });
  await editor.undo();
  assert.deepEqual([draft.open.value!.edits.length, draft.open.value!.zones.length], [1, 0], "the last goes first");
  await editor.undo();
  assert.deepEqual(draft.open.value!.edits, []);
  assert.deepEqual(asked, ["scene_get"]);
  await editor.undo();
  assert.deepEqual(asked, ["scene_get", "undo"]);
});

test("of a scene that is stopped half-way the rest waits, with what was done as known, and undoable", async (t) => {
  t.mock.method(globalThis, "setInterval", () => 0);
  const sent: Requests["scene_send"][] = [];
  const ask = ((name: string, body: Requests["scene_send"]) => {
    if (name === "scene_get") return Promise.resolve({ revision: 7, voxels: { boxes: [] }, zones: [] });
    sent.push(body);
    if (sent.length > 1) return Promise.resolve({ revision: 10, edits: ["e2"], zones: 1 });
    return Promise.resolve({ revision: 8, edits: ["e1"], zones: 0, stopped: { code: "LOCKED", message: "Ana works there.", retry: true } });
  }) as unknown as Ask;
  const news = new News();
  const draft = new SceneDraft(ask, news, store());
  const editor = new Editor(ask, news, draft);
  await draft.get([0, 0, 0], 1);
  for (const x of [0, 5]) draft.addEdit({ op: "add", shape: { kind: "box", min: [x, 0, 0], max: [x + 1, 1, 1] } });
  draft.addZone({ name: "dock", zone_kind: "no_go", volume: { kind: "box", min: [0, 0, 0], max: [1, 1, 1] } });
  await draft.send();
  assert.match(news.latest.value!.text, /Ana works there/);
  assert.deepEqual(editor.undoable.value, ["e1"]);
  await draft.send();
  assert.equal(draft.open.value, null);
  assert.deepEqual(sent.map(({ base_revision, known }) => [base_revision, known]), [[7, []], [7, ["e1"]]]);
  assert.deepEqual([sent[1]!.edits.length, sent[1]!.zones.length], [1, 1]);
  assert.deepEqual(sent[1]!.edits[0]!.shape, { kind: "box", min: [5, 0, 0], max: [6, 1, 1] });
  assert.deepEqual(editor.undoable.value, ["e1", "e2"]);
});

test("what waits in a scene is there after a reload; what another version of the page wrote is not taken", async () => {
  const ask = ((name: string) => Promise.resolve(name === "scene_get" ? { revision: 7, voxels: { boxes: [] }, zones: [] } : { edits: ["e1"], zones: 0 })) as unknown as Ask;
  const memory = store();
  const draft = (): SceneDraft => new SceneDraft(ask, new News(), memory);
  const first = draft();
  await first.get([0, 0, 0], 1);
  first.addEdit({ op: "add", shape: { kind: "box", min: [0, 0, 0], max: [1, 1, 1] } });
  assert.deepEqual(draft().open.value, first.open.value);
  assert.equal(draft().open.value!.edits.length, 1);
  for (const strange of ["{", "[]", "3", '{"revision":7,"voxelBoxes":0,"edits":[{"op":"paint"}],"zones":[],"steps":["edit"],"known":[]}', '{"revision":7,"voxelBoxes":0,"edits":[],"zones":[],"steps":["edit"],"known":[]}', '{"revision":7.5,"voxelBoxes":0,"edits":[],"zones":[],"steps":[],"known":[]}', '{"revision":7,"voxelBoxes":0,"edits":[],"zones":[],"steps":[],"known":[3]}']) {
    memory.setItem("concord-scene", strange);
    assert.equal(draft().open.value, null, strange);
  }
  memory.setItem("concord-scene", JSON.stringify(first.open.value));
  const again = draft();
  await again.send();
  assert.equal(draft().open.value, null, "what was sent waits no more");
});

test("obstacles of this page are known after a reload, but for those that stand no more", async () => {
  const standing = new Map([["o1", true], ["o2", false]]);
  let reachable = true;
  const ask = ((name: string, body: { subject?: string; obstacle?: string }) => {
    if (!reachable) return Promise.reject(new Error("not connected"));
    if (name === "obstacle_remove") return Promise.resolve({ revision: 3, paths: [] });
    const active = standing.get(body.subject!);
    return Promise.resolve({ operations: active === undefined ? [] : [{ operation: body.subject, active }, { operation: "u1", active: true }] });
  }) as unknown as Ask;
  const ids = ["o1", "o2", "o3"];
  const editor = { obstacle: () => Promise.resolve({ obstacle: ids.shift()! }) } as unknown as Editor;
  const memory = store();
  const load = (): Obstacles => new Obstacles(ask, editor, new News(), memory);
  const first = load();
  for (let made = 0; made < 3; ++made) await first.add();
  const second = load();
  reachable = false;
  await second.check();
  assert.deepEqual(second.own.value, ["o1", "o2", "o3"], "what cannot be asked stays");
  reachable = true;
  await second.check();
  assert.deepEqual(second.own.value, ["o1"], "o2 was undone, o3 is not known");
  await second.remove("o1");
  assert.deepEqual(load().own.value, []);
});

test("history says of an undo what it took back, as far as it is known", () => {
  const by = (author: string, what: Operation["what"], subject: string, count = 0): Operation =>
    ({ operation: `${author}-1`, author, what, subject, count, utime: 0, revision: 1, active: true });
  const added = by("Ana", "add", "", 640);
  assert.equal(operationWords(added, new Map()), "Ana added 640 voxels");
  const undone = by("Ben", "undo", added.operation, 640);
  assert.equal(operationWords(undone, new Map([[added.operation, added]])), "Ben undid: Ana added 640 voxels");
  assert.equal(operationWords(undone, new Map()), "Ben undid Ana-1");
  assert.equal(operationWords(by("", "zone_add", "stairs"), new Map()), "somebody added zone stairs");
});

test("a device without a place in the map shows no point of it; one that loses it answers no more", async (t) => {
  t.mock.method(globalThis, "setInterval", () => 0);
  const ask = (() => Promise.resolve({})) as unknown as Ask;
  const news = new News();
  const editor = new Editor(ask, news, new SceneDraft(ask, news, store()));
  editor.blocked.set("Place your room first.");
  assert.equal(await editor.askPoint("Click where it shall go."), null);
  assert.match(news.latest.value!.text, /Place your room first/);
  const seen = editor.askPoint("Click where you see it.", true);
  editor.point([1, 2, 3]);
  assert.deepEqual(await seen, [1, 2, 3]);
  editor.blocked.set(null);
  const goal = editor.askPoint("Click where it shall go.");
  const robot = editor.question.value;
  assert(robot && !robot.unplaced);
  editor.blocked.set("Your room began anew.");
  assert.equal(await goal, null);
  assert.equal(editor.question.value, null);
  assert.match(news.latest.value!.text, /began anew/);
});

test("an alignment that is cancelled while its fit is sought does not come back, and its offer is dropped", async () => {
  const asked: string[] = [];
  let answer: (offer: unknown) => void = () => {};
  const ask = ((name: string) => {
    asked.push(name);
    return name === "align" ? new Promise((done) => (answer = done)) : Promise.resolve({});
  }) as unknown as Ask;
  const align = new AlignSession(ask, () => Promise.resolve({ kind: "points", request: 1, points: new Float32Array([0, 0, 0]) }), new News());
  await align.begin("robot2", undefined);
  const refined = align.refine(true);
  align.cancel();
  answer({ align: "al1", T_target_source: kIdentity, evidence: {}, message: "" });
  await refined;
  assert.equal(align.current.value, null);
  assert.deepEqual(asked, ["align", "align_drop"]);
});
