/** The real stack: a person enters a captured room of which a robot has a map already. */
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { promisify } from "node:util";
import { after, before, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import type { Pose } from "../../../hmd_bridge/web/generated/messages";
import { distance, fromYaw, toXr, yawOf, type Vec3 } from "../../../hmd_bridge/web/src/base/vec";
import { aimAt, drag, enterRoom, hearNews, looking, press, pressButton, words, type HeadsetPage } from "../support/headset";
import { canvasShot, launch, nextFrames, open, pageShot, settled } from "../support/page";
import { meshOf, Robot, type Robots } from "../support/room";
import { nativeClient } from "../support/paths";
import { Stack } from "../support/stack";

const kResolution = 0.1;

interface Scene extends Robots {
  goal: Vec3;
  /** Two corners on the floor of what shall stand in the way. */
  obstacle: [Vec3, Vec3];
  /** The same of what the person adds: a pane that no sensor saw. */
  added: [Vec3, Vec3];
}

/** In the room, z up; a robot of 18 cm fits through. */
const kScenes: Record<string, Scene> = {
  office_large: {
    T_odom_room: { position: [2, -1, 0], rotation: fromYaw(0.5) },
    base: [-0.3, 0.9, 0],
    eyes: [[0, 0.9, 0.6], [-0.4, 0.2, 0.8], [0.1, -0.4, 0.5], [0.2, -0.9, 0.8], [-0.6, -0.8, 0.6], [0.3, -1.6, 0.6], [0.3, -2.6, 0.8]],
    goal: [0.3, -1, 0],
    obstacle: [[0.05, -0.5, 0], [0.3, -0.65, 0]],
    added: [[0.6, -0.9, 0], [1.0, -1.1, 0]],
  },
  living_room: {
    T_odom_room: { position: [-1, 2, 0], rotation: fromYaw(-0.4) },
    base: [0, 1.4, 0],
    eyes: [[0, 0.5, 0.8], [0.2, 1.4, 0.6], [-0.5, 1, 0.7], [0.3, -0.5, 0.6], [0.5, -1.2, 0.8], [-0.4, -0.8, 0.6]],
    goal: [0, -1.2, 0],
    obstacle: [[-0.3, -0.4, 0], [0.3, -0.7, 0]],
    added: [[0.9, -0.4, 0], [1.2, -0.7, 0]],
  },
  music_room: {
    T_odom_room: { position: [1, 1, 0], rotation: fromYaw(0.3) },
    base: [-1, 1.2, 0],
    eyes: [[-0.9, 1, 0.8], [-0.5, 0.3, 0.6], [-0.2, -0.6, 0.7], [0.4, -1.8, 0.6], [-1.2, 1.9, 0.7], [0.3, 1.3, 0.6], [-0.9, -0.8, 0.6]],
    goal: [-1, -0.7, 0],
    obstacle: [[-1.2, 0.7, 0], [-0.7, 0.5, 0]],
    added: [[-0.3, -0.6, 0], [0, -0.8, 0]],
  },
  meeting_room: {
    T_odom_room: { position: [2, 0, 0], rotation: fromYaw(-0.5) },
    base: [-1.4, 1.3, 0],
    eyes: [[-1.2, -0.3, 0.8], [-1.3, 0.6, 0.6], [-1.4, 1.8, 0.7], [-1.2, 3.2, 0.8], [0.6, 3.3, 0.7], [1.2, -0.2, 0.6], [0, -0.4, 0.8]],
    goal: [-1.3, -0.4, 0],
    obstacle: [[-1.6, 0.5, 0], [-1.2, 0.3, 0]],
    added: [[0.9, -0.2, 0], [1.2, -0.4, 0]],
  },
};
const room = process.env["CONCORD_ROOM"] ?? "office_large";
const scene = kScenes[room];
if (!scene) throw new Error(`no scene is described for ${room}`);

let browser: Browser;
let stack: Stack | undefined;
let robot: Robot | undefined;
before(async () => {
  browser = await launch();
  stack = await Stack.start(kResolution);
  robot = await Robot.map(stack.url, "robot1", meshOf(room), scene);
});
after(async () => {
  robot?.stop();
  await browser.close();
  await stack?.stop();
});

/** A place on the floor of the room, for the headset's rays. */
const there = (p_room: Vec3): Vec3 => toXr(p_room);
const path = (page: Page): Promise<{ points: { p: Vec3 }[]; status: string; length: number; plan_number: number } | undefined> =>
  page.evaluate(() => (window as unknown as HeadsetPage).concord.world.paths.value.get("robot1"));

test("a person enters a captured room, scans it, aligns it by hand, corrects it, names something, and blocks a robot's way", async () => {
  const { page, errors } = await open(browser, stack!.url, (fresh) => enterRoom(fresh, room), { width: 560, height: 400 });
  await page.locator("#enter").click();
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.presenting);
  await hearNews(page);
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.uploader.occupied.value > 500);
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.uploader.looks.value >= 4);
  await canvasShot(page, "stack-1-scanning");
  await pressButton(page, "do sendMap");
  await words(page, "Your map was sent");
  await pressButton(page, "do scan"); // enough

  // The robot's map is grey, one's own is blue: taken in the hand, put there, refined.
  await pressButton(page, "page align");
  await pressButton(page, "with robot1");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.table.open);
  await nextFrames(page);
  await canvasShot(page, "stack-2-two-small-maps");
  await aimAt(page, "table");
  await press(page, "squeeze", true);
  await drag(page, [0.03, 0, -0.02]);
  await press(page, "squeeze", false);
  await pressButton(page, "do left");
  await pressButton(page, "do left");
  await canvasShot(page, "stack-3-moved");
  await pressButton(page, "do refine");
  await page.waitForFunction(() => /% overlap/.test((window as unknown as HeadsetPage).concordImmersive.panel.pageShown.title));
  await canvasShot(page, "stack-4-refined");
  await pressButton(page, "do accept");
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.own.standing.value.state === "aligned");
  const T_map_own = await page.evaluate(() => ((window as unknown as HeadsetPage).concordImmersive.own.standing.value as { T_map_own: Pose }).T_map_own);
  assert(distance(T_map_own.position, scene.T_odom_room.position) < kResolution, JSON.stringify(T_map_own));
  assert(Math.abs(yawOf(T_map_own.rotation) - yawOf(scene.T_odom_room.rotation)) < 0.03, JSON.stringify(T_map_own));
  await settled(page, 100);
  await canvasShot(page, "stack-5-merged");

  // Correct: what no sensor saw.
  await pressButton(page, "page main");
  await pressButton(page, "page edit");
  await select(page, scene.added);
  await pressButton(page, "do add");
  await words(page, "added");
  await settled(page);
  await looking(page, there(scene.added[0]), () => canvasShot(page, "stack-6-corrected"));

  // One touch and a name: the whole of it is labelled.
  await pressButton(page, "do touch");
  await aimAt(page, there([(scene.added[0][0] + scene.added[1][0]) / 2, scene.added[0][1], 0.5]));
  await press(page, "select", true);
  await press(page, "select", false);
  await page.waitForFunction(() => (window as unknown as HeadsetPage).concordImmersive.panel.pageShown.title.includes("What is it"));
  for (const key of ["p", "a", "n", "e"]) await pressButton(page, `key ${key}`);
  await pressButton(page, "text done");
  await words(page, "pane 1");
  await settled(page);
  await looking(page, there(scene.added[0]), () => canvasShot(page, "stack-6b-labelled"));

  // A robot's way, blocked, and the other one.
  await pressButton(page, "page main");
  await pressButton(page, "page robots");
  await pressButton(page, "robot send/robot1");
  await aimAt(page, there(scene.goal));
  await press(page, "select", true);
  await press(page, "select", false);
  await words(page, "on its way");
  const before = (await path(page))!;
  assert.equal(before.status, "OK");
  await pressButton(page, "robot path/robot1"); // off
  await pressButton(page, "robot path/robot1"); // and on: it is told of changes from now on
  await looking(page, there(scene.goal), () => canvasShot(page, "stack-7-path"));
  await pressButton(page, "page main");
  await pressButton(page, "page edit");
  await select(page, scene.obstacle);
  await pressButton(page, "do obstacle");
  await words(page, "another way for robot1");
  await page.waitForFunction((was) => (window as unknown as HeadsetPage).concord.world.paths.value.get("robot1")?.plan_number !== was, before.plan_number);
  const after = (await path(page))!;
  assert.equal(after.status, "OK");
  assert(after.length > before.length + 0.02, `${before.length} m, then ${after.length} m`);
  await settled(page);
  await looking(page, there(scene.goal), () => canvasShot(page, "stack-8-other-way"));
  assert.deepEqual(errors, []);

  // The same map on a desk, by somebody else.
  const desk = await open(browser, stack!.url);
  await settled(desk.page, 100);
  await desk.page.getByRole("tab", { name: "Things" }).click();
  await desk.page.locator("article", { hasText: "pane 1" }).waitFor();
  await desk.page.getByRole("tab", { name: "History" }).click();
  await desk.page.getByRole("button", { name: "Refresh" }).click();
  await desk.page.getByText(/added/).first().waitFor();
  await pageShot(desk.page, "stack-9-desk");
  assert.deepEqual(desk.errors, []);
  await desk.page.close();
  await page.close();

  // And by a program that was written from the protocol's page.
  const { stdout } = await promisify(execFile)("python3", [nativeClient, stack!.url]);
  const seen = JSON.parse(stdout) as { before: number; added: number; after: number };
  assert(seen.before > 1000, stdout);
  assert.deepEqual([seen.added, seen.after], [seen.before + 8, seen.before]);

  /** A box on the floor, drawn in one go. */
  async function select(on: Page, [from, to]: [Vec3, Vec3]): Promise<void> {
    await pressButton(on, "tool box");
    await aimAt(on, there(from));
    await press(on, "select", true);
    await aimAt(on, there(to));
    await press(on, "select", false);
  }
});
