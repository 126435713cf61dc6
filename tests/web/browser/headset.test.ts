import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import { FakeServer } from "../support/fake_server";
import { canvasShot, launch, nextFrames, open, pageShot, webFolder } from "../support/page";
import { aimAt, enterRoom, hearNews, press, pressButton, standing, words, type HeadsetPage } from "../support/headset";

let browser: Browser;
let server: FakeServer;
before(async () => (browser = await launch()));
beforeEach(() => (server = new FakeServer(webFolder)));
afterEach(() => server.stop());
after(() => browser.close());

async function entered(room: string): Promise<{ page: Page; errors: string[] }> {
  const { page, errors } = await open(browser, await server.start(), (fresh) => enterRoom(fresh, room), { width: 560, height: 400 }); // few pixels: all of them are drawn by software
  await page.locator("#enter").click();
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.presenting);
  await hearNews(page);
  return { page, errors };
}

/** The server says that this device's map was placed there. */
function alignOwn(frameId: string, agent: string): void {
  server.agents = [...server.agents, {
    agent, type: "headset", frame_id: frameId, aligned: true, T_map_agent: { position: [-2.5, 0, 0], rotation: [0, 0, 0, 1] }, weight: 100, revision: 1, known: 9, occupied: 9,
  }];
  server.tellAll("agents", { agents: server.agents });
}

const own = (page: Page): Promise<{ agent: string; frameId: string }> =>
  page.evaluate(() => {
    const { own: frame } = (window as unknown as HeadsetPage).concordImmersive;
    return { agent: frame.agent, frameId: frame.frameId.value };
  });

test("a person enters a captured office: its mesh is sent, the menu is there, edits wait for an alignment", async () => {
  const { page, errors } = await entered("office_large");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.uploader.looks.value >= 3);
  assert(server.uploads[0]!.meshes > 0, "the first look brings the room");
  assert.deepEqual(server.uploads.slice(0, 3).map(({ sequence }) => sequence), [0, 1, 2]);
  assert.equal(await standing(page), "unaligned");
  await nextFrames(page);
  await canvasShot(page, "headset-1-scanning");
  await pressButton(page, "do sendMap");
  await words(page, "4711");
  const notice = server.notices.findLast(({ name }) => name === "tracking")!.body as { state: string; T_own_head: { position: number[] } };
  assert.equal(notice.state, "ok");
  assert(Math.abs(notice.T_own_head.position[2]! - 1.65) < 0.05, "z up");
  assert.deepEqual(errors, []);
  await page.close();
});

test("the small map is taken in the hand, put onto the other's, refined and accepted; then the map stands in the room", async () => {
  const { page, errors } = await entered("office_small");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.uploader.looks.value >= 1);
  await pressButton(page, "page align");
  await pressButton(page, "with robot1");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.table.open);
  await nextFrames(page);
  await canvasShot(page, "headset-2-align");
  const before = server.asked.length;
  await aimAt(page, "table");
  await press(page, "squeeze", true);
  await page.evaluate(() => (window as unknown as HeadsetPage).xrDevice.controllers.right!.position.set(0.35, 1.3, -0.25));
  await nextFrames(page);
  await nextFrames(page);
  await press(page, "squeeze", false);
  await canvasShot(page, "headset-3-moved");
  await pressButton(page, "do refine");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.panel.pageShown.title.includes("71 % overlap"));
  const guess = server.asked.slice(before).find(({ name }) => name === "align")!.body as { source: string; T_target_source: { position: number[] } };
  assert.equal(guess.source, (await own(page)).agent);
  assert(Math.hypot(...guess.T_target_source.position) > 0.5, "it was moved by hand");
  await pressButton(page, "do accept");
  const { agent, frameId } = await own(page);
  alignOwn(frameId, agent);
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.own.standing.value.state === "aligned");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concord.layers.settled && (window as unknown as HeadsetPage).concord.layers.triangles > 100);
  await nextFrames(page);
  await canvasShot(page, "headset-4-aligned");

  // A box over the floor, drawn in one go, added.
  await pressButton(page, "page main");
  await pressButton(page, "page edit");
  await canvasShot(page, "headset-5-edit-menu");
  await pressButton(page, "tool box");
  await aimAt(page, [0.5, 0, -1.6]);
  await press(page, "select", true);
  await aimAt(page, [1.3, 0, -2.6]);
  await canvasShot(page, "headset-6-selecting");
  await press(page, "select", false);
  const size = server.map.size;
  await pressButton(page, "do add");
  await words(page, "added");
  assert(server.map.size > size);
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concord.layers.settled);
  await nextFrames(page);
  await canvasShot(page, "headset-7-added");

  // Voxels moved: a point of them is shown, and where that shall go.
  await pressButton(page, "tool box");
  await aimAt(page, [0.5, 0, -1.6]);
  await press(page, "select", true);
  await aimAt(page, [1.3, 0, -2.6]);
  await press(page, "select", false);
  await pressButton(page, "do move");
  for (const place of [[0.5, 0, -1.6], [1.3, 0, -2.6]] as const) {
    await aimAt(page, [...place]);
    await press(page, "select", true);
    await press(page, "select", false);
  }
  await words(page, "moved");
  const moved = server.lastAsked("edit")!;
  assert(moved.op === "move" && Math.hypot(...moved.move!) > 0.1);

  // The keyboard names a label.
  await pressButton(page, "tool box");
  await aimAt(page, [0.5, 0, -1.6]);
  await press(page, "select", true);
  await aimAt(page, [1.3, 0, -2.6]);
  await press(page, "select", false);
  await pressButton(page, "do label");
  for (const key of ["d", "e", "s", "k"]) await pressButton(page, `key ${key}`);
  await canvasShot(page, "headset-8-keyboard");
  await pressButton(page, "text done");
  await words(page, "label");
  assert.equal((server.lastAsked("label") as { class_name: string }).class_name, "desk");

  // Where agents disagree.
  await pressButton(page, "page main");
  await pressButton(page, "page conflicts");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.panel.pageShown.title.includes("640"));
  await pressButton(page, "do conflictNext");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.panel.pageShown.title.startsWith("1 of 1"));
  await nextFrames(page);
  await canvasShot(page, "headset-11-conflicts");

  // A path, blocked, and the other one.
  await pressButton(page, "page main");
  await pressButton(page, "page robots");
  await pressButton(page, "robot path/robot1");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concord.world.paths.value.size === 1);
  await nextFrames(page);
  await canvasShot(page, "headset-9-path");
  assert.deepEqual(errors, []);
  await page.close();
});

test("a reset of the origin makes another frame, unaligned, with edits blocked and a new sequence of looks", async () => {
  const { page, errors } = await entered("office_small");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.uploader.looks.value >= 1);
  const first = await own(page);
  alignOwn(first.frameId, first.agent);
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.own.standing.value.state === "aligned");
  assert.equal(await page.evaluate(() => (window as unknown as HeadsetPage).concord.editor.blocked.value), null);
  await page.evaluate(() => (window as unknown as HeadsetPage).xrDevice.recenter());
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.own.standing.value.state === "unaligned");
  assert.notEqual((await own(page)).frameId, first.frameId);
  assert.match((await page.evaluate(() => (window as unknown as HeadsetPage).concord.editor.blocked.value))!, /not placed in the map/);
  const sent = server.uploads.length;
  await page.waitForFunction((n) => (window as unknown as HeadsetPage).concordImmersive.uploader.looks.value > n, sent);
  assert(server.uploads.slice(sent - 1).some(({ sequence, meshes }) => sequence === 0 && meshes > 0), "the room is sent again");
  await pageShot(page, "headset-10-reset");
  assert.deepEqual(errors, []);
  await page.close();
});

test("a room that somebody reset is scanned again in another frame, which is said before its first look", async () => {
  const { page, errors } = await entered("office_small");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.uploader.looks.value >= 1);
  const first = await own(page);
  const sent = server.uploads.length;
  server.refuseNext("upload_mesh", "BAD_FRAME", "this frame was reset; begin another frame_id");
  await words(page, "began anew");
  await page.waitForFunction((n) => (window as unknown as HeadsetPage).concordImmersive.uploader.looks.value > n, sent + 1);
  const { frameId } = await own(page);
  assert.notEqual(frameId, first.frameId);
  const again = server.uploads.slice(sent).find(({ sequence }) => sequence === 0)!;
  assert(again.meshes > 0, "the room is sent again");
  assert.equal(again.frameId, frameId);
  assert.deepEqual(errors, []);
  await page.close();
});
