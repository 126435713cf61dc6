import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import type { App } from "../../../hmd_bridge/web/src/app";
import { FakeServer } from "../support/fake_server";
import { canvasShot, launch, nextFrames, open, pageShot, settled, webFolder } from "../support/page";

let browser: Browser;
let server: FakeServer;
let url: string;
before(async () => {
  browser = await launch();
  server = new FakeServer(webFolder);
  url = await server.start();
});
after(async () => {
  await browser.close();
  server.stop();
});

const news = (page: Page): Promise<string> => page.locator(".news p").innerText();

/** Where a point of the map is on the page. */
function onPage(page: Page, p: [number, number, number]): Promise<{ x: number; y: number }> {
  return page.evaluate(([x, y, z]) => {
    const { concord } = window as unknown as { concord: { stage: { camera: unknown; fromMap(p: number[]): { project(camera: unknown): { x: number; y: number } } } } };
    const box = document.querySelector("#canvas")!.getBoundingClientRect();
    const at = concord.stage.fromMap([x, y, z]).project(concord.stage.camera);
    return { x: box.left + ((at.x + 1) / 2) * box.width, y: box.top + ((1 - at.y) / 2) * box.height };
  }, p);
}

async function clickMap(page: Page, p: [number, number, number]): Promise<void> {
  const { x, y } = await onPage(page, p);
  await page.mouse.move(x, y);
  await page.mouse.click(x, y);
}

test("a newcomer sees the map, selects a box, adds it, takes it back and brings it back", async () => {
  const { page, errors } = await open(browser, url);
  await settled(page, 100);
  await pageShot(page, "desk-1-first-view");
  await page.getByRole("tab", { name: "Edit" }).click();
  await page.getByRole("button", { name: "From above" }).click();
  await page.keyboard.press("Escape");
  await nextFrames(page);
  await page.locator("#tool-box").click();
  await clickMap(page, [-2.5, -0.4, 0]);
  await clickMap(page, [-1.5, 0.4, 0]);
  await page.getByRole("button", { name: "From above" }).click();
  await nextFrames(page);
  await pageShot(page, "desk-2-selection");
  const size = server.map.size;
  await page.locator("#edit-add").click();
  await page.locator(".news p.done").waitFor();
  assert.match(await news(page), /voxels added/);
  assert(server.map.size > size + 1000);
  const shape = server.lastAsked("edit")!.shape;
  assert(shape.kind === "box" && Math.abs(shape.min[0] + 2.5) < 0.05 && Math.abs(shape.max[1] - 0.4) < 0.05, JSON.stringify(shape));
  assert(server.asked.some(({ name }) => name === "lease_hold") && server.asked.some(({ name }) => name === "lease_free"));
  await settled(page);
  await pageShot(page, "desk-3-added");
  await page.keyboard.press("Control+z");
  await page.getByText("Undone").waitFor();
  assert.equal(server.map.size, size);
  await page.keyboard.press("Control+y");
  await page.getByText("Done again").waitFor();
  await page.getByRole("tab", { name: "History" }).click();
  await page.getByRole("button", { name: "Refresh" }).click();
  await page.getByText(/Ana added/).waitFor();
  await pageShot(page, "desk-4-history");
  assert.deepEqual(errors, []);
  await page.close();
});

test("a robot's path is shown, an obstacle forces another", async () => {
  const { page, errors } = await open(browser, url);
  await settled(page, 100);
  await page.getByRole("tab", { name: "Robots" }).click();
  await page.getByLabel("Show its path").first().check();
  await page.getByText(/6\.3 m, 12 s, at least 0\.70 m/).waitFor();
  await pageShot(page, "desk-5-path");
  await page.getByRole("tab", { name: "Edit" }).click();
  await page.keyboard.press("Escape");
  await page.getByRole("button", { name: "From above" }).click();
  await page.locator("#tool-box").click();
  await clickMap(page, [-0.2, 0.3, 0]);
  await clickMap(page, [0.4, 1, 0]);
  await page.getByRole("button", { name: "Add as virtual obstacle" }).click();
  await page.getByText(/another way for robot1/).waitFor();
  await page.getByRole("tab", { name: "Robots" }).click();
  await page.getByText(/7\.2 m, 14 s, at least 0\.20 m/).waitFor();
  await settled(page);
  await canvasShot(page, "desk-6-other-way");
  await page.reload();
  await page.getByRole("tab", { name: "Robots" }).click();
  await page.getByRole("button", { name: "Remove obstacle 1" }).waitFor();
  assert.deepEqual(errors, []);
  await page.close();
});

test("a map is placed by hand, refined, and accepted", async () => {
  const { page, errors } = await open(browser, url);
  await settled(page, 100);
  await page.getByRole("tab", { name: "Align" }).click();
  await page.getByRole("button", { name: "Begin" }).click();
  await page.getByRole("button", { name: "East" }).click();
  await page.getByRole("button", { name: "Turn left" }).click();
  await nextFrames(page);
  await pageShot(page, "desk-7-align");
  await page.getByRole("button", { name: "Refine" }).click();
  await page.getByText(/71 % overlap/).waitFor();
  const guess = server.lastAsked("align")!;
  assert.equal(guess.source, "robot2");
  assert(Math.abs(guess.T_target_source!.rotation[2]) > 0.01);
  await page.getByRole("button", { name: "Accept" }).click();
  await page.getByText("robot2 is in the map now.").waitFor();
  assert.deepEqual(errors, []);
  await page.close();
});

test("labelled things and assets are listed, changed, taken away, and what was seen is decided", async () => {
  server.things = [
    { label: 3, instance: 1, class_name: "desk", voxels: 640, min: [0, 0, 0], max: [1, 1, 0.8] },
    { label: 5, instance: 1, class_name: "chair", voxels: 99, min: [1, 0, 0], max: [1.5, 0.5, 0.9], asset: "chair-1" },
  ];
  const { page, errors } = await open(browser, url);
  await settled(page, 100);
  await page.getByRole("tab", { name: "Things" }).click();
  await page.getByRole("button", { name: "Refresh" }).click();
  const desk = page.locator("article", { hasText: "desk 1" });
  await desk.getByText("label", { exact: true }).waitFor();
  await page.locator("article", { hasText: "chair 1" }).getByText("asset", { exact: true }).waitFor();
  const other = page.getByLabel("Class of desk 1", { exact: true });
  await other.pressSequentially("tab");
  // The list comes again while somebody types: with another count, and as it was.
  server.things = server.things.map((thing) => (thing.label === 3 ? { ...thing, voxels: 641 } : thing));
  for (let time = 0; time < 2; ++time) await page.evaluate(() => (window as unknown as { concord: App }).concord.loadThings());
  await desk.getByText("641 voxels").waitFor();
  await page.keyboard.type("le");
  assert.equal(await other.inputValue(), "table");
  await page.getByRole("button", { name: "Change the class of desk 1" }).click();
  await page.getByText("desk 1 is table 1 now.").waitFor();
  assert.deepEqual(server.lastAsked("instance_reassign"), { label: 3, instance: 1, class_name: "table" });
  await page.getByRole("button", { name: "List labels" }).click();
  await page.getByLabel("New name of desk", { exact: true }).fill("workbench");
  await page.getByRole("button", { name: "Rename the label desk" }).click();
  await page.getByText("desk is called workbench now.").waitFor();
  assert.deepEqual(server.lastAsked("label_rename"), { label: 3, name: "workbench" });
  await desk.getByRole("button", { name: "Drop label" }).click();
  await page.getByText("its voxels stay").waitFor();
  assert.equal(server.lastAsked("instance_delete")!.keep_voxels, true);
  await page.locator("article", { hasText: "chair 1" }).getByRole("button", { name: "Delete" }).click();
  await page.getByText("Nothing is labelled yet.").waitFor();
  assert.deepEqual(server.lastAsked("asset_delete"), { label: 5, instance: 1 });

  server.propose("7");
  await page.getByText("chair, seen by robot1, 83 % sure").waitFor();
  await pageShot(page, "desk-9-things");
  await page.getByRole("button", { name: "It is there" }).click();
  await page.getByText("64 % of its surface").waitFor();
  await page.getByText("Nothing waits for your decision.").waitFor();
  assert.deepEqual(server.lastAsked("detection_confirm"), { detection: "7" });
  server.propose("8");
  await page.getByRole("button", { name: "It is not" }).click();
  await page.getByText("Nothing waits for your decision.").waitFor();
  assert.deepEqual(server.lastAsked("detection_reject"), { detection: "8" });
  // What was done here last can be undone like an edit.
  await page.getByRole("tab", { name: "Edit" }).click();
  await page.getByRole("button", { name: "Undo", exact: true }).click();
  await page.getByText("Undone").waitFor();
  assert.deepEqual(server.lastAsked("undo"), { edit: "asset-3" });
  server.things = [];
  assert.deepEqual(errors, []);
  await page.close();
});

test("where agents disagree is asked for, looked at, and put away with its layer", async () => {
  const { page, errors } = await open(browser, url);
  await settled(page, 100);
  const looked = (): Promise<number | null> => page.evaluate(() => (window as unknown as { concord: App }).concord.conflicts.found.value!.at);
  await page.getByRole("tab", { name: "Map" }).click();
  await page.getByRole("button", { name: "Show where agents disagree" }).click();
  await page.getByRole("button", { name: "robot2: 640 occupied, 0 free" }).click();
  assert.equal(await looked(), 0);
  await page.getByLabel("Conflicts", { exact: true }).uncheck();
  assert.equal(await looked(), null);
  assert.deepEqual(errors, []);
  await page.close();
});

test("each refusal is said in clear words", async () => {
  const { page } = await open(browser, url);
  await settled(page, 100);
  server.refuseNext("maps", "IO", "The disk is full.");
  await page.getByRole("button", { name: "List saved maps" }).click();
  await page.locator(".news p.failed").waitFor();
  assert.match(await news(page), /could not write or read its disk.*The disk is full/);
  await page.close();
});

test("a lost connection says so and comes back by itself, with the map still there", async () => {
  const { page, errors } = await open(browser, url);
  await settled(page, 100);
  await page.getByRole("tab", { name: "Things" }).click();
  server.propose("9");
  await page.getByText("chair, seen by robot1").waitFor();
  server.dropConnections();
  await page.waitForFunction(() => document.body.dataset["connection"] === "lost");
  await page.waitForFunction(() => document.body.dataset["connection"] === "ready");
  assert(server.lastAsked("hello")!.resume);
  await page.getByText("Nothing waits for your decision.").waitFor(); // the server says no more that it is open
  await settled(page, 100);
  assert.deepEqual(errors, []);
  await page.close();
});

test("beyond the own machine a token is asked for, and a wrong one is refused in words", async () => {
  const guarded = new FakeServer(webFolder);
  guarded.token = "secret";
  const { page } = await open(browser, await guarded.start());
  await page.getByText("Welcome to Concord").waitFor();
  await pageShot(page, "desk-8-token");
  await page.getByLabel("Token").first().fill("wrong");
  await page.getByRole("button", { name: "Enter" }).click();
  await page.waitForFunction(() => document.querySelector("#connection")!.textContent!.includes("not valid"));
  await page.getByLabel("Token").first().fill("secret");
  await page.getByRole("button", { name: "Enter" }).click();
  await settled(page, 100);
  assert.equal(guarded.lastAsked("hello")!.ticket, "t1");
  await page.close();
  guarded.stop();
});

test("who may only look is told so", async () => {
  const quiet = new FakeServer(webFolder);
  quiet.role = "view";
  const { page } = await open(browser, await quiet.start());
  await settled(page, 100);
  await page.getByRole("tab", { name: "Edit" }).click();
  await page.getByText("Your role is view").waitFor();
  await page.close();
  quiet.stop();
});
